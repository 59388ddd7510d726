//! Files of Gmsh without physical groups, with groups that overlap, and in partitions. `meshes/field/part-*.msh` were
//! written by Gmsh 4.15: a rectangle of 2 × 1 from two squares, in three partitions.

use std::path::Path;

use amontons::mesh::{self, Mesh, MeshFile, gmsh};

use super::decks::{regions, sides};

fn read(name: &str) -> MeshFile {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/field").join(name);
    let read = mesh::read_all(&path).unwrap_or_else(|error| panic!("{error}"));
    read.mesh.check().unwrap_or_else(|error| panic!("{name}: {error}"));
    read
}

fn tags() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/field/tags.msh");
    std::fs::read_to_string(path).expect("a file")
}

fn parse(text: &str) -> Mesh {
    gmsh::parse(text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
}

/// Sizes beside those by hand, to the digits of coordinates that Gmsh computes.
fn near<'n>(found: &[(&'n str, f64)], expected: &[(&'n str, f64)]) {
    assert_eq!(found.iter().map(|of| of.0).collect::<Vec<_>>(), expected.iter().map(|of| of.0).collect::<Vec<_>>());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found.1 - expected.1).abs() < 1e-10, "{found:?} {expected:?}");
    }
}

#[test]
fn curves_name_sides_where_no_group_does() {
    let mesh = read("tags.msh").mesh;
    let expected = [("curve-11", 2, 3.0), ("curve-12", 1, 1.0), ("curve-13", 2, 3.0), ("curve-14", 1, 1.0)];
    assert_eq!(sides(&mesh), expected);
    assert_eq!(regions(&mesh), [("body", 3.0)]);
    // A group of one curve is enough to say which curves are meant.
    let grouped = parse(&tags().replace("1 1 2 0 11 1 2\n", "1 1 2 5 11 1 2\n"));
    assert_eq!(sides(&grouped), [("5", 1, 1.0)]);
    // Groups of the surface alone leave the curves their tags.
    let of_cells = parse(&tags().replace("3 2 0 1", "3 2 8 1"));
    assert_eq!((sides(&of_cells).len(), regions(&of_cells)), (4, vec![("8", 3.0)]));
}

/// Two surfaces are two regions, and the curve between them is no side. One curve around the body stays the boundary.
#[test]
fn surfaces_name_regions_if_there_are_several() {
    let two = tags()
        .replace("8 3 2 0 1 2 3 6 5", "8 3 2 0 2 2 3 6 5")
        .replace("$Elements\n8\n", "$Elements\n9\n9 1 2 0 15 2 5\n");
    let mesh = parse(&two);
    assert_eq!(regions(&mesh), [("surface-1", 1.0), ("surface-2", 2.0)]);
    assert_eq!(
        sides(&mesh).iter().map(|side| side.0).collect::<Vec<_>>(),
        ["curve-11", "curve-12", "curve-13", "curve-14"]
    );
    let around = (12..15).fold(tags(), |text, curve| text.replace(&format!("1 2 0 {curve} "), "1 2 0 11 "));
    assert_eq!(sides(&parse(&around)), [("boundary", 6, 8.0)]);
    let none = (11..15).fold(tags(), |text, curve| text.replace(&format!("1 2 0 {curve} "), "1 2 0 0 "));
    assert_eq!(sides(&parse(&none)), [("boundary", 6, 8.0)]);
}

/// Of a group within another one the inner keeps its name; Gmsh writes its cells once per group.
#[test]
fn groups_within_others_are_regions_of_their_own() {
    let MeshFile { mesh, skipped, .. } = read("overlap.msh");
    assert_eq!((mesh.cell_count(), regions(&mesh)), (2, vec![("all", 2.0), ("soft", 2.0)]));
    assert_eq!(sides(&mesh), [("wall", 1, 2.0)]);
    let told: Vec<(&str, usize)> = skipped.iter().map(|skipped| (skipped.what.as_str(), skipped.count)).collect();
    assert_eq!(told, [("groups beside one of cells in \"all\", \"soft\": these are in the region \"soft\"", 1)]);
}

const HEAD: &str =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"left\"\n2 2 \"upper\"\n$EndPhysicalNames\n";

/// Three squares in a row in version 4.1, whose entities have these groups.
fn row(groups: [&str; 3]) -> String {
    let entities: String = (1..4).zip(groups).map(|(tag, groups)| format!("{tag} 0 0 0 3 1 0 {groups} 0\n")).collect();
    let nodes: String = (1..=8).map(|tag| format!("{tag}\n")).collect();
    let points: String = (0..8).map(|at| format!("{} {} 0\n", at / 2, at % 2)).collect();
    let cells: String = (0..3)
        .map(|at| {
            let n = 2 * at;
            format!("2 {} 3 1\n{} {} {} {} {}\n", at + 1, at + 1, n + 1, n + 3, n + 4, n + 2)
        })
        .collect();
    format!(
        "{HEAD}$Entities\n0 0 3 0\n{entities}$EndEntities\n$Nodes\n1 8 1 8\n2 1 0 8\n{nodes}{points}$EndNodes\n\
         $Elements\n3 3 1 3\n{cells}$EndElements\n"
    )
}

/// Groups that only overlap share a region of both names; of groups with the same cells the first counts.
#[test]
fn groups_that_overlap_share_a_region() {
    let of = |groups: [&str; 3]| -> Vec<(String, f64)> {
        let mesh = parse(&row(groups));
        regions(&mesh).into_iter().map(|(name, area)| (name.to_owned(), area)).collect()
    };
    let named = |all: &[(&str, f64)]| all.iter().map(|(name, area)| ((*name).to_owned(), *area)).collect::<Vec<_>>();
    assert_eq!(of(["1 1", "2 1 2", "1 2"]), named(&[("left", 1.0), ("upper", 1.0), ("left+upper", 1.0)]));
    assert_eq!(of(["1 1", "1 1", "2 1 2"]), named(&[("left", 2.0), ("upper", 1.0)]));
    assert_eq!(of(["2 1 2", "2 1 2", "2 2 1"]), named(&[("left", 3.0)]));
    assert_eq!(of(["1 1", "1 2", "1 2"]), named(&[("left", 1.0), ("upper", 2.0)]));
}

/// Partitions are parts of one mesh: its groups, or its curves and surfaces, are those that were parted. What lies
/// between partitions is no side.
#[test]
fn partitions_are_read_as_one_mesh() {
    for file in ["41-ghosts.msh", "22-ghosts.msh", "41-ghosts-binary.msh", "22-ghosts-binary.msh"] {
        let MeshFile { mesh, skipped, .. } = read(&format!("part-named-{file}"));
        assert_eq!((mesh.cell_count(), mesh.points.len(), skipped.len()), (16, 15, 0), "{file}");
        near(&regions(&mesh), &[("left half", 1.0), ("right half", 1.0)]);
        let lengths: Vec<(&str, f64)> = sides(&mesh).into_iter().map(|(name, _, length)| (name, length)).collect();
        near(&lengths, &[("bottom", 2.0), ("right", 1.0)]);
    }
    for file in ["part-bare-41.msh", "part-bare-22.msh"] {
        let mesh = read(file).mesh;
        assert_eq!(mesh.cell_count(), 16, "{file}");
        near(&regions(&mesh), &[("surface-1", 1.0), ("surface-2", 1.0)]);
        let lengths: Vec<(&str, f64)> = sides(&mesh).into_iter().map(|(name, _, length)| (name, length)).collect();
        near(
            &lengths,
            &[1, 2, 3, 4, 5, 6]
                .map(|tag| (["", "curve-1", "curve-2", "curve-3", "curve-4", "curve-5", "curve-6"][tag], 1.0)),
        );
    }
}

/// Elements of ghost entities and of partitions that only borrow them are left out.
#[test]
fn ghosts_are_left_out() {
    let two = tags().replace("8 3 2 0 1 2 3 6 5", "8 3 4 0 1 1 -2 2 3 6 5");
    assert_eq!(parse(&two).cell_count(), 1);
    let ghosts = row(["1 1", "1 1", "1 1"])
        .replace("$Nodes", "$PartitionedEntities\n2\n1\n9 1\n0 0 0 0\n$EndPartitionedEntities\n$Nodes");
    assert_eq!(parse(&ghosts.replace("2 3 3 1\n", "2 9 3 1\n")).cell_count(), 2);
    assert!(gmsh::parse(ghosts.replace("2 3 3 1\n", "2 8 3 1\n").as_bytes()).is_err());
}
