//! Finite elements as static records; [`ALL`] is the list that tests loop over.

use crate::quadrature::Shape;
use crate::tensor::Point;

/// A Lagrange element: nodes, facets, shape functions and their names in other formats.
#[derive(Debug)]
pub struct Element {
    /// Name used in messages, e.g. `P1 triangle`.
    pub name: &'static str,
    /// Shape of the reference cell.
    pub shape: Shape,
    /// Polynomial degree of the shape functions.
    pub degree: usize,
    /// Reference coordinates of the nodes.
    pub nodes: &'static [Point],
    /// Local nodes of each facet, ordered so that the outward normal is on the right of a segment.
    pub facets: &'static [&'static [usize]],
    /// Values of the shape functions at a reference point, one a node.
    pub shape_functions: fn(&Point, &mut [f64]),
    /// Gradients of the shape functions at a reference point, one a node.
    pub gradients: fn(&Point, &mut [Point]),
    /// Element of a facet, none for points.
    pub facet: Option<&'static Element>,
    /// Cell type of the VTK file formats.
    pub vtk: u8,
}

/// Most nodes that an element has.
pub const MAX_NODES: usize = 3;

/// A single node, the facet of [`P1_SEGMENT`].
pub static POINT: Element = Element {
    name: "point",
    shape: Shape::Point,
    degree: 0,
    nodes: &[[0.0; 3]],
    facets: &[],
    shape_functions: |_, n| n[0] = 1.0,
    gradients: |_, g| g[0] = [0.0; 3],
    facet: None,
    vtk: 1,
};

/// Linear segment.
pub static P1_SEGMENT: Element = Element {
    name: "P1 segment",
    shape: Shape::Segment,
    degree: 1,
    nodes: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
    facets: &[&[0], &[1]],
    shape_functions: |x, n| {
        n[0] = 1.0 - x[0];
        n[1] = x[0];
    },
    gradients: |_, g| {
        g[0] = [-1.0, 0.0, 0.0];
        g[1] = [1.0, 0.0, 0.0];
    },
    facet: Some(&POINT),
    vtk: 3,
};

/// Linear triangle.
pub static P1_TRIANGLE: Element = Element {
    name: "P1 triangle",
    shape: Shape::Triangle,
    degree: 1,
    nodes: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    facets: &[&[0, 1], &[1, 2], &[2, 0]],
    shape_functions: |x, n| {
        n[0] = 1.0 - x[0] - x[1];
        n[1] = x[0];
        n[2] = x[1];
    },
    gradients: |_, g| {
        g[0] = [-1.0, -1.0, 0.0];
        g[1] = [1.0, 0.0, 0.0];
        g[2] = [0.0, 1.0, 0.0];
    },
    facet: Some(&P1_SEGMENT),
    vtk: 5,
};

/// Every element of the library.
pub static ALL: [&Element; 3] = [&POINT, &P1_SEGMENT, &P1_TRIANGLE];
