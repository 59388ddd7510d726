//! A constant conductance.

use super::{Flux, HeatLaw, phi_l};
use crate::contact::ContactPoint;

/// One h at every contact point, open or closed: the thin layer of a tied joint, or a film that never separates.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstantConductance {
    /// h ≥ 0 in W/(m² K).
    pub conductance: f64,
    /// L of φ_L in K; without it φ_L(s) = s.
    pub truncation: Option<f64>,
}

impl HeatLaw for ConstantConductance {
    fn flux(&self, at: &ContactPoint) -> Flux {
        let (phi, h) = (phi_l(at, self.truncation), self.conductance);
        Flux { value: h * phi.0, by_temperature: h * phi.1, by_foundation: -h * phi.1, ..Flux::default() }
    }
    fn mechanism(&self) -> Option<&'static str> {
        Some("constant")
    }
    fn conductance_bound(&self) -> f64 {
        self.conductance
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        Some(0.0)
    }
    fn truncation(&self) -> Option<f64> {
        self.truncation
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn HeatLaw>, f64)> {
    vec![
        (std::sync::Arc::new(ConstantConductance { conductance: 3.0, truncation: None }), 1e-3),
        (std::sync::Arc::new(ConstantConductance { conductance: 0.5, truncation: Some(2.0) }), 1e-3),
    ]
}
