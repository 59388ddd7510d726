//! The keywords of an input deck, with included files in place.

use std::collections::BTreeMap;
use std::fmt;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use amontons::mesh::inp;

use crate::status::CommandFailure;

/// Largest depth of nested included files.
const DEEPEST: usize = 16;
/// Longest deck in bytes, including included files.
const LONGEST: u64 = 1 << 30;

/// A line of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeckPlace {
    /// Name of an included file, or `None` for the deck itself.
    file: Option<Rc<str>>,
    pub line: usize,
}

impl DeckPlace {
    /// The first line of the deck.
    pub fn start() -> DeckPlace {
        DeckPlace { file: None, line: 1 }
    }

    /// True if it is in an included file.
    pub fn is_included(&self) -> bool {
        self.file.is_some()
    }
}

impl fmt::Display for DeckPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.file {
            Some(file) => write!(f, "{file} line {}", self.line),
            None => write!(f, "line {}", self.line),
        }
    }
}

/// The reason why a deck cannot become a case: place, found, expected.
#[derive(Clone, Debug)]
pub struct DeckFault {
    pub place: DeckPlace,
    pub found: String,
    pub expected: String,
}

impl DeckFault {
    pub fn new(place: &DeckPlace, found: impl Into<String>, expected: impl Into<String>) -> DeckFault {
        DeckFault { place: place.clone(), found: found.into(), expected: expected.into() }
    }

    /// The fault of a deck as the program reports it.
    pub fn of(self, deck: &Path) -> CommandFailure {
        let DeckFault { place, found, expected } = self;
        CommandFailure::Usage(format!("{}, {place}: found {found}, expected {expected}", deck.display()))
    }
}

/// A keyword with its data lines.
#[derive(Clone, Debug)]
pub struct Card {
    pub place: DeckPlace,
    /// Name in capitals without the star.
    pub name: String,
    parameters: BTreeMap<String, String>,
    pub data: Vec<DataLine>,
}

/// A data line.
#[derive(Clone, Debug)]
pub struct DataLine {
    pub place: DeckPlace,
    /// The entries, including empty ones.
    pub entries: Vec<String>,
}

impl Card {
    /// The value of a parameter, or `None` if it is missing or empty.
    pub fn parameter(&self, name: &str) -> Option<&str> {
        self.parameters.get(name).map(String::as_str).filter(|value| !value.is_empty())
    }

    /// The value of a parameter in capitals.
    pub fn word(&self, name: &str) -> Option<String> {
        self.parameter(name).map(str::to_uppercase)
    }

    /// The value of a required parameter.
    pub fn required(&self, name: &str) -> Result<&str, DeckFault> {
        self.parameter(name).ok_or_else(|| {
            DeckFault::new(&self.place, format!("*{} without {name}", self.name), format!("*{}, {name}=…", self.name))
        })
    }

    /// True if a parameter is given, with or without a value.
    pub fn has(&self, name: &str) -> bool {
        self.parameters.contains_key(name)
    }

    /// The names of the parameters that are given, in capitals and without spaces.
    pub fn parameters(&self) -> impl Iterator<Item = &str> {
        self.parameters.keys().map(String::as_str)
    }

    /// The first data line.
    pub fn first(&self, expected: &str) -> Result<&DataLine, DeckFault> {
        self.data
            .first()
            .ok_or_else(|| DeckFault::new(&self.place, format!("*{} without a data line", self.name), expected))
    }
}

impl fmt::Display for Card {
    /// Writes the keyword as in a deck.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "*{}", self.name)?;
        for (name, value) in &self.parameters {
            let sign = if value.is_empty() { "" } else { "=" };
            write!(f, ", {name}{sign}{value}")?;
        }
        writeln!(f)?;
        // A line that ends with a comma has an empty last entry.
        self.data.iter().try_for_each(|line| writeln!(f, "{}", line.entries.join(", ").trim_end()))
    }
}

impl DataLine {
    /// An entry, or `None` if it is missing or empty.
    pub fn text(&self, index: usize) -> Option<&str> {
        self.entries.get(index).map(String::as_str).filter(|entry| !entry.is_empty())
    }

    /// A required entry.
    pub fn need(&self, index: usize, expected: &str) -> Result<&str, DeckFault> {
        self.text(index).ok_or_else(|| DeckFault::new(&self.place, format!("\"{}\"", self.whole()), expected))
    }

    /// A finite number, or `None` if the entry is missing or empty.
    pub fn number(&self, index: usize) -> Result<Option<f64>, DeckFault> {
        let Some(text) = self.text(index) else { return Ok(None) };
        // Fortran writes exponents with a D.
        let value = text.to_ascii_lowercase().replace('d', "e").parse::<f64>().ok().filter(|value| value.is_finite());
        value
            .map(Some)
            .ok_or_else(|| DeckFault::new(&self.place, format!("\"{}\"", text.escape_debug()), "a finite number"))
    }

    /// A required number; `expected` describes it.
    pub fn value(&self, index: usize, expected: &str) -> Result<f64, DeckFault> {
        self.number(index)?
            .ok_or_else(|| DeckFault::new(&self.place, format!("\"{}\"", self.whole().escape_debug()), expected))
    }

    /// All numbers of the line, 0 for empty entries.
    pub fn numbers(&self) -> Result<Vec<f64>, DeckFault> {
        (0..self.entries.len()).map(|index| Ok(self.number(index)?.unwrap_or(0.0))).collect()
    }

    /// The line as text, cut off if it is long.
    pub fn whole(&self) -> String {
        self.entries.join(", ").chars().take(60).collect()
    }
}

/// The bytes of a regular file of at most `longest` bytes.
fn bytes(path: &Path, longest: u64) -> io::Result<Vec<u8>> {
    let refused = |message: &str| io::Error::new(io::ErrorKind::InvalidInput, message);
    // A pipe is not opened, because reading it may block.
    if !fs::metadata(path)?.is_file() {
        return Err(refused("found no regular file"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(longest + 1).read_to_end(&mut bytes)?;
    let fits = bytes.len() as u64 <= longest;
    if fits { Ok(bytes) } else { Err(refused("found more than 1 GiB in the deck, expected less")) }
}

/// Reads a deck with all files that it includes.
pub fn read(path: &Path) -> Result<Vec<Card>, CommandFailure> {
    let mut cards = Vec::new();
    let mut open = Vec::new();
    let mut room = LONGEST;
    append(path, None, (&mut open, &mut room), &mut cards)?;
    Ok(cards)
}

/// Appends the keywords of a file; `open` are the files that include it.
fn append(
    path: &Path,
    name: Option<&Rc<str>>,
    (open, room): (&mut Vec<PathBuf>, &mut u64),
    cards: &mut Vec<Card>,
) -> Result<(), CommandFailure> {
    let bytes = bytes(path, *room).map_err(|source| {
        let (doing, path) = ("read", path.to_owned());
        CommandFailure::Output(amontons::output::OutputError::Io { doing, path, source })
    })?;
    *room -= bytes.len() as u64;
    let text = String::from_utf8_lossy(&bytes);
    let folder = path.parent().unwrap_or(Path::new(""));
    open.push(path.to_owned());
    let keywords = inp::keywords(&text)
        .map_err(|fault| amontons::mesh::MeshFileError::In { path: path.to_owned(), fault: Box::new(fault) })?;
    for keyword in keywords {
        let place = |line: usize| DeckPlace { file: name.cloned(), line };
        if keyword.name == "INCLUDE" {
            let file = keyword.required("INPUT")?;
            let inside = folder.join(file);
            if open.contains(&inside) || open.len() > DEEPEST {
                let found = format!("*INCLUDE of \"{}\", which includes this file", file.escape_debug());
                let found = if open.len() > DEEPEST { format!("files included {DEEPEST} deep") } else { found };
                let fault = DeckFault::new(&place(keyword.line), found, "files that end");
                return Err(fault.of(open.first().map_or(path, PathBuf::as_path)));
            }
            append(&inside, Some(&file.into()), (open, room), cards)?;
            continue;
        }
        let line = |&(line, text): &(usize, &str)| DataLine {
            place: place(line),
            entries: text.split(',').map(|entry| entry.trim().trim_matches('"').to_owned()).collect(),
        };
        cards.push(Card {
            place: place(keyword.line),
            data: keyword.data.iter().map(line).collect(),
            name: keyword.name,
            parameters: keyword.parameters,
        });
    }
    open.pop();
    Ok(())
}
