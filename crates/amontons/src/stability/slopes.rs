//! Derivatives of eigenvalues by data of the problem, from right and left eigenvectors:
//!
//! ```text
//! λ_m = − yᴴ T_m(λ) x / (yᴴ T_λ(λ) x),    T(λ) x = 0,  yᴴ T(λ) = 0
//! ```
//!
//! with the derivative T_m of the pencil at fixed λ, through the state about which it is linearised too. Of an
//! eigenvalue of k eigenvectors X and Y the derivatives are the eigenvalues of −(Yᴴ T_λ X)⁻¹ Yᴴ T_m X (P. Lancaster,
//! Numer. Math. 6 (1964) 377). Where two modes meet in one vector, Yᴴ T_λ X is singular, and there is no derivative.
//!
//! Yᴴ T(λ) X is evaluated at states of problems nearby ([`DifferentiableModes::projected`]), on the unknowns of this
//! state: the difference is one of operators, never of eigenvalues.

use faer::linalg::solvers::Solve;
use faer::{Mat, c64};

use super::polynomial::{Polynomial, norm};
use super::search::{FoundPair, FoundPairs};
use super::steady::{LinearisedState, SteadyState};
use super::{Modes, SAME, StabilityError, Wanted, search};
use crate::contact::Status;
use crate::linalg::{Pattern, Pivots, SolveError};

/// Distance of the shift of inverse iteration to the eigenvalue, relative to the rates of the search, and the number of
/// iterations. Eigenvalues that are not `APART` times as far from each other are one, since it does not tell their
/// vectors apart.
const OFFSET: f64 = 1e-11;
const APART: f64 = 1e3;
const ITERATIONS: usize = 4;
/// Residual of a vector that is one, and part of its size that yᴴ T_λ x has at least.
const TRUE: f64 = 1e-7;
const DEFECTIVE: f64 = 1e-9;

/// An eigenvalue with all its vectors.
struct EigenSpace {
    lambda: c64,
    /// The pairs of the search.
    pairs: Vec<usize>,
    right: Vec<Vec<c64>>,
    left: Vec<Vec<c64>>,
    /// Yᴴ T_λ X; `None` if there are no derivatives.
    weight: Option<Mat<c64>>,
    /// Size of the terms of Yᴴ T X.
    size: f64,
    /// True of one real eigenvalue of a real pencil, which stays real.
    is_real: bool,
}

/// Modes with the vectors that their derivatives need.
pub struct DifferentiableModes {
    modes: Modes,
    parts: Vec<(FoundPairs, Vec<EigenSpace>)>,
    statuses: Vec<(Status, usize)>,
}

impl DifferentiableModes {
    /// Finds the modes of a state with their left eigenvectors, for which each eigenvalue takes one factorization.
    ///
    /// # Errors
    /// Those of [`super::modes`].
    pub fn new(at: SteadyState, wanted: &Wanted) -> Result<DifferentiableModes, StabilityError> {
        let (mut modes, found) = search(at, wanted)?;
        let mut parts = Vec::with_capacity(found.len());
        for part in found {
            let spaces = spaces(&part, wanted)?;
            modes.factorizations += spaces.len();
            parts.push((part, spaces));
        }
        Ok(DifferentiableModes { modes, parts, statuses: LinearisedState::new(at, wanted)?.statuses() })
    }

    /// The modes.
    #[must_use]
    pub fn modes(&self) -> &Modes {
        &self.modes
    }

    /// The numbers Yᴴ T(λ) X of all eigenvalues, real and imaginary parts, with T at the state of a problem nearby;
    /// `None` if it has other unknowns, or contact points that are open, stick or slip where these are not.
    ///
    /// # Errors
    /// If the state cannot be linearised.
    pub fn projected(&self, at: SteadyState, wanted: &Wanted) -> Result<Option<Vec<f64>>, StabilityError> {
        let linearised = LinearisedState::new(at, wanted)?;
        if linearised.statuses() != self.statuses {
            return Ok(None);
        }
        let mut all = Vec::new();
        for (found, spaces) in &self.parts {
            let unknowns = linearised.unknowns(found.pencil.unknowns.waves());
            let Some(pencil) = linearised.pencil(unknowns, Some(&found.pencil)) else { return Ok(None) };
            let numbers = spaces.iter().flat_map(|space| space.projected(&pencil));
            all.extend(numbers.flat_map(|value| [value.re, value.im]));
        }
        Ok(Some(all))
    }

    /// The size of the terms of each number that [`DifferentiableModes::projected`] returns.
    #[must_use]
    pub fn sizes(&self) -> Vec<f64> {
        let spaces = self.parts.iter().flat_map(|(_, spaces)| spaces);
        spaces.flat_map(|space| std::iter::repeat_n(space.size, 2 * space.pairs.len().pow(2))).collect()
    }

    /// Adds a parameter, by the derivatives of the numbers of [`DifferentiableModes::projected`].
    ///
    /// # Errors
    /// If the eigenvalues of a small matrix are not found.
    pub fn add(&mut self, (name, value): (&str, f64), slopes: &[f64]) -> Result<(), StabilityError> {
        let mut all: Vec<Vec<Option<c64>>> = Vec::new();
        let mut numbers = slopes.chunks_exact(2).map(|part| c64::new(part[0], part[1]));
        for (found, spaces) in &self.parts {
            let mut of_pairs = vec![None; found.pairs.len()];
            for space in spaces {
                let k = space.pairs.len();
                // Column by column.
                let columns: Vec<c64> = numbers.by_ref().take(k * k).collect();
                let derivatives = space.derivatives(&columns)?;
                for (pair, derivative) in space.pairs.iter().zip(derivatives) {
                    of_pairs[*pair] = Some(derivative);
                }
            }
            all.push(of_pairs);
        }
        for mode in &mut self.modes.modes {
            let own = all.get(mode.origin.search).and_then(|part| part.get(mode.origin.pair)).copied().flatten();
            let sign = if mode.origin.is_conjugate { -1.0 } else { 1.0 };
            mode.slopes.push(own.map(|slope| [slope.re, sign * slope.im]));
        }
        self.modes.parameters.push((name.to_owned(), value));
        Ok(())
    }

    /// The modes with the derivatives that were added.
    #[must_use]
    pub fn into_modes(self) -> Modes {
        self.modes
    }
}

impl EigenSpace {
    /// Yᴴ T(λ) X of a pencil, column by column.
    fn projected(&self, pencil: &Polynomial) -> Vec<c64> {
        let weights = pencil.weights(self.lambda);
        let products = self.right.iter().map(|x| pencil.combined(&weights, x));
        products.flat_map(|product| self.left.iter().map(move |y| inner(y, &product)).collect::<Vec<c64>>()).collect()
    }

    /// The derivatives by a parameter, the largest growth first; empty if there are none.
    fn derivatives(&self, columns: &[c64]) -> Result<Vec<c64>, StabilityError> {
        let k = self.pairs.len();
        let Some(weight) = self.weight.as_ref().filter(|_| columns.len() == k * k) else { return Ok(Vec::new()) };
        let slope = Mat::from_fn(k, k, |i, j| -columns[j * k + i]);
        let projected = weight.partial_piv_lu().solve(slope);
        let mut found = match k {
            1 => vec![projected[(0, 0)]],
            _ => projected.eigenvalues().map_err(|_| StabilityError::Eigenvalues { size: k })?,
        };
        found.sort_by(|a, b| b.re.total_cmp(&a.re));
        if self.is_real {
            for slope in &mut found {
                slope.im = 0.0;
            }
        }
        Ok(found)
    }
}

/// The eigenvalues of a search with their derivatives, by the derivative of its pencil.
#[cfg(test)]
pub(super) fn slopes_of(
    found: &FoundPairs,
    wanted: &Wanted,
    mut change: Polynomial,
) -> Result<Vec<(c64, Vec<c64>)>, StabilityError> {
    change.scale_with(found.pencil.scale.clone());
    let of = |space: EigenSpace| Ok((space.lambda, space.derivatives(&space.projected(&change))?));
    spaces(found, wanted)?.into_iter().map(of).collect()
}

/// yᴴ x.
fn inner(y: &[c64], x: &[c64]) -> c64 {
    y.iter().zip(x).map(|(y, x)| y.conj() * x).sum()
}

/// The eigenvalues of a search with all vectors of each. Those that differ by round-off are one.
fn spaces(found: &FoundPairs, wanted: &Wanted) -> Result<Vec<EigenSpace>, StabilityError> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let lambda = |pair: usize| found.pairs[pair].lambda;
    for pair in 0..found.pairs.len() {
        let near = (SAME * lambda(pair).norm()).max(APART * OFFSET * found.shift.norm());
        let is_same = |other: &usize| (lambda(*other) - lambda(pair)).norm() <= near;
        match groups.iter_mut().find(|group| group.iter().any(is_same)) {
            Some(group) => group.push(pair),
            None => groups.push(vec![pair]),
        }
    }
    let Some(first) = groups.first() else { return Ok(Vec::new()) };
    let pattern = Pattern::new(&found.pencil.at(lambda(first[0])))?;
    let made = groups.into_iter().map(|group| {
        wanted.go_on()?;
        space(found, &pattern, group)
    });
    Ok(made.collect::<Result<Vec<EigenSpace>, SolveError>>()?)
}

/// All vectors of an eigenvalue, by inverse iteration.
fn space(found: &FoundPairs, pattern: &Pattern, pairs: Vec<usize>) -> Result<EigenSpace, SolveError> {
    let (pencil, k) = (&found.pencil, pairs.len());
    let own = || pairs.iter().filter_map(|pair| found.pairs.get(*pair));
    let lambda = own().map(|pair| pair.lambda).sum::<c64>() / k as f64;
    let matrix = pencil.at(lambda + OFFSET * lambda.norm().max(found.shift.norm()));
    let pivots = Pivots::new(pattern, &matrix)?;
    let slope = pencil.slope_weights(lambda);
    let mut right: Vec<Vec<c64>> = own().map(|FoundPair { x, .. }| x.clone()).collect();
    let mut left: Vec<Vec<c64>> = (0..k).map(|number| beginning(pencil.size(), number)).collect();
    for _ in 0..ITERATIONS {
        right = right.iter().map(|x| pivots.solve(&pencil.combined(&slope, x))).collect();
        left = left.iter().map(|y| pivots.solve_adjoint(&pencil.combined_adjoint(&slope, y))).collect();
        orthonormalize(&mut right);
        orthonormalize(&mut left);
    }
    let (weight, size) = weighed(pencil, lambda, [&right, &left]);
    let is_real = k == 1 && pencil.is_real() && lambda.im.abs() <= 0.0;
    Ok(EigenSpace { lambda, pairs, right, left, weight, size, is_real })
}

/// Yᴴ T_λ X where X and Y are all vectors of an eigenvalue and it is not singular, and the size of the terms of Yᴴ T X.
fn weighed(pencil: &Polynomial, lambda: c64, [right, left]: [&[Vec<c64>]; 2]) -> (Option<Mat<c64>>, f64) {
    let (weights, slope) = (pencil.weights(lambda), pencil.slope_weights(lambda));
    let size = right.iter().map(|x| pencil.absolute(&weights, x)).fold(0.0, f64::max);
    let is_found = right.iter().all(|x| norm(&pencil.combined(&weights, x)) <= TRUE * size)
        && left.iter().all(|y| norm(&pencil.combined_adjoint(&weights, y)) <= TRUE * size);
    let k = right.len();
    let products: Vec<Vec<c64>> = right.iter().map(|x| pencil.combined(&slope, x)).collect();
    let weight = Mat::from_fn(k, k, |i, j| inner(&left[i], &products[j]));
    let largest = right.iter().map(|x| pencil.absolute(&slope, x)).fold(0.0, f64::max);
    let least = weight.singular_values().ok().and_then(|all| all.into_iter().reduce(f64::min)).unwrap_or(0.0);
    (Some(weight).filter(|_| is_found && least > DEFECTIVE * largest), size)
}

/// A vector with a part of each eigenvector, by a fixed sequence of numbers.
fn beginning(size: usize, number: usize) -> Vec<c64> {
    let mut seed = 0x9E37_79B9_7F4A_7C15u64 ^ number as u64;
    let mut next = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    (0..size).map(|_| c64::new(next(), next())).collect()
}

/// Makes vectors orthonormal, each against those before it, twice.
fn orthonormalize(vectors: &mut [Vec<c64>]) {
    for i in 0..vectors.len() {
        let (before, rest) = vectors.split_at_mut(i);
        let Some(own) = rest.first_mut() else { return };
        for _ in 0..2 {
            normalize(own);
            for other in before.iter() {
                let along = inner(other, own);
                own.iter_mut().zip(other).for_each(|(value, other)| *value -= along * other);
            }
        }
        normalize(own);
    }
}

fn normalize(vector: &mut [c64]) {
    let size = norm(vector);
    for value in vector {
        *value /= size;
    }
}
