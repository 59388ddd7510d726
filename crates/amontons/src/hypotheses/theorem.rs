//! (2.23): as it is printed, and what the proof of Theorem 3.1 needs instead (`book/src/theory.md`).

use super::{Constants, Finding, Status};
use crate::problem::Problem;

/// `2.23-printed`: m_a < (L_ν + L_τ) s₁², the second L_ν of the print read as L_τ, and m_d > M_kc s₂².
pub(super) fn printed(problem: &Problem, constants: &Constants) -> Finding {
    let id = "2.23-printed";
    if problem.contacts.is_empty() {
        return Finding::new(id, Status::NotCovered, "there is no contact, and no constant of a trace to compare with", "contact");
    }
    let (Some(nu), Some(tau), Some(kc)) = (constants.lipschitz_nu, constants.lipschitz_tau, constants.bound_kc) else {
        return Finding::new(id, Status::NotCovered, "the laws of contact have no Lipschitz constants L_ν, L_τ: see (H8)", "contact")
            .repair("normal compliance with a stiffness");
    };
    let Some(s1) = constants.s1 else {
        let message = "there is no s₁ of (2.14): no displacement is prescribed that holds the body";
        return Finding::new(id, Status::NotCovered, message, "boundary").repair("a side with `displacement`");
    };
    let Some(s2) = constants.s2.or((kc == 0.0).then_some(0.0)) else {
        let message = "there is no s₂ of (2.15): no temperature is prescribed that holds the heat equation";
        return Finding::new(id, Status::NotCovered, message, "boundary").repair("a side with `temperature`");
    };
    let (force, heat) = ((nu + tau) * s1 * s1, kc * s2 * s2);
    let (first, second) = (constants.m_a < force, constants.m_d > heat || !problem.physics.has_heat());
    let relation = |holds: bool| if holds { "holds" } else { "does not hold" };
    let message = format!(
        "m_a < (L_ν + L_τ) s₁² {}: {:.6e} and {force:.6e}; m_d > M_kc s₂² {}: {:.6e} and {heat:.6e}. The first asks for contact that is stiff beside the body and serves no estimate; see 2.23-needed",
        relation(first),
        constants.m_a,
        relation(second),
        constants.m_d
    );
    let numbers = if first && !second { (constants.m_d, heat) } else { (constants.m_a, force) };
    let place = if first && !second { "contact.heat" } else { "material.elasticity" };
    Finding::new(id, Status::of(first && second), message, place).numbers(Some(numbers.0), Some(numbers.1)).repair(if first {
        "a smaller conductance, or none: the proof does not need this inequality"
    } else {
        "none: the proof does not need this inequality"
    })
}

/// `2.23-needed`: no inequality between constants, but (H1), (H2) ii, (H3), (H7), (H8), and φ_L nondecreasing.
///
/// With κ = M_a + s₁²(L_ν + L_τ), two solutions of (3.6) differ by ‖u(t)‖² ≤ (2t/m_b²) exp(κ²t²/m_b²) ∫₀ᵗ ‖y₁ − y₂‖².
pub(super) fn needed(problem: &Problem, constants: &Constants, findings: &[Finding]) -> Finding {
    let id = "2.23-needed";
    let missing: Vec<&str> = findings.iter().filter(|f| ["H1", "H2", "H3", "H7", "H8"].contains(&f.id.as_str()) && f.fails()).map(|f| f.id.as_str()).collect();
    let numbers = |finding: Finding| finding.numbers(Some(constants.m_b), Some(0.0));
    if !missing.is_empty() {
        let why = |id: &str| match id {
            "H1" => "m_b > 0 absorbs elasticity, compliance and friction",
            "H2" => "elasticity must be Lipschitz",
            "H3" => "m_d > 0 absorbs the heat through Γ_C",
            "H7" => "k_c must be bounded and Lipschitz",
            _ => "p_ν and p_τ must be Lipschitz",
        };
        let list = missing.iter().map(|id| format!("({id}): {}", why(id))).collect::<Vec<_>>().join("; ");
        let message = format!("the proof needs no inequality between constants, but it needs what fails here: {list}");
        return numbers(Finding::new(id, Status::Fails, message, "material.viscosity")).repair("what repairs the hypotheses named");
    }
    if findings.iter().any(|f| f.id == "H8" && !f.holds()) {
        let message = "a friction bound that depends on the slip speed is not one of (2.9), and the proof says nothing about it";
        return numbers(Finding::new(id, Status::NotCovered, message, "contact.friction"));
    }
    if problem.materials.iter().any(|m| m.prony.is_some()) {
        let message = "(2.1) has no stress that relaxes besides 𝓔 and 𝓥, and the proof says nothing about it";
        return numbers(Finding::new(id, Status::NotCovered, message, "material"));
    }
    let cut = problem.contacts.iter().any(|c| c.heat.conductance_bound() > 0.0 && c.heat.truncation().is_none());
    let l = if cut { "; L of φ_L only bounds the heat that a change of the gap makes, and without it uniqueness takes a trace in L⁴" } else { "" };
    let message = format!(
        "no inequality between constants is needed: m_b > 0 with Young's and Gronwall's inequalities absorbs the terms of a, p_ν and p_τ whatever their size, and χ is monotone in θ since k_c ≥ 0 and φ_L is nondecreasing{l}"
    );
    numbers(Finding::new(id, Status::Holds, message, "material.viscosity"))
}
