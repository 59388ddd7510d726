//! What the contact points exert on the bodies at given states: forces and heat.

use super::balances::{foundations, missing};
use crate::equation::system::Step;
use crate::inclusion::{HeatStep, PointState};
use crate::linalg::zeros;
use crate::state::State;
use crate::tensor::Point;

/// The pressure of a fluid at a contact point that it wets, Pa; zero at others.
pub(super) fn fluid_at(step: &Step, i: usize, wet: &[bool]) -> f64 {
    let Some(point) = step.boundary.points.get(i).filter(|_| wet.get(i).copied().unwrap_or(false)) else { return 0.0 };
    let fluid = step.contacts.get(point.contact).and_then(|contact| contact.fluid.as_ref());
    fluid.map_or(0.0, |fluid| fluid.pressure.value(&point.x, step.level))
}

/// The forces of contact points and of fluids that the nodes of Γ_C lose.
pub(super) fn exerted(step: &Step, states: &[PointState], wet: &[bool]) -> Vec<f64> {
    if !step.problem.physics.has_mechanics() {
        return Vec::new();
    }
    let mut sum = zeros(step.discrete.v.free.len());
    let force = |(i, s): (usize, &PointState)| -> Point {
        let pressure = s.pressure + fluid_at(step, i, wet);
        std::array::from_fn(|c| pressure * s.normal[c] + s.q[c])
    };
    step.boundary.scatter(step.discrete.v.components, states.iter().enumerate().map(force), &mut sum);
    step.boundary.restricted(step.discrete.v.components, &sum)
}

/// Heat of contact: what the nodes of Γ_C lose, what foundations miss, and the sizes of their balances, W.
#[derive(Default)]
pub(super) struct HeatOfContact {
    pub passed: Vec<f64>,
    pub missing: Vec<f64>,
    pub warming: Vec<f64>,
}

/// The heat of contact at the temperatures of a state.
pub(super) fn passed(step: &Step, at: &State, states: &[PointState]) -> HeatOfContact {
    if !step.problem.physics.has_heat() {
        return HeatOfContact::default();
    }
    let (mut sum, foundation) = (zeros(at.theta.len()), foundations(step, at));
    let leaving = heat_step(step, &foundation, states).sides_at(&at.theta);
    step.boundary.scatter_heat(leaving.iter().copied(), &mut sum);
    let [missing, warming] = missing(step, at, &leaving, states);
    HeatOfContact { passed: step.boundary.restricted(1, &sum), missing, warming }
}

/// The heat exchange of a step on Γ_C at states of the contact points, to evaluate its laws.
pub(super) fn heat_step<'a>(step: &Step<'a>, foundation: &'a [f64], states: &'a [PointState]) -> HeatStep<'a> {
    HeatStep {
        contacts: step.contacts,
        boundary: step.boundary,
        unknown: &[],
        theta_prescribed: &[],
        foundation,
        lumped: &[],
        states,
    }
}
