//! Dense and sparse factorizations on one thread. In parallel ones the order of summation, and with it the last bits,
//! would depend on the number of threads.

use std::mem::MaybeUninit;

use faer::dyn_stack::{MemStack, StackReq};
use faer::linalg::cholesky::llt;
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::prelude::Solve;
use faer::sparse::linalg::solvers;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, MatMut, MatRef, Par, Spec};

use super::error::SolveError;
use super::tangent::Entry;

/// Alignment of columns in bytes, the size of a vector register, and the numbers in it.
const ALIGNED: usize = 64;
const WIDE: usize = ALIGNED / size_of::<f64>();

/// A dense square matrix by columns, aligned to vector registers.
#[derive(Debug)]
pub(super) struct Square {
    numbers: Vec<f64>,
    size: usize,
    /// Offset of the first entry, and distance between columns.
    first: usize,
    stride: usize,
}

impl Square {
    /// Copies a matrix.
    pub fn of(matrix: MatRef<f64>) -> Square {
        let size = matrix.nrows();
        let stride = size.next_multiple_of(WIDE);
        let mut numbers = vec![0.0; size * stride + WIDE];
        let first = numbers.as_ptr().align_offset(ALIGNED).min(WIDE);
        for j in 0..size {
            let column = &mut numbers[first + j * stride..][..size];
            column.iter_mut().zip(matrix.col(j).iter()).for_each(|(to, from)| *to = *from);
        }
        Square { numbers, size, first, stride }
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Adds a value to entry (i, j).
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        self.numbers[self.first + j * self.stride + i] += value;
    }

    /// Read-only view of the matrix.
    pub fn as_ref(&self) -> MatRef<'_, f64> {
        let entries = &self.numbers[self.first..][..self.size * self.stride];
        MatRef::from_column_major_slice_with_stride(entries, self.size, self.size, self.stride)
    }

    /// Mutable view of the matrix, for factorizing it in place.
    fn as_mut(&mut self) -> MatMut<'_, f64> {
        let entries = &mut self.numbers[self.first..][..self.size * self.stride];
        MatMut::from_column_major_slice_with_stride_mut(entries, self.size, self.size, self.stride)
    }
}

/// Work space for the factorizations and solutions of this file.
pub(super) fn work_space(needed: StackReq) -> Vec<MaybeUninit<u8>> {
    vec![MaybeUninit::uninit(); needed.unaligned_bytes_required()]
}

/// LU factorization A = P⁻¹ L U with partial pivoting.
#[derive(Debug)]
pub(super) struct Lu {
    /// L below the diagonal, with a unit diagonal that is not stored, and U.
    factors: Square,
    /// Permutation of the rows into the order of the pivots, and its inverse.
    forward: Vec<usize>,
    backward: Vec<usize>,
}

impl Lu {
    /// Factorizes a matrix. If it is singular, solutions are not finite or leave a large part of the right-hand side.
    pub fn new(mut factors: Square) -> Lu {
        let n = factors.size();
        let (mut forward, mut backward) = (vec![0; n], vec![0; n]);
        let mut buffer = work_space(factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Spec::default()));
        factor::lu_in_place(
            factors.as_mut(),
            &mut forward,
            &mut backward,
            Par::Seq,
            MemStack::new(&mut buffer),
            Spec::default(),
        );
        Lu { factors, forward, backward }
    }

    /// Number of rows of A.
    pub fn size(&self) -> usize {
        self.factors.size()
    }

    /// Solves A x = b in place.
    pub fn solve(&self, b: &mut [f64]) {
        let n = self.size();
        let rows = PermRef::new_checked(&self.forward, &self.backward, n);
        let mut buffer = work_space(solve::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq));
        let x = MatMut::from_column_major_slice_mut(b, n, 1);
        let factors = self.factors.as_ref();
        solve::solve_in_place(factors, factors, rows, x, Par::Seq, MemStack::new(&mut buffer));
    }
}

/// Cholesky factorization A = L Lᵀ: half of the work of [`Lu`], without its search for pivots.
#[derive(Debug)]
pub(super) struct Cholesky(Square);

impl Cholesky {
    /// Factorizes a symmetric matrix given by its lower half, or returns `None` if it is not positive definite.
    pub fn new(mut matrix: Square) -> Option<Cholesky> {
        let n = matrix.size();
        let mut buffer = work_space(llt::factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, Spec::default()));
        let made = llt::factor::cholesky_in_place(
            matrix.as_mut(),
            llt::factor::LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut buffer),
            Spec::default(),
        );
        made.is_ok().then_some(Cholesky(matrix))
    }

    /// Solves A x = b in place.
    pub fn solve(&self, b: &mut [f64]) {
        let n = self.0.size();
        let mut buffer = work_space(llt::solve::solve_in_place_scratch::<f64>(n, 1, Par::Seq));
        let x = MatMut::from_column_major_slice_mut(b, n, 1);
        llt::solve::solve_in_place(self.0.as_ref(), x, Par::Seq, MemStack::new(&mut buffer));
    }
}

/// Sparse matrix with its LU factors.
#[derive(Debug)]
pub(super) struct SparseLu {
    matrix: SparseColMat<usize, f64>,
    /// The order of elimination, which follows from the pattern.
    symbolic: solvers::SymbolicLu<usize>,
    factors: solvers::Lu<usize, f64>,
}

impl SparseLu {
    /// Factorizes the square matrix that is the sum of the entries. The order of elimination is that of `before` if
    /// that has the same pattern: to find it takes longer than to eliminate.
    ///
    /// # Errors
    /// When the matrix is singular.
    pub fn new(
        size: usize,
        entries: impl Iterator<Item = Entry>,
        before: Option<&SparseLu>,
    ) -> Result<SparseLu, SolveError> {
        let singular = || SolveError::Singular { size };
        let triplets: Vec<_> = entries.map(|(i, j, value)| Triplet::new(i as usize, j as usize, value)).collect();
        let matrix = SparseColMat::try_new_from_triplets(size, size, &triplets).map_err(|_| singular())?;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|_| singular())?;
        let (symbolic, factors) = pool.install(|| {
            let known = before.filter(|before| has_same_pattern(&before.matrix, &matrix));
            let symbolic = match known {
                Some(before) => before.symbolic.clone(),
                None => solvers::SymbolicLu::try_new(matrix.symbolic()).map_err(|_| singular())?,
            };
            let factors = solvers::Lu::try_new_with_symbolic(symbolic.clone(), matrix.as_ref());
            factors.map(|factors| (symbolic, factors)).map_err(|_| singular())
        })?;
        Ok(SparseLu { matrix, symbolic, factors })
    }

    /// A⁻¹ b.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let solved = self.factors.solve(&Mat::from_fn(b.len(), 1, |i, _| b[i]));
        (0..b.len()).map(|i| solved[(i, 0)]).collect()
    }

    /// A x.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for (j, &x) in x.iter().enumerate() {
            let column = self.matrix.row_idx_of_col(j).zip(self.matrix.val_of_col(j));
            column.for_each(|(i, value)| y[i] += value * x);
        }
        y
    }
}

/// True if two matrices have entries at the same places.
fn has_same_pattern(a: &SparseColMat<usize, f64>, b: &SparseColMat<usize, f64>) -> bool {
    a.ncols() == b.ncols() && a.col_ptr() == b.col_ptr() && a.row_idx() == b.row_idx()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Factors after a matrix with the same pattern, and after one with another, have the bits of those without.
    #[test]
    fn an_order_of_elimination_is_taken_for_the_same_pattern() {
        let n = 60;
        let matrix = |seed: usize, far: usize| {
            let at = move |i: usize, j: usize| 1.0 / (1 + (seed * i + 5 * j) % 11) as f64;
            (0..n).flat_map(move |i| {
                let beside = [(i + 1) % n, (i * i + 3) % n, (i + far) % n].map(|j| (i as u32, j as u32, at(i, j)));
                beside.into_iter().chain([(i as u32, i as u32, 5.0)])
            })
        };
        let b: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let bits = |lu: &SparseLu| lu.solve(&b).into_iter().map(f64::to_bits).collect::<Vec<_>>();
        let first = SparseLu::new(n, matrix(3, 7), None).expect("a regular matrix");
        for (far, is_known) in [(7, true), (8, false)] {
            let alone = SparseLu::new(n, matrix(4, far), None).expect("a regular matrix");
            let after = SparseLu::new(n, matrix(4, far), Some(&first)).expect("a regular matrix");
            assert_eq!(has_same_pattern(&first.matrix, &after.matrix), is_known, "{far}");
            assert_eq!(bits(&after), bits(&alone), "{far}");
            let rest = after.apply(&after.solve(&b)).iter().zip(&b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
            assert!(rest < 1e-14, "{rest}");
        }
    }

    #[test]
    fn solutions_and_definiteness() {
        let n = 40;
        let entry = |i: usize, j: usize| ((7 * i + 3 * j + 1) as f64).sin() + if (i + 5) % n == j { 4.0 } else { 0.0 };
        let x: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
        let mut b: Vec<f64> = (0..n).map(|i| (0..n).map(|j| entry(i, j) * x[j]).sum()).collect();
        Lu::new(Square::of(Mat::from_fn(n, n, entry).as_ref())).solve(&mut b);
        assert!(b.iter().zip(&x).all(|(found, x)| (found - x).abs() < 1e-12), "{b:?}");
        // 2 on the diagonal, −1 beside it: eigenvalues 2 − 2 cos(πk/(n+1)).
        let least = 2.0 - 2.0 * (std::f64::consts::PI / (n + 1) as f64).cos();
        let shifted = |shift: f64| {
            let entry = |i: usize, j: usize| [2.0 - shift, -1.0, 0.0][i.abs_diff(j).min(2)];
            // The upper half is not read.
            Square::of(Mat::from_fn(n, n, |i, j| if i < j { f64::NAN } else { entry(i, j) }).as_ref())
        };
        assert!(Cholesky::new(shifted(1.01 * least)).is_none());
        let factor = Cholesky::new(shifted(0.9 * least)).expect("a positive definite matrix");
        let row = |i: usize| (0..n).map(move |j| [2.0 - 0.9 * least, -1.0, 0.0][i.abs_diff(j).min(2)]);
        let mut b: Vec<f64> = (0..n).map(|i| row(i).zip(&x).map(|(a, x)| a * x).sum()).collect();
        factor.solve(&mut b);
        assert!(b.iter().zip(&x).all(|(found, x)| (found - x).abs() < 1e-10), "{b:?}");
    }
}
