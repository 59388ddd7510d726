//! Friction coefficients that depend on slip speed, temperature or pressure, given by tables.
//!
//! Sources: E. Rabinowicz, "Friction and Wear of Materials", Wiley (1965), chapter 4 (slip speed, pressure); the
//! coefficient linear in the temperature, μ₀ + μ₁ (θ − θ₀) between two limits, is a table of two points.

use super::{Bound, FrictionLaw};
use crate::contact::{ContactPoint, PiecewiseLinear};

/// The variable on which the coefficient depends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrictionVariable {
    /// ‖w_τ‖ in m/s.
    SlipSpeed,
    /// θ of the body in K.
    Temperature,
    /// p in Pa.
    Pressure,
}

/// p_τ = μ(·) p with μ linear between the points of a table and constant outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    /// The argument of μ.
    pub variable: FrictionVariable,
    /// μ ≥ 0.
    pub coefficient: PiecewiseLinear,
}

impl FrictionLaw for Tabulated {
    fn bound(&self, at: &ContactPoint) -> Bound {
        let argument = match self.variable {
            FrictionVariable::SlipSpeed => at.slip_speed,
            FrictionVariable::Temperature => at.temperature,
            FrictionVariable::Pressure => at.pressure,
        };
        let (mu, slope) = self.coefficient.held(argument);
        let by = |variable: FrictionVariable| if variable == self.variable { slope * at.pressure } else { 0.0 };
        Bound {
            value: mu * at.pressure,
            by_pressure: mu + by(FrictionVariable::Pressure),
            by_slip_speed: by(FrictionVariable::SlipSpeed),
            by_temperature: by(FrictionVariable::Temperature),
            by_penetration: 0.0,
        }
    }
    fn lipschitz(&self, l_nu: Option<f64>) -> Option<f64> {
        let mut most = self.coefficient.largest();
        if self.variable == FrictionVariable::Pressure {
            // (μ(p) p)′ = μ + μ′ p is linear on each piece: largest at its ends.
            for (ends, slope) in self.coefficient.points().windows(2).zip(self.coefficient.slopes()) {
                most = ends.iter().fold(most, |most, &(p, mu)| most.max((mu + slope * p.max(0.0)).abs()));
            }
        }
        l_nu.map(|l| most * l)
    }
    fn least_slope(&self, at: &ContactPoint, from: f64, to: f64) -> f64 {
        if self.variable != FrictionVariable::SlipSpeed {
            return 0.0;
        }
        let pieces = self.coefficient.points().windows(2).zip(self.coefficient.slopes());
        at.pressure
            * pieces.filter(|(ends, _)| ends[0].0 < to && from < ends[1].0).map(|(_, slope)| slope).fold(0.0, f64::min)
    }
    fn is_frictionless(&self) -> bool {
        self.coefficient.largest() == 0.0
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<std::sync::Arc<dyn FrictionLaw>> {
    let law = |variable, arguments: &[f64], values: &[f64]| {
        PiecewiseLinear::new(arguments, values).map(|coefficient| Tabulated { variable, coefficient })
    };
    [
        law(FrictionVariable::SlipSpeed, &[0.0, 0.2, 0.6], &[0.5, 0.2, 0.4]),
        law(FrictionVariable::Temperature, &[-1.0, 1.0], &[0.3, 0.1]),
        law(FrictionVariable::Pressure, &[0.0, 1.0, 4.0], &[0.5, 0.5, 0.1]),
    ]
    .into_iter()
    .flatten()
    .map(|law| std::sync::Arc::new(law) as std::sync::Arc<dyn FrictionLaw>)
    .collect()
}
