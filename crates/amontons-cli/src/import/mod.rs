//! `amontons import`: a case from an input deck of Abaqus or CalculiX.
//!
//! The deck is read twice: its mesh by the library, like any mesh file, and its materials, steps, loads and contacts
//! here. Items that the deck refers to by number get names in a second file, which then is the mesh of the case.

mod body;
mod conditions;
mod contact;
mod deck;
mod forces;
mod material;
mod mesh;
mod model;
mod notes;
mod orientation;
mod parts;
mod rigid;
mod sides;
mod time;
mod transform;
mod units;
mod vector;
mod write;

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use amontons::case;
use amontons::mesh::MeshFileError;
use amontons::output::OutputError;

use crate::arguments::DeckUnits;
use crate::new::beside;
use crate::print;
use crate::status::CommandFailure;

/// Writes the case of a deck, and a mesh file with the names missing in the deck.
pub fn execute(deck: &Path, out: Option<&Path>, units: DeckUnits, force: bool) -> Result<(), CommandFailure> {
    let out = out.map_or_else(|| deck.with_extension("toml"), Path::to_owned);
    let sides_file = with_stem(&out, "-sides.inp");
    let same =
        |file: &Path| file == deck || matches!((file.canonicalize(), deck.canonicalize()), (Ok(a), Ok(b)) if a == b);
    if same(&out) || same(&sides_file) {
        let found = format!("--out {}: found a name that would replace the deck", out.display());
        return Err(CommandFailure::Usage(format!("{found}, expected a case file such as case.toml")));
    }
    if !force {
        for file in [&out, &sides_file] {
            if file.symlink_metadata().is_ok() {
                return Err(CommandFailure::Exists(file.clone()));
            }
        }
    }
    let cards = deck::read(deck)?;
    let (model, mut notes) = model::DeckModel::of(&cards).map_err(|fault| fault.of(deck))?;
    // The mesh of a deck with included files is written out, too.
    let includes = cards.iter().any(|card| card.place.is_included());
    let needs_sides = includes || !model.sides.text().is_empty();
    let read = if includes {
        let inside = |fault| MeshFileError::In { path: sides_file.clone(), fault: Box::new(fault) };
        amontons::mesh::inp::parse(model::mesh_of(&cards).as_bytes()).map_err(inside)?
    } else {
        amontons::mesh::read_all(deck)?
    };
    let all = needs_sides.then(|| with_names(&cards, &model, deck));
    // Rigid parts are looked up in the mesh of the case, with the names made for it.
    let read = match all.as_ref().filter(|_| !model.rigid.is_empty()) {
        Some(text) => {
            let inside = |fault| MeshFileError::In { path: sides_file.clone(), fault: Box::new(fault) };
            amontons::mesh::inp::parse(text.as_bytes()).map_err(inside)?
        }
        None => read,
    };
    let file = if needs_sides { &sides_file } else { deck };
    let names = write::Names {
        case: out.file_stem().map_or_else(|| "case".to_owned(), |stem| stem.to_string_lossy().into_owned()),
        deck: name_of(deck),
        mesh: beside(&out, file).to_string_lossy().into_owned(),
    };
    let text = write::case(&model, &read, units, (&names, &mut notes)).map_err(|fault| fault.of(deck))?;
    if let Some(all) = &all {
        put(&sides_file, all, force)?;
    }
    put(&out, &text, force)?;
    report(&out, needs_sides.then_some(sides_file.as_path()), (deck, units), &notes)?;
    case::parse(&case::source(&out)?, &[])?;
    Ok(())
}

/// The mesh of a deck, with names for items that the deck refers to by number.
fn with_names(cards: &[deck::Card], model: &model::DeckModel, deck: &Path) -> String {
    let head = format!(
        "** The mesh of {}, and below names for sides and points that it does not name, by amontons import.\n",
        name_of(deck).replace(char::is_control, " ")
    );
    format!("{head}{}** names\n{}", model::mesh_of(cards), model.sides.text())
}

/// The name of a file without its folder.
fn name_of(file: &Path) -> String {
    file.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// Prints the written files and the items that were left out.
fn report(out: &Path, sides: Option<&Path>, (deck, units): (&Path, DeckUnits), notes: &notes::Notes) -> io::Result<()> {
    let mut text =
        format!("{}: the case of {}; run it with: amontons run {}\n", out.display(), deck.display(), out.display());
    if let Some(sides) = sides {
        text += &format!("{}: its mesh, with names for what the deck names by number\n", sides.display());
    }
    text += &format!("units: {}\n", write::assumed(units));
    let lines = notes.lines();
    if !lines.is_empty() {
        text += "not in the case, or said otherwise:\n";
        for line in lines {
            text += &format!("  {line}\n");
        }
    }
    print::text(&text)
}

/// The file next to another one whose name is its stem and an ending.
fn with_stem(file: &Path, end: &str) -> PathBuf {
    let mut name = file.file_stem().unwrap_or_default().to_owned();
    name.push(end);
    file.with_file_name(name)
}

/// Writes a file. An existing one is replaced only with `force`.
fn put(file: &Path, text: &str, force: bool) -> Result<(), CommandFailure> {
    let failed = |source: io::Error| match source.kind() {
        io::ErrorKind::AlreadyExists => CommandFailure::Exists(file.to_owned()),
        _ => OutputError::Io { doing: "create", path: file.to_owned(), source }.into(),
    };
    let mut options = OpenOptions::new();
    options.write(true);
    if force {
        options.create(true).truncate(true)
    } else {
        options.create_new(true)
    };
    let mut out = options.open(file).map_err(failed)?;
    out.write_all(text.as_bytes()).map_err(failed)
}
