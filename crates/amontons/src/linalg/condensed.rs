//! The condensed system S x + (forces on Γ_C) = r: what a solver of the inclusion on Γ_C needs of a matrix K.
//!
//! A backend keeps some unknowns of K, those of Γ_C among them, and eliminates the others. A direct one keeps Γ_C
//! alone, and S is the Schur complement; one that has no factor keeps all unknowns, and S is K.

use std::fmt::Debug;

use faer::Mat;

use super::error::SolveError;
use super::relief::Account;
use super::tangent::Tangent;
use super::turn::Turn;

/// Residual, relative to that of x = 0, of a solution as good as double precision has it.
pub const EXACT: f64 = 1e-13;

/// What tells a tangent from others: a hash of its entries and of the bases of its nodes.
pub type TangentKey = [u8; 32];

/// The operator S on the unknowns that are kept, and systems with it.
///
/// Sums are taken in an order that does not depend on the number of threads. Any call may fail, as an iteration or a
/// message between processes can.
pub trait Condensed: Debug + Send + Sync {
    /// The scale of S at each unknown: the mean of its diagonal over the node, the same in every basis.
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

    /// A bound on [`Condensed::magnitude`] that takes no product; infinite where none is known.
    fn magnitude_bound(&self, _x: &[f64]) -> f64 {
        f64::INFINITY
    }

    /// Solves (S + J) x = b in place until the residual is nearly `enough` times that of
    /// x = 0; a backend with a factor leaves what its round-off leaves. Where J is much stiffer than S, a residual
    /// counts as the displacement that it means, times the stiffness of S: otherwise it would hide the residuals of
    /// the other unknowns.
    ///
    /// # Errors
    /// [`SolveError::Singular`] where a solution leaves much of b, as that of a singular matrix does; another one when
    /// the system cannot be solved.
    fn solve(&mut self, tangent: &Tangent, b: &mut [f64], enough: f64) -> Result<(), SolveError>;

    /// Whether S + J is positive definite, J symmetric.
    ///
    /// # Errors
    /// When that cannot be found out.
    fn is_positive_definite(&mut self, tangent: &Tangent) -> Result<bool, SolveError>;

    /// Takes the unknowns of some nodes in other bases: from here on S, products, solutions and entries are in these.
    fn turn(&mut self, turns: &[Turn]);

    /// The nodes that are turned.
    fn turns(&self) -> &[Turn];

    /// S itself, where it is at hand.
    fn dense(&self) -> Option<&Mat<f64>> {
        None
    }

    /// Factorizations of S + J so far.
    fn factorizations(&self) -> usize {
        0
    }

    /// The tangents J whose factors are at hand, the last one first.
    fn kept(&self) -> Vec<TangentKey> {
        Vec::new()
    }

    /// Takes tangents as those whose factors were at hand in the run that this one goes on from: to factorize them
    /// again is not counted again.
    fn recall(&mut self, _kept: &[TangentKey]) {}

    /// Work of an iteration that may be left for a factor.
    fn account(&self) -> Account {
        Account::default()
    }

    /// Goes on from the work that was counted before, with another matrix or in the run that this one goes on from.
    fn go_on_from(&mut self, _account: Account) {}

    /// Krylov iterations so far.
    fn iterations(&self) -> usize {
        0
    }

    /// Number of unknowns that are kept.
    fn len(&self) -> usize {
        self.scale().len()
    }

    /// Whether no unknowns are kept.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
