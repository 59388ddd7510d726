//! Runs and compares cases with an `[expected]` or a `[verify]` block, and the shipped benchmark problems.
//!
//! A benchmark is one file in the crate's `benchmarks/`: a case, its source, and reference values that this program did
//! not compute.

use crate::case::{
    self, Case, CaseError, Check, ColumnTake, Comparison, ErrorName, Expected, Files, Source, StudyRequest,
    StudyRequestError,
};
use crate::convergence::{ErrorRow, Reference, Study, StudyError, StudyLevel, StudySettings, Vary, slope};
use crate::output::{
    OutputError, Probe, ProbeError, ProbeSet, RunStart, Sink, Snapshot, history_columns, history_values,
};
use crate::run::{RunError, Settings, run};
use crate::stability::{Modes, Search, StabilityError, modes};

mod folder;

pub use folder::{Recomputed, recompute};

/// Names and texts of the shipped benchmarks, sorted by name.
pub const BENCHMARKS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/benchmarks.rs"));

/// The shipped meshes, by the names used in the cases.
const MESHES: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/benchmark_meshes.rs"));

/// A computed value compared with its reference.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Verdict {
    /// The benchmark, or the name of the case.
    pub benchmark: String,
    /// The compared quantity.
    pub what: String,
    /// The value computed.
    pub computed: f64,
    /// The reference value.
    pub reference: f64,
    /// Their difference, relative to the scale of the comparison.
    pub error: f64,
    /// The allowed difference.
    pub tolerance: f64,
    /// True if the difference is allowed.
    pub holds: bool,
}

/// Reason why a case could not be verified.
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
    Files(#[from] OutputError),
    /// The case has no value to compare.
    #[error("{0} has nothing to compare; add [expected] with values of summary.json, or [[verify.check]]")]
    Nothing(String),
    /// A check refers to something that does not exist.
    #[error("{0}")]
    Check(String),
}

/// Runs a shipped benchmark and makes its comparisons.
///
/// # Errors
/// See [`verify_case`].
pub fn verify(name: &str, text: &str, settings: &Settings) -> Result<Vec<Verdict>, VerifyError> {
    verify_case(&benchmark(name, text), &[], settings)
}

/// The case of a benchmark, with the shipped meshes.
#[must_use]
pub fn benchmark(name: &str, text: &str) -> Source {
    let files = Files::Memory(MESHES.iter().map(|&(name, bytes)| (name.to_owned(), bytes.into())).collect());
    Source { files, ..Source::new(format!("{name}.toml"), text) }
}

/// Runs a case with overrides and makes the comparisons of its `[expected]` and `[verify]` blocks.
///
/// # Errors
/// Fails if the case has faults, nothing to compare, or a path missing in the summary, or if the run or a study fails.
/// Values that disagree are no error: their verdict says so.
pub fn verify_case(source: &Source, overrides: &[String], settings: &Settings) -> Result<Vec<Verdict>, VerifyError> {
    let case = case::parse(source, overrides)?;
    let checks = case.verify.as_ref().map_or(&[][..], |block| &block.checks);
    let expected = case.expected.as_ref().filter(|expected| !expected.values.is_empty());
    if checks.is_empty() && expected.is_none() {
        return Err(VerifyError::Nothing(source.name.clone()));
    }
    let name = &case.problem.name;
    let mut recorder = Recorder::new(name, &case)?;
    let reads_run = |check: &Check| matches!(check, Check::Probe { .. } | Check::History { .. } | Check::Mode { .. });
    let mut verdicts = Vec::new();
    if expected.is_some() || checks.iter().any(reads_run) {
        let summary = run(&case.problem, settings, &mut [&mut recorder])?;
        if let Some(expected) = expected {
            let summary = serde_json::to_value(&summary);
            let summary = summary.map_err(|error| VerifyError::Check(format!("{name}: {error}")))?;
            verdicts.extend(of_summary(name, &summary, expected)?);
        }
    }
    let mut studies = Studies { source, overrides, case: &case, done: Vec::new(), own: None };
    for (index, check) in checks.iter().enumerate() {
        let computed = match check {
            Check::Probe { probe, time, .. } => recorder
                .probe(index, *time)
                .ok_or_else(|| VerifyError::Check(format!("{name}: no {}, t = {time}", probe.name)))?,
            Check::History { column, time, take, .. } => recorder.column(column, *time, *take).ok_or_else(|| {
                VerifyError::Check(format!("{name}: history.csv has no {column} at t = {}", time.unwrap_or_default()))
            })?,
            Check::Mode { mode, is_frequency, .. } => recorder.mode(name, *mode, *is_frequency)?,
            Check::Order { study, error, .. } => studies.order(study, *error)?,
            Check::Error { error, .. } => studies.own_error(*error)?,
        };
        verdicts.push(verdict(name, title(check), computed, check.comparison()));
    }
    Ok(verdicts)
}

/// The quantity compared by a check.
fn title(check: &Check) -> String {
    match check {
        Check::Probe { probe, time, .. } => format!("{}, t = {time}", probe.name),
        Check::History { column, time, take, .. } => match (time, take) {
            (Some(t), _) => format!("{column} at t = {t}"),
            (None, ColumnTake::Last) => format!("{column} at the end"),
            (None, ColumnTake::Min) => format!("smallest {column}"),
            (None, ColumnTake::Max) => format!("largest {column}"),
        },
        Check::Mode { mode, is_frequency: true, .. } => format!("frequency of mode {mode}"),
        Check::Mode { mode, is_frequency: false, .. } => format!("growth of mode {mode}"),
        Check::Order { study, error, .. } => {
            let vary = match (study.vary, study.power) {
                (Vary::Both, 2) => "h with k ~ h²",
                (Vary::Both, _) => "h = k",
                (Vary::Space, _) => "h",
                (Vary::Time, _) => "k",
            };
            format!("order of {} in {vary}", error.name())
        }
        Check::Error { error, .. } => format!("{} on the mesh of the case", error.name()),
    }
}

/// Compares the values of `[expected]` with those of a summary, one verdict per component.
fn of_summary(name: &str, summary: &serde_json::Value, expected: &Expected) -> Result<Vec<Verdict>, VerifyError> {
    let mut verdicts = Vec::new();
    for (path, values) in &expected.values {
        let found = path.split('.').try_fold(summary, |value, key| value.get(key));
        let components = match found {
            Some(serde_json::Value::Array(all)) => all.iter().map(serde_json::Value::as_f64).collect(),
            Some(one) => one.as_f64().map(|one| vec![one]),
            None => None,
        };
        let is_array = found.is_some_and(serde_json::Value::is_array);
        let Some(components) = components.filter(|components| components.len() == values.len()) else {
            let of = |count: usize| format!("{count} number{}", if count == 1 { "" } else { "s" });
            let there = match found {
                None => "no such value".to_owned(),
                Some(serde_json::Value::Array(all)) => of(all.len()),
                Some(other) => other.to_string().chars().take(40).collect(),
            };
            return Err(VerifyError::Check(format!(
                "{name}: expected.values.\"{path}\": summary.json has {there} there, expected {}; take the path from summary.json of a run",
                of(values.len())
            )));
        };
        let scale = values.iter().fold(0.0f64, |scale, value| scale.max(value.abs()));
        for (c, (&computed, &reference)) in components.iter().zip(values).enumerate() {
            let what = if is_array { format!("{path}.{c}") } else { path.clone() };
            verdicts.push(verdict(
                name,
                what,
                computed,
                &Comparison { reference, tolerance: expected.tolerance, scale },
            ));
        }
    }
    Ok(verdicts)
}

/// The studies of a case; each is made once.
struct Studies<'a> {
    source: &'a Source,
    overrides: &'a [String],
    case: &'a Case,
    done: Vec<(StudyRequest, Vec<ErrorRow>)>,
    /// Errors with the mesh and steps of the case.
    own: Option<ErrorRow>,
}

impl Studies<'_> {
    /// The least-squares order of an error.
    fn order(&mut self, request: &StudyRequest, error: ErrorName) -> Result<f64, VerifyError> {
        if !self.done.iter().any(|(done, _)| done == request) {
            let table = case::study(self.source, self.overrides, request)?.run(&StudySettings::default())?;
            self.done.push((request.clone(), table.rows));
        }
        let rows = self.done.iter().find(|(done, _)| done == request).map_or(&[][..], |(_, rows)| rows);
        let size = |row: &ErrorRow| if request.vary == Vary::Time { row.k } else { row.h };
        Ok(slope(&rows.iter().map(|row| (size(row), error.of(row))).collect::<Vec<_>>()))
    }

    /// An error against the exact solution with the mesh and steps of the case.
    fn own_error(&mut self, error: ErrorName) -> Result<f64, VerifyError> {
        if self.own.is_none() {
            self.own = Some(own_errors(&self.case.problem.name, self.case)?);
        }
        Ok(self.own.as_ref().map_or(f64::NAN, |row| error.of(row)))
    }
}

fn verdict(name: &str, what: String, computed: f64, is: &Comparison) -> Verdict {
    let difference = (computed - is.reference).abs();
    let error = if difference == 0.0 { 0.0 } else { difference / is.scale };
    // Not `error > tolerance`: a NaN must not hold.
    let holds = error <= is.tolerance;
    Verdict {
        benchmark: name.to_owned(),
        what,
        computed,
        reference: is.reference,
        error,
        tolerance: is.tolerance,
        holds,
    }
}

/// Errors against the exact solution with the mesh and steps of the case.
fn own_errors(name: &str, case: &Case) -> Result<ErrorRow, VerifyError> {
    let Some(exact) = &case.exact else { return Err(VerifyError::Check(format!("{name} has no [exact] block"))) };
    let level = StudyLevel {
        level: case.cells.first().copied().unwrap_or_default(),
        problem: case.problem.clone(),
        text: case.fingerprint(),
        measured: None,
    };
    let study = Study { vary: Vary::Both, levels: vec![level], reference: Reference::Exact(exact.clone()) };
    let mut table = study.run(&StudySettings::default())?;
    table.rows.pop().ok_or_else(|| VerifyError::Check(format!("{name}: an empty study")))
}

/// Records the data for the checks of a benchmark, step by step.
struct Recorder {
    columns: Vec<String>,
    times: Vec<f64>,
    /// One row per step.
    history: Vec<Vec<f64>>,
    set: ProbeSet,
    /// Values of each probe, by the index of its check: one value per time, including t = 0.
    probes: Vec<(usize, Vec<f64>)>,
    /// What modes are looked for, if a check names one, and those found.
    wanted: Option<Search>,
    modes: Option<Result<Modes, StabilityError>>,
}

impl Recorder {
    fn new(name: &str, case: &Case) -> Result<Recorder, VerifyError> {
        let checks = case.verify.iter().flat_map(|v| v.checks.iter().enumerate());
        let (probes, indices): (Vec<Probe>, Vec<usize>) = checks
            .filter_map(
                |(i, check)| if let Check::Probe { probe, .. } = check { Some((probe.clone(), i)) } else { None },
            )
            .unzip();
        let names_mode = case.verify.iter().flat_map(|v| &v.checks).any(|check| matches!(check, Check::Mode { .. }));
        let failed = |(i, error): (usize, ProbeError)| {
            VerifyError::Check(format!("{name}: {}: {error}", probes.get(i).map_or("", |probe| &probe.name)))
        };
        Ok(Recorder {
            columns: history_columns(&case.problem),
            times: Vec::new(),
            history: Vec::new(),
            set: ProbeSet::new(&case.problem, &probes).map_err(failed)?,
            probes: indices.into_iter().map(|i| (i, Vec::new())).collect(),
            wanted: names_mode.then(|| case.stability.clone()),
            modes: None,
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

    /// A value of a mode.
    fn mode(&self, name: &str, number: usize, is_frequency: bool) -> Result<f64, VerifyError> {
        let failed = |error: String| VerifyError::Check(format!("{name}: {error}"));
        let modes = match &self.modes {
            Some(Ok(modes)) if modes.missing() == 0 => &modes.modes,
            Some(Ok(modes)) => return Err(failed(format!("the count finds {} more modes", modes.missing()))),
            Some(Err(error)) => return Err(failed(error.to_string())),
            None => return Err(failed("no state to find modes of".to_owned())),
        };
        let mode = number.checked_sub(1).and_then(|at| modes.get(at));
        let mode = mode.ok_or_else(|| failed(format!("found {} modes, expected mode {number}", modes.len())))?;
        Ok(if is_frequency { mode.hertz() } else { mode.growth })
    }

    fn column(&self, name: &str, time: Option<f64>, take: ColumnTake) -> Option<f64> {
        let column = self.columns.iter().position(|c| c == name)?;
        let values: Vec<f64> = self.history.iter().map(|row| row[column]).collect();
        match (time, take) {
            (Some(t), _) => interpolate(self.times.get(1..)?, &values, t),
            (None, ColumnTake::Last) => values.last().copied(),
            (None, ColumnTake::Min) => values.iter().copied().reduce(f64::min),
            (None, ColumnTake::Max) => values.iter().copied().reduce(f64::max),
        }
    }
}

/// Linear interpolation in time; `None` outside the range.
fn interpolate(times: &[f64], values: &[f64], t: f64) -> Option<f64> {
    let slack = 1e-12 * times.last()?.abs();
    let after = times.iter().position(|&time| time >= t - slack)?;
    if after == 0 {
        return values.first().copied().filter(|_| (times[0] - t).abs() <= slack);
    }
    let (t0, t1) = (times[after - 1], times[after]);
    let share = ((t - t0) / (t1 - t0)).clamp(0.0, 1.0);
    // A value unknown at t = 0 does not count at the end of the first step.
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

    fn last(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        if let (Some(wanted), Some(report)) = (&self.wanted, last.report) {
            let wanted = wanted.wanted(last.problem, None);
            self.modes = Some(modes(last.problem, last.discretization, last.state, report, &wanted));
        }
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
