//! Triangles (0,0), (1,0), (0,1).

use super::basis::{linear, linear_gradients, quadratic, quadratic_gradients};
use super::{CellType, Child, Element, Facet, FileOrders, P1_SEGMENT, P2_SEGMENT, parts};
use crate::quadrature::Shape;
use crate::tensor::Point;

/// Vertices, then middles of the edges of [`EDGES`].
pub(super) const NODES: [Point; 6] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.0]];

/// The two vertices next to each middle node.
pub(super) const EDGES: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];

/// A triangle at each vertex, and the one between them.
fn children(_: &[Point]) -> Vec<Child> {
    parts(Shape::Triangle, &NODES, &[&[0, 3, 5], &[3, 1, 4], &[5, 4, 2], &[3, 4, 5]])
}

/// Linear triangle.
pub static P1_TRIANGLE: Element = Element {
    name: "P1 triangle",
    shape: Shape::Triangle,
    degree: 1,
    gradient_degree: 0,
    neighbours: 7.0,
    nodes: &[NODES[0], NODES[1], NODES[2]],
    facets: &[
        Facet { element: &P1_SEGMENT, nodes: &[0, 1] },
        Facet { element: &P1_SEGMENT, nodes: &[1, 2] },
        Facet { element: &P1_SEGMENT, nodes: &[2, 0] },
    ],
    shape_functions: |x, n| linear(2, x, n),
    gradients: |_, g| linear_gradients(2, g),
    children,
    types: &[CellType::new("3-node triangle", 3)
        .vtk(5)
        .gmsh(2)
        .aster("TR3", "TRIA3")
        .abaqus()
        .drawn(&[0, 1, 2], &[[0, 1, 2]])],
    orders: FileOrders::SAME,
};

/// Quadratic triangle with six nodes.
pub static P2_TRIANGLE: Element = Element {
    name: "P2 triangle",
    shape: Shape::Triangle,
    degree: 2,
    gradient_degree: 1,
    neighbours: 11.5,
    nodes: &NODES,
    facets: &[
        Facet { element: &P2_SEGMENT, nodes: &[0, 1, 3] },
        Facet { element: &P2_SEGMENT, nodes: &[1, 2, 4] },
        Facet { element: &P2_SEGMENT, nodes: &[2, 0, 5] },
    ],
    shape_functions: |x, n| quadratic(2, &EDGES, x, n),
    gradients: |x, g| quadratic_gradients(2, &EDGES, x, g),
    children,
    types: &[CellType::new("6-node triangle", 6)
        .vtk(22)
        .gmsh(9)
        .aster("TR6", "TRIA6")
        .abaqus()
        .drawn(&[0, 3, 1, 4, 2, 5], &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])],
    orders: FileOrders::SAME,
};
