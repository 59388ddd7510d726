//! When an iteration is left for a factor: by work that is counted, so that results do not depend on the machine.
//!
//! An iteration is chosen where it is predicted to take less work than a factor. What it takes is counted in its
//! products and put beside what a factor would have taken up to the same system. An iteration that is as fast as
//! predicted stays below that, and one that has taken more is left: both together take at most about twice the work of
//! the factor alone.

use serde::{Deserialize, Serialize};

use super::estimate::Estimate;

/// Work is given in seconds on the core of [`Estimate`].
#[derive(Clone, Debug, PartialEq)]
pub struct Relief {
    /// Nodes whose unknowns the factor keeps, ascending.
    pub contact: Vec<u32>,
    /// Work of one factorization, and of one system with contact that is solved with it.
    factor: f64,
    system: f64,
    /// Work of the levels of an iteration, and of one of its products.
    levels: f64,
    product: f64,
}

/// Work of an iteration so far, beside that of a factor in its place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Account {
    /// What the iteration has taken.
    pub taken: f64,
    /// What a factor would have taken.
    pub allowed: f64,
    /// Whether the iteration is left for a factor.
    pub is_left: bool,
}

impl Relief {
    /// For a matrix with these counts; `joins` says whether a point of contact joins nodes.
    #[must_use]
    pub fn new(estimate: &Estimate, joins: bool, contact: Vec<u32>) -> Relief {
        let [factor, system] = estimate.factor_and_system();
        let [levels, product] = estimate.levels_and_product(joins);
        Relief { contact, factor, system, levels, product }
    }

    /// Counts a matrix: its levels, and the factor in their place.
    pub fn count_matrix(&self, account: &mut Account) {
        account.taken += self.levels;
        account.allowed += self.factor;
    }

    /// Counts a system that is to be solved.
    pub fn count_system(&self, account: &mut Account) {
        account.allowed += self.system;
    }

    /// Counts products; the iteration is left once it has taken more than a factor would have.
    pub fn count_products(&self, account: &mut Account, products: usize) {
        account.taken += self.product * products as f64;
        account.is_left |= account.taken > account.allowed;
    }

    /// Products after which the iteration is left.
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

    /// An iteration is left after the work of the factor and of the systems so far, and not before.
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
