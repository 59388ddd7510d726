//! Preload of a bolt: a section that is tightened to a force, then kept.

use crate::field::Field;

/// The tension of a section, whose two sides are a tie.
///
/// Until a time the sides are drawn together by a length δ(t), the same everywhere on the section, so that its tension
/// is F(t); then δ stays as it is, and the tension is what the joint makes of it:
///
/// ```text
///     r = u_ν − g − δ = 0,      −∫ p = F(t) for t ≤ t₁,      δ(t) = δ(t₁) for t > t₁
/// ```
///
/// Source: the pretension sections of finite element programs, with the reference node in the direction of the section;
/// VDI 2230-1 (2015), section 5.3, for the joint diagram.
#[derive(Clone, Debug)]
pub struct Preload {
    /// F in N, a field of time, per unit of thickness in two dimensions; on the whole ring of a body of revolution.
    pub force: Field,
    /// t₁ in s.
    pub until: f64,
}

/// Share of a step within which t₁ is its start.
const SAME: f64 = 1e-9;

impl Preload {
    /// F at the end of a step in which the section is tightened; none in a step that keeps it.
    #[must_use]
    pub fn force_in(&self, [from, to]: [f64; 2]) -> Option<f64> {
        let is_tightened = self.until - from > SAME * (to - from);
        is_tightened.then(|| self.force.value(&[0.0; 3], to.min(self.until)))
    }
}
