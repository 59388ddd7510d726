//! Adhesion: a layer that pulls up to a bound and then releases.
//!
//! Source: P. D. Panagiotopoulos, "Hemivariational Inequalities", Springer (1993), section 1.4: reversible, without
//! damage.

use super::{NormalLaw, Pressure};
use crate::tensor::Point;

/// p = c r for r ≥ −δ₀, δ₀ = strength/c; at wider gaps the tension decreases to zero, linearly over the length
/// `release`, or at once if `release` is 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Adhesion {
    /// c > 0 in Pa/m.
    pub stiffness: f64,
    /// Largest tension in Pa.
    pub strength: f64,
    /// Further opening in m over which the tension decreases to zero, ≥ 0.
    pub release: f64,
}

impl NormalLaw for Adhesion {
    fn pressure(&self, _x: &Point, z: f64, _rate: f64, _lambda: f64) -> Pressure {
        let bond = self.strength / self.stiffness;
        let (value, slope) = if z >= -bond {
            (self.stiffness * z, self.stiffness)
        } else if z > -bond - self.release {
            let slope = self.strength / self.release;
            (-slope * (z + bond + self.release), -slope)
        } else {
            (0.0, 0.0)
        };
        Pressure { value, slope, by_rate: 0.0 }
    }
    fn potential(&self, _x: &Point, r: f64) -> f64 {
        let bond = self.strength / self.stiffness;
        let (held, left) = (r.max(-bond), (r + bond + self.release).max(0.0));
        let released = if r < -bond && self.release > 0.0 {
            0.5 * self.strength * (self.release - left * left / self.release)
        } else {
            0.0
        };
        0.5 * self.stiffness * held * held + released
    }
    fn least_slope(&self, _x: &Point, from: f64, to: f64) -> f64 {
        let bond = self.strength / self.stiffness;
        if from >= -bond {
            self.stiffness
        } else if to <= -bond - self.release || self.strength == 0.0 {
            0.0
        } else if self.release > 0.0 {
            -self.strength / self.release
        } else {
            f64::NEG_INFINITY
        }
    }
    fn lipschitz(&self) -> Option<f64> {
        (self.strength == 0.0 || self.release > 0.0)
            .then(|| self.stiffness.max(self.strength / self.release.max(f64::MIN_POSITIVE)))
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn NormalLaw>, f64)> {
    vec![
        (std::sync::Arc::new(Adhesion { stiffness: 1e4, strength: 1.0, release: 1e-4 }), 2e-4),
        (std::sync::Arc::new(Adhesion { stiffness: 1e4, strength: 1.0, release: 0.0 }), 2e-4),
    ]
}
