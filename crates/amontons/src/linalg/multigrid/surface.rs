//! Contact that couples the nodes of a facet, as at Gauss points: K + J on the degrees of freedom that it touches,
//! solved as a whole.
//!
//! Where fewer points of a facet act than it has nodes, J is stiff at every node and has motions without force: no
//! solution node by node knows them.

use std::collections::BTreeMap;

use faer::sparse::linalg::solvers::Lu;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, prelude::Solve};

use super::precondition::{AXES, Body, in_basis};
use crate::linalg::condensed::Entry;
use crate::linalg::error::SolveError;
use crate::tensor::Point;

/// Whether entries couple different nodes of `n` degrees of freedom each.
pub(super) fn couples(entries: &[Entry], n: usize) -> bool {
    entries.iter().any(|&(i, j, _)| i as usize / n != j as usize / n)
}

/// The degrees of freedom that contact touches, with the factors of K + J on them.
#[derive(Debug)]
pub(super) struct Surface {
    dofs: Vec<u32>,
    matrix: SparseColMat<usize, f64>,
    factors: Lu<usize, f64>,
}

impl Surface {
    /// For entries by degree of freedom in the bases of `turns`.
    ///
    /// # Errors
    /// When K + J is singular there.
    pub fn new(body: &Body, entries: &[Entry], bases: &BTreeMap<usize, [Point; 3]>) -> Result<Surface, SolveError> {
        let (n, _) = body.matrix.block_shape();
        let mut nodes: Vec<usize> = entries.iter().flat_map(|(i, j, _)| [*i as usize / n, *j as usize / n]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let free = |dof: &usize| body.free[*dof];
        let dofs: Vec<u32> = nodes.iter().flat_map(|i| i * n..i * n + n).filter(free).map(|dof| dof as u32).collect();
        let place = |dof: usize| dofs.binary_search(&(dof as u32)).ok();
        let basis = |node: usize| bases.get(&node).copied().unwrap_or(AXES);
        let mut triplets = Vec::new();
        for &i in &nodes {
            for (j, block) in body.matrix.row(i).filter(|(j, _)| nodes.binary_search(j).is_ok()) {
                let block = in_basis(block, [&basis(i), &basis(j)], n, true);
                for (k, value) in block.iter().enumerate() {
                    if let (Some(row), Some(column)) = (place(i * n + k / n), place(j * n + k % n)) {
                        triplets.push(Triplet::new(row, column, *value));
                    }
                }
            }
        }
        for &(i, j, value) in entries {
            if let (Some(row), Some(column)) = (place(i as usize), place(j as usize)) {
                triplets.push(Triplet::new(row, column, value));
            }
        }
        let size = dofs.len();
        let singular = || SolveError::Singular { size };
        let matrix = SparseColMat::try_new_from_triplets(size, size, &triplets).map_err(|_| singular())?;
        // On one thread: sums of several would be taken in another order.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|_| singular())?;
        let factors = pool.install(|| matrix.sp_lu()).map_err(|_| singular())?;
        Ok(Surface { dofs, matrix, factors })
    }

    /// (K + J)⁻¹ r on the surface, by degree of freedom.
    pub fn solution(&self, r: &[f64]) -> Vec<(u32, f64)> {
        let right = Mat::from_fn(self.dofs.len(), 1, |i, _| r[self.dofs[i] as usize]);
        let solved = self.factors.solve(&right);
        self.dofs.iter().enumerate().map(|(i, &dof)| (dof, solved[(i, 0)])).collect()
    }

    /// (K + J) x on the surface, by degree of freedom.
    pub fn load(&self, x: &[f64]) -> Vec<(u32, f64)> {
        let mut load = vec![0.0; self.dofs.len()];
        for (j, &dof) in self.dofs.iter().enumerate() {
            let column = self.matrix.row_idx_of_col(j).zip(self.matrix.val_of_col(j));
            column.for_each(|(i, value)| load[i] += value * x[dof as usize]);
        }
        self.dofs.iter().copied().zip(load).collect()
    }
}
