//! Meshes from files: [`read`] takes the format from the extension.
//!
//! | extension | format | regions | sides |
//! |---|---|---|---|
//! | `.msh` | Gmsh 2.x and 4.1, text and binary ([`gmsh`](crate::mesh::gmsh)) | physical groups of dimension d | physical groups of dimension d − 1 |
//! | `.vtu` | VTK unstructured grid ([`vtu`](crate::mesh::vtu)) | cell data `region` | cells of dimension d − 1 with cell data `facet` or `boundary` |
//!
//! d is the highest dimension of the elements present. Elements of dimension below d − 1 are left out, and so are nodes
//! that neither a cell nor a named facet uses: the points of the geometry are often among them. Where no side is named,
//! the whole boundary is the side `boundary`.

mod loose;

use std::path::{Path, PathBuf};

use super::Mesh;
use crate::machine;
pub(super) use loose::{Kind, Loose, LooseBlock};

/// Longest mesh file in bytes.
const LONGEST: u64 = 4 << 30;

/// Where in a mesh file something was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Line of a text file, from 1.
    Line(usize),
    /// Byte of a binary file, from 0.
    Byte(usize),
    /// Cell of a grid, from 0.
    Cell(usize),
}

impl Place {
    /// The line of a byte of a text.
    pub(super) fn line(text: &[u8], at: usize) -> Place {
        Place::Line(1 + text.iter().take(at).filter(|&&b| b == b'\n').count())
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Place::Line(line) => write!(f, "line {line}"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
            Place::Cell(cell) => write!(f, "cell {cell}"),
        }
    }
}

/// What is wrong with a mesh file: where, what was found, what was expected, what to try.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFileError {
    /// A fault in the file with this path.
    #[error("{}: {fault}", path.display())]
    In {
        /// The file.
        path: PathBuf,
        /// Its fault.
        fault: Box<MeshFileError>,
    },
    /// The file system gave no bytes.
    #[error("cannot be read: {message}")]
    Unreadable {
        /// What the system said.
        message: String,
    },
    /// Neither of the known extensions.
    #[error("the extension is {found:?}, expected .msh (Gmsh) or .vtu (VTK unstructured grid)")]
    Extension {
        /// The extension found, without the dot.
        found: String,
    },
    /// Something else stands where a number, a section or a name belongs.
    #[error("{at}: found {found}, expected {expected}")]
    Syntax {
        /// Where.
        at: Place,
        /// What stands there.
        found: String,
        /// What belongs there.
        expected: String,
    },
    /// A version of the format that is not read.
    #[error(
        "{at}: found version {found} of the Gmsh format, expected 2.2 or 4.1; try `gmsh OLD.msh -save -format msh41 -o NEW.msh`"
    )]
    Version {
        /// Where.
        at: Place,
        /// The version.
        found: String,
    },
    /// A count larger than the rest of the file can hold.
    #[error(
        "{at}: found a count of {found} {what}, expected at most the {room} that the rest of the file can hold; it may be truncated"
    )]
    Count {
        /// Where.
        at: Place,
        /// What is counted.
        what: &'static str,
        /// The count.
        found: u64,
        /// How many fit.
        room: u64,
    },
    /// A type of element outside Gmsh's first and second order.
    #[error("{at}: found element type {found}, expected one of Gmsh's types 1 to 19; try Mesh.ElementOrder = 1 or 2")]
    ElementType {
        /// Where.
        at: Place,
        /// The number of the type.
        found: i64,
    },
    /// A cell or facet of an element type that the library does not have.
    #[error(
        "{at}: found element type {found}, expected one of {known}; try the first order or, for the second, change Mesh.SecondOrderIncomplete"
    )]
    Element {
        /// Where.
        at: Place,
        /// What the format calls it.
        found: String,
        /// The elements of the library.
        known: String,
    },
    /// An element refers to a node that is not in the file.
    #[error("{at}: found node {tag}, expected the tag of one of the {nodes} nodes of the file")]
    UnknownNode {
        /// Where.
        at: Place,
        /// The tag.
        tag: i64,
        /// Number of nodes.
        nodes: usize,
    },
    /// Two nodes with one tag.
    #[error("found node tag {tag} twice, expected each tag once")]
    RepeatedNode {
        /// The tag.
        tag: u64,
    },
    /// A coordinate that is no finite number.
    #[error("{at}: found the coordinate {found} of node {tag}, expected a finite number")]
    Coordinate {
        /// Where.
        at: Place,
        /// Tag of the node, its number in a grid.
        tag: u64,
        /// The coordinate.
        found: f64,
    },
    /// Elements on an entity that `$Entities` does not list.
    #[error("{at}: found elements on entity {tag} of dimension {dim}, expected one that $Entities lists")]
    UnknownEntity {
        /// Where.
        at: Place,
        /// Dimension of the entity.
        dim: i64,
        /// Its tag.
        tag: i64,
    },
    /// Cells in more than one physical group: their material would be ambiguous.
    #[error(
        "{at}: found cells in the regions {first:?} and {second:?}, expected one; try to remove one of the physical groups"
    )]
    TwoRegions {
        /// Where.
        at: Place,
        /// A region.
        first: String,
        /// Another one.
        second: String,
    },
    /// Cells without a physical group although others have one.
    #[error(
        "{at}: found {found} of {of} cells without a region, expected all or none; try a physical group of dimension {dim} for them too, or Mesh.SaveAll = 0"
    )]
    NoRegion {
        /// Where the first of them is.
        at: Place,
        /// How many.
        found: usize,
        /// Number of cells.
        of: usize,
        /// Dimension of the body.
        dim: usize,
    },
    /// No element of dimension 1 or more.
    #[error(
        "found {found}, expected at least one cell; try to mesh before saving, and to give the body a physical group"
    )]
    Empty {
        /// What there is instead.
        found: String,
    },
    /// A curve or surface that is not straight: not a body.
    #[error(
        "the elements of highest dimension are of dimension {dim}, and {axis} goes from {low:e} to {high:e} on them, expected it constant; try a physical group for the volume, or to rotate the body into the {plane}"
    )]
    NotFlat {
        /// Dimension of the elements.
        dim: usize,
        /// The coordinate that should be constant.
        axis: char,
        /// Its smallest value.
        low: f64,
        /// Its largest value.
        high: f64,
        /// Where the body belongs.
        plane: &'static str,
    },
    /// A mesh in parts.
    #[error("{at}: found a partitioned mesh, expected one in one part; try `gmsh FILE.msh -unpartition -save`")]
    Partitioned {
        /// Where.
        at: Place,
    },
    /// A grid whose arrays are inconsistent.
    #[error("{message}")]
    Grid {
        /// What was found and expected, with the name of the array.
        message: String,
    },
}

/// Reads a mesh from a file, Gmsh or VTK by its extension.
///
/// The coordinates are taken as they stand; [`Mesh::scaled`] changes their unit. [`Mesh::check`] finds the defects of
/// the whole mesh (inverted cells, facets inside the body), listed by [`defects`](crate::mesh::defects::defects).
///
/// # Errors
/// When the file cannot be read, or is not a mesh of one body: the error names the file, the line or byte, what was
/// found and expected.
pub fn read(path: &Path) -> Result<Mesh, MeshFileError> {
    let inside = |fault| MeshFileError::In { path: path.to_owned(), fault: Box::new(fault) };
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let parse = match extension.as_str() {
        "msh" => super::gmsh::parse,
        "vtu" => super::vtu::parse,
        _ => return Err(inside(MeshFileError::Extension { found: extension })),
    };
    let bytes =
        machine::read(path, LONGEST).map_err(|e| inside(MeshFileError::Unreadable { message: e.to_string() }))?;
    parse(&bytes).map_err(inside)
}

impl Mesh {
    /// The mesh with all coordinates multiplied by a positive factor: 1e-3 turns a file in mm into m.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Mesh {
        for point in &mut self.points {
            *point = point.map(|x| x * factor);
        }
        self
    }
}
