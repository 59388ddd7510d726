//! Everything that acts on a side, an edge or points: prescribed values, given loads, supports and contact.

use super::Snapshot;
use super::reaction::{Arms, Held};
use crate::contact::PointOnBoundary;
use crate::forms::{self, Load};
use crate::linalg::BlockMatrix;
use crate::mesh::FacetSet;
use crate::problem::ProblemData;
use crate::state::StepReport;
use crate::tensor::Point;

/// Everything that acts on a set of facets. `about` is the reference point of the moment, or `None` for the force.
#[derive(Debug)]
pub(super) struct Borne {
    held: Held,
    about: Option<Point>,
    load: Load,
    springs: Option<BlockMatrix>,
    dashpots: Option<BlockMatrix>,
    /// Numbers of the contacts with a facet of the set, each with true if its side there bears the contact points.
    contacts: Vec<(usize, bool)>,
    /// The nodes of the set, ascending.
    nodes: Vec<u32>,
}

impl Borne {
    pub(super) fn new(problem: &ProblemData, set: &FacetSet, about: Option<Point>) -> Borne {
        let (mesh, nodes) = (&problem.mesh, set.node_list());
        let touches = |side: &str| mesh.facets.get(side).is_some_and(|other| !set.common(other).is_empty());
        let contacts = problem.contacts.iter().enumerate().flat_map(|(number, contact)| {
            let bears = touches(contact.bearing()).then_some((number, true));
            bears.into_iter().chain(contact.facing().is_some_and(touches).then_some((number, false)))
        });
        let [springs, dashpots] = forms::supports_on(mesh, &problem.boundary, set);
        Borne {
            held: Held::on(problem, set, about),
            about,
            load: forms::load_on(problem, set),
            springs,
            dashpots,
            contacts: contacts.collect(),
            nodes,
        }
    }

    /// The force in N or the moment in N m, per unit of thickness in two dimensions; NaN at t = 0.
    pub(super) fn value(&self, now: &Snapshot) -> Point {
        let Some(report) = now.report else { return [f64::NAN; 3] };
        let (mesh, state) = (&now.problem.mesh, now.state);
        let (arms, n) = (Arms { mesh, about: self.about }, mesh.dim);
        let mut forces = self.load.at(state.t).to_vec();
        for (support, moved) in [(&self.springs, &state.u), (&self.dashpots, &state.w)] {
            let of_support = support.iter().flat_map(|form| form.apply(moved));
            forces.iter_mut().zip(of_support).for_each(|(force, more)| *force -= more);
        }
        // Forces set from the outside count at each node of the set, whatever the side that they were set on.
        for &node in &self.nodes {
            let of_node = node as usize * n..(node as usize + 1) * n;
            let set = report.forces.get(of_node.clone()).unwrap_or_default();
            forces.get_mut(of_node).into_iter().flatten().zip(set).for_each(|(force, more)| *force += more);
        }
        self.add_contact(now, report, &mut forces);
        let mut sum = self.held.resultant(now);
        for (node, force) in (0u32..).zip(forces.chunks_exact(n)) {
            let more = arms.of(node, &std::array::from_fn(|c| force.get(c).copied().unwrap_or_default()));
            sum = std::array::from_fn(|c| sum[c] + more[c]);
        }
        sum
    }

    /// Adds the forces of contact, and of a fluid in it, at the nodes of the set.
    fn add_contact(&self, now: &Snapshot, report: &StepReport, forces: &mut [f64]) {
        let (state, n) = (now.state, now.problem.mesh.dim);
        let boundary = report.contact.boundary.as_deref().unwrap_or(now.discretization.boundary.as_ref());
        let fluid = |i: usize, point: &PointOnBoundary| {
            let is_wet = state.surface.wet.points.get(i).copied().unwrap_or(false);
            let fluid = now.problem.contacts.get(point.contact).and_then(|contact| contact.fluid.as_ref());
            fluid.filter(|_| is_wet).map_or(0.0, |fluid| fluid.pressure.value(&point.x, state.t))
        };
        for (i, (point, state)) in boundary.points.iter().zip(&report.contact.states).enumerate() {
            let pressure = state.pressure + fluid(i, point);
            for &(_, bears) in self.contacts.iter().filter(|(number, _)| *number == point.contact) {
                let force: Point = std::array::from_fn(|c| pressure * state.normal[c] + state.q[c]);
                let of_side = point.entries().enumerate().filter(|(i, _)| (*i < point.own) == bears);
                for (_, (local, value, turn)) in of_side {
                    let Some(node) = boundary.nodes.get(local).filter(|node| self.nodes.binary_search(node).is_ok())
                    else {
                        continue;
                    };
                    let at_node = turn.map_or(force, |turn| turn.back(&force));
                    let own = forces.get_mut(*node as usize * n..(*node as usize + 1) * n);
                    own.into_iter().flatten().zip(at_node).for_each(|(sum, c)| *sum -= point.weight * value * c);
                }
            }
        }
    }
}
