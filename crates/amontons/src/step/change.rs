//! What a change of conditions does to a state: supports take their energy with them, and may give up their force in
//! the course of the next phase.

use crate::discretization::Discretization;
use crate::forms;
use crate::linalg::dot;
use crate::problem::Problem;
use crate::state::{State, StepReport};
use crate::time::Instant;

/// Counts the energy of the springs that end and begin with a phase: they take it with them, and bring it, which is
/// work of the supports. `before` is the problem with the conditions of the phase before.
pub(super) fn supported(before: &Problem, discrete: &Discretization, state: &mut State) {
    let energy = |springs: Option<&crate::linalg::BlockMatrix>| {
        springs.map_or(0.0, |springs| 0.5 * dot(&state.u, &springs.apply(&state.u)))
    };
    let ended = forms::springs(&discrete.mesh, discrete.mass.graph(), &before.boundary);
    let change = energy(discrete.springs.as_ref()) - energy(ended.as_ref());
    state.ledger.elastic += change;
    state.ledger.load_work += change;
    state.ledger.turned_over += change.abs();
}

/// The forces that the supports which end with the phase of a step give up in the course of the next one, N per degree
/// of freedom; empty if there are none. Directions that the next phase holds, too, have none.
pub(super) fn released(problem: &Problem, discrete: &Discretization, report: &StepReport, now: &Instant) -> Vec<f64> {
    let releases = problem.releases_in_phase();
    let forces = &report.reactions.force;
    if forces.is_empty() || now.phase + 1 >= problem.timeline.phases().len() || !releases.contains(&true) {
        return Vec::new();
    }
    let gives_up = |number: usize| {
        let prescription = discrete.v.prescription_of(number);
        prescription.is_some_and(|prescription| releases.get(prescription).copied().unwrap_or(false))
    };
    let own = forces.iter().enumerate().map(|(number, force)| if gives_up(number) { *force } else { 0.0 });
    let mut nodal = discrete.v.nodal(&own.collect::<Vec<f64>>());
    problem.in_phase(now.phase + 1).displacement_space().mask(&mut nodal);
    if nodal.iter().any(|force| *force != 0.0) { nodal } else { Vec::new() }
}
