//! Normal contact: laws for the pressure p = −σ_ν of (2.8).

use std::fmt::Debug;
#[cfg(test)]
use std::sync::Arc;

use crate::tensor::Point;

/// A value with its slope.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ValueSlope {
    /// The value.
    pub value: f64,
    /// A generalized derivative.
    pub slope: f64,
}

/// A monotone graph G from penetration r (m) to pressure p ≥ 0 (Pa), zero for r ≤ 0: (H8).
pub trait NormalLaw: Debug + Send + Sync {
    /// Solves p ∈ G(z − λ p) for p; the slope is dp/dz. λ = 0 evaluates a single-valued law.
    fn pressure(&self, x: &Point, z: f64, lambda: f64) -> ValueSlope;
    /// ∫₀^r G, the energy stored in the layer, in J/m².
    fn potential(&self, x: &Point, r: f64) -> f64;
    /// L_ν of (H8) in Pa/m; none for a multivalued graph.
    fn lipschitz(&self) -> Option<f64>;
}

/// Normal compliance p_ν(r) = c_ν r₊ of section 5.
#[derive(Clone, Debug, PartialEq)]
pub struct Compliance {
    /// c_ν in Pa/m.
    pub stiffness: f64,
}

impl NormalLaw for Compliance {
    fn pressure(&self, _x: &Point, z: f64, lambda: f64) -> ValueSlope {
        // p = c (z − λ p)  ⇒  p = c z / (1 + c λ).
        let slope = self.stiffness / (1.0 + self.stiffness * lambda);
        if z > 0.0 { ValueSlope { value: slope * z, slope } } else { ValueSlope::default() }
    }
    fn potential(&self, _x: &Point, r: f64) -> f64 {
        0.5 * self.stiffness * r.max(0.0).powi(2)
    }
    fn lipschitz(&self) -> Option<f64> {
        Some(self.stiffness)
    }
}

/// Sample laws, each with a penetration typical of it, for tests that hold for every law.
#[cfg(test)]
pub(crate) fn samples() -> Vec<(Arc<dyn NormalLaw>, f64)> {
    vec![(Arc::new(Compliance { stiffness: 1e4 }), 1e-4), (Arc::new(Compliance { stiffness: 3.0e12 }), 1e-6)]
}
