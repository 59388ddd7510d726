//! Wear: the depth that rubbing takes off.
//!
//! Source: J. F. Archard, "Contact and rubbing of flat surfaces", J. Appl. Phys. 24 (1953) 981–988: the worn volume is
//! proportional to the load and the sliding distance; by area, ḣ = κ p ‖w_τ‖.

use std::fmt::Debug;
#[cfg(test)]
use std::sync::Arc;

use super::{ContactPoint, PiecewiseLinear};

/// A wear rate ḣ = κ p₊ ‖w_τ‖ in m/s, κ a function of temperature; the gap grows by h.
pub trait WearLaw: Debug + Send + Sync {
    /// κ ≥ 0 in 1/Pa.
    fn coefficient(&self, at: &ContactPoint) -> f64;
    /// ∂κ/∂θ in 1/(Pa K).
    fn by_temperature(&self, at: &ContactPoint) -> f64;
}

/// Archard's law with a constant or temperature-dependent coefficient.
#[derive(Clone, Debug, PartialEq)]
pub enum Archard {
    /// κ in 1/Pa: wear coefficient over hardness.
    Constant(f64),
    /// κ in 1/Pa over the temperature of the body in K, constant beyond the table.
    ByTemperature(PiecewiseLinear),
}

impl WearLaw for Archard {
    fn coefficient(&self, at: &ContactPoint) -> f64 {
        match self {
            Archard::Constant(coefficient) => *coefficient,
            Archard::ByTemperature(table) => table.held(at.temperature).0,
        }
    }
    fn by_temperature(&self, at: &ContactPoint) -> f64 {
        match self {
            Archard::Constant(_) => 0.0,
            Archard::ByTemperature(table) => table.held(at.temperature).1,
        }
    }
}

/// Sample laws for tests that hold for every law.
#[cfg(test)]
pub(crate) fn samples() -> Vec<Arc<dyn WearLaw>> {
    let mut all: Vec<Arc<dyn WearLaw>> = vec![Arc::new(Archard::Constant(2e-3))];
    all.extend(
        PiecewiseLinear::new(&[0.0, 100.0], &[1e-3, 5e-3])
            .ok()
            .map(|table| -> Arc<dyn WearLaw> { Arc::new(Archard::ByTemperature(table)) }),
    );
    all
}
