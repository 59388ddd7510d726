//! Input files as preprocessors write them: in several files, with shells on solids, with sets of what is left out.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use amontons::mesh::{self, Mesh, MeshFile, MeshFileError, Skipped, inp};

use super::{region, side};

fn field(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/field").join(name)
}

fn read(text: &str) -> MeshFile {
    inp::parse(text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
}

/// A size without the round-off of its sum.
fn rounded(size: f64) -> f64 {
    (size * 1e12).round() / 1e12
}

/// Facets and area of each side.
pub fn sides(mesh: &Mesh) -> Vec<(&str, usize, f64)> {
    mesh.facets.iter().map(|(name, set)| (name.as_str(), set.len(), rounded(side(mesh, set).0))).collect()
}

/// Name and size of each region.
pub fn regions(mesh: &Mesh) -> Vec<(&str, f64)> {
    mesh.regions.iter().map(|name| (name.as_str(), rounded(region(mesh, name).0))).collect()
}

fn told(skipped: &[Skipped]) -> Vec<String> {
    skipped
        .iter()
        .map(|skipped| format!("{}: {} × {}", skipped.line.unwrap_or(0), skipped.count, skipped.what))
        .collect()
}

/// A file with others in memory.
fn with(main: &str, others: &[(&str, &str)]) -> Result<MeshFile, MeshFileError> {
    let others: BTreeMap<&str, &str> = others.iter().copied().collect();
    let mut include = |name: &str| {
        others.get(name).map(|text| Arc::from(text.as_bytes())).ok_or_else(|| "which is not there".to_owned())
    };
    mesh::parse_file("decks/main.inp", main.as_bytes(), Some(&mut include))
}

/// The mesh and the sides stand in a file of their own, as cgx writes them: a rectangle of 3 × 2.
#[test]
fn a_deck_includes_its_mesh() {
    for name in ["main.inp", "main-mesh.msh"] {
        let read = mesh::read_all(&field(name)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(regions(&read.mesh), [("Eall", 6.0)], "{name}");
        let whole = ("Nall", 4, 10.0);
        let expected = if name == "main.inp" { vec![("HIGH", 1, 3.0), ("LOW", 1, 3.0), whole] } else { vec![whole] };
        assert_eq!(sides(&read.mesh), expected, "{name}");
    }
}

const NODES: &str = "*NODE\n1,0,0\n2,3,0\n3,3,2\n4,0,2\n";

/// Names are seen from the folder of the file that includes; an included file may end within the data of a keyword; of
/// what is skipped the file and its line are told. The whole text is the same mesh.
#[test]
fn included_files_stand_where_they_are_included() {
    let main = "*HEADING\n*Include,\n  input = \"parts\\nodes.nam\"\n3,3,2\n4,0,2\n*INCLUDE, INPUT=cells.dat\n*SURFACE,NAME=LOW\n1,S1\n";
    let others = [
        ("decks/parts/nodes.nam", "** nodes\n*INCLUDE,INPUT=../first.nam\n2,3,0"),
        ("decks/parts/../first.nam", "*NODE\n1,0,0\n"),
        ("decks/cells.dat", "*MATERIAL, NAME=M\n\n*ELEMENT, TYPE=CPE4, ELSET=E\n1,1,2,3,4\n*ELASTIC\n1\n"),
    ];
    let read = with(main, &others).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((regions(&read.mesh), sides(&read.mesh)), (vec![("E", 6.0)], vec![("LOW", 1, 3.0)]));
    let places: Vec<_> = read.skipped.iter().map(|s| (s.what.as_str(), s.file.as_deref(), s.line)).collect();
    let file = Some("decks/cells.dat");
    assert_eq!(places, [("*MATERIAL", file, Some(1)), ("*ELASTIC", file, Some(5))]);
    let whole = read.whole.expect("a whole text");
    let again = inp::parse(&whole).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(sides(&again.mesh), [("LOW", 1, 3.0)]);
    assert!(again.whole.is_none());
}

#[test]
fn faults_of_included_files_are_told_with_their_places() {
    let main = format!("{NODES}*INCLUDE, INPUT=cells.dat\n*NSET, NSET=N, GENERATE\n9,1\n");
    let cell = "*ELEMENT, TYPE=CPE4, ELSET=E\n1,1,2,3,4\n";
    let refused = |main: &str, others: &[(&str, &str)]| with(main, others).expect_err(main).to_string();
    let short = main.split("*NSET").next().expect("a text");
    assert_eq!(
        refused(short, &[("decks/cells.dat", "*ELEMENT, TYPE=CPE4\n\n1,1,2,3,9\n")]),
        "decks/cells.dat: line 3: found node 9, expected the tag of one of the 4 nodes of the file"
    );
    let faults = [
        // Behind an included file lines count on.
        (
            vec![("decks/cells.dat", cell)],
            "line 8: found \"9,1\", expected a first number, a last one that is not smaller, and a positive step",
        ),
        (
            vec![],
            "line 6: found *INCLUDE of \"cells.dat\", which is not there, expected a file beside the one that includes it",
        ),
        (
            vec![("decks/cells.dat", "\n*INCLUDE, INPUT=../decks/./cells.dat\n")],
            "decks/cells.dat: line 2: found *INCLUDE of \"../decks/./cells.dat\", which includes this file, expected files that do not include themselves",
        ),
        (
            vec![("decks/cells.dat", "*INCLUDE, FILE=x\n")],
            "decks/cells.dat: line 1: found *INCLUDE without INPUT, expected *INCLUDE, INPUT=… with the name of a file",
        ),
    ];
    for (others, expected) in faults {
        assert_eq!(refused(&main, &others), expected);
    }
    let alone = inp::parse(main.as_bytes()).expect_err("a refusal").to_string();
    assert_eq!(
        alone,
        "line 6: found *INCLUDE of \"cells.dat\", but a text without a folder, expected all nodes and elements in one text; read the file from its folder, or put the contents of the other file in the place of the line"
    );
}

/// Files that include more and more, under ever new names or many times, end soon.
#[test]
fn includes_are_bounded() {
    let endless = |text: &'static str| {
        let mut count = 0;
        let mut include = |_: &str| {
            count += 1;
            Ok(Arc::from(text.replace('#', &count.to_string()).as_bytes()))
        };
        let error = mesh::parse_file("a.inp", text.as_bytes(), Some(&mut include)).expect_err(text).to_string();
        (error, count)
    };
    let (error, count) = endless("*INCLUDE, INPUT=x#\n");
    assert!(error.ends_with("expected at most 16 deep and 1000 in all") && count == 16, "{count}: {error}");
    let line = "*INCLUDE, INPUT=leaf\n";
    let wide = line.repeat(1001);
    let mut include = |_: &str| Ok(Arc::from("** nothing\n".as_bytes()));
    let error = mesh::parse_file("a.inp", wide.as_bytes(), Some(&mut include)).expect_err("a refusal").to_string();
    assert!(error.starts_with("line 1001: found *INCLUDE of \"leaf\", 1 deep and the 1001th in all"), "{error}");
}

/// Confined reading admits what lies below the folder of the mesh file, and nothing else.
#[test]
fn confined_decks_include_what_is_beside_them() {
    let folder = std::env::temp_dir().join(format!("amontons-decks-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("in/sub")).expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("a file");
    write("in/sub/nodes.nam", NODES);
    write("outside.nam", NODES);
    let cell = "*ELEMENT, TYPE=CPE4, ELSET=E\n1,1,2,3,4\n";
    write("in/below.inp", &format!("*INCLUDE, INPUT=sub/nodes.nam\n{cell}"));
    write("in/above.inp", &format!("*INCLUDE, INPUT=../outside.nam\n{cell}"));
    for (name, confined) in [("in/below.inp", true), ("in/below.inp", false), ("in/above.inp", false)] {
        let path = folder.join(name);
        let read = if confined { mesh::read_confined(&path) } else { mesh::read_all(&path) };
        assert_eq!(regions(&read.unwrap_or_else(|error| panic!("{error}")).mesh), [("E", 6.0)]);
    }
    let refused = mesh::read_confined(&folder.join("in/above.inp")).expect_err("a refusal").to_string();
    assert!(refused.contains("line 1: found *INCLUDE of \"../outside.nam\", which is not in the folder"), "{refused}");
    std::fs::remove_dir_all(&folder).expect("the folder");
}

/// The faces of a cube as Gmsh writes them: plane elements with sets, beside sets of nodes of the same names.
#[test]
fn facets_of_solids_with_names_are_sides() {
    let cube = std::fs::read_to_string(field("cube.inp")).expect("a file");
    let without_nodes = cube.split("*NSET").next().expect("a text");
    for text in [cube.as_str(), without_nodes] {
        let MeshFile { mesh, skipped, plane, .. } = read(text);
        assert_eq!(sides(&mesh), [("Surface1", 1, 1.0), ("Surface2", 1, 1.0), ("fix", 1, 1.0), ("load", 1, 1.0)]);
        assert_eq!(regions(&mesh), [("Volume1", 1.0)]);
        assert_eq!((skipped, plane, mesh.cell_count()), (Vec::new(), None, 1));
        // Outward: ∫ x·ν is 1 above, and 0 below, where z = 0.
        assert!((side(&mesh, &mesh.facets["load"]).2 - 1.0).abs() < 1e-14);
        assert!(side(&mesh, &mesh.facets["fix"]).2.abs() < 1e-14);
    }
    for kind in ["S4R", "SFM3D4", "M3D4R", "CPE4", "R3D4"] {
        let mesh = read(&cube.replace("CPS4", kind)).mesh;
        assert_eq!(sides(&mesh).len(), 4, "{kind}");
    }
}

/// A box of 10 × 10 × 3.6 as Gmsh 4.15 wrote it, with four physical surfaces and a volume, as sets of elements and of
/// nodes: each face has its own area, though the nodes of one at its rim hold facets of others.
#[test]
fn a_box_of_gmsh_has_its_faces() {
    let read = mesh::read_all(&field("box-groups.inp")).unwrap_or_else(|error| panic!("{error}"));
    let found: Vec<(&str, f64)> = sides(&read.mesh)
        .into_iter()
        .filter(|(name, ..)| !name.starts_with("Surface"))
        .map(|(name, _, area)| (name, (area * 1e9).round() / 1e9))
        .collect();
    let whole = 2.0 * 100.0 + 4.0 * 36.0;
    assert_eq!(found, [("above", 100.0), ("below", 100.0), ("block", whole), ("front", 36.0), ("left", 36.0)]);
    assert!((region(&read.mesh, "block").0 - 360.0).abs() < 1e-9);
    assert_eq!(read.mesh.regions, ["block"]);
}

/// Two tetrahedra in one cube corner: triangles outside are sides, the one between the bodies and one that is no face
/// are not. In a file of Gmsh the physical groups are the regions.
#[test]
fn only_the_boundary_becomes_sides() {
    let text = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,1,1\n\
        *ELEMENT, type=T3D2, ELSET=Line1\n1,1,2\n*ELEMENT, type=CPS3, ELSET=Surface1\n2,1,3,2\n\
        *ELEMENT, type=CPS3, ELSET=Surface2\n3,2,3,4\n*ELEMENT, type=CPS3, ELSET=Surface3\n4,1,2,5\n\
        *ELEMENT, type=C3D4, ELSET=Volume1\n5,1,2,3,4\n*ELEMENT, type=C3D4, ELSET=Volume2\n6,2,5,3,4\n\
        *ELSET,ELSET=floor\n2\n*ELSET,ELSET=between\n3,\n*ELSET,ELSET=iron\n5\n*ELSET,ELSET=rubber\n6\n";
    let MeshFile { mesh, skipped, .. } = read(text);
    assert_eq!(sides(&mesh), [("Surface1", 1, 0.5), ("floor", 1, 0.5)]);
    // Edges (1, 1, 1) − (1, 0, 0), …: |det| = 2.
    let found = regions(&mesh);
    assert_eq!(found.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["iron", "rubber"]);
    assert!((found[0].1 - 1.0 / 6.0).abs() < 1e-12 && (found[1].1 - 2.0 / 6.0).abs() < 1e-12, "{found:?}");
    assert_eq!(
        told(&skipped),
        [
            "7: 1 × elements of type T3D2",
            "7: 4 × element sets without a cell of the body: \"Line1\", \"Surface2\", \"Surface3\", \"between\"",
            "11: 2 × elements of type CPS3",
        ]
    );
}

/// Quadratic faces in the order of Gmsh and of Abaqus: the edge of a plane body of one cell with a node in the middle,
/// at (1, 0.2) of a side from (0, 0) to (2, 0).
#[test]
fn quadratic_lines_are_sides_in_either_order() {
    let text = "*NODE\n1,0,0\n2,2,0\n3,0,2\n4,1,0\n5,1,1\n6,0,1\n*ELEMENT, TYPE=CPE6, ELSET=E\n1,1,2,3,4,5,6\n\
        *ELEMENT, TYPE=T3D3, ELSET=LOW\n2,1,2,4\n*ELEMENT, TYPE=B32, ELSET=SLANT\n3,2,5,3\n*ELEMENT, TYPE=T2D2, ELSET=LEFT\n4,3,1\n";
    let MeshFile { mesh, skipped, .. } = read(text);
    let found = sides(&mesh);
    assert_eq!(found.iter().map(|side| (side.0, side.1)).collect::<Vec<_>>(), [("LEFT", 1), ("LOW", 1), ("SLANT", 1)]);
    for (found, expected) in found.iter().zip([2.0, 2.0, 8.0_f64.sqrt()]) {
        assert!((found.2 - expected).abs() < 1e-12, "{found:?}");
    }
    assert_eq!(skipped, []);
    assert!(mesh.facets.values().flat_map(|set| &set.blocks).all(|block| block.element.name == "P2 segment"));
}

/// A floor of shells below a block: the block is read, the floor told, with the surface on it.
#[test]
fn shells_beside_solids_are_told() {
    let text = std::fs::read_to_string(field("floor.inp")).expect("a file");
    let MeshFile { mesh, skipped, .. } = read(&text);
    assert_eq!((regions(&mesh), sides(&mesh)), (vec![("BODY", 8.0)], vec![("BLOCK", 1, 4.0)]));
    assert_eq!(
        told(&skipped),
        [
            "16: 1 × elements of type S4",
            "16: 1 × element sets without a cell of the body: \"FLOOR\"",
            "19: 1 × *SHELL SECTION",
            "23: 1 × surfaces without a face of the body: \"PLANE\"",
        ]
    );
}

#[test]
fn shells_alone_are_refused_with_their_number() {
    let told = mesh::read(&field("shells.inp")).expect_err("a refusal").to_string();
    let expected = "shells.inp: found 2 elements of type S4R, expected elements that fill a body, C3D… in space, CPS…, CPE… or CAX… in the plane; shells, membranes and beams are not computed: mesh the volume";
    assert!(told.ends_with(expected), "{told}");
    let beams = "*NODE\n1,0,0\n2,1,0\n*ELEMENT,TYPE=B31\n1,1,2\n*ELEMENT,TYPE=MASS\n2,1\n3,2\n";
    let told = inp::parse(beams.as_bytes()).expect_err("a refusal").to_string();
    assert!(told.starts_with("found 2 elements of type MASS, 1 element of type B31, expected elements"), "{told}");
}

/// A later section takes the cells that it names, and one without cells is told.
#[test]
fn later_sections_take_cells() {
    let text = std::fs::read_to_string(field("later-section.inp")).expect("a file");
    let MeshFile { mesh, skipped, .. } = read(&text);
    assert_eq!((mesh.cell_count(), regions(&mesh)), (2, vec![("ALL", 2.0), ("SOFT", 2.0)]));
    assert_eq!(told(&skipped), ["14: 1 × cells that a later section takes from \"ALL\""]);
    let all = text.clone() + "*SOLID SECTION,ELSET=ALL,MATERIAL=LAST\n";
    let MeshFile { mesh, skipped, .. } = read(&all);
    assert_eq!(regions(&mesh), [("ALL", 4.0)]);
    assert_eq!(
        told(&skipped),
        [
            "11: 1 × element sets of cells that are no region: \"SOFT\"",
            "14: 2 × cells that a later section takes from \"ALL\", \"SOFT\""
        ]
    );
    let before = text.replace("*ELSET,ELSET=SOFT\n2\n", "").replace(
        "*SOLID SECTION,ELSET=ALL",
        "*ELEMENT,TYPE=SPRING1,ELSET=NONE\n7,1\n*SOLID SECTION,ELSET=NONE\n*SOLID SECTION,ELSET=ALL",
    ) + "*ELSET,ELSET=SOFT\n2\n";
    let MeshFile { mesh, skipped, .. } = read(&before);
    assert_eq!(regions(&mesh), [("ALL", 2.0), ("SOFT", 2.0)]);
    assert!(
        told(&skipped).contains(&"13: 1 × sections without a cell of the body: \"NONE\"".to_owned()),
        "{skipped:?}"
    );
}

/// Sets with nodes and elements that the file lacks, or that are left out, are read without these.
#[test]
fn sets_of_what_is_not_there_are_told() {
    let text = format!(
        "{NODES}7,9,9\n*ELEMENT, TYPE=CPE4, ELSET=E\n1,1,2,3,4\n*ELEMENT, TYPE=CONN2D2, ELSET=LINKS\n5,1,7\n\
        *NSET, NSET=LOW\n1,2,7,88\n*NSET, NSET=AWAY\n7\n*ELSET, ELSET=MIXED\n1,5,99\n*SURFACE, NAME=RIGHT\n1,S2\n\
        77,S1\n\
        *SURFACE, NAME=BOTH, COMBINE=UNION\nRIGHT, LOW\n"
    );
    let MeshFile { mesh, skipped, .. } = read(&text);
    assert_eq!((regions(&mesh), sides(&mesh)), (vec![("E", 6.0)], vec![("LOW", 1, 3.0), ("RIGHT", 1, 2.0)]));
    assert!(mesh.edges.is_empty(), "{:?}", mesh.edges);
    assert_eq!(
        told(&skipped),
        [
            "9: 1 × elements of type CONN2D2",
            "9: 1 × element sets without a cell of the body: \"LINKS\"",
            "12: 1 × nodes that sets name and the file lacks: \"88\"",
            "13: 1 × node sets without a node of the body: \"AWAY\"",
            "15: 1 × element sets of cells that are no region: \"MIXED\"",
            "16: 2 × elements that sets name and the file lacks: \"77\", \"99\"",
            "20: 1 × *SURFACE, COMBINE=UNION",
        ]
    );
}
