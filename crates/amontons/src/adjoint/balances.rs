//! The equations beside those of the half-steps: of contacts that a force drives, and of foundations with a heat
//! capacity.

use crate::contact::{Contact, NoSlip, PointOnBoundary};
use crate::equation::foundation::temperatures;
use crate::equation::heat::lumped;
use crate::equation::system::Step;
use crate::inclusion::PointState;
use crate::linalg::zeros;
use crate::problem::Problem;
use crate::state::State;
use crate::tensor::dot;

/// Residual of an equation relative to its largest term above which the step does not obey it.
pub(super) const MET: f64 = 1e-6;

/// The friction bound of a point, Pa; zero of one that never slips, whose bound is no traction.
pub(super) fn bound(of: f64) -> f64 {
    if of < NoSlip::BOUND { of } else { 0.0 }
}

/// The largest traction that the states of contact points show, Pa.
pub(super) fn largest_traction(states: &[PointState]) -> f64 {
    states.iter().fold(0.0, |most, state| most.max(state.pressure.abs()).max(bound(state.bound)))
}

/// True if the opposite side of a contact moves by a length that is solved for.
pub(super) fn is_moved(problem: &Problem) -> bool {
    problem.contacts.iter().any(moves)
}

/// The same of one contact.
pub(super) fn moves(contact: &Contact) -> bool {
    contact.preload.is_some() || contact.obstacle.as_ref().is_some_and(|obstacle| obstacle.load.is_some())
}

/// What each contact lacks to be in equilibrium and the size of the forces on it, N: zero of those that nothing drives.
pub(super) fn driven(step: &Step, states: &[PointState], advance: &[f64]) -> [Vec<f64>; 2] {
    let [mut lacking, mut sizes] = [0; 2].map(|_| zeros(step.problem.contacts.len()));
    if !step.problem.physics.has_mechanics() || !is_moved(step.problem) {
        return [lacking, sizes];
    }
    for drive in step.drives(advance) {
        let own = step.boundary.points.iter().zip(states).filter(|(point, _)| point.contact == drive.contact);
        let force = |(point, state): (&PointOnBoundary, &PointState)| {
            let along = drive.direction.unwrap_or(state.normal);
            point.weight * (state.pressure * dot(&state.normal, &along) + dot(&state.q, &along))
        };
        let (mut lack, mut size) = (drive.inertia[0] - drive.force, drive.inertia[0].abs().max(drive.force.abs()));
        for force in own.map(force) {
            (lack, size) = (lack - force, size + force.abs());
        }
        lacking.get_mut(drive.contact).into_iter().for_each(|of| *of = lack);
        sizes.get_mut(drive.contact).into_iter().for_each(|of| *of = size);
    }
    [lacking, sizes]
}

/// θ_F at the contact points, K: as prescribed, or in a state at the time of the equations.
pub(super) fn foundations(step: &Step, at: &State) -> Vec<f64> {
    let mut all = temperatures(step);
    for (theta, point) in all.iter_mut().zip(&step.boundary.points) {
        if let Some(Some(found)) = at.surface.foundation.get(point.contact) {
            *theta = *found;
        }
    }
    all
}

/// What the balance of each foundation lacks, W, at the heat that leaves each point, and the sizes of its terms; zero
/// where θ_F is prescribed.
pub(super) fn missing(step: &Step, at: &State, leaving: &[[f64; 2]], states: &[PointState]) -> [Vec<f64>; 2] {
    let [mut missing, mut sizes] = [0; 2].map(|_| zeros(step.problem.contacts.len()));
    for (side, of) in lumped(step).iter().enumerate() {
        let (Some(of), Some(Some(theta))) = (of, at.surface.foundation.get(side)) else { continue };
        let terms = [of.storage * (theta - of.before), of.exchange * (theta - of.surroundings)];
        missing[side] = terms[0] + terms[1];
        // Round-off of a balance is that of its temperatures.
        let round_off = f64::EPSILON * (of.storage + of.exchange) * theta.abs();
        sizes[side] = terms[0].abs() + terms[1].abs() + round_off / MET;
        let points = step.boundary.points.iter().zip(leaving.iter().zip(states));
        for (point, ([flux, _], state)) in points.filter(|(point, _)| point.contact == side) {
            let received = point.weight * (flux + dot(&state.q, &state.slip));
            missing[side] -= received;
            sizes[side] += received.abs();
        }
    }
    [missing, sizes]
}
