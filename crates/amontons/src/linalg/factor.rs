//! Traits of a factorization with the contact unknowns last, and of the backend that makes it.
//!
//! With the unknowns ordered (I, C), interior before contact, the condensed operator is S = K_CC − K_CI K_II⁻¹ K_IC.
//! The forward sweep over the interior columns reduces the right-hand side to Γ_C. Once the contact unknowns are found
//! there, the backward sweep expands them to the body.

use std::fmt::Debug;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::condensed::Condensed;
use super::error::SolveError;
use super::estimate::{Choice, Decided, Estimate};
use super::sparse::BlockMatrix;
use super::tangent::Tangent;
use super::unknowns::{Layout, Unknowns};

/// A solver of symmetric positive definite systems.
pub trait Backend: Debug + Send + Sync {
    /// Orders the unknowns and chooses those that are kept: at least those of the contact nodes, after the others.
    fn order(&self, matrix: &BlockMatrix, layout: &Layout) -> Unknowns {
        Unknowns::new(matrix, layout)
    }

    /// Eliminates the interior of the submatrix of `matrix` on `unknowns`.
    ///
    /// # Errors
    /// When the matrix is not positive definite or does not fit into memory.
    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError>;

    /// This backend, ending its work with [`SolveError::Interrupted`] when the flag becomes true, or `None` if it
    /// ignores flags.
    fn interruptible(&self, _flag: &Arc<AtomicBool>) -> Option<Arc<dyn Backend>> {
        None
    }

    /// This backend with the choices of an earlier run, or `None` if it does not choose between solvers.
    fn decided(&self, _before: &[Decided]) -> Option<Arc<dyn Backend>> {
        None
    }

    /// True if several processes work on each call together, so that the calls must have the same order in all of them:
    /// then no two are made from different threads at a time.
    fn is_collective(&self) -> bool {
        false
    }

    /// The backend that takes the place of a collective one for what a single process computes, as for its results;
    /// `None` if this one will do.
    fn alone(&self) -> Option<Arc<dyn Backend>> {
        None
    }

    /// Why systems are solved as they are, in words, if neither the case nor the program has chosen.
    fn reason(&self) -> Option<String> {
        None
    }

    /// Chooses the solver for systems with a matrix of this pattern, with the reason.
    fn choice(&self, estimate: &Estimate) -> Choice {
        Choice::asked("direct", estimate)
    }

    /// True if [`Backend::is_positive_definite`] uses a factor. Otherwise an iteration decides, and an existing one of
    /// a nearby matrix saves its set-up.
    fn proves(&self, _matrix: &BlockMatrix, _layout: &Layout) -> bool {
        true
    }

    /// True if a matrix is positive definite on the unknowns of the layout: by a factor, or by an iteration where
    /// [`Backend::proves`] is false.
    ///
    /// # Errors
    /// When definiteness cannot be determined.
    fn is_positive_definite(&self, matrix: &Arc<BlockMatrix>, layout: &Layout) -> Result<bool, SolveError> {
        let (proves, matrix) = (self.proves(matrix, layout), layout.matrix(matrix));
        if proves {
            // No contact unknowns: the factor is the complete Cholesky factor, which exists only for a positive
            // definite matrix.
            let unknowns = self.order(&matrix, &Layout { contact: &[], ..*layout });
            return has_factor(self.factorize(&matrix, &unknowns));
        }
        match self.factorize(&matrix, &self.order(&matrix, layout)) {
            Ok(factor) => factor.condensed().is_positive_definite(&Tangent::new()),
            Err(SolveError::NotPositive { .. }) => Ok(false),
            Err(error) => Err(error),
        }
    }
}

/// Computes both in parallel, or one after the other if both may call a backend of several processes.
pub(crate) fn join<A: Send, B: Send>(
    is_collective: bool,
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    if is_collective { (first(), second()) } else { rayon::join(first, second) }
}

/// True if a factorization found every pivot positive.
pub(super) fn has_factor(made: Result<Box<dyn Factor>, SolveError>) -> Result<bool, SolveError> {
    match made {
        Ok(_) => Ok(true),
        Err(SolveError::NotPositive { .. }) => Ok(false),
        Err(error) => Err(error),
    }
}

/// A matrix with its interior eliminated; vectors are in elimination order.
pub trait Factor: Debug + Send + Sync {
    /// Eliminates the interior: on return the kept entries hold the reduced right-hand side
    /// r_C − K_CI K_II⁻¹ r_I, the interior ones what [`Factor::backward`] needs.
    ///
    /// # Errors
    /// When the sweep fails.
    fn forward(&self, r: &mut [f64]) -> Result<(), SolveError>;
    /// Expands a solution: reads the kept entries and computes the interior ones.
    ///
    /// # Errors
    /// When the sweep fails.
    fn backward(&self, x: &mut [f64]) -> Result<(), SolveError>;
    /// The condensed operator S = K_CC − K_CI K_II⁻¹ K_IC.
    fn condensed(&self) -> Box<dyn Condensed>;
    /// Number of stored entries of the factor; a sweep reads them once.
    fn stored(&self) -> usize;
    /// Name of the solver: `direct` or `iterative`.
    fn name(&self) -> &'static str {
        "direct"
    }
}

/// Lower half of a matrix in elimination order, by columns: rows ascending, the diagonal first.
pub(super) struct LowerTriangle {
    pub start: Vec<u32>,
    pub rows: Vec<u32>,
    pub values: Vec<f64>,
}

impl LowerTriangle {
    /// Lower half of the submatrix of `matrix` on `unknowns`.
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

    /// Start of each column of the upper half, and its rows.
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
