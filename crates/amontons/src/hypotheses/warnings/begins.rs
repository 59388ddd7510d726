//! `phase-jump`, `start-inside`, `start-kept`: conditions that begin where the body is not.
//!
//! Data tell where a displacement is prescribed at t = 0, and where it is prescribed before and after the start of a
//! phase. Where a side was free, or a contact begins, the run tells.

use super::super::{Finding, FindingId};
use super::{gaps, warning};
use crate::problem::{Misfit, MisfitOf, PrescribedJump, Problem, StartState};
use crate::time::{Analysis, TimePhase};
use crate::units::Measure;

/// Warns of jumps of prescribed displacements that the data tell, where inertia acts.
pub(super) fn of_data(problem: &Problem) -> Vec<Finding> {
    if !problem.has_mass() {
        return Vec::new();
    }
    let mut all = at_start(problem);
    for (number, phase) in problem.timeline.phases().enumerate().skip(1) {
        if phase.analysis == Analysis::Dynamic {
            all.extend(between(problem, number));
        }
    }
    all
}

fn at_start(problem: &Problem) -> Vec<Finding> {
    let first = problem.timeline.instant(1);
    if first.analysis != Analysis::Dynamic || problem.initial.state != StartState::Given {
        return Vec::new();
    }
    let space = problem.displacement_space();
    let u = space.interpolate(&problem.mesh, &problem.initial.displacement, 0.0);
    let jumps = problem.jumps_from(&space, &u, [0.0, first.k], |_| ());
    let of = |jump: &PrescribedJump| {
        let distance = distance(problem, jump.size, jump.boundary);
        let message = format!(
            "at t = 0 {distance} from its initial displacement, at {}: {ONE_STEP}",
            problem.mesh.place(&jump.at)
        );
        let repair = "let it change from the initial displacement, as a ramp in t does, give `initial.displacement`, or let a quasistatic phase bring the side there first";
        warning(FindingId::PhaseJump, &place(problem, jump.boundary), [jump.size, jump.way], message, repair)
    };
    jumps.iter().map(of).collect()
}

/// What a jump is in a step.
const ONE_STEP: &str =
    "the first step brings it there, with a velocity that is the larger the shorter the step, and waves by it";

/// Jumps of values that are prescribed before and after the start of a phase.
fn between(problem: &Problem, number: usize) -> Vec<Finding> {
    let depends = |problem: &Problem| {
        let fields = problem.boundary.iter().flat_map(|condition| condition.prescriptions(&problem.mesh));
        fields.into_iter().any(|given| given.field.depends_on_time())
    };
    let phases = [number - 1, number];
    let [before, after] = phases.map(|phase| problem.in_phase(phase));
    if problem.has_same_conditions(phases) && !depends(&after) {
        return Vec::new();
    }
    let ends = || problem.timeline.ends_from(number - 1);
    let (Some(start), Some(end)) = (ends().next(), ends().nth(1)) else { return Vec::new() };
    let [held, space] = [&before, &after].map(|problem| problem.displacement_space());
    let mut u = vec![0.0; problem.mesh.points.len() * problem.mesh.dim];
    held.prescribe(start.t, &mut u);
    let jumps = after.jumps_from(&space, &u, [start.t, end.k], |jump| held.mask_free(jump));
    jumps
        .iter()
        .map(|jump| of_phase(&after, number, jump.boundary, [jump.size, jump.way], &problem.mesh.place(&jump.at)))
        .collect()
}

/// The warning of a jump at the start of a phase, with its size and the way of the condition in a step.
fn of_phase(problem: &Problem, phase: usize, boundary: usize, [size, way]: [f64; 2], x: &str) -> Finding {
    let message = format!(
        "{}, {} from where the side is then, at {x}: {ONE_STEP}",
        where_begins(problem, phase),
        distance(problem, size, boundary)
    );
    let repair = "bring the side there in a quasistatic phase before, or let the displacement begin where the side is and change from there, as a ramp in t does";
    warning(FindingId::PhaseJump, &place(problem, boundary), [size, way], message, repair)
}

fn distance(problem: &Problem, size: f64, boundary: usize) -> String {
    let on = problem.boundary.get(boundary).map_or("", |condition| condition.on.as_str());
    format!("the displacement that is prescribed on \"{on}\" is {} away", problem.units().write(size, Measure::Length))
}

fn place(problem: &Problem, boundary: usize) -> String {
    let along = problem.boundary.get(boundary).is_some_and(|condition| condition.normal_displacement.is_some());
    format!("boundary[{boundary}].{}", if along { "normal_displacement" } else { "displacement" })
}

/// The start of a phase in words: `at t = 1.0 s, where the phase "spin" begins`.
fn where_begins(problem: &Problem, phase: usize) -> String {
    let name = problem.timeline.phases().nth(phase).map_or("", |phase: &TimePhase| phase.name.as_str());
    let before = phase.checked_sub(1).and_then(|before| problem.timeline.phases().nth(before));
    let t = problem.units().write(before.map_or(0.0, |phase| phase.end), Measure::Time);
    format!("at t = {t}, where the phase \"{name}\" begins")
}

/// Warns of what began in a run with a phase where the body was not.
pub(super) fn of_run(problem: &Problem, misfits: &[Misfit]) -> Vec<Finding> {
    let of = |misfit: &Misfit| match misfit.of {
        MisfitOf::Displacement(boundary) => {
            let problem = problem.in_phase(misfit.phase);
            Some(of_phase(&problem, misfit.phase, boundary, [misfit.size, 0.0], &problem.mesh.place(&misfit.at)))
        }
        MisfitOf::Contact(contact) => inside(problem, misfit, contact),
    };
    misfits.iter().filter_map(of).collect()
}

/// A contact that began while its side was inside its foundation or its other side, by more than round-off and the
/// depth to which facets cut in.
fn inside(problem: &Problem, misfit: &Misfit, number: usize) -> Option<Finding> {
    let contact = problem.contacts_of_run().get(number)?;
    let limit = contact.sides().filter_map(|side| problem.mesh.facets.get(side));
    let limit = limit.map(|set| gaps::limit(&problem.mesh, set)).fold(0.0, f64::max);
    if misfit.size <= limit {
        return None;
    }
    let analysis = problem.timeline.phases().nth(misfit.phase)?.analysis;
    let stays = contact.normal.is_rigid() && analysis == Analysis::Dynamic && problem.has_impacts();
    let what = contact.pair.as_ref().map_or_else(
        || (if contact.obstacle.is_some() { "its obstacle" } else { "its foundation" }).to_owned(),
        |pair| format!("\"{}\"", pair.with),
    );
    let then = match (stays, contact.normal.is_rigid()) {
        (true, _) => "the ϑ-scheme holds velocities there, so that this distance stays",
        (_, true) => "the first step pushes it out",
        (_, false) => "it presses at once",
    };
    let message = format!(
        "{} and with it the contact, \"{}\" is inside {what} by up to {}, at {}: {then}",
        where_begins(problem, misfit.phase),
        contact.on,
        problem.units().write(misfit.size, Measure::Length),
        problem.mesh.place(&misfit.at)
    );
    let (id, repair) = if stays {
        let repair = "let a quasistatic phase begin the contact, whose steps close the distance, or let it begin where the side is outside; leave it if the distance is meant to stay";
        (FindingId::StartKept, repair)
    } else {
        let repair = "let the contact begin where the side is outside: move the foundation, or give the gap as an expression in t; leave it if the side is meant to be pressed";
        (FindingId::StartInside, repair)
    };
    let path = format!("{}.phases", problem.contact_path(number));
    Some(warning(id, &path, [misfit.size, limit], message, repair))
}
