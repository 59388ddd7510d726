//! Distinct nodes at the same position: a crack, or parts that were not merged.

use rayon::prelude::*;

use super::super::{Block, Mesh};
use crate::tensor::{Point, dot, length, minus};

/// Fraction of the shortest edge at a node within which another node counts as coincident.
const SAME: f64 = 1e-6;
/// A direction, of length 1, with which no mesh is expected to be aligned.
const ASKEW: Point = [0.439_714_6, 0.561_332_9, 0.701_168_3];
/// Round-off of a coordinate along this direction, relative to the distance from the origin.
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

/// Pairs of coincident nodes, the lower node first, ascending.
///
/// The mesh is sound with them: a displacement may jump there. If that is not intended, the nodes must be merged. Nodes
/// must exist and have finite coordinates, see [`super::defects`].
#[must_use]
pub fn coincident(mesh: &Mesh) -> Vec<[u32; 2]> {
    let edges = shortest_edges(mesh);
    let spacing = edges.iter().copied().fold(f64::INFINITY, f64::min);
    if !(spacing > 0.0 && spacing.is_finite()) {
        return Vec::new();
    }
    // Sorted along a direction askew to any mesh, each node has few candidates.
    let along = |p: &Point| dot(p, &ASKEW);
    let mut order: Vec<(f64, u32)> = mesh.points.iter().zip(0..).map(|(p, node)| (along(p), node)).collect();
    order.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let of_node = |(node, p): (usize, &Point)| {
        let reach = SAME * if edges[node].is_finite() { edges[node] } else { spacing };
        let (here, beyond) = (along(p), reach + ROUND_OFF * length(p));
        let others = &order[order.partition_point(|(at, _)| *at < here - beyond)..];
        let others = others.iter().take_while(|(at, _)| *at <= here + beyond).map(|(_, other)| *other);
        let near = |other: &u32| length(&minus(p, &mesh.points[*other as usize])) <= reach;
        // Each pair is found at both of its nodes, or at one if their tolerances differ.
        let (node, apart) = (node as u32, |other: &u32| *other as usize != node);
        let pairs = others.filter(apart).filter(near).map(|other| [node.min(other), node.max(other)]);
        pairs.collect::<Vec<_>>()
    };
    let mut pairs: Vec<[u32; 2]> = mesh.points.par_iter().enumerate().flat_map_iter(of_node).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Shortest distance of each node to another vertex of one of its cells, m; infinite for nodes without a cell.
fn shortest_edges(mesh: &Mesh) -> Vec<f64> {
    let mut edges = vec![f64::INFINITY; mesh.points.len()];
    for cell in mesh.blocks.iter().flat_map(Block::cells) {
        for (i, &a) in cell.iter().enumerate() {
            for &b in &cell[..i] {
                let (a, b) = (a as usize, b as usize);
                let edge = length(&minus(&mesh.points[a], &mesh.points[b]));
                edges[a] = edges[a].min(edge);
                edges[b] = edges[b].min(edge);
            }
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Diagonal, MeshError};

    /// A rectangle and its copy moved by its width, in an oblique position: exactly the nodes of the common side are
    /// pairs.
    #[test]
    fn nodes_of_two_parts_that_touch_are_pairs() -> Result<(), MeshError> {
        for angle in [0.0, 0.3, 1.1] {
            let mut mesh = Mesh::rectangle([1.0, 1.0], [7, 5], Diagonal::Right)?;
            let nodes = mesh.points.len() as u32;
            let mut copy = mesh.blocks[0].clone();
            copy.nodes.iter_mut().for_each(|node| *node += nodes);
            mesh.blocks.push(copy);
            let moved: Vec<Point> = mesh.points.iter().map(|p| [p[0] + 1.0, p[1], 0.0]).collect();
            mesh.points.extend(moved);
            let (sin, cos) = f64::sin_cos(angle);
            mesh.points
                .iter_mut()
                .for_each(|p| *p = [cos * p[0] - sin * p[1] + 1e-9 * p[1], sin * p[0] + cos * p[1], 0.0]);
            let pairs = coincident(&mesh);
            assert_eq!(pairs.len(), 6, "angle {angle}: {pairs:?}");
            assert!(pairs.iter().all(|[a, b]| *a < nodes && *b >= nodes));
        }
        assert!(coincident(&Mesh::rectangle([1.0, 1.0], [7, 5], Diagonal::Crossed)?).is_empty());
        Ok(())
    }
}
