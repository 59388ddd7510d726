//! Heat exchange: laws for q·ν = k_c(u_ν − g) φ_L(θ − θ_F) of (2.10).

use std::fmt::Debug;
#[cfg(test)]
use std::sync::Arc;

use super::ContactPoint;

/// A heat flux leaving the body, W/m², with its slopes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flux {
    /// q·ν in W/m².
    pub value: f64,
    /// ∂(q·ν)/∂θ in W/(m² K).
    pub by_temperature: f64,
    /// ∂(q·ν)/∂r, the penetration, in W/m³, at fixed pressure.
    pub by_penetration: f64,
    /// ∂(q·ν)/∂p, the pressure, in W/N.
    pub by_pressure: f64,
    /// ∂(q·ν)/∂‖w_τ‖, the slip speed, in W s/m³.
    pub by_slip_speed: f64,
}

/// The heat flux from the body into the foundation, nondecreasing in θ.
pub trait HeatLaw: Debug + Send + Sync {
    /// The flux at a point.
    fn flux(&self, at: &ContactPoint) -> Flux;
    /// M_kc of (H7), the bound of the conductance in W/(m² K).
    fn conductance_bound(&self) -> f64;
    /// L_kc of (H7), the Lipschitz constant of the conductance in W/(m³ K); none if there is none.
    fn conductance_lipschitz(&self) -> Option<f64>;
    /// L of φ_L in K; none without truncation.
    fn truncation(&self) -> Option<f64> {
        None
    }
}

/// No heat exchange.
#[derive(Clone, Debug, PartialEq)]
pub struct Insulated;

impl HeatLaw for Insulated {
    fn flux(&self, _at: &ContactPoint) -> Flux {
        Flux::default()
    }
    fn conductance_bound(&self) -> f64 {
        0.0
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        Some(0.0)
    }
}

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
        let phi = phi_l(at.temperature - at.foundation_temperature, self.truncation);
        Flux { value: k_c.0 * phi.0, by_temperature: k_c.0 * phi.1, by_penetration: k_c.1 * phi.0, ..Flux::default() }
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

/// φ_L(s) of (2.10) with a generalized derivative: s cut off at ±L.
fn phi_l(s: f64, truncation: Option<f64>) -> (f64, f64) {
    match truncation {
        Some(l) if s.abs() > l => (l * s.signum(), 0.0),
        _ => (s, 1.0),
    }
}

/// Sample laws, each with a penetration typical of it, for tests that hold for every law.
#[cfg(test)]
pub(crate) fn samples() -> Vec<(Arc<dyn HeatLaw>, f64)> {
    vec![
        (Arc::new(Insulated), 1e-4),
        (Arc::new(Ramp { conductance: 1.0, width: 1e-5, truncation: None }), 1e-5),
        (Arc::new(Ramp { conductance: 30.0, width: 0.5, truncation: Some(2.0) }), 0.5),
    ]
}
