//! The unknowns of a perturbation: free displacements and temperatures, node by node in the order of elimination.

use super::eliminated::Functional;
use crate::contact::{ContactBoundary, PointOnBoundary};
use crate::discretization::Discretization;
use crate::linalg::{Layout, nested_dissection};
use crate::mesh::{leader, link_of};
use crate::space::Space;
use crate::space::rigid::rigid_of;
use crate::tensor::Point;

/// What is perturbed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Perturbed {
    pub displacement: bool,
    pub temperature: bool,
}

/// Each component of the displacement and each temperature at a node as a combination of the unknowns.
pub(super) struct PerturbedUnknowns {
    pub size: usize,
    /// By node and component.
    pub u: Vec<Functional>,
    /// By node.
    pub theta: Vec<Functional>,
    /// True for unknowns of the displacement.
    pub moves: Vec<bool>,
    dim: usize,
}

impl PerturbedUnknowns {
    /// The unknowns of a discrete problem, those on Γ_C last.
    pub fn new(discrete: &Discretization, what: Perturbed) -> PerturbedUnknowns {
        let Discretization { mesh, v, q, boundary, .. } = discrete;
        let (dim, nodes) = (mesh.dim, mesh.points.len());
        let layout = Layout::of(mesh, v, &boundary.nodes);
        let graph = layout.graph(discrete.mass.graph());
        let is_free = |node: usize| {
            what.displacement && v.free[node * dim..(node + 1) * dim].contains(&true)
                || what.temperature && q.free[node]
        };
        let keep: Vec<bool> = (0..nodes).map(is_free).collect();
        let order = nested_dissection(&graph, &mesh.points, &keep, &layout.leading_contact()).order;
        let (mut of_u, mut of_theta) = (vec![None; nodes * dim], vec![None; nodes]);
        let mut moves = Vec::new();
        for node in order.into_iter().map(|node| node as usize) {
            for dof in (node * dim..(node + 1) * dim).filter(|dof| what.displacement && v.free[*dof]) {
                of_u[dof] = Some(moves.len() as u32);
                moves.push(true);
            }
            if what.temperature && q.free[node] {
                of_theta[node] = Some(moves.len() as u32);
                moves.push(false);
            }
        }
        let u = (0..nodes as u32).flat_map(|node| (0..dim).map(move |c| (node, c)));
        let u = u.map(|(node, c)| displacement(v, &of_u, node, c)).collect();
        let theta = (0..nodes as u32).map(|node| of_theta[leader(&q.links, node) as usize].map(|at| (at, 1.0)));
        PerturbedUnknowns {
            size: moves.len(),
            u,
            theta: theta.map(|at| at.into_iter().collect()).collect(),
            moves,
            dim,
        }
    }

    /// The component of the jump at a contact point in a direction.
    pub fn jump(&self, boundary: &ContactBoundary, point: &PointOnBoundary, direction: &Point) -> Functional {
        let mut sum = Functional::new();
        for (node, value, turn) in point.entries() {
            let direction = turn.map_or(*direction, |turn| turn.back(direction));
            let first = boundary.nodes[node] as usize * self.dim;
            for c in 0..self.dim {
                add(&mut sum, value * direction[c], &self.u[first + c]);
            }
        }
        merged(sum)
    }

    /// The temperatures at a contact point on its own side and on the other one, which is empty at a foundation.
    pub fn temperatures(&self, boundary: &ContactBoundary, point: &PointOnBoundary) -> [Functional; 2] {
        let (own, other) = point.nodes.split_at(point.own);
        let of = |nodes: &[(usize, f64)], sign: f64| {
            let mut sum = Functional::new();
            for &(node, value) in nodes {
                add(&mut sum, sign * value, &self.theta[boundary.nodes[node] as usize]);
            }
            merged(sum)
        };
        [of(own, 1.0), of(other, -1.0)]
    }
}

/// The displacement of a node along an axis of space.
fn displacement(space: &Space, unknown: &[Option<u32>], node: u32, c: usize) -> Functional {
    let dim = space.components;
    if let Some((body, position)) = rigid_of(&space.rigid, node) {
        let body = &space.rigid[body];
        let motions = body.at(position).enumerate();
        return motions.filter_map(|(j, motion)| Some((unknown[body.dof(j)]?, motion[c]))).collect();
    }
    let axis: Point = std::array::from_fn(|a| f64::from(u8::from(a == c)));
    let (leader, axis) = link_of(&space.links, node).map_or((node, axis), |link| (link.to, link.back(&axis)));
    let axes = space.directions(leader);
    let along = |a: usize| axis.iter().zip(&axes[a]).map(|(x, y)| x * y).sum::<f64>();
    let of = |a: usize| Some((unknown[leader as usize * dim + a]?, along(a))).filter(|(_, factor)| *factor != 0.0);
    (0..dim).filter_map(of).collect()
}

/// Adds a multiple of a functional.
pub(super) fn add(sum: &mut Functional, factor: f64, of: &[(u32, f64)]) {
    if factor != 0.0 {
        sum.extend(of.iter().map(|(at, value)| (*at, factor * value)));
    }
}

/// A functional with each unknown once.
pub(super) fn merged(mut sum: Functional) -> Functional {
    sum.sort_by_key(|(at, _)| *at);
    sum.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 += next.1;
        }
        same
    });
    sum
}
