//! The rules of the steps of a problem.

use super::ProblemData;
use crate::mass::MassMatrix;
use crate::time::{Analysis, Rule};

impl ProblemData {
    /// The rule of a step of length `k` in s that follows on one of the same length.
    #[must_use]
    pub fn rule(&self, analysis: Analysis, k: f64) -> Rule {
        self.with_mass(analysis.rule(self.scheme, k))
    }

    /// The rule of a step of length `k` in s with no step of the same length before it.
    #[must_use]
    pub fn starting_rule(&self, analysis: Analysis, k: f64) -> Rule {
        self.with_mass(analysis.starting_rule(self.scheme, k))
    }

    fn with_mass(&self, rule: Rule) -> Rule {
        match self.mass {
            MassMatrix::Consistent => rule,
            MassMatrix::Redistributed => rule.with_massless_contact(),
        }
    }
}
