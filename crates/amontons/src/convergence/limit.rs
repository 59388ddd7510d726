//! Observed order and limit of a number on a sequence of meshes (Richardson's extrapolation).
//!
//! Three meshes determine p, C and v of v(h) = v + C h^p. The pure power is an assumption: corners and changes of the
//! boundary condition mix exponents, and the reported error is an estimate, not a bound.

use serde::Serialize;

use crate::hypotheses::{Constant, DomainConstants};

/// Orders above this one are differences of round-off.
const HIGHEST: f64 = 16.0;

/// The limit of a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limit {
    /// p from the three finest meshes; `None` if the values agree within their errors.
    pub order: Option<f64>,
    /// The limit.
    pub value: f64,
    /// Estimate of its error: the change of the limit by the finest mesh, or with only three meshes its distance to the
    /// finest value. Algebraic errors are added.
    pub error: f64,
}

/// A mesh of a sequence with its constants.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstantsRow {
    /// Cells per side.
    pub level: usize,
    /// Spacing of the mesh, m.
    pub h: f64,
    /// The constants on this mesh.
    pub constants: DomainConstants,
    /// Observed order of each constant over this mesh and the two before, in the order of [`DomainConstants::named`].
    pub orders: [Option<f64>; 6],
}

/// Constants of (2.12)–(2.15) on a sequence of meshes, from coarse to fine, and their limits.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstantsTable {
    /// One row per mesh.
    pub rows: Vec<ConstantsRow>,
    /// The limits, in the order of [`DomainConstants::named`]; `None` with fewer than three meshes, and if the
    /// differences do not decrease like a power of h.
    pub limits: [Option<Limit>; 6],
}

impl ConstantsTable {
    /// The table of meshes given by level, spacing h in m and constants, coarsest first.
    #[must_use]
    pub fn new(meshes: &[(usize, f64, DomainConstants)]) -> ConstantsTable {
        let column = |i: usize, count: usize| -> Option<Vec<(f64, Constant)>> {
            meshes[..count].iter().map(|(_, h, constants)| Some((*h, constants.named()[i].1?))).collect()
        };
        let rows = meshes.iter().enumerate().map(|(k, &(level, h, constants))| ConstantsRow {
            level,
            h,
            constants,
            orders: std::array::from_fn(|i| limit(&column(i, k + 1)?)?.order),
        });
        ConstantsTable { rows: rows.collect(), limits: std::array::from_fn(|i| limit(&column(i, meshes.len())?)) }
    }
}

/// Reason why a sequence has no limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoLimit {
    /// Fewer than three meshes.
    #[error("fewer than three levels: no order and no limit")]
    Few,
    /// A value is infinite or not a number.
    #[error("a value that is not a finite number")]
    NotFinite,
    /// The last two differences have different signs.
    #[error("the differences alternate in sign: no order and no limit")]
    Alternating,
    /// The order would be zero or negative.
    #[error("the differences do not become smaller: no order and no limit")]
    Growing,
    /// The order would be above 16.
    #[error("the differences fall faster than any power: no order and no limit")]
    TooFast,
}

/// The limit of values at decreasing h, from the last three; `None` if they do not behave like v + C h^p, p > 0.
#[must_use]
pub fn limit(values: &[(f64, Constant)]) -> Option<Limit> {
    limit_of(values).ok()
}

/// [`limit`], or the reason why there is none.
///
/// # Errors
/// The values do not behave like v + C h^p, p > 0.
pub fn limit_of(values: &[(f64, Constant)]) -> Result<Limit, NoLimit> {
    let [earlier @ .., (h0, v0), (h1, v1), (h2, v2)] = values else { return Err(NoLimit::Few) };
    if [v0, v1, v2].iter().any(|v| !v.value.is_finite()) {
        return Err(NoLimit::NotFinite);
    }
    let (first, second) = (v0.value - v1.value, v1.value - v2.value);
    if second.abs() <= v1.error + v2.error {
        return Ok(Limit { order: None, value: v2.value, error: second.abs() + v2.error });
    }
    let p = order([*h0, *h1, *h2], first / second)?;
    // v = v₂ − C h₂^p with C = (v₁ − v₂)/(h₁^p − h₂^p).
    let share = 1.0 / ((h1 / h2).powf(p) - 1.0);
    let value = v2.value - share * second;
    let before = if earlier.is_empty() { None } else { limit(&values[..values.len() - 1]) };
    let change = before.map_or(share * second, |before| before.value - value).abs();
    Ok(Limit { order: Some(p), value, error: change + (1.0 + share) * v2.error + share * v1.error })
}

/// p with (h₀^p − h₁^p)/(h₁^p − h₂^p) = `ratio`; the left side increases with p.
fn order(h: [f64; 3], ratio: f64) -> Result<f64, NoLimit> {
    let left = |p: f64| ((h[0] / h[1]).powf(p) - 1.0) / (1.0 - (h[2] / h[1]).powf(p));
    let (mut low, mut high) = (0.0, HIGHEST);
    if ratio < 0.0 {
        return Err(NoLimit::Alternating);
    }
    if ratio >= left(high) {
        return Err(NoLimit::TooFast);
    }
    let falls = (h[0] / h[1]).ln() < ratio * (h[1] / h[2]).ln();
    if !falls {
        return Err(NoLimit::Growing);
    }
    // One bisection per binary digit of a number.
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (low + high);
        if left(middle) < ratio { low = middle } else { high = middle }
    }
    Ok(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::expect_used, reason = "a test fails by panicking")]

    use super::*;

    fn power(h: &[f64], p: f64, error: f64) -> Vec<(f64, Constant)> {
        h.iter().map(|&h| (h, Constant { value: 3.0 - 0.7 * h.powf(p), error })).collect()
    }

    #[test]
    fn a_power_of_h_has_its_exponent_and_limit_whatever_the_ratio_of_the_meshes() {
        for p in [0.4, 1.0, 1.37, 2.0, 4.0] {
            for h in [[0.5, 0.25, 0.125].as_slice(), &[0.5, 0.3, 0.2, 0.07], &[1e-6, 5e-7, 1e-7]] {
                // In units where h is of order 1, a small h leaves no digits of the power.
                let unit: Vec<f64> = h.iter().map(|x| x / h[0]).collect();
                let found = limit(&power(&unit, p, 0.0)).expect("a limit");
                assert!(
                    (found.order.expect("an order") - p).abs() < 1e-9 && (found.value - 3.0).abs() < 1e-10,
                    "{p} {h:?} {found:?}"
                );
            }
        }
    }

    #[test]
    fn values_that_agree_have_a_limit_without_order() {
        let values: Vec<_> =
            [0.5, 0.25, 0.125].iter().map(|&h| (h, Constant { value: 1.0 + 1e-13 * h, error: 1e-12 })).collect();
        let found = limit(&values).expect("a limit");
        assert!(found.order.is_none() && (found.value - 1.0).abs() < 1e-12 && found.error >= 1e-12);
    }

    #[test]
    fn values_that_do_not_settle_have_no_limit() {
        let of = |values: [f64; 3]| {
            limit(
                &[0.5, 0.25, 0.125]
                    .iter()
                    .zip(values)
                    .map(|(&h, value)| (h, Constant { value, error: 0.0 }))
                    .collect::<Vec<_>>(),
            )
        };
        assert_eq!(of([1.0, 2.0, 3.0]), None);
        assert_eq!(of([1.0, 2.0, 1.5]), None);
        assert_eq!(of([1.0, 2.0, f64::NAN]), None);
        assert_eq!(limit(&power(&[0.5, 0.25], 1.0, 0.0)), None);
    }

    /// The estimate of the error covers the error if the next term is h^{p+1}.
    #[test]
    fn the_error_is_of_the_size_told() {
        let values: Vec<_> = [0.4, 0.2, 0.1, 0.05]
            .iter()
            .map(|h: &f64| (*h, Constant { value: 2.0 + h * h + h.powi(3), error: 0.0 }))
            .collect();
        let found = limit(&values).expect("a limit");
        let off = (found.value - 2.0).abs();
        assert!(off < found.error && found.error < 20.0 * off, "{found:?} {off:e}");
    }
}
