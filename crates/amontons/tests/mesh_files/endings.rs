//! Files under another ending than that of their format, and files of other programs.

use amontons::mesh::{self, MeshFileError};

use super::decks::regions;

const DECK: &str = "** a deck\n*NODE\n1,0,0\n2,1,0\n3,0,1\n*ELEMENT, TYPE=CPS3, ELSET=E\n1,1,2,3\n";

fn refusal(name: &str, text: &str) -> String {
    match mesh::parse_file(name, text.as_bytes(), None) {
        Ok(_) => panic!("{name} is read"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn decks_are_known_by_their_contents() {
    for name in ["a.dat", "a.msh", "a.ccx", "a.txt", "a", "A.INP", "a.b/c"] {
        let read = mesh::parse_file(name, DECK.as_bytes(), None).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(regions(&read.mesh), [("E", 0.5)], "{name}");
    }
    let gmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n1 2 2 0 1 1 2 3\n$EndElements\n";
    for name in ["a.msh", "a.gmsh", "a.inp"] {
        let read = mesh::parse_file(name, gmsh.as_bytes(), None).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(regions(&read.mesh), [("body", 0.5)], "{name}");
    }
    // A text with stars is not yet a deck.
    assert!(refusal("a.txt", "* a list\n* of things\n").starts_with("the extension is \"txt\""));
    assert!(refusal("a.dat", "1 2 3\n").starts_with("the extension is \"dat\", expected .msh (Gmsh), .inp"));
}

/// What a file of another program is, by its ending or its contents, and how it is converted.
#[test]
fn files_of_other_programs_are_named() {
    let deck_of_dyna = "*KEYWORD\n*NODE\n1,0,0,0\n*ELEMENT_SOLID\n1,1,1,2,3,4\n*END\n";
    let files = [
        ("a.cdb", "/COM,ANSYS RELEASE 19\n/PREP7\n", "ANSYS Mechanical APDL", "for Abaqus"),
        ("a.dat", "/COM,ANSYS\n/PREP7\n", "ANSYS Mechanical APDL", "for Abaqus"),
        ("a.unv", "    -1\n  2411\n", "universal file", "gmsh FILE.unv"),
        ("a.txt", "    -1\n   164\n", "universal file", "gmsh FILE.unv"),
        ("a.stl", "solid part\n facet normal 0 0 1\n", "a surface of triangles (STL)", "mesh the volume"),
        ("a.stl", "\u{0}\u{0}", "a surface of triangles (STL)", "mesh the volume"),
        ("a.bdf", "SOL 101\nBEGIN BULK\n", "Nastran", "gmsh FILE.bdf"),
        ("a.nas", "", "Nastran", "gmsh FILE.bdf"),
        ("a.dat", "$ head\nGRID,1,,0.,0.,0.\n", "Nastran", "gmsh FILE.bdf"),
        ("a.k", deck_of_dyna, "LS-DYNA", "for Abaqus"),
        ("a.inp", deck_of_dyna, "LS-DYNA", "for Abaqus"),
        ("a.cgns", "\u{89}HDF", "CGNS", "meshio convert"),
        ("a.vtk", "# vtk DataFile Version 3.0\n", "legacy file of VTK", "meshio convert"),
        ("a.vtu", "# vtk DataFile Version 3.0\n", "legacy file of VTK", "meshio convert"),
        ("a.xdmf", "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n", "XDMF", "meshio convert"),
        ("a.obj", "v 0 0 0\n", "Wavefront", "mesh the volume"),
        ("a.step", "ISO-10303-21;\n", "(STEP)", "gmsh FILE -3"),
        ("a.STP", "", "(STEP)", "gmsh FILE -3"),
        ("a.msh", "(0 \"fluent\")\n(2 3)\n", "Fluent", "meshio convert"),
        ("a.inp", "4 1 0 0 0\n1 0 0 0\n", "AVS", "meshio convert"),
        ("a.frd", "    1C\n", "results of CalculiX", "input file"),
    ];
    for (name, text, what, how) in files {
        let told = refusal(name, text);
        assert!(told.starts_with("found ") && told.contains(what) && told.contains(how), "{name}: {told}");
        let (found, expected) = told.split_once(", expected ").expect("what was expected");
        assert!(found.contains(what) && expected.contains(how), "{name}: {told}");
    }
    let error = mesh::parse_file("a.step", b"", None).expect_err("a refusal");
    assert!(matches!(error, MeshFileError::Foreign { .. }), "{error:?}");
}
