//! Whether two problems have the same forms.

use super::Discretization;
use crate::linalg::BlockMatrix;

impl Discretization {
    /// True if the forms of (4.1) and of (4.2) are to the bit those of another discretization; false for laws that are
    /// not in matrices, and for (4.1) of a body with Maxwell branches.
    #[must_use]
    pub fn has_same_forms(&self, other: &Discretization) -> [bool; 2] {
        let in_matrices =
            |of: &Discretization| of.is_linear() && of.warm.expansion.is_empty() && of.branches.is_empty();
        let mechanics = [self, other].into_iter().all(in_matrices)
            && is_same(self.inertia(), other.inertia())
            && [(&self.a, &other.a), (&self.b, &other.b), (&self.m, &other.m)].iter().all(|(a, b)| a.is_same(b))
            && are_same(self.springs.as_ref(), other.springs.as_ref())
            && are_same(self.dashpots.as_ref(), other.dashpots.as_ref());
        let heat = [self, other].into_iter().all(Discretization::conducts_linearly)
            && is_same(self.storage(), other.storage())
            && [(&self.d, &other.d), (&self.e, &other.e)].iter().all(|(a, b)| a.is_same(b))
            && are_same(self.convection.as_ref(), other.convection.as_ref());
        [mechanics, heat]
    }
}

/// True if scales and forms are the same.
fn is_same(a: (f64, &BlockMatrix), b: (f64, &BlockMatrix)) -> bool {
    a.0.to_bits() == b.0.to_bits() && a.1.is_same(b.1)
}

/// True if both forms are the same, or neither is there.
fn are_same(a: Option<&BlockMatrix>, b: Option<&BlockMatrix>) -> bool {
    match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => a.is_same(b),
        _ => false,
    }
}
