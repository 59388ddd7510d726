//! The schemes of a run.

use super::analysis::Analysis;
use super::rule::{ContactRule, Rule};

/// A scheme in time: it states the rule of its steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TimeScheme {
    /// Backward Euler, of first order and dissipative.
    #[default]
    BackwardEuler,
    /// The ϑ-scheme, ½ ≤ ϑ ≤ 1.
    Theta {
        /// ϑ.
        level: f64,
        /// How the laws of contact hold in a step.
        contact: ContactRule,
    },
}

impl TimeScheme {
    /// The ϑ-scheme with impacts without rebound, pressures that keep the energy of layers, and friction of the mean.
    #[must_use]
    pub fn theta(level: f64) -> TimeScheme {
        TimeScheme::Theta { level, contact: ContactRule::default() }
    }

    /// The rule of a step of length `k` in s.
    #[must_use]
    pub fn rule(&self, k: f64) -> Rule {
        match *self {
            TimeScheme::BackwardEuler => Rule::backward_euler(k),
            TimeScheme::Theta { level, contact } => Rule::theta(k, level, contact),
        }
    }

    /// The name of the scheme.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            TimeScheme::BackwardEuler => "backward Euler",
            TimeScheme::Theta { .. } => "ϑ-scheme",
        }
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
}
