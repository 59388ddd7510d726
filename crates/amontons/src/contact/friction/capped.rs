//! A friction bound limited by a shear strength.
//!
//! Source: E. Orowan, "The calculation of roll pressure in hot and cold flat rolling", Proc. Inst. Mech. Engrs 150
//! (1943) 140–167.

use std::sync::Arc;

use super::{Bound, Cone, FrictionLaw};
use crate::contact::ContactPoint;
use crate::tensor::Point;

/// p_τ = min(s, τ_max), s the bound of another law: with Coulomb's, the law of Coulomb and Orowan.
#[derive(Clone, Debug)]
pub struct Capped {
    /// The law below the cap.
    pub law: Arc<dyn FrictionLaw>,
    /// τ_max ≥ 0 in Pa.
    pub cap: f64,
}

impl FrictionLaw for Capped {
    fn bound(&self, at: &ContactPoint) -> Bound {
        let bound = self.law.bound(at);
        if bound.value <= self.cap { bound } else { Bound { value: self.cap, ..Bound::default() } }
    }
    fn lipschitz(&self, l_nu: Option<f64>) -> Option<f64> {
        self.law.lipschitz(l_nu)
    }
    fn least_slope(&self, at: &ContactPoint, from: f64, to: f64) -> f64 {
        self.law.least_slope(at, from, to)
    }
    fn drops_from_rest(&self) -> bool {
        self.law.drops_from_rest()
    }
    fn is_frictionless(&self) -> bool {
        self.cap == 0.0 || self.law.is_frictionless()
    }
    fn cone(&self, x: &Point, nu: &Point) -> Option<Cone> {
        self.law.cone(x, nu)
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<Arc<dyn FrictionLaw>> {
    let coulomb: Arc<dyn FrictionLaw> = Arc::new(super::Coulomb { coefficient: 0.3 });
    vec![Arc::new(Capped { law: coulomb, cap: 0.7 })]
}
