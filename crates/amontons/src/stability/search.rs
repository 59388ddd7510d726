//! The search for all eigenvalues of a region: a Krylov space that grows until it has them, and the count.

use faer::c64;

use super::count::{EigenvalueCount, count};
use super::krylov::{KrylovSpace, RitzPair};
use super::polynomial::Polynomial;
use super::{Coverage, ModeKind, ModeRegion, StabilityError, Wanted};
use crate::linalg::{Pattern, Pivots};
use crate::machine;

/// Part of the memory of the machine that the vectors of the space may take.
const MEMORY: f64 = 0.25;
/// Imaginary part of an eigenvalue, relative to its size, that is the round-off of a real one.
const REAL: f64 = 1e-9;

/// Distance of an eigenvalue to the shift over that of the nearest one above which it may be an infinite one, and the
/// residual that tells a finite one.
const FAR: f64 = 1e4;
const TRUE: f64 = 1e-6;

/// Imaginary part of an eigenvalue, relative to its size, up to which it may be one of relaxation that is not yet
/// found.
const NEARLY_REAL: f64 = 1e-2;

/// True for an eigenvalue of relaxation: branches have one of each unknown, on the real axis between −1/τ and 0, and
/// they gather there, so that a search would never end with them.
fn relaxes(pencil: &Polynomial, lambda: c64) -> bool {
    let fastest = pencil.rates.iter().copied().fold(0.0, f64::max);
    lambda.im.abs() <= NEARLY_REAL * lambda.norm() && lambda.re < 0.0 && lambda.re >= -(1.0 + NEARLY_REAL) * fastest
}

/// An eigenvalue with its vector; of conjugates that both are eigenvalues the one of positive frequency.
pub(super) struct FoundPair {
    pub lambda: c64,
    pub x: Vec<c64>,
    pub residual: f64,
}

/// What was found.
pub(super) struct FoundPairs {
    pub pencil: Polynomial,
    /// The shift about which they were found.
    pub shift: c64,
    pub pairs: Vec<FoundPair>,
    pub region: ModeRegion,
    pub missing: isize,
    pub factorizations: usize,
    pub dimension: usize,
}

/// The eigenvalues that the space has found up to the first that it has not, by distance to the shift.
struct KnownEigenvalues {
    coverage: Coverage,
    ritz: Vec<RitzPair>,
    /// Distance within which all of the space are found.
    radius: f64,
}

impl KnownEigenvalues {
    fn new(space: &KrylovSpace, shift: c64, coverage: Coverage) -> Result<KnownEigenvalues, StabilityError> {
        let mut ritz = space.ritz()?;
        // Infinite eigenvalues, of unknowns without mass, are found as large numbers of no meaning.
        let nearest = ritz.first().map_or(0.0, |first| (first.lambda - shift).norm());
        ritz.retain(|ritz| {
            let is_far = (ritz.lambda - shift).norm() > FAR * nearest;
            !(is_far && ritz.is_found()) || space.polynomial().residual(ritz.lambda, &space.vector(ritz)) < TRUE
        });
        ritz.retain(|ritz| !relaxes(space.polynomial(), ritz.lambda));
        let found = ritz.iter().position(|ritz| !ritz.is_found()).unwrap_or(ritz.len());
        let radius = match ritz.get(found) {
            Some(next) => (next.lambda - shift).norm(),
            None if space.is_exhausted() => f64::INFINITY,
            None => ritz.last().map_or(0.0, |last| (last.lambda - shift).norm()),
        };
        ritz.truncate(found);
        Ok(KnownEigenvalues { coverage, ritz, radius })
    }

    /// The eigenvalues that are covered: of conjugates that both are eigenvalues the one of non-negative frequency.
    /// Those that are real up to round-off are made so.
    fn covered(&self) -> impl Iterator<Item = (c64, &RitzPair)> {
        self.ritz.iter().filter_map(|ritz| {
            let lambda = ritz.lambda;
            let is_real = lambda.im.abs() <= REAL * lambda.norm();
            let lambda = if is_real { c64::new(lambda.re, 0.0) } else { lambda };
            (lambda.im >= 0.0 || self.coverage == Coverage::Both).then_some((lambda, ritz))
        })
    }

    /// All that are known, with their conjugates where these are eigenvalues.
    fn both(&self) -> Vec<c64> {
        let folded = self.coverage == Coverage::Folded;
        let covered = self.covered().map(|(lambda, _)| lambda);
        covered.flat_map(|l| [l].into_iter().chain((folded && l.im > 0.0).then(|| l.conj()))).collect()
    }
}

/// The region of the wanted number of modes, if the space has them all and those next to them: to the middle between
/// the last one and the next.
fn region_of(
    known: &KnownEigenvalues,
    wanted: &Wanted,
    (shift, relaxing): (c64, bool),
    all: bool,
) -> Option<ModeRegion> {
    let mut upper: Vec<c64> = known.covered().map(|(lambda, _)| c64::new(lambda.re, lambda.im.abs())).collect();
    if relaxing {
        upper.retain(|lambda| lambda.im > 0.0);
    }
    let (count, thermal) = (wanted.count, wanted.kind == ModeKind::Thermal);
    if thermal {
        upper.sort_by(|a, b| b.re.total_cmp(&a.re));
    } else {
        upper.sort_by(|a, b| a.im.total_cmp(&b.im));
    }
    let key = |lambda: &c64| if thermal { -lambda.re } else { lambda.im };
    let last = key(upper.get(count.checked_sub(1)?)?);
    // A pair that nearly meets, as at the onset of squeal, is not parted.
    let size = upper.iter().take(count).map(|l| l.norm()).fold(0.0, f64::max);
    let next = upper.iter().skip(count).map(key).find(|next| next - last > 1e-3 * size);
    let next = match next {
        Some(next) => next,
        None if all => last + size,
        None => return None,
    };
    let edge = 0.5 * (last + next);
    if thermal {
        let reach = (shift.re + edge).max(size);
        let most = upper.iter().filter(|l| -l.re <= edge).map(|l| l.im).fold(0.0, f64::max);
        return Some(ModeRegion { growth: [-edge, shift.re + reach], frequency: [0.0, (2.0 * most).max(reach)] });
    }
    let most = upper.iter().filter(|l| l.im <= edge).map(|l| l.re.abs()).fold(0.0, f64::max);
    let most = (2.0 * most).max(0.5 * edge);
    // The real axis has the poles of the branches.
    let least = if relaxing { 0.5 * upper.first().map_or(0.0, |lambda| lambda.im) } else { 0.0 };
    Some(ModeRegion { growth: [-most, most], frequency: [least, edge] })
}

/// Where the search begins: on the real axis, at the growth of the region or at a slow rate of the body, or within a
/// region away from the axis.
fn shift(wanted: &Wanted, slow: f64) -> c64 {
    match wanted.region {
        None => c64::new(0.5 * slow, 0.0),
        Some(ModeRegion { growth, frequency }) => {
            let [middle, height] = [growth, frequency].map(|[from, to]| 0.5 * (from + to));
            // Off the middle, where a mode of no growth might lie; to the right, where the body has no eigenvalues.
            if frequency[0] > 0.0 {
                c64::new(middle + 0.0371 * (growth[1] - growth[0]), height)
            } else {
                c64::new(middle + 0.25 * frequency[1].max(growth[1] - growth[0]), 0.0)
            }
        }
    }
}

/// Shifts at which faster growth is looked for than that of slow motions, each so many times the one before, the
/// dimension of their spaces, and what a shift exceeds the fastest growth by.
const PROBES: i32 = 4;
const WIDER: f64 = 8.0;
const PROBED: usize = 20;
const BEYOND: f64 = 1.25;

/// A shift to the right of the eigenvalues of hot spots that shifts further to the right find first: modes are wanted
/// by growth, and the nearest ones are found.
fn right_of_growth(pencil: &Polynomial, pattern: &Pattern, wanted: &Wanted, shift: c64) -> Result<c64, StabilityError> {
    let mut fastest = shift.re / BEYOND;
    for power in 1..=PROBES {
        let probe = c64::new(shift.re * WIDER.powi(power), 0.0);
        let matrix = pencil.at(probe);
        let pivots = Pivots::new(pattern, &matrix)?;
        let mut space = KrylovSpace::new(pencil, &pivots, probe);
        space.extend(PROBED, wanted)?;
        let found = space.ritz()?;
        let faster = found.iter().filter(|ritz| ritz.error <= TRUE && ritz.lambda.re > fastest);
        let is_true = |ritz: &&RitzPair| pencil.residual(ritz.lambda, &space.vector(ritz)) < TRUE;
        fastest = faster.filter(is_true).map(|ritz| ritz.lambda.re).fold(fastest, f64::max);
    }
    Ok(c64::new(BEYOND * fastest, 0.0))
}

/// Finds the eigenpairs.
pub(super) fn find(
    mut pencil: Polynomial,
    wanted: &Wanted,
    coverage: Coverage,
    dim: usize,
) -> Result<FoundPairs, StabilityError> {
    let mut shift = shift(wanted, pencil.slow_rate(dim));
    pencil.balance(shift.norm());
    let pattern = Pattern::new(&pencil.at(shift))?;
    let mut factorizations = 1;
    if wanted.kind == ModeKind::Thermal && wanted.region.is_none() {
        shift = right_of_growth(&pencil, &pattern, wanted, shift)?;
        factorizations += PROBES as usize;
    }
    let matrix = pencil.at(shift);
    let pivots = Pivots::new(&pattern, &matrix)?;
    let mut space = KrylovSpace::new(&pencil, &pivots, shift);
    let memory = machine::physical_memory().map_or(f64::INFINITY, |memory| MEMORY * memory.bytes);
    let most = ((memory / space.bytes() as f64) as usize).max(64);
    let mut by = 2 * wanted.count + 20;
    loop {
        space.extend(by, wanted)?;
        by = (space.dimension() / 4).max(10);
        let known = KnownEigenvalues::new(&space, shift, coverage)?;
        let is_last = space.is_exhausted() || space.dimension() >= most;
        let region = match wanted.region {
            Some(region) => Some(region),
            None => region_of(&known, wanted, (shift, !pencil.rates.is_empty()), space.is_exhausted()),
        };
        let Some(region) = region.filter(|region| region.farthest(shift) <= known.radius || is_last) else {
            if is_last {
                return Err(StabilityError::TooFew { found: known.covered().count(), count: wanted.count });
            }
            continue;
        };
        let EigenvalueCount { missing, factorizations: made } =
            count(&pencil, &pattern, (&region, coverage, wanted), &known.both())?;
        factorizations += made;
        if missing != 0 && !is_last {
            continue;
        }
        let inside = known.covered().filter(|(lambda, _)| region.has([lambda.re, lambda.im]));
        let pairs = inside.map(|(lambda, ritz)| {
            let x = space.vector(ritz);
            FoundPair { lambda, residual: pencil.residual(lambda, &x), x }
        });
        let (pairs, dimension) = (pairs.collect(), space.dimension());
        return Ok(FoundPairs { pencil, shift, pairs, region, missing, factorizations, dimension });
    }
}
