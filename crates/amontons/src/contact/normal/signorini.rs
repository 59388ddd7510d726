//! Signorini's conditions: r ≤ 0, p ≥ 0, p r = 0.
//!
//! Source: A. Signorini, "Sopra alcune questioni di elastostatica", Atti Soc. Ital. Progr. Sci. (1933).

use super::{GraphKind, NormalLaw, Pressure};
use crate::tensor::Point;

/// A rigid foundation: r ≤ 0, p ≥ 0, p r = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Signorini;

impl NormalLaw for Signorini {
    fn pressure(&self, _x: &Point, z: f64, _rate: f64, lambda: f64) -> Pressure {
        if z > 0.0 { Pressure { value: z / lambda, slope: 1.0 / lambda, by_rate: 0.0 } } else { Pressure::default() }
    }
    fn potential(&self, _x: &Point, _r: f64) -> f64 {
        // A positive penetration is round-off.
        0.0
    }
    fn lipschitz(&self) -> Option<f64> {
        None
    }
    fn graph(&self) -> GraphKind {
        GraphKind::Multivalued
    }
    fn is_rigid(&self) -> bool {
        true
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn NormalLaw>, f64)> {
    vec![(std::sync::Arc::new(Signorini), 1e-4)]
}
