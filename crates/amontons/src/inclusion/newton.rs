//! The semismooth Newton iteration for S (x − x̂) + Σ ω Nᵀ f = r on Γ_C, f the contact forces that a term makes of x
//! and its multipliers.
//!
//! **Globalisation.** After a first full step, which leaves the pattern of the guess, steps are halved until the
//! residual decreases; where that ends at a kink, a full step leaves it.

use super::loose::Jumps;
use super::residual::{grown, is_small};
use super::{NotConverged, SHORTEST_STEP, TOLERANCE};
use crate::contact::Status;
use crate::linalg::{Condensed, SolveError, Spring, Tangent, max_abs};
use crate::pulse::Pulse;

/// Residual of the linear systems relative to the one before, where they are solved by an iteration: the part of what
/// the residual has to fall by, and the least that is asked for at once.
const SHARE: f64 = 0.1;
const ENOUGH: f64 = 1e-5;
/// Residual that is none, N: below it numbers lose digits, and no residual is small beside the largest term.
const NOTHING: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// A nonsmooth term on Γ_C: laws at contact points with multipliers.
pub(super) trait Term {
    /// The multipliers of all points.
    type Multipliers: Clone;
    /// The laws of all points at an iterate.
    type Laws;

    /// Evaluates the laws.
    fn laws(&self, x: &[f64], multipliers: &Self::Multipliers) -> Self::Laws;
    /// Σ ω Nᵀ f, f the multipliers.
    fn forces(&self, laws: &Self::Laws, out: &mut [f64]);
    /// Differences between the multipliers and their values by the laws, as forces.
    fn defects(&self, laws: &Self::Laws) -> Vec<f64>;
    /// The largest round-off of a term of the laws, as a force.
    fn round_off(&self, x: &[f64], laws: &Self::Laws) -> f64;
    /// True if the error of the laws besides the defects is as small as the residual must be.
    fn is_sharp(&self, _x: &[f64], _laws: &Self::Laws, _tolerance: f64) -> bool {
        true
    }
    /// The linearised laws: J = Σ ω Nᵀ T N; takes Σ ω Nᵀ f at an unchanged x off `right`.
    fn linearise(&self, laws: &Self::Laws, right: &mut [f64]) -> Tangent;
    /// The multipliers of the linearised laws after the step δx.
    fn after(&self, laws: &Self::Laws, before: &Self::Multipliers, step: &[f64]) -> Self::Multipliers;
    /// The multipliers a part α of the way from one to another.
    fn towards(from: &Self::Multipliers, to: &Self::Multipliers, alpha: f64) -> Self::Multipliers;
    /// Sets the statuses assumed before the first iteration.
    fn begin(&self, _laws: &mut Self::Laws, _multipliers: &Self::Multipliers) {}
    /// The multipliers of an iterate that has converged: those that the laws make of them.
    fn settled(&self, x: &[f64], laws: &Self::Laws, multipliers: Self::Multipliers) -> Self::Multipliers;
    /// The states of the points.
    fn states(&self, laws: &Self::Laws) -> Vec<Status>;
    /// Points whose states differ between the last iterates, and those where the equations, which lack `errors`, and
    /// the laws are left the farthest from holding; the worst first, with these states.
    fn unsettled(&self, _laws: &Self::Laws, _errors: &[f64]) -> Vec<(usize, Vec<Status>)> {
        Vec::new()
    }
}

/// S (x − x̂) + Σ ω Nᵀ f = r: the increment is solved for, so that the round-off of the sweeps is relative to the
/// change within a step and not to x.
#[derive(Clone)]
pub(super) struct Right<'a> {
    pub r: &'a [f64],
    pub guess: &'a [f64],
    /// β and the anchor of a proximal term β diag(S) (x − anchor).
    pub proximal: Option<(f64, Vec<f64>)>,
    /// True if the step is solved again for the remaining round-off. Round-off of any size then ends the iteration.
    pub is_repeated: bool,
    /// Springs that hold undetermined motions at rest.
    pub springs: &'a [Spring],
    /// The rigid motions that S does not resist to the last bit, or `None` if they are not known.
    pub rigid: Option<&'a Jumps>,
    /// Receives the progress of each iteration, if there is an observer.
    pub pulse: Option<&'a Pulse>,
}

impl Right<'_> {
    /// S x, without what round-off makes of rigid motions.
    pub fn product(&self, condensed: &dyn Condensed, mut x: Vec<f64>) -> Result<Vec<f64>, SolveError> {
        let Some(rigid) = self.rigid else { return condensed.apply(&x) };
        rigid.take_off(&mut x);
        let mut product = condensed.apply(&x)?;
        rigid.take_off(&mut product);
        Ok(product)
    }

    /// True if a residual is within the round-off of S (x − x̂) and small relative to the largest term: a sum of n
    /// terms has √n/2 of their last bits, and never less than one.
    pub fn is_round_off(
        &self,
        condensed: &dyn Condensed,
        x: &[f64],
        [residual, scale]: [f64; 2],
    ) -> Result<bool, SolveError> {
        let sizes = self.sizes(x);
        let bits = f64::EPSILON * (0.5 * (x.len() as f64).sqrt()).max(1.0);
        if residual > bits * condensed.magnitude_bound(&sizes) {
            return Ok(false);
        }
        let here = bits * condensed.magnitude(&sizes)?;
        let excused = self.excused(here, scale, || Ok(bits * condensed.magnitude(&self.sizes(self.guess))?))?;
        Ok(residual <= here.min(excused))
    }

    /// The round-off that may excuse a residual: all of it where it is small beside the largest term, else no more than
    /// a few times that of the guess. An iterate that runs away, as where nothing holds a body, has a round-off that
    /// exceeds everything that acts on the body, and would always be a solution.
    fn excused(
        &self,
        here: f64,
        scale: f64,
        at_guess: impl FnOnce() -> Result<f64, SolveError>,
    ) -> Result<f64, SolveError> {
        if is_small(here, scale) || self.is_repeated { Ok(here) } else { Ok(grown(at_guess()?)) }
    }

    /// |x| + |x̂|: x − x̂ is a difference of larger numbers.
    fn sizes(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(self.guess).map(|(x, guess)| x.abs() + guess.abs()).collect()
    }

    /// Round-off of S (x − x̂) by the last bits of x and x̂, if the residual may be as small.
    fn round_off(&self, condensed: &dyn Condensed, x: &[f64], residual: f64) -> Result<f64, SolveError> {
        let sizes = self.sizes(x);
        // A residual beyond the bound is no round-off, whatever the product, which costs as much as S (x − x̂).
        if residual > f64::EPSILON * condensed.magnitude_bound(&sizes) {
            Ok(0.0)
        } else {
            Ok(f64::EPSILON * condensed.magnitude(&sizes)?)
        }
    }
}

/// Values on Γ_C and multipliers.
#[derive(Clone)]
pub(super) struct Iterate<M> {
    pub x: Vec<f64>,
    pub multipliers: M,
}

/// An iterate with what is left of the equations.
pub(super) struct Evaluation<T: Term> {
    pub at: Iterate<T::Multipliers>,
    pub laws: T::Laws,
    /// r − S (x − x̂).
    rest: Vec<f64>,
    /// Euclidean norm of the errors.
    norm: f64,
    pub residual: f64,
    pub scale: f64,
    tolerance: f64,
    is_sharp: bool,
}

impl<T: Term> Evaluation<T> {
    /// Evaluates an iterate.
    pub fn new(
        term: &T,
        condensed: &dyn Condensed,
        right: &Right,
        at: Iterate<T::Multipliers>,
    ) -> Result<Evaluation<T>, SolveError> {
        let x = &at.x;
        let laws = term.laws(x, &at.multipliers);
        let increment: Vec<f64> = x.iter().zip(right.guess).map(|(x, guess)| x - guess).collect();
        let inner = right.product(condensed, increment)?;
        let mut forces = vec![0.0; x.len()];
        term.forces(&laws, &mut forces);
        let scale = max_abs(&inner).max(max_abs(&forces)).max(max_abs(right.r));
        let mut rest: Vec<f64> = right.r.iter().zip(&inner).map(|(r, inner)| r - inner).collect();
        if let Some((beta, anchor)) = &right.proximal {
            for (i, rest) in rest.iter_mut().enumerate() {
                *rest -= beta * condensed.scale()[i] * (x[i] - anchor[i]);
            }
        }
        right.springs.iter().for_each(|spring| spring.add(-spring.motion(x), &mut rest));
        let defects = term.defects(&laws);
        let mut errors = Vec::with_capacity(forces.len() + defects.len());
        errors.extend(forces.iter().zip(&rest).map(|(force, rest)| force - rest));
        errors.extend_from_slice(&defects);
        let residual = max_abs(&errors);
        // Scaled, so that squares neither under- nor overflow.
        let norm = if residual > 0.0 {
            residual * errors.iter().map(|e| (e / residual).powi(2)).sum::<f64>().sqrt()
        } else {
            0.0
        };
        let tight = (TOLERANCE * scale).max(NOTHING);
        let tolerance = if residual > tight {
            let noise = |x: &[f64], laws: &T::Laws, residual: f64| -> Result<f64, SolveError> {
                Ok(right.round_off(condensed, x, residual)?.max(f64::EPSILON * term.round_off(x, laws)))
            };
            let here = noise(x, &laws, residual)?;
            let at_guess = || noise(right.guess, &term.laws(right.guess, &at.multipliers), 0.0);
            tight.max(if residual <= here { here.min(right.excused(here, scale, at_guess)?) } else { here })
        } else {
            tight
        };
        let is_sharp = residual > tolerance || term.is_sharp(x, &laws, tight);
        Ok(Evaluation { at, laws, rest, norm, residual, scale, tolerance, is_sharp })
    }

    /// True if the residual is within the tolerance and the laws are accurate enough.
    pub fn converged(&self) -> bool {
        self.residual <= self.tolerance && self.is_sharp
    }

    /// The end of an iteration that has converged.
    fn end(self, term: &T, iterations: usize) -> Outcome<T::Multipliers> {
        let Iterate { x, multipliers } = self.at;
        let multipliers = term.settled(&x, &self.laws, multipliers);
        Outcome { end: Iterate { x, multipliers }, iterations, failure: None }
    }

    /// The end of an iteration that has not.
    fn fail(self, term: &T, iterations: usize) -> Outcome<T::Multipliers> {
        let mut errors = vec![0.0; self.at.x.len()];
        term.forces(&self.laws, &mut errors);
        errors.iter_mut().zip(&self.rest).for_each(|(error, rest)| *error -= rest);
        let failure = NotConverged {
            iterations,
            residual: self.residual / self.scale,
            states: term.states(&self.laws),
            unsettled: term.unsettled(&self.laws, &errors),
        };
        Outcome { end: self.at, iterations, failure: Some(failure) }
    }
}

/// Limits of an iteration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Full steps that the residual does not decide on, the first among them.
    pub leaps: usize,
    /// True if every step is accepted whatever the residual.
    pub is_free: bool,
    /// Most iterations.
    pub iterations: usize,
    /// Relative residual that is enough; zero for what the round-off leaves.
    pub enough: f64,
}

/// Result of an iteration.
pub(super) struct Outcome<M> {
    pub end: Iterate<M>,
    pub iterations: usize,
    /// Reason why it has not converged, or `None` if it has.
    pub failure: Option<NotConverged>,
}

/// Newton's method from an iterate.
pub(super) fn iterate<T: Term>(
    term: &T,
    condensed: &mut dyn Condensed,
    right: &Right,
    start: Iterate<T::Multipliers>,
    effort: &Effort,
) -> Result<Outcome<T::Multipliers>, SolveError> {
    let mut now = Evaluation::<T>::new(term, condensed, right, start)?;
    let (mut left, mut leap) = (effort.leaps.saturating_sub(1), effort.leaps > 0);
    for iteration in 0..effort.iterations {
        if now.converged() || now.residual <= effort.enough * now.scale {
            return Ok(now.end(term, iteration));
        }
        right.pulse.into_iter().for_each(Pulse::iterate);
        if iteration == 0 {
            term.begin(&mut now.laws, &now.at.multipliers);
        }
        let Some(step) = newton_step(term, condensed, right, &now)? else {
            // Nothing holds the body at this iterate, as where all points are open; a proximal step does.
            return Ok(now.fail(term, iteration + 1));
        };
        let after = term.after(&now.laws, &now.at.multipliers, &step);
        let mut alpha = 1.0;
        loop {
            let x = now.at.x.iter().zip(&step).map(|(x, step)| x + alpha * step).collect();
            let multipliers = T::towards(&now.at.multipliers, &after, alpha);
            let trial = Evaluation::new(term, condensed, right, Iterate { x, multipliers })?;
            if trial.converged()
                || trial.norm < now.norm * (1.0 - 5e-5 * alpha)
                || ((leap || effort.is_free) && trial.norm.is_finite())
            {
                (now, leap) = (trial, false);
                break;
            }
            alpha *= 0.5;
            if alpha < SHORTEST_STEP {
                if now.residual <= now.tolerance
                    || right.is_round_off(condensed, &now.at.x, [now.residual, now.scale])?
                {
                    return Ok(now.end(term, iteration));
                }
                if left == 0 {
                    return Ok(now.fail(term, iteration + 1));
                }
                (left, leap, alpha) = (left - 1, true, 1.0);
            }
        }
    }
    Ok(now.fail(term, effort.iterations))
}

/// Solution δx of (S + J) δx = r − S (x − x̂) − Σ ω Nᵀ f, with f of the linearised laws, or `None` if the matrix is
/// singular.
fn newton_step<T: Term>(
    term: &T,
    condensed: &mut dyn Condensed,
    right: &Right,
    now: &Evaluation<T>,
) -> Result<Option<Vec<f64>>, SolveError> {
    let mut step = now.rest.clone();
    let mut tangent = term.linearise(&now.laws, &mut step);
    if let Some((beta, _)) = right.proximal {
        tangent.add_diagonal(condensed.scale().iter().map(|scale| beta * scale));
    }
    // As far as the residual has to fall, but not further than a step with an unchanged contact pattern goes.
    let enough = (SHARE * now.tolerance / now.residual).max(ENOUGH);
    match condensed.solve(&tangent, &mut step, enough) {
        Ok(()) => Ok(Some(step)),
        Err(SolveError::Singular { .. } | SolveError::NotConverged { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}
