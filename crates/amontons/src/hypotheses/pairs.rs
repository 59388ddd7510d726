//! Pairs of deformable bodies: what the theory says of a foundation it does not say of them.

use super::{Certificate, Constants, Finding, FindingId, FindingStatus, judged};
use crate::contact::{Contact, Supports};
use crate::contact::mortar::{Mortar, mean_facet};
use crate::problem::{Problem, with_supports};
use crate::units::Measure;

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

/// Depth of an overlap, relative to a facet, that is not the round-off of a mesh file.
const DEEP: f64 = 1e-6;
/// Share of a side that is as good as all of it.
const WHOLE: f64 = 1.0 - 1e-6;

/// `pairs`: which side bears the contact points, how much of it the other side faces, and where the sides overlap at
/// rest.
pub(super) fn faced(problem: &Problem) -> Option<Finding> {
    let (mesh, space) = (&*problem.mesh, problem.displacement_space());
    let (mut told, mut is_partly, mut deepest) = (Vec::new(), false, 0.0);
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
        let is_geometric = contact.pair.as_ref().is_some_and(|pair| !pair.gap_is_given && !pair.closes);
        let facet = mesh.facets.get(bearing).map_or(0.0, |set| mean_facet(mesh, set));
        let size = if mesh.dim == 3 { facet.sqrt() } else { facet };
        let overlap = mortar.rows.iter().filter(|_| is_geometric).min_by(|a, b| a.gap.total_cmp(&b.gap));
        if let Some(row) = overlap.filter(|row| row.gap < -DEEP * size) {
            deepest = row.gap.min(deepest);
            let place = mesh.place(&mesh.points[row.node as usize]);
            told.push(format!(
                "they overlap at rest by up to {}, at {place}: the first step pushes them apart",
                problem.units().write(-row.gap, Measure::Length)
            ));
        }
    }
    let first = first(problem)?;
    let status = if is_partly || deepest < 0.0 { FindingStatus::NotCovered } else { FindingStatus::Holds };
    let finding = Finding::new(FindingId::Pairs, status, told.join("; "), &problem.contact_path(first));
    Some(if deepest < 0.0 {
        finding
            .repair("take `close = true` to let them touch without stress, or `gap` for an interference that is meant")
    } else {
        finding
    })
}

/// A finding on which the theory makes no statement because of a pair.
pub(super) fn not_covered(problem: &Problem, id: FindingId, message: &str) -> Finding {
    let number = first(problem).unwrap_or_default();
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
