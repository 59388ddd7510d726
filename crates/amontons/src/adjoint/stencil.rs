//! Derivatives by differences of functions that are smooth on one branch, of fourth order.
//!
//! A central difference of step h has the error h⁴ f⁽⁵⁾/30 and the round-off ε f/h: at h of a thousandth of the
//! argument both are about 1e-12 of f′. Of a function with several branches all values are taken on the same one; where
//! the argument lies between two, only on the side of the branch that is asked for.

use crate::linalg::max_abs;

/// Step relative to the scale of the argument.
pub(crate) const STEP: f64 = 1.0 / 1024.0;
/// Number of times that the step is divided by [`SHRINK`] to stay on one branch.
const TRIES: i32 = 4;
const SHRINK: f64 = 8.0;
/// Kink relative to the derivative above which a function is not smooth, and roundings of its values that are no kink.
const KINK: f64 = 1e-4;
const ROUNDINGS: f64 = 64.0;

/// Values at −2h, −h, 0, h and 2h to the derivative, and to a number that is far below it where the function is smooth
/// and of its size where it has a kink.
pub(crate) fn central<const N: usize>(h: f64, [a, b, at, c, d]: [&[f64; N]; 5]) -> [[f64; N]; 2] {
    [
        std::array::from_fn(|i| (8.0 * (c[i] - b[i]) - (d[i] - a[i])) / (12.0 * h)),
        // Second differences over h and 2h: of a smooth function the latter is twice the former, at a kink both are its
        // jump.
        std::array::from_fn(|i| {
            let bent = |left: f64, right: f64, h: f64| ((right - at[i]) - (at[i] - left)) / h;
            2.0 * bent(b[i], c[i], h) - bent(a[i], d[i], 2.0 * h)
        }),
    ]
}

/// The derivative of the sum of products of weights and numbers, and its kink, by [`central`].
pub(super) fn product(h: f64, weights: &[f64], [a, b, at, c, d]: [&[f64]; 5]) -> [f64; 2] {
    let numbers = a.iter().zip(b).zip(at.iter().zip(c.iter().zip(d)));
    let mut sum = [0.0; 2];
    for (weight, ((a, b), (at, (c, d)))) in weights.iter().zip(numbers) {
        if weight.abs() > 0.0 {
            let [[slope], [bent]] = central(h, [&[*a], &[*b], &[*at], &[*c], &[*d]]);
            sum = [sum[0] + weight * slope, sum[1] + weight * bent];
        }
    }
    sum
}

/// Kink relative to the largest derivative of a list that is followed through the steps.
const FOLLOWED: f64 = 1e-7;
/// Roundings of the numbers of a list that are no kink.
pub(super) const OF_LISTS: f64 = 256.0;

/// [`central`] of lists of numbers whose terms have this size, the kinks without round-off.
pub(super) fn of_lists(h: f64, all: [&[f64]; 5], size: f64) -> [Vec<f64>; 2] {
    let of = |i: usize| {
        let [a, b, at, c, d] = all.map(|values| [values[i]]);
        central(h, [&a, &b, &at, &c, &d])
    };
    let (slopes, bent) = (0..all[2].len()).map(of).map(|[[slope], [bent]]| (slope, bent)).unzip();
    without_round_off([slopes, bent], size / h)
}

/// Kinks that are not more than round-off of numbers of a size, or far below all derivatives, are none.
pub(super) fn without_round_off([slopes, mut bent]: [Vec<f64>; 2], size: f64) -> [Vec<f64>; 2] {
    let least = OF_LISTS * f64::EPSILON * size + FOLLOWED * max_abs(&slopes);
    bent.iter_mut().filter(|bent| bent.abs() <= least).for_each(|bent| *bent = 0.0);
    [slopes, bent]
}

/// The derivative of the numbers of a function at 0, on a branch, for an argument of this scale; `sizes` are those of
/// the terms that the numbers are sums of. `None` if neither side of 0 is on the branch, or if the function has a kink
/// within it.
pub(super) fn derivative<const N: usize, B: PartialEq + Copy>(
    of: impl Fn(f64) -> ([f64; N], B),
    scale: f64,
    sizes: [f64; N],
    wanted: B,
) -> Option<[f64; N]> {
    let (at, mut other) = (of(0.0).0, None);
    for shrunk in 0..TRIES {
        let h = STEP * scale / SHRINK.powi(shrunk);
        let values = [-2.0, -1.0, 1.0, 2.0].map(|j| of(j * h));
        let first = values[0].1;
        let [a, b, c, d] = &values;
        let [found, bent] = central(h, [&a.0, &b.0, &at, &c.0, &d.0]);
        let is_straight = |i: usize| {
            let moved = (a.0[i] - at[i]).abs().max((d.0[i] - at[i]).abs());
            let size = sizes[i].max(a.0[i].abs()).max(d.0[i].abs());
            (bent[i] * h).abs() <= KINK * moved + ROUNDINGS * f64::EPSILON * size
        };
        let is_smooth = (0..N).all(is_straight);
        if is_smooth && values.iter().all(|(_, branch)| *branch == first) {
            if first == wanted {
                return Some(found);
            }
            // The argument does not tell the branches apart.
            other.get_or_insert(found);
        }
    }
    for h in [1.0, -1.0].map(|sign| sign * STEP * scale) {
        for shrunk in 0..TRIES {
            let h = h / SHRINK.powi(shrunk);
            let values = [1.0, 2.0, 3.0, 4.0].map(|j| of(j * h));
            if values.iter().all(|(_, branch)| *branch == wanted) && other.is_none() {
                let [a, b, c, d] = values.map(|(value, _)| value);
                let of = |i: usize| (-25.0 * at[i] + 48.0 * a[i] - 36.0 * b[i] + 16.0 * c[i] - 3.0 * d[i]) / (12.0 * h);
                return Some(std::array::from_fn(of));
            }
        }
    }
    other
}
