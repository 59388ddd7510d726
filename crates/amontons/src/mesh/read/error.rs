//! Errors in mesh files.

use std::path::PathBuf;

/// The supported formats, for messages.
const KNOWN: &str = ".msh (Gmsh), .inp (Abaqus, CalculiX), .med (Code_Aster, Salome), .mail (Code_Aster), .e (Exodus) or .vtu (VTK unstructured grid); meshio converts others: `meshio convert FILE MESH.vtu`";

/// Position of a fault in a mesh file.
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
    /// The line of a byte in a text.
    pub(in crate::mesh) fn line(text: &[u8], at: usize) -> FilePosition {
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

/// A fault of a mesh file: position, value found, value expected, and a hint.
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
    /// The file could not be read.
    Unreadable {
        /// The message of the system.
        message: String,
    },
    /// An unknown extension.
    Extension {
        /// The extension found, without the dot.
        found: String,
    },
    /// Unexpected contents instead of a number, a section or a name.
    Syntax {
        /// The position.
        at: FilePosition,
        /// The contents found.
        found: String,
        /// The contents expected.
        expected: String,
    },
    /// An unsupported version of the format.
    Version {
        /// The position.
        at: FilePosition,
        /// The version.
        found: String,
    },
    /// A count larger than the rest of the file can hold.
    Count {
        /// The position.
        at: FilePosition,
        /// The items counted.
        what: &'static str,
        /// The count.
        found: u64,
        /// The largest number that fits.
        room: u64,
    },
    /// A type of element outside Gmsh's first and second order.
    ElementType {
        /// The position.
        at: FilePosition,
        /// The number of the type.
        found: i64,
    },
    /// A cell or facet of an element type that the library does not have.
    Element {
        /// The position.
        at: FilePosition,
        /// The type's name in the format.
        found: String,
        /// The elements of the library.
        known: String,
    },
    /// An element refers to a node that is not in the file.
    UnknownNode {
        /// The position.
        at: FilePosition,
        /// The tag.
        tag: i64,
        /// Number of nodes.
        nodes: usize,
    },
    /// Two nodes with the same tag.
    RepeatedNode {
        /// The tag.
        tag: u64,
    },
    /// A coordinate that is not finite.
    Coordinate {
        /// The position.
        at: FilePosition,
        /// Tag of the node, or its number in a grid.
        tag: u64,
        /// The coordinate.
        found: f64,
    },
    /// Elements on an entity that `$Entities` does not list.
    UnknownEntity {
        /// The position.
        at: FilePosition,
        /// Dimension of the entity.
        dim: i64,
        /// Its tag.
        tag: i64,
    },
    /// Cells without a physical group although others have one.
    NoRegion {
        /// Position of the first of them.
        at: FilePosition,
        /// Number of these cells.
        found: usize,
        /// Number of cells.
        of: usize,
        /// Dimension of the body.
        dim: usize,
    },
    /// No element of dimension 1 or more.
    Empty {
        /// The contents found instead.
        found: String,
    },
    /// Elements, but none that fill a body.
    NoBody {
        /// Their number and types.
        found: String,
        /// The elements that fill a body in the format.
        expected: &'static str,
    },
    /// A file of another program.
    Foreign {
        /// The kind of file.
        found: &'static str,
        /// A hint how to convert it to a mesh.
        hint: &'static str,
    },
    /// A file that includes another one, but was not read from a folder.
    Include {
        /// The position.
        at: FilePosition,
        /// The name of the included file.
        name: String,
    },
    /// A curve or surface that is not flat: not a body.
    NotFlat {
        /// Dimension of the elements.
        dim: usize,
        /// The coordinate that should be constant.
        axis: char,
        /// Its smallest value.
        low: f64,
        /// Its largest value.
        high: f64,
        /// The plane or line in which the body must lie.
        plane: &'static str,
    },
    /// A grid whose arrays are inconsistent.
    Grid {
        /// The fault, with the name of the array.
        message: String,
    },
}

impl MeshFileError {
    /// Position in the file, if known.
    #[must_use]
    pub fn at(&self) -> Option<FilePosition> {
        match self {
            MeshFileError::In { fault, .. } => fault.at(),
            other => other.clone().own_at().copied(),
        }
    }

    /// The position of a fault in the file itself, not in an included one.
    fn own_at(&mut self) -> Option<&mut FilePosition> {
        match self {
            MeshFileError::Syntax { at, .. }
            | MeshFileError::Version { at, .. }
            | MeshFileError::Count { at, .. }
            | MeshFileError::ElementType { at, .. }
            | MeshFileError::Element { at, .. }
            | MeshFileError::UnknownNode { at, .. }
            | MeshFileError::Coordinate { at, .. }
            | MeshFileError::UnknownEntity { at, .. }
            | MeshFileError::Include { at, .. }
            | MeshFileError::NoRegion { at, .. } => Some(at),
            _ => None,
        }
    }

    /// The text in front of a message: the included file with the fault, if any, and the position in it.
    #[must_use]
    pub fn place(&self) -> String {
        match self {
            MeshFileError::In { path, fault } => format!("{}: {}", path.display(), fault.place()),
            other => other.at().map_or_else(String::new, |at| format!("{at}: ")),
        }
    }

    /// Moves the fault to another line.
    pub(in crate::mesh) fn in_line(mut self, line: usize) -> MeshFileError {
        if let Some(at) = self.own_at() {
            *at = FilePosition::Line(line);
        }
        self
    }

    /// True if the file could not be read.
    #[must_use]
    pub fn is_unreadable(&self) -> bool {
        match self {
            MeshFileError::In { fault, .. } => fault.is_unreadable(),
            other => matches!(other, MeshFileError::Unreadable { .. }),
        }
    }

    /// The value found, for messages.
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
            MeshFileError::NoBody { found, .. } => found.clone(),
            MeshFileError::Foreign { found, .. } => (*found).to_owned(),
            MeshFileError::Include { name, .. } => format!("*INCLUDE of {name:?}, but a text without a folder"),
            MeshFileError::NoRegion { found, of, .. } => format!("{found} of {of} cells without a region"),
            MeshFileError::NotFlat { dim, axis, low, high, .. } => format!(
                "the elements of highest dimension are of dimension {dim}, and {axis} goes from {low:e} to {high:e} on them"
            ),
        }
    }

    /// The value expected and a hint, for messages; `None` if they are obvious.
    #[must_use]
    pub fn expected(&self) -> Option<String> {
        let expected = match self {
            MeshFileError::In { fault, .. } => return fault.expected(),
            MeshFileError::Unreadable { .. } | MeshFileError::Grid { .. } => return None,
            MeshFileError::Extension { .. } => KNOWN,
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
            MeshFileError::NoBody { expected, .. } => expected,
            MeshFileError::Foreign { hint, .. } => hint,
            MeshFileError::Include { .. } => {
                "all nodes and elements in one text; read the file from its folder, or put the contents of the other file in the place of the line"
            }
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
            MeshFileError::RepeatedNode { .. }
            | MeshFileError::Empty { .. }
            | MeshFileError::NoBody { .. }
            | MeshFileError::Foreign { .. } => "found ",
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
