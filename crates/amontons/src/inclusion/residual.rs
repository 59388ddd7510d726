//! Residual of an equation, and the rule by which it may be the round-off of its terms.

/// Residual of an equation, with its reference sizes. All are the largest entries of vectors, in N or W.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Residual {
    /// The residual, relative to `scale`.
    pub value: f64,
    /// The largest term of the equation.
    pub scale: f64,
    /// The largest of the terms that are known: loads, inertia, heat.
    pub acting: f64,
    /// The largest contact force, zero if it is not looked at.
    pub contact: f64,
}

/// Fraction of what acts below which the round-off of the terms is small.
const BESIDE: f64 = 1e-4;
/// Growth of the round-off over that of the state before up to which it is that of the same motion.
const GROWN: f64 = 10.0;

/// True if the round-off of the terms is small compared with what acts on the body: then a residual may be round-off.
/// An iterate that runs away, as where nothing holds a body, has a round-off that exceeds everything that acts on it.
pub(crate) fn is_small(round_off: f64, acting: f64) -> bool {
    round_off <= BESIDE * acting
}

/// The round-off that is tolerated if no known term acts on the body: a few times that of the previous state.
pub(crate) fn grown(before: f64) -> f64 {
    GROWN * before
}
