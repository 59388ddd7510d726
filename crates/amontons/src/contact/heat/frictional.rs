//! Frictional heat.
//!
//! Source: F. F. Ling, "Surface Mechanics", Wiley (1973), chapter 2: a share η of the power of friction enters one
//! body, 1 − η the other.

use super::{FRICTION, Flux, HeatLaw};
use crate::contact::ContactPoint;

/// q·ν = −η q·w_τ, w_τ the slip against the foundation: the share η of the friction power enters the body.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionalHeat {
    /// η from 0 to 1.
    pub partition: f64,
}

impl HeatLaw for FrictionalHeat {
    fn flux(&self, at: &ContactPoint) -> Flux {
        Flux { value: -self.partition * at.friction_power, by_friction_power: -self.partition, ..Flux::default() }
    }
    fn mechanism(&self) -> Option<&'static str> {
        Some(FRICTION)
    }
    fn conductance_bound(&self) -> f64 {
        0.0
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        Some(0.0)
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn HeatLaw>, f64)> {
    vec![(std::sync::Arc::new(FrictionalHeat { partition: 0.4 }), 1e-3)]
}
