//! A friction coefficient given by a formula in pressure, slip speed and temperature.

use super::{Bound, FrictionLaw};
use crate::contact::ContactPoint;
use crate::expression::{ExpressionError, Formula, NamedConstants};

/// p_τ = c μ(p, v, θ) p with μ a formula: p the pressure in Pa, v the slip speed in m/s, θ the temperature of the body
/// in K. Where the formula is negative, μ is 0.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionFormula {
    /// c ≥ 0.
    factor: f64,
    /// μ.
    coefficient: Formula,
}

/// Number of slip speeds in an interval at which the least slope is searched.
const SAMPLES: usize = 64;

impl FrictionFormula {
    /// Names of the variables.
    pub const VARIABLES: [&'static str; 3] = ["p", "v", "theta"];

    /// A formula times a factor.
    ///
    /// # Errors
    /// Fails if the text is no formula in `p`, `v`, `theta` and the constants.
    pub fn new(coefficient: &str, factor: f64, constants: &NamedConstants) -> Result<FrictionFormula, ExpressionError> {
        Ok(FrictionFormula { factor, coefficient: Formula::with(coefficient, &Self::VARIABLES, constants)? })
    }

    /// True if the formula mentions the temperature.
    #[must_use]
    pub fn sees_temperature(&self) -> bool {
        self.coefficient.uses(2)
    }

    /// c μ with its derivatives by p, v and θ.
    fn coefficient(&self, at: &ContactPoint) -> (f64, [f64; 3]) {
        let (mu, [by_p, by_v, by_theta, _]) =
            self.coefficient.derivatives([at.pressure, at.slip_speed, at.temperature, 0.0]);
        if mu < 0.0 {
            return (0.0, [0.0; 3]);
        }
        (self.factor * mu, [by_p, by_v, by_theta].map(|slope| self.factor * slope))
    }
}

impl FrictionLaw for FrictionFormula {
    fn bound(&self, at: &ContactPoint) -> Bound {
        if at.pressure <= 0.0 {
            let (mu, _) = self.coefficient(&ContactPoint { pressure: 0.0, ..*at });
            return Bound { by_pressure: mu, ..Bound::default() };
        }
        let (mu, [by_p, by_v, by_theta]) = self.coefficient(at);
        Bound {
            value: mu * at.pressure,
            by_pressure: mu + by_p * at.pressure,
            by_slip_speed: by_v * at.pressure,
            by_temperature: by_theta * at.pressure,
            by_penetration: 0.0,
        }
    }
    fn lipschitz(&self, _l_nu: Option<f64>) -> Option<f64> {
        // No bound is known that holds for all pressures, speeds and temperatures.
        None
    }
    fn least_slope(&self, at: &ContactPoint, from: f64, to: f64) -> f64 {
        let slope = |slip_speed: f64| self.bound(&ContactPoint { slip_speed, ..*at }).by_slip_speed;
        // Samples are evenly spaced, with more near the first speed, where friction of slow slip changes most.
        let shares = (0..=SAMPLES).map(|i| i as f64 / SAMPLES as f64);
        let speeds = shares.flat_map(|share| [share, share.powi(6)]).map(|share| from + share * (to - from));
        speeds.map(slope).fold(0.0, f64::min)
    }
    fn is_frictionless(&self) -> bool {
        self.factor == 0.0
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<std::sync::Arc<dyn FrictionLaw>> {
    let all = [
        FrictionFormula::new("0.2 + 0.1*exp(-v/0.3)", 1.0, &NamedConstants::default()),
        FrictionFormula::new("0.3/(1 + 0.1*p)*(1 - 0.01*theta)", 0.5, &NamedConstants::default()),
    ];
    all.into_iter().flatten().map(|law| std::sync::Arc::new(law) as std::sync::Arc<dyn FrictionLaw>).collect()
}
