//! A dense backend: small systems, and the reference of the sparse one.

use faer::Mat;

use super::factor::{Backend, Factor, FactorError, Unknowns, upper_columns};
use super::sparse::BlockMatrix;

/// A dense factorization, for small systems and as the reference of the sparse one.
#[derive(Debug, Clone, Copy, Default)]
pub struct Dense;

#[derive(Debug)]
struct DenseFactor {
    l: Mat<f64>,
    interior: usize,
}

impl Backend for Dense {
    fn factorize(&self, matrix: &BlockMatrix, unknowns: &Unknowns) -> Result<Box<dyn Factor>, FactorError> {
        let size = unknowns.len();
        let upper = upper_columns(matrix, unknowns);
        let mut l = Mat::<f64>::zeros(size, size);
        for j in 0..size {
            for k in upper.start[j] as usize..upper.start[j + 1] as usize {
                l[(j, upper.rows[k] as usize)] = upper.values[k];
            }
        }
        // The contact unknowns are last and stay: S need not be positive definite where contact alone holds the body.
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
                return Err(FactorError::NotPositive { pivot: j, size });
            }
            let d = l[(j, j)].sqrt();
            for i in j..size {
                l[(i, j)] /= d;
            }
        }
        Ok(Box::new(DenseFactor { l, interior: unknowns.interior }))
    }
}

impl Factor for DenseFactor {
    fn forward(&self, r: &mut [f64]) {
        for j in 0..self.interior {
            r[j] /= self.l[(j, j)];
            for i in j + 1..r.len() {
                r[i] -= self.l[(i, j)] * r[j];
            }
        }
    }
    fn backward(&self, x: &mut [f64]) {
        for j in (0..self.interior).rev() {
            let sum: f64 = (j + 1..x.len()).map(|i| self.l[(i, j)] * x[i]).sum();
            x[j] = (x[j] - sum) / self.l[(j, j)];
        }
    }
    fn condensed(&self) -> Mat<f64> {
        let n = self.l.nrows() - self.interior;
        let s = self.l.submatrix(self.interior, self.interior, n, n);
        Mat::from_fn(n, n, |i, j| s[(i.max(j), i.min(j))])
    }
    fn stored(&self) -> usize {
        self.l.nrows() * (self.l.nrows() + 1) / 2
    }
}
