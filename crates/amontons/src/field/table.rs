//! Tables over time, linear between their points.

use std::sync::Arc;

use crate::expression::{Derivatives, Expression};
use crate::tensor::Point;

/// A fault in the numbers of a table over time or temperature.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// There are no rows.
    #[error("the table has no {over}s, expected at least one")]
    Empty {
        /// `time` or `temperature`.
        over: &'static str,
    },
    /// Arguments and values are not paired.
    #[error("the table has {count} {over}s and {values} values, expected one value per {over}")]
    Lengths {
        /// `time` or `temperature`.
        over: &'static str,
        /// Number of arguments.
        count: usize,
        /// Number of values.
        values: usize,
    },
    /// An argument or a value is infinite or not a number.
    #[error("row {row} of the table has the {over} {at} and the value {value}, expected finite numbers")]
    NotFinite {
        /// `time` or `temperature`.
        over: &'static str,
        /// The row, from 1.
        row: usize,
        /// Its argument.
        at: f64,
        /// Its value.
        value: f64,
    },
    /// An argument is not larger than the one before.
    #[error(
        "row {row} of the table has the {over} {found} after {before}, expected a {} one",
        if *.over == "time" { "later" } else { "higher" }
    )]
    NotIncreasing {
        /// `time` or `temperature`.
        over: &'static str,
        /// The row, from 1.
        row: usize,
        /// Its argument.
        found: f64,
        /// The argument of the row before.
        before: f64,
    },
}

impl TableError {
    /// Checks that these can be the arguments and values of a table.
    pub(super) fn check(over: &'static str, at: &[f64], values: &[f64]) -> Result<(), TableError> {
        if at.len() != values.len() {
            return Err(TableError::Lengths { over, count: at.len(), values: values.len() });
        }
        if at.is_empty() {
            return Err(TableError::Empty { over });
        }
        if let Some(i) = (0..at.len()).find(|&i| !(at[i].is_finite() && values[i].is_finite())) {
            return Err(TableError::NotFinite { over, row: i + 1, at: at[i], value: values[i] });
        }
        if let Some(i) = at.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(TableError::NotIncreasing { over, row: i + 2, found: at[i + 1], before: at[i] });
        }
        Ok(())
    }
}

/// A function of time given by its values at times t₀ < t₁ < …, linear between them, times a factor that may vary in
/// space and time: f(x, t) = factor(x, t) Σ v_i φ_i(t), φ_i the hat function of t_i.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeTable {
    times: Arc<[f64]>,
    values: Arc<[f64]>,
    hold: bool,
    factor: Option<Arc<Expression>>,
}

impl TimeTable {
    /// The function with these values at these times in s. Outside the times its value is NaN.
    ///
    /// # Errors
    /// Fails if there are no times, not as many values, numbers that are not finite, or times that do not increase.
    pub fn new(times: Vec<f64>, values: Vec<f64>) -> Result<TimeTable, TableError> {
        TableError::check("time", &times, &values)?;
        Ok(TimeTable { times: times.into(), values: values.into(), hold: false, factor: None })
    }

    /// Extends the table by its first value before its times and its last one after them.
    #[must_use]
    pub fn hold(mut self) -> TimeTable {
        self.hold = true;
        self
    }

    /// Multiplies the table by a factor.
    #[must_use]
    pub fn scaled(mut self, factor: Expression) -> TimeTable {
        self.factor = Some(Arc::new(factor));
        self
    }

    /// True if its factor depends on space.
    #[must_use]
    pub fn depends_on_space(&self) -> bool {
        self.factor.as_ref().is_some_and(|factor| factor.depends_on_space())
    }

    /// The first and the last time with a value, s.
    #[must_use]
    pub fn span(&self) -> [f64; 2] {
        match (self.hold, self.times.first(), self.times.last()) {
            (false, Some(&first), Some(&last)) => [first, last],
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// The sum over the hat functions and its slope in time.
    fn at(&self, t: f64) -> (f64, f64) {
        let after = self.times.partition_point(|&time| time <= t);
        let [first, last] = self.span();
        match (after.checked_sub(1), self.times.get(after)) {
            _ if !(first..=last).contains(&t) => (f64::NAN, f64::NAN),
            (Some(i), Some(&end)) => {
                let (start, from, to) = (self.times[i], self.values[i], self.values[after]);
                let share = (t - start) / (end - start);
                (from * (1.0 - share) + to * share, (to - from) / (end - start))
            }
            (None, _) => (self.values[0], 0.0),
            (Some(i), None) => (self.values[i], 0.0),
        }
    }

    /// Value at a point and a time.
    #[must_use]
    pub fn value(&self, x: &Point, t: f64) -> f64 {
        let (value, _) = self.at(t);
        self.factor.as_ref().map_or(value, |factor| value * factor.value(x, t))
    }

    /// Values at many points at one time; the table is searched once.
    pub fn values(&self, points: &[Point], t: f64, out: &mut [f64]) {
        let (value, _) = self.at(t);
        match &self.factor {
            None => out.fill(value),
            Some(factor) => {
                factor.values(points, t, out);
                for out in out {
                    *out *= value;
                }
            }
        }
    }

    /// Value and derivatives; at a time of the table the slope of the following interval is used.
    #[must_use]
    pub fn derivatives(&self, x: &Point, t: f64) -> Derivatives {
        let (value, slope) = self.at(t);
        let Some(factor) = &self.factor else { return Derivatives { value, by_t: slope, ..Derivatives::default() } };
        let factor = factor.derivatives(x, t);
        Derivatives {
            value: value * factor.value,
            by_x: factor.by_x.map(|d| value * d),
            by_t: slope * factor.value + value * factor.by_t,
        }
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "the numbers are exact in binary")]
mod tests {
    use super::*;

    fn ramp() -> Result<TimeTable, TableError> {
        TimeTable::new(vec![0.0, 1.0, 3.0], vec![1.0, 5.0, -1.0])
    }

    #[test]
    fn values_are_linear_between_the_times_and_none_outside() -> Result<(), TableError> {
        let at = |table: &TimeTable, t: f64| table.value(&[0.0; 3], t);
        let table = ramp()?;
        assert_eq!([0.0, 0.25, 1.0, 2.0, 3.0].map(|t| at(&table, t)), [1.0, 2.0, 5.0, 2.0, -1.0]);
        assert!(at(&table, -1e-9).is_nan() && at(&table, 3.000_001).is_nan());
        assert_eq!(table.span(), [0.0, 3.0]);
        let held = table.hold();
        assert_eq!([-7.0, 0.5, 9.0].map(|t| at(&held, t)), [1.0, 3.0, -1.0]);
        Ok(())
    }

    #[test]
    fn a_factor_multiplies_in_space_and_time() -> Result<(), Box<dyn std::error::Error>> {
        let table = ramp()?.scaled(Expression::parse("x*(1 - x) + t")?);
        let points = [[0.5, 0.0, 0.0], [0.25, 9.0, 0.0]];
        let mut values = [0.0; 2];
        table.values(&points, 0.5, &mut values);
        assert_eq!(values, [3.0 * (0.25 + 0.5), 3.0 * (0.1875 + 0.5)]);
        assert_eq!(points.map(|x| table.value(&x, 0.5)), values);
        // (1 + 4t)(x(1 − x) + t): by x (1 + 4t)(1 − 2x), by t 4(x(1 − x) + t) + (1 + 4t).
        let d = table.derivatives(&points[1], 0.5);
        assert_eq!((d.by_x, d.by_t), ([1.5, 0.0, 0.0], 4.0 * 0.6875 + 3.0));
        Ok(())
    }

    #[test]
    fn what_is_no_function_of_time_is_refused() {
        let of = |times: &[f64], values: &[f64]| {
            TimeTable::new(times.to_vec(), values.to_vec()).map(|_| ()).map_err(|e| e.to_string())
        };
        let told = |message: &str| Err(message.to_owned());
        assert_eq!(of(&[], &[]), told("the table has no times, expected at least one"));
        assert_eq!(of(&[0.0], &[]), told("the table has 1 times and 0 values, expected one value per time"));
        assert_eq!(
            of(&[0.0, f64::NAN], &[1.0, 2.0]),
            told("row 2 of the table has the time NaN and the value 2, expected finite numbers")
        );
        assert_eq!(
            of(&[0.0, 1.0, 1.0], &[1.0; 3]),
            told("row 3 of the table has the time 1 after 1, expected a later one")
        );
    }
}
