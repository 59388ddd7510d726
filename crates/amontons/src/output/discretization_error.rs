//! `error.csv`: bounds of the discretization error at the snapshots of a run.

use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::files::{LONGEST, WrittenFile, write_atomically};
use super::{OutputError, Snapshot};
use crate::machine;
use crate::majorant::{DiscretizationError, Majorant, Refused};
use crate::units::Measure;

/// The columns of the table.
const COLUMNS: [(&str, Measure); 9] = [
    ("step", Measure::Number),
    ("t", Measure::Time),
    ("energy", Measure::Energy),
    ("relative", Measure::Number),
    ("mesh", Measure::Energy),
    ("contact", Measure::Energy),
    ("repair", Measure::Energy),
    ("solution", Measure::Energy),
    ("guaranteed", Measure::Number),
];

/// The quantities measured by the columns.
pub(super) fn measures() -> Vec<(String, Measure)> {
    COLUMNS.iter().map(|(name, measure)| ((*name).to_owned(), *measure)).collect()
}

/// The bound of the discretization error of a step in the norm of its energy.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorSummary {
    /// Energy of the error, ½‖u_h − u‖², at most, J; `None` if there is no bound.
    pub energy: Option<f64>,
    /// ‖u_h − u‖ over ‖u_h‖, at most.
    pub relative: Option<f64>,
    /// The part of the energy from the cells, J.
    pub mesh: Option<f64>,
    /// The part of the energy from Γ_C, J.
    pub contact: Option<f64>,
    /// True if the bound is proven, up to round-off; false if it is an estimate.
    pub guaranteed: bool,
    /// Reasons why there is no bound, or why it is an estimate, then what it does not count.
    pub reasons: Vec<String>,
}

impl ErrorSummary {
    fn of(found: &Result<DiscretizationError, Refused>) -> ErrorSummary {
        match found {
            Ok(found) => ErrorSummary {
                energy: Some(found.energy),
                relative: Some(found.relative()),
                mesh: Some(found.mesh),
                contact: Some(found.contact),
                guaranteed: found.is_guaranteed(),
                reasons: found.estimate.iter().chain(&found.notes).cloned().collect(),
            },
            Err(refused) => ErrorSummary { reasons: vec![refused.reason().to_owned()], ..ErrorSummary::default() },
        }
    }

    /// The bound in one line.
    #[must_use]
    pub fn line(&self) -> String {
        let reasons = self.reasons.join("; ");
        let after = if reasons.is_empty() { String::new() } else { format!(": {reasons}") };
        match (self.relative, self.guaranteed) {
            (Some(relative), is_proven) if relative > 1.0 => {
                let word = if is_proven { "" } else { ", an estimate" };
                format!("perhaps more than the solution itself{word}{after}")
            }
            (Some(relative), true) => format!("at most {} in the norm of the energy{after}", per_cent(relative)),
            (Some(relative), false) => {
                format!("about {} in the norm of the energy, an estimate{after}", per_cent(relative))
            }
            (None, _) => format!("no bound{after}"),
        }
    }
}

/// A part in per cent with three digits, rounded up: it stays a bound.
#[must_use]
pub fn per_cent(part: f64) -> String {
    let number = 100.0 * part;
    if number == 0.0 || !number.is_finite() {
        return format!("{number} %");
    }
    let digits = 2 - number.log10().floor() as i32;
    let unit = 10f64.powi(digits);
    // What is three digits but for round-off stays so.
    let up = (number * unit * (1.0 - 8.0 * f64::EPSILON)).ceil() / unit;
    if (-2..=6).contains(&digits) { format!("{up:.*} %", digits.max(0) as usize) } else { format!("{up:.2e} %") }
}

/// The bounds of the phase of a run that is made.
#[derive(Debug, Default)]
pub(super) struct PhaseBounds {
    /// The bounds of the phase with this number.
    prepared: Option<(usize, Result<Majorant, Refused>)>,
}

impl PhaseBounds {
    /// The bound of the step that led to a snapshot; `None` at t = 0.
    pub fn at(&mut self, now: &Snapshot) -> Option<Result<DiscretizationError, Refused>> {
        let report = now.report?;
        let phase = now.state.made(&now.problem.timeline).phase;
        if self.prepared.as_ref().is_none_or(|(known, _)| *known != phase) {
            self.prepared = Some((phase, Majorant::new(now.problem, now.discretization)));
        }
        // A sink works in one process, even if several solve.
        let problem = now.problem.alone();
        let (_, prepared) = self.prepared.as_mut()?;
        Some(match prepared {
            Ok(majorant) => majorant.at(&problem, now.discretization, (now.state, report)),
            Err(refused) => Err(refused.clone()),
        })
    }
}

/// The bounds of a run.
#[derive(Debug, Default)]
pub(super) struct ErrorTable {
    bounds: PhaseBounds,
    rows: Vec<(usize, String)>,
    /// The newest bound, and its step.
    pub last: Option<(usize, ErrorSummary)>,
}

impl ErrorTable {
    /// The table of a run that goes on from a step.
    pub fn reopen(path: &Path, step: usize) -> Result<ErrorTable, OutputError> {
        if !path.exists() {
            return Ok(ErrorTable::default());
        }
        let text = machine::read_text(path, LONGEST).map_err(OutputError::io("read", path))?;
        let row = |line: &str| Some((line.split(',').next()?.parse::<usize>().ok()?, line.to_owned()));
        let rows = text.lines().skip(1).filter_map(row).filter(|(n, _)| *n <= step).collect();
        Ok(ErrorTable { rows, ..ErrorTable::default() })
    }

    /// The bound of the step that led to a snapshot; `None` at t = 0 and if there is none.
    pub fn take(&mut self, now: &Snapshot) -> Option<DiscretizationError> {
        let found = self.bounds.at(now)?;
        let step = now.state.step;
        self.last = Some((step, ErrorSummary::of(&found)));
        let found = found.ok()?;
        let DiscretizationError { energy, mesh, contact, repair, of_solution, .. } = found;
        let numbers = [now.state.t, energy, found.relative(), mesh, contact, repair, of_solution];
        let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
        self.rows.push((step, format!("{step},{},{}", numbers.join(","), u8::from(found.is_guaranteed()))));
        Some(found)
    }

    /// Writes the table.
    pub fn write(&self, path: &Path) -> Result<WrittenFile, OutputError> {
        write_atomically(path, |out| {
            writeln!(out, "{}", COLUMNS.map(|(name, _)| name).join(","))?;
            self.rows.iter().try_for_each(|(_, row)| writeln!(out, "{row}"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::per_cent;

    #[test]
    fn parts_are_rounded_up_to_three_digits() {
        let all = [0.0, 1.0, 0.02, 0.034_201, 0.123_99, 1.2e-5, 3.4e-9, 2.0 / 3.0, 5e17];
        let told: Vec<String> = all.into_iter().map(per_cent).collect();
        let expected = ["0 %", "100 %", "2.00 %", "3.43 %", "12.4 %", "0.00120 %", "3.40e-7 %", "66.7 %", "5.00e19 %"];
        assert_eq!(told, expected);
    }
}
