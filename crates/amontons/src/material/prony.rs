//! Relaxing stress: branches of a generalized Maxwell body (Prony series).

use std::sync::Arc;

use super::{LawError, Linear, OperatorConstants, TensorLaw, in_range};
use crate::field::{Coefficient, Law};
use crate::tensor::{Point, Sym, SymMap};

/// Maxwell branches in parallel with 𝓔 and 𝓥: σ = 𝓔ε + 𝓥ε̇ + Σ q_i − θ𝓜 with q̇_i + q_i/τ_i = 𝓖_i ε̇, each 𝓖_i linear.
///
/// A branch is a spring 𝓖_i in series with a dashpot τ_i 𝓖_i (Simo and Hughes 1998, *Computational Inelasticity*,
/// chapter 10). 𝓔 is the long-term law: under a constant strain the stress relaxes to it from the instantaneous law 𝓔 +
/// Σ 𝓖_i. The state of a branch is the strain e_i of its spring, q_i = 𝓖_i e_i, so that no 𝓖_i must be inverted (a
/// branch may act on deviators only):
///
/// ```text
/// ė_i + e_i/τ_i = ε̇        e_i^n = (e_i^{n−1} + ε_n − ε_{n−1})/(1 + k/τ_i)          backward Euler
/// ```
///
/// Multiplied by q_i^n this is the exact energy identity of the step, with two nonnegative terms besides the stored
/// energy:
///
/// ```text
/// q_i^n:(ε_n − ε_{n−1}) = [½ e_i:𝓖_i e_i]_{n−1}^n + (k/τ_i) e_i^n:𝓖_i e_i^n + ½ (e_i^n − e_i^{n−1}):𝓖_i (e_i^n −
///        e_i^{n−1}) work                    stored                   dissipated                      dissipated by the
/// scheme ```
///
/// Both 𝓖_i and τ_i may vary in space.
///
/// In plane stress each branch is reduced on its own, which is exact if all have the Poisson ratio of 𝓔
/// ([`Prony::ratios`]).
#[derive(Clone, Debug)]
pub struct Prony {
    terms: Vec<Branch>,
}

/// One Maxwell branch; as a [`TensorLaw`] it is its spring 𝓖_i.
#[derive(Clone, Debug)]
pub struct Branch {
    /// 𝓖_i in Pa; its value at one point if it varies in space.
    pub modulus: SymMap,
    /// τ_i in s; its minimum if it varies in space.
    pub time: f64,
    /// 𝓖_i if it varies in space.
    spring: Option<Law<dyn TensorLaw>>,
    /// τ_i if it varies in space, with its maximum.
    times: Option<(Coefficient<f64>, f64)>,
}

impl Branch {
    /// The uniform branch with this spring.
    #[must_use]
    pub const fn new(modulus: SymMap, time: f64) -> Branch {
        Branch { modulus, time, spring: None, times: None }
    }

    /// The branch at a point.
    #[must_use]
    pub fn at(&self, x: &Point) -> Branch {
        let time = self.times.as_ref().map_or(self.time, |(time, _)| time.at(x));
        Branch::new(self.tangent(x, &Sym::ZERO), time)
    }

    /// The spring 𝓖_i.
    #[must_use]
    pub fn law(&self) -> Law<dyn TensorLaw> {
        self.spring.clone().unwrap_or_else(|| self.clone().into())
    }

    /// True if 𝓖_i varies in space.
    #[must_use]
    pub fn modulus_varies(&self) -> bool {
        self.spring.is_some()
    }

    /// True if τ_i varies in space.
    #[must_use]
    pub fn time_varies(&self) -> bool {
        self.times.is_some()
    }

    /// The least and the largest τ_i in s.
    #[must_use]
    pub fn times(&self) -> [f64; 2] {
        [self.time, self.times.as_ref().map_or(self.time, |(_, most)| *most)]
    }

    /// 1/(1 + k/τ): the fraction of the spring's strain that remains after a step of length k.
    #[must_use]
    pub fn factor(&self, k: f64) -> f64 {
        1.0 / (1.0 + k / self.time)
    }
}

impl TensorLaw for Branch {
    fn value(&self, x: &Point, xi: &Sym) -> Sym {
        match &self.spring {
            Some(law) => law.value(x, xi),
            None => self.modulus.apply(xi),
        }
    }
    fn tangent(&self, x: &Point, xi: &Sym) -> SymMap {
        match &self.spring {
            Some(law) => law.tangent(x, xi),
            None => self.modulus,
        }
    }
    fn is_linear(&self) -> bool {
        true
    }
    fn constants(&self) -> OperatorConstants {
        self.spring.as_ref().map_or_else(|| OperatorConstants::of_linear(&self.modulus, 3), |law| law.constants())
    }
}

fn scaled(mut map: SymMap, factor: f64) -> SymMap {
    map.0.iter_mut().flatten().for_each(|entry| *entry *= factor);
    map
}

/// The spring at a point with `ratio` times the modulus of a linear law.
fn spring(law: &dyn TensorLaw, x: &Point, ratio: f64) -> Arc<dyn TensorLaw> {
    let OperatorConstants { monotonicity, lipschitz } = law.constants();
    let constants = OperatorConstants { monotonicity: ratio * monotonicity, lipschitz: ratio * lipschitz };
    Arc::new(Linear::with_constants(&scaled(law.tangent(x, &Sym::ZERO), ratio), constants))
}

/// The least and the largest value over points, or at the origin if there are none; NaN if a value is.
fn bounds(coefficient: &Coefficient<f64>, points: &[Point]) -> [f64; 2] {
    if let Some(value) = coefficient.constant() {
        return [value; 2];
    }
    let points = if points.is_empty() { &[[0.0; 3]] } else { points };
    points.iter().map(|x| coefficient.at(x)).fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| {
        if (least + value).is_nan() { [f64::NAN; 2] } else { [least.min(value), most.max(value)] }
    })
}

/// The energy identity of one step of all branches, in J/m³: `work = stored + dissipated + scheme`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BranchBalance {
    /// Work of the relaxing stress at the end of the step on the increment of strain.
    pub work: f64,
    /// Increase of the stored energy.
    pub stored: f64,
    /// Dissipation of the dashpots, not negative.
    pub dissipated: f64,
    /// Dissipation of backward Euler, not negative and of second order in the increment.
    pub scheme: f64,
}

impl Prony {
    /// Branches given by a linear law 𝓖_i in Pa and a relaxation time τ_i > 0 in s.
    ///
    /// # Errors
    /// Fails if a law is not linear or not monotone, or a time is not positive.
    pub fn new(terms: &[(&Law<dyn TensorLaw>, f64)]) -> Result<Prony, LawError> {
        let term = |&(law, time): &(&Law<dyn TensorLaw>, f64)| {
            if !law.is_linear() {
                return Err(LawError::NotLinear);
            }
            let c = law.constants();
            // Round-off of an eigenvalue is relative to the largest; a branch may act on deviators only.
            if c.monotonicity.is_nan() || c.monotonicity < -1e-14 * c.lipschitz {
                return Err(LawError::NotPositive {
                    what: "modulus of a branch",
                    least: c.monotonicity,
                    most: c.lipschitz,
                });
            }
            let time = in_range("a relaxation time", time, "a positive number", time > 0.0)?;
            let x = law.graded().map_or([0.0; 3], |graded| graded.extremes()[0].x);
            let spring = law.graded().map(|_| law.clone());
            Ok(Branch { modulus: law.tangent(&x, &Sym::ZERO), time, spring, times: None })
        };
        Ok(Prony { terms: terms.iter().map(term).collect::<Result<_, _>>()? })
    }

    /// Branches 𝓖_i = g_i 𝓔 given by pairs (g_i, τ_i), with g_i > 0 relative to the long-term modulus (not to the
    /// instantaneous 𝓔 (1 + Σ g_i)).
    ///
    /// # Errors
    /// Fails if 𝓔 is not linear, or a ratio or time is not positive.
    pub fn ratios(elasticity: &Law<dyn TensorLaw>, pairs: &[(f64, f64)]) -> Result<Prony, LawError> {
        let mut prony = Prony::new(&pairs.iter().map(|&(_, time)| (elasticity, time)).collect::<Vec<_>>())?;
        for (term, &(ratio, _)) in prony.terms.iter_mut().zip(pairs) {
            in_range("the ratio of a branch", ratio, "a positive number", ratio > 0.0)?;
            term.modulus = scaled(term.modulus, ratio);
            term.spring = term.spring.take().map(|law| law.map(move |law, x| spring(law, x, ratio)));
        }
        Ok(prony)
    }

    /// Branches 𝓖_i = g_i(x) 𝓔_i given by triples (𝓔_i, g_i, τ_i), some varying in space, with their bounds over
    /// points; 𝓔_i is 𝓔 or its deviatoric part ([`super::Isotropic::deviatoric`]). See [`Prony::ratios`].
    ///
    /// # Errors
    /// Fails like [`Prony::ratios`], at any of the points.
    pub fn varying(
        branches: &[(Law<dyn TensorLaw>, Coefficient<f64>, Coefficient<f64>)],
        points: &[Point],
    ) -> Result<Prony, LawError> {
        let mut prony = Prony { terms: Vec::new() };
        for (elasticity, ratio, time) in branches {
            let [least, most] = bounds(time, points);
            let branch = if let Some(ratio) = ratio.constant().filter(|_| elasticity.graded().is_none()) {
                Prony::ratios(elasticity, &[(ratio, least)])?
            } else {
                let least_ratio = bounds(ratio, points)[0];
                in_range("the ratio of a branch", least_ratio, "a positive number", least_ratio > 0.0)?;
                let (law, ratio) = (elasticity.clone(), ratio.clone());
                let law = Law::in_space(points, move |x| spring(law.at(x).as_ref(), x, ratio.at(x)));
                Prony::new(&[(&law, least)])?
            };
            let times = time.constant().is_none().then(|| (time.clone(), most));
            prony.terms.extend(branch.terms.into_iter().map(|branch| Branch { times: times.clone(), ..branch }));
        }
        Ok(prony)
    }

    /// The branches at a point; the methods below apply to uniform branches.
    #[must_use]
    pub fn at(&self, x: &Point) -> Prony {
        Prony { terms: self.terms.iter().map(|branch| branch.at(x)).collect() }
    }

    /// The branches.
    #[must_use]
    pub fn branches(&self) -> &[Branch] {
        &self.terms
    }

    /// Number of branches: strains e_i to store per point.
    #[must_use]
    pub fn len(&self) -> usize {
        self.terms.len()
    }

    /// True if there is no branch.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.terms.is_empty()
    }

    /// One step of length `k` with the increment of strain ε_n − ε_{n−1}: e_i^{n−1} in `springs` become e_i^n.
    pub fn update(&self, springs: &mut [Sym], increment: &Sym, k: f64) {
        for (term, e) in self.terms.iter().zip(springs) {
            *e = term.factor(k) * (*e + *increment);
        }
    }

    /// Σ q_i for the strains e_i in `springs`.
    #[must_use]
    pub fn stress(&self, springs: &[Sym]) -> Sym {
        self.terms.iter().zip(springs).fold(Sym::ZERO, |sum, (term, e)| sum + term.modulus.apply(e))
    }

    /// Σ q_i^n of a step without increment, Σ 𝓖_i e_i^{n−1}/(1 + k/τ_i): the part of the stress known before the step.
    #[must_use]
    pub fn history(&self, springs: &[Sym], k: f64) -> Sym {
        self.terms.iter().zip(springs).fold(Sym::ZERO, |sum, (term, e)| sum + term.factor(k) * term.modulus.apply(e))
    }

    /// ∂(Σ q_i^n)/∂ε_n = Σ 𝓖_i/(1 + k/τ_i), so that Σ q_i^n = history + tangent (ε_n − ε_{n−1}); with respect to ε(w_n)
    /// it is k times that.
    #[must_use]
    pub fn tangent(&self, k: f64) -> SymMap {
        let entry = |i: usize, j: usize| self.terms.iter().map(|term| term.factor(k) * term.modulus.0[i][j]).sum();
        SymMap(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))))
    }

    /// Stored energy Σ ½ e_i:𝓖_i e_i in J/m³ (½ q_i:𝓖_i⁻¹ q_i if 𝓖_i has an inverse).
    #[must_use]
    pub fn energy(&self, springs: &[Sym]) -> f64 {
        self.terms.iter().zip(springs).map(|(term, e)| 0.5 * term.modulus.apply(e).dot(e)).sum()
    }

    /// The energy identity of the step of length `k` from `before` to `after` with this strain increment.
    #[must_use]
    pub fn balance(&self, before: &[Sym], after: &[Sym], increment: &Sym, k: f64) -> BranchBalance {
        let mut sum = BranchBalance::default();
        for ((term, old), new) in self.terms.iter().zip(before).zip(after) {
            let (stress, change) = (term.modulus.apply(new), *new - *old);
            sum.work += stress.dot(increment);
            // The difference of squares by factors avoids cancellation in a short step.
            sum.stored += 0.5 * term.modulus.apply(&change).dot(&(*new + *old));
            sum.dissipated += k / term.time * stress.dot(new);
            sum.scheme += 0.5 * term.modulus.apply(&change).dot(&change);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Carreau, Hencky, Isotropic, StressState};

    const STRAIN: Sym = Sym([0.3, -0.1, 0.2, 0.0, 0.0, 0.0]);

    fn body() -> Result<(Isotropic, Prony), LawError> {
        let elasticity = Isotropic::elastic(2, 2.0, 0.3, StressState::PlaneStrain);
        let prony = Prony::ratios(&elasticity.clone().into(), &[(0.5, 0.2), (2.0, 1.5)])?;
        Ok((elasticity, prony))
    }

    /// σ(t) − 𝓔ε = Σ g_i exp(−t/τ_i) 𝓔ε under a strain applied at t = 0 and held, to first order in k.
    #[test]
    fn relaxation_is_exponential_to_first_order() -> Result<(), LawError> {
        let (elasticity, prony) = body()?;
        let x = [0.0; 3];
        let error = |steps: u32| {
            let k = 1.0 / f64::from(steps);
            let mut springs = vec![STRAIN; prony.len()];
            for _ in 0..steps {
                prony.update(&mut springs, &Sym::ZERO, k);
            }
            let exact = (0.5 * (-1.0f64 / 0.2).exp() + 2.0 * (-1.0f64 / 1.5).exp()) * elasticity.value(&x, &STRAIN);
            (prony.stress(&springs) - exact).norm() / exact.norm()
        };
        let errors = [64, 128, 256, 512].map(error);
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((order - 1.0).abs() < 0.05, "order {order}");
        }
        assert!(errors[3] < 2e-3, "{errors:?}");
        Ok(())
    }

    /// A ramp ε̇ = const: q_i → τ_i 𝓖_i ε̇ exactly, the dashpot's stress, for any step.
    #[test]
    fn a_steady_rate_ends_in_the_viscosity_of_the_dashpots() -> Result<(), LawError> {
        let (elasticity, prony) = body()?;
        let mut springs = vec![Sym::ZERO; 2];
        for _ in 0..200 {
            prony.update(&mut springs, &(0.7 * STRAIN), 0.7);
        }
        let exact = (0.5 * 0.2 + 2.0 * 1.5) * elasticity.value(&[0.0; 3], &STRAIN);
        assert!((prony.stress(&springs) - exact).norm() < 1e-13 * exact.norm());
        Ok(())
    }

    /// Work = stored + dissipated + scheme up to round-off; the last two are not negative, and the scheme's total over
    /// a time is of first order in k.
    #[test]
    fn the_energy_identity_closes() -> Result<(), LawError> {
        let (_, prony) = body()?;
        let strain = |t: f64| Sym([0.3 * (3.0 * t).sin(), 0.2 * t, -0.1 * t * t, 0.0, 0.0, 0.0]);
        let run = |steps: u32| {
            let k = 1.0 / f64::from(steps);
            let mut springs = vec![Sym::ZERO; 2];
            let (mut total, mut scheme) = (0.0, 0.0);
            for n in 0..steps {
                let increment = strain(f64::from(n + 1) * k) - strain(f64::from(n) * k);
                let before = springs.clone();
                let predicted = prony.history(&before, k) + prony.tangent(k).apply(&increment);
                prony.update(&mut springs, &increment, k);
                assert!((predicted - prony.stress(&springs)).norm() < 1e-15);
                let b = prony.balance(&before, &springs, &increment, k);
                // Round-off of the strains e_i scales with their energy.
                let held = prony.energy(&before) + prony.energy(&springs);
                assert!(
                    (b.work - b.stored - b.dissipated - b.scheme).abs() <= 4.0 * f64::EPSILON * held,
                    "{b:?}, {held}"
                );
                assert!(b.dissipated >= 0.0 && b.scheme >= 0.0);
                total += b.stored;
                scheme += b.scheme;
            }
            assert!((total - prony.energy(&springs)).abs() < 1e-14 * total);
            scheme
        };
        let order = (run(200) / run(400)).log2();
        assert!((order - 1.0).abs() < 0.05, "order of the scheme's dissipation {order}");
        Ok(())
    }

    /// ½ e:𝓖e is ½ q:𝓖⁻¹q: in uniaxial strain 𝓖 is a number.
    #[test]
    fn stored_energy_by_the_stress() -> Result<(), LawError> {
        let law = Isotropic::lame(1, 0.0, 4.0, StressState::PlaneStrain);
        let prony = Prony::new(&[(&law.into(), 1.0)])?;
        let springs = [Sym([0.25, 0.0, 0.0, 0.0, 0.0, 0.0])];
        assert!(
            (prony.stress(&springs).0[0] - 1.0).abs() < 1e-15 && (prony.energy(&springs) - 1.0 / 8.0).abs() < 1e-15
        );
        Ok(())
    }

    #[test]
    fn what_is_no_branch_is_refused() -> Result<(), LawError> {
        let law = Isotropic::elastic(3, 2.0, 0.3, StressState::PlaneStrain).into();
        assert!(matches!(Prony::ratios(&law, &[(0.5, 0.0)]), Err(LawError::Range { found: 0.0, .. })));
        assert!(matches!(Prony::ratios(&law, &[(-0.5, 1.0)]), Err(LawError::Range { found: -0.5, .. })));
        assert!(matches!(
            Prony::new(&[(&Isotropic::lame(3, 0.0, -1.0, StressState::PlaneStrain).into(), 1.0)]),
            Err(LawError::NotPositive { least: -1.0, .. })
        ));
        let curved = Hencky::new(1.0, Carreau::new(1.0, 0.5, 1.0, 0.5)?)?;
        assert!(matches!(Prony::ratios(&curved.into(), &[(0.5, 1.0)]), Err(LawError::NotLinear)));
        // Relaxation of deviators only: λ + c/3 = 0.
        let deviators = Isotropic::lame(3, -1.0, 3.0, StressState::PlaneStrain);
        assert!(Prony::new(&[(&deviators.into(), 1.0)]).is_ok());
        Ok(())
    }
}
