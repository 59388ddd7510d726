//! Refinement of marked cells: the same body, conforming, with cells of bounded shape, and no more of them than needed.

use std::collections::BTreeSet;

use amontons::mesh::defects::defects;
use amontons::mesh::{Bisection, Block, Diagonal, Elements, Mesh};
use amontons::tensor::{Point, length, minus};

use super::refinement::{bodies, side, turned, volume};

/// Numbers in [0, 1) that are the same in each run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / (1_u64 << 31) as f64
    }

    fn cells(&mut self, count: usize, of: usize) -> Vec<usize> {
        (0..count).map(|_| (self.next() * of as f64) as usize).collect()
    }
}

/// Moves the nodes inside the unit square or cube, so that all lengths differ.
pub fn shaken(mut mesh: Mesh, by: f64, seed: u64) -> Mesh {
    let (mut random, dim) = (Random(seed), mesh.dim);
    for x in &mut mesh.points {
        if x[..dim].iter().all(|x| *x > 1e-9 && *x < 1.0 - 1e-9) {
            x[..dim].iter_mut().for_each(|x| *x += by * (random.next() - 0.5));
        }
    }
    mesh
}

pub fn square(n: usize, elements: Elements) -> Mesh {
    Mesh::rectangle_of(elements, [1.0, 1.0], [n, n], Diagonal::Right).expect("a mesh")
}

pub fn cube(n: usize, elements: Elements) -> Mesh {
    Mesh::box_([1.0, 1.0, 1.0], [n; 3], elements).expect("a mesh")
}

/// The vertices of each cell.
fn simplices(mesh: &Mesh) -> Vec<Vec<Point>> {
    let at = |nodes: &[u32]| nodes[..=mesh.dim].iter().map(|&n| mesh.points[n as usize]).collect();
    mesh.blocks.iter().flat_map(|block| block.cells().map(at)).collect()
}

/// Regions, sides and unnamed facets keep their measures over ten rounds of random marks, and cells fit together.
#[test]
fn a_mesh_refined_in_places_is_the_same_body() {
    let all = bodies();
    let others = all.iter().zip(1..).map(|(mesh, seed)| turned(mesh, seed)).collect::<Vec<_>>();
    for (mesh, seed) in all.iter().chain(&others).zip(1..) {
        let (mut random, name) = (Random(seed), mesh.blocks[0].element.name);
        let mut bisection = Bisection::new(mesh);
        // A face that is not plane is bilinear in a hexahedron, and of four triangles when it is cut.
        let keeps = name != "P2 pyramid" && !name.starts_with("Q2");
        for _ in 0..10 {
            let before = bisection.mesh();
            let marked = random.cells(4 - mesh.dim, bisection.cell_count());
            bisection.refine(&marked).expect("a mesh");
            let finer = bisection.mesh();
            finer.check().expect("a sound mesh");
            let found = defects(&finer);
            assert!(found.is_empty(), "{name}: {}", found[0]);
            let volumes = [&finer, mesh].map(volume);
            let tolerance = if keeps { 1e-12 } else { 1e-2 };
            assert!((volumes[0] - volumes[1]).abs() < tolerance * volumes[1], "{name}: {volumes:?}");
            for (on, set) in &mesh.facets {
                let (found, expected) = (side(&finer, &finer.facets[on]), side(mesh, set));
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!(
                        (found - expected).abs() < tolerance * (1.0 + expected.abs()),
                        "{name} {on}: {found} {expected}"
                    );
                }
            }
            assert_eq!(finer.unnamed_boundary_facets() == 0, mesh.unnamed_boundary_facets() == 0, "{name}");
            let bits = |x: &Point| x.map(f64::to_bits);
            let is_known = before.points.iter().zip(&finer.points).all(|(a, b)| bits(a) == bits(b));
            assert!(is_known, "{name}: a node has moved");
        }
    }
}

/// Each edge of a marked cell is cut at its middle.
#[test]
fn every_edge_of_a_marked_cell_is_halved() {
    for mesh in [square(3, Elements::P1), square(3, Elements::Q1), cube(2, Elements::P1), cube(2, Elements::Q1)] {
        let mesh = shaken(mesh, 0.1, 5);
        let marked = 5;
        let vertices: Vec<u32> = mesh.blocks[0].cells().nth(marked).expect("a cell").to_vec();
        let finer = mesh.refined_where(&[marked]).expect("a mesh");
        let places = |x: &Point| finer.points.iter().any(|y| length(&minus(x, y)) < 1e-14);
        let element = mesh.blocks[0].element;
        let (mut edges, cells) = (0, || finer.blocks.iter().flat_map(Block::cells));
        for (i, &a) in vertices.iter().enumerate() {
            for (j, &b) in vertices.iter().enumerate().take(i) {
                let (x, y) = (element.nodes[i], element.nodes[j]);
                let is_edge = element.is_simplex() || (length(&minus(&x, &y)) - 1.0).abs() < 1e-9;
                if is_edge {
                    let [p, q] = [a, b].map(|node| mesh.points[node as usize]);
                    assert!(places(&std::array::from_fn(|d| 0.5 * (p[d] + q[d]))), "{}", element.name);
                    assert!(!cells().any(|cell| cell.contains(&a) && cell.contains(&b)), "{}", element.name);
                    edges += 1;
                }
            }
        }
        assert_eq!(edges, [[3, 4], [6, 12]][mesh.dim - 2][usize::from(!element.is_simplex())]);
    }
}

/// Newest-vertex bisection from the longest edges leaves no angle smaller than half of the smallest one.
#[test]
fn angles_of_triangles_are_bounded() {
    let least = |mesh: &Mesh| -> f64 {
        let of_cell = |x: &Vec<Point>| -> f64 {
            let angle = |i: usize| {
                let (a, b) = (minus(&x[(i + 1) % 3], &x[i]), minus(&x[(i + 2) % 3], &x[i]));
                (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1])
            };
            (0..3).map(angle).fold(f64::INFINITY, f64::min)
        };
        simplices(mesh).iter().map(of_cell).fold(f64::INFINITY, f64::min)
    };
    for seed in 1..6 {
        let mesh = turned(&shaken(square(4, Elements::P1), 0.2, seed), seed);
        let (mut random, mut bisection) = (Random(seed), Bisection::new(&mesh));
        for _ in 0..10 {
            let marked = random.cells(8, bisection.cell_count());
            bisection.refine(&marked).expect("a mesh");
        }
        let found = least(&bisection.mesh());
        assert!(found >= 0.5 * least(&mesh) - 1e-12, "{found} of {}", least(&mesh));
    }
}

/// Liu and Joe (1995) bound their bisection, of which the marks are an equivalent: a tetrahedron has descendants of at
/// most 168 shapes, with at least 0.1417 of its mean ratio.
#[test]
fn shapes_of_tetrahedra_are_bounded() {
    let corners = |mesh: &mut Mesh, x: [Point; 4]| {
        mesh.points = x.to_vec();
        mesh.blocks[0].nodes = vec![0, 1, 2, 3];
    };
    let mut random = Random(7);
    for _ in 0..12 {
        let mut mesh = cube(1, Elements::P1);
        (mesh.facets, mesh.edges) = Default::default();
        let mut point = || std::array::from_fn(|_| random.next());
        corners(&mut mesh, [point(), point(), point(), point()]);
        if mesh.check().is_err() {
            mesh.blocks[0].nodes.swap(0, 1);
        }
        let first = mesh.worst_quality().0;
        let mut bisection = Bisection::new(&mesh);
        let mut shapes: BTreeSet<Vec<i64>> = BTreeSet::new();
        for _ in 0..4 {
            let all: Vec<usize> = (0..bisection.cell_count()).collect();
            bisection.refine(&all).expect("a mesh");
            let found = bisection.mesh();
            assert!(found.worst_quality().0 > 0.1417 * first, "{} of {first}", found.worst_quality().0);
            shapes.extend(simplices(&found).iter().map(|x| shape(x)));
        }
        assert!(shapes.len() <= 168, "{} shapes", shapes.len());
        // A corner and random places, deeper: no shapes beyond.
        for round in 0..20 {
            let count = bisection.cell_count();
            let marked = if round < 10 { vec![0] } else { random.cells(3, count) };
            bisection.refine(&marked).expect("a mesh");
            let found = bisection.mesh();
            assert!(found.worst_quality().0 > 0.1417 * first, "{} of {first}", found.worst_quality().0);
        }
    }
}

/// Lengths of the edges over the longest one, ascending.
fn shape(x: &[Point]) -> Vec<i64> {
    let mut lengths: Vec<f64> =
        (0..4).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| length(&minus(&x[i], &x[j]))).collect();
    lengths.sort_by(f64::total_cmp);
    lengths.iter().map(|length| (1e6 * length / lengths[5]).round() as i64).collect()
}

/// The cells that ten rounds add per marked cell.
pub fn added(mesh: &Mesh, each: usize) -> f64 {
    let (mut random, mut bisection, mut marked) = (Random(3), Bisection::new(mesh), 0);
    for _ in 0..10 {
        // One place of the body in every round, as a solution asks for, and a few others.
        let mut cells = random.cells(each, bisection.cell_count());
        cells.push(0);
        marked += cells.len();
        bisection.refine(&cells).expect("a mesh");
    }
    (bisection.cell_count() - mesh.cell_count()) as f64 / marked as f64
}

/// Cells added around one marked cell inside a regular mesh, counted by hand. A triangle has 4 children; the one over
/// its longest side is cut once, those over the others twice with a further one each. A square has 8, its neighbours 5.
/// A cube has 48 children, the 6 over its faces 8 + 4 · 5 + 1 each, the 12 over its edges 2 · 5 + 4.
#[test]
fn the_closure_of_one_cell_is_counted() {
    let mesh = square(6, Elements::P1);
    let middle = mesh.blocks[0]
        .cells()
        .position(|cell| cell.iter().all(|&n| mesh.points[n as usize][..2].iter().all(|x| *x > 0.3 && *x < 0.7)));
    for (mesh, marked, added) in [
        (&mesh, middle.expect("a cell"), 3 + 1 + 2 * (2 + 1)),
        (&square(5, Elements::Q1), 12, 7 + 4 * 4),
        (&cube(5, Elements::Q1), 62, 47 + 6 * 28 + 12 * 13),
    ] {
        assert_eq!(mesh.refined_where(&[marked]).expect("a mesh").cell_count(), mesh.cell_count() + added);
    }
}

/// The closure adds cells in proportion to those that are marked, however many cells there are (Binev, Dahmen and
/// DeVore, 2004): on meshes with 64 times as many cells not more of them, up to the random choice.
#[test]
fn the_closure_is_local() {
    let makes: [fn(usize) -> Mesh; 4] = [
        |n| shaken(square(8 * n, Elements::P1), 0.2 / n as f64, 1),
        |n| shaken(square(8 * n, Elements::Q1), 0.2 / n as f64, 1),
        |n| shaken(cube(4 * n, Elements::P1), 0.1 / n as f64, 1),
        |n| cube(4 * n, Elements::Q1),
    ];
    // Besides the closure of a whole square or cube, see above, that of their triangles and tetrahedra is bounded.
    for (make, bound) in makes.into_iter().zip([20.0, 23.0, 250.0, 371.0]) {
        let found = [1, 4].map(|n| added(&make(n), 4));
        assert!(found[0] < bound && found[1] < bound, "{found:?}");
        assert!(found[1] < 1.5 * found[0], "{found:?}");
    }
}

/// The places of the nodes, rounded to what a rotation leaves.
fn places(mesh: &Mesh, back: impl Fn(&Point) -> Point) -> BTreeSet<[i64; 3]> {
    mesh.points.iter().map(|x| back(x).map(|x| (x * 1e9).round() as i64)).collect()
}

/// A mesh turned, mirrored and renumbered is refined at the same places if its lengths differ; and a regular one turned
/// only has the same cells, although round-off makes equal lengths differ.
#[test]
fn the_result_does_not_depend_on_the_frame() {
    let (s, c) = 0.7_f64.sin_cos();
    let turn = |x: &Point| [c * x[0] - s * x[1] + 3.0, s * x[0] + c * x[1] - 1.0, x[2]];
    let back = |x: &Point| {
        let (x, y) = (x[0] - 3.0, x[1] + 1.0);
        [c * x + s * y, c * y - s * x, 0.0]
    };
    for regular in [square(5, Elements::P1), square(5, Elements::Q1), cube(3, Elements::P1), cube(3, Elements::Q1)] {
        let other = Mesh { points: regular.points.iter().map(turn).collect(), ..regular.clone() };
        let marked = [3, 7, 11];
        let [a, b] = [&regular, &other].map(|mesh| mesh.refined_where(&marked).expect("a mesh"));
        let cells = |mesh: &Mesh| mesh.blocks.iter().map(|block| block.nodes.clone()).collect::<Vec<_>>();
        assert_eq!(cells(&a), cells(&b));
    }
    for elements in [Elements::P1, Elements::P2, Elements::Q1] {
        // Node numbers from the end, and the plane mirrored in x, which turns the cells over.
        let mesh = shaken(square(5, if elements == Elements::P2 { Elements::P1 } else { elements }), 0.05, 2);
        let mut other = mesh.clone();
        let last = mesh.points.len() as u32 - 1;
        other.points = mesh.points.iter().rev().map(|x| turn(&[-x[0], x[1], 0.0])).collect();
        let corners = mesh.blocks[0].element.nodes.len();
        other.blocks[0].nodes.iter_mut().for_each(|n| *n = last - *n);
        other.blocks[0].nodes.chunks_exact_mut(corners).for_each(<[u32]>::reverse);
        (other.facets, other.edges) = Default::default();
        let [mesh, other] =
            [mesh, other].map(|mesh| if elements == Elements::P2 { mesh.quadratic().expect("a mesh") } else { mesh });
        other.check().expect("a sound mesh");
        let marked = [2, 5, 17, 17];
        let [a, b] = [&mesh, &other].map(|mesh| mesh.refined_where(&marked).expect("a mesh"));
        assert_eq!(
            places(&a, |x| *x),
            places(&b, |x| {
                let x = back(x);
                [-x[0], x[1], 0.0]
            })
        );
        assert_eq!(a.cell_count(), b.cell_count());
    }
}

/// Cells in another order are refined at the same places, to the last bit.
#[test]
fn the_order_of_the_cells_does_not_matter() {
    for mesh in [shaken(square(4, Elements::P1), 0.1, 4), cube(2, Elements::P1), cube(2, Elements::Q1)] {
        let (count, corners) = (mesh.cell_count(), mesh.blocks[0].element.nodes.len());
        let mut other = mesh.clone();
        other.blocks[0].nodes = mesh.blocks[0].nodes.chunks_exact(corners).rev().flatten().copied().collect();
        let a = mesh.refined_where(&[1, 6]).expect("a mesh");
        let b = other.refined_where(&[count - 2, count - 7]).expect("a mesh");
        let bits = |mesh: &Mesh| mesh.points.iter().map(|x| x.map(f64::to_bits)).collect::<BTreeSet<_>>();
        assert_eq!(bits(&a), bits(&b));
        assert_eq!(a.cell_count(), b.cell_count());
    }
}

#[test]
fn a_missing_cell_is_refused() {
    let error = square(2, Elements::P1).refined_where(&[3, 8]).expect_err("there are 8 cells");
    assert_eq!(error.to_string(), "cell 8 is marked, expected one below 8, the number of cells");
}
