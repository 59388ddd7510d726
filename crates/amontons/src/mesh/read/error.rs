//! What is wrong with a mesh file.

use std::path::PathBuf;

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
    /// Elements, but none that fill a body.
    NoBody {
        /// Their number and types.
        found: String,
        /// What fills a body in the format.
        expected: &'static str,
    },
    /// A file of another program.
    Foreign {
        /// What it is.
        found: &'static str,
        /// How a mesh is made of it.
        hint: &'static str,
    },
    /// A file that includes another one where there are no files.
    Include {
        /// Where.
        at: FilePosition,
        /// The name of the other one.
        name: String,
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
            | MeshFileError::Include { at, .. }
            | MeshFileError::NoRegion { at, .. } => Some(*at),
            MeshFileError::In { fault, .. } => fault.at(),
            _ => None,
        }
    }

    /// The file with the fault, if it is one that the mesh file includes, and the place in it: what messages put in
    /// front of what was found.
    #[must_use]
    pub fn place(&self) -> String {
        match self {
            MeshFileError::In { path, fault } => format!("{}: {}", path.display(), fault.place()),
            other => other.at().map_or_else(String::new, |at| format!("{at}: ")),
        }
    }

    /// The same fault in another line.
    pub(in crate::mesh) fn in_line(mut self, line: usize) -> MeshFileError {
        match &mut self {
            MeshFileError::Syntax { at, .. }
            | MeshFileError::Version { at, .. }
            | MeshFileError::Count { at, .. }
            | MeshFileError::ElementType { at, .. }
            | MeshFileError::Element { at, .. }
            | MeshFileError::UnknownNode { at, .. }
            | MeshFileError::Coordinate { at, .. }
            | MeshFileError::UnknownEntity { at, .. }
            | MeshFileError::Include { at, .. }
            | MeshFileError::NoRegion { at, .. } => *at = FilePosition::Line(line),
            _ => {}
        }
        self
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
            MeshFileError::NoBody { found, .. } => found.clone(),
            MeshFileError::Foreign { found, .. } => (*found).to_owned(),
            MeshFileError::Include { name, .. } => format!("*INCLUDE of {name:?}, but a text without a folder"),
            MeshFileError::NoRegion { found, of, .. } => format!("{found} of {of} cells without a region"),
            MeshFileError::NotFlat { dim, axis, low, high, .. } => format!(
                "the elements of highest dimension are of dimension {dim}, and {axis} goes from {low:e} to {high:e} on them"
            ),
        }
    }

    /// What was expected and what to try, where that does not go without saying.
    #[must_use]
    pub fn expected(&self) -> Option<String> {
        let expected = match self {
            MeshFileError::In { fault, .. } => return fault.expected(),
            MeshFileError::Unreadable { .. } | MeshFileError::Grid { .. } => return None,
            MeshFileError::Extension { .. } => super::formats::KNOWN,
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
