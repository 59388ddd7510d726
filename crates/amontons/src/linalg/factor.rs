//! Factorizations of a system whose contact unknowns are last: what one gives, and which backend makes one.
//!
//! With the unknowns ordered (I, C), interior before contact, the condensed operator is
//! S = K_CC − K_CI K_II⁻¹ K_IC. The forward sweep over the interior columns reduces the right-hand side to Γ_C; with
//! the contact unknowns found there, the backward sweep expands them to the body.

use std::fmt::Debug;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::condensed::Condensed;
use super::error::SolveError;
use super::estimate::{Choice, Decided, Estimate};
use super::sparse::BlockMatrix;
use super::unknowns::{Layout, Unknowns};

/// A way to solve symmetric positive definite systems.
pub trait Backend: Debug + Send + Sync {
    /// The order of the unknowns, and which are kept: those of the contact nodes at least, after the others.
    fn order(&self, matrix: &BlockMatrix, layout: &Layout) -> Unknowns {
        Unknowns::new(matrix, layout)
    }

    /// Eliminates the interior of the rows and columns of `matrix` that `unknowns` names.
    ///
    /// # Errors
    /// When the matrix is not positive definite or does not fit into memory.
    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError>;

    /// The same backend, ending its work with [`SolveError::Interrupted`] when the flag becomes true; none if it does
    /// not look at one.
    fn interruptible(&self, _flag: &Arc<AtomicBool>) -> Option<Arc<dyn Backend>> {
        None
    }

    /// The same backend, solving as was decided before, where it chooses between ways to solve; else none.
    fn decided(&self, _before: &[Decided]) -> Option<Arc<dyn Backend>> {
        None
    }

    /// How systems with a matrix that has this pattern are solved, and why.
    fn choice(&self, estimate: &Estimate) -> Choice {
        Choice::asked("direct", estimate)
    }

    /// Whether [`Backend::is_positive_definite`] rests on a factor. Otherwise an iteration answers, and one that is at
    /// hand for a matrix nearby spares its set-up.
    fn proves(&self, _matrix: &BlockMatrix, _layout: &Layout) -> bool {
        true
    }

    /// Whether a matrix is positive definite on the unknowns of the layout.
    ///
    /// # Errors
    /// When that cannot be found out.
    fn is_positive_definite(&self, matrix: &Arc<BlockMatrix>, layout: &Layout) -> Result<bool, SolveError> {
        // No unknowns last: the factor is the plain one, which a matrix that is not positive definite does not have.
        let matrix = layout.matrix(matrix);
        let unknowns = self.order(&matrix, &Layout { contact: &[], ..*layout });
        has_factor(self.factorize(&matrix, &unknowns))
    }
}

/// Whether a factorization found every pivot positive.
pub(super) fn has_factor(made: Result<Box<dyn Factor>, SolveError>) -> Result<bool, SolveError> {
    match made {
        Ok(_) => Ok(true),
        Err(SolveError::NotPositive { .. }) => Ok(false),
        Err(error) => Err(error),
    }
}

/// A matrix whose interior is eliminated, vectors in elimination order.
pub trait Factor: Debug + Send + Sync {
    /// Eliminates the interior: on return the kept entries hold the reduced right-hand side
    /// r_C − K_CI K_II⁻¹ r_I, the interior ones what [`Factor::backward`] needs.
    ///
    /// # Errors
    /// When the sweep fails.
    fn forward(&self, r: &mut [f64]) -> Result<(), SolveError>;
    /// Expands: takes the kept entries as solved and returns the interior ones.
    ///
    /// # Errors
    /// When the sweep fails.
    fn backward(&self, x: &mut [f64]) -> Result<(), SolveError>;
    /// The condensed operator S = K_CC − K_CI K_II⁻¹ K_IC.
    fn condensed(&self) -> Box<dyn Condensed>;
    /// Numbers that the factor stores; a sweep reads them once.
    fn stored(&self) -> usize;
    /// How systems are solved: `direct` or `iterative`.
    fn name(&self) -> &'static str {
        "direct"
    }
}

/// The lower half of a matrix in elimination order by columns, rows ascending, the diagonal first.
pub(super) struct LowerTriangle {
    pub start: Vec<u32>,
    pub rows: Vec<u32>,
    pub values: Vec<f64>,
}

impl LowerTriangle {
    /// The rows and columns of `matrix` that `unknowns` names.
    pub fn new(matrix: &BlockMatrix, unknowns: &Unknowns) -> LowerTriangle {
        let (components, _) = matrix.block_shape();
        let mut position = vec![u32::MAX; matrix.graph().len() * components];
        for (k, &dof) in unknowns.dofs.iter().enumerate() {
            position[dof as usize] = k as u32;
        }
        let mut lower = LowerTriangle { start: vec![0], rows: Vec::new(), values: Vec::new() };
        let mut column: Vec<(u32, f64)> = Vec::new();
        for (k, &dof) in unknowns.dofs.iter().enumerate() {
            let (i, r) = (dof as usize / components, dof as usize % components);
            column.clear();
            // The matrix is symmetric: its row is its column.
            for (j, block) in matrix.row(i) {
                for c in 0..components {
                    let p = position[j * components + c];
                    if p != u32::MAX && p as usize >= k {
                        column.push((p, block[r * components + c]));
                    }
                }
            }
            column.sort_unstable_by_key(|&(p, _)| p);
            lower.rows.extend(column.iter().map(|&(p, _)| p));
            lower.values.extend(column.iter().map(|&(_, v)| v));
            lower.start.push(lower.rows.len() as u32);
        }
        lower
    }

    /// Where the columns of the upper half begin, and their rows.
    pub fn transposed_pattern(&self) -> (Vec<u32>, Vec<u32>) {
        let size = self.start.len() - 1;
        let mut start = vec![0u32; size + 1];
        for &row in &self.rows {
            start[row as usize + 1] += 1;
        }
        for k in 0..size {
            start[k + 1] += start[k];
        }
        let (mut filled, mut rows) = (start.clone(), vec![0u32; self.rows.len()]);
        for j in 0..size {
            for (row, _) in self.column(j) {
                rows[filled[row as usize] as usize] = j as u32;
                filled[row as usize] += 1;
            }
        }
        (start, rows)
    }

    /// Rows and values of a column.
    pub fn column(&self, j: usize) -> impl Iterator<Item = (u32, f64)> {
        let range = self.start[j] as usize..self.start[j + 1] as usize;
        self.rows[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }
}
