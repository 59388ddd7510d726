//! Text meshes of Code_Aster: cells of every type with their nodes in the order of its document U3.01.00, groups, and
//! what is refused.

use std::fmt::Write as _;

use amontons::mesh::{Mesh, defects, parse};
use amontons::tensor::Point;

use super::abaqus::sorted;
use super::files::{assert_places, read as file};
use super::hostile::{refusal, spoil_at_random};
use super::{assert_same, region};

/// A type: its name, and of each node the vertices of which it is the mean, from 1.
type Nodes = (&'static str, &'static [&'static [usize]]);

const SEGMENT: &[&[usize]] = &[&[1], &[2], &[1, 2]];
const TRIANGLE: &[&[usize]] = &[&[1], &[2], &[3], &[1, 2], &[2, 3], &[3, 1]];
const QUADRILATERAL: &[&[usize]] = &[&[1], &[2], &[3], &[4], &[1, 2], &[2, 3], &[3, 4], &[4, 1], &[1, 2, 3, 4]];
const TETRAHEDRON: &[&[usize]] = &[&[1], &[2], &[3], &[4], &[1, 2], &[2, 3], &[3, 1], &[1, 4], &[2, 4], &[3, 4]];
const PYRAMID: &[&[usize]] =
    &[&[1], &[2], &[3], &[4], &[5], &[1, 2], &[2, 3], &[3, 4], &[4, 1], &[1, 5], &[2, 5], &[3, 5], &[4, 5]];
/// The edges below, those that rise, those above, and the faces that rise.
const PRISM: &[&[usize]] = &[
    &[1],
    &[2],
    &[3],
    &[4],
    &[5],
    &[6],
    &[1, 2],
    &[2, 3],
    &[3, 1],
    &[1, 4],
    &[2, 5],
    &[3, 6],
    &[4, 5],
    &[5, 6],
    &[6, 4],
    &[1, 2, 5, 4],
    &[2, 3, 6, 5],
    &[1, 3, 6, 4],
];
/// The same, then the faces: below, around, above; and the middle.
const HEXAHEDRON: &[&[usize]] = &[
    &[1],
    &[2],
    &[3],
    &[4],
    &[5],
    &[6],
    &[7],
    &[8],
    &[1, 2],
    &[2, 3],
    &[3, 4],
    &[4, 1],
    &[1, 5],
    &[2, 6],
    &[3, 7],
    &[4, 8],
    &[5, 6],
    &[6, 7],
    &[7, 8],
    &[8, 5],
    &[1, 2, 3, 4],
    &[1, 2, 6, 5],
    &[2, 3, 7, 6],
    &[3, 4, 8, 7],
    &[1, 4, 8, 5],
    &[5, 6, 7, 8],
    &[1, 2, 3, 4, 5, 6, 7, 8],
];

/// Every type that is read, the vertices of its unit cell, its element here, and the size of the unit cell.
fn types() -> Vec<(Nodes, &'static [Point], &'static str, f64)> {
    const LINE: &[Point] = &[[0.0; 3], [1.0, 0.0, 0.0]];
    const FLAT: &[Point] = &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    const SQUARE: &[Point] = &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    const SOLID: &[Point] = &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const PEAK: &[Point] = &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0]];
    const WEDGE: &[Point] =
        &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    const CUBE: &[Point] = &[
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0; 3],
        [0.0, 1.0, 1.0],
    ];
    vec![
        (("SEG2", &SEGMENT[..2]), LINE, "P1 segment", 1.0),
        (("SEG3", SEGMENT), LINE, "P2 segment", 1.0),
        (("TRIA3", &TRIANGLE[..3]), FLAT, "P1 triangle", 0.5),
        (("TRIA6", TRIANGLE), FLAT, "P2 triangle", 0.5),
        (("QUAD4", &QUADRILATERAL[..4]), SQUARE, "Q1 quadrilateral", 1.0),
        (("QUAD8", &QUADRILATERAL[..8]), SQUARE, "Q2 quadrilateral", 1.0),
        (("QUAD9", QUADRILATERAL), SQUARE, "Q2 quadrilateral", 1.0),
        (("TETRA4", &TETRAHEDRON[..4]), SOLID, "P1 tetrahedron", 1.0 / 6.0),
        (("TETRA10", TETRAHEDRON), SOLID, "P2 tetrahedron", 1.0 / 6.0),
        (("PYRAM5", &PYRAMID[..5]), PEAK, "P1 pyramid", 1.0 / 3.0),
        (("PYRAM13", PYRAMID), PEAK, "P2 pyramid", 1.0 / 3.0),
        (("PENTA6", &PRISM[..6]), WEDGE, "P1 prism", 0.5),
        (("PENTA15", &PRISM[..15]), WEDGE, "P2 prism", 0.5),
        (("PENTA18", PRISM), WEDGE, "P2 prism", 0.5),
        (("HEXA8", &HEXAHEDRON[..8]), CUBE, "Q1 hexahedron", 1.0),
        (("HEXA20", &HEXAHEDRON[..20]), CUBE, "Q2 hexahedron", 1.0),
        (("HEXA27", HEXAHEDRON), CUBE, "Q2 hexahedron", 1.0),
    ]
}

/// A file with one cell, mapped by u, v, w from its unit cell.
fn one_cell((name, nodes): &Nodes, vertices: &[Point], [u, v, w]: [Point; 3]) -> String {
    let mut text = "TITRE\n a cell % and a comment\nFINSF\nCOOR_3D\n".to_owned();
    for (i, of) in nodes.iter().enumerate() {
        let mean: Point =
            std::array::from_fn(|c| of.iter().map(|&k| vertices[k - 1][c]).sum::<f64>() / of.len() as f64);
        let x: Point = std::array::from_fn(|c| 3.0 + u[c] * mean[0] + v[c] * mean[1] + w[c] * mean[2]);
        let _ = writeln!(text, "N{} {:?} {:?} {:?}", i + 1, x[0], x[1], x[2]);
    }
    let _ = write!(text, "FINSF\n{name}\nM1");
    (0..nodes.len()).for_each(|i| {
        let _ = write!(text, "{}N{}", if i % 7 == 6 { "\n   " } else { " " }, i + 1);
    });
    text + "\nFINSF\nFIN\n"
}

/// A skew map and its determinant, in space, in the plane and on the line: of numbers that take no rounding.
fn skew(dim: usize) -> ([Point; 3], f64) {
    match dim {
        1 => ([[2.5, 0.0, 0.0], [0.0; 3], [0.0; 3]], 2.5),
        2 => ([[2.0, 0.25, 0.0], [-0.5, 1.5, 0.0], [0.0; 3]], 2.0 * 1.5 + 0.25 * 0.5),
        _ => {
            let [u, v, w]: [Point; 3] = [[2.0, 0.0, 0.125], [0.25, 1.0, 0.0], [0.0, -0.25, 0.5]];
            let cross = [v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]];
            ([u, v, w], (0..3).map(|c| u[c] * cross[c]).sum())
        }
    }
}

fn read(text: &str) -> Mesh {
    let mesh = parse("mail", text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}")).mesh;
    mesh.check().unwrap_or_else(|error| panic!("{error}\n{text}"));
    mesh
}

/// Each cell has its size, its nodes where the map of its vertices has them, and no defect, which a cell inside out or
/// a middle at the wrong place would be.
#[test]
fn cells_of_every_type_have_their_nodes_in_place() {
    for (nodes, vertices, element, size) in types() {
        let dim = match nodes.0 {
            name if name.starts_with("SEG") => 1,
            name if name.starts_with("TRIA") || name.starts_with("QUAD") => 2,
            _ => 3,
        };
        let (map, determinant) = skew(dim);
        let mesh = read(&one_cell(&nodes, vertices, map));
        assert_eq!((mesh.dim, mesh.cell_count(), mesh.blocks[0].element.name), (dim, 1, element), "{}", nodes.0);
        assert_places(&mesh, nodes.0);
        let found = region(&mesh, "body").0;
        assert!((found - size * determinant).abs() < 1e-13, "{}: {found}", nodes.0);
        assert_eq!(defects::defects(&mesh), [], "{}", nodes.0);
        // As it stands: the first vertex is where the file has it, and the determinant is positive as it is there.
        assert_eq!(mesh.points[mesh.blocks[0].nodes[0] as usize][0], 3.0, "{}", nodes.0);
    }
}

/// Two squares with all that a file may have.
const PLATE: &str = include_str!("../meshes/plate.mail");

#[test]
fn a_plate_has_its_groups() {
    let mesh = read(PLATE);
    assert_eq!((mesh.dim, mesh.points.len(), mesh.cell_count()), (2, 6, 2));
    assert_eq!(mesh.regions, ["SOFT", "HARD"]);
    assert_eq!(mesh.blocks.iter().map(|block| (block.region, block.len())).collect::<Vec<_>>(), [(0, 1), (1, 1)]);
    let sides: Vec<(&str, usize)> = mesh.facets.iter().map(|(name, set)| (name.as_str(), set.len())).collect();
    assert_eq!(sides, [("HIGH", 2), ("LEFT", 1), ("LOW", 2)]);
    let corner = mesh.edges.get("CORNER").expect("a named point").node_list();
    assert_eq!(corner.iter().map(|&n| mesh.points[n as usize]).collect::<Vec<_>>(), [[2.0, 1.0, 0.0]]);
    assert!((region(&mesh, "HARD").0 - 1.0).abs() < 1e-15);
    // Blocks in another order, and the ends of lines of another system.
    let (head, rest) = PLATE.split_once("QUAD4").expect("cells");
    let (nodes, groups) = (head.replace("COOR_2D", "\r\nCOOR_2D"), format!("QUAD4{rest}"));
    let turned = groups.replace("FIN\nwhat", &format!("{nodes}FIN\nwhat")).replace('\n', "\r\n");
    assert_same(&sorted(&read(&turned)), &sorted(&mesh));
}

/// The ring of Gmsh, written as a text of Code_Aster, is the ring.
#[test]
fn a_ring_of_curved_triangles_is_the_same() {
    let ring = file("quarter_ring.msh");
    let mut text = "COOR_2D\n".to_owned();
    for (i, x) in ring.points.iter().enumerate() {
        let _ = writeln!(text, "N{i} {:?} {:?}", x[0], x[1]);
    }
    let mut number = 0;
    let mut cells = |name: &str, nodes: &[u32], each: usize| {
        let _ = writeln!(text, "FINSF\n{name}");
        let names: Vec<String> = nodes
            .chunks(each)
            .map(|cell| {
                number += 1;
                let _ =
                    writeln!(text, "M{number} {}", cell.iter().map(|n| format!("N{n}")).collect::<Vec<_>>().join(" "));
                format!("M{number}")
            })
            .collect();
        names.join("\n")
    };
    let mut groups = vec![(ring.regions[0].clone(), cells("TRIA6", &ring.blocks[0].nodes, 6))];
    for (name, set) in &ring.facets {
        groups.push((name.clone(), cells("SEG3", &set.blocks[0].nodes, 3)));
    }
    for (name, members) in groups {
        let _ = writeln!(text, "FINSF\nGROUP_MA NOM={}\n{members}", name.replace(' ', "_"));
    }
    let mut expected = ring.clone();
    expected.regions.iter_mut().for_each(|name| *name = name.replace(' ', "_"));
    expected.facets = ring.facets.iter().map(|(name, set)| (name.replace(' ', "_"), set.clone())).collect();
    assert_same(&sorted(&read(&(text + "FINSF\nFIN\n"))), &sorted(&expected));
}

/// What is replaced in the plate, by what, and what is told.
const FAULTS: &[(&str, &str, &str)] = &[
    ("1.D0", "1.X0", "line 7: found \"1.X0\" as a coordinate of the node \"N2\", expected a finite number"),
    ("1.D0", "inf", "line 7: found \"inf\" as a coordinate of the node \"N2\", expected a finite number"),
    ("N6 2 1.\n", "N6 2\n", "line 10: found 1 coordinates of the node \"N6\", expected 2 coordinates"),
    ("N4 0 1 N5", "N2 0 1 N5", "line 9: found the node \"N2\" again, expected a name of its own for each node"),
    ("N5 N4\n", "N5 N9\n", "line 14: found the node \"N9\", expected the name of one of the 6 nodes of the file"),
    (
        "   N5 N4\nM2",
        "   N5\nM2",
        "line 16: found the node \"M2\", expected the name of one of the 6 nodes of the file",
    ),
    ("N6 N5\n", "N6\n", "line 16: found 3 nodes of the cell \"M2\", expected 4 nodes of a QUAD4"),
    ("S3 N4 N1", "S1 N4 N1", "line 20: found the cell \"S1\" again, expected a name of its own for each cell"),
    (
        "S1 S2\nFINSF",
        "S1 S7\nFINSF",
        "line 32: found the cell \"S7\" in the group \"LOW\", expected a cell of the file",
    ),
    ("CORNER N6", "CORNER N8", "line 43: found the node \"N8\", expected the name of one of the 6 nodes of the file"),
    (
        "GROUP_NO\nCORNER N6\n",
        "GROUP_NO\n",
        "line 42: found a GROUP_NO without a name, expected its name, and the names of what it holds",
    ),
    (
        "POI1\n",
        "POINT\n",
        "line 22: found \"POINT\", expected TITRE, COOR_2D, COOR_3D, a type of cells such as HEXA20, GROUP_MA, GROUP_NO or FIN",
    ),
    (
        "seg2\nS1 N1 N2  S2 N2 NODE_WITH_A_LONG_NAME_24\n",
        "SEG4\nS1 N1 N2 N4 N5\n",
        "line 18: found element type SEG4, expected one of POI1, SEG2, SEG3, TRIA3, TRIA6, QUAD4, QUAD8, QUAD9, TETRA4, TETRA10, PYRAM5, PYRAM13, PENTA6, PENTA15, PENTA18, HEXA8, HEXA20, HEXA27; try elements of the first order",
    ),
    (
        "POI1\n",
        "COOR_2D\n",
        "line 22: found COOR_2D after the coordinates of line 5, expected the coordinates of all nodes in one block",
    ),
    (
        "FIN\nwhat",
        "what",
        "line 45: found \"what\", expected TITRE, COOR_2D, COOR_3D, a type of cells such as HEXA20, GROUP_MA, GROUP_NO or FIN",
    ),
];

#[test]
fn faults_have_their_line() {
    let told = |old: &str, new: &str| {
        assert!(PLATE.contains(old), "{old}");
        refusal("mail", PLATE.replacen(old, new, 1).as_bytes())
            .map_or_else(|| "read".to_owned(), |error| error.to_string())
    };
    for (old, new, says) in FAULTS {
        assert_eq!(told(old, new), *says);
    }
}

#[test]
fn files_that_are_cut_or_empty_are_told() {
    let cut = &PLATE[..PLATE.find("M2 N2").expect("a cell")];
    assert_eq!(
        refusal("mail", cut.as_bytes()).expect("a refusal").to_string(),
        "line 15: found the end of the file in the block QUAD4 of line 12, expected FINSF, which ends a block; it may be truncated"
    );
    let cut = &PLATE[..PLATE.find("GROUP_MA").expect("a group")];
    assert_eq!(
        refusal("mail", cut.as_bytes()).expect("a refusal").to_string(),
        "line 24: found the end of the file, expected FIN, which ends a mesh of Code_Aster; it may be truncated"
    );
    let without = "COOR_2D\nN1 0 0\nFINSF\nFIN\n";
    assert_eq!(
        refusal("mail", without.as_bytes()).expect("a refusal").to_string(),
        "found 1 nodes and 0 points as elements, expected at least one cell; try to mesh before saving, in Gmsh with a physical group for the body"
    );
}

/// More than 20 000 files that are cut, or have random bytes in random places.
#[test]
fn spoiled_files_are_refused_or_read() {
    let texts: Vec<String> = types()
        .iter()
        .map(|(nodes, vertices, ..)| one_cell(nodes, vertices, skew(3).0))
        .chain([PLATE.to_owned()])
        .collect();
    let files: Vec<&[u8]> = texts.iter().map(String::as_bytes).collect();
    assert!(files.len() * 1540 > 20_000);
    let refused = spoil_at_random("mail", &files);
    assert!(refused > 10_000, "{refused} were refused");
}
