//! Meshes from files: [`read`] derives the format from the extension, or from unmistakable contents.
//!
//! | extension | format | regions | sides |
//! |---|---|---|---|
//! | `.msh` | Gmsh 2.x and 4.1, text and binary ([`gmsh`]) | physical groups of dimension d, or volumes | physical groups of dimension d − 1, or surfaces |
//! | `.inp` | Abaqus and CalculiX ([`inp`]) | element sets of the sections | surfaces, sets of elements on the boundary, and node sets |
//! | `.med` | Code_Aster and Salome, versions 2.2 to 4 ([`med`]) | groups of cells of dimension d | groups of cells of dimension d − 1 and of nodes |
//! | `.mail` | Code_Aster, as text ([`mail`]) | groups of cells of dimension d | groups of cells of dimension d − 1 and of nodes |
//! | `.e`, `.exo`, `.g` | Exodus: Cubit, MOOSE, SIERRA ([`exodus`]) | blocks of dimension d | side sets, blocks of dimension d − 1 and node sets |
//! | `.vtu` | VTK unstructured grid ([`vtu`]) | cell data `region` | cells of dimension d − 1 with cell data `facet` or `boundary` |
//!
//! d is the highest dimension of the elements present. Elements of dimension below d − 1 are left out, and so are nodes
//! that neither a cell nor a named facet uses, often points of the geometry. If no side is named, the whole boundary is
//! the side `boundary`.

use std::path::Path;
use std::sync::Arc;

use super::read::{Include, MeshFile, MeshFileError};
use super::{Mesh, exodus, gmsh, inp, mail, med, vtu};
use crate::machine;

/// Longest mesh file in bytes.
const LONGEST: u64 = 4 << 30;

/// Extensions of the supported formats, in lower case.
pub const EXTENSIONS: [&str; 8] = ["msh", "inp", "vtu", "med", "mail", "e", "exo", "g"];

/// Number of leading bytes that are inspected: comments may come first.
const HEAD: usize = 1 << 16;

/// A supported format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MeshFormat {
    Gmsh,
    Input,
    Grid,
    Med,
    Mail,
    Exodus,
}

/// Extensions of unsupported files, with the kind of file and a hint how to convert it.
const FOREIGN: [(&[&str], &str, &str); 22] = [
    (&["cdb"], ANSYS, OF_ANSYS),
    (&["unv"], UNIVERSAL, OF_UNIVERSAL),
    (&["stl"], STL, OF_STL),
    (&["obj"], "a surface of Wavefront (OBJ), without cells inside", OF_SURFACE),
    (&["ply", "off"], "a surface of triangles, without cells inside", OF_SURFACE),
    (&["bdf", "nas", "fem"], NASTRAN, OF_NASTRAN),
    (&["k", "key", "dyn"], DYNA, OF_DYNA),
    (&["cgns"], "a CGNS file", BY_MESHIO),
    (&["vtk"], LEGACY, BY_MESHIO),
    (&["pvtu", "vtm", "vtkhdf"], "a VTK file in parts or in HDF5", BY_PARAVIEW),
    (&["xdmf", "xmf"], XDMF, BY_MESHIO),
    (&["step", "stp"], STEP, OF_SHAPE),
    (&["iges", "igs", "brep"], "a shape without a mesh (CAD)", OF_SHAPE),
    (&["geo"], "a script of Gmsh without a mesh", OF_SHAPE),
    (&["mesh", "meshb"], "a mesh of Medit", BY_MESHIO),
    (&["mphtxt", "mphbin"], "a mesh of COMSOL", OF_COMSOL),
    (&["vol"], "a mesh of Netgen", BY_MESHIO),
    (&["su2"], "a mesh of SU2", BY_MESHIO),
    (&["frd"], "results of CalculiX", OF_RESULTS),
    (&["odb"], "results of Abaqus", OF_RESULTS),
    (&["cas"], FLUENT, BY_MESHIO),
    (&["mdpa"], "a mesh of Kratos", BY_MESHIO),
];

const ANSYS: &str = "a mesh of ANSYS Mechanical APDL (CDB)";
const UNIVERSAL: &str = "a universal file of I-deas or Salome (UNV)";
const STL: &str = "a surface of triangles (STL), without cells inside";
const NASTRAN: &str = "a deck of Nastran (bulk data)";
const DYNA: &str = "a deck of LS-DYNA";
const LEGACY: &str = "a legacy file of VTK";
const XDMF: &str = "an XDMF file";
const STEP: &str = "a shape without a mesh (STEP)";
const FLUENT: &str = "a mesh of ANSYS Fluent";
const UCD: &str = "a mesh of AVS (UCD)";

const BY_MESHIO: &str = "a mesh in a format that is read; convert it with meshio: `meshio convert FILE MESH.vtu`, or save it as .msh or .inp";
const BY_PARAVIEW: &str = "one unstructured grid; open it in ParaView and save the data as .vtu";
const OF_ANSYS: &str = "a mesh in a format that is read; write it from ANSYS for Abaqus (.inp), or convert it with Python's mapdl-archive to .vtk and with meshio to .vtu";
const OF_UNIVERSAL: &str = "a mesh in a format that is read; convert it with Gmsh: `gmsh FILE.unv -save -format msh41 -o MESH.msh`, or export .med from Salome";
const OF_SURFACE: &str = "cells that fill a body; mesh the volume inside, in Gmsh with `Merge`, `Surface Loop` and `Volume`, or mesh the CAD shape";
const OF_STL: &str = "cells that fill a body; mesh the volume inside, in Gmsh with `Merge`, `Surface Loop` and `Volume`, or mesh the CAD shape; a rigid obstacle may be a surface: `shape = \"file\"` in [contact.obstacle]";
const OF_NASTRAN: &str =
    "a mesh in a format that is read; convert it with Gmsh: `gmsh FILE.bdf -save -format msh41 -o MESH.msh`";
const OF_DYNA: &str =
    "a mesh in a format that is read; write it from the preprocessor for Abaqus (.inp), LS-PrePost exports it too";
const OF_SHAPE: &str =
    "a mesh; mesh the shape with Gmsh: `gmsh FILE -3 -o MESH.msh`, with physical groups for regions and sides";
const OF_COMSOL: &str =
    "a mesh in a format that is read; export it from COMSOL for Nastran, and convert that with Gmsh";
const OF_RESULTS: &str = "the mesh; read the input file (.inp) of the computation";

impl MeshFormat {
    /// The format of a file with this extension in lower case; unmistakable contents take precedence.
    ///
    /// # Errors
    /// Fails if the format is not supported; the error names the format, if it is known.
    pub fn of(ending: &str, bytes: &[u8]) -> Result<MeshFormat, MeshFileError> {
        let head = bytes.get(..bytes.len().min(HEAD)).unwrap_or_default();
        if let Some((found, hint)) = foreign_contents(ending, head) {
            return Err(MeshFileError::Foreign { found, hint });
        }
        let of_ending = MeshFormat::of_ending(ending);
        // Binary formats report their own faults.
        match (of_ending, MeshFormat::of_contents(head)) {
            (Some(MeshFormat::Gmsh | MeshFormat::Input) | None, Some(format)) => Ok(format),
            (Some(format), _) => Ok(format),
            (None, None) => Err(unknown(ending)),
        }
    }

    /// The format of an extension in lower case.
    pub fn of_ending(ending: &str) -> Option<MeshFormat> {
        Some(match ending {
            "msh" => MeshFormat::Gmsh,
            "inp" => MeshFormat::Input,
            "vtu" => MeshFormat::Grid,
            "med" => MeshFormat::Med,
            "mail" => MeshFormat::Mail,
            "e" | "exo" | "g" => MeshFormat::Exodus,
            _ => return None,
        })
    }

    /// The format of a text with unmistakable contents.
    fn of_contents(head: &[u8]) -> Option<MeshFormat> {
        if head.starts_with(b"$MeshFormat") {
            return Some(MeshFormat::Gmsh);
        }
        is_deck(head).then_some(MeshFormat::Input)
    }
}

/// The error for an unsupported extension.
fn unknown(ending: &str) -> MeshFileError {
    let named = FOREIGN.iter().find(|(endings, ..)| endings.contains(&ending));
    match named {
        Some((_, found, hint)) => MeshFileError::Foreign { found, hint },
        None => MeshFileError::Extension { found: ending.to_owned() },
    }
}

/// True if a text is a deck of Abaqus or CalculiX: its first line is a comment or keyword, and it has nodes, elements
/// with a type, or includes a file.
fn is_deck(head: &[u8]) -> bool {
    let mut lines = lines(head);
    let Some(first) = lines.clone().next() else { return false };
    first.starts_with(b"*")
        && lines.any(|line| {
            let line = line.to_ascii_uppercase();
            let has = |word: &[u8]| line.windows(word.len()).any(|part| part == word);
            (line.starts_with(b"*ELEMENT") && has(b"TYPE=") || line.starts_with(b"*INCLUDE") && has(b"INPUT="))
                || line.split(|byte| *byte == b',').next().is_some_and(|name| name.trim_ascii() == b"*NODE")
                    && !is_dyna(head)
        })
}

/// True if a text is a deck of LS-DYNA, whose keywords also begin with stars.
fn is_dyna(head: &[u8]) -> bool {
    lines(head).any(|line| {
        let line = line.to_ascii_uppercase();
        line.starts_with(b"*KEYWORD") || line.starts_with(b"*ELEMENT_")
    })
}

/// The nonempty lines without surrounding blanks.
fn lines(head: &[u8]) -> impl Iterator<Item = &[u8]> + Clone {
    head.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty())
}

/// The kind of a foreign file recognized by its first bytes, with a hint, regardless of its extension.
fn foreign_contents(ending: &str, head: &[u8]) -> Option<(&'static str, &'static str)> {
    let first = lines(head).next().unwrap_or_default().to_ascii_uppercase();
    let begins = |words: &[&str]| words.iter().any(|word| first.starts_with(word.as_bytes()));
    let line = |words: &[&str]| {
        lines(head).any(|line| {
            let line = line.to_ascii_uppercase();
            words.iter().any(|word| line.starts_with(word.as_bytes()))
        })
    };
    if begins(&["# VTK DATAFILE"]) {
        return Some((LEGACY, BY_MESHIO));
    }
    if begins(&["ISO-10303-21"]) {
        return Some((STEP, OF_SHAPE));
    }
    if begins(&["SOLID "]) && line(&["FACET NORMAL"]) {
        return Some((STL, OF_STL));
    }
    if begins(&["/COM", "/PREP7", "/NOPR", "/BATCH"]) {
        return Some((ANSYS, OF_ANSYS));
    }
    if begins(&["-1"]) && lines(head).nth(1).is_some_and(|line| matches!(line, b"151" | b"164" | b"2411" | b"2420")) {
        return Some((UNIVERSAL, OF_UNIVERSAL));
    }
    if begins(&["(0 ", "(1 ", "(2 "]) {
        return Some((FLUENT, BY_MESHIO));
    }
    if head.starts_with(b"<") && line(&["<XDMF"]) {
        return Some((XDMF, BY_MESHIO));
    }
    if begins(&["*", "$#", "$ "]) && is_dyna(head) {
        return Some((DYNA, OF_DYNA));
    }
    let is_deck_ending = matches!(ending, "inp" | "dat" | "txt" | "bdf" | "nas");
    if is_deck_ending && !begins(&["*"]) && line(&["BEGIN BULK", "GRID ", "GRID,", "GRID*"]) {
        return Some((NASTRAN, OF_NASTRAN));
    }
    let first = first.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).collect::<Vec<_>>();
    if ending == "inp" && first.len() == 5 && first.iter().all(|word| word.iter().all(u8::is_ascii_digit)) {
        return Some((UCD, BY_MESHIO));
    }
    None
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
        MeshFormat::Gmsh => gmsh::read(bytes),
        MeshFormat::Input => inp::read(name, bytes, include),
        MeshFormat::Grid => vtu::read(bytes),
        MeshFormat::Med => med::read(bytes),
        MeshFormat::Mail => mail::read(bytes),
        MeshFormat::Exodus => exodus::read(bytes),
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
