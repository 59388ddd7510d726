//! Intervals, correlations, and what data do not determine.

use std::f64::consts::FRAC_PI_2;

use serde::Serialize;

use super::least_squares::{LinearModel, ROUNDED};
use super::singular::SingularValues;

/// Quantile 0.975 of the normal distribution.
const NORMAL: f64 = 1.959_963_984_540_054;
/// Degrees of freedom from which on the quantile of Student's distribution is taken from its expansion.
const MANY: usize = 200;
/// Parts of the quarter of a circle for fewer.
const PARTS: usize = 4000;
/// Half-width of the 95 % interval of a combination, relative to it, above which data do not determine it.
const UNDETERMINED: f64 = 1.0;
/// Part of a direction that counts as none.
const ABSENT: f64 = 1e-6;

/// A product of powers of the parameters, one of as many as there are parameters, whose errors are independent.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DataCombination {
    /// The exponents, by parameter: a unit vector v, for the product m₁^v₁ m₂^v₂ ….
    pub exponents: Vec<f64>,
    /// The singular value of the relative derivatives of all data over their deviations, along this direction.
    pub singular_value: f64,
    /// Half-width of the 95 % interval of the product, relative to it; `None` if the data say nothing about it.
    pub half_width: Option<f64>,
    /// True if the half-width is less than the product itself.
    pub is_determined: bool,
}

/// What data say about parameters at the minimum.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct DataStatistics {
    /// Standard deviations relative to the parameters; `None` if the data do not determine one.
    pub deviations: Vec<Option<f64>>,
    /// Factor of a standard deviation in a 95 % interval.
    pub quantile: f64,
    /// Coefficients of correlation.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// The combinations, the best determined one first.
    pub combinations: Vec<DataCombination>,
}

/// The statistics of a model in the parameters that no bound holds, over `variance`, that of residuals in units of
/// their deviations, `None` if nothing tells it, with `freedom` degrees of freedom, `None` if the deviations are known.
pub(super) fn statistics(
    model: &LinearModel,
    is_free: &[bool],
    variance: Option<f64>,
    freedom: Option<usize>,
) -> DataStatistics {
    let count = is_free.len();
    let free: Vec<usize> = (0..count).filter(|&j| is_free[j]).collect();
    let singular = SingularValues::new(free.iter().map(|&j| model.columns[j].clone()).collect());
    let rounded = ROUNDED * singular.values.first().copied().unwrap_or(0.0);
    let quantile = freedom.map_or(NORMAL, student);
    let known: Vec<bool> = singular.values.iter().map(|s| *s > rounded && *s > 0.0).collect();
    let covariance = |a: usize, b: usize| -> Option<f64> {
        let mut sum = 0.0;
        for ((right, s), known) in singular.right.iter().zip(&singular.values).zip(&known) {
            let part = right[a] * right[b];
            if *known {
                sum += part / (s * s);
            } else if right[a].abs() > ABSENT || right[b].abs() > ABSENT {
                return None;
            }
        }
        Some(sum)
    };
    let mut found = DataStatistics {
        deviations: vec![None; count],
        quantile,
        correlations: vec![vec![None; count]; count],
        combinations: Vec::new(),
    };
    for (a, &i) in free.iter().enumerate() {
        let of = covariance(a, a);
        found.deviations[i] = of.zip(variance).map(|(of, variance)| (variance * of).sqrt());
        for (b, &j) in free.iter().enumerate() {
            let product = of.zip(covariance(b, b)).map(|(a, b)| (a * b).sqrt()).filter(|product| *product > 0.0);
            found.correlations[i][j] = covariance(a, b).zip(product).map(|(ab, product)| ab / product);
        }
    }
    for ((right, s), known) in singular.right.iter().zip(&singular.values).zip(&known) {
        let mut exponents = vec![0.0; count];
        let largest = right.iter().fold(0.0, |most: f64, v| if v.abs() > most.abs() { *v } else { most });
        free.iter().zip(right).for_each(|(&j, v)| exponents[j] = v * largest.signum());
        let half_width = variance.filter(|_| *known).map(|variance| quantile * variance.sqrt() / s);
        let is_determined = *known && half_width.is_none_or(|width| width < UNDETERMINED);
        found.combinations.push(DataCombination { exponents, singular_value: *s, half_width, is_determined });
    }
    found
}

/// Quantile 0.975 of Student's distribution with `freedom` ≥ 1 degrees of freedom.
///
/// With x = √ν tan φ the density is proportional to cos^(ν−1) φ, whose integral from 0 to the quantile is 0.95 of that
/// to π/2. For many degrees of freedom the expansion of Cornish and Fisher has the same digits.
pub(super) fn student(freedom: usize) -> f64 {
    let nu = freedom.max(1) as f64;
    if freedom > MANY {
        let z = NORMAL;
        let square = z * z;
        let first = z * (square + 1.0) / 4.0;
        let second = z * ((5.0 * square + 16.0) * square + 3.0) / 96.0;
        let third = z * (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0;
        return z + (first + (second + third / nu) / nu) / nu;
    }
    let h = FRAC_PI_2 / PARTS as f64;
    let density = |phi: f64| phi.cos().max(0.0).powf(nu - 1.0);
    // Simpson's rule on each part, summed up to every end.
    let mut sums = vec![0.0];
    for i in 0..PARTS {
        let from = i as f64 * h;
        let part = h / 6.0 * (density(from) + 4.0 * density(from + 0.5 * h) + density(from + h));
        sums.push(sums[i] + part);
    }
    let wanted = 0.95 * sums[PARTS];
    let i = sums.partition_point(|sum| *sum < wanted).clamp(1, PARTS);
    let part = (wanted - sums[i - 1]) / (sums[i] - sums[i - 1]);
    // Within a part the density is nearly constant; one step of Newton's method corrects it.
    let phi = (i as f64 - 1.0 + part) * h;
    let from = (i as f64 - 1.0) * h;
    let to_phi = (phi - from) / 6.0 * (density(from) + 4.0 * density(0.5 * (from + phi)) + density(phi));
    let phi = phi - (sums[i - 1] + to_phi - wanted) / density(phi);
    nu.sqrt() * phi.tan()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of the distribution (Abramowitz and Stegun, 26.10).
    #[test]
    fn quantiles_are_those_of_tables() {
        let known = [
            (1, 12.706_204_736),
            (2, 4.302_652_730),
            (3, 3.182_446_305),
            (5, 2.570_581_836),
            (10, 2.228_138_852),
            (30, 2.042_272_456),
            (100, 1.983_971_519),
            (200, 1.971_896_224),
            (1000, 1.962_339_081),
        ];
        for (freedom, exact) in known {
            let found = student(freedom);
            assert!((found / exact - 1.0).abs() < 1e-8, "{freedom}: {found}, expected {exact}");
        }
        assert!((student(200) - student(201)).abs() < 1e-4 && student(201) < student(200));
    }

    /// A straight line through noise: the variances of its coefficients in closed form.
    #[test]
    fn a_line_has_the_variances_of_regression() {
        let x: Vec<f64> = (0..12).map(f64::from).collect();
        let model = LinearModel { residuals: vec![0.0; 12], columns: vec![vec![1.0; 12], x.clone()] };
        let found = statistics(&model, &[true, true], Some(4.0), Some(10));
        let (n, mean) = (12.0, 5.5);
        let square: f64 = x.iter().map(|x| (x - mean) * (x - mean)).sum();
        let exact = [(4.0 * (1.0 / n + mean * mean / square)).sqrt(), (4.0 / square).sqrt()];
        for (found, exact) in found.deviations.iter().zip(exact) {
            assert!((found.unwrap_or(f64::NAN) / exact - 1.0).abs() < 1e-12, "{found:?} {exact}");
        }
        let correlation = 0.0 - mean / (square / n + mean * mean).sqrt();
        assert!((found.correlations[0][1].unwrap_or(f64::NAN) - correlation).abs() < 1e-12);
        let held = statistics(&model, &[true, false], Some(4.0), None);
        assert_eq!(held.deviations[1], None);
        assert!((held.deviations[0].unwrap_or(f64::NAN) - (4.0f64 / 12.0).sqrt()).abs() < 1e-12);
    }

    /// B10: u = F²/(2 τ EA) determines the product of τ and EA alone.
    #[test]
    fn a_product_is_determined_and_its_factors_are_not() {
        let u: Vec<f64> = [2.0, 4.0, 6.0, 8.0, 10.0f64].iter().map(|f| f * f / 20_000.0).collect();
        let column: Vec<f64> = u.iter().map(|u| 0.0 - u).collect();
        let model = LinearModel { residuals: vec![0.0; 5], columns: vec![column.clone(), column] };
        let found = statistics(&model, &[true, true], Some(1.0), None);
        let squares: Vec<f64> = found.combinations.iter().map(|of| of.singular_value * of.singular_value).collect();
        assert!((squares[0] / 7.832e-5 - 1.0).abs() < 1e-12 && squares[1] < 1e-30, "{squares:?}");
        assert_eq!(found.deviations, [None, None]);
        let [product, quotient] = [0, 1].map(|i| found.combinations[i].exponents.clone());
        assert!((product[0] - product[1]).abs() < 1e-12 && (quotient[0] + quotient[1]).abs() < 1e-12);
        assert!(found.combinations[1].half_width.is_none() && !found.combinations[1].is_determined);
        // With the speed of waves beside, all relative to the largest of their kind, both are determined.
        let most = u[4];
        let mut columns = [u.iter().map(|u| u / most).collect::<Vec<f64>>(), u.iter().map(|u| u / most).collect()];
        columns[0].push(0.0);
        columns[1].push(0.5);
        let model = LinearModel { residuals: vec![0.0; 6], columns: columns.to_vec() };
        let found = statistics(&model, &[true, true], Some(1.0), None);
        for (combination, exact) in found.combinations.iter().zip([3.26278, 0.12002]) {
            let square = combination.singular_value * combination.singular_value;
            assert!((square - exact).abs() < 5e-6, "{square} {exact}");
        }
        assert!(found.deviations.iter().all(Option::is_some));
    }
}
