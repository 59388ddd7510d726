//! Polynomials fitted to values at points, in the sense of least squares.

use crate::tensor::Point;

/// A column is dependent on those before it if less than this share of it is not theirs.
const DEPENDENT: f64 = 1e-7;

/// A polynomial fitted to values at points: the columns of its matrix, made orthonormal one after the other.
pub(super) struct Fit {
    /// Number of points.
    count: usize,
    origin: Point,
    /// Reciprocal lengths of the patch by direction: the matrix has no units.
    scale: Point,
    exponents: Vec<[i32; 3]>,
    /// By column that does not depend on those before it: its number, itself, and its parts along the columns before
    /// and itself.
    columns: Vec<(usize, Vec<f64>, Vec<f64>)>,
}

impl Fit {
    /// A fit of all polynomials of a degree; columns that depend on those before them are left out, and the result says
    /// whether there are none.
    pub fn new(dim: usize, degree: usize, origin: &Point, points: &[Point]) -> (Fit, bool) {
        let extent = |d: usize| points.iter().fold(0.0f64, |most, p| most.max((p[d] - origin[d]).abs()));
        let scale = std::array::from_fn(|d| Some(extent(d)).filter(|e| *e > 0.0).map_or(1.0, f64::recip));
        let (count, exponents) = (points.len(), exponents(dim, degree));
        let mut fit = Fit { count, origin: *origin, scale, exponents, columns: Vec::new() };
        let rows: Vec<Vec<f64>> = points.iter().map(|x| fit.monomials(x)).collect();
        for m in 0..fit.exponents.len() {
            let mut column: Vec<f64> = rows.iter().map(|row| row[m]).collect();
            let whole = norm(&column);
            let mut parts = vec![0.0; fit.columns.len()];
            // Twice is enough (Kahan, Parlett).
            for _ in 0..2 {
                for (part, (_, other, _)) in parts.iter_mut().zip(&fit.columns) {
                    let along: f64 = column.iter().zip(other).map(|(a, b)| a * b).sum();
                    *part += along;
                    column.iter_mut().zip(other).for_each(|(a, b)| *a -= along * b);
                }
            }
            let rest = norm(&column);
            if rest > DEPENDENT * whole {
                for a in &mut column {
                    *a /= rest;
                }
                parts.push(rest);
                fit.columns.push((m, column, parts));
            }
        }
        let is_determined = fit.columns.len() == fit.exponents.len();
        (fit, is_determined)
    }

    fn monomials(&self, x: &Point) -> Vec<f64> {
        let y: Point = std::array::from_fn(|d| (x[d] - self.origin[d]) * self.scale[d]);
        self.exponents.iter().map(|e| (0..3).map(|d| y[d].powi(e[d])).product()).collect()
    }

    /// Weights of the points in the value of the polynomial at a point: with the columns QR they are Q R⁻ᵀ p(x).
    pub fn weights(&self, x: &Point) -> Vec<f64> {
        let p = self.monomials(x);
        let mut solved: Vec<f64> = Vec::new();
        let mut weights = vec![0.0; self.count];
        for (m, column, parts) in &self.columns {
            let known: f64 = parts.iter().zip(&solved).map(|(part, s)| part * s).sum();
            let s = (p[*m] - known) / parts.last().copied().unwrap_or(1.0);
            weights.iter_mut().zip(column).for_each(|(w, q)| *w += s * q);
            solved.push(s);
        }
        weights
    }
}

/// Exponents of the monomials up to a degree, the lower degrees first.
fn exponents(dim: usize, degree: usize) -> Vec<[i32; 3]> {
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
