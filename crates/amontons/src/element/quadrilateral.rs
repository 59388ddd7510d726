//! Quadrilaterals [0, 1]².

use super::basis::{product, product_gradients};
use super::{CellType, Child, Element, Facet, FileOrders, P1_SEGMENT, P2_SEGMENT, parts};
use crate::quadrature::Shape;
use crate::tensor::Point;

/// Vertices around the cell, middles of its edges, its centre.
const NODES: [Point; 9] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.5, 0.0, 0.0],
    [1.0, 0.5, 0.0],
    [0.5, 1.0, 0.0],
    [0.0, 0.5, 0.0],
    [0.5, 0.5, 0.0],
];

/// A quadrilateral at each vertex; the order of the vertices is kept.
fn children(_: &[Point]) -> Vec<Child> {
    parts(Shape::Quadrilateral, &NODES, &[&[0, 4, 8, 7], &[4, 1, 5, 8], &[8, 5, 2, 6], &[7, 8, 6, 3]])
}

/// Bilinear quadrilateral.
pub static Q1_QUADRILATERAL: Element = Element {
    name: "Q1 quadrilateral",
    shape: Shape::Quadrilateral,
    degree: 1,
    gradient_degree: 1,
    neighbours: 9.0,
    nodes: &[NODES[0], NODES[1], NODES[2], NODES[3]],
    facets: &[
        Facet { element: &P1_SEGMENT, nodes: &[0, 1] },
        Facet { element: &P1_SEGMENT, nodes: &[1, 2] },
        Facet { element: &P1_SEGMENT, nodes: &[2, 3] },
        Facet { element: &P1_SEGMENT, nodes: &[3, 0] },
    ],
    shape_functions: |x, n| product(2, 1, &NODES[..4], x, n),
    gradients: |x, g| product_gradients(2, 1, &NODES[..4], x, g),
    children,
    types: &[CellType::new("4-node quadrilateral", 4)
        .vtk(9)
        .gmsh(3)
        .aster("QU4", "QUAD4")
        .abaqus()
        .drawn(&[0, 1, 2, 3], &[[0, 1, 2], [0, 2, 3]])],
    orders: FileOrders::SAME,
};

/// Biquadratic quadrilateral with nine nodes.
pub static Q2_QUADRILATERAL: Element = Element {
    name: "Q2 quadrilateral",
    shape: Shape::Quadrilateral,
    degree: 2,
    gradient_degree: 2,
    neighbours: 16.0,
    nodes: &NODES,
    facets: &[
        Facet { element: &P2_SEGMENT, nodes: &[0, 1, 4] },
        Facet { element: &P2_SEGMENT, nodes: &[1, 2, 5] },
        Facet { element: &P2_SEGMENT, nodes: &[2, 3, 6] },
        Facet { element: &P2_SEGMENT, nodes: &[3, 0, 7] },
    ],
    shape_functions: |x, n| product(2, 2, &NODES, x, n),
    gradients: |x, g| product_gradients(2, 2, &NODES, x, g),
    children,
    types: &[
        CellType::new("9-node quadrilateral", 9).vtk(28).gmsh(10).aster("QU9", "QUAD9").drawn(
            &[0, 4, 1, 5, 2, 6, 3, 7],
            &[[8, 0, 4], [8, 4, 1], [8, 1, 5], [8, 5, 2], [8, 2, 6], [8, 6, 3], [8, 3, 7], [8, 7, 0]],
        ),
        CellType::new("8-node quadrilateral", 8)
            .vtk(23)
            .gmsh(16)
            .aster("QU8", "QUAD8")
            .abaqus()
            .drawn(&[0, 4, 1, 5, 2, 6, 3, 7], &[[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 6], [4, 6, 7]]),
    ],
    orders: FileOrders::SAME,
};
