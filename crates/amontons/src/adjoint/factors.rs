//! The matrices of a step at its solution.

use super::error::GradientError;
use super::instance::{ProblemInstance, data, deformation, driving, follows, is_coupled};
use crate::discretization::Discretization;
use crate::equation::system::{HalfStep, Step};
use crate::inclusion::Chosen;
use crate::linalg::{BlockMatrix, Krylov, SolveError, Tangent, gmres, max_abs, zeros};
use crate::space::Space;
use crate::state::State;
use crate::time::{Rule, Start};

/// Largest number of solutions for what is left of the equations. Each leaves a fraction of it that is at most of the
/// order of what is added to the equations of contact points.
pub(super) const REPETITIONS: usize = 3;
/// What is left of equations, relative to their largest term, that is round-off.
pub(super) const ROUNDED: f64 = 64.0 * f64::EPSILON;
/// What iterations leave of equations, the most that they may leave, and their number.
const LEFT: f64 = 1e-10;
const SOLVED: f64 = 1e-8;
const PRODUCTS: usize = 200;

/// A matrix with its factor. If the matrix is not symmetric, the factor is that of its symmetric part.
pub(super) struct Factored {
    pub half: HalfStep,
    pub matrix: BlockMatrix,
    pub is_symmetric: bool,
    /// The largest magnitude of an entry.
    pub largest: f64,
}

/// The matrices of both half-steps with their factors.
pub(super) struct StepFactors {
    pub rule: Rule,
    /// The phase whose conditions the matrices have.
    phase: usize,
    /// `None` if the problem has not this half-step.
    pub mechanics: Option<Factored>,
    pub heat: Option<Factored>,
    pub slopes: BodySlopes,
    /// True if heat follows the displacement of the step, and if mechanics has the temperature of the step, too.
    pub follows: bool,
    pub is_coupled: bool,
}

/// Derivatives of the forms of the bodies at a step that the matrices of its half-steps do not hold; `None` where forms
/// are linear, and are their own derivatives.
#[derive(Default)]
pub(super) struct BodySlopes {
    /// Of a(u, ·) in u.
    elastic: Option<BlockMatrix>,
    /// Of the right-hand side of (4.1) in the temperature.
    force: Option<BlockMatrix>,
    /// Of the stored heat that a step adds to, in the temperatures at its start and one step before.
    stored: Option<[Option<BlockMatrix>; 2]>,
}

impl Factored {
    fn new(half: HalfStep, matrix: BlockMatrix, is_symmetric: bool) -> Factored {
        let largest = matrix.largest();
        Factored { half, matrix, is_symmetric, largest }
    }

    /// The solution of equations with a contact term, from a first value with the prescribed ones, and what is left of
    /// them; `apply` is the product with the matrix and the term.
    pub fn solved(
        &mut self,
        space: &Space,
        tangent: &Tangent,
        (mut x, right): (Vec<f64>, &[f64]),
        apply: impl Fn(&BlockMatrix, &[f64]) -> Vec<f64>,
    ) -> Result<[Vec<f64>; 2], SolveError> {
        let Factored { half, matrix, is_symmetric, largest } = self;
        let mut nearly = |mut forces: Vec<f64>| {
            solvable(space, &mut forces);
            half.system.linearised(tangent, &forces)
        };
        let left = |product: Vec<f64>| -> Vec<f64> {
            right.iter().zip(product).map(|(right, product)| right - product).collect()
        };
        let mut rest = left(apply(matrix, &x));
        for repetition in 0..REPETITIONS {
            let mut more = nearly(rest.clone())?;
            if !*is_symmetric {
                more = iterated(|v: &[f64]| nearly(apply(matrix, v)), &more, repetition)?;
            }
            x.iter_mut().zip(&more).for_each(|(x, more)| *x += more);
            rest = left(apply(matrix, &x));
            let mut unmet = rest.clone();
            solvable(space, &mut unmet);
            if max_abs(&unmet) <= ROUNDED * *largest * max_abs(&x) {
                break;
            }
        }
        Ok([x, rest])
    }
}

/// The solution of A x = b by products with A. What later repetitions are asked for is round-off, and may stay so.
fn iterated(
    apply: impl FnMut(&[f64]) -> Result<Vec<f64>, SolveError>,
    b: &[f64],
    repetition: usize,
) -> Result<Vec<f64>, SolveError> {
    let Krylov { x, iterations, residual, .. } = gmres(apply, b, LEFT, PRODUCTS)?;
    if repetition == 0 && (residual.is_nan() || residual > SOLVED) {
        return Err(SolveError::NotConverged { size: b.len(), iterations, residual });
    }
    Ok(x)
}

/// The solution of x = `right` + T x.
pub(super) fn coupled(
    right: &[f64],
    mut through: impl FnMut(&[f64]) -> Result<Vec<f64>, SolveError>,
) -> Result<Vec<f64>, SolveError> {
    let mut left = |x: &[f64]| -> Result<Vec<f64>, SolveError> {
        Ok(x.iter().zip(through(x)?).map(|(x, through)| x - through).collect())
    };
    let (mut x, mut rest) = (zeros(right.len()), right.to_vec());
    for repetition in 0..REPETITIONS {
        let more = iterated(&mut left, &rest, repetition)?;
        x.iter_mut().zip(&more).for_each(|(x, more)| *x += more);
        rest = right.iter().zip(left(&x)?).map(|(right, product)| right - product).collect();
    }
    Ok(x)
}

/// Gathers forces at the degrees of freedom that are solved for; zero at the prescribed ones.
pub(super) fn solvable(space: &Space, forces: &mut [f64]) {
    space.gather(forces);
    space.mask(forces);
}

impl BodySlopes {
    fn new(step: &Step, at: &State) -> BodySlopes {
        let (discrete, rule) = (step.discrete, step.rule);
        let (u, theta) = (deformation(step, &at.w), driving(step, &at.theta));
        let warmed = discrete.warmed(&theta);
        BodySlopes {
            elastic: discrete.elastic_tangent(&u, &warmed),
            force: discrete.mechanical_slope(&u, &step.rates(&at.w), &theta),
            stored: discrete.capacity_form(&step.old.theta).map(|start| stored(step, rule, &at.theta, start)),
        }
    }

    /// The derivative of a(u, ·) in u times a vector. It is symmetric.
    pub fn elastic(&self, discrete: &Discretization, of: &[f64]) -> Vec<f64> {
        self.elastic.as_ref().map_or_else(|| discrete.apply_linear_a(of), |elastic| elastic.apply(of))
    }

    /// The change of the right-hand side of (4.1) with that of the temperature.
    pub fn force(&self, discrete: &Discretization, theta: &[f64]) -> Vec<f64> {
        self.force.as_ref().unwrap_or(&discrete.m).apply(theta)
    }

    /// The transposed of [`BodySlopes::force`].
    pub fn force_transposed(&self, discrete: &Discretization, y: &[f64]) -> Vec<f64> {
        self.force.as_ref().unwrap_or(&discrete.m).apply_transposed(y)
    }

    /// The change of the stored heat over δ that a step adds to, with the temperatures θ̄, θ₀ and θ₋₁.
    pub fn stored(&self, step: &Step, bar: &[f64], [start, before]: [&[f64]; 2]) -> Vec<f64> {
        let (scale, form) = step.discrete.storage();
        let mut sum = match &self.stored {
            None => form.apply(bar),
            Some([of_start, of_before]) => {
                let mut sum = of_start.as_ref().map_or_else(Vec::new, |form| form.apply(start));
                if let Some(form) = of_before {
                    sum.iter_mut().zip(form.apply(before)).for_each(|(sum, more)| *sum += more);
                }
                sum
            }
        };
        for stored in &mut sum {
            *stored *= scale / step.rule.delta;
        }
        sum
    }

    /// The transposed of [`BodySlopes::stored`]: of θ̄, θ₀ and θ₋₁.
    pub fn stored_transposed(&self, step: &Step, heat: &[f64]) -> [Option<Vec<f64>>; 3] {
        let (scale, form) = step.discrete.storage();
        let of = |form: &BlockMatrix| {
            let product = form.apply(heat).into_iter();
            product.map(|product| scale / step.rule.delta * product).collect()
        };
        match &self.stored {
            None => [Some(of(form)), None, None],
            Some([start, before]) => [None, start.as_ref().map(of), before.as_ref().map(of)],
        }
    }
}

/// The derivatives of the stored heat H̄ that a step adds to, with the capacity at its start. In a step before whose
/// end the equations hold, it is that of H₀ + ϑ (H₁ − H₀) − H₀ with θ₁ = θ₀ + (θ_ϑ − θ₀)/ϑ.
fn stored(step: &Step, rule: Rule, at: &[f64], start: BlockMatrix) -> [Option<BlockMatrix>; 2] {
    let discrete = step.discrete;
    match (rule.start, &step.old.earlier) {
        (Start::TwoStates, Some(earlier)) => {
            let before = discrete.capacity_form(&earlier.theta);
            [Some(start.scaled(4.0 / 3.0)), before.map(|before| before.scaled(-1.0 / 3.0))]
        }
        _ if rule.is_at_end() => [Some(start), None],
        _ => {
            let mut matrix = start.scaled(rule.level);
            if let Some(end) = discrete.capacity_form(&step.end(&step.old.theta, at.to_vec())) {
                matrix.add_scaled(1.0 - rule.level, &end);
            }
            [Some(matrix), None]
        }
    }
}

impl StepFactors {
    /// The factors of a step n from a state, with w and θ at the time of its equations.
    pub fn new(
        base: &ProblemInstance,
        (n, old, at): (usize, &State, &State),
    ) -> Result<StepFactors, (&'static str, SolveError)> {
        let ProblemInstance { problem, discrete, .. } = base;
        base.step(n, old, |step| {
            let mechanics = problem.physics.has_mechanics().then(|| mechanics(step, at)).transpose();
            let heat = problem.physics.has_heat().then(|| heat(step, &at.theta)).transpose();
            Ok(StepFactors {
                rule: step.rule,
                phase: problem.phase(),
                mechanics: mechanics.map_err(|source| ("mechanics", source))?,
                heat: heat.map_err(|source| ("heat", source))?,
                slopes: if discrete.is_constant() { BodySlopes::default() } else { BodySlopes::new(step, at) },
                follows: follows(step),
                is_coupled: is_coupled(step),
            })
        })
    }

    /// The factors of step n: those of another step, if they are constant and it has the same rule.
    pub fn kept_or_made(
        factors: Option<StepFactors>,
        base: &ProblemInstance,
        (n, old, at): (usize, &State, &State),
    ) -> Result<StepFactors, GradientError> {
        let rule = base.rule(n, old);
        let is_same = |factors: &StepFactors| {
            factors.rule == rule && base.problem.has_same_conditions([factors.phase, base.problem.phase()])
        };
        if let Some(factors) = factors.filter(|factors| base.discrete.is_constant() && is_same(factors)) {
            return Ok(factors);
        }
        let made = StepFactors::new(base, (n, old, at));
        made.map_err(|(part, source)| GradientError::Linear { step: n, part, source })
    }

    /// The unknown of each degree of freedom of the contact nodes.
    pub fn on_contact(&self) -> Vec<Option<u32>> {
        self.mechanics.as_ref().map_or_else(Vec::new, |of| of.half.on_contact.clone())
    }

    /// What the iteration on Γ_C chooses in the step.
    pub fn chosen(&self, base: &ProblemInstance, n: usize, [old, new]: [&State; 2]) -> Chosen {
        let Some(Factored { half, .. }) = &self.mechanics else { return Chosen::default() };
        base.step(n, old, |step| {
            let given = data(step, new);
            let term = given.term(step, &half.system, &half.on_contact);
            term.map_or_else(Chosen::default, |term| term.chosen())
        })
    }
}

/// K_u with the tangents of laws that are not linear.
fn mechanics(step: &Step, at: &State) -> Result<Factored, SolveError> {
    let discrete = step.discrete;
    let matrix = if discrete.is_linear() {
        discrete.mechanical_matrix(step.rule)
    } else {
        let (u, theta) = (deformation(step, &at.w), driving(step, &at.theta));
        discrete.mechanical_tangent(step.rule, &u, &step.rates(&at.w), &discrete.warmed(&theta))
    };
    let half = HalfStep::new(matrix.clone(), discrete, &discrete.v, &step.problem.backend)?;
    Ok(Factored::new(half, matrix, true))
}

/// The derivative of (4.2) in the temperature at the time of its equations.
fn heat(step: &Step, theta: &[f64]) -> Result<Factored, SolveError> {
    let (discrete, rule) = (step.discrete, step.rule);
    let factored = |matrix: BlockMatrix| HalfStep::new(matrix, discrete, &discrete.q, &step.problem.backend);
    if discrete.conducts_linearly() {
        let matrix = discrete.thermal_matrix(rule);
        return Ok(Factored::new(factored(matrix.clone())?, matrix, true));
    }
    let end = step.end(&step.old.theta, theta.to_vec());
    let symmetric = discrete.thermal_tangent_with(rule, [theta, &end]);
    let mut matrix = symmetric.clone();
    let slope = discrete.thermal_slope(theta);
    if let Some(slope) = &slope {
        matrix.add_scaled(1.0, slope);
    }
    Ok(Factored::new(factored(symmetric)?, matrix, slope.is_none()))
}
