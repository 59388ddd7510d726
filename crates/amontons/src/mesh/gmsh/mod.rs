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
use super::read::{FilePosition, Kind, MeshFile, MeshFileError, completed};
use crate::element;
use crate::quadrature::Shape;

/// Name, dimension and number of nodes of the types 1 to 19.
const KINDS: [(&str, usize, usize); 19] = [
    ("2-node segment", 1, 2),
    ("3-node triangle", 2, 3),
    ("4-node quadrilateral", 2, 4),
    ("4-node tetrahedron", 3, 4),
    ("8-node hexahedron", 3, 8),
    ("6-node prism", 3, 6),
    ("5-node pyramid", 3, 5),
    ("3-node segment", 1, 3),
    ("6-node triangle", 2, 6),
    ("9-node quadrilateral", 2, 9),
    ("10-node tetrahedron", 3, 10),
    ("27-node hexahedron", 3, 27),
    ("18-node prism", 3, 18),
    ("14-node pyramid", 3, 14),
    ("1-node point", 0, 1),
    ("8-node quadrilateral", 2, 8),
    ("20-node hexahedron", 3, 20),
    ("15-node prism", 3, 15),
    ("13-node pyramid", 3, 13),
];

/// The element type with a number.
fn kind(code: i64) -> Option<Kind> {
    let index = usize::try_from(code).ok()?.checked_sub(1)?;
    let &(name, dim, nodes) = KINDS.get(index)?;
    let complete = element::ALL.iter().copied().find(|e| i64::from(e.gmsh) == code && e.nodes.len() == nodes);
    let shape = match code {
        16 => Shape::Quadrilateral,
        17 => Shape::Hexahedron,
        18 => Shape::Prism,
        19 => Shape::Pyramid,
        _ => Shape::Point,
    };
    let element = complete.or_else(|| completed(shape, nodes));
    Some(Kind { name, dim, nodes, element })
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
