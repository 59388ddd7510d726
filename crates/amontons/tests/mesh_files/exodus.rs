//! Exodus files: `meshes/exodus.py` made those of the tests with the netCDF library, and `meshes/exodus.txt` is what
//! VTK reads of them.

use amontons::mesh::{Mesh, defects, parse};
use amontons::tensor::Point;

use super::abaqus::sorted;
use super::decks::{regions, sides};
use super::files::read as file;
use super::hostile::{refusal, replaced, spoil_at_random, spoil_counts};
use super::{assert_same, region, side};

const PLATE: &[u8] = include_bytes!("../meshes/plate-3-classic.e");

fn read(bytes: &[u8]) -> Mesh {
    let mesh = parse("e", bytes).unwrap_or_else(|error| panic!("{error}")).mesh;
    mesh.check().unwrap_or_else(|error| panic!("{error}"));
    mesh
}

/// Blocks, sets of sides and sets of nodes by their names, or by their numbers where they have none.
#[test]
fn a_plate_has_its_blocks_and_sets() {
    let files: [&[u8]; 4] = [
        PLATE,
        include_bytes!("../meshes/plate-3-64bit-offset.e"),
        include_bytes!("../meshes/plate-3-64bit-data.e"),
        include_bytes!("../meshes/plate-4.e"),
    ];
    for bytes in files {
        let mesh = read(bytes);
        assert_eq!((mesh.dim, mesh.points.len(), mesh.cell_count()), (2, 12, 8));
        assert_eq!(mesh.points[7], [1.5, 0.25, 0.0]);
        assert_eq!(mesh.regions, ["steel", "7"]);
        assert!((region(&mesh, "steel").0 - 0.5).abs() < 1e-15 && (region(&mesh, "7").0 - 0.25).abs() < 1e-15);
        let sides: Vec<(&str, usize)> = mesh.facets.iter().map(|(name, set)| (name.as_str(), set.len())).collect();
        // The set of nodes "left" holds a node beside the set of sides of that name, which stays alone.
        assert_eq!(sides, [("9", 3), ("bottom", 3), ("left", 2), ("right", 2)]);
        // Length, ∫ x and ∫ x·ν.
        for (name, expected) in [
            ("9", (1.5, 1.125, 0.75)),
            ("bottom", (1.5, 1.125, 0.0)),
            ("left", (0.5, 0.0, 0.0)),
            ("right", (0.5, 0.75, 0.75)),
        ] {
            let found = side(&mesh, &mesh.facets[name]);
            let errors = [found.0 - expected.0, found.1 - expected.1, found.2 - expected.2];
            assert!(errors.iter().all(|error| error.abs() < 1e-15), "{name}: {found:?}");
        }
        let at = |name: &str| -> Vec<Point> {
            mesh.edges[name].node_list().into_iter().map(|node| mesh.points[node as usize]).collect()
        };
        assert_eq!(at("corner"), [[1.5, 0.5, 0.0]]);
        assert_eq!(at("nodeset_4"), [[0.5, 0.25, 0.0]]);
    }
}

/// Two hexahedra under a skin of two shells: the block of shells and the side set on them are left out and told; blocks
/// and sets without names are called by their numbers.
#[test]
fn shells_beside_solids_are_left_out() {
    let found = parse("e", include_bytes!("../meshes/field/skin.e")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((found.mesh.cell_count(), regions(&found.mesh)), (2, vec![("1", 2.0)]));
    assert_eq!(sides(&found.mesh), [("10", 2, 2.0), ("20", 2, 2.0)]);
    let told: Vec<(&str, usize)> = found.skipped.iter().map(|skipped| (skipped.what.as_str(), skipped.count)).collect();
    let expected = [
        ("shells of the block \"2\" (Q1 quadrilateral)", 2),
        ("sides in the side set \"30\" that are not those of cells of the body", 2),
    ];
    assert_eq!(told, expected);
}

/// Cells have the nodes, and sides the nodes, that VTK reads of them; cells without the nodes in the middle of their
/// faces get these besides.
#[test]
fn single_cells_are_those_that_vtk_reads() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let text = std::fs::read_to_string(folder.join("exodus.txt")).expect("a file");
    let numbers = |words: &str| -> Vec<Point> {
        let all: Vec<f64> = words.split(' ').map(|word| word.parse().expect("a number")).collect();
        all.chunks_exact(3).map(|point| [point[0], point[1], point[2]]).collect()
    };
    let order = |mut points: Vec<Point>| {
        points.sort_by(|a, b| a.partial_cmp(b).expect("finite"));
        points
    };
    let (mut cells, mut sides) = (0, 0);
    for part in text.split("cell ").skip(1) {
        let mut lines = part.lines();
        let name = lines.next().and_then(|line| line.split(' ').next()).expect("a name");
        let (nodes, named): (Vec<&str>, Vec<&str>) = lines.partition(|line| line.starts_with("node "));
        let nodes: Vec<Point> = nodes.iter().flat_map(|line| numbers(&line["node ".len()..])).collect();
        let mesh = read(&std::fs::read(folder.join(format!("{name}.e"))).expect("a file"));
        let at = |list: &[u32]| -> Vec<Point> { list.iter().map(|&node| mesh.points[node as usize]).collect() };
        assert_eq!(at(&mesh.blocks[0].nodes)[..nodes.len()], nodes, "{name}");
        assert_eq!(defects::defects(&mesh), [], "{name}");
        assert_eq!(mesh.facets.len(), named.len(), "{name}");
        for line in named {
            let (side, theirs) = line["side ".len()..].split_once(' ').expect("nodes");
            let (ours, theirs) = (order(at(&mesh.facets[side].node_list())), order(numbers(theirs)));
            let common: Vec<Point> = ours.iter().copied().filter(|point| theirs.contains(point)).collect();
            assert_eq!(common, theirs, "{name}, {side}");
            // Four vertices and four nodes on the edges lack one in the middle.
            assert_eq!(ours.len() - theirs.len(), usize::from(theirs.len() == 8), "{name}, {side}");
            sides += 1;
        }
        cells += 1;
    }
    assert_eq!((cells, sides), (11, 56));
}

/// What meshio writes of the ring of Gmsh is the ring of Gmsh. It writes no names: blocks have their numbers.
#[test]
fn a_file_of_another_program_is_the_mesh_it_was_made_of() {
    let [mut ours, theirs] = ["quarter_ring_meshio.e", "quarter_ring.msh"].map(file);
    assert_eq!(ours.regions, ["4"]);
    ours.regions.clone_from(&theirs.regions);
    for (number, name) in ["start", "outer", "end", "inner"].into_iter().enumerate() {
        let set = ours.facets.remove(&number.to_string()).expect("a side of this number");
        ours.facets.insert(name.to_owned(), set);
    }
    assert_same(&sorted(&ours), &sorted(&theirs));
}

#[test]
fn what_is_no_exodus_file_is_refused() {
    let message = |bytes: &[u8]| refusal("e", bytes).expect("a refusal").to_string();
    let no_file = message(b"$MeshFormat\n4.1 0 8\n");
    assert!(no_file.starts_with("no netCDF, which an Exodus file is: "), "{no_file}");
    let spoiled = |old: &[u8], new: &[u8]| message(&replaced(PLATE, old, new));
    assert_eq!(
        spoiled(b"coord\0", b"place\0"),
        "netCDF without the coordinates of nodes (coordx, coordy, coordz), expected an Exodus file"
    );
    assert_eq!(
        spoiled(b"QUAD4", b"QUID4"),
        "elements of type \"QUID4\" with 4 nodes, expected bars of 2 or 3 nodes, triangles of 3 or 6, quadrilaterals of 4, 8 or 9, tetrahedra of 4 or 10, pyramids of 5, 13 or 14, wedges of 6, 15 or 18, or hexahedra of 8, 20 or 27"
    );
    assert_eq!(
        spoiled(&[0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 6, 0, 0, 0, 5], &[0, 0, 0, 1, 0, 0, 0, 13, 0, 0, 0, 6, 0, 0, 0, 5]),
        "node 13 of cell 1 of connect1, expected one of the nodes 1 to 12"
    );
}

#[test]
fn spoiled_files_are_refused_or_read() {
    let files: [&[u8]; 3] = [PLATE, include_bytes!("../meshes/plate-4.e"), include_bytes!("../meshes/hex20.e")];
    let refused = spoil_at_random("e", &files);
    assert!(refused > 200, "{refused} were refused");
    spoil_counts("e", &files);
}
