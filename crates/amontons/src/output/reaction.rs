//! Reactions at prescribed displacements and temperatures: sums over the nodes of a side, an edge or points.

use super::Snapshot;
use super::quantity::Base;
use crate::mesh::{leader, link_of};
use crate::problem::ProblemData;
use crate::space::rigid::rigid_of;
use crate::space::{RigidNodes, Space};
use crate::tensor::Point;

/// Numbers of the reactions of a set of nodes among those that [`crate::scheme::Reactions`] lists.
#[derive(Debug)]
pub(super) struct Held {
    of_heat: bool,
    /// Each with its direction.
    numbers: Vec<(usize, Point)>,
}

/// The resultants of what holds the motions of each rigid body with one of some nodes, per unit of what it bears; empty
/// for other bodies. None if a body that nothing holds has one of the nodes.
fn bodies(space: &Space, nodes: &[u32]) -> Option<Vec<Vec<Point>>> {
    let of = |body: &RigidNodes| {
        if !nodes.iter().any(|&node| body.position(node).is_some()) {
            return Some(Vec::new());
        }
        let mut sums = vec![[0.0; 3]; body.held];
        for i in 0..body.nodes.len() {
            for (sum, motion) in sums.iter_mut().zip(body.at(i)) {
                *sum = std::array::from_fn(|c| sum[c] + motion[c]);
            }
        }
        (body.held > 0).then_some(sums)
    };
    space.rigid.iter().map(of).collect()
}

impl Held {
    /// Of some nodes; none if there is none, or one that no prescribed value: what it bears would be no reaction.
    pub(super) fn new(problem: &ProblemData, base: Base, mut nodes: Vec<u32>) -> Option<Held> {
        if nodes.is_empty() {
            return None;
        }
        let of_heat = base == Base::ReactionHeat;
        let space = if of_heat { problem.temperature_space() } else { problem.displacement_space() };
        // What is borne at a node that follows another one is borne there.
        for node in &mut nodes {
            *node = leader(&space.links, *node);
        }
        nodes.sort_unstable();
        nodes.dedup();
        let bodies = bodies(&space, &nodes)?;
        let (mut numbers, mut nodes) = (Vec::new(), nodes.into_iter().peekable());
        let mut number = 0;
        for (node, free) in (0u32..).zip(space.free.chunks_exact(space.components)) {
            let is_here = nodes.next_if(|&next| next == node).is_some();
            if let Some((body, position)) = rigid_of(&space.rigid, node) {
                // The prescribed motions of a rigid body stand at its first nodes.
                let first = position * space.components;
                for j in first..space.rigid[body].held.min(first + space.components) {
                    numbers.extend(bodies[body].get(j).map(|sum| (number, *sum)));
                    number += 1;
                }
                continue;
            }
            if is_here && free.iter().all(|free| *free) {
                return None;
            }
            if link_of(&space.links, node).is_some() {
                continue;
            }
            for (c, _) in free.iter().enumerate().filter(|(_, free)| !**free) {
                if is_here {
                    numbers.push((number, space.directions(node)[c]));
                }
                number += 1;
            }
        }
        Some(Held { of_heat, numbers })
    }

    /// The resultant in a step, N or W per unit of thickness in two dimensions; at t = 0 it is not a number.
    pub(super) fn resultant(&self, now: &Snapshot) -> Point {
        let Some(report) = now.report else { return [f64::NAN; 3] };
        let all = if self.of_heat { &report.reactions.heat } else { &report.reactions.force };
        let value = |i: usize| all.get(i).copied().unwrap_or(f64::NAN);
        std::array::from_fn(|c| self.numbers.iter().map(|&(i, direction)| value(i) * direction[c]).sum())
    }
}
