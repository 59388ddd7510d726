//! What every pencil of an eigenvalue problem must satisfy.

use crate::linalg::{Pencil, dot, max_abs};

/// Checks that both products of a pencil B x = μ K x are linear and symmetric, that B is positive semidefinite and K
/// positive definite on some vectors, and that `solve` inverts K.
///
/// # Panics
/// Panics if the pencil violates the contract.
pub fn assert_pencil(pencil: &mut impl Pencil) {
    let n = pencil.size();
    let vector = |seed: usize| (0..n).map(|i| ((i * (2 * seed + 3) + seed) as f64).sin()).collect::<Vec<f64>>();
    let (x, y) = (vector(1), vector(2));
    let sum: Vec<f64> = x.iter().zip(&y).map(|(x, y)| 2.0 * x - 3.0 * y).collect();
    let denominator =
        |x: &[f64]| pencil.denominator(x).unwrap_or_else(|error| panic!("the product K x of a pencil: {error}"));
    let numerator = |x: &[f64]| pencil.numerator(x);
    for (name, product) in [("B", &numerator as &dyn Fn(&[f64]) -> Vec<f64>), ("K", &denominator)] {
        let [of_x, of_y, of_sum] = [&x, &y, &sum].map(|v| product(v));
        let size = max_abs(&of_x).max(max_abs(&of_y)).max(f64::MIN_POSITIVE);
        let bent =
            (0..n).map(|i| of_sum[i] - (2.0 * of_x[i] - 3.0 * of_y[i])).fold(0.0f64, |most, d| most.max(d.abs()));
        assert!(bent <= 1e-10 * size, "{name} of a pencil is not linear, by {bent:e} of {size:e}");
        let [xy, yx] = [dot(&x, &of_y), dot(&y, &of_x)];
        let scale = (dot(&x, &of_x).abs() * dot(&y, &of_y).abs()).sqrt().max(f64::MIN_POSITIVE);
        assert!((xy - yx).abs() <= 1e-9 * scale, "{name} of a pencil is not symmetric: {xy:e} and {yx:e}");
        let least = dot(&x, &of_x).min(dot(&y, &of_y));
        assert!(least >= -1e-10 * scale && (name == "B" || least > 0.0), "{name} of a pencil has the energy {least:e}");
    }
    let mut found = denominator(&x);
    pencil.solve(&mut found, 1e-12).unwrap_or_else(|error| panic!("the system of a pencil: {error}"));
    let error = found.iter().zip(&x).fold(0.0f64, |most, (found, x)| most.max((found - x).abs()));
    assert!(error <= 1e-6 * max_abs(&x), "a pencil does not solve K x = r, by {error:e}");
}
