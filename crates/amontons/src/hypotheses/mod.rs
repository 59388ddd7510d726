//! The hypotheses of the theory, evaluated numerically. Findings are reported and never stop a run.
//!
//! | id | statement | evaluated by |
//! |---|---|---|
//! | `H1` … `H8` | the hypotheses of Theorem 3.1 | closed forms; declared constants of nonlinear laws are tested on samples |
//! | `phi-L` | the cut-off of φ_L in (2.10) | the law |
//! | `2.23-printed` | both inequalities of (2.23) as they are printed | eigenvalues on the mesh |
//! | `2.23-needed` | whether Theorem 1 of the book, which needs no such inequality, applies | closed forms, samples of the laws |
//! | `step-unique`, `time-step` | one solution of a step of (4.1), and the number of steps that ensures it | factors of K_u, an eigenvalue on Γ_C |
//! | `contact-heat` | the conductance depends on the penetration although the foundation is rigid; absent otherwise | the laws |
//! | `softening` | a contact law softens, so that a step may have several solutions; absent otherwise | the laws |
//! | `mesh-quality` | the shape of the cells | their geometry |
//! | `contact-possible` | whether contact can occur at all | an energy estimate |
//! | `pairs` | which part of the nonmortar side of each pair is faced; absent without pairs | the rows of the pair |
//! | `energy`, `heat` | the audit of a run | the run |
//! | others of kind `warning` | traps in data and runs: [`warnings`]; absent if nothing is wrong | data, the run |
//!
//! The proofs are in `book/src/theory.md`. [`findings`] takes negligible time, [`certificate`] a few factorizations,
//! and [`advice`] as many as its search needs.

mod data;
mod domain;
mod finding;
mod laws;
mod pairs;
mod probe;
mod quality;
mod reach;
mod sample;
mod softening;
mod step;
mod tensors;
mod theorem;
pub mod warnings;

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::contact::Contact;
use crate::discretization::Discretization;
use crate::linalg::{SolveError, join};
use crate::problem::{Physics, Problem};
use crate::time::During;

pub use domain::{Constant, DomainConstants, domain_constants};
pub use finding::{Finding, FindingId, FindingStatus, Kind, UnknownFinding};
pub(crate) use sample::Samples;
pub use step::monotonicity_loss;

/// The constants of the hypotheses, under the names of the paper; `None` if a law or the domain has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Constants {
    /// m_a of (H2) in Pa.
    pub m_a: f64,
    /// M_a of (H2) in Pa.
    #[serde(rename = "M_a")]
    pub lipschitz_a: f64,
    /// m_b of (H1) in Pa s.
    pub m_b: f64,
    /// M_b of (H1) in Pa s.
    #[serde(rename = "M_b")]
    pub lipschitz_b: f64,
    /// m_d of (H3) in W/(m K).
    pub m_d: f64,
    /// M_d of (H3) in W/(m K).
    #[serde(rename = "M_d")]
    pub bound_d: f64,
    /// M_m of (H4) in Pa m/K: |m(θ, v)| ≤ M_m ‖∇θ‖ ‖ε(v)‖; needs c_f.
    #[serde(rename = "M_m")]
    pub bound_m: Option<f64>,
    /// M_e of (H5): |e(v, η)| ≤ M_e ‖∇η‖ ‖ε(v)‖; needs c_f.
    #[serde(rename = "M_e")]
    pub bound_e: Option<f64>,
    /// L_ν of (H8) in Pa/m.
    #[serde(rename = "L_nu")]
    pub lipschitz_nu: Option<f64>,
    /// L_τ of (H8) in Pa/m.
    #[serde(rename = "L_tau")]
    pub lipschitz_tau: Option<f64>,
    /// M_kc of (H7) in W/(m² K).
    #[serde(rename = "M_kc")]
    pub bound_kc: Option<f64>,
    /// L_kc of (H7) in W/(m³ K).
    #[serde(rename = "L_kc")]
    pub lipschitz_kc: Option<f64>,
    /// L of φ_L in K; `None` without cut-off.
    #[serde(rename = "L")]
    pub truncation: Option<f64>,
    /// c_k of (2.12).
    pub c_k: Option<f64>,
    /// c_f of (2.13).
    pub c_f: Option<f64>,
    /// s₁ of (2.14) in √m.
    pub s1: Option<f64>,
    /// Constant s₁ of the normal trace in √m.
    pub s1_normal: Option<f64>,
    /// Constant s₁ of the tangential trace in √m.
    pub s1_tangential: Option<f64>,
    /// s₂ of (2.15) in √m.
    pub s2: Option<f64>,
}

/// The constant of the laws on Γ_C: the largest over its sides, for each side the sum over its contacts; `None` if a
/// contact has no constant, or without contact.
fn largest_of_sides(problem: &Problem, of_contacts: &[Option<f64>]) -> Option<f64> {
    let mut of_sides: BTreeMap<&str, f64> = BTreeMap::new();
    for (contact, constant) in problem.contacts.iter().zip(of_contacts) {
        for side in contact.sides() {
            *of_sides.entry(side).or_default() += (*constant)?;
        }
    }
    of_sides.into_values().reduce(f64::max)
}

impl Constants {
    /// Constants of the materials and the contact laws.
    fn of_laws(problem: &Problem) -> Constants {
        // Several materials together have the least m and the largest M.
        let materials = &problem.materials;
        let extremes = |law: fn(&crate::material::Material) -> crate::material::OperatorConstants| {
            let all = || materials.iter().map(law);
            (
                all().fold(f64::INFINITY, |least, c| least.min(c.monotonicity)),
                all().fold(0.0, |most: f64, c| most.max(c.lipschitz)),
            )
        };
        let (a, b) = (extremes(|m| m.elasticity.constants()), extremes(|m| m.viscosity.constants()));
        let conductivities = problem.values_of(|m| &m.conductivity);
        let d: Vec<f64> = conductivities.iter().flat_map(|k| k.value.eigenvalues(problem.mesh.dim)).collect();
        let over_sides = |constant: &dyn Fn(&Contact) -> Option<f64>| {
            let of_contacts: Vec<Option<f64>> = problem.contacts.iter().map(constant).collect();
            largest_of_sides(problem, &of_contacts)
        };
        let tau: Vec<Option<f64>> = laws::tested(problem).map(|test| test.tau.0).collect();
        Constants {
            m_a: a.0,
            lipschitz_a: a.1,
            m_b: b.0,
            lipschitz_b: b.1,
            m_d: d.iter().copied().reduce(f64::min).unwrap_or(0.0),
            bound_d: d.iter().fold(0.0, |max, e| e.abs().max(max)),
            lipschitz_nu: over_sides(&|c| c.normal.lipschitz()),
            lipschitz_tau: largest_of_sides(problem, &tau),
            bound_kc: over_sides(&|c| Some(c.heat.conductance_bound())),
            lipschitz_kc: over_sides(&|c| c.heat.conductance_lipschitz()),
            truncation: problem.contacts.iter().map(|c| c.heat.truncation()).reduce(|a, b| Some(a?.max(b?))).flatten(),
            ..Constants::default()
        }
    }

    /// Adds the constants of the domain and those derived from them.
    fn on(self, problem: &Problem, domain: &DomainConstants) -> Constants {
        let value = |constant: Option<Constant>| constant.map(|c| c.value);
        // (2.13): ‖η‖² ≤ (1 − c_f²)/c_f² ‖∇η‖².
        let poincare = value(domain.c_f).map(|c| (1.0 - c * c).max(0.0).sqrt() / c);
        Constants {
            bound_m: poincare.map(|p| p * tensors::largest_norm(problem, |m| &m.expansion)),
            bound_e: poincare.map(|p| p * tensors::largest_norm(problem, |m| &m.coupling)),
            c_k: value(domain.c_k),
            c_f: value(domain.c_f),
            s1: value(domain.s1),
            s1_normal: value(domain.s1_normal),
            s1_tangential: value(domain.s1_tangential),
            s2: value(domain.s2),
            ..self
        }
    }
}

/// The verdicts on a problem with the constants used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    /// One verdict per id.
    pub findings: Vec<Finding>,
    /// The constants.
    pub constants: Constants,
}

/// True if a run evaluates all hypotheses by default: if that is at most about a tenth of its work.
///
/// Verdicts that need their own factors take as long as ten to twenty steps of the same body, regardless of its size;
/// for a small body less than a tenth of a second. The rule depends on the data alone, so two runs of a case have the
/// same findings.
#[must_use]
pub fn are_affordable(problem: &Problem) -> bool {
    if !problem.physics.has_mechanics() || pairs::are_beyond(problem) {
        return true;
    }
    let mesh = &problem.mesh;
    let few = [usize::MAX, FEW_IN_PLANE, FEW_IN_SPACE].get(mesh.dim.saturating_sub(1)).copied().unwrap_or_default();
    mesh.points.len() * mesh.dim <= few || problem.timeline.steps() >= MANY_STEPS
}

/// Unknowns of a plane body up to which its certificate takes less than 0.1 s.
const FEW_IN_PLANE: usize = 10_000;
/// Unknowns of a body in space up to which its certificate takes less than 0.1 s.
const FEW_IN_SPACE: usize = 1_000;
/// Number of steps from which the certificate is at most about a tenth of a run.
const MANY_STEPS: usize = 200;

/// [`findings`], with a note on the verdicts that they leave out.
pub(crate) fn without_factors(problem: &Problem) -> Vec<Finding> {
    let mut findings = findings(problem);
    if problem.physics.has_mechanics() {
        let message = "verdicts that need factorizations of their own are left out of this run: 2.23-printed, step-unique, contact-possible";
        let finding = Finding::new(FindingId::Certificate, FindingStatus::NotCovered, message, "mesh");
        findings.push(finding.repair("`amontons check`, or `amontons run --certificate`, judges them"));
    }
    findings
}

/// The findings that need no eigenvalue problem: (H1)–(H8), the truncation of φ_L, `2.23-needed` and the cells.
#[must_use]
pub fn findings(problem: &Problem) -> Vec<Finding> {
    judged(problem, &Constants::of_laws(problem))
}

fn judged(problem: &Problem, constants: &Constants) -> Vec<Finding> {
    let mut findings = tensors::material(problem, constants);
    findings.push(data::h6(problem));
    findings.extend(laws::contact(problem, constants));
    findings.retain(|finding| finding.id.concerns(problem.physics));
    findings.push(theorem::needed(problem, constants, &findings));
    findings.extend(softening::softening(problem));
    findings.extend(laws::rigid_conductance(problem));
    findings.extend(pairs::faced(problem));
    findings.push(quality::cells(&problem.mesh));
    findings.extend(warnings::of_data(problem));
    findings.retain(|finding| finding.id.concerns(problem.physics));
    findings
}

/// All verdicts on a problem except those of [`advice`]. It takes one factorization each for ‖ε(·)‖, ‖∇·‖, the
/// mechanical and the thermal system, and two of a if the gap is open at t = 0 and loads do not vary. Constants are
/// those of V^h and Q^h.
///
/// # Errors
/// Fails if a matrix of the constants of the domain cannot be factorized: see [`domain_constants`].
pub fn certificate(problem: &Problem) -> Result<Certificate, SolveError> {
    certificate_on(problem, &|| Arc::new(Discretization::new(problem)))
}

/// [`certificate`] of a problem whose forms `forms` assembles if a verdict needs them.
fn certificate_on(problem: &Problem, forms: &dyn Fn() -> Arc<Discretization>) -> Result<Certificate, SolveError> {
    if pairs::are_beyond(problem) {
        return Ok(pairs::certificate(problem));
    }
    let discrete = &forms();
    let domain = || domain::constants_on(problem, &discrete.mass);
    let (domain, unique) = join(problem.backend.is_collective(), domain, || step::unique(problem, discrete));
    let constants = Constants::of_laws(problem).on(problem, &domain?);
    let mut findings = judged(problem, &constants);
    if !problem.physics.has_mechanics() {
        return Ok(Certificate { findings, constants });
    }
    let at = findings.iter().position(|f| f.id == FindingId::Needed).unwrap_or(findings.len());
    findings.insert(at, theorem::printed(problem, &constants));
    findings.push(unique);
    if !reach::loads_vary(problem) {
        findings.push(reach::possible(problem, discrete, &constants));
    }
    say_phase(problem, &mut findings);
    Ok(Certificate { findings, constants })
}

/// Says of verdicts that depend on the supports that they are those of the first phase, if conditions change.
fn say_phase(problem: &Problem, findings: &mut [Finding]) {
    let of_supports =
        [FindingId::Printed, FindingId::Needed, FindingId::StepUnique, FindingId::TimeStep, FindingId::ContactPossible];
    let phase = problem.timeline.phases().nth(problem.phase());
    let Some(phase) = phase.filter(|_| problem.changes_conditions_of_run()) else { return };
    let all_act = problem.contacts.iter().all(|contact| contact.during == During::Run);
    let contacts = if all_act { "" } else { ", and as if all contacts acted in it" };
    for finding in findings.iter_mut().filter(|finding| of_supports.contains(&finding.id)) {
        let name = &phase.name;
        finding.message += &format!("; judged with the conditions of the phase \"{name}\" alone{contacts}");
    }
}

/// Verdicts that need a variable number of factorizations: `time-step` searches by doubling the number of steps if
/// `step-unique` does not hold, and `contact-possible` under time-dependent loads solves a static problem for every
/// step.
#[must_use]
pub fn advice(problem: &Problem, certificate: &Certificate) -> Vec<Finding> {
    advice_on(problem, &|| Arc::new(Discretization::new(problem)), certificate)
}

/// [`advice`] on a problem whose forms `forms` assembles if a verdict needs them.
fn advice_on(problem: &Problem, forms: &dyn Fn() -> Arc<Discretization>, certificate: &Certificate) -> Vec<Finding> {
    if !problem.physics.has_mechanics() {
        return Vec::new();
    }
    if pairs::are_beyond(problem) {
        let message = "the number of steps that ensures one solution is proved for one body on a rigid foundation";
        return vec![pairs::not_covered(problem, FindingId::TimeStep, message)];
    }
    let unique = certificate.findings.iter().find(|finding| finding.id == FindingId::StepUnique);
    let mut findings = vec![step::time_step(problem, forms, unique)];
    if reach::loads_vary(problem) {
        findings.push(reach::possible(problem, &forms(), &certificate.constants));
    }
    say_phase(problem, &mut findings);
    findings
}

/// The certificate, or, if it cannot be computed, the findings that do not need it with the reason.
#[must_use]
pub fn certificate_or_findings(problem: &Problem) -> Certificate {
    certificate_or_findings_on(problem, &|| Arc::new(Discretization::new(problem)))
}

/// [`certificate_or_findings`] of a problem with these forms, which a run can reuse.
pub(crate) fn certificate_or_findings_on(problem: &Problem, forms: &dyn Fn() -> Arc<Discretization>) -> Certificate {
    certificate_on(problem, forms).unwrap_or_else(|error| {
        let constants = Constants::of_laws(problem);
        let mut findings = judged(problem, &constants);
        let message = format!("the constants of the domain cannot be computed: {error}");
        findings.push(Finding::new(FindingId::Certificate, FindingStatus::NotCovered, message, "mesh"));
        Certificate { findings, constants }
    })
}

/// All verdicts: [`certificate_or_findings`] with [`advice`].
#[must_use]
pub fn full(problem: &Problem) -> Certificate {
    let made = OnceCell::new();
    let forms = || Arc::clone(made.get_or_init(|| Arc::new(Discretization::new(problem))));
    let mut certificate = certificate_or_findings_on(problem, &forms);
    let advice = advice_on(problem, &forms, &certificate);
    certificate.findings.extend(advice);
    certificate
}

/// Closing error of an identity of the audit up to which it counts as round-off.
pub const CLOSING: f64 = 1e-10;
/// Closing error above which results cannot be trusted. Accepted steps may leave unbalanced forces of 1e-4 of the
/// driving ones if these are round-off; a closing error ten times as large has another cause.
pub const GROSS: f64 = 1e-3;

/// Checks that the energy and heat identities of a problem close.
#[must_use]
pub fn audit(physics: Physics, energy: f64, heat: f64) -> Vec<Finding> {
    let one = |id: FindingId, name: &str, error: f64| {
        let holds = error.abs() <= CLOSING;
        let message = if holds {
            format!("the {name} identity closes to {error:.1e} of what was turned over")
        } else {
            format!(
                "the {name} identity closes only to {error:.1e} of what was turned over: round-off has grown, check the results"
            )
        };
        Finding::new(id, FindingStatus::of(holds), message, "the audit of every step")
            .numbers(Some(error.abs()), Some(CLOSING))
    };
    let both = [one(FindingId::Energy, "energy", energy), one(FindingId::Heat, "heat", heat)];
    both.into_iter().filter(|finding| finding.id.concerns(physics)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_identity_that_does_not_close_is_a_failure() {
        let audit = |energy, heat| audit(Physics::Coupled, energy, heat);
        assert!(audit(1e-14, -1e-9)[1].fails() && !audit(1e-14, -1e-9)[0].fails());
        assert!(audit(f64::NAN, 0.0)[0].fails());
    }
}
