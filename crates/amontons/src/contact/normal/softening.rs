//! A softening layer: a pressure that is not monotone, as in hemivariational models.
//!
//! Source: S. Migórski, A. Ochal, M. Sofonea, "Nonlinear Inclusions and Hemivariational Inequalities", Springer (2013),
//! section 6.3.

use super::{NormalLaw, Pressure};
use crate::tensor::Point;

/// p = c r₊ up to the peak, then decreasing with the slope −s to the residual pressure, which remains.
#[derive(Clone, Debug, PartialEq)]
pub struct Softening {
    /// c > 0 in Pa/m.
    pub stiffness: f64,
    /// Largest pressure in Pa.
    pub peak: f64,
    /// s > 0 in Pa/m.
    pub softening: f64,
    /// Residual pressure in Pa, at most the peak.
    pub residual: f64,
}

impl Softening {
    /// Penetrations at the peak and at the start of the residual pressure.
    fn corners(&self) -> [f64; 2] {
        let top = self.peak / self.stiffness;
        [top, top + (self.peak - self.residual) / self.softening]
    }
}

impl NormalLaw for Softening {
    fn pressure(&self, _x: &Point, z: f64, _rate: f64, _lambda: f64) -> Pressure {
        let [top, end] = self.corners();
        let (value, slope) = if z <= 0.0 {
            (0.0, 0.0)
        } else if z <= top {
            (self.stiffness * z, self.stiffness)
        } else if z < end {
            (self.peak - self.softening * (z - top), -self.softening)
        } else {
            (self.residual, 0.0)
        };
        Pressure { value, slope, by_rate: 0.0 }
    }
    fn potential(&self, _x: &Point, r: f64) -> f64 {
        let [top, end] = self.corners();
        let (rising, falling, after) = (r.clamp(0.0, top), (r - top).clamp(0.0, end - top), (r - end).max(0.0));
        0.5 * self.stiffness * rising * rising
            + falling * (self.peak - 0.5 * self.softening * falling)
            + self.residual * after
    }
    fn least_slope(&self, _x: &Point, from: f64, to: f64) -> f64 {
        let [top, end] = self.corners();
        if to > top && from < end {
            -self.softening
        } else if from > 0.0 && to <= top {
            self.stiffness
        } else {
            0.0
        }
    }
    fn lipschitz(&self) -> Option<f64> {
        Some(self.stiffness.max(self.softening))
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn NormalLaw>, f64)> {
    vec![(std::sync::Arc::new(Softening { stiffness: 1e4, peak: 2.0, softening: 5e3, residual: 0.5 }), 4e-4)]
}
