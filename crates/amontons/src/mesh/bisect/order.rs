//! The order of edges by which cells and their faces choose the edge to bisect first.

use std::collections::{HashMap, HashSet};

use crate::element::Element;
use crate::mesh::Mesh;
use crate::tensor::{length, minus};

/// The two vertices of an edge, ascending.
pub(super) type Edge = [u32; 2];

/// The edge between two vertices.
pub(super) fn edge(a: u32, b: u32) -> Edge {
    [a.min(b), a.max(b)]
}

/// Relative difference below which consecutive lengths are the same: beyond the round-off of rotated or scaled
/// coordinates, far below the differences of edges that a mesh generator makes.
const SAME: f64 = 1e-9;

/// Ranks of edges that a mesh did not have at the start: those to the centre of a face, below those to the centre of a
/// cell, below all others.
const TO_FACE: u32 = 0;
const TO_CELL: u32 = 1;
const OF_MESH: u32 = 2;

/// A total order of the edges of a mesh: by length, and by the numbers of the vertices among equal lengths. Lengths
/// that differ by round-off are equal, so that the order does not depend on the frame of the coordinates.
pub(super) struct EdgeOrder {
    rank: HashMap<Edge, u32>,
}

impl EdgeOrder {
    /// The order of the edges of the cells.
    pub(super) fn new(mesh: &Mesh) -> EdgeOrder {
        let mut edges: Vec<Edge> = Vec::new();
        for block in &mesh.blocks {
            let of_element = edges_of(block.element);
            edges.extend(block.cells().flat_map(|cell| of_element.iter().map(|&[a, b]| edge(cell[a], cell[b]))));
        }
        edges.sort_unstable();
        edges.dedup();
        let distance = |[a, b]: Edge| length(&minus(&mesh.points[a as usize], &mesh.points[b as usize]));
        let mut lengths: Vec<(f64, Edge)> = edges.into_iter().map(|edge| (distance(edge), edge)).collect();
        lengths.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let (mut rank, mut before) = (OF_MESH, f64::INFINITY);
        let ranked = lengths.into_iter().map(|(length, edge)| {
            rank += u32::from(length - before > SAME * length);
            before = length;
            (edge, rank)
        });
        EdgeOrder { rank: ranked.collect() }
    }

    /// The last of some edges in the order. Edges of cells that are cut through their centres come before all others.
    pub(super) fn largest<const N: usize>(&self, edges: [Edge; N], face_centres: &HashSet<u32>) -> Edge {
        let key = |edge: Edge| {
            let to_face = edge.iter().any(|node| face_centres.contains(node));
            (self.rank.get(&edge).copied().unwrap_or(if to_face { TO_FACE } else { TO_CELL }), edge)
        };
        edges.into_iter().fold(edges[0], |largest, edge| if key(edge) > key(largest) { edge } else { largest })
    }
}

/// The edges of an element by its vertices.
pub(super) fn edges_of(element: &Element) -> Vec<[usize; 2]> {
    match element.dim() {
        0 => Vec::new(),
        1 => vec![[0, 1]],
        _ => {
            let of_facet = |facet: &crate::element::Facet| -> Vec<[usize; 2]> {
                let ends = |[a, b]: [usize; 2]| [facet.nodes[a], facet.nodes[b]];
                edges_of(facet.element).into_iter().map(ends).map(|[a, b]| [a.min(b), a.max(b)]).collect()
            };
            let mut edges: Vec<[usize; 2]> = element.facets.iter().flat_map(of_facet).collect();
            edges.sort_unstable();
            edges.dedup();
            edges
        }
    }
}
