//! Polynomials fitted to values at points, in the sense of least squares.

use crate::tensor::Point;

/// A column depends on earlier ones if its independent part is below this fraction of its norm.
const DEPENDENT: f64 = 1e-7;

/// A polynomial fitted to values at points: the columns of its matrix, orthonormalized one after the other.
pub(super) struct Fit<'e> {
    /// Number of points.
    count: usize,
    local: PatchAxes,
    exponents: &'e [[i32; 3]],
    /// The columns that do not depend on earlier ones: their numbers, the columns one after the other, and the
    /// components of each along the earlier ones and itself (R by columns).
    independent: Vec<usize>,
    columns: Vec<f64>,
    parts: Vec<f64>,
}

/// The coordinates of a patch.
#[derive(Clone, Copy)]
struct PatchAxes {
    origin: Point,
    /// Reciprocal size of the patch by direction, which makes the matrix dimensionless.
    scale: Point,
}

impl PatchAxes {
    fn of(&self, x: &Point) -> Point {
        std::array::from_fn(|d| (x[d] - self.origin[d]) * self.scale[d])
    }
}

impl<'e> Fit<'e> {
    /// Fits all polynomials with these [`exponents`]. Columns that depend on earlier ones are left out; the result is
    /// true if none was.
    pub fn new(exponents: &'e [[i32; 3]], origin: &Point, points: &[Point]) -> (Fit<'e>, bool) {
        let extent = |d: usize| points.iter().fold(0.0f64, |most, p| most.max((p[d] - origin[d]).abs()));
        let scale = std::array::from_fn(|d| Some(extent(d)).filter(|e| *e > 0.0).map_or(1.0, f64::recip));
        let (local, count, all) = (PatchAxes { origin: *origin, scale }, points.len(), exponents.len());
        let mut fit = Fit {
            count,
            local,
            exponents,
            independent: Vec::with_capacity(all),
            columns: Vec::with_capacity(all * count),
            parts: Vec::with_capacity(all * (all + 1) / 2),
        };
        for m in 0..all {
            let done = fit.columns.len();
            fit.columns.extend(points.iter().map(|x| monomial(&exponents[m], &local.of(x))));
            let (before, column) = fit.columns.split_at_mut(done);
            let whole = norm(column);
            let first = fit.parts.len();
            fit.parts.resize(first + fit.independent.len(), 0.0);
            // Two passes of orthogonalization are enough (Kahan, Parlett).
            for _ in 0..2 {
                for (part, other) in fit.parts[first..].iter_mut().zip(before.chunks_exact(count.max(1))) {
                    let along: f64 = column.iter().zip(other).map(|(a, b)| a * b).sum();
                    *part += along;
                    column.iter_mut().zip(other).for_each(|(a, b)| *a -= along * b);
                }
            }
            let rest = norm(column);
            if rest > DEPENDENT * whole {
                for a in column {
                    *a /= rest;
                }
                fit.parts.push(rest);
                fit.independent.push(m);
            } else {
                fit.columns.truncate(done);
                fit.parts.truncate(first);
            }
        }
        let is_determined = fit.independent.len() == all;
        (fit, is_determined)
    }

    /// Weights of the points in the value of the polynomial at `x`: Q R⁻ᵀ p(x) for columns QR.
    pub fn weights(&self, x: &Point) -> Vec<f64> {
        self.bounded_weights(x, &[])
    }

    /// Such weights for the highest degree whose sum of magnitudes is at most `most[degree]`, if `most` has that
    /// entry. Larger sums would make the value a difference of much larger ones. Degree 0 is always allowed; its
    /// weights are all equal.
    pub fn bounded_weights(&self, x: &Point, most: &[f64]) -> Vec<f64> {
        let y = self.local.of(x);
        let degree = |m: usize| self.exponents[m].iter().sum::<i32>();
        let mut solved: Vec<f64> = Vec::with_capacity(self.independent.len());
        let mut weights = vec![0.0; self.count];
        let mut bounded = weights.clone();
        let mut rest = &self.parts[..];
        let columns = self.columns.chunks_exact(self.count.max(1));
        for (place, (&m, column)) in self.independent.iter().zip(columns).enumerate() {
            let (parts, others) = rest.split_at(solved.len() + 1);
            let known: f64 = parts.iter().zip(&solved).map(|(part, s)| part * s).sum();
            let s = (monomial(&self.exponents[m], &y) - known) / parts[solved.len()];
            weights.iter_mut().zip(column).for_each(|(w, q)| *w += s * q);
            solved.push(s);
            rest = others;
            // Columns of one degree are adjacent, lower degrees first.
            let is_last = self.independent.get(place + 1).is_none_or(|&next| degree(next) > degree(m));
            let sum = || weights.iter().map(|w| w.abs()).sum::<f64>();
            let is_bounded = || most.get(degree(m) as usize).is_none_or(|most| sum() <= *most);
            if is_last && (degree(m) == 0 || is_bounded()) {
                bounded.copy_from_slice(&weights);
            }
        }
        bounded
    }
}

fn monomial(exponents: &[i32; 3], y: &Point) -> f64 {
    (0..3).map(|d| y[d].powi(exponents[d])).product()
}

/// Exponents of the monomials up to a degree, the lower degrees first.
pub(super) fn exponents(dim: usize, degree: usize) -> Vec<[i32; 3]> {
    let most = |d: usize| if d < dim { degree as i32 } else { 0 };
    let mut all: Vec<[i32; 3]> = (0..=most(0))
        .flat_map(|a| (0..=most(1)).flat_map(move |b| (0..=most(2)).map(move |c| [a, b, c])))
        .filter(|e| e.iter().sum::<i32>() <= degree as i32)
        .collect();
    all.sort_by_key(|e| e.iter().sum::<i32>());
    all
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
