//! The tables of a run, and their mutual consistency.

use std::path::Path;

use super::Differences;
use crate::contact::Status;
use crate::machine;
use crate::output::{LONGEST, columns};
use crate::problem::Problem;

/// A table of numbers with a header line; words are read as NaN.
pub(super) struct NumberTable {
    pub names: Vec<String>,
    pub rows: Vec<Vec<f64>>,
    /// The word of each row in the column `status`; empty without that column.
    status: Vec<String>,
}

impl NumberTable {
    /// Reads a table.
    ///
    /// # Errors
    /// The fault of the file.
    pub fn read(path: &Path) -> Result<NumberTable, String> {
        let text = machine::read_text(path, LONGEST).map_err(|error| format!("cannot be read: {error}"))?;
        let mut lines = text.lines();
        let names: Vec<String> = lines.next().unwrap_or_default().split(',').map(str::to_owned).collect();
        let words = names.iter().position(|name| name == columns::STATUS.name);
        let (mut rows, mut status) = (Vec::new(), Vec::new());
        for (i, line) in lines.enumerate() {
            let cells: Vec<&str> = line.split(',').collect();
            // The name of a side may contain commas: it is among the last columns.
            if cells.len() < names.len() {
                return Err(format!("row {} has {} values under {} names", i + 1, cells.len(), names.len()));
            }
            rows.push(cells.iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect());
            status.extend(words.and_then(|c| cells.get(c)).map(|word| (*word).to_owned()));
        }
        Ok(NumberTable { names, rows, status })
    }

    /// The values of a column; NaN if there is no such column.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let c = self.names.iter().position(|n| n == name);
        self.rows.iter().map(|row| c.and_then(|c| row.get(c)).copied().unwrap_or(f64::NAN)).collect()
    }

    /// The value of a column in a row; `None` if it is missing.
    pub fn value(&self, row: usize, name: &str) -> Option<f64> {
        let c = self.names.iter().position(|n| n == name)?;
        self.rows.get(row)?.get(c).copied()
    }
}

/// Largest error of the energy identity over the rows, and the error that round-off of its terms allows.
pub(super) struct Audit {
    pub worst: f64,
    pub allowed: f64,
}

/// Checks the energy identity of every row: energy stored plus energy dissipated minus work done equals the initial
/// energy plus the closing error of the row.
///
/// The initial energy is in no row: it is derived from the first. Terms of n rows are sums of n numbers, each with its
/// own round-off.
pub(super) fn audit(history: &NumberTable) -> Audit {
    let plus = [
        columns::KINETIC.name,
        columns::ELASTIC.name,
        columns::CONTACT_ENERGY.name,
        columns::VISCOUS_DISSIPATION.name,
        columns::FRICTION_DISSIPATION.name,
        columns::WEAR_DISSIPATION.name,
        columns::SCHEME_DISSIPATION.name,
    ];
    let minus = [columns::LOAD_WORK.name, columns::THERMAL_WORK.name, columns::CLOSING_ERROR.name];
    // Older results do not have the one, cases without impacts the other.
    let there = |name: &&str| history.value(0, name).is_some();
    let moduli = Some(columns::MODULUS_WORK.name).filter(there);
    let impacts = Some(columns::IMPACT_DISSIPATION.name).filter(there);
    let terms: Vec<(f64, Vec<f64>)> = plus
        .iter()
        .chain(&impacts)
        .map(|name| (1.0, history.column(name)))
        .chain(minus.iter().chain(&moduli).map(|name| (-1.0, history.column(name))))
        .collect();
    let sum = |row: usize| terms.iter().map(|(sign, values)| sign * values[row]).sum::<f64>();
    let rows = history.rows.len();
    let largest = terms.iter().flat_map(|(_, values)| values).fold(0.0f64, |largest, v| largest.max(v.abs()));
    let worst = (0..rows)
        .map(|row| (sum(row) - sum(0)).abs())
        .fold(0.0f64, |worst, e| if e > worst || e.is_nan() { e } else { worst });
    // Worst case: every sum of n numbers loses n last bits of its largest partial sum.
    Audit { worst, allowed: f64::EPSILON * largest * (terms.len() * (rows + 1)) as f64 }
}

/// Compares the contact points at a step with its row in the history.
pub(super) fn contact(
    points: &NumberTable,
    problem: &Problem,
    (history, row): (&NumberTable, usize),
    differences: &mut Differences,
) {
    // Worn material of bodies that slide over each other does not stay with their contact points.
    let stays = !problem.contacts.iter().any(|contact| contact.pair.is_some() && contact.wear.is_some());
    let weights = points.column(columns::WEIGHT.name);
    for status in [Status::Open, Status::Stick, Status::Slip] {
        // Points of a pair that currently face nothing are not counted.
        let of_status = points.status.iter().zip(&weights).filter(|(word, _)| *word == status.name());
        let count = of_status.filter(|(_, weight)| **weight > 0.0).count() as f64;
        if let Some(told) = history.value(row, status.name()) {
            differences.note(format!("{} of contact/ against history.csv", status.name()), count - told, told);
        }
    }
    let largest = |name: &str| points.column(name).into_iter().fold(0.0f64, f64::max);
    for (name, of) in
        [(columns::PENETRATION_MAX.name, columns::PENETRATION.name), (columns::WEAR_MAX.name, columns::WEAR.name)]
    {
        if let Some(told) = history.value(row, name).filter(|_| stays || of != columns::WEAR.name) {
            differences.note(format!("{name} of contact/ against history.csv"), largest(of) - told, told);
        }
    }
    let wear = points.column(columns::WEAR.name);
    let touching = points.status.iter().zip(&weights).filter(|(word, _)| *word != Status::Open.name());
    let area = touching.map(|(_, weight)| weight).sum::<f64>();
    let volume = weights.iter().zip(&wear).map(|(weight, wear)| weight * wear).sum::<f64>();
    for (name, value) in [(columns::CONTACT_AREA.name, area), (columns::WEAR_VOLUME.name, volume)] {
        if let Some(told) = history.value(row, name).filter(|_| stays || name != columns::WEAR_VOLUME.name) {
            differences.note(format!("{name} of contact/ against history.csv"), value - told, told);
        }
    }
}
