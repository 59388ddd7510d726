//! Radiation between the surfaces.
//!
//! Source: F. P. Incropera, D. P. DeWitt, "Fundamentals of Heat and Mass Transfer", Wiley (2002), chapter 13; the
//! constant is that of the SI (2019).

use super::{Flux, HeatLaw};
use crate::contact::ContactPoint;

/// σ of Stefan and Boltzmann in W/(m² K⁴).
pub const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;

/// q·ν = σ ε ((θ − θ_a)⁴ − (θ_F − θ_a)⁴), independent of the gap; below θ_a a surface does not radiate.
#[derive(Clone, Debug, PartialEq)]
pub struct Radiation {
    /// ε of both surfaces together, ≥ 0.
    pub emissivity: f64,
    /// σ in the units of the case; see [`STEFAN_BOLTZMANN`].
    pub constant: f64,
    /// θ_a, the value of θ at absolute zero: 0 K.
    pub absolute_zero: f64,
}

impl HeatLaw for Radiation {
    fn flux(&self, at: &ContactPoint) -> Flux {
        let [body, foundation] =
            [at.temperature, at.foundation_temperature].map(|theta| (theta - self.absolute_zero).max(0.0));
        let factor = self.constant * self.emissivity;
        // a⁴ − b⁴ factored to avoid cancellation if the temperatures are close.
        let difference = (body - foundation) * (body + foundation) * (body * body + foundation * foundation);
        Flux {
            value: factor * difference,
            by_temperature: 4.0 * factor * body.powi(3),
            by_foundation: -4.0 * factor * foundation.powi(3),
            ..Flux::default()
        }
    }
    fn mechanism(&self) -> Option<&'static str> {
        Some("radiation")
    }
    fn conductance_bound(&self) -> f64 {
        // The slope grows with the temperature.
        if self.constant * self.emissivity == 0.0 { 0.0 } else { f64::INFINITY }
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        // The flux does not depend on the penetration.
        Some(0.0)
    }
    fn absolute_zero(&self) -> Option<f64> {
        Some(self.absolute_zero)
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn HeatLaw>, f64)> {
    vec![
        (std::sync::Arc::new(Radiation { emissivity: 0.8, constant: STEFAN_BOLTZMANN, absolute_zero: -273.15 }), 1e-3),
        (std::sync::Arc::new(Radiation { emissivity: 1.0, constant: 0.3, absolute_zero: -5.0 }), 1e-3),
    ]
}
