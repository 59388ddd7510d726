//! Pairs of deformable bodies, to which the theory of a given foundation does not apply.

use super::{Certificate, Constants, Finding, FindingId, FindingStatus, judged};
use crate::contact::mortar::Mortar;
use crate::contact::{Contact, Supports};
use crate::problem::{Problem, with_supports};

/// Number of the first contact that is a pair.
pub(super) fn first(problem: &Problem) -> Option<usize> {
    problem.contacts.iter().position(|contact| contact.pair.is_some())
}

/// True if the theory of one body on a given foundation does not apply: with pairs, rigid parts, or obstacles under a
/// load.
pub(super) fn are_beyond(problem: &Problem) -> bool {
    first(problem).is_some() || !problem.rigid.is_empty() || loaded(problem).is_some()
}

/// Number of the first contact whose obstacle has a load.
fn loaded(problem: &Problem) -> Option<usize> {
    problem.contacts.iter().position(|contact| contact.obstacle.as_ref().is_some_and(|of| of.load.is_some()))
}

/// The certificate of a problem with pairs, rigid parts or obstacles under a load: the usual findings on laws and data,
/// and "not covered" for all that involves the traces of one body on a given foundation.
pub(super) fn certificate(problem: &Problem) -> Certificate {
    let constants = Constants::of_laws(problem);
    let mut findings = judged(problem, &constants);
    if problem.physics.has_mechanics() {
        let at = findings.iter().position(|f| f.id == FindingId::Needed).unwrap_or(findings.len());
        findings.insert(at, not_covered(problem, FindingId::Printed, "the traces s₁, s₂ are those of one body"));
        let message = "the condition for one solution of a step is proved for one body on a rigid foundation";
        findings.push(not_covered(problem, FindingId::StepUnique, message));
    }
    Certificate { findings, constants }
}

/// Fraction of a side that counts as all of it.
const WHOLE: f64 = 1.0 - 1e-6;

/// `pairs`: the side that bears the contact points, and the fraction of it that the other side faces.
pub(super) fn faced(problem: &Problem) -> Option<Finding> {
    let (mesh, space) = (&*problem.mesh, problem.displacement_space());
    let (mut told, mut is_partly) = (Vec::new(), false);
    for contact in problem.contacts.iter().filter(|contact| contact.pair.is_some()) {
        let of = |supports: Supports| contact.pairing(mesh, &mesh.points, supports).map(|sides| Mortar::new(&sides));
        let (Some(mortar), Some(facing)) = (with_supports(&space, None, of), contact.facing()) else { continue };
        let (bearing, share) = (contact.bearing(), mortar.covered / mortar.measure);
        let lever = mortar.rows.iter().map(|row| row.lever).fold(0.0, f64::max);
        is_partly |= share < WHOLE;
        let points = mortar.rows.iter().filter(|row| row.weight > 0.0).count();
        told.push(format!(
            "\"{bearing}\" bears {points} contact points, and \"{facing}\" faces {:.4} % of it; pressures miss the balance of moments by levers of up to {lever:.1e} m",
            100.0 * share
        ));
    }
    let first = first(problem)?;
    let status = if is_partly { FindingStatus::NotCovered } else { FindingStatus::Holds };
    Some(Finding::new(FindingId::Pairs, status, told.join("; "), &problem.contact_path(first)))
}

/// A finding without a verdict because of a pair, a rigid part or an obstacle under a load.
pub(super) fn not_covered(problem: &Problem, id: FindingId, message: &str) -> Finding {
    let of_load = loaded(problem).filter(|_| first(problem).is_none() && problem.rigid.is_empty());
    if let Some(number) = of_load {
        let message = format!("a load moves the obstacle, and the theory is that of a given place: {message}");
        let place = format!("{}.obstacle.load", problem.contact_path(number));
        return Finding::new(id, FindingStatus::NotCovered, message, &place);
    }
    let Some(number) = first(problem) else {
        let parts: Vec<String> = problem.rigid.iter().map(|part| format!("\"{}\"", part.on)).collect();
        let message = format!("{} moves as a rigid body: {message} that deforms everywhere", parts.join(" and "));
        return Finding::new(id, FindingStatus::NotCovered, message, "rigid[0]");
    };
    let sides: Vec<String> = problem
        .contacts
        .iter()
        .skip(number)
        .take(1)
        .flat_map(Contact::sides)
        .map(|side| format!("\"{side}\""))
        .collect();
    let message = format!("{} are sides of deformable bodies: {message}", sides.join(" and "));
    Finding::new(id, FindingStatus::NotCovered, message, &format!("{}.with", problem.contact_path(number)))
}
