//! Tetrahedra (0,0,0), (1,0,0), (0,1,0), (0,0,1).

use super::basis::{linear, linear_gradients, quadratic, quadratic_gradients};
use super::{CellType, Element, Facet, FileOrder, FileOrders, P1_TRIANGLE, P2_TRIANGLE};
use crate::quadrature::Shape;
use crate::tensor::Point;

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

/// Linear tetrahedron.
pub static P1_TETRAHEDRON: Element = Element {
    name: "P1 tetrahedron",
    shape: Shape::Tetrahedron,
    degree: 1,
    gradient_degree: 0,
    nodes: &[NODES[0], NODES[1], NODES[2], NODES[3]],
    facets: &[
        Facet { element: &P1_TRIANGLE, nodes: &[0, 2, 1] },
        Facet { element: &P1_TRIANGLE, nodes: &[0, 1, 3] },
        Facet { element: &P1_TRIANGLE, nodes: &[1, 2, 3] },
        Facet { element: &P1_TRIANGLE, nodes: &[0, 3, 2] },
    ],
    shape_functions: |x, n| linear(3, x, n),
    gradients: |_, g| linear_gradients(3, g),
    types: &[CellType::new("4-node tetrahedron", 4).vtk(10).gmsh(4).aster("TE4", "TETRA4").abaqus()],
    orders: FileOrders { exodus_sides: EXODUS_SIDES, ..FileOrders::SAME },
};

/// Quadratic tetrahedron with ten nodes.
pub static P2_TETRAHEDRON: Element = Element {
    name: "P2 tetrahedron",
    shape: Shape::Tetrahedron,
    degree: 2,
    gradient_degree: 1,
    nodes: &NODES,
    facets: &[
        Facet { element: &P2_TRIANGLE, nodes: &[0, 2, 1, 6, 5, 4] },
        Facet { element: &P2_TRIANGLE, nodes: &[0, 1, 3, 4, 8, 7] },
        Facet { element: &P2_TRIANGLE, nodes: &[1, 2, 3, 5, 9, 8] },
        Facet { element: &P2_TRIANGLE, nodes: &[0, 3, 2, 7, 9, 6] },
    ],
    shape_functions: |x, n| quadratic(3, &EDGES, x, n),
    gradients: |x, g| quadratic_gradients(3, &EDGES, x, g),
    types: &[CellType::new("10-node tetrahedron", 10).vtk(24).gmsh(11).aster("T10", "TETRA10").abaqus()],
    orders: FileOrders {
        // Gmsh lists the last two in the opposite order.
        gmsh: FileOrder(&[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
        exodus_sides: EXODUS_SIDES,
        ..FileOrders::SAME
    },
};
