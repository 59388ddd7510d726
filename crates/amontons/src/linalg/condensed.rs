//! The condensed system S x + (forces on Γ_C) = r: the interface of a matrix K to the solver of the inclusion on Γ_C.
//!
//! A backend keeps some unknowns of K, among them those of Γ_C, and eliminates the others. A direct backend keeps Γ_C
//! alone, and S is the Schur complement. An iterative backend has no factor and keeps all unknowns, and S is K.

use std::fmt::Debug;

use faer::Mat;

use super::error::SolveError;
use super::relief::Account;
use super::tangent::Tangent;
use super::turn::Turn;

/// Relative residual ‖b − A x‖/‖b‖ that stands for a solution at full double precision.
pub const EXACT: f64 = 1e-13;

/// Identifier of a tangent: a hash of its entries and of the bases of its nodes.
pub type TangentKey = [u8; 32];

/// The operator S on the kept unknowns, and the solution of systems with it.
///
/// Sums are taken in an order that does not depend on the number of threads. Any call may fail, as an iteration or a
/// message between processes can.
pub trait Condensed: Debug + Send + Sync {
    /// Scale of S per unknown: the mean of its diagonal over the node, the same in every basis.
    fn scale(&self) -> &[f64];

    /// S x.
    ///
    /// # Errors
    /// When the product cannot be computed.
    fn apply(&self, x: &[f64]) -> Result<Vec<f64>, SolveError>;

    /// Largest entry of |S| |x|: the size of the numbers whose sum S x is, for judging round-off.
    ///
    /// # Errors
    /// When the product cannot be computed.
    fn magnitude(&self, x: &[f64]) -> Result<f64, SolveError>;

    /// Upper bound on [`Condensed::magnitude`] without a product; infinite if no bound is known.
    fn magnitude_bound(&self, _x: &[f64]) -> f64 {
        f64::INFINITY
    }

    /// Solves (S + J) x = b in place until the residual is nearly `enough` times that of x = 0; a backend with a factor
    /// solves to round-off. If J is much stiffer than S, a residual counts as the displacement that it means, times the
    /// stiffness of S: otherwise it would hide the residuals of the other unknowns.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if the solution leaves a large part of b, as with a singular matrix; another error if
    /// the system cannot be solved.
    fn solve(&mut self, tangent: &Tangent, b: &mut [f64], enough: f64) -> Result<(), SolveError>;

    /// True if S + J is positive definite, for symmetric J.
    ///
    /// # Errors
    /// When definiteness cannot be determined.
    fn is_positive_definite(&mut self, tangent: &Tangent) -> Result<bool, SolveError>;

    /// Changes the bases of some nodes: from here on S, products, solutions and entries are in these bases.
    fn turn(&mut self, turns: &[Turn]);

    /// Nodes whose unknowns are in another basis than the axes of space.
    fn turns(&self) -> &[Turn];

    /// S as a dense matrix, or `None` if it is not stored.
    fn dense(&self) -> Option<&Mat<f64>> {
        None
    }

    /// Number of factorizations of S + J so far.
    fn factorizations(&self) -> usize {
        0
    }

    /// Tangents J whose factors are stored, the last one first.
    fn kept(&self) -> Vec<TangentKey> {
        Vec::new()
    }

    /// Marks tangents as factorized in the run that this one continues: factorizing them again is not counted again.
    fn recall(&mut self, _kept: &[TangentKey]) {}

    /// Work of an iteration that may be replaced by a factor.
    fn account(&self) -> Account {
        Account::default()
    }

    /// Continues from work counted before, with another matrix or in the run that this one continues.
    fn go_on_from(&mut self, _account: Account) {}

    /// Number of Krylov iterations so far.
    fn iterations(&self) -> usize {
        0
    }

    /// Number of kept unknowns.
    fn len(&self) -> usize {
        self.scale().len()
    }

    /// True if no unknowns are kept.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
