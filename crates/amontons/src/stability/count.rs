//! The number of eigenvalues in a region, by the argument principle: the change of the angle of det T(λ) around it.
//!
//! What is known is divided out: f(λ) = det T(λ)/(exp p(λ) Π(λ − λ_j)) over the eigenvalues that were found, with a
//! polynomial p that stands for the many eigenvalues far away, fitted to the size of det T on the boundary; exp p has
//! no zeros. The angle of f changes little along the boundary, unless an eigenvalue is missing near it, and its change
//! around the region is 2π times the number of those that are missing inside. Where T is real, the upper half of a
//! region that reaches the real axis is enough. Each point costs one factorization of T(λ).

use std::f64::consts::{FRAC_PI_4, PI, TAU};
use std::sync::atomic::{AtomicUsize, Ordering};

use faer::linalg::solvers::SolveLstsq;
use faer::{Mat, c64};
use rayon::prelude::*;

use super::polynomial::Polynomial;
use super::{Coverage, ModeRegion, StabilityError, Wanted};
use crate::linalg::{Pattern, Pivots, SolveError};

/// Pieces of each edge to begin with, and the degree of the polynomial.
const PIECES: usize = 8;
const DEGREE: usize = 9;
/// Halvings of a piece: eigenvalues nearer to the boundary than this leaves are on it.
const HALVINGS: usize = 24;
/// Logarithm of the size of f up to which the pieces are short enough: where f varies by more, its angle might turn
/// unseen between two points.
const FITS: f64 = 0.5;
/// Difference of two ways to one angle, which else is a whole turn.
const SAME: f64 = 0.1;
/// Difference of a number of turns to the nearest integer that is round-off.
const WHOLE: f64 = 1e-3;

/// The count, and its cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct EigenvalueCount {
    /// Eigenvalues inside beyond those that are known.
    pub missing: isize,
    pub factorizations: usize,
}

/// A point with the angle of f there.
type Placed = (c64, f64);

/// A polynomial in (λ − c)/r, with real coefficients where T is real.
#[derive(Default)]
struct Far {
    centre: f64,
    radius: f64,
    coefficients: Vec<c64>,
}

impl Far {
    /// The polynomial whose real part is nearest to values at some points.
    fn fitted(region: &ModeRegion, values: &[(c64, f64)], is_real: bool) -> Far {
        let centre = 0.5 * (region.growth[0] + region.growth[1]);
        let mut far = Far { centre, radius: region.farthest(c64::new(centre, 0.0)), coefficients: Vec::new() };
        let powers: Vec<Vec<c64>> = values.iter().map(|(at, _)| far.powers(*at)).collect();
        // The real parts, then the imaginary parts from the first power on.
        let columns = if is_real { DEGREE + 1 } else { 2 * DEGREE + 1 };
        let entry = |i: usize, k: usize| if k <= DEGREE { powers[i][k].re } else { -powers[i][k - DEGREE].im };
        let matrix = Mat::from_fn(values.len(), columns, entry);
        let right = Mat::from_fn(values.len(), 1, |i, _| values[i].1);
        let solved = matrix.qr().solve_lstsq(&right);
        let imaginary = |k: usize| if is_real || k == 0 { 0.0 } else { solved[(DEGREE + k, 0)] };
        far.coefficients = (0..=DEGREE).map(|k| c64::new(solved[(k, 0)], imaginary(k))).collect();
        far
    }

    fn powers(&self, at: c64) -> Vec<c64> {
        let z = (at - self.centre) / self.radius;
        std::iter::successors(Some(c64::new(1.0, 0.0)), |power| Some(power * z)).take(DEGREE + 1).collect()
    }

    /// Re p, the logarithm of the size of exp p.
    fn size(&self, at: c64) -> f64 {
        self.at(at).re
    }

    /// Im p, the angle of exp p.
    fn angle(&self, at: c64) -> f64 {
        self.at(at).im
    }

    fn at(&self, at: c64) -> c64 {
        self.powers(at).iter().zip(&self.coefficients).map(|(power, factor)| power * factor).sum()
    }
}

/// The angle of f, on demand.
struct Angles<'a> {
    polynomial: &'a Polynomial,
    pattern: &'a Pattern,
    known: &'a [c64],
    wanted: &'a Wanted<'a>,
    far: Far,
    made: AtomicUsize,
}

impl Angles<'_> {
    /// Angle and logarithm of the size of det T(λ)/Π(λ − λ_j), over what branches make of it.
    fn near(&self, lambda: c64) -> Result<[f64; 2], SolveError> {
        self.wanted.go_on()?;
        self.made.fetch_add(1, Ordering::Relaxed);
        let matrix = self.polynomial.at(lambda);
        let (angle, size) = Pivots::new(self.pattern, &matrix)?.determinant();
        let ([turned, grown], known) = (self.polynomial.relaxation(lambda), || self.known.iter().map(|l| lambda - l));
        let (angle, size) = (angle - turned, size - grown);
        Ok([angle - known().map(c64::arg).sum::<f64>(), size - known().map(|l| l.norm().ln()).sum::<f64>()])
    }

    /// The angle of f.
    fn at(&self, lambda: c64) -> Result<f64, SolveError> {
        Ok(self.near(lambda)?[0] - self.far.angle(lambda))
    }

    /// The change of the angle between two points with these angles, by halving until it is small and the halves agree.
    fn change(&self, from: Placed, to: Placed, left: usize) -> Result<f64, StabilityError> {
        if left == 0 {
            return Err(StabilityError::OnBoundary { at: [from.0.re, from.0.im] });
        }
        let middle = 0.5 * (from.0 + to.0);
        let middle = (middle, self.at(middle)?);
        let whole = wrapped(to.1 - from.1);
        let halves = [wrapped(middle.1 - from.1), wrapped(to.1 - middle.1)];
        if (halves[0] + halves[1] - whole).abs() < SAME && halves.iter().all(|half| half.abs() < FRAC_PI_4) {
            return Ok(whole);
        }
        Ok(self.change(from, middle, left - 1)? + self.change(middle, to, left - 1)?)
    }
}

/// An angle in (−π, π].
fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// Counts the eigenvalues in a region beyond the known ones, which are those of both halves of the plane unless only
/// its upper half is covered.
///
/// # Errors
/// If an eigenvalue is on the boundary, or T is singular there.
pub(super) fn count(
    polynomial: &Polynomial,
    pattern: &Pattern,
    (region, coverage, wanted): (&ModeRegion, Coverage, &Wanted),
    known: &[c64],
) -> Result<EigenvalueCount, StabilityError> {
    let mut sum = EigenvalueCount { missing: 0, factorizations: 0 };
    for path in region.paths(coverage) {
        let angles = Angles { polynomial, pattern, known, wanted, far: Far::default(), made: AtomicUsize::new(0) };
        let counted = angles.around(&path, region)?;
        sum.missing += counted.missing;
        sum.factorizations += counted.factorizations;
    }
    Ok(sum)
}

impl Angles<'_> {
    /// Counts the eigenvalues within a path that is closed, or that begins and ends on the real axis where T is real.
    fn around(mut self, corners: &[c64], region: &ModeRegion) -> Result<EigenvalueCount, StabilityError> {
        let angles = &mut self;
        let is_closed = corners.first() == corners.last();
        let mut at: Vec<Placed> = Vec::new();
        for pieces in [PIECES, 2 * PIECES, 4 * PIECES] {
            let mut places = Vec::new();
            for edge in corners.windows(2) {
                places.extend((0..pieces).map(|piece| edge[0] + (edge[1] - edge[0]) * (piece as f64 / pieces as f64)));
            }
            places.extend(corners.last());
            let near = places.par_iter().map(|at| angles.near(*at)).collect::<Result<Vec<_>, SolveError>>()?;
            let sizes: Vec<(c64, f64)> = places.iter().zip(&near).map(|(at, [_, size])| (*at, *size)).collect();
            angles.far = Far::fitted(region, &sizes, angles.polynomial.is_real());
            at = places.iter().zip(&near).map(|(at, [angle, _])| (*at, angle - angles.far.angle(*at))).collect();
            if sizes.iter().all(|(at, size)| (size - angles.far.size(*at)).abs() < FITS) {
                break;
            }
        }
        // Pieces do not depend on each other, and their sum is taken in order.
        let pieces: Vec<[Placed; 2]> = at.windows(2).map(|piece| [piece[0], piece[1]]).collect();
        let change = |piece: &[Placed; 2]| angles.change(piece[0], piece[1], HALVINGS);
        let sum: f64 = pieces.par_iter().map(change).collect::<Result<Vec<f64>, _>>()?.into_iter().sum();
        // Half of the way around a region on the real axis.
        let turns = if is_closed { sum / TAU } else { sum / PI };
        if (turns - turns.round()).abs() > WHOLE {
            return Err(StabilityError::OnBoundary { at: [region.growth[0], 0.0] });
        }
        Ok(EigenvalueCount { missing: turns.round() as isize, factorizations: self.made.into_inner() })
    }
}
