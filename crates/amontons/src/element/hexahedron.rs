//! Hexahedra [0, 1]³.

use super::basis::{product, product_gradients};
use super::{CellType, Child, Element, Facet, FileOrder, FileOrders, Q1_QUADRILATERAL, Q2_QUADRILATERAL, parts};
use crate::quadrature::Shape;
use crate::tensor::Point;

/// Vertices; middles of the lower, upper and upright edges; centres of the faces −x, +x, −y, +y, −z, +z; the centre.
const NODES: [Point; 27] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.5, 0.0, 0.0],
    [1.0, 0.5, 0.0],
    [0.5, 1.0, 0.0],
    [0.0, 0.5, 0.0],
    [0.5, 0.0, 1.0],
    [1.0, 0.5, 1.0],
    [0.5, 1.0, 1.0],
    [0.0, 0.5, 1.0],
    [0.0, 0.0, 0.5],
    [1.0, 0.0, 0.5],
    [1.0, 1.0, 0.5],
    [0.0, 1.0, 0.5],
    [0.0, 0.5, 0.5],
    [1.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
    [0.5, 1.0, 0.5],
    [0.5, 0.5, 0.0],
    [0.5, 0.5, 1.0],
    [0.5, 0.5, 0.5],
];

/// Exodus numbers the upright sides first.
const EXODUS_SIDES: FileOrder = FileOrder(&[2, 3, 4, 5, 0, 1]);

/// A hexahedron at each vertex; the order of the vertices is kept.
fn children(_: &[Point]) -> Vec<Child> {
    const VERTICES: [&[usize]; 8] = [
        &[0, 8, 24, 11, 16, 22, 26, 20],
        &[8, 1, 9, 24, 22, 17, 21, 26],
        &[24, 9, 2, 10, 26, 21, 18, 23],
        &[11, 24, 10, 3, 20, 26, 23, 19],
        &[16, 22, 26, 20, 4, 12, 25, 15],
        &[22, 17, 21, 26, 12, 5, 13, 25],
        &[26, 21, 18, 23, 25, 13, 6, 14],
        &[20, 26, 23, 19, 15, 25, 14, 7],
    ];
    parts(Shape::Hexahedron, &NODES, &VERTICES)
}

/// Trilinear hexahedron.
pub static Q1_HEXAHEDRON: Element = Element {
    name: "Q1 hexahedron",
    shape: Shape::Hexahedron,
    degree: 1,
    gradient_degree: 1,
    neighbours: 27.0,
    nodes: &[NODES[0], NODES[1], NODES[2], NODES[3], NODES[4], NODES[5], NODES[6], NODES[7]],
    facets: &[
        Facet { element: &Q1_QUADRILATERAL, nodes: &[0, 3, 2, 1] },
        Facet { element: &Q1_QUADRILATERAL, nodes: &[4, 5, 6, 7] },
        Facet { element: &Q1_QUADRILATERAL, nodes: &[0, 1, 5, 4] },
        Facet { element: &Q1_QUADRILATERAL, nodes: &[1, 2, 6, 5] },
        Facet { element: &Q1_QUADRILATERAL, nodes: &[2, 3, 7, 6] },
        Facet { element: &Q1_QUADRILATERAL, nodes: &[3, 0, 4, 7] },
    ],
    shape_functions: |x, n| product(3, 1, &NODES[..8], x, n),
    gradients: |x, g| product_gradients(3, 1, &NODES[..8], x, g),
    children,
    types: &[CellType::new("8-node hexahedron", 8).vtk(12).gmsh(5).aster("HE8", "HEXA8").abaqus()],
    orders: FileOrders { exodus_sides: EXODUS_SIDES, ..FileOrders::SAME },
};

/// Triquadratic hexahedron with 27 nodes.
pub static Q2_HEXAHEDRON: Element = Element {
    name: "Q2 hexahedron",
    shape: Shape::Hexahedron,
    degree: 2,
    gradient_degree: 2,
    neighbours: 64.0,
    nodes: &NODES,
    facets: &[
        Facet { element: &Q2_QUADRILATERAL, nodes: &[0, 3, 2, 1, 11, 10, 9, 8, 24] },
        Facet { element: &Q2_QUADRILATERAL, nodes: &[4, 5, 6, 7, 12, 13, 14, 15, 25] },
        Facet { element: &Q2_QUADRILATERAL, nodes: &[0, 1, 5, 4, 8, 17, 12, 16, 22] },
        Facet { element: &Q2_QUADRILATERAL, nodes: &[1, 2, 6, 5, 9, 18, 13, 17, 21] },
        Facet { element: &Q2_QUADRILATERAL, nodes: &[2, 3, 7, 6, 10, 19, 14, 18, 23] },
        Facet { element: &Q2_QUADRILATERAL, nodes: &[3, 0, 4, 7, 11, 16, 15, 19, 20] },
    ],
    shape_functions: |x, n| product(3, 2, &NODES, x, n),
    gradients: |x, g| product_gradients(3, 2, &NODES, x, g),
    children,
    types: &[
        CellType::new("27-node hexahedron", 27).vtk(29).gmsh(12).aster("H27", "HEXA27"),
        CellType::new("20-node hexahedron", 20).vtk(25).gmsh(17).aster("H20", "HEXA20").abaqus(),
    ],
    orders: FileOrders {
        // Gmsh orders the edges by their first vertex, and the faces −z, −y, −x, +x, +y, +z.
        gmsh: FileOrder(&[
            0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14, 24, 22, 20, 21, 23, 25, 26,
        ]),
        // MED begins with the lower face, goes around and ends with the upper one; `.mail` files have the upright edges
        // before the upper ones, too.
        med: FileOrder(&[
            0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 24, 22, 21, 23, 20, 25, 26,
        ]),
        mail: FileOrder(&[
            0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15, 24, 22, 21, 23, 20, 25, 26,
        ]),
        // Exodus has the upright edges before the upper ones, and the centre before the faces −z, +z, −x, +x, −y, +y.
        exodus: FileOrder(&[
            0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15, 26, 24, 25, 20, 21, 22, 23,
        ]),
        exodus_sides: EXODUS_SIDES,
    },
};
