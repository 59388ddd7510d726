//! Conductance as a power of the pressure.
//!
//! Sources: M. G. Cooper, B. B. Mikic, M. M. Yovanovich, "Thermal contact conductance", Int. J. Heat Mass Transfer 12
//! (1969) 279–300 (h ~ p^0.985); P. Wriggers, C. Miehe, Comput. Methods Appl. Mech. Engrg. 113 (1994) 301–319.

use super::{Flux, HeatLaw, phi_l};
use crate::contact::ContactPoint;

/// h(p) = c p₊^m.
#[derive(Clone, Debug, PartialEq)]
pub struct PressureConductance {
    /// c ≥ 0 in W/(m² K Pa^m).
    pub coefficient: f64,
    /// m > 0.
    pub exponent: f64,
    /// L of φ_L in K; without it φ_L(s) = s.
    pub truncation: Option<f64>,
}

impl HeatLaw for PressureConductance {
    fn flux(&self, at: &ContactPoint) -> Flux {
        if at.pressure <= 0.0 {
            return Flux::default();
        }
        let (phi, h) = (phi_l(at, self.truncation), self.coefficient * at.pressure.powf(self.exponent));
        Flux {
            value: h * phi.0,
            by_temperature: h * phi.1,
            by_foundation: -h * phi.1,
            by_pressure: self.exponent * h / at.pressure * phi.0,
            ..Flux::default()
        }
    }
    fn mechanism(&self) -> Option<&'static str> {
        Some("pressure")
    }
    fn conductance_bound(&self) -> f64 {
        if self.coefficient == 0.0 { 0.0 } else { f64::INFINITY }
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        // A constant in the penetration would depend on the normal law, too.
        None
    }
    fn truncation(&self) -> Option<f64> {
        self.truncation
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn HeatLaw>, f64)> {
    vec![
        (std::sync::Arc::new(PressureConductance { coefficient: 1.1, exponent: 1.0, truncation: None }), 1e-3),
        (std::sync::Arc::new(PressureConductance { coefficient: 4.0, exponent: 0.95, truncation: Some(2.0) }), 1e-3),
    ]
}
