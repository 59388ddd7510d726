//! Coulomb's law, and no friction.

use super::{Bound, FrictionLaw};
use crate::contact::ContactPoint;

/// No friction: p_τ = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Frictionless;

impl FrictionLaw for Frictionless {
    fn bound(&self, _at: &ContactPoint) -> Bound {
        Bound::default()
    }
    fn lipschitz(&self, _l_nu: Option<f64>) -> Option<f64> {
        Some(0.0)
    }
    fn is_frictionless(&self) -> bool {
        true
    }
}

/// Coulomb's law p_τ = μ p_ν.
#[derive(Clone, Debug, PartialEq)]
pub struct Coulomb {
    /// μ_τ ≥ 0.
    pub coefficient: f64,
}

impl FrictionLaw for Coulomb {
    fn bound(&self, at: &ContactPoint) -> Bound {
        Bound { value: self.coefficient * at.pressure, by_pressure: self.coefficient, ..Bound::default() }
    }
    fn lipschitz(&self, l_nu: Option<f64>) -> Option<f64> {
        l_nu.map(|l| self.coefficient * l)
    }
    fn is_frictionless(&self) -> bool {
        self.coefficient == 0.0
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<std::sync::Arc<dyn FrictionLaw>> {
    use std::sync::Arc;
    vec![Arc::new(Frictionless), Arc::new(Coulomb { coefficient: 0.2 }), Arc::new(Coulomb { coefficient: 1.5 })]
}
