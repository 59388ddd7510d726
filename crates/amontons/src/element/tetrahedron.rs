//! Tetrahedra (0,0,0), (1,0,0), (0,1,0), (0,0,1).

use super::basis::{linear, linear_gradients, quadratic, quadratic_gradients};
use super::{CellType, Child, Element, Facet, FileOrder, FileOrders, P1_TRIANGLE, P2_TRIANGLE, parts};
use crate::quadrature::Shape;
use crate::tensor::{Point, dot};

/// Vertices, then middles of the edges of [`EDGES`].
const NODES: [Point; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.0, 0.5, 0.5],
];

const EDGES: [(usize, usize); 6] = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)];

/// Exodus numbers the lower side last.
const EXODUS_SIDES: FileOrder = FileOrder(&[1, 2, 3, 0]);

/// Tetrahedra at the vertices.
const OUTER: [&[usize]; 4] = [&[0, 4, 6, 7], &[4, 1, 5, 8], &[6, 5, 2, 9], &[7, 8, 9, 3]];
/// Tetrahedra about each diagonal of the octahedron between those at the vertices. Its ends are the middles of the
/// edges 01 and 23, 02 and 13, 03 and 12.
const INNER: [[&[usize]; 4]; 3] = [
    [&[4, 9, 6, 7], &[4, 9, 7, 8], &[4, 9, 8, 5], &[4, 9, 5, 6]],
    [&[6, 8, 7, 4], &[6, 8, 4, 5], &[6, 8, 5, 9], &[6, 8, 9, 7]],
    [&[7, 5, 4, 6], &[7, 5, 6, 9], &[7, 5, 9, 8], &[7, 5, 8, 4]],
];

/// Four tetrahedra at the vertices, and four from the octahedron between them about its shortest diagonal.
fn children(x: &[Point]) -> Vec<Child> {
    let length = |[(a, b), (c, d)]: [(usize, usize); 2]| {
        let between: Point = std::array::from_fn(|k| x[a][k] + x[b][k] - x[c][k] - x[d][k]);
        dot(&between, &between)
    };
    let opposite = [[(0, 1), (2, 3)], [(0, 2), (1, 3)], [(0, 3), (1, 2)]];
    let shortest = (0..3).min_by(|&i, &j| length(opposite[i]).total_cmp(&length(opposite[j]))).unwrap_or(0);
    parts(Shape::Tetrahedron, &NODES, &[OUTER, INNER[shortest]].concat())
}

/// Linear tetrahedron.
pub static P1_TETRAHEDRON: Element = Element {
    name: "P1 tetrahedron",
    shape: Shape::Tetrahedron,
    degree: 1,
    gradient_degree: 0,
    neighbours: 15.0,
    nodes: &[NODES[0], NODES[1], NODES[2], NODES[3]],
    facets: &[
        Facet { element: &P1_TRIANGLE, nodes: &[0, 2, 1] },
        Facet { element: &P1_TRIANGLE, nodes: &[0, 1, 3] },
        Facet { element: &P1_TRIANGLE, nodes: &[1, 2, 3] },
        Facet { element: &P1_TRIANGLE, nodes: &[0, 3, 2] },
    ],
    shape_functions: |x, n| linear(3, x, n),
    gradients: |_, g| linear_gradients(3, g),
    children,
    types: &[CellType::new("4-node tetrahedron", 4).vtk(10).gmsh(4).aster("TE4", "TETRA4").abaqus()],
    orders: FileOrders { exodus_sides: EXODUS_SIDES, ..FileOrders::SAME },
};

/// Quadratic tetrahedron with ten nodes.
pub static P2_TETRAHEDRON: Element = Element {
    name: "P2 tetrahedron",
    shape: Shape::Tetrahedron,
    degree: 2,
    gradient_degree: 1,
    neighbours: 28.75,
    nodes: &NODES,
    facets: &[
        Facet { element: &P2_TRIANGLE, nodes: &[0, 2, 1, 6, 5, 4] },
        Facet { element: &P2_TRIANGLE, nodes: &[0, 1, 3, 4, 8, 7] },
        Facet { element: &P2_TRIANGLE, nodes: &[1, 2, 3, 5, 9, 8] },
        Facet { element: &P2_TRIANGLE, nodes: &[0, 3, 2, 7, 9, 6] },
    ],
    shape_functions: |x, n| quadratic(3, &EDGES, x, n),
    gradients: |x, g| quadratic_gradients(3, &EDGES, x, g),
    children,
    types: &[CellType::new("10-node tetrahedron", 10).vtk(24).gmsh(11).aster("T10", "TETRA10").abaqus()],
    orders: FileOrders {
        // Gmsh lists the last two in the opposite order.
        gmsh: FileOrder(&[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
        exodus_sides: EXODUS_SIDES,
        ..FileOrders::SAME
    },
};
