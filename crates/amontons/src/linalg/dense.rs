//! A dense backend: small systems, and the reference of the sparse one; the product L Lᵀ.

use std::sync::Arc;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use rayon::prelude::*;

use super::condensed::Condensed;
use super::error::SolveError;
use super::factor::{Backend, Factor, upper_columns};
use super::schur::Schur;
use super::sparse::BlockMatrix;
use super::unknowns::Unknowns;

/// A dense factorization, for small systems and as the reference of the sparse one.
#[derive(Debug, Clone, Copy, Default)]
pub struct Dense;

#[derive(Debug)]
struct DenseFactor {
    l: Mat<f64>,
    interior: usize,
    /// First unknown of each contact node.
    nodes: Vec<usize>,
}

impl Backend for Dense {
    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError> {
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
        Box::new(Schur::new(Arc::new(whole), self.nodes.clone()))
    }
    fn stored(&self) -> usize {
        self.l.nrows() * (self.l.nrows() + 1) / 2
    }
}

/// Columns of L Lᵀ that are computed at once, whatever the number of threads: the order of summation must not depend on
/// it.
const PART: usize = 256;
/// Rows of the lower half that are copied at once.
const STRIP: usize = 64;

/// L Lᵀ of a lower triangular L: n³/3 operations for the lower half, and none for what is zero above the diagonal of L.
pub(super) fn gram(l: &Mat<f64>) -> Mat<f64> {
    let n = l.nrows();
    let mut s = Mat::<f64>::zeros(n, n);
    if n == 0 {
        return s;
    }
    s.par_col_chunks_mut(PART).enumerate().for_each(|(part, columns)| {
        let (first, width) = (part * PART, columns.ncols());
        let right = l.submatrix(first, 0, width, first + width).transpose();
        matmul(
            columns.subrows_mut(first, n - first),
            Accum::Replace,
            l.submatrix(first, 0, n - first, first + width),
            right,
            1.0,
            Par::Seq,
        );
    });
    for strip in (0..n).step_by(STRIP) {
        for i in 0..n {
            for j in strip.max(i + 1)..(strip + STRIP).min(n) {
                s[(i, j)] = s[(j, i)];
            }
        }
    }
    s
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of whole numbers, whose product is exact, it is the product; of others it has the same bits on one thread and on
    /// three.
    #[test]
    fn the_product_with_the_transpose() -> Result<(), rayon::ThreadPoolBuildError> {
        for n in [0, 1, 5, PART, 2 * PART + 37] {
            let whole = |i: usize, j: usize| if i >= j { ((i * 7 + j * 5) % 11) as f64 - 5.0 } else { 0.0 };
            let s = gram(&Mat::from_fn(n, n, whole));
            for (i, j) in (0..n).step_by(3).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let exact: f64 = (0..n).map(|k| whole(i, k) * whole(j, k)).sum();
                assert!((s[(i, j)] - exact).abs() == 0.0, "n = {n}, ({i}, {j}): {}, expected {exact}", s[(i, j)]);
            }
            let l = Mat::from_fn(n, n, |i, j| if i >= j { ((i + 3 * j) as f64).sin() } else { 0.0 });
            let on = |threads: usize| {
                Ok::<_, rayon::ThreadPoolBuildError>(
                    rayon::ThreadPoolBuilder::new().num_threads(threads).build()?.install(|| gram(&l)),
                )
            };
            assert_eq!(on(1)?, on(3)?, "n = {n}");
        }
        Ok(())
    }
}
