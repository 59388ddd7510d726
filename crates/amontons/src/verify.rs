//! The benchmark problems that are shipped: cases with a `[verify]` block, run and compared.
//!
//! A benchmark is one file in the crate's `benchmarks/`: a case, its source, and reference values that are not this
//! program's own.

use std::path::Path;

use crate::case::{self, Case, CaseError, Check, Comparison, ErrorName, Files, Source, StudyRequestError, Take};
use crate::contact::Status;
use crate::convergence::{Level, Reference, Row, Study, StudyError, StudySettings, Vary, slope};
use crate::output::{OutputError, Probe, ProbeError, ProbeSet, RunStart, Sink, Snapshot, Summary, history_columns, history_values};
use crate::plot::{PlotError, Run};
use crate::run::{RunError, Settings, run};

/// Names and texts of the shipped benchmarks, by name.
pub const BENCHMARKS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/benchmarks.rs"));

/// The meshes beside them, by the names that the cases give them.
const MESHES: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/benchmark_meshes.rs"));

/// A computed value held against its reference.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Verdict {
    /// The benchmark.
    pub benchmark: String,
    /// What is compared.
    pub what: String,
    /// The value computed.
    pub computed: f64,
    /// The reference value.
    pub reference: f64,
    /// Their difference, relative to the scale of the comparison.
    pub error: f64,
    /// The difference that is allowed.
    pub tolerance: f64,
    /// Whether the difference is allowed.
    pub holds: bool,
}

/// Why a benchmark could not be run.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// The case has faults.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The run failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A study failed.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// A study does not fit the case.
    #[error(transparent)]
    Request(#[from] StudyRequestError),
    /// The files of a run cannot be read.
    #[error(transparent)]
    Files(#[from] PlotError),
    /// A check asks for something that is not there.
    #[error("{0}")]
    Check(String),
}

/// Runs a benchmark and compares what it asks for.
///
/// # Errors
/// When the case has faults, the run or a study fails, or a check names something that is not there. Values that
/// do not agree are no error: their verdict says so.
pub fn verify(name: &str, text: &str, settings: &Settings) -> Result<Vec<Verdict>, VerifyError> {
    let files = Files::Memory(MESHES.iter().map(|&(name, bytes)| (name.to_owned(), bytes.into())).collect());
    let source = Source { files, ..Source::new(format!("{name}.toml"), text) };
    let case = case::parse(&source, &[])?;
    let Some(block) = &case.verify else { return Err(VerifyError::Check(format!("{name} has no [verify] block"))) };
    let mut recorder = Recorder::new(name, &case)?;
    if block.checks.iter().any(|c| matches!(c, Check::Probe { .. } | Check::History { .. })) {
        run(&case.problem, settings, &mut [&mut recorder])?;
    }
    let mut verdicts = Vec::new();
    let mut studies: Vec<(case::StudyRequest, Vec<Row>)> = Vec::new();
    let mut own_row: Option<Row> = None;
    for (index, check) in block.checks.iter().enumerate() {
        let (what, computed, is) = match check {
            Check::Probe { probe, time, is } => {
                let value = recorder.probe(index, *time).ok_or_else(|| VerifyError::Check(format!("{name}: no {}, t = {time}", probe.name)))?;
                (format!("{}, t = {time}", probe.name), value, is)
            }
            Check::History { column, time, take, is } => {
                let value = recorder.column(column, *time, *take).ok_or_else(|| VerifyError::Check(format!("{name}: history.csv has no column {column}")))?;
                let when = match (time, take) {
                    (Some(t), _) => format!("{column} at t = {t}"),
                    (None, Take::Last) => format!("{column} at the end"),
                    (None, Take::Min) => format!("smallest {column}"),
                    (None, Take::Max) => format!("largest {column}"),
                };
                (when, value, is)
            }
            Check::Order { study: request, error, is } => {
                if !studies.iter().any(|(done, _)| done == request) {
                    let table = case::study(&source, &[], request)?.run(&StudySettings::default())?;
                    studies.push((request.clone(), table.rows));
                }
                let rows = studies.iter().find(|(done, _)| done == request).map_or(&[][..], |(_, rows)| rows);
                let size = |row: &Row| if request.vary == Vary::Time { row.k } else { row.h };
                let order = slope(&rows.iter().map(|row| (size(row), error.of(row))).collect::<Vec<_>>());
                let vary = match (request.vary, request.power) {
                    (Vary::Both, 2) => "h with k ~ h²",
                    (Vary::Both, _) => "h = k",
                    (Vary::Space, _) => "h",
                    (Vary::Time, _) => "k",
                };
                (format!("order of {} in {vary}", error.name()), order, is)
            }
            Check::Error { error, is } => {
                if own_row.is_none() {
                    own_row = Some(own_errors(name, &case)?);
                }
                (format!("{} on the mesh of the case", error.name()), own_row.as_ref().map_or(f64::NAN, |row| ErrorName::of(*error, row)), is)
            }
        };
        verdicts.push(verdict(name, what, computed, is));
    }
    Ok(verdicts)
}

/// Recomputes the figures of a run from the files of its results folder and holds its summary against them.
///
/// # Errors
/// When files are missing or damaged.
pub fn recompute(folder: &Path) -> Result<Vec<Verdict>, VerifyError> {
    let path = folder.join("summary.json");
    let text = std::fs::read_to_string(&path).map_err(|error| VerifyError::Check(format!("cannot read {}: {error}", path.display())))?;
    let summary: serde_json::Value = serde_json::from_str(&text).map_err(|error| VerifyError::Check(format!("{}: {error}", path.display())))?;
    let run = Run::read(folder)?;
    let name = summary["case"].as_str().unwrap_or("run").to_owned();
    let mut figures: Vec<(&str, f64)> = Vec::new();
    let range = |values: &mut dyn Iterator<Item = f64>| values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
    if let Some(fields) = &run.snapshot {
        let [x, y] = [0, 1].map(|c| range(&mut fields.displacement.iter().map(|u| u[c])));
        let theta = range(&mut fields.temperature.iter().copied());
        let stress = range(&mut fields.von_mises.iter().copied());
        figures.extend([
            ("/final/displacement_min/0", x[0]),
            ("/final/displacement_max/0", x[1]),
            ("/final/displacement_min/1", y[0]),
            ("/final/displacement_max/1", y[1]),
            ("/final/temperature_min", theta[0]),
            ("/final/temperature_max", theta[1]),
            ("/final/von_mises_max", stress[1]),
        ]);
    }
    if !run.contact.is_empty() {
        let count = |status: Status| run.contact.iter().filter(|row| row.status == status).count() as f64;
        let largest = |value: fn(&crate::plot::ContactRow) -> f64| run.contact.iter().map(value).fold(0.0, f64::max);
        figures.extend([
            ("/final/contact/pressure_max", largest(|row| row.pressure)),
            ("/final/contact/penetration_max", largest(|row| row.penetration)),
            ("/final/contact/open", count(Status::Open)),
            ("/final/contact/stick", count(Status::Stick)),
            ("/final/contact/slip", count(Status::Slip)),
        ]);
    }
    let columns = [
        ("/energy/kinetic", "kinetic"),
        ("/energy/elastic", "elastic"),
        ("/energy/load_work", "load_work"),
        ("/energy/viscous_dissipation", "viscous_dissipation"),
        ("/energy/friction_dissipation", "friction_dissipation"),
        ("/final/contact/force/0", "contact_force_x"),
        ("/final/contact/force/1", "contact_force_y"),
    ];
    figures.extend(columns.into_iter().filter_map(|(place, column)| Some((place, *run.history.get(column)?.last()?))));
    // The audit of the last row: what is stored and dissipated is the work done, up to the closing error.
    let at = |column: &str| run.history.get(column).and_then(|values| values.last()).copied().unwrap_or(0.0);
    let mut verdicts: Vec<Verdict> = figures
        .into_iter()
        .filter_map(|(place, computed)| {
            let reference = summary.pointer(place)?.as_f64()?;
            let is = Comparison { reference, tolerance: 1e-12, scale: reference.abs() };
            Some(verdict(&name, place.trim_start_matches('/').replace('/', "."), computed, &is))
        })
        .collect();
    let turned = summary.pointer("/energy/turned_over").and_then(serde_json::Value::as_f64).unwrap_or(1.0);
    let closing = summary.pointer("/energy/closing_error").and_then(serde_json::Value::as_f64).unwrap_or(f64::NAN);
    let is = Comparison { reference: closing, tolerance: 1e-12, scale: 1.0 };
    let error = at("closing_error");
    // A run without mechanics turns nothing over.
    verdicts.push(verdict(&name, "energy.closing_error".to_owned(), if turned > 0.0 { error / turned } else { error }, &is));
    Ok(verdicts)
}

fn verdict(name: &str, what: String, computed: f64, is: &Comparison) -> Verdict {
    let difference = (computed - is.reference).abs();
    let error = if difference == 0.0 { 0.0 } else { difference / is.scale };
    // Not `error > tolerance`: a value that is no number does not hold.
    let holds = error <= is.tolerance;
    Verdict { benchmark: name.to_owned(), what, computed, reference: is.reference, error, tolerance: is.tolerance, holds }
}

/// Errors against the exact solution with the mesh and the steps of the case.
fn own_errors(name: &str, case: &Case) -> Result<Row, VerifyError> {
    let Some(exact) = &case.exact else { return Err(VerifyError::Check(format!("{name} has no [exact] block"))) };
    let level = Level { level: case.cells.first().copied().unwrap_or_default(), problem: case.problem.clone(), text: case.fingerprint() };
    let study = Study { vary: Vary::Both, levels: vec![level], reference: Reference::Exact(exact.clone()) };
    let mut table = study.run(&StudySettings::default())?;
    table.rows.pop().ok_or_else(|| VerifyError::Check(format!("{name}: an empty study")))
}

/// Keeps what the checks of a benchmark read, step by step.
struct Recorder {
    columns: Vec<String>,
    times: Vec<f64>,
    /// One row per step.
    history: Vec<Vec<f64>>,
    set: ProbeSet,
    /// Of each probe, by the index of its check: one value per time, t = 0 included.
    probes: Vec<(usize, Vec<f64>)>,
}

impl Recorder {
    fn new(name: &str, case: &Case) -> Result<Recorder, VerifyError> {
        let checks = case.verify.iter().flat_map(|v| v.checks.iter().enumerate());
        let (probes, indices): (Vec<Probe>, Vec<usize>) =
            checks.filter_map(|(i, check)| if let Check::Probe { probe, .. } = check { Some((probe.clone(), i)) } else { None }).unzip();
        let failed = |(i, error): (usize, ProbeError)| VerifyError::Check(format!("{name}: {}: {error}", probes.get(i).map_or("", |probe| &probe.name)));
        Ok(Recorder {
            columns: history_columns(&case.problem),
            times: Vec::new(),
            history: Vec::new(),
            set: ProbeSet::new(&case.problem, &probes).map_err(failed)?,
            probes: indices.into_iter().map(|i| (i, Vec::new())).collect(),
        })
    }

    fn record(&mut self, now: &Snapshot) {
        self.times.push(now.state.t);
        for ((_, values), value) in self.probes.iter_mut().zip(self.set.values(now)) {
            values.push(value);
        }
    }

    fn probe(&self, index: usize, time: f64) -> Option<f64> {
        let (_, values) = self.probes.iter().find(|(i, _)| *i == index)?;
        interpolate(&self.times, values, time)
    }

    fn column(&self, name: &str, time: Option<f64>, take: Take) -> Option<f64> {
        let column = self.columns.iter().position(|c| c == name)?;
        let values: Vec<f64> = self.history.iter().map(|row| row[column]).collect();
        match (time, take) {
            (Some(t), _) => interpolate(self.times.get(1..)?, &values, t),
            (None, Take::Last) => values.last().copied(),
            (None, Take::Min) => values.iter().copied().reduce(f64::min),
            (None, Take::Max) => values.iter().copied().reduce(f64::max),
        }
    }
}

/// Piecewise linear in time; none outside.
fn interpolate(times: &[f64], values: &[f64], t: f64) -> Option<f64> {
    let slack = 1e-12 * times.last()?.abs();
    let after = times.iter().position(|&time| time >= t - slack)?;
    if after == 0 {
        return values.first().copied().filter(|_| (times[0] - t).abs() <= slack);
    }
    let (t0, t1) = (times[after - 1], times[after]);
    let share = ((t - t0) / (t1 - t0)).clamp(0.0, 1.0);
    // What is not known at t = 0 does not count at the end of the first step.
    let part = |value: f64, share: f64| if share > 0.0 { value * share } else { 0.0 };
    Some(part(*values.get(after - 1)?, 1.0 - share) + part(*values.get(after)?, share))
}

impl Sink for Recorder {
    fn start(&mut self, start: &RunStart) -> Result<(), OutputError> {
        self.record(&start.from);
        Ok(())
    }

    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        self.record(now);
        self.history.extend(history_values(now));
        Ok(())
    }

    fn last(&mut self, _last: &Snapshot) -> Result<(), OutputError> {
        Ok(())
    }

    fn finish(&mut self, _summary: &Summary) -> Result<(), OutputError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolation_in_time() {
        let (times, values) = ([0.0, 1.0, 2.0], [0.0, 10.0, 40.0]);
        assert_eq!(interpolate(&times, &values, 1.5), Some(25.0));
        assert_eq!(interpolate(&times, &values, 2.0), Some(40.0));
        assert_eq!(interpolate(&times, &values, 0.0), Some(0.0));
        assert_eq!(interpolate(&times, &values, 2.1), None);
    }

    #[test]
    fn a_value_that_is_no_number_does_not_hold() {
        let is = Comparison { reference: 1.0, tolerance: 1e300, scale: 1.0 };
        assert!(!verdict("x", String::new(), f64::NAN, &is).holds);
    }
}
