//! Meshes of Gmsh: the formats MSH 2.x and 4.1, text and binary of either byte order, as documented in the Gmsh
//! reference manual (section "Gmsh file formats").
//!
//! Physical groups of the dimension d of the body become regions, those of dimension d − 1 facet sets, both by their
//! name or, without one, by the digits of their tag; groups with the same name are merged. If a dimension has no
//! groups, the tags of the entities are used: `surface-3`, `curve-11`, for dimension d only if there are several, for
//! dimension d − 1 only on the boundary. A cell in several groups belongs to the region of the smallest of them if that
//! lies within the others. A partitioned mesh is read as one: its entities are the original ones, and ghost cells are
//! left out. Sections other than format, names, entities, nodes and elements are skipped.

mod cursor;
mod data;
mod entities;
mod sections;

pub(in crate::mesh) use data::data;

use super::Mesh;
use super::read::{FilePosition, Kind, MeshFile, MeshFileError};
use crate::element::CellType;

/// The element type with a number.
fn kind(code: i64) -> Option<Kind> {
    let (element, cell) = CellType::find(|_, cell| cell.gmsh.is_some_and(|number| i64::from(number) == code))?;
    Some(Kind { name: cell.name, dim: element.dim(), nodes: cell.nodes, element: Some(element) })
}

/// Reads a mesh from the bytes of an MSH file.
///
/// The cells of an entity are turned over if all of them are mirrored, as on a plane surface whose normal is −z; single
/// inverted cells are kept and reported by [`Mesh::check`].
///
/// # Errors
/// Fails if the bytes are no mesh of one body; the error names the line (text) or byte (binary).
pub fn parse(bytes: &[u8]) -> Result<Mesh, MeshFileError> {
    read(bytes).map(|read| read.mesh)
}

/// Reads the mesh and the list of skipped contents.
pub(super) fn read(bytes: &[u8]) -> Result<MeshFile, MeshFileError> {
    let (mut loose, entities, binary) = sections::parse(bytes)?;
    entities::join_copies(&mut loose, &entities);
    entities::name(&mut loose, &entities);
    loose.into_read(|at| if binary { FilePosition::Byte(at) } else { FilePosition::line(bytes, at) })
}
