//! A conductance given by a formula in pressure and penetration.

use super::{Flux, HeatLaw, phi_l};
use crate::contact::ContactPoint;
use crate::expression::{ExpressionError, Formula, NamedConstants};

/// h = c f(p, r) with a formula f: p₊ in Pa is the contact pressure, r in m the penetration, negative if the gap is
/// open. If the formula is negative, h is 0.
#[derive(Clone, Debug, PartialEq)]
pub struct ConductanceFormula {
    /// c ≥ 0.
    factor: f64,
    /// f in W/(m² K).
    conductance: Formula,
    /// L of φ_L in K; without it φ_L(s) = s.
    truncation: Option<f64>,
}

impl ConductanceFormula {
    /// Names of the variables.
    pub const VARIABLES: [&'static str; 2] = ["p", "r"];

    /// A formula times a factor.
    ///
    /// # Errors
    /// Fails if the text is no formula in `p`, `r` and the constants.
    pub fn new(
        conductance: &str,
        factor: f64,
        truncation: Option<f64>,
        constants: &NamedConstants,
    ) -> Result<ConductanceFormula, ExpressionError> {
        let conductance = Formula::with(conductance, &Self::VARIABLES, constants)?;
        Ok(ConductanceFormula { factor, conductance, truncation })
    }
}

impl HeatLaw for ConductanceFormula {
    fn flux(&self, at: &ContactPoint) -> Flux {
        let presses = at.pressure > 0.0;
        let (h, [by_p, by_r, ..]) = self.conductance.derivatives([at.pressure.max(0.0), at.penetration, 0.0, 0.0]);
        if h < 0.0 {
            return Flux::default();
        }
        let (h, phi) = (self.factor * h, phi_l(at, self.truncation));
        Flux {
            value: h * phi.0,
            by_temperature: h * phi.1,
            by_foundation: -h * phi.1,
            by_penetration: self.factor * by_r * phi.0,
            by_pressure: if presses { self.factor * by_p * phi.0 } else { 0.0 },
            ..Flux::default()
        }
    }
    fn mechanism(&self) -> Option<&'static str> {
        Some("expression")
    }
    fn conductance_bound(&self) -> f64 {
        if self.factor == 0.0 { 0.0 } else { f64::INFINITY }
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        // No bound is known that holds for all pressures and penetrations.
        None
    }
    fn truncation(&self) -> Option<f64> {
        self.truncation
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn HeatLaw>, f64)> {
    let all = [
        ConductanceFormula::new("5 + 2*p^0.95", 1.0, None, &NamedConstants::default()),
        ConductanceFormula::new("0.02/(1e-3 + max(-r, 0))", 2.0, Some(3.0), &NamedConstants::default()),
    ];
    all.into_iter().flatten().map(|law| (std::sync::Arc::new(law) as std::sync::Arc<dyn HeatLaw>, 1e-3)).collect()
}
