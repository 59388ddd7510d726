//! No slip at all.

use super::{Bound, FrictionLaw};
use crate::contact::ContactPoint;

/// A bound beyond every traction, open or closed: with bilateral contact a tie of two sides.
///
/// Source: N. Kikuchi, J. T. Oden, "Contact Problems in Elasticity", SIAM (1988), 10.2: perfect adhesion along the
/// tangents.
#[derive(Clone, Debug, PartialEq)]
pub struct NoSlip;

impl NoSlip {
    /// The bound: beyond every traction, and its square is still a number.
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
