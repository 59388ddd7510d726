//! The rule in time: how the unknown of a step enters displacements and accelerations.

/// u = ū + γ w and ẇ = (w − w̄)/δ, w the unknown velocity of the step. Backward Euler has γ = δ = k with ū = u_{n−1}
/// and w̄ = w_{n−1}.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// γ in s.
    pub gamma: f64,
    /// δ in s.
    pub delta: f64,
}

impl Rule {
    /// Backward Euler with the step length k.
    #[must_use]
    pub fn backward_euler(k: f64) -> Rule {
        Rule { gamma: k, delta: k }
    }
}
