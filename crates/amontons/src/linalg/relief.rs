//! Change from an iteration to a factor, by counted work, so that results do not depend on the machine.
//!
//! An iteration is chosen if it is predicted to take less work than a factor. Its work is counted in products and
//! compared with the work that a factor would have taken up to the same system. An iteration that is as fast as
//! predicted stays below that. One that has taken more is replaced: both together take at most about twice the work of
//! the factor alone.

use serde::{Deserialize, Serialize};

use super::estimate::Estimate;

/// Predicted work of an iteration and of the factor that may replace it, in seconds on the core of [`Estimate`].
#[derive(Clone, Debug, PartialEq)]
pub struct Relief {
    /// Nodes whose unknowns the factor keeps, ascending.
    pub contact: Vec<u32>,
    /// Work of one factorization, and of one system with contact solved with it, s.
    factor: f64,
    system: f64,
    /// Work of building the levels of an iteration, and of one of its products, s.
    levels: f64,
    product: f64,
}

/// Work of an iteration so far, and that of a factor in its place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Account {
    /// Work of the iteration so far, s.
    pub taken: f64,
    /// Work that a factor would have taken, s.
    pub allowed: f64,
    /// True if the iteration is replaced by a factor.
    pub is_left: bool,
}

impl Relief {
    /// Predicts the work for a matrix with these counts; `joins` is true if a contact point joins nodes.
    #[must_use]
    pub fn new(estimate: &Estimate, joins: bool, contact: Vec<u32>) -> Relief {
        let [factor, system] = estimate.factor_and_system();
        let [levels, product] = estimate.levels_and_product(joins);
        Relief { contact, factor, system, levels, product }
    }

    /// Counts a new matrix: its levels, and the factor in their place.
    pub fn count_matrix(&self, account: &mut Account) {
        account.taken += self.levels;
        account.allowed += self.factor;
    }

    /// Counts a system that is to be solved.
    pub fn count_system(&self, account: &mut Account) {
        account.allowed += self.system;
    }

    /// Counts products; the iteration is to be replaced once it has taken more work than a factor would have.
    pub fn count_products(&self, account: &mut Account, products: usize) {
        account.taken += self.product * products as f64;
        account.is_left |= account.taken > account.allowed;
    }

    /// Number of products after which the iteration is replaced.
    #[must_use]
    pub fn products_left(&self, account: &Account) -> usize {
        let left = (account.allowed - account.taken) / self.product;
        // A float beyond the largest integer becomes that integer.
        (left.max(0.0) as usize).saturating_add(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ESTIMATE: Estimate = Estimate { unknowns: 45_000, contact: 1875, entries: 3.4e6, stored: 3e7, flops: 6e10 };

    /// An iteration is replaced after the work of the factor and of the systems so far, and not before.
    #[test]
    fn an_iteration_is_left_when_it_has_taken_more_than_a_factor() {
        let relief = Relief::new(&ESTIMATE, false, Vec::new());
        let mut account = Account::default();
        relief.count_matrix(&mut account);
        for _ in 0..3 {
            relief.count_system(&mut account);
            let left = relief.products_left(&account);
            assert!(left > 1);
            relief.count_products(&mut account, left - 1);
            assert!(!account.is_left, "{account:?}");
        }
        relief.count_products(&mut account, 1);
        assert!(account.is_left && account.taken > account.allowed);
        // One product more than a factor would have taken: not twice its work.
        assert!(account.taken <= 1.1 * account.allowed, "{account:?}");
        assert_eq!(relief.products_left(&account), 1);
    }
}
