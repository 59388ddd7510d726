//! Normal compliance p_ν(r) = c_ν r₊ of section 5.

use super::{NormalLaw, Pressure};
use crate::tensor::Point;

/// Normal compliance p_ν(r) = c_ν r₊ of section 5.
#[derive(Clone, Debug, PartialEq)]
pub struct Compliance {
    /// c_ν in Pa/m.
    pub stiffness: f64,
}

impl NormalLaw for Compliance {
    fn pressure(&self, _x: &Point, z: f64, _rate: f64, lambda: f64) -> Pressure {
        // p = c (z − λ p)  ⇒  p = c z / (1 + c λ).
        let slope = self.stiffness / (1.0 + self.stiffness * lambda);
        if z > 0.0 { Pressure { value: slope * z, slope, by_rate: 0.0 } } else { Pressure::default() }
    }
    fn potential(&self, _x: &Point, r: f64) -> f64 {
        0.5 * self.stiffness * r.max(0.0).powi(2)
    }
    fn lipschitz(&self) -> Option<f64> {
        Some(self.stiffness)
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn NormalLaw>, f64)> {
    vec![
        (std::sync::Arc::new(Compliance { stiffness: 1e4 }), 1e-4),
        (std::sync::Arc::new(Compliance { stiffness: 3.0e12 }), 1e-6),
    ]
}
