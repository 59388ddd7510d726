//! Friction: laws for the bound p_τ of (2.9).

use std::fmt::Debug;
#[cfg(test)]
use std::sync::Arc;

use super::ContactPoint;

/// A friction bound s ≥ 0 in Pa with its slopes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bound {
    /// s in Pa.
    pub value: f64,
    /// ∂s/∂r, the penetration, in Pa/m, at fixed pressure.
    pub by_penetration: f64,
    /// ∂s/∂p, the pressure.
    pub by_pressure: f64,
    /// ∂s/∂‖w_τ‖, the slip speed, in Pa s/m.
    pub by_slip_speed: f64,
}

/// The bound of the friction traction; the projection onto it is not the law's.
pub trait FrictionLaw: Debug + Send + Sync {
    /// The bound at a point.
    fn bound(&self, at: &ContactPoint) -> Bound;
    /// L_τ of (H8) in Pa/m where the pressure has the Lipschitz constant `l_nu`; none if unbounded.
    fn lipschitz(&self, l_nu: Option<f64>) -> Option<f64>;
    /// Whether the bound is always zero.
    fn is_frictionless(&self) -> bool {
        false
    }
}

/// No friction: p_τ = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Frictionless;

impl FrictionLaw for Frictionless {
    fn bound(&self, _at: &ContactPoint) -> Bound {
        Bound::default()
    }
    fn lipschitz(&self, _l_nu: Option<f64>) -> Option<f64> {
        Some(0.0)
    }
    fn is_frictionless(&self) -> bool {
        true
    }
}

/// Coulomb's law p_τ = μ p_ν.
#[derive(Clone, Debug, PartialEq)]
pub struct Coulomb {
    /// μ_τ ≥ 0.
    pub coefficient: f64,
}

impl FrictionLaw for Coulomb {
    fn bound(&self, at: &ContactPoint) -> Bound {
        Bound { value: self.coefficient * at.pressure, by_pressure: self.coefficient, ..Bound::default() }
    }
    fn lipschitz(&self, l_nu: Option<f64>) -> Option<f64> {
        l_nu.map(|l| self.coefficient * l)
    }
    fn is_frictionless(&self) -> bool {
        self.coefficient == 0.0
    }
}

/// Sample laws for tests that hold for every law.
#[cfg(test)]
pub(crate) fn samples() -> Vec<Arc<dyn FrictionLaw>> {
    vec![Arc::new(Frictionless), Arc::new(Coulomb { coefficient: 0.2 }), Arc::new(Coulomb { coefficient: 1.5 })]
}
