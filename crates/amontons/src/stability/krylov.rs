//! Eigenvalues of the pencil nearest to a shift: Arnoldi's method on (𝓐 − σ𝓑)⁻¹𝓑 of its linear form.
//!
//! With v = λx and z_τ = λx/(λ + 1/τ), T(λ)x = 0 is 𝓐y = λ𝓑y for y = (x, v, z):
//!
//! ```text
//! v = λx,    −T₀x − T₁v − Σ A_τ z_τ = λT₂v,    v − z_τ/τ = λz_τ
//! ```
//!
//! One application solves T(σ)x = r. The method starts with two vectors, so that it finds both of a double eigenvalue,
//! as bodies of revolution have them, and keeps all vectors: there is no restart to choose.

use faer::linalg::matmul::matmul;
use faer::traits::Conjugate;
use faer::{Accum, Mat, MatMut, MatRef, Par, c64};

use super::polynomial::{Polynomial, norm};
use super::{StabilityError, Wanted};
use crate::linalg::{Pivots, SolveError};

/// Size of an eigenvalue's residual, relative to that of the operator, at which it counts as found.
const FOUND: f64 = 1e-12;
/// Size of a new vector, relative to what it was, that is round-off: the space is exhausted.
const NOTHING: f64 = 1e-14;
/// Vectors the method starts with.
const FIRST: usize = 2;

const ONE: c64 = c64::new(1.0, 0.0);

/// y ← factor A x, or y ← y + factor A x.
fn product<C: Conjugate<Canonical = c64>>(y: &mut [c64], a: MatRef<C>, x: &[c64], how: Accum, factor: c64) {
    let rows = y.len();
    let y = MatMut::from_column_major_slice_mut(y, rows, 1);
    matmul(y, how, a, MatRef::from_column_major_slice(x, x.len(), 1), factor, Par::Seq);
}

/// An approximate eigenpair.
#[derive(Clone, Debug)]
pub(super) struct RitzPair {
    pub lambda: c64,
    /// Residual of 1/(λ − σ), relative to its size.
    pub error: f64,
    /// Coefficients of the vector in the basis.
    vector: Vec<c64>,
}

impl RitzPair {
    /// True if the eigenvalue is found to round-off.
    pub fn is_found(&self) -> bool {
        self.error <= FOUND
    }
}

/// The Krylov space about a shift.
pub(super) struct KrylovSpace<'a> {
    polynomial: &'a Polynomial,
    pivots: &'a Pivots<'a>,
    shift: c64,
    /// Size of v against x: the largest rate of interest, 1/s.
    rate: f64,
    /// The vectors of the basis, one after the other.
    basis: Vec<c64>,
    /// Columns of the projected operator, each as long as the basis was after it.
    columns: Vec<Vec<c64>>,
    is_exhausted: bool,
}

impl<'a> KrylovSpace<'a> {
    pub fn new(polynomial: &'a Polynomial, pivots: &'a Pivots<'a>, shift: c64) -> KrylovSpace<'a> {
        let rate = shift.norm();
        let mut space = KrylovSpace {
            polynomial,
            pivots,
            shift,
            rate,
            basis: Vec::new(),
            columns: Vec::new(),
            is_exhausted: false,
        };
        let mut seed = 0x9E37_79B9_7F4A_7C15u64;
        for _ in 0..FIRST {
            let start: Vec<c64> = (0..space.length())
                .map(|_| {
                    seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    c64::new((seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5, 0.0)
                })
                .collect();
            // Applied once, so that the part of infinite eigenvalues is gone.
            let start = space.apply(&start);
            space.orthogonalized(start);
        }
        space
    }

    /// Length of y.
    fn length(&self) -> usize {
        self.polynomial.size() * (2 + self.polynomial.branches())
    }

    /// The pencil.
    pub fn polynomial(&self) -> &Polynomial {
        self.polynomial
    }

    /// Dimension of the space.
    pub fn dimension(&self) -> usize {
        self.columns.len()
    }

    /// Bytes per dimension.
    pub fn bytes(&self) -> usize {
        self.length() * size_of::<c64>()
    }

    /// True if the space holds all there is.
    pub fn is_exhausted(&self) -> bool {
        self.is_exhausted
    }

    /// Number of vectors of the basis.
    fn count(&self) -> usize {
        self.basis.len() / self.length().max(1)
    }

    /// Orthogonalizes a vector against the basis, twice, and appends it if something is left. Returns the coefficients.
    fn orthogonalized(&mut self, mut vector: Vec<c64>) -> Vec<c64> {
        let (before, length, count) = (norm(&vector), self.length(), self.count());
        let mut coefficients = vec![c64::default(); count];
        let basis = MatRef::from_column_major_slice(&self.basis[..], length, count);
        for _ in 0..2 {
            let mut along = vec![c64::default(); count];
            product(&mut along, basis.adjoint(), &vector, Accum::Replace, ONE);
            product(&mut vector, basis, &along, Accum::Add, -ONE);
            coefficients.iter_mut().zip(&along).for_each(|(sum, along)| *sum += *along);
        }
        let left = norm(&vector);
        if left > NOTHING * before {
            coefficients.push(c64::new(left, 0.0));
            self.basis.extend(vector.iter().map(|v| *v / left));
        }
        coefficients
    }

    /// (𝓐 − σ𝓑)⁻¹𝓑 y.
    fn apply(&self, y: &[c64]) -> Vec<c64> {
        let (polynomial, n, sigma) = (self.polynomial, self.polynomial.size(), self.shift);
        let (minus, x0) = (c64::new(-1.0, 0.0), &y[..n]);
        let v0: Vec<c64> = y[n..2 * n].iter().map(|v| *v * self.rate).collect();
        let mut right = vec![c64::default(); n];
        polynomial.add_product(2, minus, &v0, &mut right);
        polynomial.add_product(1, minus, x0, &mut right);
        polynomial.add_product(2, -sigma, x0, &mut right);
        for (group, rate) in polynomial.rates.iter().enumerate() {
            let change: Vec<c64> = x0.iter().zip(&y[(2 + group) * n..]).map(|(x, z)| *x - *z).collect();
            polynomial.add_product(3 + group, minus / (sigma + rate), &change, &mut right);
        }
        let mut out = self.pivots.solve(&right);
        let v: Vec<c64> = x0.iter().zip(&out).map(|(x0, x)| *x0 + sigma * *x).collect();
        out.extend(v.iter().map(|v| *v / self.rate));
        for (group, rate) in polynomial.rates.iter().enumerate() {
            out.extend(v.iter().zip(&y[(2 + group) * n..]).map(|(v, z)| (*v - *z) / (sigma + rate)));
        }
        out
    }

    /// Adds dimensions to the space.
    ///
    /// # Errors
    /// If the search was asked to stop.
    pub fn extend(&mut self, by: usize, wanted: &Wanted) -> Result<(), SolveError> {
        for _ in 0..by {
            wanted.go_on()?;
            let from = self.columns.len() * self.length();
            let Some(next) = self.basis.get(from..from + self.length()) else {
                self.is_exhausted = true;
                return Ok(());
            };
            let image = self.apply(next);
            let column = self.orthogonalized(image);
            self.columns.push(column);
        }
        Ok(())
    }

    /// The eigenpairs of the projected operator, the nearest to the shift first.
    ///
    /// # Errors
    /// If the eigenvalues of the small matrix are not found.
    pub fn ritz(&self) -> Result<Vec<RitzPair>, StabilityError> {
        let m = self.columns.len();
        let entry = |i: usize, j: usize| self.columns[j].get(i).copied().unwrap_or_default();
        let projected = Mat::from_fn(m, m, entry);
        let eigen = projected.eigen().map_err(|_| StabilityError::Eigenvalues { size: m })?;
        let (values, vectors) = (eigen.S().column_vector(), eigen.U());
        let mut found = Vec::with_capacity(m);
        for k in 0..m {
            let (nu, mut vector): (c64, Vec<c64>) = (values[k], (0..m).map(|i| vectors[(i, k)]).collect());
            let size = norm(&vector);
            for v in &mut vector {
                *v /= size;
            }
            // The part of the image outside of the space.
            let outside: f64 = (m..self.count())
                .map(|i| vector.iter().enumerate().map(|(j, v)| entry(i, j) * *v).sum::<c64>().norm_sqr())
                .sum();
            if nu.norm() > 0.0 {
                let error = outside.sqrt() / nu.norm();
                found.push(RitzPair { lambda: self.shift + c64::new(1.0, 0.0) / nu, error, vector });
            }
        }
        found.sort_by(|a, b| (a.lambda - self.shift).norm().total_cmp(&(b.lambda - self.shift).norm()));
        Ok(found)
    }

    /// The eigenvector x of T(λ), of size 1.
    pub fn vector(&self, ritz: &RitzPair) -> Vec<c64> {
        let mut x = vec![c64::default(); self.polynomial.size()];
        for (own, factor) in self.basis.chunks_exact(self.length().max(1)).zip(&ritz.vector) {
            x.iter_mut().zip(own).for_each(|(x, own)| *x += *factor * *own);
        }
        let size = norm(&x);
        for x in &mut x {
            *x /= size;
        }
        x
    }
}
