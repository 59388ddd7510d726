//! (2.23) as printed, and the condition that replaces it in the proof of Theorem 3.1 (`book/src/theory.md`).

use super::data::not_in_v;
use super::laws::{Test, beyond, tested};
use super::tensors::not_lipschitz;
use super::{Constants, Finding, FindingId, FindingStatus};
use crate::contact::GraphKind;
use crate::field::Coefficient;
use crate::material::Material;
use crate::mesh::defects::components;
use crate::problem::{Problem, first_warm};
use crate::space::Space;

/// `2.23-printed`: m_a < (L_ν + L_τ) s₁², with the second L_ν of the print read as L_τ, and m_d > M_kc s₂².
pub(super) fn printed(problem: &Problem, constants: &Constants) -> Finding {
    let id = FindingId::Printed;
    if problem.contacts.is_empty() {
        return Finding::new(
            id,
            FindingStatus::NotCovered,
            "there is no contact, and no constant of a trace to compare with",
            "contact",
        );
    }
    let (Some(nu), Some(tau)) = (constants.lipschitz_nu, constants.lipschitz_tau) else {
        return Finding::new(
            id,
            FindingStatus::NotCovered,
            "the contact laws have no Lipschitz constants L_ν, L_τ: see (H8)",
            "contact",
        )
        .repair("normal compliance with a stiffness");
    };
    let Some(kc) = constants.bound_kc.filter(|kc| kc.is_finite()) else {
        return Finding::new(
            id,
            FindingStatus::NotCovered,
            "the heat through the contact has no bound M_kc: see (H7)",
            "contact.heat",
        );
    };
    let Some(s1) = constants.s1 else {
        let message = "there is no s₁ of (2.14): no displacement is prescribed that holds the body";
        return Finding::new(id, FindingStatus::NotCovered, message, "boundary").repair("a side with `displacement`");
    };
    let Some(s2) = constants.s2.or((kc == 0.0).then_some(0.0)) else {
        let message = "there is no s₂ of (2.15): no temperature is prescribed that holds the heat equation";
        return Finding::new(id, FindingStatus::NotCovered, message, "boundary").repair("a side with `temperature`");
    };
    let (force, heat) = ((nu + tau) * s1 * s1, kc * s2 * s2);
    let (first, second) = (constants.m_a < force, constants.m_d > heat || !problem.physics.has_heat());
    let relation = |holds: bool| if holds { "holds" } else { "does not hold" };
    let message = format!(
        "m_a < (L_ν + L_τ) s₁² {}: {:.6e} and {force:.6e}; m_d > M_kc s₂² {}: {:.6e} and {heat:.6e}. The first requires contact that is stiff compared with the body and is not used in any estimate; see 2.23-needed",
        relation(first),
        constants.m_a,
        relation(second),
        constants.m_d
    );
    let numbers = if first && !second { (constants.m_d, heat) } else { (constants.m_a, force) };
    let place = if first && !second { "contact.heat" } else { "material.elasticity" };
    Finding::new(id, FindingStatus::of(first && second), message, place)
        .numbers(Some(numbers.0), Some(numbers.1))
        .repair(if first {
            "a smaller conductance, or none: the proof does not need this inequality"
        } else {
            "none: the proof does not need this inequality"
        })
}

/// `2.23-needed`: the hypotheses of Theorem 1 of the book, without an inequality between constants.
///
/// With κ = M_a + s₁²(L_ν + L_τ), two solutions of (3.6) differ by ‖u(t)‖² ≤ (2t/m_b²) exp(κ²t²/m_b²) ∫₀ᵗ ‖y₁ − y₂‖².
pub(super) fn needed(problem: &Problem, constants: &Constants, findings: &[Finding]) -> Finding {
    let id = FindingId::Needed;
    let numbers = |finding: Finding| finding.numbers(Some(constants.m_b), Some(0.0));
    if let Some((what, place)) = outside(problem) {
        return numbers(Finding::new(
            id,
            FindingStatus::NotCovered,
            format!("the theorem does not cover these data: {what}"),
            &place,
        ));
    }
    let missing = missing(problem, findings);
    if let Some((_, place)) = missing.first() {
        let list = missing.iter().map(|(what, _)| what.as_str()).collect::<Vec<_>>().join("; ");
        let message = format!(
            "the proof needs no inequality between constants, but it needs a hypothesis that fails here: {list}"
        );
        return numbers(Finding::new(id, FindingStatus::Fails, message, place)).repair("repair the hypotheses named");
    }
    let message = "no inequality between constants is needed: Problem 2.2 has one solution. m_b > 0 with Young's and Gronwall's inequalities absorbs the terms of a, p_ν and p_τ whatever their size, and the flux through Γ_C is monotone in θ";
    numbers(Finding::new(id, FindingStatus::Holds, message, "material.viscosity"))
}

/// Hypotheses of Theorem 1 that these data violate, with their places.
fn missing(problem: &Problem, findings: &[Finding]) -> Vec<(String, &'static str)> {
    let fails = |id: FindingId| findings.iter().any(|f| f.id == id && f.fails());
    let mut missing = Vec::new();
    if fails(FindingId::H1) {
        missing.push(("(H1): m_b > 0 absorbs elasticity, compliance and friction".to_owned(), "material.viscosity"));
    }
    if let Some(why) = problem.materials.iter().find_map(|m| not_lipschitz(problem, &m.elasticity, "M_a")) {
        missing.push((format!("(H2): elasticity must be Lipschitz, {why}"), "material.elasticity"));
    }
    if fails(FindingId::H3) {
        missing.push(("(H3): m_d > 0 absorbs the heat through Γ_C".to_owned(), "material.conductivity"));
    }
    if fails(FindingId::H4) || fails(FindingId::H5) {
        missing.push(("(H4), (H5): the coupling must be bounded".to_owned(), "material"));
    }
    if let Some(why) = not_in_v(problem) {
        missing.push((format!("(H6): {why}"), "initial"));
    }
    missing
}

/// A part of the model that Theorem 1 of the book does not cover, and its place.
fn outside(problem: &Problem) -> Option<(&'static str, String)> {
    if let Some(side) = super::pairs::first(problem) {
        let what = "contact of two deformable bodies, while Problem 2.2 has one body on a foundation";
        return Some((what, format!("{}.with", problem.contact_path(side))));
    }
    for (side, test) in tested(problem).enumerate() {
        if let Some((what, place)) = outside_of_contact(&test) {
            return Some((what, place.replacen("contact", &problem.contact_path(side), 1)));
        }
    }
    if let Some(number) = problem.timeline.first_steady() {
        let place =
            if problem.timeline.has_phases() { format!("phase[{number}].analysis") } else { "time.analysis".into() };
        return Some(("a steady state, while Problem 2.2 is one in time", place));
    }
    if problem.materials.iter().any(|m| m.viscosity.constants().lipschitz == 0.0) {
        return Some(("a material without viscosity, while (H1) asks for m_b > 0", "material.viscosity".to_owned()));
    }
    if let Some((key, _)) = problem.materials.iter().find_map(first_warm) {
        return Some(("a coefficient that depends on the temperature", format!("material.{key}")));
    }
    let zeros = |of: fn(&Material) -> &Coefficient<f64>| {
        let all: Vec<bool> = problem.values_of(of).iter().map(|sample| sample.value == 0.0).collect();
        (all.iter().any(|zero| *zero), all.iter().all(|zero| *zero))
    };
    let (mut density, capacity) = (zeros(|m| &m.density), zeros(|m| &m.heat_capacity));
    if problem.timeline.lacks_inertia() {
        density = (true, true);
    }
    let place = |key: &str| format!("material.{key}");
    match (density, capacity) {
        ((true, false), _) => Some(("a density that is zero in a part of the body only", place("density"))),
        (_, (true, false)) => Some(("a heat capacity that is zero in a part of the body only", place("heat_capacity"))),
        ((true, _), _) if !is_held(problem, &problem.displacement_space()) => Some((
            "without inertia every part of the body must be held by displacements in all directions",
            place("density"),
        )),
        (_, (true, _)) if !is_held(problem, &problem.temperature_space()) => Some((
            "without a heat capacity every part of the body must have a side with a prescribed temperature",
            place("heat_capacity"),
        )),
        _ => None,
    }
}

/// A part of one contact that Theorem 1 does not cover, and its place.
fn outside_of_contact(test: &Test) -> Option<(&'static str, &'static str)> {
    let contact = test.contact;
    let nu = contact.normal.lipschitz().filter(|l| l.is_finite() && contact.normal.graph() == GraphKind::Function);
    if nu.is_none() {
        return Some(("the pressure is no Lipschitz function of the penetration", "contact.normal"));
    }
    if let Some(found) = beyond(test) {
        return Some(found);
    }
    if contact.friction.lipschitz(nu).is_none_or(|l| !l.is_finite()) && !test.friction_is_given() {
        return Some(("the friction bound is no Lipschitz function of the penetration", "contact.friction"));
    }
    if contact.obstacle.as_ref().is_some_and(|obstacle| obstacle.updated) {
        return Some((
            "the normal of an obstacle with geometry = \"updated\" depends on the displacement",
            "contact.obstacle",
        ));
    }
    if test.friction_makes_heat() {
        return Some((
            "friction heat is a product of pressure and slip, for which no estimate is known",
            "contact.heat",
        ));
    }
    if contact.foundation_heat.is_some() && !contact.friction.is_frictionless() {
        return Some((
            "friction heats the foundation by a product of pressure and slip, for which no estimate is known",
            "contact.foundation",
        ));
    }
    if contact.heat.conductance_bound() > 0.0 && contact.heat.at_time(0.0).is_some() {
        return Some(("the conductance depends on the time", "contact.heat"));
    }
    if contact.heat.conductance_bound() > 0.0 && test.heat_sees_pressure() {
        return Some(("the conductance depends on the pressure", "contact.heat"));
    }
    if contact.heat.conductance_lipschitz().is_none_or(|l| !l.is_finite()) || !test.keeps_its_constants() {
        return Some(("the laws have no Lipschitz constants, or violate those that they declare", "contact"));
    }
    None
}

/// True if every part of the body has a facet on which all values of a space are prescribed.
fn is_held(problem: &Problem, space: &Space) -> bool {
    let fixed: Vec<bool> = (0..problem.mesh.points.len() as u32).map(|node| space.is_held(node)).collect();
    let held = |nodes: &[u32]| nodes.iter().all(|&node| fixed.get(node as usize) == Some(&true));
    let mut anchored = vec![false; fixed.len()];
    for set in problem.mesh.facets.values() {
        for block in &set.blocks {
            for facet in block.nodes.chunks_exact(block.element.nodes.len()).filter(|facet| held(facet)) {
                for &node in facet {
                    anchored[node as usize] = true;
                }
            }
        }
    }
    components(&problem.mesh).iter().all(|part| part.nodes.iter().any(|&node| anchored[node as usize]))
}
