//! Error bars of all numbers of a run, at all instants that its companions have.

use std::collections::HashMap;
use std::fmt::Write as _;

use crate::convergence::{FinalValue, rounded};

/// Bar over change, for what is left beside the leading term of the error (Roache's factor of safety).
const SAFETY: f64 = 1.25;
/// Part of the change from level to level that counts as one by halving.
const OF_LEVELS: f64 = 0.5;
/// Difference of two times relative to the last one that is round-off.
const SAME_TIME: f64 = 1e-12;

/// A number at an instant with its bar.
#[derive(Clone, Debug, PartialEq)]
pub struct BarRow {
    /// Time in s.
    pub t: f64,
    /// Its name, that of a column of `history.csv` or `probes.csv`.
    pub name: String,
    /// Name of those with which it shares a scale.
    pub group: String,
    /// The number, in its unit.
    pub value: f64,
    /// The part of the bar from the cells: 5/4 of its change when they were halved, and of half of its change since the
    /// level before, if that is more; 0 if it is round-off.
    pub mesh: f64,
    /// The part of the bar from the steps: 5/4 of its change when they were halved; 0 if it is round-off.
    pub steps: f64,
}

impl BarRow {
    /// The whole bar.
    #[must_use]
    pub fn bar(&self) -> f64 {
        self.mesh + self.steps
    }
}

/// Numbers of the steps of a run, with their times.
pub(super) type ValuesOfSteps = [(f64, Vec<FinalValue>)];

/// The numbers of a run with their bars, from the same run with whole cells, and that with whole steps, at the instants
/// that all three have.
pub(super) fn bars(fine: &ValuesOfSteps, of_mesh: &ValuesOfSteps, of_steps: &ValuesOfSteps) -> Vec<BarRow> {
    let end = fine.last().map_or(0.0, |(t, _)| *t);
    let at = |steps: &'_ ValuesOfSteps, t: f64| -> Option<usize> {
        let place = steps.partition_point(|(other, _)| *other < t - SAME_TIME * end);
        steps.get(place).filter(|(other, _)| *other <= t + SAME_TIME * end).map(|_| place)
    };
    let mut rows = Vec::new();
    for (t, values) in fine {
        let [Some(of_mesh), Some(of_steps)] = [of_mesh, of_steps].map(|of| of.get(at(of, *t)?)) else { continue };
        for FinalValue { name, group, value } in values {
            let same = values.iter().filter(|other| other.group == *group);
            let noise = rounded(value.abs(), same.map(|other| other.value.abs()).fold(0.0, f64::max));
            let change = |of: &[FinalValue]| {
                let other = of.iter().find(|other| other.name == *name)?;
                let change = (value - other.value).abs();
                Some(if change <= noise { 0.0 } else { SAFETY * change })
            };
            let (Some(mesh), Some(steps)) = (change(&of_mesh.1), change(&of_steps.1)) else { continue };
            rows.push(BarRow { t: *t, name: name.clone(), group: group.clone(), value: *value, mesh, steps });
        }
    }
    rows
}

/// Raises the parts of the cells to half of the change of each number since the level before: where halving hits the
/// same number by chance, an error is told by that.
pub(super) fn raise(rows: &mut [BarRow], before: &[BarRow]) {
    let known: HashMap<(u64, &str), f64> =
        before.iter().map(|row| ((row.t.to_bits(), row.name.as_str()), row.value)).collect();
    for row in rows {
        if let Some(before) = known.get(&(row.t.to_bits(), row.name.as_str())).filter(|_| row.bar() > 0.0) {
            row.mesh = row.mesh.max(SAFETY * OF_LEVELS * (row.value - before).abs());
        }
    }
}

/// The rows as `bars.csv`.
#[must_use]
pub fn bars_csv(rows: &[BarRow]) -> String {
    let mut text = "t,quantity,value,bar,mesh,steps\n".to_owned();
    for row in rows {
        let BarRow { t, name, value, mesh, steps, .. } = row;
        // Names of contacts are those of the header of history.csv, without commas.
        let _ = writeln!(text, "{t:?},{name},{value:?},{:?},{mesh:?},{steps:?}", row.bar());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(t: f64, values: &[(&str, f64)]) -> (f64, Vec<FinalValue>) {
        let of =
            |(name, value): &(&str, f64)| FinalValue { name: (*name).to_owned(), group: "g".to_owned(), value: *value };
        (t, values.iter().map(of).collect())
    }

    /// Bars stand at the instants that all three runs have, 5/4 of the changes, and are zero for round-off.
    #[test]
    fn bars_are_the_changes_at_common_instants() {
        let fine = [step(0.25, &[("a", 1.0)]), step(0.5, &[("a", 2.0), ("b", 1e-16)]), step(1.0, &[("a", 4.0)])];
        let coarse = [step(0.5, &[("a", 2.5), ("b", 3e-16)]), step(1.0 + 1e-15, &[("a", 4.0)])];
        let long = [step(0.5, &[("a", 1.75), ("b", 0.0)]), step(1.0, &[("a", 4.0 + 1e-12)])];
        let rows = bars(&fine, &coarse, &long);
        let shown: Vec<(f64, &str)> = rows.iter().map(|row| (row.t, row.name.as_str())).collect();
        assert_eq!(shown, [(0.5, "a"), (0.5, "b"), (1.0, "a")]);
        assert!((rows[0].mesh - 0.625).abs() < 1e-12 && (rows[0].steps - 0.3125).abs() < 1e-12, "{rows:?}");
        assert!(rows[1..].iter().all(|row| row.bar() <= 0.0), "{rows:?}");
        assert!(
            bars_csv(&rows).starts_with("t,quantity,value,bar,mesh,steps\n0.5,a,2.0,0.9375,"),
            "{}",
            bars_csv(&rows)
        );
    }

    /// Half of the change since the level before counts, unless the number is round-off.
    #[test]
    fn the_change_since_the_level_before_raises_a_bar() {
        let row = |value: f64, mesh: f64| BarRow {
            t: 1.0,
            name: "a".to_owned(),
            group: "g".to_owned(),
            value,
            mesh,
            steps: 0.0,
        };
        for (mesh, raised) in [(0.1, 0.5), (0.7, 0.7), (0.0, 0.0)] {
            let mut rows = [row(2.0, mesh)];
            raise(&mut rows, &[row(1.2, 0.1)]);
            assert!((rows[0].mesh - raised).abs() < 1e-12, "{rows:?}");
        }
    }
}
