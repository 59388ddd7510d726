//! The conductance of section 5.

use super::{Flux, HeatLaw, phi_l};
use crate::contact::ContactPoint;

/// The conductance of section 5: k_c(r) = k̄_c r/ε_c on [0, ε_c], k̄_c above, 0 below.
#[derive(Clone, Debug, PartialEq)]
pub struct Ramp {
    /// k̄_c in W/(m² K).
    pub conductance: f64,
    /// ε_c in m.
    pub width: f64,
    /// L of φ_L in K; without it φ_L(s) = s.
    pub truncation: Option<f64>,
}

impl Ramp {
    /// k_c(r) with a generalized derivative.
    fn k_c(&self, r: f64) -> (f64, f64) {
        let slope = if r > 0.0 && r < self.width { self.conductance / self.width } else { 0.0 };
        (self.conductance * (r / self.width).clamp(0.0, 1.0), slope)
    }
}

impl HeatLaw for Ramp {
    fn flux(&self, at: &ContactPoint) -> Flux {
        let k_c = self.k_c(at.penetration);
        let phi = phi_l(at, self.truncation);
        Flux {
            value: k_c.0 * phi.0,
            by_temperature: k_c.0 * phi.1,
            by_foundation: -k_c.0 * phi.1,
            by_penetration: k_c.1 * phi.0,
            ..Flux::default()
        }
    }
    fn mechanism(&self) -> Option<&'static str> {
        Some("ramp")
    }
    fn conductance_bound(&self) -> f64 {
        self.conductance
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        Some(self.conductance / self.width)
    }
    fn truncation(&self) -> Option<f64> {
        self.truncation
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn HeatLaw>, f64)> {
    vec![
        (std::sync::Arc::new(Ramp { conductance: 1.0, width: 1e-5, truncation: None }), 1e-5),
        (std::sync::Arc::new(Ramp { conductance: 30.0, width: 0.5, truncation: Some(2.0) }), 0.5),
    ]
}
