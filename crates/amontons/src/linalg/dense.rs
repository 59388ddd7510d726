//! Dense backend for small systems, and the reference for the sparse one.

use std::sync::Arc;

use faer::Mat;

use super::condensed::Condensed;
use super::error::SolveError;
use super::factor::{Backend, Factor, LowerTriangle};
use super::schur::Schur;
use super::sparse::BlockMatrix;
use super::stop::StopFlag;
use super::unknowns::Unknowns;

/// Dense factorization, for small systems and as the reference for the sparse one.
#[derive(Debug, Clone, Copy, Default)]
pub struct Dense;

#[derive(Debug)]
struct DenseFactor {
    l: Mat<f64>,
    interior: usize,
    /// First unknown per contact node.
    nodes: Vec<usize>,
}

impl Backend for Dense {
    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError> {
        let size = unknowns.len();
        let lower = LowerTriangle::new(matrix, unknowns);
        let mut l = Mat::<f64>::zeros(size, size);
        for j in 0..size {
            for (row, value) in lower.column(j) {
                l[(row as usize, j)] = value;
            }
        }
        // The contact unknowns are last and are not eliminated: S need not be positive definite if contact alone holds
        // the body.
        for j in 0..size {
            for k in 0..j.min(unknowns.interior) {
                for i in j..size {
                    l[(i, j)] -= l[(i, k)] * l[(j, k)];
                }
            }
            if j >= unknowns.interior {
                continue;
            }
            if l[(j, j)].is_nan() || l[(j, j)] <= 0.0 {
                return Err(SolveError::NotPositive { pivot: j, size });
            }
            let d = l[(j, j)].sqrt();
            for i in j..size {
                l[(i, j)] /= d;
            }
        }
        let nodes = unknowns.kept_nodes(matrix.block_shape().0);
        Ok(Box::new(DenseFactor { l, interior: unknowns.interior, nodes }))
    }
}

impl Factor for DenseFactor {
    fn forward(&self, r: &mut [f64]) -> Result<(), SolveError> {
        for j in 0..self.interior {
            r[j] /= self.l[(j, j)];
            for i in j + 1..r.len() {
                r[i] -= self.l[(i, j)] * r[j];
            }
        }
        Ok(())
    }
    fn backward(&self, x: &mut [f64]) -> Result<(), SolveError> {
        for j in (0..self.interior).rev() {
            let sum: f64 = (j + 1..x.len()).map(|i| self.l[(i, j)] * x[i]).sum();
            x[j] = (x[j] - sum) / self.l[(j, j)];
        }
        Ok(())
    }
    fn condensed(&self) -> Box<dyn Condensed> {
        let n = self.l.nrows() - self.interior;
        let s = self.l.submatrix(self.interior, self.interior, n, n);
        let whole = Mat::from_fn(n, n, |i, j| s[(i.max(j), i.min(j))]);
        Box::new(Schur::new(Arc::new(whole), self.nodes.clone(), StopFlag::default()))
    }
    fn stored(&self) -> usize {
        self.l.nrows() * (self.l.nrows() + 1) / 2
    }
}
