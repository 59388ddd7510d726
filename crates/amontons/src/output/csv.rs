//! `history.csv` and `probes.csv`, one row per step, and `contact.csv`, one row per contact point.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::files::write_atomically;
use super::{ContactSummary, OutputError, Snapshot};
use crate::contact::Quadrature;
use crate::problem::ProblemData;

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

/// Names of the columns of `history.csv`; of several contacts each has columns of its own, ending with `@` and the name of its side.
#[must_use]
pub fn history_columns(problem: &ProblemData) -> Vec<String> {
    let dim = problem.mesh.dim;
    let before = "step,t,kinetic,elastic,viscous_dissipation,friction_dissipation,contact_energy,load_work,thermal_work,scheme_dissipation,\
                  closing_error,heat_content,heat_contact";
    let after = "penetration_max,open,stick,slip,newton_mechanics,newton_heat,heat_prescribed,heat_supplied,heat_coupling,heat_closing_error,\
                 passes,contraction";
    let contact = "contact_area,wear_max,wear_volume,wear_dissipation,heat_friction,heat_foundation,heat_surroundings,parts";
    let [force, center] = ["contact_force_", "contact_center_"].map(|prefix| components(prefix, dim));
    let mut columns: Vec<String> = format!("{before},{force},{after},{contact},{center}").split(',').map(str::to_owned).collect();
    let several = problem.contacts.len() > 1;
    for contact in &problem.contacts {
        let mut add = |name: &str| columns.push(if several { format!("{name}@{}", contact.on) } else { name.to_owned() });
        if contact.foundation_heat.is_some() {
            add("foundation_temperature");
        }
        if several {
            format!("{force},{center},contact_area,heat_flow,penetration_max,pressure_max,open,stick,slip,wear_max,wear_volume").split(',').for_each(add);
        }
    }
    columns
}

/// Largest depth and volume, force, centre and area of a contact, in the order of the columns of one of several.
fn side_values(contact: &ContactSummary) -> Vec<f64> {
    let mut values = [&contact.force[..], &contact.center].concat();
    values.extend([contact.area, contact.heat_flow, contact.penetration_max, contact.pressure_max]);
    values.extend([contact.open, contact.stick, contact.slip].map(|count| count as f64));
    values.extend([contact.wear_max, contact.wear_volume]);
    values
}

/// The row of a step, in the order of [`history_columns`]; none at t = 0.
#[must_use]
pub fn history_values(now: &Snapshot) -> Option<Vec<f64>> {
    let report = now.report?;
    let (state, ledger) = (now.state, &now.state.ledger);
    let contact = ContactSummary::new(now, &report.contact, None);
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
    values.extend([contact.area, contact.wear_max, contact.wear_volume, ledger.wear_dissipation]);
    values.extend([ledger.heat_friction, ledger.heat_foundation, ledger.heat_surroundings, report.parts as f64]);
    values.extend(&contact.center);
    let several = now.problem.contacts.len() > 1;
    for side in 0..now.problem.contacts.len() {
        values.extend(state.surface.foundation.get(side).copied().flatten());
        if several {
            values.extend(side_values(&ContactSummary::new(now, &report.contact, Some(side))));
        }
    }
    Some(values)
}

/// A table with one row per step, as it grows.
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

/// Names of the columns of `contact.csv` in `dim` dimensions.
pub(super) fn contact_columns(dim: usize) -> Vec<String> {
    let [x, traction, slip] = ["", "traction_", "slip_velocity_"].map(|prefix| components(prefix, dim));
    let all = format!("node,{x},penetration,pressure,{traction},{slip},status,temperature,heat_flux,weight,wear,friction_work,side,bound");
    all.split(',').map(str::to_owned).collect()
}

/// Writes the contact points, one row per point: with nodal quadrature `node` is the node, otherwise it counts the contact points from 0. `weight`
/// is the area of a point, `side` the name of its side, `bound` the friction bound s.
pub(super) fn write_contact(path: &Path, now: &Snapshot) -> Result<(), OutputError> {
    let dim = now.problem.mesh.dim;
    let boundary = &now.discretization.boundary;
    let nodal = |side: usize| now.problem.contacts.get(side).is_some_and(|c| c.quadrature == Quadrature::Nodal);
    write_atomically(path, |out| {
        writeln!(out, "{}", contact_columns(dim).join(","))?;
        let Some(report) = now.report else { return Ok(()) };
        let contact = &report.contact;
        for (i, ((point, state), (temperature, flux))) in
            boundary.points.iter().zip(&contact.states).zip(contact.temperature.iter().zip(&contact.flux)).enumerate()
        {
            let on_node = point.nodes.first().filter(|_| nodal(point.side)).and_then(|(node, _)| boundary.nodes.get(*node));
            let node = on_node.map_or(i, |&node| node as usize);
            let kept = |values: &[f64]| values.get(i).copied().unwrap_or(0.0);
            let traction = state.q.map(|q| 0.0 - q);
            // Without heat the body has no temperature: both fields stay empty.
            let heat = if now.problem.physics.has_heat() { format!("{temperature:?},{:?}", flux.value) } else { ",".to_owned() };
            writeln!(
                out,
                "{node},{},{:?},{:?},{},{},{},{heat},{:?},{:?},{:?},{},{:?}",
                join(&point.x[..dim]),
                state.penetration,
                state.pressure,
                join(&traction[..dim]),
                join(&state.slip[..dim]),
                state.status.name(),
                point.weight,
                kept(&now.state.surface.wear),
                kept(&now.state.surface.friction_work),
                quoted(now.problem.contacts.get(point.side).map_or("", |contact| &contact.on)),
                state.bound,
            )?;
        }
        io::Result::Ok(())
    })
}

/// A name as a field of a table: in quotes where it has a comma, a quote or a line end.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}
