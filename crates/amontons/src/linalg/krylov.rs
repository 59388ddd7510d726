//! Krylov methods, which need only products with the matrix: GMRES and conjugate gradients.

use rayon::prelude::*;

use super::vectors::{add_combination, copy, dot, map, orthogonalize, zeros};

/// Result of GMRES.
#[derive(Clone, Debug, PartialEq)]
pub struct Krylov {
    /// The solution found.
    pub x: Vec<f64>,
    /// Components of the solution along the vectors to which the product was applied, in their order.
    pub components: Vec<f64>,
    /// Number of products.
    pub iterations: usize,
    /// Relative residual ‖b − A x‖ / ‖b‖ of the recurrence.
    pub residual: f64,
}

/// Solves A x = b by the generalized minimal residual method without restart (Saad and Schultz, 1986): `apply` is the
/// product with A. Ends when the residual is `tolerance` times that of x = 0 or after `limit` products; the caller
/// looks at [`Krylov::residual`]. Sums are taken in a fixed order, so the bits do not depend on the number of threads.
///
/// # Errors
/// When a product cannot be computed.
pub fn gmres<E>(
    mut apply: impl FnMut(&[f64]) -> Result<Vec<f64>, E>,
    b: &[f64],
    tolerance: f64,
    limit: usize,
) -> Result<Krylov, E> {
    let norm = dot(b, b).sqrt();
    if norm == 0.0 || !norm.is_finite() {
        let residual = if norm == 0.0 { 0.0 } else { norm };
        return Ok(Krylov { x: zeros(b.len()), components: Vec::new(), iterations: 0, residual });
    }
    let mut basis = vec![map([b], |[b]| b / norm)];
    // The triangular factor of the Hessenberg matrix by columns, its rotations, and the rotated right-hand side.
    let (mut columns, mut rotations, mut rotated): (Vec<Vec<f64>>, Vec<(f64, f64)>, Vec<f64>) =
        (Vec::new(), Vec::new(), vec![norm]);
    while columns.len() < limit {
        let k = columns.len();
        let mut next = apply(&basis[k])?;
        let mut column = orthogonalize(&mut next, &basis, &basis);
        let length = dot(&next, &next).sqrt();
        for (i, &(c, s)) in rotations.iter().enumerate() {
            (column[i], column[i + 1]) = (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let radius = column[k].hypot(length);
        if radius == 0.0 || !radius.is_finite() {
            break;
        }
        let (c, s) = (column[k] / radius, length / radius);
        column[k] = radius;
        columns.push(column);
        rotations.push((c, s));
        let last = rotated[k];
        rotated[k] = c * last;
        rotated.push(-s * last);
        if rotated[k + 1].abs() <= tolerance * norm || length == 0.0 {
            break;
        }
        next.par_iter_mut().for_each(|next| *next /= length);
        basis.push(next);
    }
    let size = columns.len();
    let mut y = rotated[..size].to_vec();
    for i in (0..size).rev() {
        y[i] /= columns[i][i];
        let yi = y[i];
        for j in 0..i {
            y[j] -= columns[i][j] * yi;
        }
    }
    let mut x = zeros(b.len());
    add_combination(&mut x, &y, &basis);
    Ok(Krylov { x, components: y, iterations: size, residual: rotated[size].abs() / norm })
}

/// Definiteness of a matrix observed by conjugate gradients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Definite {
    /// All energies were positive.
    Seen,
    /// An energy was not positive: the matrix, or the preconditioner, is not positive definite.
    No,
}

/// Result of conjugate gradients.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradients {
    /// The solution found.
    pub x: Vec<f64>,
    /// Number of products.
    pub iterations: usize,
    /// Relative residual ‖b − A x‖ / ‖b‖ of the recurrence.
    pub residual: f64,
    /// Definiteness observed: `No` if an energy was not positive.
    pub definite: Definite,
}

/// Solves A x = b, A symmetric positive definite, by conjugate gradients with a preconditioner that may vary a little
/// from product to product, as one in lower precision does (Notay, SIAM J. Sci. Comput. 22 (2000) 1444). Ends when the
/// `norm` of the residual is `tolerance` times that of x = 0, after `limit` products, or at an energy that is not
/// positive.
///
/// # Errors
/// When a product cannot be computed.
pub fn conjugate_gradients<E>(
    mut apply: impl FnMut(&[f64]) -> Result<Vec<f64>, E>,
    mut precondition: impl FnMut(&[f64]) -> Vec<f64>,
    b: &[f64],
    norm: impl Fn(&[f64]) -> f64,
    tolerance: f64,
    limit: usize,
) -> Result<Gradients, E> {
    let whole = norm(b);
    let mut made = Gradients { x: zeros(b.len()), iterations: 0, residual: 1.0, definite: Definite::Seen };
    if whole == 0.0 || !whole.is_finite() {
        made.residual = if whole == 0.0 { 0.0 } else { whole };
        return Ok(made);
    }
    let mut rest = copy(b);
    let mut direction = precondition(&rest);
    let mut merit = dot(&rest, &direction);
    while made.iterations < limit {
        let image = apply(&direction)?;
        let energy = dot(&direction, &image);
        if energy.is_nan() || merit.is_nan() || energy <= 0.0 || merit <= 0.0 {
            made.definite = Definite::No;
            break;
        }
        made.iterations += 1;
        let alpha = merit / energy;
        made.x.par_iter_mut().zip(&direction).for_each(|(x, d)| *x += alpha * d);
        rest.par_iter_mut().zip(&image).for_each(|(r, image)| *r -= alpha * image);
        made.residual = norm(&rest) / whole;
        if made.residual <= tolerance {
            break;
        }
        let next = precondition(&rest);
        // (r − r_before)·z, z the preconditioned residual: r has changed by −α A d.
        let beta = -alpha * dot(&image, &next) / merit;
        direction.par_iter_mut().zip(&next).for_each(|(d, next)| *d = next + beta * *d);
        merit = dot(&rest, &next);
    }
    Ok(made)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// The matrix is neither symmetric nor definite; its solution is known.
    #[test]
    fn a_system_of_n_unknowns_takes_at_most_n_products() {
        let n = 30;
        let entry = |i: usize, j: usize| {
            if i == j { if i.is_multiple_of(2) { 3.0 } else { -2.0 } } else { ((i * 7 + j * 3) % 11) as f64 / 40.0 }
        };
        let apply = |x: &[f64]| (0..n).map(|i| (0..n).map(|j| entry(i, j) * x[j]).sum()).collect::<Vec<f64>>();
        let exact: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let Ok(solved) = gmres(|x| Ok::<_, Infallible>(apply(x)), &apply(&exact), 1e-14, n);
        assert!(solved.iterations <= n && solved.residual <= 1e-13, "{solved:?}");
        assert!(solved.x.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-11));
    }

    /// I plus a matrix of rank two has a minimal polynomial of degree three.
    #[test]
    fn a_perturbation_of_low_rank_takes_few_products() {
        let n = 500;
        let apply = |x: &[f64]| {
            let (s, t): (f64, f64) = (x.iter().sum(), x.iter().enumerate().map(|(i, x)| x * (i as f64).cos()).sum());
            (0..n).map(|i| x[i] + 0.1 * s + t * (i as f64).sin()).collect::<Vec<f64>>()
        };
        let product = |x: &[f64]| Ok::<_, Infallible>(apply(x));
        let Ok(solved) = gmres(product, &vec![1.0; n], 1e-12, 50);
        assert!(solved.iterations <= 3 && solved.residual <= 1e-12, "{}", solved.iterations);
        let Ok(still) = gmres(product, &vec![0.0; n], 1e-12, 50);
        assert_eq!(still.x, vec![0.0; n]);
    }
}
