//! Largest eigenvalue of a symmetric pencil B x = μ K x by the method of Lanczos.
//!
//! The constant of an inequality √(x·Bx) ≤ s √(x·Kx) is s² = μ_max. K⁻¹B is self-adjoint for the product
//! x·By, and its largest eigenvalues are well apart where K is the stronger norm, so a few solutions with
//! the factor of K suffice (Parlett, *The Symmetric Eigenvalue Problem*, chapters 13 and 15; Nour-Omid,
//! Parlett, Ericsson, Jensen 1987 for B that is only semidefinite). Every vector is orthogonalized
//! against all before it, twice, so no eigenvalue appears more than once.

use faer::{Mat, Side};
use rayon::prelude::*;

use super::condensed::Condensed;
use super::factor::{Backend, Factor, FactorError, Unknowns};
use super::sparse::{BlockMatrix, dot};
use super::supernodal::Supernodal;

/// Residual at which the iteration ends, relative to the eigenvalue.
const TOLERANCE: f64 = 1e-12;

/// Vectors kept at once: bounds the memory. Of a full basis the better half of its Ritz vectors stays.
const BASIS: usize = 60;

/// Steps after which the iteration ends in any case; what is not reached then shows in the error.
const STEPS: usize = 1000;

/// A pencil B x = μ K x, B positive semidefinite and K positive definite.
pub trait Pencil {
    /// Number of unknowns.
    fn size(&self) -> usize;
    /// B x.
    fn numerator(&self, x: &[f64]) -> Vec<f64>;
    /// K x.
    fn denominator(&self, x: &[f64]) -> Vec<f64>;
    /// K⁻¹ r in place.
    fn solve(&mut self, r: &mut [f64]);
}

/// The largest eigenvalue of a pencil with its vector.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenpair {
    /// μ = x·Bx / x·Kx, the largest; 0 where B = 0 or there are no unknowns.
    pub value: f64,
    /// The pencil has an eigenvalue within this distance: ‖K⁻¹Bx − μx‖ / ‖x‖ in the norm √(x·Bx), computed from the
    /// vector, round-off included.
    pub error: f64,
    /// x, of length 1 in the norm of K; zero where B = 0.
    pub vector: Vec<f64>,
}

/// The largest eigenvalue μ of B x = μ K x. The start vector is fixed and no sum depends on the number of
/// threads, so the bits are the same in every run.
pub fn largest(pencil: &mut impl Pencil) -> Eigenpair {
    // Fractional parts of multiples of the golden ratio: no eigenvector is orthogonal to them by symmetry.
    let start: Vec<f64> = (1..=pencil.size()).map(|i| 0.5 + (i as f64 * 0.618_033_988_749_894_9).fract()).collect();
    // One application puts it into the range of K⁻¹B, where x·Bx vanishes for x = 0 only.
    let mut x = pencil.numerator(&start);
    pencil.solve(&mut x);
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
        pencil.solve(&mut next);
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
        let mut column = vec![0.0; self.len()];
        for _ in 0..2 {
            let coefficients: Vec<f64> = self.images.iter().map(|bq| dot(w, bq)).collect();
            for ((c, sum), q) in coefficients.into_iter().zip(&mut column).zip(&self.basis) {
                subtract(w, c, q);
                *sum += c;
            }
        }
        self.matrix.push(column);
    }

    fn ritz(&self) -> Option<Ritz> {
        let n = self.len();
        let matrix = Mat::from_fn(n, n, |i, j| self.matrix[i.max(j)][i.min(j)]);
        let eigen = matrix.self_adjoint_eigen(Side::Upper).ok()?;
        Some(Ritz { values: eigen.S().column_vector().iter().rev().copied().collect(), vectors: eigen.U().to_owned() })
    }

    /// Keeps the first Ritz vectors.
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
    for (s, q) in factors.iter().zip(vectors) {
        subtract(&mut sum, -s, q);
    }
    sum
}

/// The vector's own quotient and residual.
fn judged(pencil: &mut impl Pencil, mut x: Vec<f64>) -> Eigenpair {
    let energy = dot(&x, &pencil.denominator(&x));
    if x.iter().all(|&x| x == 0.0) {
        return Eigenpair { value: 0.0, error: 0.0, vector: x };
    }
    scale(&mut x, 1.0 / energy.sqrt());
    let (kx, mut residual) = (pencil.denominator(&x), pencil.numerator(&x));
    let value = dot(&x, &residual) / dot(&x, &kx);
    subtract(&mut residual, value, &kx);
    pencil.solve(&mut residual);
    let error = (dot(&residual, &pencil.numerator(&residual)).max(0.0) / value).sqrt();
    Eigenpair { value, error, vector: x }
}

fn subtract(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y -= factor * x;
    }
}

fn scale(x: &mut [f64], factor: f64) {
    for x in x {
        *x *= factor;
    }
}

/// A matrix on its unknowns, factorized with the contact unknowns last, that is solved as a whole.
#[derive(Debug)]
pub struct System {
    unknowns: Unknowns,
    factor: Box<dyn Factor>,
    condensed: Condensed,
}

impl System {
    /// Factorizes the rows and columns of `matrix` that `unknowns` names.
    ///
    /// # Errors
    /// When the matrix is not positive definite or does not fit into memory.
    pub fn new(matrix: &BlockMatrix, unknowns: Unknowns) -> Result<System, FactorError> {
        let factor = Supernodal.factorize(matrix, &unknowns)?;
        let condensed = Condensed::new(factor.condensed(), unknowns.contact_nodes(matrix.block_shape().0));
        Ok(System { unknowns, factor, condensed })
    }

    /// The unknowns in elimination order.
    #[must_use]
    pub fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    /// The condensed operator S on the contact unknowns: x·Sx is the least energy of all vectors with these contact
    /// entries.
    #[must_use]
    pub fn condensed(&self) -> &Condensed {
        &self.condensed
    }

    /// Solves S x = r in place on the contact unknowns.
    pub fn solve_condensed(&mut self, r: &mut [f64]) {
        if !self.condensed.is_empty() {
            self.condensed.solve(&[], r);
        }
    }

    /// The vector with these contact entries whose energy is the least, in elimination order.
    #[must_use]
    pub fn extend(&self, contact: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.unknowns.interior];
        x.extend_from_slice(contact);
        self.factor.backward(&mut x);
        x
    }

    /// Solves K x = r in place, in elimination order.
    pub fn solve(&mut self, r: &mut [f64]) {
        let interior = self.unknowns.interior;
        self.factor.forward(r);
        self.solve_condensed(&mut r[interior..]);
        self.factor.backward(r);
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
        let unknowns = &self.system.unknowns;
        let mut full = vec![0.0; self.denominator.graph().len() * self.denominator.block_shape().0];
        unknowns.add(x, &mut full);
        unknowns.gather(&matrix.apply(&full))
    }
}

impl Pencil for Quotient<'_> {
    fn size(&self) -> usize {
        self.system.unknowns.len()
    }
    fn numerator(&self, x: &[f64]) -> Vec<f64> {
        self.product(self.numerator, x)
    }
    fn denominator(&self, x: &[f64]) -> Vec<f64> {
        self.product(self.denominator, x)
    }
    fn solve(&mut self, r: &mut [f64]) {
        self.system.solve(r);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// B = diag(values), K = I.
    struct Diagonal(Vec<f64>);

    impl Pencil for Diagonal {
        fn size(&self) -> usize {
            self.0.len()
        }
        fn numerator(&self, x: &[f64]) -> Vec<f64> {
            self.0.iter().zip(x).map(|(d, x)| d * x).collect()
        }
        fn denominator(&self, x: &[f64]) -> Vec<f64> {
            x.to_vec()
        }
        fn solve(&mut self, _r: &mut [f64]) {}
    }

    #[test]
    fn semidefinite_multiple_and_empty_pencils() {
        for (values, expected) in [
            (vec![], 0.0),
            (vec![0.0; 5], 0.0),
            (vec![7.0], 7.0),
            (vec![0.0, 2.0, 0.0, 0.0], 2.0),
            (vec![1e-20; 9], 1e-20),
            (vec![3.0, 3.0, 1.0, 0.0, 3.0, 2.0], 3.0),
        ] {
            let pair = largest(&mut Diagonal(values.clone()));
            assert!(
                (pair.value - expected).abs() <= 1e-15 * expected && pair.error <= 1e-12 * expected,
                "{values:?}: {} ± {:e}",
                pair.value,
                pair.error
            );
        }
    }

    /// Eigenvalues of a strip a hundred times as long as wide crowd at the largest: 1/μ = 1 + (j/50)². They need
    /// more vectors than are kept, fewer than there are.
    #[test]
    fn crowded_eigenvalues_are_reached_with_a_reduced_basis() {
        let values: Vec<f64> = (0..2000).map(|j| 1.0 / (1.0 + (f64::from(j) / 50.0).powi(2))).collect();
        let pair = largest(&mut Diagonal(values));
        assert!(
            (pair.value - 1.0).abs() < 1e-14 && pair.error < 2.0 * TOLERANCE,
            "{:e} ± {:e}",
            pair.value - 1.0,
            pair.error
        );
    }
}
