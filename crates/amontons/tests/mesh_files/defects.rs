//! Each defect by one spoiled mesh.

use amontons::element::{P1_SEGMENT, P1_TETRAHEDRON, P1_TRIANGLE, P2_TRIANGLE};
use amontons::mesh::defects::{Defect, Defects, components, defects};
use amontons::mesh::{Block, Diagonal, Elements, FacetSet, Mesh};

fn square() -> Mesh {
    Mesh::rectangle([3.0, 3.0], [3, 3], Diagonal::Right).expect("a mesh")
}

/// The one kind of defect that a mesh has.
fn only(mesh: &Mesh) -> Defects {
    let mut found = defects(mesh);
    assert_eq!(found.len(), 1, "{found:?}");
    found.remove(0)
}

#[test]
fn sound_meshes_have_none() {
    let solid = Mesh::rectangle([1.0, 1.0], [2, 2], Diagonal::Right)
        .expect("a mesh")
        .extruded(1.0, 2, ["low", "high"])
        .expect("a mesh");
    for mesh in [
        square(),
        Mesh::interval(1.0, 3, Elements::P2).expect("a mesh"),
        Mesh::rectangle_of(Elements::Q2, [1.0, 1.0], [3, 3], Diagonal::Right).expect("a mesh"),
        Mesh::disc(1.0, [3, 12], Elements::P2).expect("a mesh"),
        Mesh::ring([0.5, 1.0], None, [2, 9], Elements::Q2).expect("a mesh"),
        Mesh::box_([1.0, 1.0, 1.0], [3, 3, 3], Elements::P2).expect("a mesh"),
        Mesh::cylinder([0.5, 1.0], None, 1.0, [2, 8, 2], Elements::Q2).expect("a mesh"),
        solid.quadratic().expect("a mesh"),
        solid,
    ] {
        assert_eq!(defects(&mesh), []);
        assert_eq!(components(&mesh).len(), 1);
    }
}

#[test]
fn inverted_and_degenerate_cells() {
    let mut mesh = square();
    mesh.blocks[0].nodes.swap(6, 7);
    let found = only(&mesh);
    // Cell 2 is the lower triangle of the second square: nodes 1, 2, 6 at (1,0), (2,0), (2,1).
    assert_eq!(found.total, 1);
    assert_eq!(
        found.first,
        [Defect::Inverted { cell: 2, nodes: vec![2, 1, 6], centre: [5.0 / 3.0, 1.0 / 3.0, 0.0], jacobian: -1.0 }]
    );
    let mut mesh = square();
    // The first square loses its height at its right end: its lower triangle (0,0), (1,0), (1,0) has none.
    mesh.points[5] = [1.0, 0.0, 0.0];
    assert!(defects(&mesh)[0].first.contains(&Defect::Degenerate {
        cell: 0,
        nodes: vec![0, 1, 5],
        centre: [2.0 / 3.0, 0.0, 0.0],
        jacobian: 0.0
    }));
    // A quadratic triangle whose middle node has gone beyond its corner.
    let mut mesh = Mesh::rectangle_of(Elements::P2, [1.0, 1.0], [1, 1], Diagonal::Right).expect("a mesh");
    let (a, b, middle) =
        (mesh.blocks[0].nodes[0] as usize, mesh.blocks[0].nodes[1] as usize, mesh.blocks[0].nodes[3] as usize);
    let beyond = std::array::from_fn(|d| 1.2 * mesh.points[b][d] - 0.2 * mesh.points[a][d]);
    mesh.points[middle] = beyond;
    assert!(matches!(only(&mesh).first[0], Defect::Inverted { cell: 0, .. }));
}

#[test]
fn the_verdict_on_a_cell_does_not_depend_on_the_unit_of_length() {
    for unit in [1e-9, 1.0, 1e9] {
        let mut mesh = square().scaled(unit);
        assert_eq!(defects(&mesh), []);
        mesh.points[5][0] += 10.0 * unit;
        assert!(matches!(defects(&mesh)[0].first[0], Defect::Inverted { .. }));
    }
}

#[test]
fn only_the_first_five_are_listed() {
    let mut mesh = square();
    mesh.points.iter_mut().for_each(|p| p[0] = -p[0]);
    let found = only(&mesh);
    assert_eq!((found.total, found.first.len()), (18, 5));
    assert!(found.to_string().ends_with("\nand 13 more of this kind"), "{found}");
}

#[test]
fn duplicate_and_overlapping_cells() {
    let mut mesh = square();
    mesh.blocks[0].nodes.extend([5, 6, 10]);
    let found = defects(&mesh);
    assert!(matches!(&found[0].first[..], [Defect::Duplicate { cell: 18, other: 8, .. }]), "{found:?}");
    assert!(
        matches!(&found[1].first[0], Defect::Overlap { cells, .. } if cells.contains(&18) && cells.len() == 3),
        "{found:?}"
    );
}

#[test]
fn hanging_nodes() {
    // Two squares, the right one cut in two at half its height.
    let points =
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0], [1.0, 0.5]].map(|[x, y]| [x, y, 0.0]);
    let mut mesh = square();
    mesh.points = points.to_vec();
    mesh.facets.clear();
    mesh.blocks[0].nodes = vec![0, 1, 2, 0, 2, 3, 1, 4, 6, 6, 4, 5, 6, 5, 2];
    let found = only(&mesh);
    assert_eq!(
        (found.total, &found.first[..]),
        (1, &[Defect::Hanging { node: 6, at: [1.0, 0.5, 0.0], cell: 0, facet: vec![1, 2] }][..])
    );
    // Sound when the left part has it too.
    mesh.blocks[0].nodes = vec![0, 1, 6, 0, 6, 2, 0, 2, 3, 1, 4, 6, 6, 4, 5, 6, 5, 2];
    assert_eq!(defects(&mesh), []);
}

#[test]
fn hanging_nodes_in_space_and_on_curved_facets() {
    // A cube on four smaller ones.
    let mut mesh = Mesh::box_([2.0, 2.0, 1.0], [2, 2, 1], Elements::Q1).expect("a mesh");
    mesh.facets.clear();
    let find = |mesh: &Mesh, at: [f64; 3]| mesh.points.iter().position(|p| *p == at).expect("a node") as u32;
    let below = [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 2.0, 1.0], [0.0, 2.0, 1.0]].map(|at| find(&mesh, at));
    let first = mesh.points.len() as u32;
    mesh.points.extend([[0.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 2.0, 2.0], [0.0, 2.0, 2.0]]);
    mesh.blocks[0].nodes.extend(below.into_iter().chain(first..first + 4));
    let found = only(&mesh);
    // The middles of four edges and that of the face.
    assert_eq!(found.total, 5);
    assert!(found.first.iter().all(|d| matches!(d, Defect::Hanging { at, cell: 4, .. } if at[2] == 1.0)), "{found}");
    // Two quadratic triangles with a common curved edge, which the second has in two halves: one parabola through the
    // same points.
    let parabola = |x: f64| [x, x * (1.0 - x), 0.0];
    let mut mesh = square();
    mesh.facets.clear();
    mesh.points = [0.0, 0.25, 0.5, 0.75, 1.0].map(parabola).to_vec();
    mesh.points.extend([[0.5, -1.0, 0.0], [0.25, -0.5, 0.0], [0.75, -0.5, 0.0]]);
    mesh.points.extend([[0.5, 2.0, 0.0], [0.25, 1.0, 0.0], [0.75, 1.0, 0.0], [0.5, 1.0, 0.0]]);
    mesh.blocks[0].element = &P2_TRIANGLE;
    mesh.blocks[0].nodes = vec![5, 4, 0, 7, 2, 6, 0, 2, 8, 1, 11, 9, 2, 4, 8, 3, 10, 11];
    let found = only(&mesh);
    assert_eq!(
        found.first,
        [1, 3].map(|node| Defect::Hanging { node, at: mesh.points[node as usize], cell: 0, facet: vec![4, 0, 2] }),
        "{found}"
    );
}

#[test]
fn facets_that_do_not_match_in_space() {
    // A cube with two tetrahedra on its upper face: the diagonal is the tetrahedra's only.
    let mut mesh = Mesh::box_([1.0, 1.0, 1.0], [1, 1, 1], Elements::Q1).expect("a mesh");
    mesh.facets.clear();
    let top = [4, 5, 6, 7].map(|i| mesh.blocks[0].nodes[i]);
    let apex = mesh.points.len() as u32;
    mesh.points.push([0.5, 0.5, 2.0]);
    mesh.blocks.push(Block {
        element: &P1_TETRAHEDRON,
        region: 0,
        nodes: vec![top[0], top[1], top[2], apex, top[0], top[2], top[3], apex],
    });
    let found = only(&mesh);
    assert_eq!(found.total, 2, "{found}");
    assert!(
        found.first.iter().all(|d| matches!(
            d,
            Defect::Mismatch { cell: 0, other: 1 | 2, .. } | Defect::Mismatch { cell: 1 | 2, other: 0, .. }
        )),
        "{found}"
    );
}

#[test]
fn a_crack_is_no_defect() {
    // The nodes 5 and 6 of the line y = 1 are doubled for the cells above it; 4 and 7 are the fronts of the crack.
    let mut mesh = square();
    mesh.facets.clear();
    let doubled = [mesh.points.len() as u32, mesh.points.len() as u32 + 1];
    mesh.points.extend([mesh.points[5], mesh.points[6]]);
    let cells: Vec<Vec<u32>> = mesh.blocks[0].cells().map(<[u32]>::to_vec).collect();
    let above = |cell: &[u32]| cell.iter().any(|&n| mesh.points[n as usize][1] > 1.5);
    mesh.blocks[0].nodes = cells
        .iter()
        .flat_map(|cell| {
            let above = above(cell);
            cell.iter().map(move |&n| if above && (n == 5 || n == 6) { doubled[n as usize - 5] } else { n })
        })
        .collect();
    assert_eq!(defects(&mesh), []);
    assert_eq!(mesh.boundary().len(), 12 + 6);
}

#[test]
fn sides_inside_the_body_beside_it_and_twice() {
    let mut mesh = square();
    mesh.facets.insert("seam".to_owned(), FacetSet::of(&P1_SEGMENT, vec![4, 5, 5, 6]));
    let found = only(&mesh);
    assert_eq!(found.total, 2);
    assert!(
        matches!(&found.first[0], Defect::Inside { side, nodes, cells: [1, 6], .. } if side == "seam" && *nodes == [4, 5]),
        "{found}"
    );
    assert_eq!(found.first[0].side(), Some("seam"));
    let mut mesh = square();
    mesh.facets.insert("diagonal".to_owned(), FacetSet::of(&P1_SEGMENT, vec![0, 2]));
    assert!(matches!(&only(&mesh).first[0], Defect::Stray { side, centre: [1.0, 0.0, 0.0], .. } if side == "diagonal"));
    let mut mesh = square();
    mesh.facets.insert("double".to_owned(), FacetSet::of(&P1_SEGMENT, vec![0, 1, 1, 2, 1, 0]));
    assert!(matches!(&only(&mesh).first[0], Defect::Repeated { times: 2, .. }));
}

#[test]
fn nodes_that_do_not_exist_or_are_not_used() {
    let mut mesh = square();
    mesh.blocks[0].nodes[4] = 99;
    assert_eq!(only(&mesh).to_string(), "cell 1 has node 99, expected one below 16, the number of nodes");
    let mut mesh = square();
    mesh.facets.insert("far".to_owned(), FacetSet::of(&P1_SEGMENT, vec![0, 77]));
    assert_eq!(
        only(&mesh).to_string(),
        "facet 0 of side \"far\" has node 77, expected one below 16, the number of nodes"
    );
    let mut mesh = square();
    mesh.points.push([9.0, 0.0, 0.0]);
    assert_eq!(only(&mesh).to_string(), "node 16 at [9.0, 0.0, 0.0] belongs to no cell");
    let mut mesh = square();
    mesh.points[3][1] = f64::NAN;
    assert!(matches!(only(&mesh).first[0], Defect::Coordinate { node: 3, .. }));
}

#[test]
fn parts_that_touch_without_common_nodes_are_parts() {
    let mut mesh = square();
    let second = square();
    let shift = mesh.points.len() as u32;
    mesh.points.extend(second.points.iter().map(|p| [p[0] + 3.0, p[1] + 0.5, 0.0]));
    mesh.blocks.push(Block {
        element: &P1_TRIANGLE,
        region: 0,
        nodes: second.blocks[0].nodes.iter().map(|n| n + shift).collect(),
    });
    assert_eq!(defects(&mesh), []);
    let parts = components(&mesh);
    assert_eq!(parts.iter().map(|p| (p.cells, p.nodes.len())).collect::<Vec<_>>(), [(18, 16), (18, 16)]);
    assert_eq!(parts[1].nodes, (16..32).collect::<Vec<_>>());
    assert_eq!(parts[1].bounds(&mesh), [[3.0, 0.5, 0.0], [6.0, 3.5, 0.0]]);
}
