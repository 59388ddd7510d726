//! What a change of conditions does to a state: supports and contacts take their energy with them and bring it,
//! bilateral contacts hold their sides where they begin, and supports may give up their force in the course of the next
//! phase.

use std::sync::Arc;

use crate::contact::{Contact, ContactBoundary, GraphKind};
use crate::discretization::Discretization;
use crate::equation::acting::{boundary_at, contacts_at};
use crate::equation::foundation::{at_rest, frames, opened};
use crate::forms;
use crate::linalg::dot;
use crate::problem::{Misfit, MisfitOf, PrescribedJump, Problem};
use crate::state::{State, StepReport};
use crate::tensor::{self, Point};
use crate::time::{Instant, Interval};

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

/// What contacts that end and begin do to a state: the energy of their layers is work of the supports, those that hold
/// their sides in tension, too, hold them where they are, and points that begin at rest stick as at t = 0. `before` is
/// the problem with the conditions of the phase before, `now` the first step of the next one.
pub(super) fn met(before: &Problem, problem: &Problem, discrete: &Discretization, now: &Instant, state: &mut State) {
    let acts = |of: &Problem| of.contacts.iter().map(Contact::acts).collect::<Vec<bool>>();
    let (ended, begun) = (acts(before), acts(problem));
    if ended == begun {
        return;
    }
    let at = |all: &[bool], contact: usize| all.get(contact).copied().unwrap_or(false);
    let (boundary, penetrations) = reached(problem, discrete, state);
    let laws = [before, problem].map(|problem| contacts_at(problem, state.t));
    let rests = at_rest(problem, &boundary, [&state.u, &state.w], [state.t, now.k]);
    let mut change = 0.0;
    for (i, (point, r)) in boundary.points.iter().zip(&penetrations).enumerate() {
        let changes = at(&begun, point.contact) != at(&ended, point.contact);
        if !changes || point.weight <= 0.0 {
            continue;
        }
        let [old, new] = laws.each_ref().map(|laws| &laws[point.contact].normal);
        change += point.weight * (new.potential(&point.x, *r) - old.potential(&point.x, *r));
        if !at(&begun, point.contact) {
            continue;
        }
        if let Some(sticks) = state.multipliers.sticks.get_mut(i) {
            *sticks = rests.get(i).copied().unwrap_or(false);
        }
        if new.graph() == GraphKind::Bilateral {
            state.surface.offset.resize(boundary.points.len(), 0.0);
            state.surface.offset[i] += r;
        }
    }
    state.ledger.contact_energy += change;
    state.ledger.load_work += change;
    state.ledger.turned_over += change.abs();
}

/// Γ_C in a state, and r = u_ν − g of each contact point, m.
fn reached(problem: &Problem, discrete: &Discretization, state: &State) -> (Arc<ContactBoundary>, Vec<f64>) {
    let boundary = boundary_at(discrete, problem, state);
    let surface = &state.surface;
    let opened = opened(discrete, &problem.contacts, &boundary, surface);
    let frames = frames(problem, &boundary, &state.u, (&opened, [&surface.advance; 2]), Interval::at(state.t));
    let points = boundary.points.iter().zip(&frames);
    let moved = |point| boundary.vector_at(point, discrete.mesh.dim, &state.u);
    let r = points.map(|(point, frame)| tensor::dot(&moved(point), &frame.normal) - frame.gap).collect();
    (boundary, r)
}

/// What begins with a phase, whose first step is `now`, where the body is not: prescribed displacements if inertia acts
/// and the phase before leaves their directions free, and contacts that press, less the interference that their gap
/// gives.
pub(super) fn misfits(
    before: &Problem,
    problem: &Problem,
    discrete: &Discretization,
    now: &Instant,
    state: &State,
) -> Vec<Misfit> {
    let mut all = Vec::new();
    if now.analysis.has_inertia() && problem.has_mass() {
        let held = before.displacement_space();
        let jumps = problem.jumps_from(&discrete.v, &state.u, [state.t, now.k], |jump| held.mask(jump));
        let misfit = |jump: PrescribedJump| Misfit {
            phase: now.phase,
            of: MisfitOf::Displacement(jump.boundary),
            size: jump.size,
            at: jump.at,
        };
        all.extend(jumps.into_iter().map(misfit));
    }
    let acts = |of: &Problem, contact: usize| of.contacts.get(contact).is_some_and(Contact::acts);
    let begins = |contact: &usize| acts(problem, *contact) && !acts(before, *contact);
    let begun: Vec<usize> = (0..problem.contacts.len()).filter(begins).collect();
    if begun.is_empty() || !problem.physics.has_mechanics() {
        return all;
    }
    let (boundary, penetrations) = reached(problem, discrete, state);
    for (number, contact) in begun.into_iter().filter_map(|number| Some((number, problem.contacts.get(number)?))) {
        if contact.normal.graph() == GraphKind::Bilateral {
            continue;
        }
        let points = boundary.points.iter().zip(&penetrations);
        let own = points.filter(|(point, _)| point.contact == number && point.weight > 0.0);
        let beyond = |x: &Point, r: f64| r - (0.0 - contact.gap.value(x, state.t)).max(0.0);
        let deepest = own.map(|(point, r)| (point.x, beyond(&point.x, *r))).max_by(|a, b| a.1.total_cmp(&b.1));
        let of = MisfitOf::Contact(number);
        all.extend(deepest.filter(|(_, r)| *r > 0.0).map(|(at, size)| Misfit { phase: now.phase, of, size, at }));
    }
    all
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
