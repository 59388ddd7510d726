//! Isotropic nonlinear laws that split into a linear spherical and a nonlinear deviatoric part.

use super::{LawError, OperatorConstants, ShearLaw, TensorLaw, in_range};
use crate::tensor::{Point, Sym, SymMap};

/// ξ ↦ κ tr(ξ) I + c(‖ξ^D‖) ξ^D in three dimensions, c a [`ShearLaw`]; [`super::Reduced`] makes it plane.
///
/// 𝓔 of this form is the Hencky material (deformation theory; Zeidler 1988, *Nonlinear Functional Analysis* IV, chapter
/// 62; Han and Sofonea 2002), 𝓥 a generalized Newtonian viscosity. ξ^D is the deviator in three dimensions: for a plane
/// strain it has a component 33.
///
/// With s = ‖ξ^D‖, τ(s) = c(s) s and n = ξ^D/s the tangent is κ I⊗I + c (Id^D − n⊗n) + τ′ n⊗n. Since c(s) is the mean
/// of τ′ over (0, s), both lie between r = inf τ′ and R = sup τ′, so that κ I⊗I + r Id^D ≤ D ≤ κ I⊗I + R Id^D, and the
/// law is the gradient of κ/2 tr(ξ)² + ∫₀^s τ. Hence (mean value theorem) m = min(3κ, r) and M = max(3κ, R) in (H1),
/// (H2) are the best possible: D takes the value τ′ along n. In plane strain and in one dimension the same holds for
/// the restricted forms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hencky<S> {
    bulk: f64,
    shear: S,
}

impl<S: ShearLaw> Hencky<S> {
    /// κ = `bulk` ≥ 0 in Pa or Pa s (0 is monotone, but not strongly) and the shear function.
    ///
    /// # Errors
    /// Fails if the bulk modulus is negative or not finite.
    pub fn new(bulk: f64, shear: S) -> Result<Hencky<S>, LawError> {
        Ok(Hencky { bulk: in_range("the bulk modulus κ", bulk, "a number that is not negative", bulk >= 0.0)?, shear })
    }

    /// κ I⊗I + c Id^D.
    fn linear(&self, c: f64) -> SymMap {
        SymMap::isotropic(3, self.bulk - c / 3.0, c)
    }
}

impl<S: ShearLaw> TensorLaw for Hencky<S> {
    fn value(&self, _x: &Point, xi: &Sym) -> Sym {
        let deviator = xi.deviator();
        self.bulk * xi.trace() * Sym::identity(3) + self.shear.secant(deviator.norm()) * deviator
    }
    fn tangent(&self, _x: &Point, xi: &Sym) -> SymMap {
        let deviator = xi.deviator();
        let s = deviator.norm();
        let (secant, tangent) = (self.shear.secant(s), self.shear.tangent(s));
        let mut map = self.linear(secant);
        if s > 0.0 {
            let n = (1.0 / s) * deviator;
            for (i, row) in map.0.iter_mut().enumerate() {
                for (j, entry) in row.iter_mut().enumerate() {
                    *entry += (tangent - secant) * n.0[i] * n.0[j];
                }
            }
        }
        map
    }
    fn constants(&self) -> OperatorConstants {
        let [least, most] = self.shear.range();
        OperatorConstants { monotonicity: least.min(3.0 * self.bulk), lipschitz: most.max(3.0 * self.bulk) }
    }
    fn potential(&self, _x: &Point, xi: &Sym) -> Option<f64> {
        Some(0.5 * self.bulk * xi.trace().powi(2) + self.shear.potential(xi.deviator().norm()))
    }
    fn bounds(&self) -> [SymMap; 2] {
        self.shear.range().map(|c| self.linear(c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Carreau, StressState, VonMisesProjection, reduced};
    use crate::tensor::mandel_len;
    use std::sync::Arc;

    const X: Point = [0.0; 3];
    const BULK: f64 = 2.0;
    const STATES: [StressState; 2] = [StressState::PlaneStress, StressState::PlaneStrain];

    /// Stiffening, softening, shear thinning, saturating, a power law, and a nearly incompressible law.
    fn shears() -> Result<Vec<(f64, Arc<dyn ShearLaw>)>, LawError> {
        Ok(vec![
            (BULK, Arc::new(VonMisesProjection::new(1.0, 5.0, 1e-3)?)),
            (BULK, Arc::new(VonMisesProjection::new(1.0, -1.5, 1e-3)?)),
            (BULK, Arc::new(Carreau::new(3.0, 0.1, 2e3, 0.4)?)),
            (BULK, Arc::new(Carreau::new(1.0, 1e-3, 1e3, 0.0)?)),
            (BULK, Arc::new(Carreau::power_law(0.1, 0.25, 1e-4, 0.2)?)),
            (1e5 * BULK, Arc::new(Carreau::new(1.0, 1e-2, 1e3, 0.1)?)),
        ])
    }

    impl ShearLaw for Arc<dyn ShearLaw> {
        fn secant(&self, s: f64) -> f64 {
            self.as_ref().secant(s)
        }
        fn tangent(&self, s: f64) -> f64 {
            self.as_ref().tangent(s)
        }
        fn potential(&self, s: f64) -> f64 {
            self.as_ref().potential(s)
        }
        fn range(&self) -> [f64; 2] {
            self.as_ref().range()
        }
    }

    /// Uniaxial tension by its scalar equation, the norm s of the deviator as parameter: τ(s) = √(2/3) σ and tr
    /// ξ = σ/(3κ), so ξ₁₁ = σ/(9κ) + √(2/3) s and across σ/(9κ) − s/√6. On a line, in a sheet and, with its transverse
    /// strains, in space.
    #[test]
    fn uniaxial_tension_satisfies_the_scalar_equation() -> Result<(), LawError> {
        for (bulk, shear) in shears()? {
            let line = reduced(Hencky::new(bulk, shear.clone())?, 1, StressState::PlaneStress);
            let sheet = reduced(Hencky::new(bulk, shear.clone())?, 2, StressState::PlaneStress);
            let space = Hencky::new(bulk, shear.clone())?;
            for s in [1e-7, 1e-4, 0.99e-3, 1.01e-3, 1e-2, 1.0, 1e3] {
                let sigma = 1.5f64.sqrt() * shear.secant(s) * s;
                let (along, across) =
                    (sigma / (9.0 * bulk) + (2.0f64 / 3.0).sqrt() * s, sigma / (9.0 * bulk) - s / 6f64.sqrt());
                // Effect on the stress of round-off in the strain, times the stiffness.
                let tolerance = 1e-14 * (sigma + space.constants().lipschitz * along);
                for sign in [1.0, -1.0] {
                    let strain = Sym([sign * along, sign * across, 0.0, sign * across, 0.0, 0.0]);
                    let mut flat = strain;
                    flat.0[3] = 0.0;
                    let expected = Sym([sign * sigma, 0.0, 0.0, 0.0, 0.0, 0.0]);
                    for (what, found) in [
                        ("line", line.value(&X, &flat)),
                        ("sheet", sheet.value(&X, &flat)),
                        ("space", space.value(&X, &strain)),
                    ] {
                        assert!(
                            (found - expected).norm() < tolerance,
                            "{shear:?}, {what}, s = {s}: {found:?} {expected:?}"
                        );
                    }
                }
            }
        }
        Ok(())
    }

    /// Simple shear γ: σ₁₂ = c(γ/√2) γ/2 without pressure, in every state.
    #[test]
    fn simple_shear_is_the_shear_function() -> Result<(), LawError> {
        for (bulk, shear) in shears()? {
            for state in STATES {
                let law = reduced(Hencky::new(bulk, shear.clone())?, 2, state);
                for gamma in [1e-5, 1e-3, 0.1, 10.0] {
                    let expected = shear.secant(gamma / 2f64.sqrt()) * gamma / 2.0;
                    let found = law.value(&X, &Sym::from_fn(2, |i, j| if i == j { 0.0 } else { gamma / 2.0 }));
                    assert!(
                        (found.get(0, 1) / expected - 1.0).abs() < 1e-14 && found.trace().abs() < 1e-14 * expected,
                        "{shear:?}: {found:?} {expected}"
                    );
                }
            }
        }
        Ok(())
    }

    /// In plane stress σ₃₃ vanishes at a strain ε₃₃ that is recomputed here by bisection.
    #[test]
    fn plane_stress_agrees_with_bisection() -> Result<(), LawError> {
        for (bulk, shear) in shears()? {
            let space = Hencky::new(bulk, shear.clone())?;
            let sheet = reduced(Hencky::new(bulk, shear.clone())?, 2, StressState::PlaneStress);
            for i in 0..20 {
                let size = 10f64.powi(i % 10 - 6);
                let xi = Sym([
                    size * f64::from(i).sin(),
                    size * f64::from(2 * i).cos(),
                    size * f64::from(3 * i).sin(),
                    0.0,
                    0.0,
                    0.0,
                ]);
                let with = |z: f64| space.value(&X, &Sym([xi.0[0], xi.0[1], xi.0[2], z, 0.0, 0.0]));
                let (mut low, mut high) = (-4.0 * size, 4.0 * size);
                for _ in 0..200 {
                    let middle = 0.5 * (low + high);
                    if with(middle).0[3] < 0.0 {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                let (found, expected) = (sheet.value(&X, &xi), with(high));
                for m in 0..3 {
                    let tolerance = 1e-14 * space.constants().lipschitz * size;
                    assert!(
                        (found.0[m] - expected.0[m]).abs() < tolerance,
                        "{shear:?} at {xi:?}: {found:?} {expected:?}"
                    );
                }
                assert!(found.0[3..].iter().all(|&v| v == 0.0));
            }
        }
        Ok(())
    }

    /// Tangents at sampled arguments reach the declared m and M within 3 % and do not exceed them.
    #[test]
    fn constants_are_sharp() -> Result<(), LawError> {
        for (bulk, shear) in shears()? {
            for (dim, state) in (1..=3).flat_map(|dim| STATES.map(|state| (dim, state))) {
                let law = reduced(Hencky::new(bulk, shear.clone())?, dim, state);
                let (mut least, mut most) = (f64::INFINITY, 0.0f64);
                for i in 0..400 {
                    let size = 10f64.powf(f64::from(i % 40) / 2.0 - 7.0);
                    let mut xi = Sym::ZERO;
                    for m in 0..mandel_len(dim) {
                        xi.0[m] = size * (f64::from(i) * (1.0 + 0.618 * m as f64)).sin();
                    }
                    if i % 3 == 0 && dim > 1 {
                        xi = Sym([0.0, 0.0, size, 0.0, 0.0, 0.0]);
                    }
                    let tangent = OperatorConstants::of_linear(&law.tangent(&X, &xi), dim);
                    least = least.min(tangent.monotonicity);
                    most = most.max(tangent.lipschitz);
                }
                let OperatorConstants { monotonicity: m, lipschitz: big } = law.constants();
                assert!(least >= m * (1.0 - 1e-9) && least <= 1.03 * m, "{law:?}: m = {m}, sampled {least}");
                assert!(most <= big * (1.0 + 1e-9) && most >= 0.97 * big, "{law:?}: M = {big}, sampled {most}");
            }
        }
        Ok(())
    }
}
