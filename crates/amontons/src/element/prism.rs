//! Prisms: the unit triangle times [0, 1].

use super::basis::{line, linear, linear_gradients, quadratic, quadratic_gradients};
use super::triangle::EDGES;
use super::{
    CellType, Child, Element, Facet, FileOrder, FileOrders, P1_TRIANGLE, P2_TRIANGLE, Q1_QUADRILATERAL,
    Q2_QUADRILATERAL, parts,
};
use crate::quadrature::Shape;
use crate::tensor::Point;

/// Lower and upper vertices; middles of the lower, upper and upright edges; centres of the upright faces.
const NODES: [Point; 18] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.5, 0.0, 1.0],
    [0.5, 0.5, 1.0],
    [0.0, 0.5, 1.0],
    [0.0, 0.0, 0.5],
    [1.0, 0.0, 0.5],
    [0.0, 1.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.5, 0.5, 0.5],
    [0.0, 0.5, 0.5],
];

/// The node of the lower triangle below each node.
const FOOT: [usize; 18] = [0, 1, 2, 0, 1, 2, 3, 4, 5, 3, 4, 5, 0, 1, 2, 3, 4, 5];

/// Products of functions of the triangle and functions of the height.
fn values(degree: usize, x: &Point, out: &mut [f64]) {
    let mut plane = [0.0; 6];
    if degree == 1 {
        linear(2, x, &mut plane);
    } else {
        quadratic(2, &EDGES, x, &mut plane);
    }
    for (n, value) in out.iter_mut().enumerate() {
        *value = plane[FOOT[n]] * line(degree, NODES[n][2], x[2]).0;
    }
}

fn gradients(degree: usize, x: &Point, out: &mut [Point]) {
    let (mut plane, mut slopes) = ([0.0; 6], [[0.0; 3]; 6]);
    if degree == 1 {
        linear(2, x, &mut plane);
        linear_gradients(2, &mut slopes);
    } else {
        quadratic(2, &EDGES, x, &mut plane);
        quadratic_gradients(2, &EDGES, x, &mut slopes);
    }
    for (n, gradient) in out.iter_mut().enumerate() {
        let (value, slope) = line(degree, NODES[n][2], x[2]);
        let [a, b, _] = slopes[FOOT[n]];
        *gradient = [a * value, b * value, plane[FOOT[n]] * slope];
    }
}

/// Exodus numbers the upright sides first.
const EXODUS_SIDES: FileOrder = FileOrder(&[2, 3, 4, 0, 1]);
/// Exodus and `.mail` files list the middles of the upright edges before those of the upper ones.
const UPRIGHT_FIRST: FileOrder = FileOrder(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11]);

/// The lower and the upper prism over each part of the triangle.
fn children(_: &[Point]) -> Vec<Child> {
    const VERTICES: [&[usize]; 8] = [
        &[0, 6, 8, 12, 15, 17],
        &[12, 15, 17, 3, 9, 11],
        &[6, 1, 7, 15, 13, 16],
        &[15, 13, 16, 9, 4, 10],
        &[8, 7, 2, 17, 16, 14],
        &[17, 16, 14, 11, 10, 5],
        &[6, 7, 8, 15, 16, 17],
        &[15, 16, 17, 9, 10, 11],
    ];
    parts(Shape::Prism, &NODES, &VERTICES)
}

/// Linear prism with six nodes.
pub static P1_PRISM: Element = Element {
    name: "P1 prism",
    shape: Shape::Prism,
    degree: 1,
    gradient_degree: 1,
    neighbours: 21.0,
    nodes: &[NODES[0], NODES[1], NODES[2], NODES[3], NODES[4], NODES[5]],
    facets: &[
        Facet { element: &P1_TRIANGLE, nodes: &[0, 2, 1] },
        Facet { element: &P1_TRIANGLE, nodes: &[3, 4, 5] },
        Facet { element: &Q1_QUADRILATERAL, nodes: &[0, 1, 4, 3] },
        Facet { element: &Q1_QUADRILATERAL, nodes: &[1, 2, 5, 4] },
        Facet { element: &Q1_QUADRILATERAL, nodes: &[2, 0, 3, 5] },
    ],
    shape_functions: |x, n| values(1, x, n),
    gradients: |x, g| gradients(1, x, g),
    children,
    types: &[CellType::new("6-node prism", 6).vtk(13).gmsh(6).aster("PE6", "PENTA6").abaqus()],
    orders: FileOrders { exodus_sides: EXODUS_SIDES, ..FileOrders::SAME },
};

/// Quadratic prism with 18 nodes.
pub static P2_PRISM: Element = Element {
    name: "P2 prism",
    shape: Shape::Prism,
    degree: 2,
    gradient_degree: 2,
    neighbours: 46.0,
    nodes: &NODES,
    facets: &[
        Facet { element: &P2_TRIANGLE, nodes: &[0, 2, 1, 8, 7, 6] },
        Facet { element: &P2_TRIANGLE, nodes: &[3, 4, 5, 9, 10, 11] },
        Facet { element: &Q2_QUADRILATERAL, nodes: &[0, 1, 4, 3, 6, 13, 9, 12, 15] },
        Facet { element: &Q2_QUADRILATERAL, nodes: &[1, 2, 5, 4, 7, 14, 10, 13, 16] },
        Facet { element: &Q2_QUADRILATERAL, nodes: &[2, 0, 3, 5, 8, 12, 11, 14, 17] },
    ],
    shape_functions: |x, n| values(2, x, n),
    gradients: |x, g| gradients(2, x, g),
    children,
    types: &[
        CellType::new("18-node prism", 18).vtk(32).gmsh(13).aster("P18", "PENTA18"),
        CellType::new("15-node prism", 15).vtk(26).gmsh(18).aster("P15", "PENTA15").abaqus(),
    ],
    orders: FileOrders {
        // Gmsh orders the edges by their first vertex, and the upright faces 01, 02, 12.
        gmsh: FileOrder(&[0, 1, 2, 3, 4, 5, 6, 8, 12, 7, 13, 14, 9, 11, 10, 15, 17, 16]),
        mail: UPRIGHT_FIRST,
        exodus: UPRIGHT_FIRST,
        exodus_sides: EXODUS_SIDES,
        ..FileOrders::SAME
    },
};
