//! Normal contact: laws for the pressure p = −σ_ν of (2.8), one per file.

mod adhesion;
mod bilateral;
mod compliance;
mod damped;
mod formula;
mod impact;
mod mean;
mod power;
mod signorini;
mod softening;
mod stop;
mod table;

use std::fmt::Debug;
#[cfg(test)]
use std::sync::Arc;

use crate::tensor::Point;

pub use adhesion::Adhesion;
pub use bilateral::Bilateral;
pub use compliance::Compliance;
pub use damped::{Damped, HuntCrossley};
pub use formula::{PressureFormula, PressureFormulaFault};
pub use impact::Impact;
pub use mean::MeanPressure;
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

/// The kind of graph of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GraphKind {
    /// A function of r and ṙ.
    Function,
    /// A graph with vertical parts: at the largest possible penetration, p takes the value that holds it.
    Multivalued,
    /// One vertical line: the gap stays closed for either sign of p, so friction also acts in tension.
    Bilateral,
}

/// A graph G from penetration r (m) and its rate ṙ (m/s) to pressure p (Pa).
///
/// Laws covered by (H8) are nonnegative, nondecreasing functions of r alone that vanish for r ≤ 0.
pub trait NormalLaw: Debug + Send + Sync {
    /// Solves p ∈ G(z − λ p, ṙ) for p; the slopes are those of the solution. A function is evaluated with λ = 0, so z =
    /// r; [`resolvent`] then solves the equation.
    ///
    /// `rate` is that of r₊, (r₊ⁿ − r₊ⁿ⁻¹)/k: with ṙ itself a damped law would jump when the gap closes within a step.
    fn pressure(&self, x: &Point, z: f64, rate: f64, lambda: f64) -> Pressure;
    /// ∫₀^r G at ṙ = 0, the energy stored in the layer, in J/m².
    fn potential(&self, x: &Point, r: f64) -> f64;
    /// L_ν of (H8) in Pa/m; `None` for a multivalued graph and for unbounded slopes.
    fn lipschitz(&self) -> Option<f64>;
    /// Largest derivative in the rate, Pa s/m; `None` if it is unbounded. Zero for a law that does not depend on the
    /// rate.
    fn lipschitz_in_rate(&self) -> Option<f64> {
        Some(0.0)
    }
    /// Least slope in Pa/m between two penetrations, the smaller first; −∞ across a drop. May be zero for any law that
    /// does not soften.
    fn least_slope(&self, _x: &Point, _from: f64, _to: f64) -> f64 {
        0.0
    }
    /// The kind of graph.
    fn graph(&self) -> GraphKind {
        GraphKind::Function
    }
    /// True if the foundation is rigid: any pressure at r = 0, none below.
    fn is_rigid(&self) -> bool {
        false
    }
}

/// Most iterations of [`resolvent`]; every third halves the interval.
const ITERATIONS: usize = 200;

/// Coefficients by which the pressure p reduces the arguments of a normal law.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Yield {
    /// λ in m/Pa: p reduces the penetration by λ p and its rate by λ p/γ.
    pub lambda: f64,
    /// λ/γ in m/(Pa s), γ of the time-stepping rule.
    pub lambda_rate: f64,
    /// λ_w in m/Pa: wear opens the gap by λ_w p₊ in a step.
    pub by_wear: f64,
    /// λ_w/γ in m/(Pa s): wear reduces the rate of the penetration by λ_w p₊/γ.
    pub by_wear_rate: f64,
}

/// Solves p ∈ G(z − λ p − λ_w p₊, ż − (λ p + λ_w p₊)/γ), for a law that does not soften or with λ = 0. A function is
/// solved by Newton's method between zero and its value at z, where the residual changes its sign. The slopes are ∂p/∂z
/// and ∂p/∂ż.
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
    // A softening law gives a higher pressure at a smaller penetration, but none without penetration.
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

/// Sample laws, each with a typical penetration, for tests that hold for every law.
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
