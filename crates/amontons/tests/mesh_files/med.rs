//! MED files, as Code_Aster and Salome write them: `meshes/med.py` made those of the tests from the description of the
//! format, `meshes/med_cells.py` others with the library of the format.

use amontons::mesh::{Mesh, defects, parse};

use super::abaqus::sorted;
use super::files::{assert_places, read as file};
use super::hostile::{refusal, replaced, spoil_at_random, spoil_counts};
use super::{assert_same, region};

fn bytes(name: &str) -> &'static [u8] {
    match name {
        "plate" => include_bytes!("../meshes/plate.med"),
        "plate-2" => include_bytes!("../meshes/plate-2.med"),
        "brick" => include_bytes!("../meshes/brick.med"),
        "prism" => include_bytes!("../meshes/prism.med"),
        "pyramid" => include_bytes!("../meshes/pyramid.med"),
        "quadrilateral9" => include_bytes!("../meshes/quadrilateral9.med"),
        "triangle7" => include_bytes!("../meshes/triangle7.med"),
        "pyramid13" => include_bytes!("../meshes/pyramid13.med"),
        "prism18" => include_bytes!("../meshes/prism18.med"),
        "hexahedron27" => include_bytes!("../meshes/hexahedron27.med"),
        _ => include_bytes!("../meshes/tetrahedron.med"),
    }
}

fn read(name: &str) -> Mesh {
    let mesh = parse("med", bytes(name)).unwrap_or_else(|error| panic!("{name}: {error}")).mesh;
    mesh.check().unwrap_or_else(|error| panic!("{name}: {error}"));
    mesh
}

fn size_of_body(mesh: &Mesh) -> f64 {
    mesh.regions.iter().map(|name| region(mesh, name).0).sum()
}

#[test]
fn a_plate_has_its_groups() {
    for name in ["plate", "plate-2"] {
        let mesh = read(name);
        assert_eq!((mesh.dim, mesh.points.len(), mesh.cell_count()), (2, 12, 8), "{name}");
        assert_eq!(mesh.points[7], [1.5, 0.25, 0.0]);
        let mut regions = mesh.regions.clone();
        regions.sort();
        assert_eq!(regions, ["rubber", "steel"]);
        let sides: Vec<(&str, usize)> = mesh.facets.iter().map(|(name, set)| (name.as_str(), set.len())).collect();
        assert_eq!(sides, [("bottom", 3), ("free", 3), ("left", 2), ("right", 2), ("top", 3)]);
        let corner = mesh.edges.get("corner").expect("a named point").node_list();
        assert_eq!(corner.iter().map(|&n| mesh.points[n as usize]).collect::<Vec<_>>(), [[1.5, 0.5, 0.0]]);
    }
}

/// The volume is that of the grid, (2, 0, 0.1) × (0.3, 1, 0) · (0, −0.2, 0.5) per unit cube: a middle node at the wrong
/// place, or a cell inside out, would change it.
#[test]
fn a_brick_of_twenty_nodes_has_its_volume() {
    let mesh = read("brick");
    assert_eq!((mesh.dim, mesh.cell_count()), (3, 4));
    assert_eq!(mesh.regions, ["brick"]);
    assert_eq!(mesh.facets.keys().collect::<Vec<_>>(), ["below"]);
    let [u, v, w] = [[2.0, 0.0, 0.1], [0.3, 1.0, 0.0], [0.0, -0.2, 0.5]];
    let volume: f64 =
        u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
    let expected = 4.0 * volume;
    assert!((size_of_body(&mesh) - expected).abs() < 1e-13, "{} and {expected}", size_of_body(&mesh));
}

#[test]
fn single_cells_have_their_volumes() {
    for (name, volume) in [("prism", 0.5), ("pyramid", 1.0 / 3.0), ("tetrahedron", 1.0 / 6.0)] {
        let mesh = read(name);
        assert_eq!(
            (mesh.dim, mesh.cell_count(), mesh.regions.as_slice()),
            (3, 1, ["body".to_owned()].as_slice()),
            "{name}"
        );
        assert!((size_of_body(&mesh) - volume).abs() < 1e-14, "{name}: {}", size_of_body(&mesh));
        assert_eq!(mesh.facets.keys().collect::<Vec<_>>(), ["boundary"]);
    }
}

/// Files of the library of the format, `meshes/med_cells.py`, which says itself where the middle nodes belong.
#[test]
fn cells_with_nodes_in_the_middle_of_faces_have_them_in_place() {
    let volume = 0.992_187_5;
    for (name, element, size) in [
        ("quadrilateral9", "Q2 quadrilateral", 2.0),
        ("pyramid13", "P2 pyramid", volume / 3.0),
        ("prism18", "P2 prism", volume / 2.0),
        ("hexahedron27", "Q2 hexahedron", volume),
    ] {
        let mesh = read(name);
        assert_eq!(mesh.blocks.iter().map(|block| block.element.name).collect::<Vec<_>>(), [element]);
        assert_places(&mesh, name);
        assert!((size_of_body(&mesh) - size).abs() < 1e-14, "{name}: {}", size_of_body(&mesh));
        assert_eq!(defects::defects(&mesh), [], "{name}");
    }
    assert_eq!(
        refusal("med", bytes("triangle7")).expect("a refusal").to_string(),
        "cells of type TR7, expected one of PO1, SE2, SE3, TR3, TR6, QU4, QU8, QU9, TE4, T10, PY5, P13, PE6, P15, P18, HE8, H20, H27; save triangles with a node in the middle as TR6, without it"
    );
}

/// What meshio writes of the ring of Gmsh is the ring of Gmsh.
#[test]
fn a_file_of_another_program_is_the_mesh_it_was_made_of() {
    let [ours, theirs] = ["quarter_ring_meshio.med", "quarter_ring.msh"].map(file);
    assert_same(&sorted(&ours), &sorted(&theirs));
}

#[test]
fn what_is_no_med_file_is_refused() {
    let message = refusal("med", b"$MeshFormat\n4.1 0 8\n").expect("a refusal").to_string();
    assert!(message.starts_with("no HDF5, which a MED file is: "), "{message}");
    let spoiled =
        |old: &[u8], new: &[u8]| refusal("med", &replaced(bytes("plate"), old, new)).expect("a refusal").to_string();
    assert_eq!(spoiled(b"ENS_MAA\0", b"ENS_MAB\0"), "HDF5 without meshes (ENS_MAA), expected a MED file");
    assert_eq!(
        spoiled(b"QU4\0", b"QV4\0"),
        "cells of type QV4, expected one of PO1, SE2, SE3, TR3, TR6, QU4, QU8, QU9, TE4, T10, PY5, P13, PE6, P15, P18, HE8, H20, H27"
    );
}

#[test]
fn spoiled_files_are_refused_or_read() {
    let refused = spoil_at_random("med", &[bytes("plate"), bytes("brick")]);
    assert!(refused > 200, "{refused} were refused");
    spoil_counts("med", &[bytes("plate"), bytes("brick")]);
}
