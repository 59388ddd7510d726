//! Every fault of a file has its place, what was found and what was expected.
#![allow(clippy::too_many_lines, clippy::too_many_arguments, reason = "a test is one list of cases")]

use amontons::mesh::{self, gmsh, vtu};

/// A square of two triangles with its lower side.
const SQUARE: &str = "$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
1 5 \"low side\"
2 6 \"body\"
$EndPhysicalNames
$Entities
0 1 1 0
1 0 0 0 1 0 0 1 5 0
1 0 0 0 1 1 0 1 6 0
$EndEntities
$Nodes
1 4 1 4
2 1 0 4
1
2
3
4
0 0 0
1 0 0
1 1 0
0 1 0
$EndNodes
$Elements
2 3 1 3
1 1 1 1
1 1 2
2 1 2 2
2 1 2 3
3 1 3 4
$EndElements
";

#[test]
fn each_fault_names_its_line_and_what_was_expected() {
    let sound = gmsh::parse(SQUARE.as_bytes()).expect("a mesh");
    assert_eq!(
        (sound.cell_count(), sound.points.len(), sound.regions.as_slice()),
        (2, 4, ["body".to_owned()].as_slice())
    );
    let cases = [
        (
            "4.1 0 8",
            "4.0 0 8",
            "line 2: found version 4.0 of the Gmsh format, expected 2.2 or 4.1; try `gmsh OLD.msh -save -format msh41 -o NEW.msh`",
        ),
        ("4.1 0 8", "3 0 8", "line 2: found version 3 of"),
        ("$MeshFormat\n", "$NOD\n", "line 1: found version 1 of"),
        ("$MeshFormat\n", "solid\n", "line 1: found `solid`, expected $MeshFormat, with which a Gmsh file begins"),
        ("4.1 0 8", "4.1 2 8", "line 2: found `2`, expected 0 for text or 1 for binary"),
        ("4.1 0 8", "4.1 0 16", "line 2: found `16`, expected the bytes of a number: 8"),
        (
            "1 5 \"low side\"",
            "1 5 low",
            "line 6: found `low`, expected the name of the physical group in double quotes",
        ),
        ("1 5 \"low", "7 5 \"low", "line 6: found `7`, expected a dimension from 0 to 3"),
        (
            "1 4 1 4\n",
            "1 400 1 4\n",
            "line 15: found a count of 400 nodes, expected at most the 15 that the rest of the file can hold; it may be truncated",
        ),
        ("1 4 1 4\n", "1 3 1 4\n", "line 16: found `4`, expected no more than the 3 nodes announced"),
        ("1 4 1 4\n", "1 5 1 4\n", "line 25: found `$EndNodes`, expected 5 nodes, as announced, of which 4 came"),
        ("\n1 1 0\n", "\n1 nan 0\n", "line 23: found the coordinate NaN of node 3, expected a finite number"),
        ("\n1 1 0\n", "\n1 x1 0\n", "line 23: found `x1`, expected a coordinate of a node"),
        ("3\n4\n0", "3\n3\n0", "found node tag 3 twice, expected each tag once"),
        ("3 1 3 4", "3 1 3 9", "line 32: found node 9, expected the tag of one of the 4 nodes of the file"),
        (
            "2 1 2 2\n",
            "2 1 21 2\n",
            "line 30: found element type 21, expected one of Gmsh's types 1 to 19; try Mesh.ElementOrder = 1 or 2",
        ),
        ("2 1 2 2\n", "2 1 4 2\n", "line 30: found `2`, expected the dimension 3 of a 4-node tetrahedron"),
        (
            "2 1 2 2\n",
            "2 9 2 2\n",
            "line 30: found elements on entity 9 of dimension 2, expected one that $Entities lists",
        ),
        ("2 3 1 3\n", "2 4 1 3\n", "line 27: found `4`, expected the number of elements that follow, 3"),
        ("0 1 6 0\n$EndE", "0 2 6 7 0\n$EndE", ""),
        ("1 0 0 0 1 1 0 1 6 0\n", "1 0 0 0 1 1 0 0 0\n", ""),
        ("$EndElements", "$EndElement", "line 33: found `$EndElement`, expected $EndElements"),
        ("$Elements", "$Periodic", "line 34: found the end of the file, expected $EndPeriodic"),
        ("$Nodes\n", "$PartitionedEntities\n", "line 25: found `$EndNodes`, expected the tag of an entity"),
        ("1 1 0\n0 1 0", "1 1 0\n0 1 0.5", "z goes from 0e0 to 5e-1 on them, expected it constant"),
    ];
    for (old, new, expected) in cases {
        let spoiled = SQUARE.replacen(old, new, 1);
        assert_ne!(spoiled, SQUARE, "{old}");
        match gmsh::parse(spoiled.as_bytes()) {
            Ok(_) => assert_eq!(expected, "", "{old} → {new}"),
            Err(error) => {
                assert!(!expected.is_empty() && error.to_string().contains(expected), "{old} → {new}: {error}");
            }
        }
    }
}

#[test]
fn cells_without_a_region_beside_others_are_a_fault() {
    let spoiled = SQUARE
        .replace("0 1 1 0\n1 0", "0 1 2 0\n1 0")
        .replace("1 0 0 0 1 1 0 1 6 0\n", "1 0 0 0 1 1 0 1 6 0\n2 0 0 0 1 1 0 0 0\n")
        .replace("2 3 1 3\n", "3 3 1 3\n")
        .replace("2 1 2 2\n2 1 2 3\n3", "2 1 2 1\n2 1 2 3\n2 2 2 1\n3");
    let error = gmsh::parse(spoiled.as_bytes()).expect_err("a fault").to_string();
    assert!(
        error.starts_with(
            "line 33: found 1 of 2 cells without a region, expected all or none; try a physical group of dimension 2"
        ),
        "{error}"
    );
}

#[test]
fn a_file_without_cells_is_refused() {
    let points = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n2 1 0 0\n$EndNodes\n$Elements\n1\n1 15 2 0 1 1\n$EndElements\n";
    let error = gmsh::parse(points.as_bytes()).expect_err("a fault").to_string();
    assert_eq!(
        error,
        "found 2 nodes and 1 points as elements, expected at least one cell; try to mesh before saving, in Gmsh with a physical group for the body"
    );
}

#[test]
fn binary_faults_name_their_byte() {
    let head = b"$MeshFormat\n4.1 1 8\n\x02\0\0\0\n$EndMeshFormat\n";
    let error = gmsh::parse(head).expect_err("a fault").to_string();
    assert_eq!(error, "byte 20: found the bytes [2, 0, 0, 0], expected the integer 1 in binary");
    let huge = [
        b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n".as_slice(),
        &1_u64.to_le_bytes(),
        &u64::MAX.to_le_bytes(),
        &[0; 64],
    ]
    .concat();
    let error = gmsh::parse(&huge).expect_err("a fault").to_string();
    assert_eq!(
        error,
        format!(
            "byte 55: found a count of {} nodes, expected at most the 1 that the rest of the file can hold; it may be truncated",
            u64::MAX
        )
    );
}

#[test]
fn files_are_named_in_their_faults() {
    let missing = mesh::read(std::path::Path::new("/nowhere/pad.msh")).expect_err("a fault").to_string();
    assert!(missing.starts_with("/nowhere/pad.msh: cannot be read: "), "{missing}");
    let other = mesh::read(std::path::Path::new("pad.part")).expect_err("a fault").to_string();
    assert_eq!(
        other,
        "pad.part: the extension is \"part\", expected .msh (Gmsh), .inp (Abaqus, CalculiX), .med (Code_Aster, Salome), .mail (Code_Aster), .e (Exodus) or .vtu (VTK unstructured grid); meshio converts others: `meshio convert FILE MESH.vtu`"
    );
}

#[test]
fn faults_of_grids_name_the_array_or_cell() {
    let grid = "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece>\
        <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 5 5 0</DataArray></Points>\
        <Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 0 1</DataArray>\
        <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3 5</DataArray>\
        <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5 3</DataArray></Cells>\
        <CellData><DataArray type=\"Int32\" Name=\"region\" format=\"ascii\">4 0</DataArray></CellData></Piece></UnstructuredGrid></VTKFile>";
    let read = vtu::parse(grid.as_bytes()).expect("a mesh");
    assert_eq!(read.regions, ["4"]);
    assert_eq!(read.points.len(), 3, "the node of no cell is left out");
    assert_eq!(read.facets["boundary"].len(), 1, "facets without data are the boundary that the file means");
    for (old, new, expected) in [
        ("0 1 2 0 1<", "0 1 -2 0 1<", "the array connectivity has the value -2, not integers"),
        ("0 1 2 0 1<", "0 1 9 0 1<", "a cell has node 9, but there are 4 nodes"),
        ("5 3<", "37 3<", "cell 0: found element type VTK 37, expected one of"),
        ("5 3<", "23 3<", "cell 0 has 3 nodes, not the 8 of a Q2 quadrilateral"),
        ("5 3<", "9 3<", "cell 0 has 3 nodes, not the 4 of a Q1 quadrilateral"),
        ("4 0<", "4.5 0<", "the array region has 1 components or fractions, not one integer per cell"),
        ("4 0<", "4<", "the array region has 1 values, not 1 for each of 2 cells"),
        ("type=\"Unstr", "compressor=\"vtkLZ4DataCompressor\" type=\"Unstr", "compressed by vtkLZ4DataCompressor"),
    ] {
        let error = vtu::parse(grid.replacen(old, new, 1).as_bytes()).expect_err(new).to_string();
        assert!(error.contains(expected), "{new}: {error}");
    }
    let boundary =
        grid.replace("0 1 2 0 1<", "0 1 2<").replace("3 5<", "3<").replace("5 3<", "5<").replace("4 0<", "4<");
    assert_eq!(vtu::parse(boundary.as_bytes()).expect("a mesh").facets["boundary"].len(), 3);
}
