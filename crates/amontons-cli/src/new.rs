//! `amontons new`: cases to start from.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use amontons::case;
use amontons::mesh;
use amontons::model::MeshModel;
use amontons::output::OutputError;

use crate::arguments::Template;
use crate::model::figure;
use crate::print;
use crate::status::Failure;

/// Writes a case; a file that is there is kept.
pub fn execute(file: &Path, template: Template, mesh: Option<&Path>) -> Result<(), Failure> {
    let (what, text) = match template {
        Template::Starter => ("a starter case", case::STARTER.to_owned()),
        Template::Paper => ("the example of the paper", include_str!("paper.toml").to_owned()),
        Template::Seal => ("a gasket", include_str!("templates/seal.toml").to_owned()),
        Template::Brake => ("a brake pad", include_str!("templates/brake.toml").to_owned()),
        Template::PressFit => ("a press fit", include_str!("templates/press-fit.toml").to_owned()),
        Template::FromMesh => ("a case with the mesh", from_mesh(file, mesh.unwrap_or(Path::new("")))?),
    };
    let failed = |source: io::Error| match source.kind() {
        io::ErrorKind::AlreadyExists => Failure::Exists(file.to_owned()),
        _ => OutputError::Io { doing: "create", path: file.to_owned(), source }.into(),
    };
    let mut out = OpenOptions::new().write(true).create_new(true).open(file).map_err(failed)?;
    out.write_all(text.as_bytes()).map_err(failed)?;
    Ok(print::text(&format!("{}: {what}; run it with: amontons run {}\n", file.display(), file.display()))?)
}

/// A case with the sides and regions of a mesh file: the first side is held, the second is loaded.
fn from_mesh(file: &Path, mesh: &Path) -> Result<String, Failure> {
    let model = MeshModel::new(&mesh::read(mesh)?);
    let sides: Vec<String> = model.sides.iter().map(|side| quoted(&side.name)).collect();
    let Some((held, others)) = sides.split_first() else {
        let found = format!("{}: found no sides", mesh.display());
        let advice =
            "expected named parts of the boundary; name them in the mesh program, as physical groups or surfaces";
        return Err(Failure::Usage(format!("{found}, {advice}")));
    };
    let extents = |d: usize| model.bounds[1].get(d).unwrap_or(&0.0) - model.bounds[0].get(d).unwrap_or(&0.0);
    let size: Vec<String> = (0..model.dimension).map(|d| figure(extents(d))).collect();
    let vector = |last: &str| {
        let mut components = vec!["0"; model.dimension.saturating_sub(1)];
        components.push(last);
        format!("[{}]", components.join(", "))
    };
    let name = file.file_stem().map_or_else(|| "case".into(), |stem| stem.to_string_lossy());
    let mut text = format!(
        "name = {}\n\n[mesh]                               # sides: {}\nfile = {}\nscale = 1.0                          # to m; \
         the mesh is {} in its unit: 0.001 if that is mm\n",
        quoted(&name),
        sides.join(", "),
        quoted(&beside(file, mesh).to_string_lossy()),
        size.join(" × "),
    );
    if model.axisymmetric {
        text += "axisymmetric = true\n";
    }
    text += "\n[time]\nend = \"1 s\"\nsteps = 10\n\n[material]\nbase = \"steel-s235\"                  # `amontons \
             materials` lists others; or give density, elasticity, …\ndensity = 0                          # without inertia\n";
    if model.dimension == 2 && !model.axisymmetric {
        text += "stress_state = \"plane-strain\"        # or plane-stress: a thin sheet\n";
    }
    for region in model.regions.iter().skip(1) {
        text += &format!(
            "\n[[region]]\non = {}\nmaterial = {{ base = \"steel-s235\", density = 0{} }}\n",
            quoted(&region.name),
            if model.dimension == 2 && !model.axisymmetric { ", stress_state = \"plane-strain\"" } else { "" },
        );
    }
    text += &format!("\n[[boundary]]\non = {held}\ndisplacement = {}\n", vector("0"));
    if let Some(loaded) = others.first() {
        text += &format!("\n[[boundary]]\non = {loaded}\ntraction = {}\n", vector("\"-1 MPa\""));
    }
    let touching = others.get(1).or(others.first()).unwrap_or(held);
    text += &format!(
        "\n# Contact with a rigid foundation at a distance `gap`; see the guide for other laws, obstacles and pairs of bodies.\n\
         # [contact]\n# on = {touching}\n# gap = \"10 µm\"\n# normal = {{ law = \"signorini\" }}\n\
         # friction = {{ law = \"coulomb\", coefficient = 0.2 }}\n\n[output]\nevery = 1                            # steps \
         between files for ParaView\n"
    );
    Ok(text)
}

/// The mesh file as the case file has to name it: a file beside it by its name.
pub fn beside(case: &Path, mesh: &Path) -> PathBuf {
    let folder = |file: &Path| {
        let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        parent.canonicalize().ok()
    };
    match (mesh.file_name(), folder(case), folder(mesh)) {
        (Some(name), Some(one), Some(other)) if one == other => name.into(),
        (Some(name), _, Some(folder)) => folder.join(name),
        _ => mesh.to_owned(),
    }
}

/// A text as TOML writes it.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
