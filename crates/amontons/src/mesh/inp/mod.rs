//! Meshes of Abaqus and CalculiX: input files (`.inp`), as documented in the manuals of Abaqus ("Input syntax rules",
//! "Element-based surface definition") and CalculiX CrunchiX ("Input deck format").
//!
//! Read are `*NODE`, `*ELEMENT`, `*NSET` and `*ELSET` with `GENERATE`, `*SURFACE` of faces of elements and of nodes,
//! `*SOLID SECTION`, and parts with their instances. Everything else is skipped and named in
//! [`Read::skipped`](crate::mesh::Read::skipped): materials, loads and steps are those of the case file.
//!
//! - Regions are the element sets of the solid sections; without sections, the sets that the `*ELEMENT` lines name.
//! - Sides are the surfaces, and the node sets that hold all nodes of a facet of the boundary.
//! - With several instances, the sets of a part have the name of the instance and a point in front of theirs.
//! - Names are compared without regard to case, as Abaqus does, and keep the spelling of their first definition.

mod lines;
mod model;
mod sets;
mod solid;

pub use lines::{Keyword, entries, keywords};
pub use solid::{SolidType, face, solid_type};

use super::read::{FilePosition, MeshFileError, Read};

/// Reads a mesh from the bytes of an input file.
///
/// # Errors
/// When the bytes are no mesh of one body; the error names the line.
pub fn parse(bytes: &[u8]) -> Result<Read, MeshFileError> {
    let text = String::from_utf8_lossy(bytes);
    let model = model::Model::of(&keywords(&text)?)?;
    let skipped = model.skipped.clone();
    let (loose, axisymmetric, plane) = sets::loose(model)?;
    let mut mesh = loose.into_mesh(FilePosition::Line)?;
    mesh.axisymmetric = axisymmetric && mesh.dim == 2;
    Ok(Read { mesh, plane, skipped })
}
