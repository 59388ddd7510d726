//! Cells without nodes in the middle of faces and cell: quadrilaterals of 8, hexahedra of 20, prisms of 15 and pyramids
//! of 13 nodes.
//!
//! Their shape functions (Zienkiewicz and Taylor, The Finite Element Method, "serendipity" elements; of pyramids
//! Bedrosian, 1992) are contained in those of the element with all nodes. So the body is unchanged if the missing nodes
//! are placed by these functions: in the middle of a quadrilateral face at −¼ Σ vertices + ½ Σ middles, in the middle
//! of a hexahedron at −¼ Σ + ¼ Σ. A face shared with a complete cell takes the node of that cell.

use std::collections::HashMap;

use super::{Kind, LooseBlock};
use crate::element::Element;
use crate::mesh::Block;
use crate::mesh::topology::{SortedFacet, key};
use crate::quadrature::Shape;
use crate::tensor::Point;

/// Adds the nodes of library elements that the cells of the file lack.
pub(super) fn complete(points: &mut Vec<Point>, blocks: &mut [LooseBlock]) {
    complete_with(points, &mut Vec::new(), blocks);
}

/// Completes cells by their missing nodes, which are added to the points and, if given, to the nodal values; both are
/// interpolated by the functions of the incomplete cells.
pub(in crate::mesh) fn complete_data(
    points: &mut Vec<Point>,
    values: &mut Vec<f64>,
    mut blocks: Vec<LooseBlock>,
) -> Vec<Block> {
    complete_with(points, values, &mut blocks);
    let whole = |block: LooseBlock| Some(Block { element: block.kind.element?, region: 0, nodes: block.nodes });
    blocks.into_iter().filter_map(whole).collect()
}

fn complete_with(points: &mut Vec<Point>, values: &mut Vec<f64>, blocks: &mut [LooseBlock]) {
    let lacking = |block: &LooseBlock| block.kind.element.filter(|element| element.nodes.len() > block.kind.nodes);
    if !blocks.iter().any(|block| lacking(block).is_some()) {
        return;
    }
    let mut added = Added { points, values, known: HashMap::new() };
    for block in blocks.iter().filter(|block| lacking(block).is_none()) {
        added.know(block);
    }
    for block in blocks {
        let Some(element) = lacking(block) else { continue };
        let mut nodes = Vec::with_capacity(block.nodes.len() / block.kind.nodes * element.nodes.len());
        for cell in block.nodes.chunks_exact(block.kind.nodes) {
            nodes.extend_from_slice(cell);
            for local in block.kind.nodes..element.nodes.len() {
                nodes.push(added.middle(element, cell, local));
            }
        }
        block.nodes = nodes;
        block.kind = Kind { nodes: element.nodes.len(), ..block.kind };
    }
}

/// The nodes including the added ones.
struct Added<'a> {
    points: &'a mut Vec<Point>,
    /// A value per node; empty without values.
    values: &'a mut Vec<f64>,
    /// The nodes in the middle of faces, by vertices.
    known: HashMap<SortedFacet, u32>,
}

impl Added<'_> {
    /// Records the face nodes of complete cells: an incomplete neighbour uses them.
    fn know(&mut self, block: &LooseBlock) {
        let Some(element) = block.kind.element else { return };
        let whole = (0..element.nodes.len()).collect::<Vec<_>>();
        let own = (element.shape == Shape::Quadrilateral).then_some(whole.as_slice());
        let faces: Vec<&[usize]> = own
            .into_iter()
            .chain(element.facets.iter().map(|facet| facet.nodes))
            .filter(|face| face.len() == 9)
            .collect();
        for cell in block.nodes.chunks_exact(element.nodes.len()) {
            for face in &faces {
                self.known.insert(key(face[..4].iter().map(|&node| cell[node])), cell[face[8]]);
            }
        }
    }

    /// The node in the middle of a face, shared by both of its cells, or in the middle of the cell.
    fn middle(&mut self, element: &Element, cell: &[u32], local: usize) -> u32 {
        if element.shape == Shape::Quadrilateral {
            return self.of_face(cell);
        }
        let face = element.facets.iter().find(|facet| facet.nodes.last() == Some(&local) && facet.nodes.len() == 9);
        let Some(face) = face else {
            let (vertices, middles) = cell.split_at(8);
            return self.put(vertices, middles, 0.25);
        };
        let nodes: Vec<u32> = face.nodes[..8].iter().map(|&node| cell[node]).collect();
        self.of_face(&nodes)
    }

    fn of_face(&mut self, face: &[u32]) -> u32 {
        let (vertices, middles) = face.split_at(4);
        let of = key(vertices.iter().copied());
        if let Some(&node) = self.known.get(&of) {
            return node;
        }
        let node = self.put(vertices, middles, 0.5);
        self.known.insert(of, node);
        node
    }

    fn put(&mut self, vertices: &[u32], middles: &[u32], weight: f64) -> u32 {
        let sum = |nodes: &[u32], at: &dyn Fn(usize) -> f64| nodes.iter().map(|&node| at(node as usize)).sum::<f64>();
        let between = |at: &dyn Fn(usize) -> f64| -0.25 * sum(vertices, at) + weight * sum(middles, at);
        let point = std::array::from_fn(|d| between(&|node| self.points[node][d]));
        if !self.values.is_empty() {
            self.values.push(between(&|node| self.values[node]));
        }
        self.points.push(point);
        self.points.len() as u32 - 1
    }
}
