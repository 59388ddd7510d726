//! Tables over the temperature, linear between their points, for temperature-dependent coefficients.

use std::sync::Arc;

use super::TableError;
use crate::expression::Expression;
use crate::tensor::Point;

/// A coefficient given by its values at temperatures θ₀ < θ₁ < …, linear between them, times a factor that may vary in
/// space: c(x, θ) = factor(x) Σ c_i φ_i(θ), φ_i the hat function of θ_i.
///
/// Beyond its temperatures the table is constant, so that iterations may pass there. A step whose solution has such
/// temperatures is refused.
#[derive(Clone, Debug, PartialEq)]
pub struct TemperatureTable {
    temperatures: Arc<[f64]>,
    values: Arc<[f64]>,
    /// Integrals of the sum of hat functions from the first temperature to each.
    integrals: Arc<[f64]>,
    factor: Option<Arc<Expression>>,
    is_mean: bool,
}

impl TemperatureTable {
    /// The coefficient with these values at these temperatures in K.
    ///
    /// # Errors
    /// Fails if there are no temperatures, not as many values, numbers that are not finite, or temperatures that do not
    /// increase.
    pub fn new(temperatures: Vec<f64>, values: Vec<f64>) -> Result<TemperatureTable, TableError> {
        TableError::check("temperature", &temperatures, &values)?;
        let mut integrals = vec![0.0; values.len()];
        for i in 1..values.len() {
            let width = temperatures[i] - temperatures[i - 1];
            integrals[i] = integrals[i - 1] + 0.5 * width * (values[i - 1] + values[i]);
        }
        Ok(TemperatureTable {
            temperatures: temperatures.into(),
            values: values.into(),
            integrals: integrals.into(),
            factor: None,
            is_mean: false,
        })
    }

    /// Multiplies the table by a factor that does not depend on the time.
    #[must_use]
    pub fn scaled(mut self, factor: Expression) -> TemperatureTable {
        self.factor = Some(Arc::new(factor));
        self
    }

    /// The mean of this table from 0 to θ, as a coefficient of θ: converts tangent to secant coefficients.
    #[must_use]
    pub fn mean(mut self) -> TemperatureTable {
        self.is_mean = true;
        self
    }

    /// True if its factor depends on space.
    #[must_use]
    pub fn depends_on_space(&self) -> bool {
        self.factor.as_ref().is_some_and(|factor| factor.depends_on_space())
    }

    /// The temperatures, K.
    #[must_use]
    pub fn temperatures(&self) -> &[f64] {
        &self.temperatures
    }

    /// The sum over the hat functions, and its integral from the first temperature.
    fn at(&self, theta: f64) -> (f64, f64) {
        let (temperatures, values, integrals) = (&self.temperatures, &self.values, &self.integrals);
        let after = temperatures.partition_point(|&temperature| temperature <= theta);
        match (after.checked_sub(1), temperatures.get(after)) {
            (Some(i), Some(&end)) => {
                let (start, from, to) = (temperatures[i], values[i], values[after]);
                let share = (theta - start) / (end - start);
                let value = from * (1.0 - share) + to * share;
                (value, integrals[i] + 0.5 * (theta - start) * (from + value))
            }
            (None, _) => (values[0], values[0] * (theta - temperatures[0])),
            (Some(i), None) => (values[i], integrals[i] + values[i] * (theta - temperatures[i])),
        }
    }

    fn factor(&self, x: &Point) -> f64 {
        self.factor.as_ref().map_or(1.0, |factor| factor.value(x, 0.0))
    }

    /// The coefficient at a point and a temperature.
    #[must_use]
    pub fn value(&self, x: &Point, theta: f64) -> f64 {
        let value = if self.is_mean && theta != 0.0 { self.plain_integral(theta) / theta } else { self.at(theta).0 };
        self.factor(x) * value
    }

    fn plain_integral(&self, theta: f64) -> f64 {
        self.at(theta).1 - self.at(0.0).1
    }

    /// The integral of the table from 0 to θ: the enthalpy for a heat capacity.
    #[must_use]
    pub fn integral(&self, x: &Point, theta: f64) -> f64 {
        self.factor(x) * self.plain_integral(theta)
    }
}

/// The temperature of a list nearest to 0 K, used if no temperature is known; 0 for an empty list.
pub(crate) fn reference(temperatures: &[f64]) -> f64 {
    match temperatures {
        [first, .., last] => 0f64.clamp(*first, *last),
        [only] => *only,
        [] => 0.0,
    }
}

/// The temperatures of several lists within their common range; empty if there is none.
#[cfg(feature = "case")]
pub(crate) fn common<'a>(lists: impl Iterator<Item = &'a [f64]> + Clone) -> Vec<f64> {
    let first = lists.clone().filter_map(|list| list.first().copied()).fold(f64::NEG_INFINITY, f64::max);
    let last = lists.clone().filter_map(|list| list.last().copied()).fold(f64::INFINITY, f64::min);
    let mut all: Vec<f64> = lists.flatten().copied().filter(|theta| (first..=last).contains(theta)).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "the numbers are exact in binary")]
mod tests {
    use super::*;

    const X: Point = [0.5, 0.0, 0.0];

    fn table() -> Result<TemperatureTable, TableError> {
        TemperatureTable::new(vec![-2.0, 0.0, 4.0], vec![1.0, 3.0, 1.0])
    }

    /// The trapezia by hand: 3 − θ/2 above 0, 3 + θ below, 1 beyond both ends.
    #[test]
    fn values_are_linear_and_integrals_begin_at_zero() -> Result<(), TableError> {
        let table = table()?;
        let at = |theta| (table.value(&X, theta), table.integral(&X, theta));
        assert_eq!(at(1.0), (2.5, 2.75));
        assert_eq!(at(4.0), (1.0, 8.0));
        assert_eq!(at(6.0), (1.0, 10.0));
        assert_eq!(at(-1.0), (2.0, -2.5));
        assert_eq!(at(-2.0), (1.0, -4.0));
        assert_eq!(at(-3.0), (1.0, -5.0));
        assert_eq!(at(0.0), (3.0, 0.0));
        Ok(())
    }

    #[test]
    fn a_mean_is_the_integral_over_the_temperature() -> Result<(), Box<dyn std::error::Error>> {
        let mean = table()?.mean().scaled(Expression::parse("4*x")?);
        assert_eq!([4.0, -2.0, 0.0].map(|theta| mean.value(&X, theta)), [4.0, 4.0, 6.0]);
        Ok(())
    }

    #[test]
    fn what_is_no_function_of_the_temperature_is_refused() {
        let of = |temperatures: &[f64], values: &[f64]| {
            TemperatureTable::new(temperatures.to_vec(), values.to_vec()).map(|_| ()).map_err(|e| e.to_string())
        };
        let told = |message: &str| Err(message.to_owned());
        assert_eq!(
            of(&[0.0], &[]),
            told("the table has 1 temperatures and 0 values, expected one value per temperature")
        );
        assert_eq!(
            of(&[0.0, -1.0], &[1.0; 2]),
            told("row 2 of the table has the temperature -1 after 0, expected a higher one")
        );
    }

    #[test]
    fn several_lists_have_their_common_range() {
        let lists: [&[f64]; 3] = [&[0.0, 10.0], &[], &[5.0, 7.0, 20.0]];
        assert_eq!(common(lists.into_iter()), [5.0, 7.0, 10.0]);
        assert_eq!([reference(&[5.0, 9.0]), reference(&[-4.0, 2.0]), reference(&[])], [5.0, 0.0, 0.0]);
    }
}
