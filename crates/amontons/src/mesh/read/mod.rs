//! Meshes from files: [`read`] takes the format from the extension.
//!
//! | extension | format | regions | sides |
//! |---|---|---|---|
//! | `.msh` | Gmsh 2.x and 4.1, text and binary ([`gmsh`](crate::mesh::gmsh)) | physical groups of dimension d | physical groups of dimension d − 1 |
//! | `.inp` | Abaqus and CalculiX ([`inp`](crate::mesh::inp)) | element sets of the sections | surfaces and node sets |
//! | `.med` | Code_Aster and Salome, versions 2.2 to 4 ([`med`](crate::mesh::med)) | groups of cells of dimension d | groups of cells of dimension d − 1 and of nodes |
//! | `.e`, `.exo`, `.g` | Exodus: Cubit, MOOSE, SIERRA ([`exodus`](crate::mesh::exodus)) | blocks of dimension d | side sets, blocks of dimension d − 1 and node sets |
//! | `.vtu` | VTK unstructured grid ([`vtu`](crate::mesh::vtu)) | cell data `region` | cells of dimension d − 1 with cell data `facet` or `boundary` |
//!
//! d is the highest dimension of the elements present. Elements of dimension below d − 1 are left out, and so are nodes
//! that neither a cell nor a named facet uses: the points of the geometry are often among them. Where no side is named,
//! the whole boundary is the side `boundary`.

mod announced;
mod loose;
mod node_sets;
mod serendipity;

use std::path::{Path, PathBuf};

use super::Mesh;
use crate::machine;
pub(super) use announced::{CHARACTER, NUMBER, Room};
pub(super) use loose::{Kind, Loose, LooseBlock};
pub(super) use node_sets::{FacetOf, NodeSet, facet_with};
pub(super) use serendipity::{complete_data, completed, of_vtk};

/// Longest mesh file in bytes.
const LONGEST: u64 = 4 << 30;

/// Where in a mesh file something was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilePosition {
    /// Line of a text file, from 1.
    Line(usize),
    /// Byte of a binary file, from 0.
    Byte(usize),
    /// Cell of a grid, from 0.
    Cell(usize),
}

impl FilePosition {
    /// The line of a byte of a text.
    pub(super) fn line(text: &[u8], at: usize) -> FilePosition {
        FilePosition::Line(1 + text.iter().take(at).filter(|&&b| b == b'\n').count())
    }
}

impl std::fmt::Display for FilePosition {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FilePosition::Line(line) => write!(f, "line {line}"),
            FilePosition::Byte(byte) => write!(f, "byte {byte}"),
            FilePosition::Cell(cell) => write!(f, "cell {cell}"),
        }
    }
}

/// What is wrong with a mesh file: where, what was found, what was expected, what to try.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MeshFileError {
    /// A fault in the file with this path.
    In {
        /// The file.
        path: PathBuf,
        /// Its fault.
        fault: Box<MeshFileError>,
    },
    /// The file system gave no bytes.
    Unreadable {
        /// What the system said.
        message: String,
    },
    /// Neither of the known extensions.
    Extension {
        /// The extension found, without the dot.
        found: String,
    },
    /// Something else stands where a number, a section or a name belongs.
    Syntax {
        /// Where.
        at: FilePosition,
        /// What stands there.
        found: String,
        /// What belongs there.
        expected: String,
    },
    /// A version of the format that is not read.
    Version {
        /// Where.
        at: FilePosition,
        /// The version.
        found: String,
    },
    /// A count larger than the rest of the file can hold.
    Count {
        /// Where.
        at: FilePosition,
        /// What is counted.
        what: &'static str,
        /// The count.
        found: u64,
        /// How many fit.
        room: u64,
    },
    /// A type of element outside Gmsh's first and second order.
    ElementType {
        /// Where.
        at: FilePosition,
        /// The number of the type.
        found: i64,
    },
    /// A cell or facet of an element type that the library does not have.
    Element {
        /// Where.
        at: FilePosition,
        /// What the format calls it.
        found: String,
        /// The elements of the library.
        known: String,
    },
    /// An element refers to a node that is not in the file.
    UnknownNode {
        /// Where.
        at: FilePosition,
        /// The tag.
        tag: i64,
        /// Number of nodes.
        nodes: usize,
    },
    /// Two nodes with one tag.
    RepeatedNode {
        /// The tag.
        tag: u64,
    },
    /// A coordinate that is no finite number.
    Coordinate {
        /// Where.
        at: FilePosition,
        /// Tag of the node, its number in a grid.
        tag: u64,
        /// The coordinate.
        found: f64,
    },
    /// Elements on an entity that `$Entities` does not list.
    UnknownEntity {
        /// Where.
        at: FilePosition,
        /// Dimension of the entity.
        dim: i64,
        /// Its tag.
        tag: i64,
    },
    /// Cells in more than one physical group: their material would be ambiguous.
    TwoRegions {
        /// Where.
        at: FilePosition,
        /// A region.
        first: String,
        /// Another one.
        second: String,
    },
    /// Cells without a physical group although others have one.
    NoRegion {
        /// Where the first of them is.
        at: FilePosition,
        /// How many.
        found: usize,
        /// Number of cells.
        of: usize,
        /// Dimension of the body.
        dim: usize,
    },
    /// No element of dimension 1 or more.
    Empty {
        /// What there is instead.
        found: String,
    },
    /// A curve or surface that is not straight: not a body.
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
    Partitioned {
        /// Where.
        at: FilePosition,
    },
    /// A grid whose arrays are inconsistent.
    Grid {
        /// What is wrong, with the name of the array.
        message: String,
    },
}

impl MeshFileError {
    /// Where it is in the file.
    #[must_use]
    pub fn at(&self) -> Option<FilePosition> {
        match self {
            MeshFileError::Syntax { at, .. }
            | MeshFileError::Version { at, .. }
            | MeshFileError::Count { at, .. }
            | MeshFileError::ElementType { at, .. }
            | MeshFileError::Element { at, .. }
            | MeshFileError::UnknownNode { at, .. }
            | MeshFileError::Coordinate { at, .. }
            | MeshFileError::UnknownEntity { at, .. }
            | MeshFileError::TwoRegions { at, .. }
            | MeshFileError::NoRegion { at, .. }
            | MeshFileError::Partitioned { at } => Some(*at),
            MeshFileError::In { fault, .. } => fault.at(),
            _ => None,
        }
    }

    /// Whether the file system gave no bytes.
    #[must_use]
    pub fn is_unreadable(&self) -> bool {
        match self {
            MeshFileError::In { fault, .. } => fault.is_unreadable(),
            other => matches!(other, MeshFileError::Unreadable { .. }),
        }
    }

    /// What was found.
    #[must_use]
    pub fn found(&self) -> String {
        match self {
            MeshFileError::In { fault, .. } => fault.found(),
            MeshFileError::Unreadable { message } => format!("cannot be read: {message}"),
            MeshFileError::Extension { found } => format!("the extension is {found:?}"),
            MeshFileError::Grid { message } => message.clone(),
            MeshFileError::Syntax { found, .. } | MeshFileError::Empty { found } => found.clone(),
            MeshFileError::Version { found, .. } => format!("version {found} of the Gmsh format"),
            MeshFileError::Count { what, found, .. } => format!("a count of {found} {what}"),
            MeshFileError::ElementType { found, .. } => format!("element type {found}"),
            MeshFileError::Element { found, .. } => format!("element type {found}"),
            MeshFileError::UnknownNode { tag, .. } => format!("node {tag}"),
            MeshFileError::RepeatedNode { tag } => format!("node tag {tag} twice"),
            MeshFileError::Coordinate { tag, found, .. } => format!("the coordinate {found} of node {tag}"),
            MeshFileError::UnknownEntity { dim, tag, .. } => format!("elements on entity {tag} of dimension {dim}"),
            MeshFileError::TwoRegions { first, second, .. } => format!("cells in the regions {first:?} and {second:?}"),
            MeshFileError::NoRegion { found, of, .. } => format!("{found} of {of} cells without a region"),
            MeshFileError::NotFlat { dim, axis, low, high, .. } => format!(
                "the elements of highest dimension are of dimension {dim}, and {axis} goes from {low:e} to {high:e} on them"
            ),
            MeshFileError::Partitioned { .. } => "a partitioned mesh".to_owned(),
        }
    }

    /// What was expected and what to try, where that does not go without saying.
    #[must_use]
    pub fn expected(&self) -> Option<String> {
        let expected = match self {
            MeshFileError::In { fault, .. } => return fault.expected(),
            MeshFileError::Unreadable { .. } | MeshFileError::Grid { .. } => return None,
            MeshFileError::Extension { .. } => {
                ".msh (Gmsh), .inp (Abaqus, CalculiX), .med (Code_Aster, Salome), .e (Exodus) or .vtu (VTK unstructured grid); meshio converts others: `meshio convert FILE MESH.vtu`"
            }
            MeshFileError::Syntax { expected, .. } => expected,
            MeshFileError::Version { .. } => "2.2 or 4.1; try `gmsh OLD.msh -save -format msh41 -o NEW.msh`",
            MeshFileError::Count { room, .. } => {
                return Some(format!("at most the {room} that the rest of the file can hold; it may be truncated"));
            }
            MeshFileError::ElementType { .. } => "one of Gmsh's types 1 to 19; try Mesh.ElementOrder = 1 or 2",
            MeshFileError::Element { known, .. } => {
                let hint = "try elements of the first order";
                return Some(format!("one of {known}; {hint}"));
            }
            MeshFileError::UnknownNode { nodes, .. } => {
                return Some(format!("the tag of one of the {nodes} nodes of the file"));
            }
            MeshFileError::RepeatedNode { .. } => "each tag once",
            MeshFileError::Coordinate { .. } => "a finite number",
            MeshFileError::UnknownEntity { .. } => "one that $Entities lists",
            MeshFileError::TwoRegions { .. } => "one; try to remove one of the physical groups",
            MeshFileError::NoRegion { dim, .. } => {
                let hint = format!("try a physical group of dimension {dim} for them too, or Mesh.SaveAll = 0");
                return Some(format!("all or none; {hint}"));
            }
            MeshFileError::Empty { .. } => {
                "at least one cell; try to mesh before saving, in Gmsh with a physical group for the body"
            }
            MeshFileError::NotFlat { plane, .. } => {
                let hint = format!("try a physical group for the volume, or to rotate the body into the {plane}");
                return Some(format!("it constant; {hint}"));
            }
            MeshFileError::Partitioned { .. } => "one in one part; try `gmsh FILE.msh -unpartition -save`",
        };
        Some(expected.to_owned())
    }
}

impl std::fmt::Display for MeshFileError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let MeshFileError::In { path, fault } = self {
            return write!(f, "{}: {fault}", path.display());
        }
        let lead = match self {
            MeshFileError::RepeatedNode { .. } | MeshFileError::Empty { .. } => "found ",
            _ => "",
        };
        match self.at() {
            Some(at) => write!(f, "{at}: found {}", self.found())?,
            None => write!(f, "{lead}{}", self.found())?,
        }
        self.expected().map_or(Ok(()), |expected| write!(f, ", expected {expected}"))
    }
}

impl std::error::Error for MeshFileError {}

/// Extensions of the formats that are read, in small letters.
pub const EXTENSIONS: [&str; 7] = ["msh", "inp", "vtu", "med", "e", "exo", "g"];

/// What the elements of a plane mesh say of the direction that they lack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// Plane stress, as CPS3.
    Stress,
    /// Plane strain, as CPE4.
    Strain,
}

/// A mesh from a file, with what else the file has.
#[derive(Clone, Debug)]
pub struct Read {
    /// The mesh.
    pub mesh: Mesh,
    /// What its elements say of the direction that they lack, if they all say the same; none in formats that do not say
    /// it.
    pub plane: Option<Plane>,
    /// What an input file of Abaqus or CalculiX has besides, in its order; empty for other formats.
    pub skipped: Vec<Skipped>,
}

/// Something in a file that is no part of the mesh.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Skipped {
    /// A keyword with its star, or elements of a type.
    pub what: String,
    /// Line of the first of them.
    pub line: usize,
    /// How many there are: keywords, or elements.
    pub count: usize,
}

/// Reads a mesh from a file, its format by the extension.
///
/// The coordinates are taken as they stand; [`Mesh::scaled`] changes their unit. [`Mesh::check`] finds the defects of
/// the whole mesh (inverted cells, facets inside the body), listed by [`defects`](crate::mesh::defects::defects).
///
/// # Errors
/// When the file cannot be read, or is not a mesh of one body: the error names the file, the line or byte, what was
/// found and expected.
pub fn read(path: &Path) -> Result<Mesh, MeshFileError> {
    read_all(path).map(|read| read.mesh)
}

/// The same with what else the file has.
///
/// # Errors
/// Those of [`read`].
pub fn read_all(path: &Path) -> Result<Read, MeshFileError> {
    let inside = |fault| MeshFileError::In { path: path.to_owned(), fault: Box::new(fault) };
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    if !EXTENSIONS.contains(&extension.as_str()) {
        return Err(inside(MeshFileError::Extension { found: extension }));
    }
    let bytes =
        machine::read(path, LONGEST).map_err(|e| inside(MeshFileError::Unreadable { message: e.to_string() }))?;
    parse(&extension, &bytes).map_err(inside)
}

/// Reads a mesh from the bytes of a file with this extension, in small letters.
///
/// # Errors
/// Those of [`read`].
pub fn parse(extension: &str, bytes: &[u8]) -> Result<Read, MeshFileError> {
    let alone = |mesh: Mesh| Read { mesh, plane: None, skipped: Vec::new() };
    match extension {
        "msh" => super::gmsh::parse(bytes).map(alone),
        "inp" => super::inp::parse(bytes),
        "vtu" => super::vtu::parse(bytes).map(alone),
        "med" => super::med::parse(bytes).map(alone),
        "e" | "exo" | "g" => super::exodus::parse(bytes).map(alone),
        _ => Err(MeshFileError::Extension { found: extension.to_owned() }),
    }
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
