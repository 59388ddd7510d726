//! Which problems have derivatives of their runs.

use super::error::GradientError;
use super::instance::PhasedInstance;
use crate::contact::{Contact, GraphKind};
use crate::problem::{Fault, Problem};
use crate::time::{Analysis, FrictionRule, Start};

/// Checks that the derivative of a run of the problem can be computed, and names the first feature for which it cannot.
pub(super) fn check(phased: &PhasedInstance) -> Result<(), GradientError> {
    let problem = &phased.first.problem;
    let found = of_phases(phased).or_else(|| of_scheme(problem));
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

type OutOfScope = (String, &'static str, &'static str);

/// A bilateral contact that begins with a phase keeps the gap that it finds.
fn of_phases(phased: &PhasedInstance) -> Option<OutOfScope> {
    let begins = |contact: &Contact| contact.normal.graph() == GraphKind::Bilateral && !contact.acts();
    let found = phased.all().any(|instance| instance.problem.contacts.iter().any(begins));
    found
        .then(|| ("phase".to_owned(), "a bilateral contact that acts in some phases", "one that acts in the whole run"))
}

/// What a scheme in time has that is not differentiated. The ϑ-scheme on rigid foundations depends on the velocities
/// before an impact, and has a kink at the bound of an impact.
fn of_scheme(problem: &Problem) -> Option<OutOfScope> {
    let told = |path: &str, found, expected| Some((path.to_owned(), found, expected));
    let rule = problem.rule(Analysis::Dynamic, 1.0);
    if rule.start == Start::Admissible {
        return told("time.scheme", "steps from admissible velocities", "\"euler\", \"bdf2\" or \"theta\"");
    }
    if rule.balances_contact_at_end() {
        return told("time.mass", "\"redistributed\", with equations within a step", "\"consistent\"");
    }
    let rule = rule.contact?;
    let has_graph = |contact: &Contact| contact.normal.graph() != GraphKind::Function;
    match () {
        () if rule.friction != FrictionRule::Mean => told("time.friction", "\"end\"", "\"mean\""),
        () if problem.contacts.iter().any(has_graph) => {
            told("time.scheme", "the ϑ-scheme with a rigid foundation", "\"euler\" or \"bdf2\", or a layer")
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
        () if contact.obstacle.as_ref().is_some_and(|obstacle| obstacle.updated) => {
            Some(("obstacle.updated", "an obstacle that is followed", "false"))
        }
        () => None,
    }
}
