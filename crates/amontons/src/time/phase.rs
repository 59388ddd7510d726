//! The phases of a run.

use std::sync::Arc;

use super::analysis::Analysis;

/// Number of steps of an automatic phase, as a power of two, beyond which no step is shorter.
pub(super) const DEEPEST: u32 = 32;
/// A step of an automatic phase is at most its 2^−3.
pub(super) const LONGEST: u32 = 3;

/// The steps of a phase.
#[derive(Clone, Debug, PartialEq)]
pub enum Steps {
    /// So many equal steps.
    Equal(usize),
    /// Steps that follow from an accuracy: the sum of their estimated errors over the phase, relative to the largest
    /// norm of the solution, 0 < accuracy ≤ 0.1.
    Automatic {
        /// The accuracy.
        accuracy: f64,
    },
    /// The steps that a run with automatic ones made: the places of their ends, in 2^−33 of the phase.
    Made(Arc<[u64]>),
}

impl Steps {
    /// Largest accuracy.
    pub const COARSEST: f64 = 0.1;

    /// The accuracy of automatic steps.
    #[must_use]
    pub fn accuracy(&self) -> Option<f64> {
        match self {
            Steps::Equal(_) | Steps::Made(_) => None,
            Steps::Automatic { accuracy } => Some(*accuracy),
        }
    }

    /// Number of equal steps; of automatic ones that of the steps with which the phase begins if they are long enough.
    /// Estimates before a run take it for the number of steps.
    #[must_use]
    pub fn nominal(&self) -> usize {
        match self {
            Steps::Equal(steps) => *steps,
            Steps::Automatic { accuracy } => 1 << first_level(*accuracy),
            Steps::Made(ends) => ends.len(),
        }
    }

    /// Steps of a 1/`parts` of the length, or of the accuracy.
    #[must_use]
    pub fn refined(&self, parts: usize) -> Steps {
        match self {
            Steps::Equal(steps) => Steps::Equal(steps * parts),
            Steps::Automatic { accuracy } => Steps::Automatic { accuracy: accuracy / parts.max(1) as f64 },
            Steps::Made(ends) => {
                let starts = std::iter::once(0).chain(ends.iter().copied());
                let of = |(start, end): (u64, &u64)| {
                    let length = end - start;
                    (1..=parts as u64).map(move |part| start + length * part / parts as u64)
                };
                Steps::Made(starts.zip(ends.iter()).flat_map(of).collect())
            }
        }
    }
}

/// An automatic phase begins with at most its 2^−level: a step of first order that moves the solution by its whole size
/// over the phase has an error of about its share of the phase.
pub(super) fn first_level(accuracy: f64) -> u32 {
    // A number without logarithm is refused with the problem.
    let level = -accuracy.clamp(f64::EPSILON, 1.0).log2().floor();
    (level as u32).clamp(LONGEST, DEEPEST - 2)
}

/// A phase of a run: steps up to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct TimePhase {
    /// Its name; empty for the only phase of a run without phases.
    pub name: String,
    /// Time at its end, s.
    pub end: f64,
    /// Its steps.
    pub steps: Steps,
    /// What of the equations acts.
    pub analysis: Analysis,
}

impl TimePhase {
    /// A dynamic phase up to `end` in s, in equal steps.
    #[must_use]
    pub fn dynamic(name: impl Into<String>, end: f64, steps: usize) -> TimePhase {
        TimePhase { name: name.into(), end, steps: Steps::Equal(steps), analysis: Analysis::Dynamic }
    }

    /// A quasistatic phase up to `end` in s, in equal steps.
    #[must_use]
    pub fn quasistatic(name: impl Into<String>, end: f64, steps: usize) -> TimePhase {
        TimePhase { analysis: Analysis::Quasistatic, ..TimePhase::dynamic(name, end, steps) }
    }

    /// A steady phase up to `end` in s, in equal steps.
    #[must_use]
    pub fn steady(name: impl Into<String>, end: f64, steps: usize) -> TimePhase {
        TimePhase { analysis: Analysis::Steady, ..TimePhase::dynamic(name, end, steps) }
    }

    /// The phase with steps that follow from an accuracy.
    #[must_use]
    pub fn automatic(self, accuracy: f64) -> TimePhase {
        TimePhase { steps: Steps::Automatic { accuracy }, ..self }
    }
}
