//! Which problems have derivatives of their runs.

use super::error::GradientError;
use crate::contact::Contact;
use crate::discretization::Discretization;
use crate::problem::{Coupling, Fault, Physics, Problem, StartState};
use crate::time::Analysis;

/// Checks that the derivative of a run of the problem can be computed, and names the first feature for which it cannot.
pub(super) fn check(problem: &Problem, discrete: &Discretization) -> Result<(), GradientError> {
    let found = of_time(problem).or_else(|| of_body(problem, discrete));
    let of_contact = || {
        let mut sides = problem.contacts.iter().enumerate();
        sides.find_map(|(side, contact)| {
            let (key, found, expected) = of_contact(contact)?;
            Some((format!("{}.{key}", problem.contact_path(side)), found, expected))
        })
    };
    let Some((path, found, expected)) = found.or_else(of_contact) else { return Ok(()) };
    let hint = "remove it, or take differences of whole runs (`run --each`)";
    Err(GradientError::refused(Fault::new(path, format!("{found}, with derivatives of a run"), expected).hint(hint)))
}

/// Name of the scheme whose steps are differentiated.
const EULER: &str = "backward Euler";

type OutOfScope = (String, &'static str, &'static str);

fn of_time(problem: &Problem) -> Option<OutOfScope> {
    let told = |path: &str, found, expected| Some((path.to_owned(), found, expected));
    let timeline = &problem.timeline;
    match () {
        () if timeline.has_phases() => told("phase", "phases", "a run of one phase"),
        () if timeline.is_automatic() => told("time.steps", "chosen steps", "equal steps"),
        () if problem.scheme.name() != EULER => told("time.scheme", "another scheme", "\"euler\""),
        () if timeline.instant(1).analysis == Analysis::Steady => {
            told("time.inertia", "a steady step", "a run in time")
        }
        () if problem.initial.state == StartState::Equilibrium => {
            told("initial.state", "a start in equilibrium", "given initial data")
        }
        () => None,
    }
}

fn of_body(problem: &Problem, discrete: &Discretization) -> Option<OutOfScope> {
    let told = |path: &str, found, expected| Some((path.to_owned(), found, expected));
    match () {
        () if problem.physics == Physics::Heat => told("physics", "heat alone", "mechanics, with or without heat"),
        () if problem.physics == Physics::Coupled && problem.coupling != Coupling::Staggered => {
            told("solver.coupling", "another coupling", "\"staggered\"")
        }
        () if !discrete.is_linear() || !discrete.conducts_linearly() => {
            told("material", "a nonlinear law, or one that depends on temperature", "linear laws with constant data")
        }
        () if !discrete.massless().is_empty() => told("time.mass", "\"redistributed\"", "\"consistent\""),
        () if discrete.branches.iter().any(|branch| !branch.has_field()) => {
            told("material.prony", "relaxation times that vary in space", "uniform ones")
        }
        () if !discrete.v.links.is_empty() => told("cyclic", "a sector of a cyclic body", "a whole body"),
        () if !discrete.v.rigid.is_empty() => told("rigid", "rigid parts", "bodies that deform"),
        () if !discrete.v.frames.is_empty() => {
            told("boundary", "displacements along normals or in other directions", "displacements along axes")
        }
        () => None,
    }
}

fn of_contact(contact: &Contact) -> Option<(&'static str, &'static str, &'static str)> {
    let pair = contact.pair.as_ref();
    match () {
        () if pair.is_some_and(crate::contact::Pair::is_updated) => {
            Some(("geometry", "an updated pair", "\"reference\""))
        }
        () if pair.is_some() && contact.wear.is_some() => Some(("wear", "wear of a pair", "wear on a foundation")),
        () if contact.obstacle.as_ref().is_some_and(|obstacle| obstacle.updated) => {
            Some(("obstacle.updated", "an obstacle that is followed", "false"))
        }
        () if contact.obstacle.as_ref().is_some_and(|obstacle| obstacle.load.is_some()) => {
            Some(("obstacle.load", "an obstacle under a load", "a given motion"))
        }
        () if contact.preload.is_some() => Some(("preload", "a preload", "none")),
        () if contact.fluid.is_some() => Some(("fluid", "a fluid", "none")),
        () if contact.foundation_heat.is_some() => {
            Some(("foundation_heat", "a foundation with a heat capacity", "a given temperature"))
        }
        () => None,
    }
}
