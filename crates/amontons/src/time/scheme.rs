//! The schemes of a run.

use super::analysis::Analysis;
use super::rule::{ContactRule, Rule, Start};

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
    /// BDF2, of second order, which damps what oscillates within few steps. It starts with a step of backward Euler.
    Bdf2,
    /// Contact-stabilised Newmark: the ϑ-scheme at ϑ = ½ from velocities that take no point into a rigid foundation,
    /// with positions that are met exactly.
    ContactStabilised,
}

impl TimeScheme {
    /// The ϑ-scheme with impacts without rebound, pressures that keep the energy of layers, and friction of the mean.
    #[must_use]
    pub fn theta(level: f64) -> TimeScheme {
        TimeScheme::Theta { level, contact: ContactRule::default() }
    }

    /// The rule of a step of length `k` in s that follows on one of the same length.
    #[must_use]
    pub fn rule(&self, k: f64) -> Rule {
        match *self {
            TimeScheme::BackwardEuler => Rule::backward_euler(k),
            TimeScheme::Theta { level, contact } => Rule::theta(k, level, contact),
            TimeScheme::Bdf2 => Rule::bdf2(k),
            TimeScheme::ContactStabilised => Rule::contact_stabilised(k),
        }
    }

    /// The rule of a step of length `k` in s with no step of the same length before it.
    #[must_use]
    pub fn starting_rule(&self, k: f64) -> Rule {
        let rule = self.rule(k);
        match rule.start {
            Start::State | Start::Admissible => rule,
            Start::TwoStates => Rule::backward_euler(k),
        }
    }

    /// The name of the scheme.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            TimeScheme::BackwardEuler => "backward Euler",
            TimeScheme::Theta { .. } => "ϑ-scheme",
            TimeScheme::Bdf2 => "BDF2",
            TimeScheme::ContactStabilised => "contact-stabilised Newmark scheme",
        }
    }
}

impl Analysis {
    /// The rule of a step of length `k` in s that follows on one of the same length: that of the scheme, or backward
    /// Euler without inertia, or that of a steady step. Without inertia the ϑ-scheme with ϑ < 1 would keep every
    /// deviation from balance, with the other sign after each step.
    #[must_use]
    pub fn rule(self, scheme: TimeScheme, k: f64) -> Rule {
        match self {
            Analysis::Dynamic => scheme.rule(k),
            Analysis::Quasistatic => Rule { analysis: self, ..Rule::backward_euler(k) },
            Analysis::Steady => Rule::steady(k),
        }
    }

    /// The rule of a step of length `k` in s with no step of the same length before it.
    #[must_use]
    pub fn starting_rule(self, scheme: TimeScheme, k: f64) -> Rule {
        match self {
            Analysis::Dynamic => scheme.starting_rule(k),
            Analysis::Quasistatic | Analysis::Steady => self.rule(scheme, k),
        }
    }
}
