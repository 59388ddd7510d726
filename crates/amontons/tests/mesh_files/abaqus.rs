//! Input files of Abaqus and CalculiX: against the same meshes in other formats, and against the faces and shape
//! functions of the manuals.

use std::fmt::Write;

use amontons::element::Element;
use amontons::mesh::{Diagonal, Elements, FacetSet, Mesh, Skipped, inp};
use amontons::tensor::Point;

use super::files::read as file;
use super::{assert_same, prisms, region, side, two_regions};

/// Type of Abaqus and number of its nodes for an element.
fn kind(element: &Element, incomplete: bool) -> (&'static str, usize) {
    match element.name {
        "P1 segment" => ("DC1D2", 2),
        "P2 segment" => ("DC1D3", 3),
        "P1 triangle" => ("CPS3", 3),
        "P2 triangle" => ("CPE6M", 6),
        "Q1 quadrilateral" => ("cps4r", 4),
        "Q2 quadrilateral" if incomplete => ("CPS8R", 8),
        "P1 tetrahedron" => ("C3D4", 4),
        "P2 tetrahedron" => ("C3D10M", 10),
        "Q1 hexahedron" => ("C3D8I", 8),
        "Q2 hexahedron" if incomplete => ("C3D20R", 20),
        "P1 prism" => ("C3D6", 6),
        "P2 prism" if incomplete => ("C3D15", 15),
        other => panic!("{other}"),
    }
}

/// An input file with the regions as sections and the sides as sets of nodes.
fn deck(mesh: &Mesh) -> String {
    let mut text = "*Heading\n** a comment\n*Node, nset=Nall\n".to_owned();
    let used: std::collections::BTreeSet<u32> = mesh
        .blocks
        .iter()
        .flat_map(|block| block.cells().flat_map(|cell| cell[..kind(block.element, true).1].to_vec()))
        .collect();
    for &node in &used {
        let [x, y, z] = mesh.points[node as usize];
        writeln!(text, "{}, {x:?},{y:?}, {z:?}", 10 + 2 * node).unwrap();
    }
    let mut number = 5;
    for block in &mesh.blocks {
        let (name, count) = kind(block.element, true);
        writeln!(text, "*Element, type={name}, elset = \"{}\"", mesh.regions[block.region]).unwrap();
        for cell in block.cells() {
            number += 3;
            let nodes: Vec<String> = cell[..count].iter().map(|node| (10 + 2 * node).to_string()).collect();
            // Sixteen entries at most stand in a line.
            let entries: Vec<String> = std::iter::once(number.to_string()).chain(nodes).collect();
            for (i, part) in entries.chunks(16).enumerate() {
                let end = if 16 * (i + 1) < entries.len() { "," } else { "" };
                writeln!(text, "{}{end}", part.join(", ")).unwrap();
            }
        }
        writeln!(text, "*Solid Section, elset=\"{}\", material=STEEL\n1.0,", mesh.regions[block.region]).unwrap();
    }
    for (name, set) in &mesh.facets {
        writeln!(text, "*Nset, nset=\"{name}\"").unwrap();
        for node in set.node_list().into_iter().filter(|node| used.contains(node)) {
            writeln!(text, "{},", 10 + 2 * node).unwrap();
        }
    }
    text + "*Material, name=STEEL\n*Elastic\n2.1e11, 0.3\n*Step\n*Static\n*End Step\n"
}

/// The same mesh with the facets of its sides in an order of their own: a file may list them as it likes.
pub fn sorted(mesh: &Mesh) -> Mesh {
    let mut sorted = mesh.clone();
    for set in sorted.facets.values_mut() {
        let mut facets: Vec<(&Element, Vec<u32>)> =
            set.facets().map(|(element, nodes)| (element, nodes.to_vec())).collect();
        let place = |nodes: &[u32]| {
            let mut at: Vec<Point> = nodes.iter().map(|&node| mesh.points[node as usize]).collect();
            at.sort_by(|p, q| p.partial_cmp(q).expect("finite"));
            at
        };
        facets.sort_by(|(_, p), (_, q)| place(p).partial_cmp(&place(q)).expect("finite"));
        let mut ordered = FacetSet::default();
        for (element, nodes) in facets {
            let element = amontons::element::ALL.into_iter().find(|known| known.name == element.name);
            ordered.push(element.expect("an element"), nodes);
        }
        *set = ordered;
    }
    sorted
}

#[test]
fn elements_of_every_type_read_back_to_the_same_mesh() {
    let prisms = prisms();
    let bodies = [
        two_regions(),
        Mesh::rectangle_of(Elements::P2, [1.0, 2.0], [3, 2], Diagonal::Crossed).expect("a mesh"),
        Mesh::rectangle_of(Elements::Q1, [1.0, 2.0], [3, 2], Diagonal::Right).expect("a mesh"),
        Mesh::rectangle_of(Elements::Q2, [1.0, 2.0], [4, 2], Diagonal::Right).expect("a mesh"),
        Mesh::box_([1.0, 2.0, 4.0], [2, 2, 1], Elements::P1).expect("a mesh"),
        Mesh::box_([1.0, 2.0, 4.0], [1, 1, 2], Elements::P2).expect("a mesh"),
        Mesh::box_([1.0, 2.0, 4.0], [2, 1, 1], Elements::Q1).expect("a mesh"),
        Mesh::box_([1.0, 2.0, 4.0], [2, 1, 2], Elements::Q2).expect("a mesh"),
        prisms.quadratic().expect("a mesh"),
        prisms,
    ];
    for mesh in bodies {
        let found = inp::parse(deck(&mesh).as_bytes()).unwrap_or_else(|error| panic!("{}: {error}", mesh.dim));
        let mut sides = found.mesh.clone();
        // The set of all nodes is a side, too: the whole boundary.
        let all = sides.facets.remove("Nall").expect("the boundary");
        assert_eq!(all.len(), mesh.boundary().len());
        assert_same(&sorted(&sides), &sorted(&mesh));
        let skipped: Vec<&str> = found.skipped.iter().map(|skipped| skipped.what.as_str()).collect();
        assert_eq!(skipped, ["*MATERIAL", "*ELASTIC", "*STEP", "*STATIC", "*END STEP"]);
    }
}

/// What meshio writes of the ring of Gmsh is the ring of Gmsh.
#[test]
fn a_file_of_another_program_is_the_mesh_it_was_made_of() {
    let [ours, theirs] = ["quarter_ring_meshio.inp", "quarter_ring.msh"].map(file);
    let named = Mesh { regions: ours.regions.clone(), ..theirs };
    assert_same(&sorted(&ours), &sorted(&named));
}

/// The missing nodes are where the shape functions of 8 nodes have them (Zienkiewicz, Taylor):
/// ¼ (1 + ξξᵢ)(1 + ηηᵢ)(ξξᵢ + ηηᵢ − 1) at vertices, ½ (1 − ξ²)(1 + ηηᵢ) and ½ (1 + ξξᵢ)(1 − η²) in between.
#[test]
fn a_curved_cell_of_eight_nodes_stays_as_it_is() {
    let corners =
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];
    let points: Vec<[f64; 2]> =
        vec![[0.0, 0.1], [2.0, -0.2], [2.3, 1.5], [0.1, 1.2], [1.1, -0.3], [2.4, 0.6], [1.2, 1.6], [-0.3, 0.7]];
    let mut text = "*NODE\n".to_owned();
    for (i, [x, y]) in points.iter().enumerate() {
        writeln!(text, "{},{x},{y}", i + 1).unwrap();
    }
    text += "*ELEMENT, TYPE=CPS8\n1, 1,2,3,4,5,6,7,8\n";
    let mesh = inp::parse(text.as_bytes()).expect("a mesh").mesh;
    assert_eq!((mesh.points.len(), mesh.blocks[0].element.name), (9, "Q2 quadrilateral"));
    let shape = |i: usize, [xi, eta]: [f64; 2]| {
        let [a, b] = corners[i];
        match i {
            0..4 => 0.25 * (1.0 + xi * a) * (1.0 + eta * b) * (xi * a + eta * b - 1.0),
            4 | 6 => 0.5 * (1.0 - xi * xi) * (1.0 + eta * b),
            _ => 0.5 * (1.0 + xi * a) * (1.0 - eta * eta),
        }
    };
    let cell = mesh.blocks[0].cells().next().expect("a cell");
    for at in [[0.3, -0.7], [-0.9, 0.2], [0.5, 0.5]] {
        let expected: [f64; 2] = std::array::from_fn(|d| (0..8).map(|i| shape(i, at) * points[i][d]).sum());
        let mut values = [0.0; 9];
        let x: Point = [0.5 + 0.5 * at[0], 0.5 + 0.5 * at[1], 0.0];
        (mesh.blocks[0].element.shape_functions)(&x, &mut values);
        for (d, expected) in expected.into_iter().enumerate() {
            let found: f64 = cell.iter().zip(values).map(|(&node, n)| n * mesh.points[node as usize][d]).sum();
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }
}

/// Outward normals and areas of faces.
type Faces = Vec<([f64; 3], f64)>;

/// Outward normals of the faces S1, S2, … of one cell of each type, as the manual numbers them ("Element faces" of each
/// family), and their areas.
#[test]
#[allow(clippy::too_many_lines, reason = "the faces of five elements")]
fn faces_are_those_of_the_manual() {
    let h = 0.5_f64.sqrt();
    let t = 1.0 / 3.0_f64.sqrt();
    let (plane, space) = (
        "1, 0,0\n2, 1,0\n3, 0,1\n4, 1,1\n",
        "1, 0,0,0\n2, 1,0,0\n3, 0,1,0\n4, 0,0,1\n5, 1,1,0\n6, 1,0,1\n7, 1,1,1\n8, 0,1,1\n",
    );
    let cells: [(&str, &str, &str, Faces); 5] = [
        ("CAX3", plane, "1,2,3", vec![([0.0, -1.0, 0.0], 1.0), ([h, h, 0.0], 1.0 / h), ([-1.0, 0.0, 0.0], 1.0)]),
        (
            "CPE4",
            plane,
            "1,2,4,3",
            vec![([0.0, -1.0, 0.0], 1.0), ([1.0, 0.0, 0.0], 1.0), ([0.0, 1.0, 0.0], 1.0), ([-1.0, 0.0, 0.0], 1.0)],
        ),
        (
            "C3D4",
            space,
            "1,2,3,4",
            vec![([0.0, 0.0, -1.0], 0.5), ([0.0, -1.0, 0.0], 0.5), ([t, t, t], 0.5 / t), ([-1.0, 0.0, 0.0], 0.5)],
        ),
        (
            "C3D6",
            space,
            "1,2,3,4,6,8",
            vec![
                ([0.0, 0.0, -1.0], 0.5),
                ([0.0, 0.0, 1.0], 0.5),
                ([0.0, -1.0, 0.0], 1.0),
                ([h, h, 0.0], 1.0 / h),
                ([-1.0, 0.0, 0.0], 1.0),
            ],
        ),
        (
            "C3D8",
            space,
            "1,2,5,3,4,6,7,8",
            vec![
                ([0.0, 0.0, -1.0], 1.0),
                ([0.0, 0.0, 1.0], 1.0),
                ([0.0, -1.0, 0.0], 1.0),
                ([1.0, 0.0, 0.0], 1.0),
                ([0.0, 1.0, 0.0], 1.0),
                ([-1.0, 0.0, 0.0], 1.0),
            ],
        ),
    ];
    for (name, nodes, cell, faces) in cells {
        let mut text = format!("*NODE\n{nodes}*ELEMENT, TYPE={name}, ELSET=all\n7,{cell}\n");
        for face in 1..=faces.len() {
            writeln!(text, "*SURFACE, NAME=face{face}\nall, S{face}").unwrap();
        }
        let mesh = inp::parse(text.as_bytes()).unwrap_or_else(|error| panic!("{name}: {error}")).mesh;
        assert_eq!((mesh.facets.len(), mesh.axisymmetric), (faces.len(), name == "CAX3"), "{name}");
        for (face, (normal, area)) in faces.into_iter().enumerate() {
            let set = &mesh.facets[&format!("face{}", face + 1)];
            let plane = Mesh { axisymmetric: false, ..mesh.clone() };
            let (found, _, flux) = side(&plane, set);
            let at = plane.points[set.node_list()[0] as usize];
            let expected: f64 = (0..3).map(|d| normal[d] * at[d]).sum::<f64>() * area;
            assert!((found - area).abs() < 1e-14 && (flux - expected).abs() < 1e-14, "{name} {face}: {found} {flux}");
        }
        let wrong = format!("{text}*SURFACE, NAME=none\nall, S9\n");
        assert!(inp::parse(wrong.as_bytes()).is_err(), "{name}");
    }
}

/// Two squares of one part, side by side, the second one turned by 90° about its corner: regions, sides and free faces.
#[test]
fn instances_are_moved_and_turned() {
    let text = "*PART, NAME=Tile\n*NODE\n1,0,0\n2,2,0\n3,2,1\n4,0,1\n*ELEMENT, TYPE=CPS4\n1,1,2,3,4\n*ELSET, ELSET=Whole, GENERATE\n1,1,1\n\
        *NSET, NSET=Foot\n1,2\n*SOLID SECTION, ELSET=whole, MATERIAL=M\n*END PART\n*ASSEMBLY, NAME=A\n\
        *INSTANCE, NAME=left, PART=TILE\n*END INSTANCE\n*INSTANCE, NAME=right, PART=Tile\n5,0,0\n5,0,0,5,0,1,90\n*END INSTANCE\n\
        *NSET, NSET=feet\nleft.Foot\n*NSET, NSET=feet, INSTANCE=right\n1, 2\n*SURFACE, NAME=Free\nleft.Whole,\n*END ASSEMBLY\n";
    let mesh = inp::parse(text.as_bytes()).expect("a mesh").mesh;
    assert_eq!(mesh.regions, ["left.Whole", "right.Whole"]);
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-13, "{found} {expected}");
    // The turned tile covers 4 < x < 5, 0 < y < 2.
    let (area, moment) = region(&mesh, "right.Whole");
    near(area, 2.0);
    near(moment, 9.0);
    let names: Vec<&str> = mesh.facets.keys().map(String::as_str).collect();
    assert_eq!(names, ["Free", "feet", "left.Foot", "right.Foot"]);
    for (name, length) in [("Free", 6.0), ("feet", 4.0), ("right.Foot", 2.0)] {
        near(side(&mesh, &mesh.facets[name]).0, length);
    }
    // The foot of the turned tile lies on x = 5.
    near(side(&mesh, &mesh.facets["right.Foot"]).1, 10.0);
}

#[test]
fn what_is_no_part_of_the_mesh_is_named() {
    let text = "*NODE\n1,0,0\n2,1,0\n3,0,1\n*ELEMENT, TYPE=CPS3, ELSET=body\n1,1,2,3\n*ELEMENT, TYPE=B21\n5,1,2\n6,2,3\n\
        *BOUNDARY\n1,1\n*ELEMENT, TYPE=MASS\n9,1\n*BOUNDARY\n2,2\n*ELSET, ELSET=mixed\n1,5,6\n*NSET, NSET=base, ELSET=mixed\n";
    let found = inp::parse(text.as_bytes()).expect("a mesh");
    let named = |what: &str, line, count| Skipped { what: what.to_owned(), file: None, line: Some(line), count };
    let expected = [
        named("elements of type B21", 7, 2),
        named("*BOUNDARY", 10, 2),
        named("elements of type MASS", 12, 1),
        named("element sets of cells that are no region: \"mixed\"", 16, 1),
    ];
    assert_eq!(found.skipped, expected);
    assert_eq!(found.mesh.facets["base"].len(), 3);
}

#[test]
#[allow(clippy::too_many_lines, reason = "one entry per fault")]
fn every_fault_is_told_with_its_line() {
    let nodes = "*NODE\n1,0,0\n2,1,0\n3,0,1\n";
    let cell = "*ELEMENT, TYPE=CPS3, ELSET=E\n1,1,2,3\n";
    let told = |text: &str| inp::parse(text.as_bytes()).expect_err(text).to_string();
    let faults = [
        ("1,0,0\n".to_owned(), "line 1: found \"1,0,0\", expected a keyword line, which begins with a star"),
        ("*NODE\n1,0,zero\n".to_owned(), "line 2: found \"zero\", expected a coordinate"),
        ("*NODE\nfirst,0,0\n".to_owned(), "line 2: found \"first\", expected the number of a node"),
        ("*NODE\n1,0,inf\n".to_owned(), "line 2: found the coordinate inf of node 1, expected a finite number"),
        (format!("{nodes}3,2,2\n{cell}"), "found node tag 3 twice, expected each tag once"),
        (
            format!("{nodes}*ELEMENT, ELSET=E\n1,1,2,3\n"),
            "line 5: found *ELEMENT without TYPE, expected *ELEMENT, TYPE=…",
        ),
        (
            format!("{nodes}*ELEMENT, TYPE=CPS3\n1,1,2\n"),
            "line 6: found element 1 with 2 nodes, expected the 3 nodes of the type CPS3",
        ),
        (
            format!("{nodes}*ELEMENT, TYPE=CPS3\n1,1,2,4\n"),
            "line 6: found node 4, expected the tag of one of the 3 nodes of the file",
        ),
        (
            format!("{nodes}*ELEMENT, TYPE=C3D13\n1,1,2,3\n"),
            "line 5: found element type C3D13, expected one of bodies of 2 or 3 nodes on a line, 3, 4, 6 or 8 in the plane, 4, 5, 6, 8, 10, 15 or 20 in space; try elements of the first order",
        ),
        (
            format!("{nodes}*ELEMENT, TYPE=C3D27\n1,1,2,3\n"),
            "line 5: found element type C3D27, expected one of bodies of 2 or 3 nodes on a line, 3, 4, 6 or 8 in the plane, 4, 5, 6, 8, 10, 15 or 20 in space; try elements of the first order",
        ),
        (
            format!("{nodes}{cell}*NSET, NSET=N, GENERATE\n3,1,1\n"),
            "line 8: found \"3,1,1\", expected a first number, a last one that is not smaller, and a positive step",
        ),
        (
            format!("{nodes}{cell}*NSET, NSET=N\n1, other\n"),
            "line 8: found the node set \"other\", expected a set that the file defines",
        ),
        (
            format!("{nodes}{cell}*SURFACE, NAME=S\nother, S1\n"),
            "line 8: found the element set \"other\", expected a set that the file defines",
        ),
        (
            format!("{nodes}{cell}*SURFACE, NAME=S\nE, S4\n"),
            "line 8: found the face S4 of a P1 triangle, expected S1, S2, … up to its number of faces",
        ),
        (
            format!("{nodes}*NGEN\n1,3,1\n{cell}"),
            "line 5: found *NGEN, expected nodes and elements written out in one file; try to let the preprocessor, or CalculiX's cgx, write them",
        ),
        (
            "*ASSEMBLY\n*INSTANCE, NAME=a, PART=p\n*END INSTANCE\n".to_owned(),
            "line 2: found an instance of the part \"p\", expected a part that the file has defined before",
        ),
        (
            format!("{nodes}4,1,1\n*ELEMENT, TYPE=CPS3\n1,1,2,3\n*ELEMENT, TYPE=CAX3\n2,2,4,3\n"),
            "line 9: found plane elements beside those of a body of revolution, expected elements of one kind, CAX… or CPS…, CPE…",
        ),
        (
            nodes.to_owned(),
            "found 3 nodes and 0 points as elements, expected at least one cell; try to mesh before saving, in Gmsh with a physical group for the body",
        ),
    ];
    for (text, expected) in faults {
        assert_eq!(told(&text), expected);
    }
}

/// A set that names itself, numbers without end, and bytes that are no text end in an error or a mesh, never in a hang.
#[test]
fn hostile_files_end() {
    let base = "*NODE\n1,0,0\n2,1,0\n3,0,1\n*ELEMENT, TYPE=CPS3, ELSET=E\n1,1,2,3\n";
    for more in [
        "*NSET, NSET=N\nN\n",
        "*ELSET, ELSET=E\nE\n*SURFACE, NAME=S\nE,\n",
        "*NSET, NSET=N, GENERATE\n1,9223372036854775807,1\n",
        "*NSET, NSET=N, GENERATE\n-9223372036854775808,9223372036854775807,1\n",
        "*SURFACE, NAME=S\nE, S99999999999999999999\n",
        "*ELEMENT, TYPE=C3D99999999999999999999\n",
        "*ELEMENT, TYPE=C3D\u{fffd}8\n1,1\n",
    ] {
        let _ = inp::parse(format!("{base}{more}").as_bytes());
    }
}
