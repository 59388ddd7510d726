//! No slip at all.

use super::{Bound, FrictionLaw};
use crate::contact::ContactPoint;

/// A bound larger than any traction, open or closed: with bilateral contact it ties two sides.
///
/// Source: N. Kikuchi, J. T. Oden, "Contact Problems in Elasticity", SIAM (1988), 10.2: perfect tangential adhesion.
#[derive(Clone, Debug, PartialEq)]
pub struct NoSlip;

impl NoSlip {
    /// The bound: larger than any traction, yet its square is finite.
    pub const BOUND: f64 = 1e150;
}

impl FrictionLaw for NoSlip {
    fn bound(&self, _at: &ContactPoint) -> Bound {
        Bound { value: NoSlip::BOUND, ..Bound::default() }
    }
    fn lipschitz(&self, _l_nu: Option<f64>) -> Option<f64> {
        None
    }
    fn never_slips(&self) -> bool {
        true
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<std::sync::Arc<dyn FrictionLaw>> {
    vec![std::sync::Arc::new(NoSlip)]
}
