//! Meshes of intervals, rectangles and boxes.

use std::collections::BTreeMap;

use super::{Block, FacetSet, Mesh, MeshError};
use crate::element::{Element, P1_SEGMENT, P1_TRIANGLE, POINT_LEFT, POINT_RIGHT, Q1_QUADRILATERAL};
use crate::tensor::Point;

/// Direction in which the squares of a rectangle mesh are split into triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Diagonal {
    /// From lower left to upper right: /.
    #[default]
    Right,
    /// From upper left to lower right: \.
    Left,
    /// Both, with a node in the middle: ×.
    Crossed,
}

/// Elements of a generated mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Elements {
    /// Linear segments, triangles, tetrahedra.
    #[default]
    P1,
    /// Quadratic segments, triangles, tetrahedra.
    P2,
    /// Segments, quadrilaterals, hexahedra, of degree 1 in each coordinate.
    Q1,
    /// Segments, quadrilaterals, hexahedra of degree 2 in each coordinate, with 3, 9 and 27 nodes.
    Q2,
}

impl Elements {
    /// Degree of the elements, 1 or 2.
    #[must_use]
    pub fn degree(self) -> usize {
        if matches!(self, Elements::P1 | Elements::Q1) { 1 } else { 2 }
    }

    /// True if the cells are triangles and tetrahedra.
    #[must_use]
    pub fn are_simplices(self) -> bool {
        matches!(self, Elements::P1 | Elements::P2)
    }

    /// Adds middle nodes, at the means of the vertices, to a linear mesh if the degree is 2.
    fn complete(self, mesh: Mesh) -> Result<Mesh, MeshError> {
        if self.degree() == 1 { Ok(mesh) } else { mesh.quadratic() }
    }
}

impl Mesh {
    /// The interval (0, length) in equal cells; facet sets `left`, `right`.
    ///
    /// # Errors
    /// Fails if the length is not positive and finite, the number of cells zero, or the mesh too large.
    pub fn interval(length: f64, cells: usize, elements: Elements) -> Result<Mesh, MeshError> {
        check(&[length], &[cells], cells as f64 * elements.degree() as f64 + 1.0)?;
        let n = cells as u32;
        let points = (0..=cells).map(|i| [length * (i as f64 / cells as f64), 0.0, 0.0]).collect();
        let facets = BTreeMap::from([
            ("left".to_owned(), FacetSet::of(&POINT_LEFT, vec![0])),
            ("right".to_owned(), FacetSet::of(&POINT_RIGHT, vec![n])),
        ]);
        let nodes = (0..n).flat_map(|i| [i, i + 1]).collect();
        elements.complete(body(&P1_SEGMENT, points, nodes, facets))
    }

    /// The rectangle (0, size₀) × (0, size₁) divided into cells₀ × cells₁ squares, each split into triangles; facet
    /// sets `left`, `right`, `bottom`, `top`; nodes numbered row by row.
    ///
    /// # Errors
    /// Fails if a size is not positive and finite, a number of cells zero, or the mesh too large.
    pub fn rectangle(size: [f64; 2], cells: [usize; 2], diagonal: Diagonal) -> Result<Mesh, MeshError> {
        Mesh::rectangle_of(Elements::P1, size, cells, diagonal)
    }

    /// [`Mesh::rectangle`] with other elements; `diagonal` is ignored for quadrilaterals.
    ///
    /// # Errors
    /// Fails like [`Mesh::rectangle`].
    pub fn rectangle_of(
        elements: Elements,
        size: [f64; 2],
        cells: [usize; 2],
        diagonal: Diagonal,
    ) -> Result<Mesh, MeshError> {
        let degree = elements.degree();
        let middles = if elements.are_simplices() {
            rectangle_nodes(cells.map(|n| n.saturating_mul(degree)), diagonal)
        } else {
            0.0
        };
        check(&size, &cells, middles.max(cells.iter().map(|&n| n as f64 * degree as f64 + 1.0).product()))?;
        let [nx, ny] = cells;
        let at = |i: usize, j: usize| (j * (nx + 1) + i) as u32;
        let x = |i: f64| size[0] * (i / nx as f64);
        let y = |j: f64| size[1] * (j / ny as f64);
        let mut points = Vec::new();
        for j in 0..=ny {
            for i in 0..=nx {
                points.push([x(i as f64), y(j as f64), 0.0]);
            }
        }
        let mut nodes = Vec::new();
        for j in 0..ny {
            for i in 0..nx {
                let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                match diagonal {
                    _ if !elements.are_simplices() => nodes.extend([a, b, c, d]),
                    Diagonal::Right => nodes.extend([a, b, c, a, c, d]),
                    Diagonal::Left => nodes.extend([a, b, d, b, c, d]),
                    Diagonal::Crossed => {
                        let m = points.len() as u32;
                        points.push([x(i as f64 + 0.5), y(j as f64 + 0.5), 0.0]);
                        nodes.extend([a, b, m, b, c, m, c, d, m, d, a, m]);
                    }
                }
            }
        }
        let side = |nodes: Vec<u32>| FacetSet::of(&P1_SEGMENT, nodes);
        let facets = BTreeMap::from([
            ("bottom".to_owned(), side((0..nx).flat_map(|i| [at(i, 0), at(i + 1, 0)]).collect())),
            ("right".to_owned(), side((0..ny).flat_map(|j| [at(nx, j), at(nx, j + 1)]).collect())),
            ("top".to_owned(), side((0..nx).rev().flat_map(|i| [at(i + 1, ny), at(i, ny)]).collect())),
            ("left".to_owned(), side((0..ny).rev().flat_map(|j| [at(0, j + 1), at(0, j)]).collect())),
        ]);
        let element = if elements.are_simplices() { &P1_TRIANGLE } else { &Q1_QUADRILATERAL };
        elements.complete(body(element, points, nodes, facets))
    }

    /// The box (0, size₀) × (0, size₁) × (0, size₂) divided into cells₀ × cells₁ × cells₂ cubes, each split into six
    /// tetrahedra for P1 and P2; facet sets `left`, `right` (x), `bottom`, `top` (y), `back`, `front` (z).
    ///
    /// # Errors
    /// Fails if a size is not positive and finite, a number of cells zero, or the mesh too large.
    pub fn box_(size: [f64; 3], cells: [usize; 3], elements: Elements) -> Result<Mesh, MeshError> {
        check(&size, &cells, cells.iter().map(|&n| n as f64 * elements.degree() as f64 + 1.0).product())?;
        let base = if elements.are_simplices() { Elements::P1 } else { Elements::Q1 };
        let section = Mesh::rectangle_of(base, [size[0], size[1]], [cells[0], cells[1]], Diagonal::Right)?;
        let body = section.extruded(size[2], cells[2], ["back", "front"])?;
        elements.complete(if elements.are_simplices() { body.simplices()? } else { body })
    }
}

/// The mesh of a body of one region whose cells are of one element.
pub(super) fn body(
    element: &'static Element,
    points: Vec<Point>,
    nodes: Vec<u32>,
    facets: BTreeMap<String, FacetSet>,
) -> Mesh {
    Mesh {
        dim: element.dim(),
        axisymmetric: false,
        thickness: None,
        points,
        blocks: vec![Block { element, region: 0, nodes }],
        regions: vec!["body".to_owned()],
        facets,
        edges: BTreeMap::new(),
    }
}

/// Checks lengths and numbers of cells per direction, and the number of nodes.
pub(super) fn check(sizes: &[f64], cells: &[usize], nodes: f64) -> Result<(), MeshError> {
    for (direction, (&size, &count)) in sizes.iter().zip(cells).enumerate() {
        if !(size.is_finite() && size > 0.0) {
            return Err(MeshError::Size { direction, found: size });
        }
        if count == 0 {
            return Err(MeshError::Cells { direction, found: 0 });
        }
    }
    if nodes > f64::from(u32::MAX) { Err(MeshError::TooLarge { found: nodes }) } else { Ok(()) }
}

/// Number of nodes of [`Mesh::rectangle`], as a real number because it may overflow an integer.
#[must_use]
pub fn rectangle_nodes(cells: [usize; 2], diagonal: Diagonal) -> f64 {
    let [nx, ny] = [cells[0] as f64, cells[1] as f64];
    (nx + 1.0) * (ny + 1.0) + if diagonal == Diagonal::Crossed { nx * ny } else { 0.0 }
}
