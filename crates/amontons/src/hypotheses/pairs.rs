//! Pairs of deformable bodies: what the theory says of a foundation it does not say of them.

use super::{Certificate, Constants, Finding, FindingId, FindingStatus, judged};
use crate::contact::Contact;
use crate::problem::Problem;

/// The first pair of a problem, by the number of its contact.
pub(super) fn first(problem: &Problem) -> Option<usize> {
    problem.contacts.iter().position(|contact| contact.pair.is_some())
}

/// The certificate of a problem with pairs: findings on the laws and the data as ever, and no statement where the
/// traces of one body on a rigid foundation enter.
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

/// A finding on which the theory makes no statement because of a pair.
pub(super) fn not_covered(problem: &Problem, id: FindingId, message: &str) -> Finding {
    let number = first(problem).unwrap_or_default();
    let sides: Vec<String> =
        problem.contacts.iter().skip(number).take(1).flat_map(Contact::sides).map(|side| format!("\"{side}\"")).collect();
    let message = format!("{} are sides of deformable bodies: {message}", sides.join(" and "));
    Finding::new(id, FindingStatus::NotCovered, message, &format!("{}.with", problem.contact_path(number)))
}
