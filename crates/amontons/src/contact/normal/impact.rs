//! Rigid foundations in a step of the ϑ-scheme: impacts, by a bound on the velocity of approach.

use super::{GraphKind, NormalLaw, Pressure};
use crate::tensor::Point;

/// A rigid foundation in a step from the penetration r₀ to r₁: in place of r ≤ 0, and of r = 0 if contact is bilateral,
///
/// r₁ ≤ r₀ + k b ⊥ p ≥ 0, with b = (1 − ϑ(1 + e)) max(V₀, 0),
///
/// V₀ the velocity of approach at the start and e the coefficient of restitution: the velocity of approach at the end
/// is at most −e V₀, which is Newton's law of impact. With b infinite the point bears nothing in the step.
///
/// Sources: J. J. Moreau, in "Nonsmooth Mechanics and Applications", CISM 302 (1988) 1–82; M. Jean, Comput. Methods
/// Appl. Mech. Engrg. 177 (1999) 235–257; V. Acary, B. Brogliato, "Numerical Methods for Nonsmooth Dynamical Systems",
/// Springer (2008).
#[derive(Debug)]
pub struct Impact<'a> {
    law: &'a dyn NormalLaw,
    limit: f64,
}

impl<'a> Impact<'a> {
    /// Of a rigid law, with the largest penetration r₀ + k b at the end of the step, m.
    #[must_use]
    pub fn new(law: &'a dyn NormalLaw, limit: f64) -> Impact<'a> {
        Impact { law, limit }
    }
}

impl NormalLaw for Impact<'_> {
    fn pressure(&self, x: &Point, z: f64, rate: f64, lambda: f64) -> Pressure {
        self.law.pressure(x, z - self.limit, rate, lambda)
    }
    fn potential(&self, x: &Point, r: f64) -> f64 {
        self.law.potential(x, r)
    }
    fn lipschitz(&self) -> Option<f64> {
        None
    }
    fn graph(&self) -> GraphKind {
        self.law.graph()
    }
    fn is_rigid(&self) -> bool {
        self.law.is_rigid()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Bilateral, Signorini};

    /// At most the limit, where any pressure holds the point; without a limit no pressure.
    #[test]
    fn the_limit_takes_the_place_of_zero() {
        let x = [0.0; 3];
        let at = |law: &dyn NormalLaw, limit: f64, z: f64| Impact::new(law, limit).pressure(&x, z, 0.0, 0.5).value;
        for (limit, z, expected) in [(0.25, 0.75, 1.0), (0.25, 0.0, 0.0), (-0.5, 0.0, 1.0), (f64::INFINITY, 1e9, 0.0)] {
            assert!((at(&Signorini, limit, z) - expected).abs() < 1e-15, "{limit}, {z}");
        }
        assert!((at(&Bilateral, 0.25, 0.0) + 0.5).abs() < 1e-15);
    }
}
