//! Power-law compliance p = c r₊^m.
//!
//! Source: J. A. C. Martins, J. T. Oden, "Existence and uniqueness results for dynamic contact problems with nonlinear
//! normal and friction interface laws", Nonlinear Analysis 11 (1987) 407–428; m = 3/2 is Hertz' sphere.

use super::{NormalLaw, Pressure};
use crate::tensor::Point;

/// p = c r₊^m.
#[derive(Clone, Debug, PartialEq)]
pub struct Power {
    /// c ≥ 0 in Pa/m^m.
    pub stiffness: f64,
    /// m ≥ 1.
    pub exponent: f64,
}

impl NormalLaw for Power {
    fn pressure(&self, _x: &Point, z: f64, _rate: f64, _lambda: f64) -> Pressure {
        if z <= 0.0 {
            return Pressure::default();
        }
        let slope = self.stiffness * z.powf(self.exponent - 1.0);
        Pressure { value: slope * z, slope: self.exponent * slope, by_rate: 0.0 }
    }
    fn potential(&self, _x: &Point, r: f64) -> f64 {
        self.stiffness * r.max(0.0).powf(self.exponent + 1.0) / (self.exponent + 1.0)
    }
    fn lipschitz(&self) -> Option<f64> {
        // For m > 1 slopes are unbounded.
        (self.exponent <= 1.0).then_some(self.stiffness)
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn NormalLaw>, f64)> {
    vec![
        (std::sync::Arc::new(Power { stiffness: 1e4, exponent: 1.0 }), 1e-4),
        (std::sync::Arc::new(Power { stiffness: 1e9, exponent: 1.5 }), 1e-3),
        (std::sync::Arc::new(Power { stiffness: 2.0, exponent: 2.7 }), 3.0),
    ]
}
