//! Uniqueness of one discrete step of (4.1).
//!
//! With the friction bound at the unknown u_n, a step is a quasi-variational inequality. After condensation it is S w +
//! T(w) ∋ r̂ on Γ_C, where T(w) = Σ ω Nᵀ(p_ν(r) ν + p_τ(r) ∂‖w_τ‖), r = r₀ + k w_ν. T loses monotonicity by at most c*
//! k W, W the weights, so that the step has one solution if
//!
//! ```text
//!     λ_min(S, W) > c* k,    c* = max{ (√(L_ν² + L_τ²) − L_ν)/2, L_r/2 },
//! ```
//!
//! where L_r is the part of L_τ that does not come from the pressure: 0 for Coulomb's law, for which c* = L_ν (√(1 +
//! μ²) − 1)/2. A solution exists in any case. If the pressure decreases by at most s per length, c* is at least (s +
//! √(s² + (μs + L_r)²))/2; if the bound decreases with the slip speed by at most f p, the condition is λ_min(S, W) > c*
//! k + f p for the pressures p of the step. With several contacts c* W is Σ c*_i W_i. λ_min/k = λ_min of the condensed
//! ρM/k² + B/k + A does not decrease as k decreases, so a condition that holds for k holds for all shorter steps. K_u
//! is the matrix of the scheme. Proofs: `book/src/theory.md`.
//!
//! `holds` rests on a Cholesky factor of K_u − c* k W minus 2⁻⁴⁰ of the diagonal of K_u, a margin far above round-off:
//! by elimination of the interior it is positive definite if and only if K_II and S − c* k W are, so that one factor of
//! K_u minus that margin serves for every c*, and for the eigenvalue. For a body too large for a factor it rests on
//! conjugate gradients that meet no other energy. `fails` rests on a quotient x·Sx / x·Wx ≤ c* k.

use std::sync::Arc;

use super::domain::TraceQuotient;
use super::laws::tested;
use super::softening::falls;
use super::tensors::largest_norm;
use super::{Finding, FindingId, FindingStatus};
use crate::contact::Contact;
use crate::discretization::{Discretization, is_fixed};
use crate::field::Law;
use crate::linalg::{BlockMatrix, Entry, Layout, Share, SolveError, System, Tangent, Unknowns, dot, largest};
use crate::material::{Isotropic, Material, StressState, TensorLaw};
use crate::problem::Problem;
use crate::space::Space;
use crate::tensor;
use crate::time::{Analysis, Instant};
use crate::units::{Measure, Units};

/// Fraction of the diagonal by which a matrix must be positive definite: far above the round-off of a factor.
const MARGIN: f64 = 9.094_947_017_729_282e-13;

/// Largest number of doublings in the search for the number of steps that ensures a unique step.
const DOUBLINGS: u32 = 20;

/// c* in Pa/m: the loss of monotonicity of the contact forces by friction, per unit step length. `l_nu` and `l_tau` are
/// L_ν and L_τ, `l_r` is the Lipschitz constant of the friction bound at fixed pressure.
#[must_use]
pub fn monotonicity_loss(l_nu: f64, l_tau: f64, l_r: f64) -> f64 {
    // (√(a² + b²) − a)/2 in a form without cancellation.
    let coupled = if l_tau > 0.0 { 0.5 * l_tau * (l_tau / (l_nu.hypot(l_tau) + l_nu)) } else { 0.0 };
    coupled.max(0.5 * l_r)
}

/// c* of the laws of a contact; `None` if they have no Lipschitz constants.
///
/// If the pressure decreases by at most s per length, c* includes s, and with friction (s + √(s² + L²))/2, L the
/// Lipschitz constant of the friction bound at such a pressure.
fn loss(contact: &Contact, fall: f64) -> Option<f64> {
    if contact.friction.is_frictionless() {
        return Some(fall).filter(|fall| fall.is_finite());
    }
    let (l_nu, bound) = (contact.normal.lipschitz()?, &contact.friction);
    let rising = monotonicity_loss(l_nu, bound.lipschitz(Some(l_nu))?, bound.lipschitz(Some(0.0))?);
    Some(if fall > 0.0 { rising.max(0.5 * (fall + fall.hypot(bound.lipschitz(Some(fall))?))) } else { rising })
}

/// A linear operator below the law: the law itself, or m times the identity, since (A(ξ₁) − A(ξ₂))·(ξ₁ − ξ₂) ≥ m ‖ξ₁ −
/// ξ₂‖², with the least m over its temperatures.
fn minorant(law: &Law<dyn TensorLaw>, dim: usize) -> Law<dyn TensorLaw> {
    if is_fixed(law) {
        return law.clone();
    }
    Isotropic::lame(dim, 0.0, law.constants().monotonicity.max(0.0), StressState::PlaneStress).into()
}

/// The forms of a problem with linear laws of the body below its own; its own forms if its laws are linear.
fn minorized(problem: &Problem, discrete: &Arc<Discretization>) -> Arc<Discretization> {
    if problem.materials.iter().all(|m| is_fixed(&m.elasticity) && is_fixed(&m.viscosity)) {
        return Arc::clone(discrete);
    }
    let dim = problem.mesh.tensor_dim();
    let below = |m: &Material| Material {
        elasticity: minorant(&m.elasticity, dim),
        viscosity: minorant(&m.viscosity, dim),
        ..m.clone()
    };
    Arc::new(Discretization::new(&problem.with_materials(below)))
}

/// The mechanical system of a step for any k.
struct StepOperator<'a> {
    problem: &'a Problem,
    discrete: Arc<Discretization>,
    /// c*, the largest of the contacts, Pa/m.
    loss: f64,
    /// f, the largest of the contacts, s/m.
    with_speed: f64,
    /// W = Σ ω NᵀN, on each component, scaled per contact by its own c* over the largest.
    weights: BlockMatrix,
    shares: Vec<f64>,
}

/// K_u at one step length, minus [`MARGIN`] of its diagonal, and its factored system once needed.
struct StepMatrix<'a> {
    step: &'a StepOperator<'a>,
    /// γ of the rule in time, s.
    gamma: f64,
    /// The length of a step over the time for which the body moves in it. A steady step is told by its length, too.
    share: f64,
    less: Arc<BlockMatrix>,
    system: Option<System>,
}

/// Bounds of λ_min(S, W): a quotient of the forms from above, and this minus the error of the iteration from below.
#[derive(Clone, Copy)]
struct Least {
    above: f64,
    below: f64,
}

impl<'a> StepOperator<'a> {
    fn new(problem: &'a Problem, discrete: &Arc<Discretization>, losses: &[[f64; 2]]) -> StepOperator<'a> {
        let discrete = minorized(problem, discrete);
        let [loss, with_speed] = [0, 1].map(|i| losses.iter().map(|l| l[i]).fold(0.0, f64::max));
        let share = |[own, own_with_speed]: [f64; 2]| {
            let of = |own: f64, largest: f64| if largest > 0.0 { own / largest } else { 0.0 };
            if loss + with_speed > 0.0 { of(own, loss).max(of(own_with_speed, with_speed)) } else { 1.0 }
        };
        let shares: Vec<f64> = losses.iter().map(|l| share(*l)).collect();
        let mut weights = BlockMatrix::zero(discrete.mass.graph(), 1, 1);
        for point in &discrete.boundary.points {
            let nodes: Vec<u32> = point.nodes.iter().map(|&(i, _)| discrete.boundary.nodes[i]).collect();
            let weight = shares.get(point.contact).copied().unwrap_or(1.0) * point.weight;
            let form: Vec<f64> = point
                .nodes
                .iter()
                .flat_map(|&(_, n_i)| point.nodes.iter().map(move |&(_, n_j)| weight * n_i * n_j))
                .collect();
            weights.add(&nodes, &form);
        }
        StepOperator { problem, discrete, loss, with_speed, weights, shares }
    }

    /// K_u = ρM/k + B + kA of an analysis at step length k.
    fn at(&self, analysis: Analysis, k: f64) -> StepMatrix<'_> {
        let rule = self.problem.starting_rule(analysis, k);
        let matrix = self.discrete.mechanical_matrix(rule);
        let share = rule.k / rule.moving();
        StepMatrix { step: self, gamma: rule.gamma, share, less: Arc::new(less_margin(matrix)), system: None }
    }

    /// True if the heat equation of each step has one solution: C/k + D is positive definite for the longest steps.
    fn heat_is_definite(&self) -> Result<bool, SolveError> {
        if !self.problem.physics.has_heat() {
            return Ok(true);
        }
        for Instant { k, analysis, .. } in self.problem.timeline.longest_steps() {
            let matrix = self.discrete.thermal_matrix(self.problem.starting_rule(analysis, k));
            if !is_positive_definite(self.problem, &self.discrete.q, matrix)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// W times a factor, as a tangent on the contact unknowns.
    fn tangent(&self, unknowns: &Unknowns, factor: f64) -> Tangent {
        const ONE: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (dim, boundary) = (self.problem.mesh.dim, &self.discrete.boundary);
        let position = unknowns.positions(self.discrete.v.free.len());
        let mut tangent = Tangent::new();
        for point in &boundary.points {
            let of_node = |&(i, value): &(usize, f64)| {
                let node = boundary.nodes[i];
                let (first, axes) = (node as usize * dim, unknowns.directions(node));
                let of = |c: usize| Some((position[first + c]?, axes[c].map(|on| value * on)));
                (0..dim).filter_map(of).collect::<Vec<Share>>()
            };
            let row: Vec<Share> = point.nodes.iter().flat_map(of_node).collect();
            let share = self.shares.get(point.contact).copied().unwrap_or(1.0);
            tangent.add(factor * share * point.weight, &row, &ONE);
        }
        tangent
    }

    /// W on the contact unknowns.
    fn entries(&self, unknowns: &Unknowns) -> Vec<Entry> {
        let dim = self.problem.mesh.dim;
        let position = unknowns.positions(self.discrete.v.free.len());
        let mut entries = Vec::new();
        for &node in &self.discrete.boundary.nodes {
            for (column, value) in self.weights.row(node as usize) {
                let (own, other) = (unknowns.directions(node), unknowns.directions(column as u32));
                let pair = |(r, c): (usize, usize)| {
                    let weight = value.first()? * tensor::dot(&own[r], &other[c]);
                    Some((position[node as usize * dim + r]?, position[column * dim + c]?, weight))
                };
                let pairs = (0..dim).flat_map(|r| (0..dim).map(move |c| (r, c)));
                entries.extend(pairs.filter_map(pair).filter(|(.., value)| *value != 0.0));
            }
        }
        entries
    }
}

impl StepMatrix<'_> {
    /// True if K_u − c* k W is positive definite beyond round-off; with c* = 0 K_u itself.
    fn dominates(&mut self, loss: f64) -> Result<bool, SolveError> {
        let step = self.step;
        let StepOperator { problem, discrete, weights, .. } = step;
        let lost = loss * self.gamma;
        let system = match self.system() {
            Ok(system) => system,
            Err(SolveError::NotPositive { .. }) => return Ok(false),
            Err(error) => return Err(error),
        };
        // An iterative solver proves less than a factor, if that is not too large.
        let layout = Layout::of(&problem.mesh, &discrete.v, &[]);
        if system.is_direct() || !problem.backend.proves(&self.less, &layout) {
            let system = self.system()?;
            let tangent = step.tangent(system.unknowns(), -lost);
            return system.condensed_mut().is_positive_definite(&tangent);
        }
        let mut less = BlockMatrix::clone(&self.less);
        less.add_scaled(-lost, weights);
        problem.backend.is_positive_definite(&Arc::new(less), &layout)
    }

    /// λ_min(S, W); infinite without unknowns on Γ_C.
    fn least(&mut self) -> Result<Least, SolveError> {
        let (step, less) = (self.step, Arc::clone(&self.less));
        let system = self.system()?;
        let mut pencil = TraceQuotient { entries: step.entries(system.unknowns()), system: &mut *system };
        // The largest eigenvalue of (W, S) is 1/λ_min(S, W), here with the reduced S.
        let pair = largest(&mut pencil)?;
        if pair.value <= 0.0 {
            return Ok(Least { above: f64::INFINITY, below: f64::INFINITY });
        }
        // Uses the energy of the body instead of x·Sx: S carries the round-off of the elimination.
        let mut body = vec![0.0; step.discrete.v.free.len()];
        system.unknowns().add(&system.extend(&pair.vector)?, &mut body);
        let above = energy(&less, &body) / dot(&body, &step.weights.apply(&body));
        let below = above.min(1.0 / (pair.value + pair.error));
        Ok(Least { above: self.share * above, below: self.share * below })
    }

    fn system(&mut self) -> Result<&mut System, SolveError> {
        let made = if let Some(system) = self.system.take() {
            system
        } else {
            let StepOperator { problem, discrete, .. } = self.step;
            let layout = Layout::of(&problem.mesh, &discrete.v, &discrete.boundary.nodes);
            System::new(&problem.backend, &self.less, &layout)?
        };
        Ok(self.system.insert(made))
    }
}

/// Subtracts [`MARGIN`] of its diagonal from a matrix. A factor includes it; products in the form of differences do not
/// use the diagonal and remain those of the original matrix.
fn less_margin(mut matrix: BlockMatrix) -> BlockMatrix {
    let (components, _) = matrix.block_shape();
    for node in 0..matrix.graph().len() {
        let mut block = vec![0.0; components * components];
        for c in 0..components {
            block[c * components + c] = -MARGIN * matrix.get(node, c, node, c);
        }
        matrix.add(&[node as u32], &block);
    }
    matrix
}

/// x·Kx of the matrix K from which `less` was made.
fn energy(less: &BlockMatrix, x: &[f64]) -> f64 {
    let product = dot(x, &less.apply(x));
    if less.is_of_differences() {
        return product;
    }
    let (components, _) = less.block_shape();
    let diagonal = |i: usize| less.get(i / components, i % components, i / components, i % components);
    let margin: f64 = x.iter().enumerate().map(|(i, x)| diagonal(i) * x * x).sum();
    product + MARGIN / (1.0 - MARGIN) * margin
}

/// True if a matrix minus [`MARGIN`] of its diagonal has a Cholesky factor on the free degrees of freedom of a space.
fn is_positive_definite(problem: &Problem, space: &Space, matrix: BlockMatrix) -> Result<bool, SolveError> {
    let less = Arc::new(less_margin(matrix));
    problem.backend.is_positive_definite(&less, &Layout::of(&problem.mesh, space, &[]))
}

/// True if a linear form is positive definite beyond round-off on the free displacements.
pub(super) fn holds_the_body(
    problem: &Problem,
    discrete: &Discretization,
    form: &BlockMatrix,
) -> Result<bool, SolveError> {
    is_positive_definite(problem, &discrete.v, form.clone())
}

/// True if θ_n acts on w_n within the same step by expansion or by moduli, as in couplings other than the paper's.
pub(super) fn heat_acts_at_once(problem: &Problem) -> bool {
    let softens = || problem.materials.iter().any(Material::laws_depend_on_temperature);
    let is_solved = problem.physics.has_heat() && problem.couples_mutually();
    is_solved && (largest_norm(problem, |m| &m.expansion) > 0.0 || softens())
}

/// A property of the laws that the condition does not cover, and its place.
fn not_judged(problem: &Problem, at_start: bool, drops: bool) -> Option<(&'static str, &'static str)> {
    let with_friction = || problem.contacts.iter().any(|contact| !contact.friction.is_frictionless());
    if drops {
        Some((
            "the pressure drops from one value to another: a step across the drop may have several solutions, however short it is",
            "contact.normal",
        ))
    } else if at_start {
        Some((
            "friction drops when slip starts: a point loaded between kinetic and static friction has two solutions in a step of any length; the run follows the state of the previous step",
            "contact.friction",
        ))
    } else if problem.contacts.iter().any(|contact| contact.wear.is_some()) {
        Some(("wear within a step lowers the pressure with the slip speed, which is not checked", "contact.wear"))
    } else if with_friction() && tested(problem).any(|test| test.rate_matters()) {
        Some(("friction that depends on a rate-dependent pressure is not checked", "contact.normal"))
    } else if problem.couples_mutually() && with_friction() && tested(problem).any(|test| test.friction_sees_heat()) {
        Some((
            "u_n and θ_n are solved together and friction depends on θ_n: the condition holds for a step with given θ",
            "contact.friction",
        ))
    } else {
        None
    }
}

/// The system to test, or the finding that explains why there is none.
fn prepare<'a>(
    problem: &'a Problem,
    discrete: &Arc<Discretization>,
    id: FindingId,
) -> Result<StepOperator<'a>, Box<Finding>> {
    if problem.contacts.is_empty() {
        return Err(Box::new(Finding::new(
            id,
            FindingStatus::Holds,
            "there is no contact: a step is monotone",
            "contact",
        )));
    }
    let falls = falls(problem);
    if let Some((message, place)) =
        not_judged(problem, falls.iter().any(|f| f.at_start > 0.0), falls.iter().any(|f| f.pressure.is_infinite()))
    {
        return Err(Box::new(Finding::new(id, FindingStatus::NotCovered, message, place)));
    }
    let losses = problem
        .contacts
        .iter()
        .zip(&falls)
        .map(|(contact, falls)| Some([loss(contact, falls.pressure)?, falls.with_speed]));
    let Some(losses) = losses.collect::<Option<Vec<[f64; 2]>>>() else {
        let message = "the condition is known for laws with Lipschitz constants L_ν, L_τ only: see (H8)";
        return Err(Box::new(
            Finding::new(id, FindingStatus::NotCovered, message, "contact")
                .repair("normal compliance with a stiffness, or no friction"),
        ));
    };
    if heat_acts_at_once(problem) {
        let message = "u_n and θ_n are solved together: the condition holds for a step with given θ";
        return Err(Box::new(Finding::new(id, FindingStatus::NotCovered, message, "material.expansion")));
    }
    let is_warm =
        |m: &Material| !m.conductivity.temperatures().is_empty() || !m.heat_capacity.temperatures().is_empty();
    if problem.materials.iter().any(is_warm) {
        let message = "conductivity or heat capacity depend on the temperature: the heat equation of a step is not linear, and how many solutions it has is not checked";
        return Err(Box::new(Finding::new(id, FindingStatus::NotCovered, message, "material")));
    }
    let step = StepOperator::new(problem, discrete, &losses);
    match step.heat_is_definite() {
        Ok(true) => Ok(step),
        Ok(false) => {
            let message = "the heat equation of a step is not positive definite, and the theory does not say how many solutions it has";
            Err(Box::new(
                Finding::new(id, FindingStatus::NotCovered, message, "material.conductivity")
                    .repair("a heat capacity, or a prescribed temperature"),
            ))
        }
        Err(error) => Err(Box::new(not_factorized(id, &error))),
    }
}

/// The unit that follows a number: ` Pa`, or empty in a dimensionless case.
fn suffix(units: Units, measure: Measure) -> String {
    format!(" {}", units.of(measure)).trim_end().to_owned()
}

/// The verdict if friction decreases with the slip speed by f p and the condition holds without that: a step has one
/// solution as long as f p < λ_min − c* k. No bound of the pressure is known before the run.
fn up_to_a_pressure(id: FindingId, found: f64, needed: f64, with_speed: f64, steps: f64, units: Units) -> Finding {
    let (most, unit) = ((found - needed) / with_speed, suffix(units, Measure::Stress));
    let message = format!(
        "with {steps} steps each step has one solution as long as the pressure is below {most:.6e}{unit}, because friction that decreases with the slip speed uses up the rest of λ_min(S, W) = {found:.4}: no bound of the pressure is known beforehand. For the pressure alone the condition holds, since {found:.4} exceeds {needed:.4}. A run halves the steps that may leave the branch of the previous step, and counts those that halving does not resolve in solver.ambiguous_steps"
    );
    Finding::new(id, FindingStatus::NotCovered, message, "contact.friction")
}

fn not_factorized(id: FindingId, error: &SolveError) -> Finding {
    Finding::new(
        id,
        FindingStatus::NotCovered,
        format!("the mechanical system of a step cannot be factorized: {error}"),
        "boundary",
    )
}

/// The finding if K_u is not positive definite, as Theorem 2 requires.
fn not_held(id: FindingId) -> Finding {
    let message = "the mechanical system of a step is not positive definite beyond round-off: only contact holds the body in some direction, which the theory does not cover";
    Finding::new(id, FindingStatus::NotCovered, message, "boundary").repair(
        "add a support, a density, or springs that are weaker than the body by at most twelve orders of magnitude",
    )
}

/// `step-unique`: λ_min(S, W) > c* k.
pub(super) fn unique(problem: &Problem, discrete: &Arc<Discretization>) -> Finding {
    let id = FindingId::StepUnique;
    prepare(problem, discrete, id)
        .map_or_else(|finding| *finding, |step| judge(&step, id).unwrap_or_else(|error| not_factorized(id, &error)))
}

/// The condition for the longest steps of each analysis, the first that does not hold if there is one: λ_min/k
/// does not decrease with decreasing k.
fn judge(step: &StepOperator, id: FindingId) -> Result<Finding, SolveError> {
    let timeline = &step.problem.timeline;
    let mut found: Option<Finding> = None;
    for longest in timeline.longest_steps() {
        let mut finding = judge_steps(step, &longest, id)?;
        if let Some(phase) = timeline.phase_of(longest.n) {
            let Instant { k, analysis, phase: number, .. } = longest;
            let (name, unit) = (analysis.name(), suffix(step.problem.units(), Measure::Time));
            finding.message +=
                &format!("; judged for the longest {name} steps, {k:.6e}{unit}, of the phase \"{}\"", phase.name);
            if finding.place == "time.steps" {
                finding.place = format!("phase[{number}].steps");
            }
        }
        let margin = |finding: &Finding| finding.value.unwrap_or(0.0) / finding.needed.unwrap_or(0.0);
        let is_worse = |before: &Finding| before.holds() && !(finding.holds() && margin(before) <= margin(&finding));
        if found.as_ref().is_none_or(is_worse) {
            found = Some(finding);
        }
    }
    Ok(found.unwrap_or_else(|| not_held(id)))
}

fn judge_steps(step: &StepOperator, longest: &Instant, id: FindingId) -> Result<Finding, SolveError> {
    let k = longest.k;
    let needed = step.loss * k;
    let mut at = step.at(longest.analysis, k);
    let holds = at.dominates(step.loss)?;
    if !holds && !at.dominates(0.0)? {
        return Ok(not_held(id));
    }
    let Least { above: found, below } = at.least()?;
    let numbers = |finding: Finding| {
        finding.numbers(Some(found), Some(needed)).repair("more steps: `check` names a number in time-step")
    };
    // In a steady step no slip speed depends on the solution.
    if holds && step.with_speed > 0.0 && longest.analysis != Analysis::Steady {
        return Ok(numbers(up_to_a_pressure(
            id,
            below,
            needed,
            step.with_speed,
            step.problem.timeline.steps() as f64,
            step.problem.units(),
        )));
    }
    let (status, message) = if holds {
        let message = format!(
            "each step has one solution, and it depends continuously on the data: λ_min(S, W) = {found:.4}, which exceeds the {needed:.4} that the contact laws require"
        );
        (FindingStatus::Holds, message)
    } else if found <= needed {
        let message = format!(
            "the condition that ensures one solution of a step does not hold: λ_min(S, W) = {found:.4}, and the contact laws require {needed:.4}. The condition is sufficient, not necessary: a step has a solution and may have only one"
        );
        (FindingStatus::Fails, message)
    } else {
        let message = format!(
            "λ_min(S, W) = {found:.4} and the {needed:.4} that the contact laws require differ by less than round-off"
        );
        (FindingStatus::NotCovered, message)
    };
    Ok(numbers(Finding::new(id, status, message, "time.steps")))
}

/// `time-step`: the least number of steps, the case's own or that times a power of two, for which `step-unique` holds.
/// Results of the finding `unique` are reused.
pub(super) fn time_step(
    problem: &Problem,
    forms: &dyn Fn() -> Arc<Discretization>,
    unique: Option<&Finding>,
) -> Finding {
    let id = FindingId::TimeStep;
    match unique {
        Some(Finding { status: FindingStatus::Holds, value: Some(_), .. }) => {
            enough(problem, problem.timeline.steps() as f64)
        }
        // Without numbers it repeats the statement of `prepare`.
        Some(told @ Finding { status: FindingStatus::Holds, .. }) => Finding { id, ..told.clone() },
        _ => prepare(problem, &forms(), id)
            .map_or_else(|finding| *finding, |step| search(&step).unwrap_or_else(|error| not_factorized(id, &error))),
    }
}

/// The finding that this number of steps ensures one solution per step.
fn enough(problem: &Problem, steps: f64) -> Finding {
    let is_enough = steps <= problem.timeline.steps() as f64;
    let (k, unit) = (problem.timeline.end() / steps, suffix(problem.units(), Measure::Time));
    if problem.timeline.has_phases() {
        let times = steps / problem.timeline.steps() as f64;
        let message = if is_enough {
            "with the steps of the phases each step has one solution".to_owned()
        } else {
            format!("with {times} times as many steps in each phase, or more, each step has one solution")
        };
        return Finding::new(FindingId::TimeStep, FindingStatus::of(is_enough), message, "phase")
            .numbers(Some(problem.timeline.steps() as f64), Some(steps))
            .repair(format!("{times} times the `steps` of each [[phase]]"));
    }
    let message = if is_enough {
        format!("with {steps} steps, k = {k:.6e}{unit}, each step has one solution")
    } else {
        format!(
            "with {steps} steps, k = {k:.6e}{unit}, or more, each step has one solution; the case has {}",
            problem.timeline.steps()
        )
    };
    Finding::new(FindingId::TimeStep, FindingStatus::of(is_enough), message, "time.steps")
        .numbers(Some(problem.timeline.steps() as f64), Some(steps))
        .repair(format!("time.steps = {steps}"))
}

/// The worst of the searches for the longest steps of each analysis.
fn search(step: &StepOperator) -> Result<Finding, SolveError> {
    let mut found: Option<Finding> = None;
    for longest in step.problem.timeline.longest_steps() {
        let finding = search_from(step, &longest)?;
        let steps = |finding: &Finding| finding.needed.unwrap_or(f64::INFINITY);
        if found.as_ref().is_none_or(|before| steps(&finding) > steps(before)) {
            found = Some(finding);
        }
    }
    Ok(found.unwrap_or_else(|| not_held(FindingId::TimeStep)))
}

fn search_from(step: &StepOperator, longest: &Instant) -> Result<Finding, SolveError> {
    let (id, problem, analysis) = (FindingId::TimeStep, step.problem, longest.analysis);
    let steps = |doubling: u32| problem.timeline.steps() as f64 * f64::from(1u32 << doubling);
    let k = |doubling: u32| longest.k / f64::from(1u32 << doubling);
    let mut doubling = 0;
    let mut at = step.at(analysis, k(0));
    let mut found = at.dominates(step.loss)?;
    if !found && !at.dominates(0.0)? {
        return Ok(not_held(id));
    }
    // λ_min/k does not decrease with decreasing k: if the shortest step of the search fails, all do.
    if !found && step.at(analysis, k(DOUBLINGS)).least()?.above > step.loss * k(DOUBLINGS) {
        while !found && doubling < DOUBLINGS {
            doubling += 1;
            at = step.at(analysis, k(doubling));
            found = at.dominates(step.loss)?;
        }
    }
    if !found {
        let message = "no number of steps was found that ensures one solution of a step";
        return Ok(Finding::new(id, FindingStatus::NotCovered, message, "time.steps")
            .numbers(Some(problem.timeline.steps() as f64), None)
            .repair("inertia, viscosity, a smaller coefficient of friction, or a law that softens less"));
    }
    let (steps, k) = (steps(doubling), k(doubling));
    if step.with_speed == 0.0 || analysis == Analysis::Steady {
        return Ok(enough(problem, steps));
    }
    Ok(up_to_a_pressure(id, at.least()?.below, step.loss * k, step.with_speed, steps, problem.units())
        .numbers(Some(problem.timeline.steps() as f64), Some(steps)))
}
