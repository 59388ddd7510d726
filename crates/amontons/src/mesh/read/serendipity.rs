//! Cells without nodes in the middle of their faces and of the cell: quadrilaterals of 8, hexahedra of 20, prisms
//! of 15 and pyramids of 13 nodes.
//!
//! Their shape functions (Zienkiewicz and Taylor, The Finite Element Method, "serendipity" elements) are among those of
//! the element with all nodes. So the body stays the same when the missing nodes are put where the functions have them:
//! in the middle of a quadrilateral face at −¼ Σ vertices + ½ Σ middles, in that of a hexahedron at −¼ Σ + ¼ Σ.

use std::collections::HashMap;

use super::{Kind, LooseBlock};
use crate::element::{self, Element};
use crate::mesh::topology::{Key, key};
use crate::quadrature::Shape;
use crate::tensor::Point;

/// The element with all nodes of a shape that a file gives with so many.
pub(in crate::mesh) fn completed(shape: Shape, nodes: usize) -> Option<&'static Element> {
    match (shape, nodes) {
        (Shape::Quadrilateral, 8) => Some(&element::Q2_QUADRILATERAL),
        (Shape::Hexahedron, 20) => Some(&element::Q2_HEXAHEDRON),
        (Shape::Prism, 15) => Some(&element::P2_PRISM),
        (Shape::Pyramid, 13) => Some(&element::P2_PYRAMID),
        _ => None,
    }
}

/// The element of a type of cells of VTK, and how many of its nodes, the first ones, these cells have.
pub(in crate::mesh) fn of_vtk(code: u8) -> Option<(&'static Element, usize)> {
    let (shape, nodes) = match code {
        23 => (Shape::Quadrilateral, 8),
        25 => (Shape::Hexahedron, 20),
        26 => (Shape::Prism, 15),
        _ => return element::ALL.into_iter().find(|e| e.vtk == code).map(|e| (e, e.vtk_nodes())),
    };
    completed(shape, nodes).map(|element| (element, nodes))
}

/// Adds the nodes that the elements of the library have and the cells of the file have not.
pub(super) fn complete(points: &mut Vec<Point>, blocks: &mut [LooseBlock]) {
    let mut known: HashMap<Key, u32> = HashMap::new();
    for block in blocks {
        let Some(element) = block.kind.element.filter(|element| element.nodes.len() > block.kind.nodes) else {
            continue;
        };
        let mut nodes = Vec::with_capacity(block.nodes.len() / block.kind.nodes * element.nodes.len());
        for cell in block.nodes.chunks_exact(block.kind.nodes) {
            nodes.extend_from_slice(cell);
            for local in block.kind.nodes..element.nodes.len() {
                nodes.push(middle(points, &mut known, element, cell, local));
            }
        }
        block.nodes = nodes;
        block.kind = Kind { nodes: element.nodes.len(), ..block.kind };
    }
}

/// The node in the middle of a face, one for both cells that have it, or in the middle of the cell.
fn middle(
    points: &mut Vec<Point>,
    known: &mut HashMap<Key, u32>,
    element: &Element,
    cell: &[u32],
    local: usize,
) -> u32 {
    let put = |points: &mut Vec<Point>, vertices: &[u32], middles: &[u32], weight: f64| {
        let sum = |nodes: &[u32], d: usize| nodes.iter().map(|&node| points[node as usize][d]).sum::<f64>();
        let point = std::array::from_fn(|d| -0.25 * sum(vertices, d) + weight * sum(middles, d));
        points.push(point);
        points.len() as u32 - 1
    };
    if element.shape == Shape::Quadrilateral {
        let (vertices, middles) = cell.split_at(4);
        let of = key(vertices.iter().copied());
        return *known.entry(of).or_insert_with(|| put(points, vertices, middles, 0.5));
    }
    let face = element.facets.iter().find(|facet| facet.nodes.last() == Some(&local) && facet.nodes.len() == 9);
    let Some(face) = face else {
        let (vertices, middles) = cell.split_at(8);
        return put(points, vertices, middles, 0.25);
    };
    let nodes: Vec<u32> = face.nodes[..8].iter().map(|&node| cell[node]).collect();
    let (vertices, middles) = nodes.split_at(4);
    *known.entry(key(vertices.iter().copied())).or_insert_with(|| put(points, vertices, middles, 0.5))
}
