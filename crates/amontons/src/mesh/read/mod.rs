//! Meshes from files: [`read`] derives the format from the extension, or from unmistakable contents.
//!
//! | extension | format | regions | sides |
//! |---|---|---|---|
//! | `.msh` | Gmsh 2.x and 4.1, text and binary ([`gmsh`](crate::mesh::gmsh)) | physical groups of dimension d, or volumes | physical groups of dimension d − 1, or surfaces |
//! | `.inp` | Abaqus and CalculiX ([`inp`](crate::mesh::inp)) | element sets of the sections | surfaces, sets of elements on the boundary, and node sets |
//! | `.med` | Code_Aster and Salome, versions 2.2 to 4 ([`med`](crate::mesh::med)) | groups of cells of dimension d | groups of cells of dimension d − 1 and of nodes |
//! | `.mail` | Code_Aster, as text ([`mail`](crate::mesh::mail)) | groups of cells of dimension d | groups of cells of dimension d − 1 and of nodes |
//! | `.e`, `.exo`, `.g` | Exodus: Cubit, MOOSE, SIERRA ([`exodus`](crate::mesh::exodus)) | blocks of dimension d | side sets, blocks of dimension d − 1 and node sets |
//! | `.vtu` | VTK unstructured grid ([`vtu`](crate::mesh::vtu)) | cell data `region` | cells of dimension d − 1 with cell data `facet` or `boundary` |
//!
//! d is the highest dimension of the elements present. Elements of dimension below d − 1 are left out, and so are nodes
//! that neither a cell nor a named facet uses, often points of the geometry. If no side is named, the whole boundary is
//! the side `boundary`.

mod announced;
mod error;
mod formats;
mod loose;
mod node_sets;
mod overlap;
mod serendipity;

use std::path::Path;
use std::sync::Arc;

use super::Mesh;
use crate::machine;
pub(super) use announced::{CHARACTER, NUMBER, Room};
pub use error::{FilePosition, MeshFileError};
use formats::MeshFormat;
pub(super) use loose::{Kind, Loose, LooseBlock};
pub(super) use node_sets::{FacetOf, NodeSet};
pub(super) use serendipity::complete_data;

/// Longest mesh file in bytes.
const LONGEST: u64 = 4 << 30;

/// Extensions of the supported formats, in lower case.
pub const EXTENSIONS: [&str; 8] = ["msh", "inp", "vtu", "med", "mail", "e", "exo", "g"];

/// Plane state given by the elements of a plane mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaneState {
    /// Plane stress, as CPS3.
    Stress,
    /// Plane strain, as CPE4.
    Strain,
}

/// A mesh from a file, with the skipped contents of the file.
#[derive(Clone, Debug)]
pub struct MeshFile {
    /// The mesh.
    pub mesh: Mesh,
    /// Plane state, if all elements agree on it; `None` in formats without one.
    pub plane: Option<PlaneState>,
    /// Skipped contents of the file, in order.
    pub skipped: Vec<Skipped>,
    /// The text of an input file with its includes inserted; `None` if it includes no file.
    pub whole: Option<Arc<[u8]>>,
}

/// Contents of a file that are no part of the mesh.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Skipped {
    /// A keyword with its star, elements of a type, or sets with their names.
    pub what: String,
    /// The included file with the contents; `None` for the mesh file itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Line of the first occurrence, in formats with lines.
    pub line: Option<usize>,
    /// Number of keywords or elements.
    pub count: usize,
}

impl Skipped {
    /// The first few skipped items in one line; `None` if nothing was skipped.
    #[must_use]
    pub fn in_one_line(all: &[Skipped]) -> Option<String> {
        const SHOWN: usize = 4;
        let word = |skipped: &Skipped| match skipped.count {
            1 => skipped.what.clone(),
            count => format!("{} ({count})", skipped.what),
        };
        let shown: Vec<String> = all.iter().take(SHOWN).map(word).collect();
        let more = all.len().saturating_sub(SHOWN);
        let rest =
            if more > 0 { format!("; and {more} more, which `amontons mesh FILE` lists") } else { String::new() };
        (!all.is_empty()).then(|| format!("{}{rest}", shown.join("; ")))
    }
}

/// The first few names in quotes.
pub(super) fn listed<'n>(names: impl Iterator<Item = &'n String>) -> String {
    const SHOWN: usize = 6;
    let mut names = names.map(|name| format!("{name:?}"));
    let mut text = names.by_ref().take(SHOWN).collect::<Vec<_>>().join(", ");
    let more = names.count();
    if more > 0 {
        text += &format!(" and {more} more");
    }
    text
}

/// Reads a mesh from a file in the format of its extension, or of unmistakable contents.
///
/// The coordinates are not converted; [`Mesh::scaled`] changes their unit. [`Mesh::check`] finds the defects of the
/// whole mesh (inverted cells, facets inside the body), listed by [`defects`](crate::mesh::defects::defects).
///
/// # Errors
/// Fails if the file cannot be read, or is not a mesh of one body: the error names the file, the line or byte, what was
/// found and expected.
pub fn read(path: &Path) -> Result<Mesh, MeshFileError> {
    read_all(path).map(|read| read.mesh)
}

/// Like [`read`], but also returns the skipped contents of the file.
///
/// # Errors
/// Fails like [`read`].
pub fn read_all(path: &Path) -> Result<MeshFile, MeshFileError> {
    read_from(path, false)
}

/// Like [`read_all`], but allows only included files in the same folder or below.
///
/// # Errors
/// Fails like [`read`], and if a file elsewhere is included.
pub fn read_confined(path: &Path) -> Result<MeshFile, MeshFileError> {
    read_from(path, true)
}

fn read_from(path: &Path, confined: bool) -> Result<MeshFile, MeshFileError> {
    let inside = |fault| MeshFileError::In { path: path.to_owned(), fault: Box::new(fault) };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let bytes = machine::read(path, LONGEST).map_err(|e| inside(MeshFileError::Unreadable { message: e.to_string() }));
    let bytes = match bytes {
        Ok(bytes) => bytes,
        // For a missing file, too, a wrong extension is reported first.
        Err(unreadable) => return Err(MeshFormat::of(&ending(&name), b"").err().map_or(unreadable, inside)),
    };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut include = |name: &str| {
        let other = folder.join(name);
        if confined && !machine::is_inside(folder, &other) {
            return Err("which is not in the folder of the mesh file: --confine allows no other".to_owned());
        }
        machine::read(&other, LONGEST).map(Arc::from).map_err(|error| format!("which cannot be read: {error}"))
    };
    parse_file(&name, &bytes, Some(&mut include)).map_err(inside)
}

/// Returns the bytes of an included file, whose name has the same base folder as that of the mesh file; or the reason
/// why it is not available, as the end of a message.
pub type Include<'a> = dyn FnMut(&str) -> Result<Arc<[u8]>, String> + 'a;

/// Reads a mesh from the bytes of a file with this extension in lower case, without included files.
///
/// # Errors
/// Fails like [`read`].
pub fn parse(extension: &str, bytes: &[u8]) -> Result<MeshFile, MeshFileError> {
    parse_file(&format!("file.{extension}"), bytes, None)
}

/// Reads a mesh from the bytes of a named file and of the files that it includes.
///
/// # Errors
/// Fails like [`read`].
pub fn parse_file(name: &str, bytes: &[u8], include: Option<&mut Include>) -> Result<MeshFile, MeshFileError> {
    match MeshFormat::of(&ending(name), bytes)? {
        MeshFormat::Gmsh => super::gmsh::read(bytes),
        MeshFormat::Input => super::inp::read(name, bytes, include),
        MeshFormat::Grid => super::vtu::read(bytes),
        MeshFormat::Med => super::med::read(bytes),
        MeshFormat::Mail => super::mail::read(bytes),
        MeshFormat::Exodus => super::exodus::read(bytes),
    }
}

/// The extension of a file name, in lower case, without the dot.
fn ending(name: &str) -> String {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.rsplit_once('.').map_or_else(String::new, |(_, ending)| ending.to_ascii_lowercase())
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
