//! Preload of a bolt: a section is tightened to a force and then kept.

use crate::field::Field;

/// The tension of a section whose two sides are a tie.
///
/// Until t₁ the sides are drawn together by a length δ(t), uniform over the section, so that the tension is F(t); then
/// δ stays constant, and the tension follows from the joint:
///
/// ```text
///     r = u_ν − g − δ = 0,      −∫ p = F(t) for t ≤ t₁,      δ(t) = δ(t₁) for t > t₁
/// ```
///
/// Source: the pretension sections of finite element programs, with the reference node in the direction of the section;
/// VDI 2230-1 (2015), section 5.3, for the joint diagram.
#[derive(Clone, Debug)]
pub struct Preload {
    /// F in N, a function of time, per unit of thickness in two dimensions; on the whole ring of a body of revolution.
    pub force: Field,
    /// t₁ in s.
    pub until: f64,
}

/// Fraction of a step within which t₁ counts as the start of the step.
const SAME: f64 = 1e-9;

impl Preload {
    /// F at the end of a step in which the section is tightened; `None` in a step that keeps δ.
    #[must_use]
    pub fn force_in(&self, [from, to]: [f64; 2]) -> Option<f64> {
        let is_tightened = self.until - from > SAME * (to - from);
        is_tightened.then(|| self.force.value(&[0.0; 3], to.min(self.until)))
    }
}
