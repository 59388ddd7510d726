//! Normal contact: laws for the pressure p = −σ_ν of (2.8), one a file.

mod adhesion;
mod bilateral;
mod compliance;
mod damped;
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
    /// Solves p ∈ G(z − λ p, ṙ) for p; the slopes are those of the solution. A function is evaluated with λ = 0, so z = r.
    ///
    /// The rate is that of r₊, (r₊ⁿ − r₊ⁿ⁻¹)/k: with ṙ itself a damped law would jump when the gap closes within a step.
    fn pressure(&self, x: &Point, z: f64, rate: f64, lambda: f64) -> Pressure;
    /// ∫₀^r G at ṙ = 0, the energy stored in the layer, in J/m².
    fn potential(&self, x: &Point, r: f64) -> f64;
    /// L_ν of (H8) in Pa/m; none for a multivalued graph and where slopes are not bounded.
    fn lipschitz(&self) -> Option<f64>;
    /// The kind of graph.
    fn graph(&self) -> GraphKind {
        GraphKind::Function
    }
}

/// Sample laws, each with a penetration typical of it, for tests that hold for every law.
#[cfg(test)]
pub(crate) fn samples() -> Vec<(Arc<dyn NormalLaw>, f64)> {
    let mut all: Vec<(Arc<dyn NormalLaw>, f64)> = Vec::new();
    for samples in [
        compliance::samples,
        power::samples,
        table::samples,
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
