//! Tresca's law: a bound that is given.

use super::{Bound, FrictionLaw};
use crate::contact::ContactPoint;

/// p_τ = s, on all of Γ_C and whatever the pressure: the problem with given friction, which is a minimum problem.
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
        // Over an open gap it is not zero, as (H8) has it.
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
