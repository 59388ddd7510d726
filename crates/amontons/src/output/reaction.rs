//! Reactions at prescribed displacements and temperatures: sums over the nodes of a side, an edge or points.

use super::Snapshot;
use super::quantity::Base;
use crate::mesh::{FacetSet, Mesh, cross, leader, link_of};
use crate::problem::{BoundaryCondition, ProblemData};
use crate::space::rigid::rigid_of;
use crate::space::{RigidNodes, Space};
use crate::tensor::Point;

/// Numbers of the reactions of a set of nodes in the list [`crate::state::Reactions`].
#[derive(Debug, Default)]
pub(super) struct Held {
    of_heat: bool,
    /// Each number with its direction, or its moment about a point.
    numbers: Vec<(usize, Point)>,
}

/// The kind of sum: forces, or their moments about the point `about`.
#[derive(Clone, Copy)]
pub(super) struct Arms<'a> {
    pub mesh: &'a Mesh,
    pub about: Option<Point>,
}

impl Arms<'_> {
    /// The contribution of a force at a node to the sum.
    pub(super) fn of(&self, node: u32, force: &Point) -> Point {
        let Some(about) = &self.about else { return *force };
        let x = self.mesh.points.get(node as usize).copied().unwrap_or_default();
        cross(&std::array::from_fn(|c| x[c] - about[c]), force)
    }

    /// Contribution of each prescribed motion of a rigid body to the sum, per unit of its reaction.
    fn of_body(&self, body: &RigidNodes) -> Vec<Point> {
        let mut sums = vec![[0.0; 3]; body.held];
        for (i, &node) in body.nodes.iter().enumerate() {
            for (sum, motion) in sums.iter_mut().zip(body.at(i)) {
                let more = self.of(node, &motion);
                *sum = std::array::from_fn(|c| sum[c] + more[c]);
            }
        }
        sums
    }
}

/// Contributions of the prescribed motions of rigid bodies with a node among `nodes`, per unit of their reactions;
/// empty for other bodies. `None` if such a body has no prescribed motion.
fn bodies(space: &Space, nodes: &[u32], arms: &Arms) -> Option<Vec<Vec<Point>>> {
    let of = |body: &RigidNodes| {
        if !nodes.iter().any(|&node| body.position(node).is_some()) {
            return Some(Vec::new());
        }
        (body.held > 0).then(|| arms.of_body(body))
    };
    space.rigid.iter().map(of).collect()
}

/// These contributions for bodies with all nodes among `nodes`; empty for other bodies.
fn whole_bodies(space: &Space, nodes: &[u32], arms: &Arms) -> Vec<Vec<Point>> {
    let is_in = |body: &RigidNodes| body.nodes.iter().all(|node| nodes.binary_search(node).is_ok());
    space.rigid.iter().map(|body| if is_in(body) { arms.of_body(body) } else { Vec::new() }).collect()
}

/// The leaders of some nodes, ascending: the reaction of a follower acts at its leader.
fn leaders(space: &Space, nodes: &[u32]) -> Vec<u32> {
    let mut nodes: Vec<u32> = nodes.iter().map(|&node| leader(&space.links, node)).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

impl Held {
    /// Reactions at some nodes, as moments if `about` is given. `None` without nodes, or if one of them has no
    /// prescribed value: its force would be no reaction.
    pub(super) fn new(problem: &ProblemData, base: Base, nodes: &[u32], about: Option<Point>) -> Option<Held> {
        if nodes.is_empty() {
            return None;
        }
        let of_heat = base == Base::ReactionHeat;
        let space = if of_heat { problem.temperature_space() } else { problem.displacement_space() };
        let (nodes, arms) = (leaders(&space, nodes), Arms { mesh: &problem.mesh, about });
        let bodies = bodies(&space, &nodes, &arms)?;
        let is_free = |node: u32| {
            let first = node as usize * space.components;
            let free = space.free.get(first..first + space.components);
            free.is_none_or(|free| free.iter().all(|free| *free)) && rigid_of(&space.rigid, node).is_none()
        };
        let is_held = !nodes.iter().any(|&node| is_free(node));
        is_held.then(|| Held { of_heat, numbers: numbers(&space, &nodes, &bodies, &arms, |_| true) })
    }

    /// Reactions of conditions on facets of a set, each in its own directions: at a node of two sides a reaction
    /// belongs to the side that prescribes the value. A rigid body counts if all its nodes are on the set.
    pub(super) fn on(problem: &ProblemData, set: &FacetSet, about: Option<Point>) -> Held {
        let mesh = &problem.mesh;
        let (space, arms, nodes) = (problem.displacement_space(), Arms { mesh, about }, set.node_list());
        let bodies = whole_bodies(&space, &nodes, &arms);
        let is_on = |on: &str| mesh.named(on).is_some_and(|held| !set.common(held).is_empty());
        let of_condition = |b: &BoundaryCondition| vec![is_on(&b.on); b.prescriptions(mesh).len()];
        let on: Vec<bool> = problem.boundary.iter().flat_map(of_condition).collect();
        // A reaction of the axis of a sector belongs to no side.
        let counts =
            |number: usize| space.prescription_of(number).is_none_or(|given| on.get(given).copied().unwrap_or(true));
        let numbers = numbers(&space, &leaders(&space, &nodes), &bodies, &arms, counts);
        Held { of_heat: false, numbers }
    }

    /// True without reactions.
    pub(super) fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// The resultant in a step, N or W, per unit of thickness in two dimensions; NaN at t = 0.
    pub(super) fn resultant(&self, now: &Snapshot) -> Point {
        let Some(report) = now.report else { return [f64::NAN; 3] };
        let all = if self.of_heat { &report.reactions.heat } else { &report.reactions.force };
        let value = |i: usize| all.get(i).copied().unwrap_or(f64::NAN);
        std::array::from_fn(|c| self.numbers.iter().map(|&(i, direction)| value(i) * direction[c]).sum())
    }
}

/// The numbers of the counted reactions at some nodes and of some rigid bodies, each with its contribution to the sum
/// per unit.
fn numbers(
    space: &Space,
    nodes: &[u32],
    bodies: &[Vec<Point>],
    arms: &Arms,
    counts: impl Fn(usize) -> bool,
) -> Vec<(usize, Point)> {
    let (mut numbers, mut nodes) = (Vec::new(), nodes.iter().copied().peekable());
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
        if link_of(&space.links, node).is_some() {
            continue;
        }
        for (c, _) in free.iter().enumerate().filter(|(_, free)| !**free) {
            if is_here && counts(number) {
                numbers.push((number, arms.of(node, &space.directions(node)[c])));
            }
            number += 1;
        }
    }
    numbers
}
