//! Segments [0, 1], and the end points of a body of one dimension.

use super::basis::{product, product_gradients};
use super::{CellType, Child, Element, Facet, FileOrders, parts};
use crate::quadrature::Shape;
use crate::tensor::Point;

/// The left end of a body on the line: its outward normal is −1.
///
/// A point has no direction of its own, so the two ends of a segment are two elements; the reference
/// coordinate of the node is that of its end.
pub static POINT_LEFT: Element = Element {
    name: "left end",
    shape: Shape::Point,
    degree: 0,
    gradient_degree: 0,
    neighbours: 1.0,
    nodes: &[[0.0; 3]],
    facets: &[],
    shape_functions: |_, n| n[0] = 1.0,
    gradients: |_, g| g[0] = [0.0; 3],
    children: |_| vec![(Shape::Point, vec![[0.0; 3]])],
    types: &[CellType::new("1-node point", 1).vtk(1).gmsh(15).aster("PO1", "POI1")],
    orders: FileOrders::SAME,
};

/// The right end of a body on the line: its outward normal is +1; see [`POINT_LEFT`].
pub static POINT_RIGHT: Element = Element {
    name: "right end",
    shape: Shape::Point,
    degree: 0,
    gradient_degree: 0,
    neighbours: 1.0,
    nodes: &[[1.0, 0.0, 0.0]],
    facets: &[],
    shape_functions: |_, n| n[0] = 1.0,
    gradients: |_, g| g[0] = [0.0; 3],
    children: |_| vec![(Shape::Point, vec![[1.0, 0.0, 0.0]])],
    types: &[CellType::new("1-node point", 1).vtk(1).gmsh(15).aster("PO1", "POI1")],
    orders: FileOrders::SAME,
};

const NODES: [Point; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]];

const ENDS: &[Facet] = &[Facet { element: &POINT_LEFT, nodes: &[0] }, Facet { element: &POINT_RIGHT, nodes: &[1] }];

/// Both halves.
fn children(_: &[Point]) -> Vec<Child> {
    parts(Shape::Segment, &NODES, &[&[0, 2], &[2, 1]])
}

/// Linear segment.
pub static P1_SEGMENT: Element = Element {
    name: "P1 segment",
    shape: Shape::Segment,
    degree: 1,
    gradient_degree: 0,
    neighbours: 3.0,
    nodes: &[NODES[0], NODES[1]],
    facets: ENDS,
    shape_functions: |x, n| product(1, 1, &NODES[..2], x, n),
    gradients: |x, g| product_gradients(1, 1, &NODES[..2], x, g),
    children,
    types: &[CellType::new("2-node segment", 2).vtk(3).gmsh(1).aster("SE2", "SEG2").abaqus()],
    orders: FileOrders::SAME,
};

/// Quadratic segment: both ends, then the middle.
pub static P2_SEGMENT: Element = Element {
    name: "P2 segment",
    shape: Shape::Segment,
    degree: 2,
    gradient_degree: 1,
    neighbours: 4.0,
    nodes: &NODES,
    facets: ENDS,
    shape_functions: |x, n| product(1, 2, &NODES, x, n),
    gradients: |x, g| product_gradients(1, 2, &NODES, x, g),
    children,
    types: &[CellType::new("3-node segment", 3).vtk(21).gmsh(8).aster("SE3", "SEG3").abaqus()],
    orders: FileOrders::SAME,
};
