//! Orthotropic friction: a coefficient for each of two orthogonal directions.
//!
//! Source: R. Michałowski, Z. Mróz, "Associated and non-associated sliding rules in contact friction problems", Arch.
//! Mech. 30 (1978) 259–276, with the associated rule.

use super::{Bound, Cone, FrictionLaw};
use crate::contact::ContactPoint;
use crate::tensor::Point;

/// (q₁/μ₁)² + (q₂/μ₂)² ≤ p², with slip along the normal of that ellipse.
#[derive(Clone, Debug, PartialEq)]
pub struct OrthotropicFriction {
    /// μ₁ along the direction and μ₂ across it, both positive.
    pub coefficients: [f64; 2],
    /// The direction of μ₁; only its tangential part counts.
    pub direction: Point,
}

impl OrthotropicFriction {
    fn largest(&self) -> f64 {
        self.coefficients[0].max(self.coefficients[1])
    }
}

impl FrictionLaw for OrthotropicFriction {
    fn bound(&self, at: &ContactPoint) -> Bound {
        let mu = self.largest();
        Bound { value: mu * at.pressure, by_pressure: mu, ..Bound::default() }
    }
    fn lipschitz(&self, l_nu: Option<f64>) -> Option<f64> {
        l_nu.map(|l| self.largest() * l)
    }
    fn cone(&self, _x: &Point, nu: &Point) -> Option<Cone> {
        let mu = self.largest();
        Some(Cone::new(nu, &self.direction, self.coefficients.map(|c| c / mu)))
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<std::sync::Arc<dyn FrictionLaw>> {
    vec![std::sync::Arc::new(OrthotropicFriction { coefficients: [0.2, 0.6], direction: [1.0, 0.0, 0.0] })]
}
