//! Three-dimensional laws in bodies of one and two dimensions: the one place where stress or strain is condensed.

use std::sync::Arc;

use super::{OperatorConstants, StressState, TensorLaw};
use crate::tensor::{Point, Sym, SymMap, mandel_len};

/// A three-dimensional law reduced to `dim` dimensions: plane strain, plane stress, uniaxial strain or stress.
///
/// The argument has the first n = d (d + 1)/2 Mandel components. With `PlaneStrain` the others are zero, and the value
/// keeps all of its components: those beyond n hold the strain. With `PlaneStress` the others, ζ, are such that the
/// value has no components beyond n. They minimize the strictly convex W(ξ, ζ) (or solve the monotone equation if there
/// is no W), so they are unique; the tangent is the Schur complement of the three-dimensional one.
///
/// In a Kelvin–Voigt body in plane stress 𝓔 and 𝓥 are reduced separately, as in (5.1): σ₃₃ = 0 then holds with the ε₃₃
/// of 𝓔, whose rate equals the ε̇₃₃ of 𝓥 only if their Poisson ratios agree.
///
/// m and M: the extreme eigenvalues of the reduced [`TensorLaw::bounds`]. Restriction to a subspace keeps the
/// order L ≤ D ≤ U of quadratic forms, and so does the Schur complement, min over ζ of D(ξ, ζ)·(ξ, ζ).
#[derive(Clone, Debug)]
pub struct Reduced<L> {
    law: L,
    kept: usize,
    state: StressState,
    /// U of the three-dimensional law: the metric of the local iteration.
    upper: SymMap,
    bounds: [SymMap; 2],
    constants: OperatorConstants,
}

/// `law` in `dim` dimensions; unchanged in three.
#[must_use]
pub fn reduced<L: TensorLaw + 'static>(law: L, dim: usize, state: StressState) -> Arc<dyn TensorLaw> {
    if dim == 3 { Arc::new(law) } else { Arc::new(Reduced::new(law, dim, state)) }
}

impl<L: TensorLaw> Reduced<L> {
    /// `law` in `dim` dimensions.
    #[must_use]
    pub fn new(law: L, dim: usize, state: StressState) -> Reduced<L> {
        let kept = mandel_len(dim);
        let [lower, upper] = law.bounds();
        let bounds = [lower, upper].map(|map| leading(&reduce(&map, kept, state), kept));
        let monotonicity = OperatorConstants::of_linear(&bounds[0], dim).monotonicity;
        let constants =
            OperatorConstants { monotonicity, lipschitz: OperatorConstants::of_linear(&bounds[1], dim).lipschitz };
        Reduced { law, kept, state, upper, bounds, constants }
    }

    /// The three-dimensional argument and its value.
    ///
    /// With the residual r(ζ) in the metric r·U⁻¹r: Newton's step with the factor α, the largest of 1, ½, … 2⁻⁸ that
    /// reduces the residual by 1 − α/2, else ζ ← ζ − U⁻¹r. The latter maps r to (1 − D̄U⁻¹) r with a mean tangent L ≤
    /// D̄ ≤ U, a contraction by at least 1 − m/M, so the iteration converges from everywhere. It ends at round-off.
    fn complete(&self, x: &Point, xi: &Sym) -> (Sym, Sym) {
        let mut full = *xi;
        full.0[self.kept..].fill(0.0);
        let mut value = self.law.value(x, &full);
        if self.state == StressState::PlaneStrain || self.kept == 6 {
            return (full, value);
        }
        let size = |value: &Sym| solve(&self.upper, self.kept, value).dot(value).sqrt();
        let mut residual = size(&value);
        for _ in 0..MAX_STEPS {
            let tangent = self.law.tangent(x, &full);
            if self.at_round_off(&tangent, &full, &value) {
                return (full, value);
            }
            let step = |correction: &Sym, alpha: f64| {
                let next = full + (-alpha) * *correction;
                let value = self.law.value(x, &next);
                (size(&value), next, value)
            };
            let newton = solve(&tangent, self.kept, &value);
            let damped = (0..=8).map(|halvings| 0.5f64.powi(halvings)).map(|alpha| (alpha, step(&newton, alpha)));
            let next = damped.into_iter().find(|(alpha, next)| next.0 <= (1.0 - 0.5 * alpha) * residual);
            let next = next.map_or_else(|| step(&solve(&self.upper, self.kept, &value), 1.0), |(_, next)| next);
            if next.0 < residual {
                (residual, full, value) = next;
            } else {
                return (full, value);
            }
        }
        // Reached only if the bounds of a law are wrong; NaN marks that there is no solution.
        (Sym([f64::NAN; 6]), Sym([f64::NAN; 6]))
    }

    /// True if the components that should vanish are below the round-off of their terms.
    fn at_round_off(&self, tangent: &SymMap, full: &Sym, value: &Sym) -> bool {
        let terms = |m: usize| (0..6).map(|b| (tangent.0[m][b] * full.0[b]).abs()).sum::<f64>();
        let scale = (self.kept..6).map(terms).fold(value.norm(), f64::max);
        (self.kept..6).all(|m| value.0[m].abs() <= 2.0 * f64::EPSILON * scale)
    }
}

/// More steps than the contraction alone needs to reach round-off at m/M = 1e-3; Newton needs a handful.
const MAX_STEPS: usize = 100_000;

impl<L: TensorLaw> TensorLaw for Reduced<L> {
    fn value(&self, x: &Point, xi: &Sym) -> Sym {
        let (_, mut value) = self.complete(x, xi);
        finish(&mut value, self.kept, self.state);
        value
    }
    fn tangent(&self, x: &Point, xi: &Sym) -> SymMap {
        reduce(&self.law.tangent(x, &self.complete(x, xi).0), self.kept, self.state)
    }
    fn is_linear(&self) -> bool {
        self.law.is_linear()
    }
    fn constants(&self) -> OperatorConstants {
        self.constants
    }
    fn potential(&self, x: &Point, xi: &Sym) -> Option<f64> {
        self.law.potential(x, &self.complete(x, xi).0)
    }
    fn bounds(&self) -> [SymMap; 2] {
        self.bounds
    }
}

/// Sets the components of the value to zero that the reduced law does not return.
fn finish(value: &mut Sym, kept: usize, state: StressState) {
    if state == StressState::PlaneStress || kept == 1 {
        value.0[kept..].fill(0.0);
    }
}

/// A three-dimensional linear map reduced to the first `kept` components of its argument.
pub(super) fn reduce(map: &SymMap, kept: usize, state: StressState) -> SymMap {
    let mut a = *map;
    if state == StressState::PlaneStress {
        for k in (kept..6).rev() {
            let pivot = a.0[k][k];
            // A semidefinite map has zero rows where its pivot is zero.
            if pivot != 0.0 {
                for i in 0..k {
                    let factor = a.0[i][k] / pivot;
                    for j in 0..k {
                        a.0[i][j] -= factor * a.0[k][j];
                    }
                }
            }
        }
    }
    let rows = if state == StressState::PlaneStress || kept == 1 { kept } else { 6 };
    SymMap(std::array::from_fn(|i| std::array::from_fn(|j| if i < rows && j < kept { a.0[i][j] } else { 0.0 })))
}

/// The leading `kept` × `kept` block.
fn leading(map: &SymMap, kept: usize) -> SymMap {
    SymMap(std::array::from_fn(|i| std::array::from_fn(|j| if i < kept && j < kept { map.0[i][j] } else { 0.0 })))
}

/// The components from `kept` on.
fn trailing(sym: &Sym, kept: usize) -> Sym {
    let mut part = *sym;
    part.0[..kept].fill(0.0);
    part
}

/// Solves the trailing block of `map`, components from `kept` on, by elimination without pivoting: the block is
/// positive definite.
fn solve(map: &SymMap, kept: usize, right: &Sym) -> Sym {
    let (mut a, mut b) = (map.0, trailing(right, kept).0);
    for k in (kept..6).rev() {
        for i in kept..k {
            let factor = a[i][k] / a[k][k];
            b[i] -= factor * b[k];
            for j in kept..k {
                a[i][j] -= factor * a[k][j];
            }
        }
    }
    for k in kept..6 {
        b[k] = (b[k] - (kept..k).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
    }
    Sym(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Carreau, Hencky, LawError, Linear, OrthotropicConstants, VonMisesProjection};
    use crate::tensor::Rotation;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// A law that counts its evaluations.
    #[derive(Debug)]
    struct Counting<L>(L, AtomicUsize);
    impl<L: TensorLaw> TensorLaw for Counting<L> {
        fn value(&self, x: &Point, xi: &Sym) -> Sym {
            self.1.fetch_add(1, Ordering::Relaxed);
            self.0.value(x, xi)
        }
        fn tangent(&self, x: &Point, xi: &Sym) -> SymMap {
            self.0.tangent(x, xi)
        }
        fn constants(&self) -> OperatorConstants {
            self.0.constants()
        }
        fn bounds(&self) -> [SymMap; 2] {
            self.0.bounds()
        }
    }

    fn counts(law: impl TensorLaw, dim: usize) -> (f64, usize) {
        let law = Reduced::new(Counting(law, AtomicUsize::new(0)), dim, StressState::PlaneStress);
        let mut worst = 0;
        for i in 0..2000 {
            let before = law.law.1.load(Ordering::Relaxed);
            let size = 10f64.powf(f64::from(i % 100) / 10.0 - 6.0);
            let xi = Sym(std::array::from_fn(|m| size * (f64::from(i + 1) * (1.0 + 0.618 * m as f64)).sin()));
            let value = law.value(&[0.0; 3], &xi);
            assert!(value.norm().is_finite() && value.0[law.kept..].iter().all(|&v| v == 0.0));
            worst = worst.max(law.law.1.load(Ordering::Relaxed) - before);
        }
        (law.law.1.load(Ordering::Relaxed) as f64 / 2000.0, worst)
    }

    #[test]
    fn the_local_iteration_takes_a_handful_of_evaluations() -> Result<(), LawError> {
        let ply =
            OrthotropicConstants { young: [140e9, 10e9, 10e9], poisson: [0.3, 0.3, 0.45], shear: [5e9, 5e9, 3.4e9] };
        for dim in [1, 2] {
            let usual = [
                ("projection", counts(Hencky::new(2.0, VonMisesProjection::new(1.0, 5.0, 1e-3)?)?, dim)),
                ("softening", counts(Hencky::new(2.0, VonMisesProjection::new(1.0, -1.99, 1e-3)?)?, dim)),
                ("thinning", counts(Hencky::new(2.0, Carreau::new(3.0, 0.1, 2e3, 0.4)?)?, dim)),
                ("saturating", counts(Hencky::new(2.0, Carreau::new(1.0, 1e-6, 1e3, 0.0)?)?, dim)),
                ("nearly incompressible", counts(Hencky::new(1e5, Carreau::new(1.0, 1e-2, 1e3, 0.1)?)?, dim)),
                (
                    "ply",
                    counts(
                        Linear::orthotropic(&ply, &Rotation::euler([0.3, 0.9, -0.5]), 3, StressState::PlaneStress)?,
                        dim,
                    ),
                ),
            ];
            // A shear stiffness that varies over six orders of magnitude, with an equally soft volume.
            let hard = [
                ("without bulk", counts(Hencky::new(0.0, Carreau::new(1.0, 1e-6, 1e3, 0.1)?)?, dim)),
                ("compressible and saturating", counts(Hencky::new(1e-4, Carreau::new(1.0, 1e-6, 1e3, 0.0)?)?, dim)),
            ];
            for (what, (mean, worst)) in usual {
                assert!(mean <= 4.0 && worst <= 8, "{what} in {dim}: {mean} and at most {worst}");
            }
            for (what, (mean, worst)) in hard {
                assert!(mean <= 20.0 && worst <= 64, "{what} in {dim}: {mean} and at most {worst}");
            }
        }
        Ok(())
    }
}
