//! Friction: laws for the bound p_τ of (2.9), one per file.

mod capped;
mod coulomb;
mod formula;
mod orthotropic;
mod static_kinetic;
mod stick;
mod tabulated;
mod tresca;

use std::fmt::Debug;
#[cfg(test)]
use std::sync::Arc;

use super::ContactPoint;
use crate::tensor::{Point, dot, length};

pub use capped::Capped;
pub use coulomb::{Coulomb, Frictionless};
pub use formula::FrictionFormula;
pub use orthotropic::OrthotropicFriction;
pub use static_kinetic::StaticKinetic;
pub use stick::NoSlip;
pub use tabulated::{FrictionVariable, Tabulated};
pub use tresca::Tresca;

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
    /// ∂s/∂θ, the temperature of the body, in Pa/K.
    pub by_temperature: f64,
}

/// A friction cone that is not round: ‖D⁻¹ q‖ ≤ s with D = Σ μ_i e_i ⊗ e_i, e_i orthonormal in the tangent plane.
///
/// In q̃ = D⁻¹ q and w̃ = D w_τ it is round, and the slip is along its normal: w_τ = γ D⁻² q, γ ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    axes: [Point; 2],
    factors: [f64; 2],
}

impl Cone {
    /// The cone with factors μ₁ along the tangential part of a direction and μ₂ across it. A direction along ν is
    /// replaced by the first coordinate axis that is not along ν.
    #[must_use]
    pub fn new(nu: &Point, direction: &Point, factors: [f64; 2]) -> Cone {
        let tangential = |v: &Point| -> Point {
            let normal = dot(v, nu);
            std::array::from_fn(|c| v[c] - normal * nu[c])
        };
        let basis = [*direction, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let first = basis
            .iter()
            .map(|v| (tangential(v), length(v)))
            .find(|(t, l)| length(t) > 1e-6 * l)
            .map_or([0.0; 3], |(t, _)| t.map(|c| c / length(&t)));
        let second = [
            nu[1] * first[2] - nu[2] * first[1],
            nu[2] * first[0] - nu[0] * first[2],
            nu[0] * first[1] - nu[1] * first[0],
        ];
        Cone { axes: [first, second], factors }
    }

    /// D v.
    #[must_use]
    pub fn apply(&self, v: &Point) -> Point {
        self.scaled(v, self.factors)
    }

    /// D⁻¹ v.
    #[must_use]
    pub fn inverse(&self, v: &Point) -> Point {
        self.scaled(v, self.factors.map(f64::recip))
    }

    fn scaled(&self, v: &Point, factors: [f64; 2]) -> Point {
        let [a, b] = [0, 1].map(|i| factors[i] * dot(v, &self.axes[i]));
        std::array::from_fn(|c| a * self.axes[0][c] + b * self.axes[1][c])
    }
}

/// A law for the bound of the friction traction; the projection onto the cone is done elsewhere.
pub trait FrictionLaw: Debug + Send + Sync {
    /// The bound at a point. `slip_speed` is zero while the point sticks; a law whose bound drops when slip starts
    /// returns the static bound there.
    ///
    /// `pressure` is p₊, or |p| if contact is bilateral.
    fn bound(&self, at: &ContactPoint) -> Bound;
    /// L_τ of (H8) in Pa/m if the pressure has the Lipschitz constant `l_nu`; `None` if the slope is unbounded, or if
    /// the bound does not vanish with the pressure.
    fn lipschitz(&self, l_nu: Option<f64>) -> Option<f64>;
    /// Least ∂s/∂‖w_τ‖ in Pa s/m between two slip speeds, the smaller first, with all else as in `at`; a drop of the
    /// bound at the start of slip is not included. Zero if the bound never decreases with the slip speed.
    fn least_slope(&self, _at: &ContactPoint, _from: f64, _to: f64) -> f64 {
        0.0
    }
    /// True if the bound drops when slip starts: its static value may exceed its limit at vanishing slip speed.
    fn drops_from_rest(&self) -> bool {
        false
    }
    /// True if a point sticks under any load.
    fn never_slips(&self) -> bool {
        false
    }
    /// True if the bound is always zero.
    fn is_frictionless(&self) -> bool {
        false
    }
    /// The friction cone at a point with the normal ν if it is not round; `None` for a round one.
    fn cone(&self, _x: &Point, _nu: &Point) -> Option<Cone> {
        None
    }
}

/// Sample laws for tests that hold for every law.
#[cfg(test)]
pub(crate) fn samples() -> Vec<Arc<dyn FrictionLaw>> {
    let mut all: Vec<Arc<dyn FrictionLaw>> = Vec::new();
    for samples in [
        coulomb::samples,
        tresca::samples,
        stick::samples,
        static_kinetic::samples,
        tabulated::samples,
        formula::samples,
        capped::samples,
        orthotropic::samples,
    ] {
        all.extend(samples());
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_scales_its_axes_and_drops_the_normal() {
        let cone = Cone::new(&[0.0, 0.0, -1.0], &[1.0, 1.0, 5.0], [0.2, 0.5]);
        let along = 0.5f64.sqrt();
        let near = |found: Point, expected: Point| {
            assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-15), "{found:?}, expected {expected:?}");
        };
        near(cone.apply(&[along, along, 7.0]), [0.2 * along, 0.2 * along, 0.0]);
        near(cone.apply(&[along, -along, 0.0]), [0.5 * along, -0.5 * along, 0.0]);
        near(cone.inverse(&cone.apply(&[0.3, -0.7, 0.0])), [0.3, -0.7, 0.0]);
        // Also in two dimensions, with a direction along the normal.
        near(Cone::new(&[0.0, -1.0, 0.0], &[0.0, 1.0, 0.0], [0.2, 0.5]).apply(&[1.0, 0.0, 0.0]), [0.2, 0.0, 0.0]);
    }
}
