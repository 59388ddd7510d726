//! Numbers of the last state on the levels of a study, with observed orders and limits.

use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize};

use super::limit::{Limit, NoLimit, limit_of};
use crate::discretization::Discretization;
use crate::hypotheses::Constant;
use crate::problem::Problem;
use crate::state::{State, StepReport};

/// The last step of a level.
#[derive(Clone, Copy, Debug)]
pub struct LastStep<'a> {
    /// The problem of the level.
    pub problem: &'a Problem,
    /// Its discretization.
    pub discretization: &'a Discretization,
    /// The state at the end.
    pub state: &'a State,
    /// The report of the step that led there.
    pub report: &'a StepReport,
}

/// A number at the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct FinalValue {
    /// Its name, that of a column of `history.csv` or `probes.csv`.
    pub name: String,
    /// Name of those with which it shares a scale: the components of a vector, the energies.
    pub group: String,
    /// The number.
    pub value: f64,
}

/// Function that takes the numbers of a level from its last step.
#[derive(Clone)]
pub struct FinalValues(Arc<dyn Fn(&LastStep) -> Vec<FinalValue> + Send + Sync>);

impl FinalValues {
    /// The numbers by a function of the last step.
    pub fn new(values: impl Fn(&LastStep) -> Vec<FinalValue> + Send + Sync + 'static) -> FinalValues {
        FinalValues(Arc::new(values))
    }

    /// The numbers of a last step.
    #[must_use]
    pub fn of(&self, last: &LastStep) -> Vec<FinalValue> {
        (self.0)(last)
    }
}

impl fmt::Debug for FinalValues {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("FinalValues")
    }
}

/// Round-off and the tolerance of the solver in a number, relative to its largest value on the levels, and relative to
/// the largest value of its group: accepted steps satisfy their equations to 1e-10 or better.
const OWN: f64 = 1e-10;
const OF_GROUP: f64 = 1e-13;

/// Round-off and the tolerance of the solver in a number, from its largest size and that of its group.
pub(crate) fn rounded(own: f64, of_group: f64) -> f64 {
    OWN * own + OF_GROUP * of_group
}

/// A number on a level, with the order and the limit from this level and those before.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelValue {
    /// The number that names the level.
    pub level: usize,
    /// Spacing of the mesh in m.
    pub h: f64,
    /// Time step in s.
    pub k: f64,
    /// The number, in its unit; null in JSON if it is not finite.
    #[serde(deserialize_with = "number_or_nan")]
    pub value: f64,
    /// Observed order p of v(h) = v + C h^p over this level and the two before; absent if the differences have none.
    pub order: Option<f64>,
    /// The limit v by Richardson's extrapolation, and the estimate of its error.
    pub limit: Option<f64>,
    /// Estimate of the error of the limit; not a bound.
    pub error: Option<f64>,
    /// Reason why there is no order or no limit, in words; empty if there are both.
    pub remark: String,
}

/// A number, or NaN for null.
fn number_or_nan<'de, D: Deserializer<'de>>(input: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(input)?.unwrap_or(f64::NAN))
}

/// A number of the last state on all levels, coarsest first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ValueRow {
    /// Its name, that of a column of `history.csv` or `probes.csv`.
    pub name: String,
    /// The levels. The last one is the reference, if that is a level.
    pub levels: Vec<LevelValue>,
}

/// Numbers of a level: its name, spacing in m, step in s, and the values.
pub(super) struct OfLevel {
    pub level: usize,
    pub h: f64,
    pub k: f64,
    pub values: Vec<FinalValue>,
}

/// The rows of all numbers that all levels have, without those that are zero on all. `refined` is the size that is
/// refined: h or k.
pub(super) fn rows(levels: &[OfLevel], refined: impl Fn(&OfLevel) -> f64) -> Vec<ValueRow> {
    let Some(first) = levels.first() else { return Vec::new() };
    let largest = |is_meant: &dyn Fn(&FinalValue) -> bool| -> f64 {
        let meant = levels.iter().flat_map(|level| &level.values).filter(|value| is_meant(value));
        meant.map(|value| value.value.abs()).filter(|value| value.is_finite()).fold(0.0, f64::max)
    };
    let mut rows = Vec::new();
    for FinalValue { name, group, .. } in &first.values {
        let on = |level: &OfLevel| level.values.iter().find(|value| value.name == *name).map(|value| value.value);
        let Some(values) = levels.iter().map(on).collect::<Option<Vec<f64>>>() else { continue };
        if values.iter().all(|value| value.abs() <= 0.0) {
            continue;
        }
        let error = rounded(largest(&|value| value.name == *name), largest(&|value| value.group == *group));
        let points: Vec<(f64, Constant)> =
            levels.iter().zip(&values).map(|(level, &value)| (refined(level), Constant { value, error })).collect();
        let of_levels = levels.iter().zip(&points).enumerate().map(|(i, (level, (_, constant)))| {
            let (found, remark) = match limit_of(&points[..=i]) {
                Ok(limit) if limit.order.is_some() => (Some(limit), String::new()),
                Ok(limit) => (Some(limit), "the values agree within round-off: no order".to_owned()),
                // Coarse levels of a study have no two levels before them.
                Err(NoLimit::Few) if i + 1 < levels.len() => (None, String::new()),
                Err(reason) => (None, reason.to_string()),
            };
            let OfLevel { level, h, k, .. } = *level;
            let part = |part: fn(&Limit) -> f64| found.as_ref().map(part);
            LevelValue {
                level,
                h,
                k,
                value: constant.value,
                order: found.and_then(|limit| limit.order),
                limit: part(|limit| limit.value),
                error: part(|limit| limit.error),
                remark,
            }
        });
        rows.push(ValueRow { name: name.clone(), levels: of_levels.collect() });
    }
    rows
}

/// The rows as `convergence-values.csv`: one line per number and level; what is absent is empty.
#[must_use]
pub fn csv(rows: &[ValueRow]) -> String {
    let mut out = String::from("quantity,level,h,k,value,order,limit,limit_error,remark\n");
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:e}"));
    for row in rows {
        for LevelValue { level, h, k, value, order, limit, error, remark } in &row.levels {
            let order = order.map_or_else(String::new, |order| format!("{order:.6}"));
            let (limit, error) = (number(*limit), number(*error));
            // Names of contacts are those of the header of history.csv, without commas.
            out.push_str(&format!("{},{level},{h:e},{k:e},{value:e},{order},{limit},{error},{remark}\n", row.name));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(values: &[f64]) -> Vec<ValueRow> {
        let of_level = |(i, &value): (usize, &f64)| OfLevel {
            level: 1 << i,
            h: 0.5_f64.powi(i as i32),
            k: 1.0,
            values: vec![
                FinalValue { name: "a".to_owned(), group: "g".to_owned(), value },
                FinalValue { name: "b".to_owned(), group: "g".to_owned(), value: 0.0 },
                FinalValue { name: "c".to_owned(), group: "g".to_owned(), value: 1e-14 * (3.0 + f64::from(i as u32)) },
            ],
        };
        rows(&values.iter().enumerate().map(of_level).collect::<Vec<_>>(), |level| level.h)
    }

    #[test]
    fn a_square_of_h_has_order_two_and_its_limit() {
        let rows = made(&[3.0 + 1.0, 3.0 + 0.25, 3.0 + 0.0625]);
        assert_eq!(rows.iter().map(|row| row.name.as_str()).collect::<Vec<_>>(), ["a", "c"]);
        let last = &rows[0].levels[2];
        assert!(last.order.is_some_and(|p| (p - 2.0).abs() < 1e-8) && last.remark.is_empty(), "{last:?}");
        let error = last.error.unwrap_or(f64::NAN);
        assert!(last.limit.is_some_and(|v| (v - 3.0).abs() < error.min(1e-7)) && error > 0.0, "{last:?}");
        assert!(rows[0].levels[..2].iter().all(|level| level.order.is_none() && level.remark.is_empty()));
        // Noise far below the other component of a vector has no order.
        assert_eq!(rows[1].levels[2].remark, "the values agree within round-off: no order");
    }

    #[test]
    fn what_has_no_order_is_said_in_words() {
        for (values, said) in [
            ([1.0, 2.0, 1.5].as_slice(), "the differences alternate in sign: no order and no limit"),
            (&[1.0, 1.5, 2.5], "the differences do not become smaller: no order and no limit"),
            (&[1.0, 2.0, 2.0 + 1e-8], "the differences fall faster than any power: no order and no limit"),
            (&[1.0, f64::NAN, 2.0], "a value that is not a finite number"),
            (&[1.0, 1.5], "fewer than three levels: no order and no limit"),
            (&[1.0], "fewer than three levels: no order and no limit"),
        ] {
            let rows = made(values);
            let last = rows[0].levels.last();
            assert!(last.is_some_and(|last| last.remark == said && last.order.is_none() && last.limit.is_none()));
            // What is not a number is null in JSON, and read again.
            let read: Result<Vec<ValueRow>, _> =
                serde_json::from_str(&serde_json::to_string(&rows).unwrap_or_default());
            assert!(read.is_ok_and(|read| read.len() == rows.len()));
        }
    }
}
