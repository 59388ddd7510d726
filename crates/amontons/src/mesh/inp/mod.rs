//! Meshes of Abaqus and CalculiX: input files (`.inp`), as documented in the manuals of Abaqus ("Input syntax rules",
//! "Element-based surface definition") and CalculiX CrunchiX ("Input deck format").
//!
//! Supported are `*NODE`, `*ELEMENT`, `*NSET` and `*ELSET` with `GENERATE`, `*SURFACE` of element faces and of nodes,
//! `*SOLID SECTION`, parts with their instances, and `*INCLUDE`. Everything else is skipped and listed in
//! [`MeshFile::skipped`](crate::mesh::MeshFile::skipped): materials, loads and steps come from the case file.
//!
//! - Regions are the element sets of the solid sections; a later section takes the cells of an earlier one. Without
//!   sections, they are the sets named by `*ELEMENT` lines. In a file of Gmsh, which names these Volume1, Volume2 and
//!   so on, the other element sets come first: they are its physical groups.
//! - Sides are the surfaces, the element sets of shells, membranes and plane elements (in the plane of lines) that are
//!   facets of the boundary, and the node sets that contain all nodes of a facet of the boundary. For equal names the
//!   first kind counts.
//! - With several instances, the names of the sets of a part are prefixed by the instance: `INSTANCE.SET`.
//! - Names are compared without regard to case, as Abaqus does, and keep the spelling of their first definition.
//! - Sets may hold elements that are left out, and nodes and elements that the file lacks: these are skipped, too.

mod include;
mod lines;
mod model;
mod regions;
mod sets;
mod solid;
mod thin;
mod told;

pub use lines::{Keyword, entries, keywords};
pub use solid::{SolidType, solid_type};

use super::read::{FilePosition, Include, MeshFile, MeshFileError};

/// Reads a mesh from the bytes of an input file without included files.
///
/// # Errors
/// Fails if the bytes are no mesh of one body; the error names the line.
pub fn parse(bytes: &[u8]) -> Result<MeshFile, MeshFileError> {
    read("deck.inp", bytes, None)
}

/// Reads a mesh from the bytes of a named input file and of the files that it includes.
pub(super) fn read(name: &str, bytes: &[u8], include: Option<&mut Include>) -> Result<MeshFile, MeshFileError> {
    let whole = include::JoinedText::of(name, bytes, include)?;
    let mut read = of_text(&String::from_utf8_lossy(&whole.bytes)).map_err(|fault| whole.told(fault))?;
    read.skipped = read.skipped.into_iter().map(|skipped| whole.located(skipped)).collect();
    read.whole = whole.includes().then(|| whole.bytes.into());
    Ok(read)
}

fn of_text(text: &str) -> Result<MeshFile, MeshFileError> {
    let mut model = model::InpModel::of(&keywords(text)?)?;
    let skipped = std::mem::take(&mut model.skipped);
    let sets = sets::Sets::of(model)?;
    let loose = sets.loose(skipped)?;
    let (axisymmetric, plane) = (sets.is_of_revolution()?, sets.plane());
    let mut read = loose.into_read(FilePosition::Line)?;
    read.skipped.sort_by_key(|skipped| skipped.line);
    read.mesh.axisymmetric = axisymmetric && read.mesh.dim == 2;
    Ok(MeshFile { plane, ..read })
}
