//! Anderson's mixing of the iterates of a fixed-point iteration.

use crate::linalg::dot;

/// Number of earlier iterates used.
const MEMORY: usize = 6;
/// Fraction of a vector that must remain after orthogonalization against the earlier ones.
const INDEPENDENT: f64 = 1e-8;

/// Speeds up an iteration x ← g(x): the next argument is the combination of the last values g at which the combined
/// residual g − x is least (Anderson, J. ACM 12 (1965) 547; in the form of Walker and Ni, SIAM J. Numer. Anal. 49
/// (2011) 1715). On a linear problem it is equivalent to GMRES.
#[derive(Default)]
pub(crate) struct Mixing {
    last: Option<[Vec<f64>; 2]>,
    /// Changes of the value and of the residual, an orthonormal basis of the latter, newest last.
    values: Vec<Vec<f64>>,
    residuals: Vec<Vec<f64>>,
}

impl Mixing {
    /// The next argument after g(`from`) = `value`.
    pub fn next(&mut self, from: &[f64], value: &[f64]) -> Vec<f64> {
        let residual: Vec<f64> = value.iter().zip(from).map(|(value, from)| value - from).collect();
        if let Some([old_value, old_residual]) = &self.last {
            let minus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
            self.values.push(minus(value, old_value));
            self.residuals.push(minus(&residual, old_residual));
            if self.values.len() > MEMORY {
                self.values.remove(0);
                self.residuals.remove(0);
            }
        }
        let mut next = value.to_vec();
        // Gram–Schmidt from the newest change to the oldest; the values are combined in the same way.
        let mut basis: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        let mut left = residual.clone();
        for (change, of_value) in self.residuals.iter().zip(&self.values).rev() {
            let (mut direction, mut step) = (change.clone(), of_value.clone());
            let size = dot(change, change).sqrt();
            for (other, other_step) in &basis {
                let share = dot(&direction, other);
                direction.iter_mut().zip(other).for_each(|(d, o)| *d -= share * o);
                step.iter_mut().zip(other_step).for_each(|(d, o)| *d -= share * o);
            }
            let length = dot(&direction, &direction).sqrt();
            if length <= INDEPENDENT * size || length.is_nan() {
                break;
            }
            direction.iter_mut().chain(&mut step).for_each(|entry| *entry /= length);
            let share = dot(&left, &direction);
            left.iter_mut().zip(&direction).for_each(|(l, d)| *l -= share * d);
            next.iter_mut().zip(&step).for_each(|(n, s)| *n -= share * s);
            basis.push((direction, step));
        }
        self.last = Some([value.to_vec(), residual]);
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x ← Mx + b in four dimensions, with M not symmetric: after four changes, one per dimension, the residual is
    /// round-off, as that of GMRES.
    #[test]
    fn a_linear_iteration_ends_after_as_many_passes_as_unknowns() {
        let m = [[0.5, -0.4, 0.1, 0.0], [0.3, 0.6, 0.0, -0.2], [0.0, 0.2, -0.7, 0.3], [0.1, 0.0, 0.5, 0.4]];
        let b = [1.0, -2.0, 0.5, 3.0];
        let g = |x: &[f64]| -> Vec<f64> { m.iter().zip(&b).map(|(row, b)| dot(row, x) + b).collect() };
        let (mut mixing, mut x) = (Mixing::default(), vec![0.0; 4]);
        for _ in 0..5 {
            let value = g(&x);
            x = mixing.next(&x, &value);
        }
        let residual = g(&x).iter().zip(&x).map(|(g, x)| (g - x).abs()).fold(0.0, f64::max);
        assert!(residual < 1e-13, "{residual}");
    }
}
