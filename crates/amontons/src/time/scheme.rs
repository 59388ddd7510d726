//! The schemes of a run.

use super::Rule;

/// A scheme in time: it states the rule of its steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TimeScheme {
    /// Backward Euler, of first order and dissipative.
    #[default]
    BackwardEuler,
    /// The ϑ-scheme, ½ ≤ ϑ ≤ 1.
    Theta(f64),
}

impl TimeScheme {
    /// The rule of a step of length `k` in s.
    #[must_use]
    pub fn rule(&self, k: f64) -> Rule {
        match *self {
            TimeScheme::BackwardEuler => Rule::backward_euler(k),
            TimeScheme::Theta(theta) => Rule::theta(k, theta),
        }
    }

    /// The name of the scheme.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            TimeScheme::BackwardEuler => "backward Euler",
            TimeScheme::Theta(_) => "ϑ-scheme",
        }
    }
}
