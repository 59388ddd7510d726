//! Bilateral contact: r = 0, without separation.
//!
//! Source: M. Shillor, M. Sofonea, J. J. Telega, "Models and Analysis of Quasistatic Contact", Springer (2004), section
//! 2.6.

use super::{GraphKind, NormalLaw, Pressure};
use crate::tensor::Point;

/// r = 0, with a pressure of any sign.
#[derive(Clone, Debug, PartialEq)]
pub struct Bilateral;

impl NormalLaw for Bilateral {
    fn pressure(&self, _x: &Point, z: f64, _rate: f64, lambda: f64) -> Pressure {
        Pressure { value: z / lambda, slope: 1.0 / lambda, by_rate: 0.0 }
    }
    fn potential(&self, _x: &Point, _r: f64) -> f64 {
        0.0
    }
    fn lipschitz(&self) -> Option<f64> {
        None
    }
    fn graph(&self) -> GraphKind {
        GraphKind::Bilateral
    }
    fn is_rigid(&self) -> bool {
        true
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn NormalLaw>, f64)> {
    vec![(std::sync::Arc::new(Bilateral), 1e-4)]
}
