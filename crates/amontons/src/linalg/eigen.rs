//! Largest eigenvalue of a symmetric pencil B x = μ K x by the method of Lanczos.
//!
//! The constant of an inequality √(x·Bx) ≤ s √(x·Kx) is s² = μ_max. K⁻¹B is self-adjoint for the product
//! x·By, and its largest eigenvalues are well apart where K is the stronger norm, so a few solutions with
//! the factor of K suffice (Parlett, *The Symmetric Eigenvalue Problem*, chapters 13 and 15; Nour-Omid,
//! Parlett, Ericsson, Jensen 1987 for B that is only semidefinite). Every vector is orthogonalized
//! against all before it, twice, so no eigenvalue appears more than once.

use faer::{Mat, Side};
use rayon::prelude::*;

use super::condensed::EXACT;
use super::error::SolveError;
use super::sparse::BlockMatrix;
use super::system::System;
use super::vectors::{add_combination, dot, orthogonalize};

/// Residual, relative to the eigenvalue, at which the iteration ends.
const TOLERANCE: f64 = 1e-12;

/// Largest number of basis vectors, which bounds the memory. A full basis is reduced to the better half of its Ritz
/// vectors.
const BASIS: usize = 60;

/// Largest number of iterations; if they do not suffice, the error shows it.
const STEPS: usize = 1000;

/// Constants for K without a factor: residual of the systems during the search and of the last one; residual of the
/// pair relative to the eigenvalue, whose error is of the order of its square; largest number of vectors; and the
/// fraction of its length below which a vector counts as linearly dependent.
const ROUGH: f64 = 0.1;
const JUDGED: f64 = 1e-3;
const NEAR: f64 = 1e-5;
const SEARCHED: usize = 12;
const DEPENDENT: f64 = 1e-10;

/// A pencil B x = μ K x, B positive semidefinite and K positive definite.
pub trait Pencil {
    /// Number of unknowns.
    fn size(&self) -> usize;
    /// B x.
    fn numerator(&self, x: &[f64]) -> Vec<f64>;
    /// K x.
    ///
    /// # Errors
    /// When the product cannot be computed.
    fn denominator(&self, x: &[f64]) -> Result<Vec<f64>, SolveError>;
    /// Computes K⁻¹ r in place, until the residual is `enough` times that of zero or at the round-off of a factor.
    ///
    /// # Errors
    /// When the system cannot be solved.
    fn solve(&mut self, r: &mut [f64], enough: f64) -> Result<(), SolveError>;
    /// True if solutions come from a factor, which ignores `enough`.
    fn has_factor(&self) -> bool {
        true
    }
}

/// Largest eigenvalue of a pencil, with its eigenvector.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenpair {
    /// Largest μ = x·Bx / x·Kx; 0 if B = 0 or there are no unknowns.
    pub value: f64,
    /// Error bound: the pencil has an eigenvalue within this distance, ‖K⁻¹Bx − μx‖ / ‖x‖ in the norm √(x·Bx), computed
    /// from the vector, round-off included.
    pub error: f64,
    /// Eigenvector x, of length 1 in the norm of K; zero if B = 0.
    pub vector: Vec<f64>,
}

/// The largest eigenvalue μ of B x = μ K x. The start vector is fixed and no sum depends on the number of
/// threads, so the bits are the same in every run.
///
/// # Errors
/// When a system with K cannot be solved.
pub fn largest(pencil: &mut impl Pencil) -> Result<Eigenpair, SolveError> {
    if pencil.has_factor() { lanczos(pencil) } else { davidson(pencil) }
}

/// Fixed start vector, orthogonal to no eigenvector by symmetry and mapped into the range of K⁻¹B, where x·Bx vanishes
/// for x = 0 only.
fn start(pencil: &mut impl Pencil, enough: f64) -> Result<Vec<f64>, SolveError> {
    // Fractional parts of multiples of the golden ratio.
    let start: Vec<f64> = (1..=pencil.size()).map(|i| 0.5 + (i as f64 * 0.618_033_988_749_894_9).fract()).collect();
    let mut x = pencil.numerator(&start);
    pencil.solve(&mut x, enough)?;
    Ok(x)
}

/// Lanczos method for K⁻¹B, with a factor of K.
fn lanczos(pencil: &mut impl Pencil) -> Result<Eigenpair, SolveError> {
    let mut x = start(pencil, EXACT)?;
    let mut bx = pencil.numerator(&x);
    let mut norm = dot(&x, &bx).max(0.0).sqrt();
    let mut span = Span::default();
    let mut best = Vec::new();
    let mut converged = norm == 0.0;
    for _ in 0..STEPS {
        if converged {
            break;
        }
        let mut next: Vec<f64> = bx.iter().map(|b| b / norm).collect();
        span.images.push(next.clone());
        span.basis.push(x.into_iter().map(|x| x / norm).collect());
        pencil.solve(&mut next, EXACT)?;
        span.project(&mut next);
        x = next;
        bx = pencil.numerator(&x);
        norm = dot(&x, &bx).max(0.0).sqrt();
        let Some(ritz) = span.ritz() else { break };
        converged = span.len() == x.len() || norm * ritz.last_entry(0).abs() <= TOLERANCE * ritz.values[0];
        if span.len() == BASIS && !converged {
            span.reduce(&ritz, BASIS / 2);
            best = vec![1.0];
        } else {
            best = ritz.vector(0);
        }
    }
    let x = if best.is_empty() { vec![0.0; pencil.size()] } else { combination(&best, &span.basis) };
    judged(pencil, x)
}

/// Davidson method (E. R. Davidson, J. Comput. Phys. 17 (1975) 87; A. V. Knyazev, SIAM J. Sci. Comput. 23 (2001) 517):
/// the space of Ritz vectors grows by the residual, solved with K to a few digits.
fn davidson(pencil: &mut impl Pencil) -> Result<Eigenpair, SolveError> {
    let mut next = start(pencil, ROUGH)?;
    let mut space = SearchSubspace::default();
    let mut best = vec![0.0; next.len()];
    for _ in 0..STEPS {
        if !space.add(pencil, std::mem::take(&mut next))? {
            break;
        }
        let Some(ritz) = space.ritz() else { break };
        let part = ritz.vector(0);
        best = combination(&part, &space.basis);
        let mut residual = combination(&part, &space.numerators);
        subtract(&mut residual, ritz.values[0], &combination(&part, &space.denominators));
        next.clone_from(&residual);
        pencil.solve(&mut next, ROUGH)?;
        if dot(&residual, &next).max(0.0).sqrt() <= NEAR * ritz.values[0] {
            break;
        }
        if space.basis.len() == SEARCHED {
            space.reduce(&ritz, SEARCHED / 2);
        }
    }
    judged(pencil, best)
}

/// Search space: vectors orthonormal for x·Ky, with their products.
#[derive(Default)]
struct SearchSubspace {
    basis: Vec<Vec<f64>>,
    numerators: Vec<Vec<f64>>,
    denominators: Vec<Vec<f64>>,
}

impl SearchSubspace {
    /// Adds a vector; returns false if it is zero or linearly dependent on those before.
    fn add(&mut self, pencil: &impl Pencil, mut x: Vec<f64>) -> Result<bool, SolveError> {
        let size = dot(&x, &pencil.denominator(&x)?).max(0.0).sqrt();
        orthogonalize(&mut x, &self.basis, &self.denominators);
        let mut kx = pencil.denominator(&x)?;
        let length = dot(&x, &kx).max(0.0).sqrt();
        if length.is_nan() || length <= DEPENDENT * size {
            return Ok(false);
        }
        scale(&mut x, 1.0 / length);
        scale(&mut kx, 1.0 / length);
        self.numerators.push(pencil.numerator(&x));
        self.denominators.push(kx);
        self.basis.push(x);
        Ok(true)
    }

    fn ritz(&self) -> Option<Ritz> {
        let n = self.basis.len();
        Ritz::of(&Mat::from_fn(n, n, |i, j| dot(&self.basis[i.min(j)], &self.numerators[i.max(j)])))
    }

    /// Reduces the basis to the first `keep` Ritz vectors.
    fn reduce(&mut self, ritz: &Ritz, keep: usize) {
        let vectors: Vec<Vec<f64>> = (0..keep).map(|k| ritz.vector(k)).collect();
        for set in [&mut self.basis, &mut self.numerators, &mut self.denominators] {
            let combined = vectors.iter().map(|s| combination(s, set)).collect();
            *set = combined;
        }
    }
}

/// Vectors orthonormal for x·By, and the matrix of K⁻¹B on their span.
///
/// The better half of the Ritz vectors and the next vector span the same space as a longer run
/// (thick restart; Wu, Simon 2000); all entries of the matrix are computed, so that no case is special.
#[derive(Default)]
struct Span {
    basis: Vec<Vec<f64>>,
    images: Vec<Vec<f64>>,
    /// Columns of the upper triangle.
    matrix: Vec<Vec<f64>>,
}

/// Eigenvalues of the projected matrix, the largest first, with their vectors.
struct Ritz {
    values: Vec<f64>,
    vectors: Mat<f64>,
}

impl Ritz {
    fn of(matrix: &Mat<f64>) -> Option<Ritz> {
        let eigen = matrix.self_adjoint_eigen(Side::Upper).ok()?;
        Some(Ritz { values: eigen.S().column_vector().iter().rev().copied().collect(), vectors: eigen.U().to_owned() })
    }

    fn vector(&self, k: usize) -> Vec<f64> {
        self.vectors.col(self.values.len() - 1 - k).iter().copied().collect()
    }

    fn last_entry(&self, k: usize) -> f64 {
        let n = self.values.len();
        self.vectors[(n - 1, n - 1 - k)]
    }
}

impl Span {
    fn len(&self) -> usize {
        self.basis.len()
    }

    /// Orthogonalizes K⁻¹B times the last vector against the basis, twice; the coefficients are a column of the matrix.
    fn project(&mut self, w: &mut [f64]) {
        self.matrix.push(orthogonalize(w, &self.basis, &self.images));
    }

    fn ritz(&self) -> Option<Ritz> {
        let n = self.len();
        Ritz::of(&Mat::from_fn(n, n, |i, j| self.matrix[i.max(j)][i.min(j)]))
    }

    /// Reduces the basis to the first `keep` Ritz vectors.
    fn reduce(&mut self, ritz: &Ritz, keep: usize) {
        let vectors: Vec<Vec<f64>> = (0..keep).map(|k| ritz.vector(k)).collect();
        for set in [&mut self.basis, &mut self.images] {
            let combined = vectors.par_iter().map(|s| combination(s, set)).collect();
            *set = combined;
        }
        self.matrix = (0..keep).map(|k| (0..=k).map(|i| if i == k { ritz.values[k] } else { 0.0 }).collect()).collect();
    }
}

fn combination(factors: &[f64], vectors: &[Vec<f64>]) -> Vec<f64> {
    let mut sum = vec![0.0; vectors.first().map_or(0, Vec::len)];
    add_combination(&mut sum, factors, vectors);
    sum
}

/// Eigenpair of a vector: its Rayleigh quotient and the residual as error bound.
fn judged(pencil: &mut impl Pencil, mut x: Vec<f64>) -> Result<Eigenpair, SolveError> {
    if x.iter().all(|&x| x == 0.0) {
        return Ok(Eigenpair { value: 0.0, error: 0.0, vector: x });
    }
    let energy = dot(&x, &pencil.denominator(&x)?);
    scale(&mut x, 1.0 / energy.sqrt());
    let (kx, mut residual) = (pencil.denominator(&x)?, pencil.numerator(&x));
    let value = dot(&x, &residual) / dot(&x, &kx);
    subtract(&mut residual, value, &kx);
    let exact = pencil.has_factor();
    pencil.solve(&mut residual, if exact { EXACT } else { JUDGED })?;
    // Doubled for the inexact solution of an iteration.
    let sure = if exact { 1.0 } else { 2.0 };
    let error = sure * (dot(&residual, &pencil.numerator(&residual)).max(0.0) / value).sqrt();
    Ok(Eigenpair { value, error, vector: x })
}

fn subtract(y: &mut [f64], factor: f64, x: &[f64]) {
    add_combination(y, &[-factor], &[x]);
}

fn scale(x: &mut [f64], factor: f64) {
    for x in x {
        *x *= factor;
    }
}

/// The quotient of two forms on the unknowns of a system: B over K, vectors in elimination order.
#[derive(Debug)]
pub struct Quotient<'a> {
    /// B; a matrix of 1 × 1 blocks acts on every component.
    pub numerator: &'a BlockMatrix,
    /// K, the matrix of the system.
    pub denominator: &'a BlockMatrix,
    /// The factor of K.
    pub system: &'a mut System,
}

impl Quotient<'_> {
    fn product(&self, matrix: &BlockMatrix, x: &[f64]) -> Vec<f64> {
        let unknowns = self.system.unknowns();
        let mut full = vec![0.0; self.denominator.graph().len() * self.denominator.block_shape().0];
        unknowns.add(x, &mut full);
        unknowns.gather(&matrix.apply(&full))
    }
}

impl Pencil for Quotient<'_> {
    fn size(&self) -> usize {
        self.system.unknowns().len()
    }
    fn numerator(&self, x: &[f64]) -> Vec<f64> {
        self.product(self.numerator, x)
    }
    fn denominator(&self, x: &[f64]) -> Result<Vec<f64>, SolveError> {
        Ok(self.product(self.denominator, x))
    }
    fn solve(&mut self, r: &mut [f64], enough: f64) -> Result<(), SolveError> {
        self.system.solve_to(r, enough)
    }
    fn has_factor(&self) -> bool {
        self.system.is_direct()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// B = diag(values), K = I.
    struct Diagonal(Vec<f64>, bool);

    impl Pencil for Diagonal {
        fn size(&self) -> usize {
            self.0.len()
        }
        fn numerator(&self, x: &[f64]) -> Vec<f64> {
            self.0.iter().zip(x).map(|(d, x)| d * x).collect()
        }
        fn denominator(&self, x: &[f64]) -> Result<Vec<f64>, SolveError> {
            Ok(x.to_vec())
        }
        /// Without a factor a solution has a relative error of up to `enough`, a different one per entry.
        fn solve(&mut self, r: &mut [f64], enough: f64) -> Result<(), SolveError> {
            if !self.1 {
                r.iter_mut().enumerate().for_each(|(i, r)| *r *= 1.0 + enough * (i as f64).sin());
            }
            Ok(())
        }
        fn has_factor(&self) -> bool {
            self.1
        }
    }

    #[test]
    fn semidefinite_multiple_and_empty_pencils() -> Result<(), SolveError> {
        for (values, expected) in [
            (vec![], 0.0),
            (vec![0.0; 5], 0.0),
            (vec![7.0], 7.0),
            (vec![0.0, 2.0, 0.0, 0.0], 2.0),
            (vec![1e-20; 9], 1e-20),
            (vec![3.0, 3.0, 1.0, 0.0, 3.0, 2.0], 3.0),
        ] {
            for (has_factor, near, error) in [(true, 1e-15, 1e-12), (false, 1e-9, 1e-4)] {
                let pair = largest(&mut Diagonal(values.clone(), has_factor))?;
                assert!(
                    (pair.value - expected).abs() <= near * expected && pair.error <= error * expected,
                    "{values:?}: {} ± {:e}",
                    pair.value,
                    pair.error
                );
            }
        }
        Ok(())
    }

    /// Eigenvalues of a strip a hundred times as long as wide crowd at the largest: 1/μ = 1 + (j/50)². They need
    /// more vectors than are kept, fewer than there are.
    #[test]
    fn crowded_eigenvalues_are_reached_with_a_reduced_basis() -> Result<(), SolveError> {
        let values: Vec<f64> = (0..2000).map(|j| 1.0 / (1.0 + (f64::from(j) / 50.0).powi(2))).collect();
        // Without a factor the residual ends the search; its square over the distance of eigenvalues is the error.
        for (has_factor, near, error) in [(true, 1e-14, 2.0 * TOLERANCE), (false, NEAR, 4.0 * NEAR)] {
            let pair = largest(&mut Diagonal(values.clone(), has_factor))?;
            assert!((pair.value - 1.0).abs() < near && pair.error < error, "{:e} ± {:e}", pair.value - 1.0, pair.error);
        }
        Ok(())
    }
}
