//! How far a run with automatic steps is, and what the choice of its next step needs.

use serde::{Deserialize, Serialize};

use super::phase::{DEEPEST, LONGEST};

/// Quantities of which the error of a step is estimated.
pub const GAUGED: usize = 3;
/// Share of a budget that is spread evenly over the phase; the rest is for transitions.
const SPREAD: f64 = 0.5;
/// Share of a budget of which a step may take its part even if the error before has used up all of it. Where a point
/// stops or meets the foundation a step adds an error in proportion to its length, and none would be short enough.
const LEAST: f64 = 0.01;

/// How far a run is whose steps are not all equal in their phases. In other runs it stays as it is at t = 0.
///
/// A step of an automatic phase goes from i/2^j of the phase to (i + 1)/2^j. So only a few step lengths exist, and two
/// integers say where it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pace {
    /// The last step of each phase that is over.
    pub ends: Vec<usize>,
    /// Length of the last step, s.
    pub k: f64,
    /// Place in an automatic phase, in 2^−32 of it.
    pub at: u64,
    /// The next step of an automatic phase is tried with 2^−level of it.
    pub level: u32,
    /// What the steps of an automatic phase may be wrong by.
    pub budget: Budget,
    /// What was chosen so far.
    pub chosen: ChosenSteps,
}

/// Steps that were chosen in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChosenSteps {
    /// Number of chosen steps.
    pub made: usize,
    /// Number of steps that were tried and made anew with a shorter length.
    pub rejected: usize,
    /// Number of steps that were solved with one length alone, so that nothing is known of their error.
    pub unjudged: usize,
    /// Length of the shortest of them, s.
    pub shortest: f64,
    /// Length of the longest of them, s.
    pub longest: f64,
    /// Largest estimated error of a phase, relative to the largest norm that the solution had reached: the largest one
    /// of all phases.
    pub error: f64,
    /// The same over the accuracy of its phase. It is more than 1 where the solution itself makes errors grow.
    pub over_accuracy: f64,
}

/// The budget of the phase: for each quantity the error stays below the accuracy times the largest norm so far.
///
/// Errors are known from a second run with steps of twice the length: its difference to this one is the error that
/// there is, without what the body has forgotten of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Budget {
    /// Largest norms: of the solution so far, and of what it comes to in a few long steps from the start of a phase.
    pub scale: [f64; GAUGED],
    /// Largest norms of the solution so far.
    pub reached: [f64; GAUGED],
    /// Norms of the error at the place.
    pub error: [f64; GAUGED],
    /// Largest norms of the error in this phase.
    pub largest: [f64; GAUGED],
}

/// The errors of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepErrors {
    /// Norms of the error that the step adds.
    pub own: [f64; GAUGED],
    /// Norms at the end of the step of the error that was there at its start.
    pub left: [f64; GAUGED],
    /// Norms of the error at the end of the step.
    pub all: [f64; GAUGED],
}

/// The largest of both, number by number.
fn larger(a: [f64; GAUGED], b: [f64; GAUGED]) -> [f64; GAUGED] {
    std::array::from_fn(|i| a[i].max(b[i]))
}

impl StepErrors {
    /// What a next step of twice the length is expected to have, in a scheme of this order.
    #[must_use]
    pub fn of_twice_the_length(&self, before: [f64; GAUGED], order: i32) -> StepErrors {
        let keeps = |i: usize| if before[i] > self.left[i] { (self.left[i] / before[i]).powi(2) } else { 1.0 };
        let own = self.own.map(|own| 2.0f64.powi(order + 1) * own);
        StepErrors { own, left: std::array::from_fn(|i| self.all[i] * keeps(i)), all: self.all }
    }
}

impl Budget {
    /// The budget for a solution with these norms.
    #[must_use]
    pub fn at(mut self, norms: [f64; GAUGED]) -> Budget {
        self.reached = larger(self.reached, norms);
        self.expecting(norms)
    }

    /// The budget for a solution that will have these norms.
    #[must_use]
    pub fn expecting(mut self, norms: [f64; GAUGED]) -> Budget {
        self.scale = larger(self.scale, norms);
        self
    }

    /// The largest error that a step adds over what it may add: half of the budget times its share of the phase, and a
    /// part of what is free of the budget at its end.
    ///
    /// So the error stays about within the budget, and a short transition takes steps that are not tiny. The part is
    /// what the body forgets of the error in the step, or one over the number of steps that a scheme of this order
    /// needs for a motion over the phase: then they are about as many as steps with equal errors, of which no other
    /// steps need fewer.
    #[must_use]
    pub fn ratio(&self, errors: &StepErrors, accuracy: f64, order: i32, [start, share]: [f64; 2]) -> f64 {
        let takes = accuracy.powf(f64::from(order).recip());
        let of = |i: usize| {
            let (own, left) = (errors.own[i], errors.left[i]);
            let all = accuracy * self.scale[i];
            let forgets = if self.error[i] > left { 1.0 - left / self.error[i] } else { 0.0 };
            let free = (all * (1.0 - SPREAD + SPREAD * start) - left).max(LEAST * all);
            let allowed = SPREAD * all * share + takes.max(forgets) * free;
            if own <= allowed { own / allowed.max(f64::MIN_POSITIVE) } else { (own / allowed).min(f64::MAX) }
        };
        (0..GAUGED).map(of).fold(0.0, f64::max)
    }

    /// The budget after a step with these errors.
    #[must_use]
    pub fn after(mut self, errors: &StepErrors) -> Budget {
        self.error = errors.all;
        self.largest = larger(self.largest, errors.all);
        self
    }

    /// The largest error, relative to the largest norm that the solution reached.
    fn relative(&self) -> f64 {
        let of = |i: usize| if self.largest[i] > 0.0 { self.largest[i] / self.reached[i] } else { 0.0 };
        (0..GAUGED).map(of).fold(0.0, f64::max)
    }
}

impl Pace {
    /// Number of lengths that a step may have, 2^−level of its phase.
    pub const LEVELS: u32 = DEEPEST;

    /// The place behind a step of 2^−level of an automatic phase. The next step may have another level.
    #[must_use]
    pub(super) fn behind(&self, level: u32) -> u64 {
        self.at + (1 << (DEEPEST - level))
    }

    /// The share of an automatic phase at the place.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.at as f64 / (1u64 << DEEPEST) as f64
    }

    /// True if a step of twice the length of 2^−level begins here and is not too long.
    #[must_use]
    pub fn may_grow(&self, level: u32) -> bool {
        level > LONGEST && self.at.is_multiple_of(1 << (DEEPEST - level + 1))
    }

    /// Notes a chosen step.
    #[must_use]
    pub fn noted(mut self, k: f64, rejected: usize) -> Pace {
        let ChosenSteps { made, shortest, longest, .. } = self.chosen;
        self.chosen = ChosenSteps {
            made: made + 1,
            rejected: self.chosen.rejected + rejected,
            shortest: if made == 0 { k } else { shortest.min(k) },
            longest: longest.max(k),
            ..self.chosen
        };
        self
    }

    /// The place at the start of the next phase, after step `n`, with which a phase of this accuracy ends.
    #[must_use]
    pub(super) fn at_end(mut self, n: usize, accuracy: Option<f64>) -> Pace {
        self.ends.push(n);
        let (error, ChosenSteps { error: before, over_accuracy, .. }) = (self.budget.relative(), self.chosen);
        self.chosen.error = before.max(error);
        self.chosen.over_accuracy = over_accuracy.max(accuracy.map_or(0.0, |accuracy| error / accuracy));
        (self.budget.error, self.budget.largest) = ([0.0; GAUGED], [0.0; GAUGED]);
        Pace { at: 0, level: 0, ..self }
    }
}
