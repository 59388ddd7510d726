//! Meshes from files: [`read`] takes the format from the extension, or from contents that are unmistakable.
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
//! that neither a cell nor a named facet uses: the points of the geometry are often among them. Where no side is named,
//! the whole boundary is the side `boundary`.

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
use formats::Format;
pub(super) use loose::{Kind, Loose, LooseBlock};
pub(super) use node_sets::{FacetOf, NodeSet, facet_with};
pub(super) use serendipity::{complete_data, completed, of_vtk};

/// Longest mesh file in bytes.
const LONGEST: u64 = 4 << 30;

/// Extensions of the formats that are read, in small letters.
pub const EXTENSIONS: [&str; 8] = ["msh", "inp", "vtu", "med", "mail", "e", "exo", "g"];

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
    /// What the file has besides, in its order.
    pub skipped: Vec<Skipped>,
    /// The text of an input file with those that it includes in their places, if it includes any.
    pub whole: Option<Arc<[u8]>>,
}

/// Something in a file that is no part of the mesh.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Skipped {
    /// A keyword with its star, elements of a type, or sets by their names.
    pub what: String,
    /// The file that the mesh file includes and that has it; none for the mesh file itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Line of the first of them, in a format with lines.
    pub line: Option<usize>,
    /// How many there are: keywords, or elements.
    pub count: usize,
}

impl Skipped {
    /// What was skipped in one line, the first few of many; none where nothing was.
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

/// Names in quotes, the first few of many.
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

/// Reads a mesh from a file, its format by the extension, or by its contents where they are unmistakable.
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
    read_from(path, false)
}

/// The same where the file may include none but those in its folder and below it.
///
/// # Errors
/// Those of [`read`], and one that names a file elsewhere.
pub fn read_confined(path: &Path) -> Result<Read, MeshFileError> {
    read_from(path, true)
}

fn read_from(path: &Path, confined: bool) -> Result<Read, MeshFileError> {
    let inside = |fault| MeshFileError::In { path: path.to_owned(), fault: Box::new(fault) };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let bytes = machine::read(path, LONGEST).map_err(|e| inside(MeshFileError::Unreadable { message: e.to_string() }));
    let bytes = match bytes {
        Ok(bytes) => bytes,
        // Of a file that is not there, too, the ending is told first.
        Err(unreadable) => return Err(Format::of(&ending(&name), b"").err().map_or(unreadable, inside)),
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

/// Gives the bytes of a file that a mesh file includes, by its name as it is seen from where that of the mesh file is
/// seen; or the reason why there are none, to follow the name in a message.
pub type Include<'a> = dyn FnMut(&str) -> Result<Arc<[u8]>, String> + 'a;

/// Reads a mesh from the bytes of a file with this extension, in small letters. It may include no other file.
///
/// # Errors
/// Those of [`read`].
pub fn parse(extension: &str, bytes: &[u8]) -> Result<Read, MeshFileError> {
    parse_file(&format!("file.{extension}"), bytes, None)
}

/// Reads a mesh from the bytes of a file of this name, and of those that it includes.
///
/// # Errors
/// Those of [`read`].
pub fn parse_file(name: &str, bytes: &[u8], include: Option<&mut Include>) -> Result<Read, MeshFileError> {
    match Format::of(&ending(name), bytes)? {
        Format::Gmsh => super::gmsh::read(bytes),
        Format::Input => super::inp::read(name, bytes, include),
        Format::Grid => super::vtu::read(bytes),
        Format::Med => super::med::read(bytes),
        Format::Mail => super::mail::read(bytes),
        Format::Exodus => super::exodus::read(bytes),
    }
}

/// The ending of the name of a file, in small letters, without the dot.
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
