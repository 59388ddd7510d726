//! Systems (S + J) x = b on Γ_C with the factors of the last few J kept.

use std::collections::VecDeque;

use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::prelude::*;

/// Factors kept at once: steps alternate between a few contact patterns at the most.
const KEPT: usize = 8;

/// An entry that the boundary term adds to S: row, column, value.
pub type Entry = (u32, u32, f64);

/// The condensed operator S with the factors of S + J for the last few J.
///
/// With piecewise linear laws J has the same bits whenever the same points are open, stuck and
/// slipping, so a step with an unchanged contact pattern costs no factorization. The key is J
/// itself: no law has to say that it is piecewise linear.
#[derive(Debug)]
pub struct Condensed {
    s: Mat<f64>,
    kept: VecDeque<(Vec<Entry>, PartialPivLu<f64>)>,
    factorizations: usize,
}

impl Condensed {
    /// For the condensed operator `s`.
    #[must_use]
    pub fn new(s: Mat<f64>) -> Condensed {
        Condensed { s, kept: VecDeque::new(), factorizations: 0 }
    }

    /// Goes over to another operator; factors of the one before are of no use.
    pub fn replace(&mut self, s: Mat<f64>) {
        self.s = s;
        self.kept.clear();
    }

    /// Number of unknowns on Γ_C.
    #[must_use]
    pub fn len(&self) -> usize {
        self.s.nrows()
    }

    /// Whether there are no unknowns on Γ_C.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Factorizations of S + J so far.
    #[must_use]
    pub fn factorizations(&self) -> usize {
        self.factorizations
    }

    /// The operator S.
    #[must_use]
    pub fn operator(&self) -> &Mat<f64> {
        &self.s
    }

    /// S x.
    #[must_use]
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for (j, &x) in x.iter().enumerate() {
            // S is symmetric and stored by columns.
            for (y, s) in y.iter_mut().zip(self.s.col(j).iter()) {
                *y += s * x;
            }
        }
        y
    }

    /// Largest entry of |S| |x|: the size of the numbers whose sum S x is, for judging round-off.
    #[must_use]
    pub fn magnitude(&self, x: &[f64]) -> f64 {
        let mut y = vec![0.0; x.len()];
        for (j, &x) in x.iter().enumerate() {
            for (y, s) in y.iter_mut().zip(self.s.col(j).iter()) {
                *y += (s * x).abs();
            }
        }
        super::sparse::max_abs(&y)
    }

    /// Solves (S + J) x = b in place, J the sum of the entries.
    pub fn solve(&mut self, entries: &[Entry], b: &mut [f64]) {
        let same =
            |kept: &[Entry]| kept.len() == entries.len() && kept.iter().zip(entries).all(|(a, b)| a.0 == b.0 && a.1 == b.1 && a.2.to_bits() == b.2.to_bits());
        let lu = match self.kept.iter().position(|(key, _)| same(key)) {
            Some(0) => &self.kept[0].1,
            Some(found) => {
                if let Some(entry) = self.kept.remove(found) {
                    self.kept.push_front(entry);
                }
                &self.kept[0].1
            }
            None => {
                let mut matrix = self.s.clone();
                for &(i, j, value) in entries {
                    matrix[(i as usize, j as usize)] += value;
                }
                self.factorizations += 1;
                self.kept.truncate(KEPT - 1);
                self.kept.push_front((entries.to_vec(), matrix.partial_piv_lu()));
                &self.kept[0].1
            }
        };
        let n = b.len();
        lu.solve_in_place(MatMut::from_column_major_slice_mut(b, n, 1));
    }
}
