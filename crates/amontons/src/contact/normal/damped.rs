//! Damped response: the pressure also depends on the rate of the penetration.
//!
//! Sources: M. Shillor, M. Sofonea, J. J. Telega, "Models and Analysis of Quasistatic Contact", Springer (2004),
//! section 2.6 (linear damped response); K. H. Hunt, F. R. E. Crossley, "Coefficient of restitution interpreted as
//! damping in vibroimpact", J. Appl. Mech. 42 (1975) 440–445.

use super::{NormalLaw, Power, Pressure};
use crate::tensor::Point;

/// A spring and a dashpot in parallel without tension: p = (c r + d ṙ)₊ for r > 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Damped {
    /// c ≥ 0 in Pa/m.
    pub stiffness: f64,
    /// d ≥ 0 in Pa s/m.
    pub damping: f64,
}

impl NormalLaw for Damped {
    fn pressure(&self, _x: &Point, z: f64, rate: f64, _lambda: f64) -> Pressure {
        let value = self.stiffness * z + self.damping * rate;
        if z > 0.0 && value > 0.0 {
            Pressure { value, slope: self.stiffness, by_rate: self.damping }
        } else {
            Pressure::default()
        }
    }
    fn potential(&self, _x: &Point, r: f64) -> f64 {
        0.5 * self.stiffness * r.max(0.0).powi(2)
    }
    fn lipschitz(&self) -> Option<f64> {
        Some(self.stiffness)
    }
    fn lipschitz_in_rate(&self) -> Option<f64> {
        Some(self.damping)
    }
}

/// p = c r₊^m (1 + a ṙ)₊: damping grows with the penetration, so the pressure starts and ends at zero.
#[derive(Clone, Debug, PartialEq)]
pub struct HuntCrossley {
    /// c r₊^m, the pressure at rest.
    pub at_rest: Power,
    /// a ≥ 0 in s/m.
    pub damping: f64,
}

impl NormalLaw for HuntCrossley {
    fn pressure(&self, x: &Point, z: f64, rate: f64, lambda: f64) -> Pressure {
        let factor = 1.0 + self.damping * rate;
        if factor <= 0.0 {
            return Pressure::default();
        }
        let Pressure { value, slope, .. } = self.at_rest.pressure(x, z, 0.0, lambda);
        Pressure { value: value * factor, slope: slope * factor, by_rate: value * self.damping }
    }
    fn potential(&self, x: &Point, r: f64) -> f64 {
        self.at_rest.potential(x, r)
    }
    fn lipschitz(&self) -> Option<f64> {
        self.at_rest.lipschitz()
    }
    fn lipschitz_in_rate(&self) -> Option<f64> {
        if self.damping == 0.0 { Some(0.0) } else { None }
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn NormalLaw>, f64)> {
    vec![
        (std::sync::Arc::new(Damped { stiffness: 1e4, damping: 2e-1 }), 1e-4),
        (std::sync::Arc::new(HuntCrossley { at_rest: Power { stiffness: 1e4, exponent: 1.0 }, damping: 0.4 }), 1e-4),
        (std::sync::Arc::new(HuntCrossley { at_rest: Power { stiffness: 1e9, exponent: 1.5 }, damping: 2.0 }), 1e-3),
    ]
}
