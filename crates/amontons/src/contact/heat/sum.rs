//! Parallel heat transfer by several mechanisms.

use std::sync::Arc;

use super::{Flux, HeatLaw};
use crate::contact::ContactPoint;

/// The sum of the fluxes of several laws, such as conduction at closed points, gas conduction at open ones, radiation,
/// friction.
#[derive(Clone, Debug)]
pub struct Sum {
    /// The laws.
    pub laws: Vec<Arc<dyn HeatLaw>>,
}

impl HeatLaw for Sum {
    fn flux(&self, at: &ContactPoint) -> Flux {
        self.laws.iter().map(|law| law.flux(at)).fold(Flux::default(), |sum, flux| Flux {
            value: sum.value + flux.value,
            by_temperature: sum.by_temperature + flux.by_temperature,
            by_foundation: sum.by_foundation + flux.by_foundation,
            by_penetration: sum.by_penetration + flux.by_penetration,
            by_pressure: sum.by_pressure + flux.by_pressure,
            by_slip_speed: sum.by_slip_speed + flux.by_slip_speed,
            by_friction_power: sum.by_friction_power + flux.by_friction_power,
        })
    }
    fn parts(&self) -> &[Arc<dyn HeatLaw>] {
        &self.laws
    }
    fn conductance_bound(&self) -> f64 {
        self.laws.iter().map(|law| law.conductance_bound()).sum()
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        self.laws.iter().map(|law| law.conductance_lipschitz()).sum()
    }
    fn truncation(&self) -> Option<f64> {
        // The sum is cut off if every law that exchanges heat is.
        let exchanging = self.laws.iter().filter(|law| law.conductance_bound() > 0.0);
        exchanging
            .map(|law| law.truncation())
            .try_fold(0.0f64, |most, cut| Some(most.max(cut?)))
            .filter(|&most| most > 0.0)
    }
    fn absolute_zero(&self) -> Option<f64> {
        self.laws.iter().filter_map(|law| law.absolute_zero()).reduce(f64::max)
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(Arc<dyn HeatLaw>, f64)> {
    let ramp: Arc<dyn HeatLaw> = Arc::new(super::Ramp { conductance: 3.0, width: 0.2, truncation: None });
    let gas: Arc<dyn HeatLaw> = Arc::new(super::GapConduction { conductivity: 2.0, roughness: 0.3, truncation: None });
    let friction: Arc<dyn HeatLaw> = Arc::new(super::FrictionalHeat { partition: 0.5 });
    vec![(Arc::new(Sum { laws: vec![ramp, gas, friction] }), 0.3)]
}
