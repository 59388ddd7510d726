//! Heat exchange: laws for q·ν of (2.10), one per file.

mod constant;
mod formula;
mod frictional;
mod gap;
mod power;
mod pressure;
mod radiation;
mod ramp;
mod sum;

use std::fmt::Debug;
use std::sync::Arc;

use super::ContactPoint;

pub use constant::ConstantConductance;
pub use formula::ConductanceFormula;
pub use frictional::FrictionalHeat;
pub use gap::GapConduction;
pub use power::PowerConductance;
pub use pressure::PressureConductance;
pub use radiation::{Radiation, STEFAN_BOLTZMANN};
pub use ramp::Ramp;
pub use sum::Sum;

/// A heat flux in W/m² that leaves the body (for a pair, the side `on`), with its slopes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flux {
    /// q·ν in W/m².
    pub value: f64,
    /// ∂(q·ν)/∂θ in W/(m² K).
    pub by_temperature: f64,
    /// ∂(q·ν)/∂θ_F in W/(m² K), not positive.
    pub by_foundation: f64,
    /// ∂(q·ν)/∂r, the penetration, in W/m³, at fixed pressure.
    pub by_penetration: f64,
    /// ∂(q·ν)/∂p, the pressure, in W/N.
    pub by_pressure: f64,
    /// ∂(q·ν)/∂‖w_τ‖, the slip speed, in W s/m³.
    pub by_slip_speed: f64,
    /// ∂(q·ν)/∂(q·w_τ), the friction power.
    pub by_friction_power: f64,
}

impl Flux {
    /// The flux out of the other body of a pair for a friction power in W/m²: heat that leaves one body enters the
    /// other, and so does the friction heat that does not enter the first.
    #[must_use]
    pub fn across(&self, friction_power: f64) -> Flux {
        Flux {
            value: 0.0 - self.value - friction_power,
            by_temperature: 0.0 - self.by_foundation,
            by_foundation: 0.0 - self.by_temperature,
            by_penetration: 0.0 - self.by_penetration,
            by_pressure: 0.0 - self.by_pressure,
            by_slip_speed: 0.0 - self.by_slip_speed,
            by_friction_power: -1.0 - self.by_friction_power,
        }
    }
}

/// The heat flux from the body into the foundation, nondecreasing in θ and nonincreasing in θ_F; for a pair from the
/// side `on` into the side `with`, regardless of which bears the contact points.
pub trait HeatLaw: Debug + Send + Sync {
    /// The flux at a point.
    fn flux(&self, at: &ContactPoint) -> Flux;
    /// M_kc of (H7), the bound of the conductance in W/(m² K); infinite if unbounded.
    fn conductance_bound(&self) -> f64;
    /// L_kc of (H7), the Lipschitz constant of the conductance in W/(m³ K); `None` if it has none.
    fn conductance_lipschitz(&self) -> Option<f64>;
    /// L of φ_L in K; `None` without truncation.
    fn truncation(&self) -> Option<f64> {
        None
    }
    /// The mechanism of heat transfer, named as the law in case files; `None` if no heat passes.
    fn mechanism(&self) -> Option<&'static str> {
        Some("law")
    }
    /// The laws whose fluxes are summed; empty for a law of one mechanism.
    fn parts(&self) -> &[Arc<dyn HeatLaw>] {
        &[]
    }
    /// Absolute zero on the scale of the temperature, K; `None` for laws that depend on differences only.
    fn absolute_zero(&self) -> Option<f64> {
        None
    }
}

/// The mechanism of [`FrictionalHeat`].
pub const FRICTION: &str = "friction";

/// No heat exchange.
#[derive(Clone, Debug, PartialEq)]
pub struct Insulated;

impl HeatLaw for Insulated {
    fn flux(&self, _at: &ContactPoint) -> Flux {
        Flux::default()
    }
    fn mechanism(&self) -> Option<&'static str> {
        None
    }
    fn conductance_bound(&self) -> f64 {
        0.0
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        Some(0.0)
    }
}

/// φ_L(θ − θ_F) of (2.10), the difference cut off at ±L, with a generalized derivative.
fn phi_l(at: &ContactPoint, truncation: Option<f64>) -> (f64, f64) {
    let s = at.temperature - at.foundation_temperature;
    match truncation {
        Some(l) if s.abs() > l => (l * s.signum(), 0.0),
        _ => (s, 1.0),
    }
}

/// Sample laws, each with a typical penetration, for tests that hold for every law.
#[cfg(test)]
pub(crate) fn samples() -> Vec<(Arc<dyn HeatLaw>, f64)> {
    let mut all: Vec<(Arc<dyn HeatLaw>, f64)> = vec![(Arc::new(Insulated), 1e-4)];
    for samples in [
        constant::samples,
        ramp::samples,
        power::samples,
        pressure::samples,
        formula::samples,
        gap::samples,
        radiation::samples,
        frictional::samples,
        sum::samples,
    ] {
        all.extend(samples());
    }
    all
}
