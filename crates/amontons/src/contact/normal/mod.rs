//! Normal contact: laws for the pressure p = −σ_ν of (2.8), one per file.

mod adhesion;
mod bilateral;
mod compliance;
mod damped;
mod formula;
mod power;
mod signorini;
mod softening;
mod stop;
mod table;

use std::fmt::Debug;
use std::sync::Arc;

use crate::arrays::Arrays;
use crate::field::Graded;
use crate::tensor::Point;

pub use adhesion::Adhesion;
pub use bilateral::Bilateral;
pub use compliance::Compliance;
pub use damped::{Damped, HuntCrossley};
pub use formula::{PressureFormula, PressureFormulaFault};
pub use power::Power;
pub use signorini::Signorini;
pub use softening::Softening;
pub use stop::Stop;
pub use table::{PressureTable, PressureTableFault};

/// A pressure with its slopes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pressure {
    /// p in Pa; negative for tension.
    pub value: f64,
    /// A generalized derivative ∂p/∂z in Pa/m.
    pub slope: f64,
    /// ∂p/∂ṙ in Pa s/m.
    pub by_rate: f64,
}

/// What kind of graph a law is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GraphKind {
    /// A function of r and ṙ.
    Function,
    /// With vertical parts: at a penetration that the foundation does not let exceed, p is what it takes to hold it.
    Multivalued,
    /// One vertical line: the gap is closed whatever the sign of p, so friction acts in tension too.
    Bilateral,
}

/// A graph G from penetration r (m) and its rate ṙ (m/s) to pressure p (Pa).
///
/// Those that (H8) covers are functions of r alone, not negative, nondecreasing, and zero for r ≤ 0.
pub trait NormalLaw: Debug + Send + Sync {
    /// Solves p ∈ G(z − λ p, ṙ) for p; the slopes are those of the solution. A function is evaluated with λ = 0, so
    /// z = r; [`resolvent`] solves it for others.
    ///
    /// The rate is that of r₊, (r₊ⁿ − r₊ⁿ⁻¹)/k: with ṙ itself a damped law would jump when the gap closes within a
    /// step.
    fn pressure(&self, x: &Point, z: f64, rate: f64, lambda: f64) -> Pressure;
    /// ∫₀^r G at ṙ = 0, the energy stored in the layer, in J/m².
    fn potential(&self, x: &Point, r: f64) -> f64;
    /// L_ν of (H8) in Pa/m; none for a multivalued graph and where slopes are not bounded.
    fn lipschitz(&self) -> Option<f64>;
    /// Largest derivative in the rate, Pa s/m; none where it is not bounded. Zero stands for any law that does not
    /// depend on the rate.
    fn lipschitz_in_rate(&self) -> Option<f64> {
        Some(0.0)
    }
    /// Least slope in Pa/m between two penetrations, the first the smaller; −∞ across a drop. Zero stands for any law
    /// that does not fall.
    fn least_slope(&self, _x: &Point, _from: f64, _to: f64) -> f64 {
        0.0
    }
    /// The law as one whose coefficients vary over the side, if it is one.
    fn graded(&self) -> Option<&Graded<dyn NormalLaw>> {
        None
    }
    /// The law at a time in s; none if it does not change with time.
    fn at_time(&self, _t: f64) -> Option<Arc<dyn NormalLaw>> {
        None
    }
    /// The functions of arrays that the law consists of: they are evaluated for all contact points at once.
    fn arrays(&self) -> Vec<&Arrays> {
        Vec::new()
    }
    /// The kind of graph.
    fn graph(&self) -> GraphKind {
        GraphKind::Function
    }
}

/// Most iterations of [`resolvent`]; every third halves the interval.
const ITERATIONS: usize = 200;

/// What the arguments of a normal law lose with the pressure p.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Yield {
    /// λ in m/Pa: λ p is taken off the penetration, and λ p/γ off its rate.
    pub lambda: f64,
    /// λ/γ in m/(Pa s), γ that of the rule in time.
    pub lambda_rate: f64,
    /// λ_w in m/Pa: λ_w p₊ is the depth by which the gap opens by wear in a step.
    pub by_wear: f64,
    /// λ_w/γ in m/(Pa s): by λ_w p₊/γ the penetration grows the slower.
    pub by_wear_rate: f64,
}

/// Solves p ∈ G(z − λ p − λ_w p₊, ż − (λ p + λ_w p₊)/γ), for a law that does not fall or with λ = 0: where the law is a
/// function, by Newton's method between zero and its value at z, where the difference of both sides changes its sign.
/// The slopes are those of p in z and ż.
#[must_use]
pub fn resolvent(law: &dyn NormalLaw, x: &Point, z: f64, rate: f64, by: &Yield) -> Pressure {
    let Yield { lambda, lambda_rate, by_wear, by_wear_rate } = *by;
    if law.graph() != GraphKind::Function {
        let fresh = law.pressure(x, z, rate, lambda);
        return if by_wear <= 0.0 || fresh.value <= 0.0 { fresh } else { law.pressure(x, z, rate, lambda + by_wear) };
    }
    let at = |z: f64, rate: f64| law.pressure(x, z, if z > 0.0 { rate } else { 0.0 }, 0.0);
    let fresh = at(z, rate);
    let (lambda, lambda_rate) =
        if fresh.value > 0.0 { (lambda + by_wear, lambda_rate + by_wear_rate) } else { (lambda, lambda_rate) };
    if lambda <= 0.0 || fresh.value == 0.0 {
        return Pressure { slope: fresh.slope / (1.0 + lambda * fresh.slope), ..fresh };
    }
    let yielding = |at: &Pressure| 1.0 + lambda * at.slope + lambda_rate * at.by_rate;
    // A law that falls presses harder at a smaller penetration, but not without one.
    let falls = law.least_slope(x, f64::NEG_INFINITY, f64::INFINITY) < 0.0;
    let (mut below, mut above) = (fresh.value.min(0.0), if falls { z / lambda } else { fresh.value.max(0.0) });
    let mut p = fresh.value / yielding(&fresh);
    let mut found = fresh;
    for iteration in 0..ITERATIONS {
        let at = at(z - lambda * p, rate - lambda_rate * p);
        let (excess, yielding) = (p - at.value, yielding(&at));
        found = Pressure { value: p, slope: at.slope / yielding, by_rate: at.by_rate / yielding };
        let newton = p - excess / yielding;
        if above - below <= 4.0 * f64::EPSILON * above.abs().max(below.abs())
            || (newton - p).abs() <= 2.0 * f64::EPSILON * p.abs()
        {
            break;
        }
        if excess > 0.0 {
            above = p;
        } else {
            below = p;
        }
        p = if newton > below && newton < above && iteration % 3 < 2 { newton } else { 0.5 * (below + above) };
    }
    found
}

/// Sample laws, each with a penetration typical of it, for tests that hold for every law.
#[cfg(test)]
pub(crate) fn samples() -> Vec<(Arc<dyn NormalLaw>, f64)> {
    let mut all: Vec<(Arc<dyn NormalLaw>, f64)> = Vec::new();
    for samples in [
        compliance::samples,
        power::samples,
        table::samples,
        formula::samples,
        stop::samples,
        signorini::samples,
        bilateral::samples,
        damped::samples,
        softening::samples,
        adhesion::samples,
    ] {
        all.extend(samples());
    }
    all
}
