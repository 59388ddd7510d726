//! One discrete step of (4.1): when it has one solution.
//!
//! With the bound of friction taken at the unknown u_n a step is a quasi-variational inequality. After condensation, S w + T(w) ∋ r̂
//! on Γ_C, where T(w) = Σ ω Nᵀ(p_ν(r) ν + p_τ(r) ∂‖w_τ‖), r = r₀ + k w_ν. T loses monotonicity by at most c* k W, W the weights, so that
//! the step has one solution if
//!
//! ```text
//!     λ_min(S, W) > c* k,    c* = max{ (√(L_ν² + L_τ²) − L_ν)/2, L_r/2 },
//! ```
//!
//! where L_r is the part of L_τ that does not come from the pressure: 0 for Coulomb's law, for which c* = L_ν (√(1 + μ²) − 1)/2. It has a
//! solution in any case. With a pressure that falls by s at the most c* is also not less than (s + √(s² + (μs + L_r)²))/2, and with a bound that
//! falls with the slip speed by f p at the most, the condition is λ_min(S, W) > c* k + f p for the pressures p of the step. λ_min/k = λ_min of the condensed ρM/k² + B/k + A does not decrease as k decreases, so that what holds
//! for k holds for all shorter steps. Relaxing stress of the material only adds to S and is left out. Proofs: `book/src/theory.md`.

use std::sync::Arc;

use super::branches::{falls, rate_matters};
use super::domain::TraceQuotient;
use super::laws::norm;
use super::{Finding, Status};
use crate::contact::{Contact, ContactBoundary, ContactPoint};
use crate::forms;
use crate::linalg::{BlockMatrix, Entry, FactorError, Graph, System, Unknowns, largest};
use crate::material::{Isotropic, Material, StressState, TensorLaw};
use crate::problem::{Coupling, Problem};
use crate::space::Space;

/// Doublings of the number of steps after which the search for one that ensures a unique step ends.
const DOUBLINGS: u32 = 20;

/// c* in Pa/m: the loss of monotonicity of the contact forces by friction, for a step of unit length. `l_nu` and `l_tau` are L_ν and L_τ,
/// `l_r` the Lipschitz constant of the friction bound at fixed pressure.
#[must_use]
pub fn monotonicity_loss(l_nu: f64, l_tau: f64, l_r: f64) -> f64 {
    // (√(a² + b²) − a)/2 without cancellation.
    let coupled = if l_tau > 0.0 { 0.5 * l_tau * (l_tau / (l_nu.hypot(l_tau) + l_nu)) } else { 0.0 };
    coupled.max(0.5 * l_r)
}

/// c* of the laws of a contact; none where they have no Lipschitz constants.
///
/// Where the pressure falls by s per length at the most, the fall takes s, and with friction (s + √(s² + L²))/2, L the Lipschitz constant of
/// the bound of a pressure that falls so.
fn loss(contact: &Contact, fall: f64) -> Option<f64> {
    if contact.friction.is_frictionless() {
        return Some(fall).filter(|fall| fall.is_finite());
    }
    let (l_nu, bound) = (contact.normal.lipschitz()?, &contact.friction);
    let rising = monotonicity_loss(l_nu, bound.lipschitz(Some(l_nu))?, bound.lipschitz(Some(0.0))?);
    Some(if fall > 0.0 { rising.max(0.5 * (fall + fall.hypot(bound.lipschitz(Some(fall))?))) } else { rising })
}

/// The mechanical system of a step for any k: λ_min(S, W).
struct Step<'a> {
    problem: &'a Problem,
    space: Space,
    boundary: ContactBoundary,
    inertia: BlockMatrix,
    a: BlockMatrix,
    b: BlockMatrix,
}

/// A linear operator below the law: the law itself, or m times the identity, since (A(ξ₁) − A(ξ₂))·(ξ₁ − ξ₂) ≥ m ‖ξ₁ − ξ₂‖².
fn minorant(law: &Arc<dyn TensorLaw>, dim: usize) -> Arc<dyn TensorLaw> {
    if law.is_linear() {
        return Arc::clone(law);
    }
    Arc::new(Isotropic::lame(dim, 0.0, law.constants().monotonicity.max(0.0), StressState::PlaneStress))
}

impl<'a> Step<'a> {
    fn new(problem: &'a Problem, boundary: ContactBoundary) -> Step<'a> {
        let mesh = &problem.mesh;
        let graph = Arc::new(Graph::of_mesh(mesh));
        let materials = &problem.materials;
        let laws = |law: fn(&Material) -> &Arc<dyn TensorLaw>| materials.iter().map(|m| minorant(law(m), mesh.tensor_dim())).collect::<Vec<_>>();
        let (a, b) = (laws(|m| &m.elasticity), laws(|m| &m.viscosity));
        Step {
            problem,
            space: problem.displacement_space(),
            boundary,
            inertia: forms::weighted_inner_h(mesh, &graph, &materials.iter().map(|m| m.density).collect::<Vec<_>>()),
            a: forms::tensor_form(mesh, &graph, &a.iter().map(AsRef::as_ref).collect::<Vec<_>>(), problem.dilatation),
            b: forms::tensor_form(mesh, &graph, &b.iter().map(AsRef::as_ref).collect::<Vec<_>>(), problem.dilatation),
        }
    }

    /// λ_min(S, W) of K_u = ρM/k + B + kA; infinite without unknowns on Γ_C.
    fn least(&self, k: f64) -> Result<f64, FactorError> {
        let mesh = &self.problem.mesh;
        let mut matrix = self.b.clone();
        matrix.add_scaled(k, &self.a);
        matrix.add_scaled(1.0 / k, &self.inertia);
        let unknowns = Unknowns::new(&matrix, &mesh.points, mesh.dim, &self.space.free, &self.boundary.nodes);
        let mut system = System::new(&matrix, unknowns)?;
        let entries = self.weights(system.unknowns());
        // The largest eigenvalue of (W, S) is 1/λ_min(S, W).
        Ok(1.0 / largest(&mut TraceQuotient { entries, system: &mut system }).value)
    }

    /// W = Σ ω NᵀN on each component of the contact unknowns.
    fn weights(&self, unknowns: &Unknowns) -> Vec<Entry> {
        let dim = self.problem.mesh.dim;
        let mut position = vec![None; self.space.free.len()];
        for (k, &dof) in unknowns.contact().iter().enumerate() {
            position[dof as usize] = Some(k as u32);
        }
        let at = |node: usize, c: usize| position[self.boundary.nodes[node] as usize * dim + c];
        let mut entries = Vec::new();
        for point in &self.boundary.points {
            for &(i, n_i) in &point.nodes {
                for &(j, n_j) in &point.nodes {
                    entries.extend((0..dim).filter_map(|c| Some((at(i, c)?, at(j, c)?, point.weight * n_i * n_j))));
                }
            }
        }
        entries
    }
}

/// Whether θ_n acts on w_n in the same step by expansion, as in couplings other than the paper's.
pub(super) fn heat_acts_at_once(problem: &Problem) -> bool {
    problem.coupling != Coupling::Staggered && problem.materials.iter().any(|m| norm(&m.expansion, problem.mesh.tensor_dim()) > 0.0)
}

/// What of the laws the condition does not speak of, and its place.
fn not_judged(problem: &Problem, at_start: bool, drops: bool) -> Option<(&'static str, &'static str)> {
    let with_friction = || problem.contacts.iter().any(|contact| !contact.friction.is_frictionless());
    if drops {
        Some(("the pressure drops from one value to another: a step over the drop may have several solutions, however short it is", "contact.normal"))
    } else if at_start {
        Some((
            "friction drops when slip starts: a point that is loaded between kinetic and static friction has two solutions in a step of any length, and the one that it was on before is followed",
            "contact.friction",
        ))
    } else if problem.contacts.iter().any(|contact| contact.wear.is_some()) {
        Some(("what wears off within a step lowers the pressure with the slip speed, which is not judged", "contact.wear"))
    } else if with_friction() && rate_matters(problem) {
        Some(("friction that follows a pressure of the rate of penetration is not judged", "contact.normal"))
    } else if problem.coupling != Coupling::Staggered && with_friction() && problem.contacts.iter().any(friction_sees_heat) {
        Some(("u_n and θ_n are found together, and friction follows θ_n: the condition is that of a step with θ given", "contact.friction"))
    } else {
        None
    }
}

/// Whether the friction bound depends on the temperature, as far as samples tell.
fn friction_sees_heat(contact: &Contact) -> bool {
    (-40i8..=40).any(|decade| {
        let temperature = 10f64.powf(0.1 * f64::from(decade));
        [-temperature, temperature]
            .iter()
            .any(|&temperature| contact.friction.bound(&ContactPoint { pressure: 1.0, temperature, ..ContactPoint::default() }).by_temperature != 0.0)
    })
}

/// What there is to compare, c* and f among it, or the finding that says why there is nothing.
fn prepare<'a>(problem: &'a Problem, id: &str) -> Result<(Step<'a>, [f64; 2]), Box<Finding>> {
    if problem.contacts.is_empty() {
        return Err(Box::new(Finding::new(id, Status::Holds, "there is no contact: a step is monotone", "contact")));
    }
    let falls = falls(problem);
    if let Some((message, place)) = not_judged(problem, falls.iter().any(|f| f.at_start > 0.0), falls.iter().any(|f| f.pressure.is_infinite())) {
        return Err(Box::new(Finding::new(id, Status::NotCovered, message, place)));
    }
    let losses = problem.contacts.iter().zip(&falls).map(|(contact, falls)| loss(contact, falls.pressure));
    let Some(loss) = losses.into_iter().try_fold(0.0, |most: f64, loss| Some(most.max(loss?))) else {
        let message = "the step is judged for laws with Lipschitz constants L_ν, L_τ: see (H8)";
        return Err(Box::new(Finding::new(id, Status::NotCovered, message, "contact").repair("normal compliance with a stiffness, or no friction")));
    };
    if heat_acts_at_once(problem) {
        let message = "u_n and θ_n are found together: the condition is that of a step with θ given";
        return Err(Box::new(Finding::new(id, Status::NotCovered, message, "material.expansion")));
    }
    let with_speed = falls.iter().map(|falls| falls.with_speed).fold(0.0, f64::max);
    Ok((Step::new(problem, problem.contact_boundary()), [loss, with_speed]))
}

/// What is said where friction falls with the slip speed by f p and, apart from that, a step has one solution: it has as long as f p is less
/// than what c* k leaves of λ_min. No bound of the pressure is known before the run.
fn up_to_a_pressure(id: &str, found: f64, needed: f64, with_speed: f64, steps: f64) -> Finding {
    let most = (found - needed) / with_speed;
    let message = format!(
        "with {steps} steps each step has one solution as long as the pressure is below {most:.6e} Pa, where friction that falls with the slip speed takes what is left of λ_min(S, W) = {found:.4}: no bound of the pressure is known beforehand. A run halves the steps that may leave the branch of the step before, and counts those that then still may in solver.ambiguous_steps"
    );
    Finding::new(id, Status::NotCovered, message, "contact.friction")
}

fn not_factorized(id: &str, error: &FactorError) -> Finding {
    Finding::new(id, Status::NotCovered, format!("the mechanical system of a step cannot be factorized: {error}"), "boundary")
}

/// `step-unique`: λ_min(S, W) > c* k.
pub(super) fn unique(problem: &Problem) -> Finding {
    let id = "step-unique";
    let (step, [loss, with_speed]) = match prepare(problem, id) {
        Ok(ready) => ready,
        Err(finding) => return *finding,
    };
    let k = problem.k();
    let needed = loss * k;
    let found = match step.least(k) {
        Ok(found) => found,
        Err(error) => return not_factorized(id, &error),
    };
    let holds = found > needed;
    if holds && with_speed > 0.0 {
        return up_to_a_pressure(id, found, needed, with_speed, problem.steps as f64).numbers(Some(found), Some(needed));
    }
    let message = if holds {
        format!(
            "each step has one solution, and it depends continuously on the data: λ_min(S, W) = {found:.4}, more than {needed:.4} that the laws of contact take"
        )
    } else {
        format!(
            "the condition that ensures one solution of a step does not hold: λ_min(S, W) = {found:.4}, the laws of contact take {needed:.4}. It is sufficient, not necessary: a step has a solution, and may well have one only"
        )
    };
    Finding::new(id, Status::of(holds), message, "time.steps").numbers(Some(found), Some(needed)).repair("more steps: `check` names a number in time-step")
}

/// `time-step`: the least number of steps, the case's own or that times a power of two, for which `step-unique` holds.
pub(super) fn time_step(problem: &Problem) -> Finding {
    let id = "time-step";
    let (step, [loss, with_speed]) = match prepare(problem, id) {
        Ok(ready) => ready,
        Err(finding) => return *finding,
    };
    let mut ratio = 0.0;
    for doubling in 0..=DOUBLINGS {
        let steps = problem.steps as f64 * f64::from(1u32 << doubling);
        let k = problem.end / steps;
        let found = match step.least(k) {
            Ok(found) => found,
            Err(error) => return not_factorized(id, &error),
        };
        if found > loss * k {
            if with_speed > 0.0 {
                return up_to_a_pressure(id, found, loss * k, with_speed, steps).numbers(Some(problem.steps as f64), Some(steps));
            }
            let message = if doubling == 0 {
                format!("with {steps} steps, k = {k:.6e} s, each step has one solution")
            } else {
                format!("with {steps} steps, k = {k:.6e} s, and more, each step has one solution; the case has {}", problem.steps)
            };
            return Finding::new(id, Status::of(doubling == 0), message, "time.steps")
                .numbers(Some(problem.steps as f64), Some(steps))
                .repair(format!("time.steps = {steps}"));
        }
        // λ/k of a body without mass and viscosity does not change with k: no step is short enough.
        if found / k <= ratio * (1.0 + 1e-9) {
            break;
        }
        ratio = found / k;
    }
    let message = "no number of steps was found that ensures one solution of a step";
    Finding::new(id, Status::NotCovered, message, "time.steps")
        .numbers(Some(problem.steps as f64), None)
        .repair("inertia, viscosity, a smaller coefficient of friction, or a law that falls less")
}
