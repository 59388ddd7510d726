//! The phases of a run.

use super::analysis::Analysis;

/// A phase of a run: equal steps up to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct TimePhase {
    /// Its name; empty for the only phase of a run without phases.
    pub name: String,
    /// Time at its end, s.
    pub end: f64,
    /// Number of its steps.
    pub steps: usize,
    /// What of the equations acts.
    pub analysis: Analysis,
}

impl TimePhase {
    /// A dynamic phase up to `end` in s, in equal steps.
    #[must_use]
    pub fn dynamic(name: impl Into<String>, end: f64, steps: usize) -> TimePhase {
        TimePhase { name: name.into(), end, steps, analysis: Analysis::Dynamic }
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
}
