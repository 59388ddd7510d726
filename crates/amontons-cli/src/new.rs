//! `amontons new`: templates of cases.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use amontons::case;
use amontons::contact::mortar::{Facing, facing};
use amontons::mesh::defects::{Component, components};
use amontons::mesh::{self, FacetSet, Mesh};
use amontons::model::MeshModel;
use amontons::output::OutputError;

use crate::arguments::Template;
use crate::model::figure;
use crate::print;
use crate::status::CommandFailure;

/// Writes a case; an existing file is kept.
pub fn execute(file: &Path, template: Template, mesh: Option<&Path>) -> Result<(), CommandFailure> {
    let (what, text) = match template {
        Template::Starter => ("a starter case", case::STARTER.to_owned()),
        Template::Paper => ("the example of the paper", include_str!("paper.toml").to_owned()),
        Template::Seal => ("a gasket", include_str!("templates/seal.toml").to_owned()),
        Template::Brake => ("a brake pad", include_str!("templates/brake.toml").to_owned()),
        Template::PressFit => ("a press fit", include_str!("templates/press-fit.toml").to_owned()),
        Template::FromMesh => ("a case with the mesh", from_mesh(file, mesh.unwrap_or(Path::new("")))?),
    };
    let failed = |source: io::Error| match source.kind() {
        io::ErrorKind::AlreadyExists => CommandFailure::Exists(file.to_owned()),
        _ => OutputError::Io { doing: "create", path: file.to_owned(), source }.into(),
    };
    let mut out = OpenOptions::new().write(true).create_new(true).open(file).map_err(failed)?;
    out.write_all(text.as_bytes()).map_err(failed)?;
    Ok(print::text(&format!("{}: {what}; run it with: amontons run {}\n", file.display(), file.display()))?)
}

/// A case with the sides and regions of a mesh file: the first side is held, the second is loaded.
fn from_mesh(file: &Path, mesh: &Path) -> Result<String, CommandFailure> {
    let read = mesh::read(mesh)?;
    let model = MeshModel::new(&read);
    let sides: Vec<String> = model.sides.iter().map(|side| quoted(&side.name)).collect();
    let Some((held, others)) = sides.split_first() else {
        let found = format!("{}: found no sides", mesh.display());
        let advice =
            "expected named parts of the boundary; name them in the mesh program, as physical groups or surfaces";
        return Err(CommandFailure::Usage(format!("{found}, {advice}")));
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
    text += &if model.parts > 1 { several(&read) } else { one(held, others, &vector) };
    text += "\n[output]\nevery = 1                            # steps between files for ParaView\n";
    Ok(text)
}

/// Conditions of one body: its first side is held, its second one is loaded.
fn one(held: &str, others: &[String], vector: &dyn Fn(&str) -> String) -> String {
    let mut text = format!("\n[[boundary]]\non = {held}\ndisplacement = {}\n", vector("0"));
    if let Some(loaded) = others.first() {
        text += &format!("\n[[boundary]]\non = {loaded}\ntraction = {}\n", vector("\"-1 MPa\""));
    }
    let touching = others.get(1).or(others.first()).map_or(held, String::as_str);
    text + &format!(
        "\n# Contact with a rigid foundation at a distance `gap`; see the guide for other laws, obstacles and pairs of bodies.\n\
         # [contact]\n# on = {touching}\n# gap = \"10 µm\"\n# normal = {{ law = \"signorini\" }}\n\
         # friction = {{ law = \"coulomb\", coefficient = 0.2 }}\n"
    )
}

/// Conditions of several bodies: bodies that face each other are pairs, the first body is held, and the others are
/// pressed against their neighbours by a thousandth of the total size.
fn several(mesh: &Mesh) -> String {
    let bodies = components(mesh);
    let extent = (0..mesh.dim).map(|d| {
        let along = || mesh.points.iter().map(|x| x[d]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    });
    let size = extent.fold(0.0, f64::max);
    let found = facing(mesh, NEAR * size, &|_, _| true);
    let pairs: Vec<[&String; 2]> =
        found.iter().filter_map(|found| Some([named(mesh, &found.sides[0])?, named(mesh, &found.sides[1])?])).collect();
    let mut text = String::new();
    for (number, body) in bodies.iter().enumerate() {
        let is_of = |set: &FacetSet| set.node_list().iter().all(|node| body.nodes.binary_search(node).is_ok());
        let own = || mesh.facets.iter().filter(|(_, set)| is_of(set)).map(|(name, _)| name);
        // A side of a pair stays free if another side can be held.
        let Some(side) =
            own().find(|name| !pairs.iter().flatten().any(|paired| paired == name)).or_else(|| own().next())
        else {
            text +=
                &format!("\n# Body {} has no side with a name: give it one by [[side]], and hold it.\n", number + 1);
            continue;
        };
        let push = if number == 0 { [0.0; 3] } else { towards(mesh, body, number, &found) };
        let components: Vec<String> = push.iter().take(mesh.dim).map(|c| figure(1e-3 * size * c)).collect();
        let note = if number == 0 { "" } else { "  # a thousandth of the size in the unit of the mesh" };
        text += &format!("\n[[boundary]]\non = {}\ndisplacement = [{}]{note}\n", quoted(side), components.join(", "));
    }
    for [on, with] in &pairs {
        text += &format!(
            "\n[[contact]]\non = {}\nwith = {}\nnormal = {{ law = \"signorini\" }}\nfriction = {{ law = \"coulomb\", coefficient = 0.2 }}\n",
            quoted(on),
            quoted(with)
        );
    }
    if pairs.is_empty() {
        text += "\n# Contact of bodies that are near each other: name two sides, or let them be found.\n\
                 # [contact]\n# automatic = { distance = \"1 mm\" }\n# normal = { law = \"signorini\" }\n";
    }
    text
}

/// The direction along an axis from the middle of a body to the part that faces another one; zero if that part
/// surrounds the body.
fn towards(mesh: &Mesh, body: &Component, number: usize, found: &[Facing]) -> [f64; 3] {
    let own = |facing: &Facing| {
        let sides = facing.bodies.iter().zip(&facing.sides);
        sides.filter(|(of, _)| **of == number).map(|(_, side)| side.node_list()).next()
    };
    let Some(nodes) = found.iter().find_map(own) else { return [0.0; 3] };
    let [whole, part] = [body.bounds(mesh), Component { nodes, cells: 0 }.bounds(mesh)];
    let way: [f64; 3] = std::array::from_fn(|d| 0.5 * (part[0][d] + part[1][d] - whole[0][d] - whole[1][d]));
    let largest = (0..mesh.dim).max_by(|&a, &b| way[a].abs().total_cmp(&way[b].abs())).unwrap_or(0);
    // A shaft in its bore has the same distance on every side.
    let is_one_sided = way[largest].abs() > 0.1 * (whole[1][largest] - whole[0][largest]);
    std::array::from_fn(|d| if is_one_sided && d == largest { way[d].signum() } else { 0.0 })
}

/// Largest distance of facing bodies, relative to the size of a mesh.
const NEAR: f64 = 0.02;

/// The side of a mesh with most of these facets and hardly any others; of two the smaller one.
fn named<'m>(mesh: &'m Mesh, facets: &FacetSet) -> Option<&'m String> {
    let nodes = facets.node_list();
    let inside = |set: &FacetSet| {
        set.facets().filter(|(_, facet)| facet.iter().all(|node| nodes.binary_search(node).is_ok())).count()
    };
    let shared =
        mesh.facets.iter().map(|(name, set)| (name, inside(set), set.len())).filter(|(_, inside, _)| *inside > 0);
    shared.max_by_key(|(_, inside, all)| (*inside, std::cmp::Reverse(*all))).map(|(name, ..)| name)
}

/// The path of the mesh file for the case file: its name alone if it is in the same folder.
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

/// A text in TOML notation.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
