//! Conductance as a power of the penetration.
//!
//! Source: M. Shillor, M. Sofonea, J. J. Telega, "Models and Analysis of Quasistatic Contact", Springer (2004), section
//! 3.1.

use super::{Flux, HeatLaw, phi_l};
use crate::contact::ContactPoint;

/// k_c(r) = c r₊^m.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerConductance {
    /// c ≥ 0 in W/(m^(2+m) K).
    pub coefficient: f64,
    /// m ≥ 1.
    pub exponent: f64,
    /// L of φ_L in K; without it φ_L(s) = s.
    pub truncation: Option<f64>,
}

impl HeatLaw for PowerConductance {
    fn flux(&self, at: &ContactPoint) -> Flux {
        let r = at.penetration;
        if r <= 0.0 {
            return Flux::default();
        }
        let (phi, secant) = (phi_l(at, self.truncation), self.coefficient * r.powf(self.exponent - 1.0));
        Flux {
            value: secant * r * phi.0,
            by_temperature: secant * r * phi.1,
            by_foundation: -secant * r * phi.1,
            by_penetration: self.exponent * secant * phi.0,
            ..Flux::default()
        }
    }
    fn mechanism(&self) -> Option<&'static str> {
        Some("power")
    }
    fn conductance_bound(&self) -> f64 {
        if self.coefficient == 0.0 { 0.0 } else { f64::INFINITY }
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        (self.exponent <= 1.0).then_some(self.coefficient)
    }
    fn truncation(&self) -> Option<f64> {
        self.truncation
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn HeatLaw>, f64)> {
    vec![
        (std::sync::Arc::new(PowerConductance { coefficient: 3.0, exponent: 1.5, truncation: None }), 0.4),
        (std::sync::Arc::new(PowerConductance { coefficient: 1e4, exponent: 1.0, truncation: Some(1.0) }), 1e-3),
    ]
}
