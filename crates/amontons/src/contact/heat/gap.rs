//! Conduction through the gas in a gap.
//!
//! Source: M. M. Yovanovich, "Four decades of research on thermal contact, gap, and joint resistance in
//! microelectronics", IEEE Trans. Components Packaging Tech. 28 (2005) 182–206: h = k_g/(g + M), M the length at which
//! the gas conducts between touching asperities.

use super::{Flux, HeatLaw, phi_l};
use crate::contact::ContactPoint;

/// h = k_g/(g + g₀) over the open width g = (−r)₊; k_g/g₀ if closed.
#[derive(Clone, Debug, PartialEq)]
pub struct GapConduction {
    /// k_g ≥ 0 in W/(m K).
    pub conductivity: f64,
    /// g₀ > 0 in m.
    pub roughness: f64,
    /// L of φ_L in K; without it φ_L(s) = s.
    pub truncation: Option<f64>,
}

impl HeatLaw for GapConduction {
    fn flux(&self, at: &ContactPoint) -> Flux {
        let (phi, width) = (phi_l(at, self.truncation), (-at.penetration).max(0.0) + self.roughness);
        let h = self.conductivity / width;
        let by_penetration = if at.penetration < 0.0 { h / width * phi.0 } else { 0.0 };
        Flux {
            value: h * phi.0,
            by_temperature: h * phi.1,
            by_foundation: -h * phi.1,
            by_penetration,
            ..Flux::default()
        }
    }
    fn mechanism(&self) -> Option<&'static str> {
        Some("gap")
    }
    fn conductance_bound(&self) -> f64 {
        self.conductivity / self.roughness
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        Some(self.conductivity / self.roughness.powi(2))
    }
    fn truncation(&self) -> Option<f64> {
        self.truncation
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn HeatLaw>, f64)> {
    vec![
        (std::sync::Arc::new(GapConduction { conductivity: 0.026, roughness: 1e-5, truncation: None }), 1e-5),
        (std::sync::Arc::new(GapConduction { conductivity: 2.0, roughness: 0.3, truncation: Some(1.5) }), 0.2),
    ]
}
