//! Finite elements as static records; [`ALL`] is the list over which tests loop.
//!
//! | family | elements |
//! |---|---|
//! | segments | [`P1_SEGMENT`], [`P2_SEGMENT`], their ends [`POINT_LEFT`], [`POINT_RIGHT`] |
//! | triangles, tetrahedra | [`P1_TRIANGLE`], [`P2_TRIANGLE`], [`P1_TETRAHEDRON`], [`P2_TETRAHEDRON`] |
//! | quadrilaterals, hexahedra | [`Q1_QUADRILATERAL`], [`Q2_QUADRILATERAL`], [`Q1_HEXAHEDRON`], [`Q2_HEXAHEDRON`] |
//! | prisms, pyramids | [`P1_PRISM`], [`P2_PRISM`], [`P1_PYRAMID`], [`P2_PYRAMID`] |
//!
//! Nodes are numbered as in the VTK file formats: vertices, then middles of edges, of faces, of the cell.

mod basis;
mod formats;
mod hexahedron;
mod prism;
mod pyramid;
mod quadrilateral;
mod segment;
mod table;
mod tetrahedron;
mod triangle;

pub use formats::{CellType, Drawing, FileOrder, FileOrders};
pub use hexahedron::{Q1_HEXAHEDRON, Q2_HEXAHEDRON};
pub use prism::{P1_PRISM, P2_PRISM};
pub use pyramid::{P1_PYRAMID, P2_PYRAMID};
pub use quadrilateral::{Q1_QUADRILATERAL, Q2_QUADRILATERAL};
pub use segment::{P1_SEGMENT, P2_SEGMENT, POINT_LEFT, POINT_RIGHT};
pub use table::ShapeTable;
pub use tetrahedron::{P1_TETRAHEDRON, P2_TETRAHEDRON};
pub use triangle::{P1_TRIANGLE, P2_TRIANGLE};

use crate::quadrature::Shape;
use crate::tensor::Point;

/// A Lagrange element: nodes, facets, shape functions, and its cells in files.
#[derive(Debug)]
pub struct Element {
    /// Name used in messages, e.g. `P1 triangle`.
    pub name: &'static str,
    /// Shape of the reference cell.
    pub shape: Shape,
    /// Largest p such that the shape functions span all polynomials of total degree p: the order of the element.
    pub degree: usize,
    /// Degree of the gradients for [`crate::quadrature::rule`]: the total degree on a simplex, the degree in each
    /// coordinate on the other shapes.
    pub gradient_degree: usize,
    /// Mean number of nodes that share a cell with a node of a regular mesh of such cells, including itself: it gives
    /// the memory of a run.
    pub neighbours: f64,
    /// Reference coordinates of the nodes, in the order of VTK.
    pub nodes: &'static [Point],
    /// The facets, oriented outward.
    pub facets: &'static [Facet],
    /// Values of the shape functions at a reference point, one per node.
    pub shape_functions: fn(&Point, &mut [f64]),
    /// Gradients of the shape functions at a reference point, one per node.
    pub gradients: fn(&Point, &mut [Point]),
    /// The parts of the reference cell when every edge is halved, from the positions of the vertices of a cell.
    pub children: fn(&[Point]) -> Vec<Child>,
    /// The types of cells that files may have: with all nodes first, then those that lack the last nodes.
    pub types: &'static [CellType],
    /// The order of nodes and facets in the formats that do not have that of the library.
    pub orders: FileOrders,
}

/// A part of a refined reference cell: its shape and its vertices.
pub type Child = (Shape, Vec<Point>);

/// The parts of a shape with these vertices, numbered as the nodes of the quadratic element.
fn parts(shape: Shape, nodes: &[Point], vertices: &[&[usize]]) -> Vec<Child> {
    vertices.iter().map(|part| (shape, part.iter().map(|&node| nodes[node]).collect())).collect()
}

/// A facet of a cell: local nodes of the cell in the order of the facet element.
///
/// A segment has the body on its left, hence its outward normal on its right; on a face the outward normal is ∂x/∂ξ ×
/// ∂x/∂η. A point is [`POINT_LEFT`] or [`POINT_RIGHT`] depending on the end of the body.
#[derive(Debug)]
pub struct Facet {
    /// Element of the facet.
    pub element: &'static Element,
    /// Local nodes of the cell, `element.nodes.len()` of them.
    pub nodes: &'static [usize],
}

/// Largest number of nodes of an element.
pub const MAX_NODES: usize = 27;

impl Element {
    /// Spatial dimension of the reference cell.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.shape.dim()
    }

    /// True if the shape is a segment, triangle or tetrahedron: the functions are then the polynomials of total degree
    /// p.
    #[must_use]
    pub fn is_simplex(&self) -> bool {
        matches!(self.shape, Shape::Segment | Shape::Triangle | Shape::Tetrahedron)
    }

    /// Cell type of the VTK file formats; that of an empty cell, 0, if VTK has no cell with these nodes.
    #[must_use]
    pub fn vtk(&self) -> u8 {
        self.types.iter().find_map(|cell| cell.vtk).unwrap_or(0)
    }

    /// Number of leading nodes that a cell of the type [`Element::vtk`] has: all except the last one of the quadratic
    /// pyramid, since VTK has quadratic pyramids of 13 and of 19 nodes.
    #[must_use]
    pub fn vtk_nodes(&self) -> usize {
        self.types.iter().find(|cell| cell.vtk.is_some()).map_or(self.nodes.len(), |cell| cell.nodes)
    }

    /// The mean of the vertices of the reference cell.
    #[must_use]
    pub fn centre(&self) -> Point {
        let n = self.shape.vertices();
        std::array::from_fn(|d| self.nodes.iter().take(n).map(|p| p[d]).sum::<f64>() / n as f64)
    }

    /// The element of a shape that is complete to a degree; `None` if the library has none.
    #[must_use]
    pub fn find(shape: Shape, degree: usize) -> Option<&'static Element> {
        ALL.into_iter().find(|e| e.shape == shape && e.degree == degree)
    }
}

/// Every element of the library.
pub static ALL: [&Element; 16] = [
    &POINT_LEFT,
    &POINT_RIGHT,
    &P1_SEGMENT,
    &P2_SEGMENT,
    &P1_TRIANGLE,
    &P2_TRIANGLE,
    &Q1_QUADRILATERAL,
    &Q2_QUADRILATERAL,
    &P1_TETRAHEDRON,
    &P2_TETRAHEDRON,
    &Q1_HEXAHEDRON,
    &Q2_HEXAHEDRON,
    &P1_PRISM,
    &P2_PRISM,
    &P1_PYRAMID,
    &P2_PYRAMID,
];
