//! The equations of nodes without mass in a step whose other equations hold before its end.
//!
//! A node in contact that has no mass has no impact: its equation is static, and with the law of contact it makes its
//! position a Lipschitz function of those of the others (Khenous, Laborde, Renard 2008). It is asked to hold at the end
//! of the step, as the laws of contact are, so that nothing alternates from step to step:
//!
//! B w₁ + A u₁ + F₁ = f(t₁) + G θ₁ with w₁ = w₀ + (x − w₀)/ϑ,
//!
//! F₁ the forces of contact. Multiplied by ϑ it is the equation at t_ϑ with ϑ F₁ in the place of the forces of contact
//! and, added to the load, ϑ f(t₁) − f(t_ϑ) + (1 − ϑ)(B w₀ + A u₀ − G θ₀), which is −(1 − ϑ) F₀ if the node was in
//! balance at t₀. So K stays symmetric and is the matrix of the ϑ-scheme.
//!
//! The velocity of such a node is that of the step, u₁ = u₀ + k x and w₁ = x: extrapolated to the end of the step it
//! would alternate, because nothing but the node itself would remember it.

use super::system::{Step, on_degrees};
use crate::inclusion::PointState;
use crate::linalg::zeros;
use crate::space::Space;

/// What the equations of nodes without mass have more than those at t_ϑ.
pub(crate) struct Massless {
    /// Their degrees of freedom.
    dofs: Vec<usize>,
    /// ϑ.
    level: f64,
    /// What is added to the load, N, one number per degree of freedom.
    added: Vec<f64>,
}

impl Massless {
    /// The nodes without mass in a step, or `None` if all equations hold at one time.
    pub fn of(step: &Step, load: &[f64]) -> Option<Massless> {
        if !step.rule.balances_contact_at_end() || step.discrete.massless().is_empty() {
            return None;
        }
        let (theta, dofs) = (step.rule.level, step.massless_dofs().collect::<Vec<usize>>());
        let at_end = step.load_at(step.t);
        let thermal = step.discrete.thermal_force(&step.old.theta);
        let mut relaxing = zeros(load.len());
        for (branch, z) in step.discrete.branches.iter().zip(&step.old.branches) {
            relaxing.iter_mut().zip(branch.force(z)).for_each(|(sum, force)| *sum += force);
        }
        let (a_u, b_w) = (&step.products.a_u, &step.products.b_w);
        let of = |&i: &usize| {
            let before = b_w[i] + a_u[i] + relaxing[i] - thermal[i];
            theta * at_end[i] - load[i] + (1.0 - theta) * before
        };
        let added = dofs.iter().map(of).collect();
        Some(Massless { dofs, level: theta, added })
    }

    /// The load with what is added to it.
    pub fn load(&self, load: &[f64]) -> Vec<f64> {
        let mut load = load.to_vec();
        self.dofs.iter().zip(&self.added).for_each(|(&i, added)| load[i] += added);
        load
    }

    /// Makes the forces of contact those that the equations have.
    pub fn share(&self, forces: &mut [f64]) {
        for force in forces {
            *force *= self.level;
        }
    }

    /// Power at the velocity `w` of what is added to the load and of the share of the forces of contact that is not in
    /// the equations, W.
    pub fn power(&self, step: &Step, states: &[PointState], w: &[f64]) -> f64 {
        let force = |state: &PointState| std::array::from_fn(|c| state.pressure * state.normal[c] + state.q[c]);
        let forces = on_degrees(step.boundary, &step.discrete.v, states.iter().map(force));
        self.dofs.iter().zip(&self.added).map(|(&i, added)| w[i] * (added + (1.0 - self.level) * forces[i])).sum()
    }
}

/// The reactions of the supports by the residual of (4.1), those of nodes without mass at the end of the step; their
/// work along the prescribed rates in the time k, and by how much it is more than that of the residual, J.
pub(crate) fn reactions(
    massless: Option<&Massless>,
    space: &Space,
    residual: &[f64],
    (rates, k): (&[f64], f64),
) -> (Vec<f64>, [f64; 2]) {
    let work = |reactions: &[f64]| reactions.iter().zip(rates).map(|(r, w)| k * r * w).sum::<f64>();
    let seen = space.prescribed_of(residual);
    let before = work(&seen);
    let Some(Massless { dofs, level, .. }) = massless else { return (seen, [before, 0.0]) };
    let mut at_end = residual.to_vec();
    for &i in dofs {
        at_end[i] /= level;
    }
    let at_end = space.prescribed_of(&at_end);
    let after = work(&at_end);
    (at_end, [after, after - before])
}

impl Step<'_> {
    /// The degrees of freedom of the nodes without mass.
    pub fn massless_dofs(&self) -> impl Iterator<Item = usize> {
        let dim = self.discrete.mesh.dim;
        self.discrete.massless().iter().flat_map(move |&node| (0..dim).map(move |c| node as usize * dim + c))
    }
}
