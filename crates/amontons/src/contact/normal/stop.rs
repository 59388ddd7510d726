//! A compliant layer with a rigid stop inside: normal compliance with a bounded penetration.
//!
//! Source: J. Jarušek, M. Sofonea, "On the solvability of dynamic elastic-visco-plastic contact problems", ZAMM 88
//! (2008) 3–22.

use super::{GraphKind, NormalLaw, Pressure};
use crate::tensor::Point;

/// p = c r₊ for r < depth; any p ≥ c depth at r = depth; the penetration cannot exceed depth.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// c ≥ 0 in Pa/m.
    pub stiffness: f64,
    /// Penetration in m at which the stop acts.
    pub depth: f64,
}

impl NormalLaw for Stop {
    fn pressure(&self, _x: &Point, z: f64, _rate: f64, lambda: f64) -> Pressure {
        let factor = 1.0 + self.stiffness * lambda;
        if z <= 0.0 {
            Pressure::default()
        } else if z <= factor * self.depth {
            let slope = self.stiffness / factor;
            Pressure { value: slope * z, slope, by_rate: 0.0 }
        } else {
            Pressure { value: (z - self.depth) / lambda, slope: 1.0 / lambda, by_rate: 0.0 }
        }
    }
    fn potential(&self, _x: &Point, r: f64) -> f64 {
        // A penetration beyond the stop is round-off.
        0.5 * self.stiffness * r.clamp(0.0, self.depth).powi(2)
    }
    fn lipschitz(&self) -> Option<f64> {
        None
    }
    fn graph(&self) -> GraphKind {
        GraphKind::Multivalued
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn NormalLaw>, f64)> {
    vec![
        (std::sync::Arc::new(Stop { stiffness: 1e4, depth: 1e-4 }), 2e-4),
        (std::sync::Arc::new(Stop { stiffness: 0.0, depth: 0.3 }), 0.5),
    ]
}
