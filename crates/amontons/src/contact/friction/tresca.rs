//! Tresca's law: a given friction bound.

use super::{Bound, FrictionLaw};
use crate::contact::ContactPoint;

/// p_τ = s on all of Γ_C, independent of the pressure: the problem with given friction, a minimum problem.
///
/// Source: G. Duvaut, J.-L. Lions, "Les inéquations en mécanique et en physique", Dunod (1972), chapter 3.
#[derive(Clone, Debug, PartialEq)]
pub struct Tresca {
    /// s ≥ 0 in Pa.
    pub bound: f64,
}

impl FrictionLaw for Tresca {
    fn bound(&self, _at: &ContactPoint) -> Bound {
        Bound { value: self.bound, ..Bound::default() }
    }
    fn lipschitz(&self, _l_nu: Option<f64>) -> Option<f64> {
        // On an open gap it is not zero, contrary to (H8).
        (self.bound == 0.0).then_some(0.0)
    }
    fn is_frictionless(&self) -> bool {
        self.bound == 0.0
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<std::sync::Arc<dyn FrictionLaw>> {
    vec![std::sync::Arc::new(Tresca { bound: 0.7 })]
}
