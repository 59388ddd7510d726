//! Static and kinetic friction: the bound decreases when slip starts.
//!
//! Source: J. A. C. Martins, J. T. Oden, F. M. F. Simões, "A study of static and kinetic friction", Int. J. Engng Sci.
//! 28 (1990) 29–92; the exponential decay is that of L. C. Bo, D. Pavelescu, Wear 82 (1982) 277–289.

use super::{Bound, FrictionLaw};
use crate::contact::ContactPoint;

/// p_τ = μ(‖w_τ‖) p with μ(v) = μ_k + (μ_s − μ_k) exp(−v/v_d). Without v_d, μ_s holds while a point sticks and μ_k
/// while it slips.
///
/// A step may then have two solutions at a point: a sticking point sticks up to μ_s p, a slipping point continues to
/// slip until its slip would reverse.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticKinetic {
    /// μ_s ≥ μ_k.
    pub at_rest: f64,
    /// μ_k ≥ 0.
    pub kinetic: f64,
    /// v_d > 0 in m/s.
    pub decay_speed: Option<f64>,
}

impl FrictionLaw for StaticKinetic {
    fn bound(&self, at: &ContactPoint) -> Bound {
        let drop = self.at_rest - self.kinetic;
        let (left, slope) = match self.decay_speed {
            Some(decay) => {
                let left = drop * (-at.slip_speed / decay).exp();
                (left, -left / decay)
            }
            None if at.slip_speed == 0.0 => (drop, 0.0),
            None => (0.0, 0.0),
        };
        let mu = self.kinetic + left;
        Bound { value: mu * at.pressure, by_pressure: mu, by_slip_speed: slope * at.pressure, ..Bound::default() }
    }
    fn lipschitz(&self, l_nu: Option<f64>) -> Option<f64> {
        l_nu.map(|l| self.at_rest.max(self.kinetic) * l)
    }
    fn least_slope(&self, at: &ContactPoint, from: f64, to: f64) -> f64 {
        [from, to]
            .map(|slip_speed| self.bound(&ContactPoint { slip_speed, ..*at }).by_slip_speed)
            .into_iter()
            .fold(0.0, f64::min)
    }
    fn drops_from_rest(&self) -> bool {
        self.decay_speed.is_none() && self.at_rest > self.kinetic
    }
    fn is_frictionless(&self) -> bool {
        self.at_rest == 0.0 && self.kinetic == 0.0
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<std::sync::Arc<dyn FrictionLaw>> {
    use std::sync::Arc;
    vec![
        Arc::new(StaticKinetic { at_rest: 0.4, kinetic: 0.3, decay_speed: None }),
        Arc::new(StaticKinetic { at_rest: 0.4, kinetic: 0.1, decay_speed: Some(0.2) }),
    ]
}
