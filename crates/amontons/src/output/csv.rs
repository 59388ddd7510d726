//! `history.csv` and `probes.csv`, a row a step, and `contact.csv`, a row a contact point.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::files::write_atomically;
use super::{ContactSummary, OutputError, Snapshot};

/// Names of the coordinate directions.
const AXES: [&str; 3] = ["x", "y", "z"];

/// `prefix_x,prefix_y[,prefix_z]`.
fn components(prefix: &str, dim: usize) -> String {
    AXES[..dim].iter().map(|axis| format!("{prefix}{axis}")).collect::<Vec<_>>().join(",")
}

/// Numbers in the shortest form that reads back to the same bits, counts without a point.
fn join(values: &[f64]) -> String {
    let number = |v: &f64| if v.fract() == 0.0 && v.abs() < 1e15 { format!("{v:.0}") } else { format!("{v:?}") };
    values.iter().map(number).collect::<Vec<_>>().join(",")
}

/// Names of the columns of `history.csv`.
#[must_use]
pub fn history_columns(dim: usize) -> Vec<String> {
    let before = "step,t,kinetic,elastic,viscous_dissipation,friction_dissipation,contact_energy,load_work,thermal_work,scheme_dissipation,\
                  closing_error,heat_content,heat_contact";
    let after = "penetration_max,open,stick,slip,newton_mechanics,newton_heat,heat_prescribed,heat_supplied,heat_coupling,heat_closing_error,\
                 passes,contraction";
    format!("{before},{},{after}", components("contact_force_", dim)).split(',').map(str::to_owned).collect()
}

/// The row of a step, in the order of [`history_columns`]; none at t = 0.
#[must_use]
pub fn history_values(now: &Snapshot) -> Option<Vec<f64>> {
    let report = now.report?;
    let (state, ledger) = (now.state, &now.state.ledger);
    let contact = ContactSummary::new(&report.contact, now.problem.mesh.dim);
    let mut values = vec![
        state.step as f64,
        state.t,
        ledger.kinetic,
        ledger.elastic,
        ledger.viscous_dissipation,
        ledger.friction_dissipation,
        ledger.contact_energy,
        ledger.load_work,
        ledger.thermal_work,
        ledger.scheme_dissipation,
        ledger.closing_error,
        ledger.heat_content,
        ledger.heat_contact,
    ];
    values.extend(&contact.force);
    values.push(contact.penetration_max);
    values.extend([contact.open, contact.stick, contact.slip, report.newton_mechanics, report.newton_heat].map(|count| count as f64));
    values.extend([ledger.heat_prescribed, ledger.heat_supplied, ledger.heat_coupling, ledger.heat_closing_error]);
    // No contraction factor is 0, so that every row has a number in every column.
    values.extend([report.coupling.passes as f64, report.coupling.contraction.unwrap_or_default().mean]);
    Some(values)
}

/// A table with a row a step, as it grows.
#[derive(Debug)]
pub(super) struct Rows {
    path: PathBuf,
    file: File,
}

impl Rows {
    /// A file with a header and no rows.
    pub fn create(path: PathBuf, columns: &[String]) -> Result<Rows, OutputError> {
        write_atomically(&path, |out| writeln!(out, "{}", columns.join(",")))?;
        Rows::append(path)
    }

    /// The file of a run that goes on after `steps` steps: rows behind them are cut off.
    pub fn reopen(path: PathBuf, columns: &[String], steps: usize) -> Result<Rows, OutputError> {
        let text = fs::read_to_string(&path).map_err(OutputError::io("read", &path))?;
        let inconsistent = |found: String, expected: String| OutputError::Inconsistent { path: path.clone(), found, expected };
        // A line that a crash cut short has no line end; it is behind the rows that count, or missing from them.
        let mut lines = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
        let header = columns.join(",");
        if lines.next().map(str::trim_end) != Some(header.as_str()) {
            return Err(inconsistent("another header".to_owned(), format!("\"{header}\"")));
        }
        let rows: Vec<&str> = lines.take(steps).collect();
        let in_order = rows.iter().enumerate().all(|(i, row)| row.split(',').next() == Some((i + 1).to_string().as_str()));
        if rows.len() < steps || !in_order {
            return Err(inconsistent(format!("{} rows", rows.len()), format!("a row for each of the {steps} steps of the checkpoint")));
        }
        write_atomically(&path, |out| {
            writeln!(out, "{header}")?;
            rows.iter().try_for_each(|row| out.write_all(row.as_bytes()))
        })?;
        Rows::append(path)
    }

    fn append(path: PathBuf) -> Result<Rows, OutputError> {
        let file = OpenOptions::new().append(true).open(&path).map_err(OutputError::io("open", &path))?;
        Ok(Rows { path, file })
    }

    /// Adds the row of a step in one piece.
    pub fn push(&mut self, values: &[f64]) -> Result<(), OutputError> {
        let row = join(values) + "\n";
        self.file.write_all(row.as_bytes()).map_err(OutputError::io("write", &self.path))
    }

    /// Sees to it that the rows are on the disk.
    pub fn sync(&self) -> Result<(), OutputError> {
        self.file.sync_data().map_err(OutputError::io("write", &self.path))
    }

    /// Follows the file to another folder.
    pub fn moved(&mut self, path: PathBuf) {
        self.path = path;
    }
}

/// Writes `contact.csv`: with nodal quadrature `node` is the node, otherwise it counts the contact points from 0.
pub(super) fn write_contact(path: &Path, now: &Snapshot) -> Result<(), OutputError> {
    let dim = now.problem.mesh.dim;
    let boundary = &now.discretization.boundary;
    let nodal = now.problem.contact.as_ref().is_some_and(|c| c.quadrature == crate::contact::Quadrature::Nodal);
    write_atomically(path, |out| {
        writeln!(
            out,
            "node,{},penetration,pressure,{},{},status,temperature,heat_flux",
            components("", dim),
            components("traction_", dim),
            components("slip_velocity_", dim)
        )?;
        let Some(report) = now.report else { return Ok(()) };
        let contact = &report.contact;
        for (i, ((point, state), (temperature, flux))) in
            boundary.points.iter().zip(&contact.states).zip(contact.temperature.iter().zip(&contact.flux)).enumerate()
        {
            let node = if nodal { boundary.nodes.get(i).map_or(i, |&node| node as usize) } else { i };
            let traction = state.q.map(|q| 0.0 - q);
            writeln!(
                out,
                "{node},{},{:?},{:?},{},{},{},{temperature:?},{:?}",
                join(&point.x[..dim]),
                state.penetration,
                state.pressure,
                join(&traction[..dim]),
                join(&state.slip[..dim]),
                state.status.name(),
                flux.value,
            )?;
        }
        io::Result::Ok(())
    })
}
