//! Shear functions s ↦ c(s) of [`super::Hencky`]: the deviatoric value c(‖ξ^D‖) ξ^D of isotropic nonlinear laws.

use std::fmt::Debug;

use super::{LawError, in_range};

/// A shear function c, with τ(s) = c(s) s the norm of the deviatoric value; s ≥ 0 is the norm ‖ξ^D‖.
///
/// In simple shear of strain γ (or rate γ̇) s = γ/√2 and the shear stress is c γ/2.
pub trait ShearLaw: Debug + Send + Sync {
    /// c(s), twice the secant shear modulus; finite at 0.
    fn secant(&self, s: f64) -> f64;
    /// τ′(s) = c(s) + s c′(s), twice the tangent shear modulus; c(0) at 0.
    fn tangent(&self, s: f64) -> f64;
    /// ∫₀^s τ.
    fn potential(&self, s: f64) -> f64;
    /// Infimum and supremum of τ′ over s ≥ 0.
    fn range(&self) -> [f64; 2];
}

/// c(s) = 2μ + β (1 − κ/s)₊: 2μ ξ^D + β (ξ − P_K ξ), P_K the projection on the von Mises convex K = {ξ: ‖ξ^D‖ ≤ κ}.
///
/// With β > 0 this is the elasticity operator 𝓒ξ + β (ξ − P_K ξ) of the literature on frictional contact (Han and
/// Sofonea 2002; Sofonea and Matei 2012, *Mathematical Models in Contact Mechanics*, on nonlinear elastic laws). With
/// −2μ < β < 0 the body softens from 2μ to 2μ + β once ‖ξ^D‖ exceeds κ: Hencky's deformation theory with linear
/// hardening.
///
/// I − P_K is the gradient of ½ dist(·, K)², hence monotone and 1-Lipschitz; in terms of s, τ′ ∈ {2μ, 2μ + β}. At the
/// kink s = κ the inner tangent is used, an element of the generalized derivative: the law is semismooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VonMisesProjection {
    twice_shear: f64,
    excess: f64,
    radius: f64,
}

impl VonMisesProjection {
    /// μ = `shear` > 0 in Pa, β = `excess` > −2μ in Pa, κ = `radius` > 0, a strain.
    ///
    /// # Errors
    /// Fails if a number is outside its range; the error names it.
    pub fn new(shear: f64, excess: f64, radius: f64) -> Result<VonMisesProjection, LawError> {
        let twice_shear = 2.0 * in_range("the shear modulus μ", shear, "a positive number", shear > 0.0)?;
        in_range("β", excess, "a number above −2μ, else the law is not strongly monotone", twice_shear + excess > 0.0)?;
        in_range("the radius κ of the von Mises convex", radius, "a positive number", radius > 0.0)?;
        Ok(VonMisesProjection { twice_shear, excess, radius })
    }
}

impl ShearLaw for VonMisesProjection {
    fn secant(&self, s: f64) -> f64 {
        if s > self.radius { self.twice_shear + self.excess * (1.0 - self.radius / s) } else { self.twice_shear }
    }
    fn tangent(&self, s: f64) -> f64 {
        if s > self.radius { self.twice_shear + self.excess } else { self.twice_shear }
    }
    fn potential(&self, s: f64) -> f64 {
        0.5 * (self.twice_shear * s * s + self.excess * (s - self.radius).max(0.0).powi(2))
    }
    fn range(&self) -> [f64; 2] {
        let outside = self.twice_shear + self.excess;
        [self.twice_shear.min(outside), self.twice_shear.max(outside)]
    }
}

/// c = 2η, η(s) = η_∞ + (η₀ − η_∞)(1 + (λs)²)^((n−1)/2), 0 ≤ n ≤ 1 (Carreau 1972).
///
/// For a viscosity in Pa s, s = ‖ε(u̇)^D‖ (rheology's γ̇ is √2 s, so its λ is λ/√2 here); for the shear modulus of a
/// Hencky solid in Pa, 1/λ is the strain at which it softens. With n = 0 its stress saturates up to the part of η_∞.
///
/// τ′(s) = 2η_∞ + 2(η₀ − η_∞) h(λs) with h(y) = (1 + y²)^((n−3)/2) (1 + n y²), and h′(y) = (n − 1) y (3 + n
/// y²)(1 + y²)^((n−5)/2) ≤ 0: τ′ decreases from 2η₀ at 0 to its infimum 2η_∞, reached at infinity (2η₀ if n = 1). So
/// with η_∞ = 0 and n < 1 the law is monotone but not strongly, and (H1) fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carreau {
    zero: f64,
    infinite: f64,
    time: f64,
    index: f64,
}

impl Carreau {
    /// η₀ = `zero` > 0, η_∞ = `infinite` in [0, η₀], λ = `time` > 0, n = `index` in [0, 1].
    ///
    /// # Errors
    /// Fails if a number is outside its range; the error names it.
    pub fn new(zero: f64, infinite: f64, time: f64, index: f64) -> Result<Carreau, LawError> {
        in_range("η₀", zero, "a positive number", zero > 0.0)?;
        in_range("η_∞", infinite, "a number from 0 to η₀", (0.0..=zero).contains(&infinite))?;
        in_range("λ", time, "a positive number", time > 0.0)?;
        in_range("n", index, "a number from 0 to 1", (0.0..=1.0).contains(&index))?;
        Ok(Carreau { zero, infinite, time, index })
    }

    /// The power law η = K s^(n−1) regularized as η_∞ + K (δ² + s²)^((n−1)/2) (Bercovier and Engelman 1980): Carreau's
    /// law with η₀ = η_∞ + K δ^(n−1), λ = 1/δ. K is `consistency` > 0, n `index` in [0, 1], δ `threshold` > 0, η_∞
    /// `floor` ≥ 0.
    ///
    /// The pure power law with n < 1 violates (H1) twice: η grows without bound as s → 0, so it is not Lipschitz, and
    /// vanishes as s → ∞, so it is not strongly monotone. δ repairs the former (M = 2η₀), a positive floor the latter
    /// (m = 2η_∞).
    ///
    /// # Errors
    /// Fails if a number is outside its range; the error names it.
    pub fn power_law(consistency: f64, index: f64, threshold: f64, floor: f64) -> Result<Carreau, LawError> {
        in_range("the consistency K", consistency, "a positive number", consistency > 0.0)?;
        in_range("n", index, "a number from 0 to 1", (0.0..=1.0).contains(&index))?;
        in_range("the threshold δ", threshold, "a positive number", threshold > 0.0)?;
        in_range("the floor η_∞", floor, "a number that is not negative", floor >= 0.0)?;
        Carreau::new(floor + consistency * threshold.powf(index - 1.0), floor, 1.0 / threshold, index)
    }
}

impl ShearLaw for Carreau {
    fn secant(&self, s: f64) -> f64 {
        2.0 * self.infinite
            + 2.0 * (self.zero - self.infinite) * (1.0 + (self.time * s).powi(2)).powf(0.5 * (self.index - 1.0))
    }
    fn tangent(&self, s: f64) -> f64 {
        let y = (self.time * s).powi(2);
        2.0 * self.infinite
            + 2.0
                * (self.zero - self.infinite)
                * (1.0 + y).powf(0.5 * (self.index - 1.0))
                * ((1.0 + self.index * y) / (1.0 + y))
    }
    fn potential(&self, s: f64) -> f64 {
        let (y, p) = ((self.time * s).powi(2), 0.5 * (self.index + 1.0));
        // ((1 + y)^p − 1)/(p λ²) without cancellation for small y.
        let shed = (p * y.ln_1p()).exp_m1() / (p * self.time * self.time);
        self.infinite * s * s + (self.zero - self.infinite) * shed
    }
    fn range(&self) -> [f64; 2] {
        // At n = 1 the law is Newton's.
        let least = if self.index < 1.0 { self.infinite } else { self.zero };
        [2.0 * least, 2.0 * self.zero]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Hencky, TensorLaw};
    use crate::tensor::Sym;

    /// (ξ − P)·(η − P) ≤ 0 for all η in K and P in K: the value is 𝓒ξ + β (ξ − P_K ξ) with the projection P_K.
    #[test]
    fn the_excess_comes_from_the_projection_on_the_von_mises_convex() -> Result<(), LawError> {
        let (bulk, shear, excess, radius) = (2.0, 1.5, 4.0, 0.3);
        let law = Hencky::new(bulk, VonMisesProjection::new(shear, excess, radius)?)?;
        for i in 0..40 {
            let t = f64::from(i);
            let xi = Sym(std::array::from_fn(|m| 0.4 * (1.3 * t + 2.1 * m as f64).sin()));
            let linear = bulk * xi.trace() * Sym::identity(3) + 2.0 * shear * xi.deviator();
            let outside = (1.0 / excess) * (law.value(&[0.0; 3], &xi) - linear);
            let projection = xi - outside;
            assert!(projection.deviator().norm() <= radius * (1.0 + 1e-14));
            assert_eq!(xi.deviator().norm() > radius, outside.norm() > 0.0);
            for j in 0..40 {
                let eta = Sym(std::array::from_fn(|m| (0.7 * f64::from(j) + 1.9 * m as f64).cos()));
                let inside = eta.trace() * Sym::identity(3) + (radius / eta.deviator().norm()) * eta.deviator();
                assert!(outside.dot(&(inside - projection)) <= 1e-14);
            }
        }
        Ok(())
    }

    /// Carreau's plateaus with his power law between them; the regularized power law has the pure one's stress 2K sⁿ
    /// for s ≫ δ.
    #[test]
    fn plateaus_and_slope_of_carreau_s_law() -> Result<(), LawError> {
        let law = Carreau::new(5.0, 0.0, 2.0, 0.4)?;
        assert!((law.secant(0.0) - 10.0).abs() < 1e-15 && (law.secant(0.5) - 10.0 * 2f64.powf(-0.3)).abs() < 1e-14);
        let slope = (law.secant(1e7) / law.secant(1e6)).log10();
        assert!((slope + 0.6).abs() < 1e-12, "{slope}");
        let power = Carreau::power_law(3.0, 0.25, 1e-6, 0.0)?;
        assert!((power.secant(2.0) * 2.0 / (2.0 * 3.0 * 2f64.powf(0.25)) - 1.0).abs() < 1e-12);
        assert!((power.range()[1] / (2.0 * 3.0 * 1e-6f64.powf(-0.75)) - 1.0).abs() < 1e-14);
        // n = 0 saturates: τ → 2K.
        let flat = Carreau::power_law(3.0, 0.0, 1e-3, 0.0)?;
        assert!((flat.secant(1e3) * 1e3 - 6.0).abs() < 1e-11);
        Ok(())
    }

    /// τ′ and ∫τ against differences of τ and of ∫τ, over sixteen decades.
    #[test]
    fn derivatives_and_integrals() -> Result<(), LawError> {
        let laws: [&dyn ShearLaw; 4] = [
            &Carreau::new(3.0, 0.1, 2.0, 0.4)?,
            &Carreau::new(3.0, 0.0, 2.0, 0.0)?,
            &VonMisesProjection::new(1.0, 5.0, 0.3)?,
            &VonMisesProjection::new(1.0, -1.5, 0.3)?,
        ];
        for law in laws {
            assert!((law.secant(0.0) - law.tangent(0.0)).abs() < 1e-15 && law.potential(0.0).abs() == 0.0);
            for decade in -8..8 {
                let s = 2.0 * 10f64.powi(decade);
                let h = 1e-5 * s;
                let tau = |s: f64| law.secant(s) * s;
                let (slope, force) =
                    ((tau(s + h) - tau(s - h)) / (2.0 * h), (law.potential(s + h) - law.potential(s - h)) / (2.0 * h));
                assert!(
                    (slope - law.tangent(s)).abs() < 1e-8 * law.range()[1],
                    "{law:?} at {s}: {slope} {}",
                    law.tangent(s)
                );
                assert!((force / tau(s) - 1.0).abs() < 1e-8, "{law:?} at {s}: {force} {}", tau(s));
            }
        }
        Ok(())
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        assert!(matches!(VonMisesProjection::new(1.0, -2.0, 0.1), Err(LawError::Range { name: "β", found: -2.0, .. })));
        assert!(matches!(VonMisesProjection::new(0.0, 1.0, 0.1), Err(LawError::Range { found: 0.0, .. })));
        assert!(matches!(VonMisesProjection::new(1.0, 1.0, f64::INFINITY), Err(LawError::Range { .. })));
        assert!(matches!(Carreau::new(1.0, 2.0, 1.0, 0.5), Err(LawError::Range { name: "η_∞", found: 2.0, .. })));
        assert!(matches!(Carreau::new(1.0, 0.0, 1.0, 1.1), Err(LawError::Range { name: "n", found: 1.1, .. })));
        assert!(matches!(Carreau::power_law(1.0, 0.5, 0.0, 0.0), Err(LawError::Range { name: "the threshold δ", .. })));
        assert!(matches!(
            Hencky::new(-1.0, Carreau { zero: 1.0, infinite: 0.0, time: 1.0, index: 1.0 }),
            Err(LawError::Range { found: -1.0, .. })
        ));
    }
}
