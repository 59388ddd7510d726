//! The phases of a run.

use serde::{Deserialize, Serialize};

use super::{Rule, TimeScheme};

/// A phase of a run: equal steps up to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct TimePhase {
    /// Its name; empty for the only phase of a run without phases.
    pub name: String,
    /// Time at its end, s.
    pub end: f64,
    /// Number of its steps.
    pub steps: usize,
    /// Whether inertia acts.
    pub analysis: Analysis,
}

/// The equations of motion of a phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Analysis {
    /// With inertia.
    #[default]
    Dynamic,
    /// Without the inertia term of (2.3): the body is in balance at the end of each step.
    Quasistatic,
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
}

impl Analysis {
    /// The rule of a step of length `k` in s: that of the scheme, or backward Euler without inertia. Without inertia
    /// the ϑ-scheme with ϑ < 1 would keep every deviation from balance, with the other sign after each step.
    #[must_use]
    pub fn rule(self, scheme: TimeScheme, k: f64) -> Rule {
        match self {
            Analysis::Dynamic => scheme.rule(k),
            Analysis::Quasistatic => Rule { analysis: self, ..Rule::backward_euler(k) },
        }
    }

    /// Its name in the case file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Analysis::Dynamic => "dynamic",
            Analysis::Quasistatic => "quasistatic",
        }
    }
}
