//! Consistency check of a results folder: files against their hashes, and figures against those computed from fields,
//! tables and checkpoint.
//!
//! Recomputed in every dimension are:
//!
//! | figures | from |
//! |---|---|
//! | `final` of `summary.json` | displacement, velocity, temperature of the last snapshot; contact points of the checkpoint |
//! | `energy`, `solver` of `summary.json` | the last row of `history.csv`; the checkpoint |
//! | von Mises stress, strain, stress and heat flux of the cells | displacement, velocity, temperature of each snapshot |
//! | kinetic and elastic energy and heat content of the rows | the snapshots at their steps |
//! | states and extremes of contact of the rows | the tables of contact points at their steps |
//! | closing error of every row | the energies and works of the row |
//! | `contact.csv`, the last row of `history.csv` | the checkpoint |

mod fields;
mod tables;

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use super::{Verdict, VerifyError, interpolate, verdict};
use crate::case::{self, Case, Check, ColumnTake, Comparison};
use crate::discretization::Discretization;
use crate::machine;
use crate::output::names::{CASE, CONTACT, HISTORY, SUMMARY, contact_file};
use crate::output::{
    self, Checkpoint, Inspection, LONGEST, ProbeSet, Snapshot, StoredFields, Work, history_columns, history_values,
};
use crate::problem::Problem;
use fields::Fields;
use tables::{Audit, NumberTable};

/// Relative difference allowed for a recomputed number: a few last bits.
const ROUND_OFF: f64 = 1e-12;

/// Largest differences per compared quantity, each with the largest number involved.
#[derive(Debug, Default)]
struct Differences {
    all: BTreeMap<String, (f64, f64)>,
}

impl Differences {
    /// Records a difference with the size of its numbers.
    fn note(&mut self, what: String, difference: f64, size: f64) {
        let (worst, scale) = self.all.entry(what).or_insert((0.0, 0.0));
        // A NaN is kept.
        if difference.abs() > *worst || difference.is_nan() {
            *worst = difference.abs();
        }
        *scale = scale.max(size.abs());
    }
}

/// Result of the check of a folder.
#[derive(Clone, Debug, Default)]
pub struct Recomputed {
    /// Recomputed figures, and comparisons requested by the case.
    pub verdicts: Vec<Verdict>,
    /// Faults of the files.
    pub faults: Vec<String>,
    /// Figures that were not checked, with the reason.
    pub unchecked: Vec<String>,
}

/// Checks the files of a results folder against their hashes, recomputes its figures from them, and makes the
/// comparisons of `[expected]` and `[verify]` of its case.
///
/// # Errors
/// Fails if the folder has no manifest. Damage is no error: it is reported in the result.
pub fn recompute(folder: &Path) -> Result<Recomputed, VerifyError> {
    let inspection = output::inspect(folder)?;
    let mut found = Recomputed { faults: inspection.faults.clone(), ..Recomputed::default() };
    let case = case::read(&folder.join(CASE), &[]);
    let name = case.as_ref().map_or_else(|_| "run".to_owned(), |case| case.problem.name.clone());
    found.compare(&name, "files as they were written", inspection.intact as f64, inspection.listed as f64);
    match case {
        Ok(case) => found.of_case(folder, &case, &inspection),
        Err(error) => found.faults.push(error.to_string()),
    }
    Ok(found)
}

impl Recomputed {
    /// True if all checks hold.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.faults.is_empty() && self.verdicts.iter().all(|verdict| verdict.holds)
    }

    /// Records a recomputed number.
    fn compare(&mut self, name: &str, what: impl Into<String>, computed: f64, reference: f64) {
        let is = Comparison { reference, tolerance: ROUND_OFF, scale: reference.abs() };
        self.verdicts.push(verdict(name, what.into(), computed, &is));
    }

    /// Records the largest difference of numbers, relative to the largest of them.
    fn differ(&mut self, name: &str, what: impl Into<String>, difference: f64, scale: f64) {
        let is = Comparison { reference: 0.0, tolerance: ROUND_OFF, scale };
        self.verdicts.push(verdict(name, what.into(), difference, &is));
    }

    fn of_case(&mut self, folder: &Path, case: &Case, inspection: &Inspection) {
        let problem = &case.problem;
        if output::sha256(case.fingerprint()) != inspection.input_sha256 {
            self.faults.push("case.toml or a file in inputs is not what the run was made with".to_owned());
        }
        let summary = self.summary(folder, problem, inspection);
        let mut phases = RunForms::of(problem);
        let checkpoint = match Checkpoint::read(folder, &case.identity()) {
            Ok(checkpoint) => checkpoint,
            Err(error) => {
                self.faults.push(error.to_string());
                None
            }
        };
        let checkpoint = checkpoint.filter(|checkpoint| {
            phases.ends = problem.timeline.ends_at(&checkpoint.state.pace);
            let fits = phases.at(checkpoint.state.step).map_or(Ok(()), |of| checkpoint.check(&of.forms, problem));
            fits.as_ref().err().into_iter().for_each(|error| self.faults.push(error.to_string()));
            fits.is_ok() && Some(checkpoint.state.step) == inspection.ended
        });
        let run = ResultFiles { folder, case, phases: &phases, inspection };
        let history = run.history(self);
        run.snapshots(history.as_ref(), self);
        match &checkpoint {
            Some(checkpoint) => run.end(checkpoint, history.as_ref(), summary.as_ref(), self),
            None => self.unchecked.push("final figures and contact.csv: there is no checkpoint of the end".to_owned()),
        }
        run.asked_for(checkpoint.as_ref(), history.as_ref(), summary.as_ref(), self);
        self.unchecked.push("times, memory, findings and warnings of summary.json: only their hash".to_owned());
    }

    /// The summary of a successfully finished run.
    fn summary(&mut self, folder: &Path, problem: &Problem, inspection: &Inspection) -> Option<Value> {
        let Some(ended) = inspection.ended else {
            self.faults.push(format!("the run has not ended; go on with: amontons resume {}", folder.display()));
            return None;
        };
        let text = machine::read_text(&folder.join(SUMMARY), LONGEST);
        let summary: Value = match text.map(|text| serde_json::from_str(&text)) {
            Ok(Ok(summary)) => summary,
            Ok(Err(error)) => {
                self.faults.push(format!("summary.json: {error}"));
                return None;
            }
            Err(error) => {
                self.faults.push(format!("summary.json cannot be read: {error}"));
                return None;
            }
        };
        let (steps, end) = (problem.timeline.steps(), problem.timeline.end());
        // The number of steps that are chosen is not known before: they end where the run does.
        let is_over = if problem.timeline.is_automatic() {
            summary["time"].as_f64().is_some_and(|time| (time - end).abs() <= ROUND_OFF * end)
        } else {
            ended == steps
        };
        match summary["outcome"].as_str() {
            Some("done") if is_over => {}
            outcome => self.faults.push(format!(
                "the run is {}: {ended} of {steps} steps are made",
                outcome.unwrap_or("without an outcome")
            )),
        }
        Some(summary)
    }
}

/// A problem with the conditions of a phase, and its forms.
struct PhaseForms {
    problem: Problem,
    forms: Discretization,
}

/// The problems and forms of all phases, or one if conditions do not change, with the last steps of the phases.
struct RunForms {
    phases: Vec<PhaseForms>,
    ends: Vec<usize>,
}

impl RunForms {
    fn of(problem: &Problem) -> RunForms {
        let phases = if problem.changes_conditions_of_run() { problem.timeline.phases().len() } else { 1 };
        let of = |phase: usize| {
            let problem = problem.in_phase(phase);
            PhaseForms { forms: Discretization::new(&problem), problem }
        };
        RunForms { phases: (0..phases).map(of).collect(), ends: problem.timeline.phase_ends() }
    }

    /// Those of the phase of a step.
    fn at(&self, step: usize) -> Option<&PhaseForms> {
        let phase = self.ends.iter().filter(|end| **end < step).count();
        self.phases.get(phase).or_else(|| self.phases.first())
    }
}

/// The files of a run.
struct ResultFiles<'a> {
    folder: &'a Path,
    case: &'a Case,
    /// The problem with the conditions of each phase; one if they do not change.
    phases: &'a RunForms,
    inspection: &'a Inspection,
}

impl ResultFiles<'_> {
    fn name(&self) -> &str {
        &self.case.problem.name
    }

    /// Reads `history.csv` and checks its rows.
    fn history(&self, found: &mut Recomputed) -> Option<NumberTable> {
        let table = match NumberTable::read(&self.folder.join(HISTORY)) {
            Ok(table) if table.names == history_columns(&self.case.problem) => table,
            Ok(_) => {
                found.faults.push("history.csv has other columns than the case".to_owned());
                return None;
            }
            Err(what) => {
                found.faults.push(format!("history.csv: {what}"));
                return None;
            }
        };
        let (steps, times) = (table.column("step"), table.column("t"));
        let problem = &self.case.problem;
        let is_chosen = problem.timeline.is_automatic();
        let in_order = steps.iter().zip(&times).enumerate().filter(|(i, (step, t))| {
            let before = i.checked_sub(1).map_or(0.0, |before| times[before]);
            let is_at = (**t - problem.timeline.time(*i + 1)).abs() <= ROUND_OFF * problem.timeline.end();
            (**step - (*i + 1) as f64).abs() < 0.5 && if is_chosen { **t > before } else { is_at }
        });
        let ended = self.inspection.ended.unwrap_or(table.rows.len()) as f64;
        found.compare(self.name(), "rows of history.csv in order", in_order.count() as f64, ended);
        let Audit { worst, allowed } = tables::audit(&table);
        let is = Comparison { reference: 0.0, tolerance: 1.0, scale: allowed };
        found.verdicts.push(verdict(self.name(), "energy identity of the rows".to_owned(), worst, &is));
        Some(table)
    }

    /// Checks each snapshot for consistency, and against the row of its step.
    fn snapshots(&self, history: Option<&NumberTable>, found: &mut Recomputed) {
        let (mut differences, stored) = (Differences::default(), StoredFields::of(self.folder));
        for &step in &self.inspection.snapshots {
            let file = stored.name(step);
            match Fields::read(&stored, step, &self.case.problem) {
                Ok(fields) => {
                    if let Some(PhaseForms { problem, forms }) = self.phases.at(step) {
                        fields.differences(forms, problem, &mut differences);
                    }
                }
                Err(what) => {
                    found.faults.push(format!("{file}: {what}"));
                    continue;
                }
            }
            let Some(row) = step.checked_sub(1).filter(|_| history.is_some()) else { continue };
            let Some(history) = history else { continue };
            let contact = self.folder.join(contact_file(step));
            if !self.case.problem.contacts.is_empty() {
                match NumberTable::read(&contact) {
                    Ok(points) => tables::contact(&points, &self.case.problem, (history, row), &mut differences),
                    Err(what) => found.faults.push(format!("{}: {what}", contact_file(step))),
                }
            }
            if let Ok(fields) = Fields::read(&stored, step, &self.case.problem)
                && let Some(PhaseForms { problem, forms }) = self.phases.at(step)
            {
                fields.energies(forms, problem, (history, row), &mut differences);
            }
        }
        for (what, (difference, scale)) in differences.all {
            found.differ(self.name(), what, difference, scale);
        }
    }

    /// Checks the figures at the end of the run.
    fn end(
        &self,
        checkpoint: &Checkpoint,
        history: Option<&NumberTable>,
        summary: Option<&Value>,
        found: &mut Recomputed,
    ) {
        let Some(PhaseForms { problem, forms }) = self.phases.at(checkpoint.state.step) else { return };
        let name = self.name();
        let mut state = checkpoint.state.clone();
        let stored = StoredFields::of(self.folder);
        let file = stored.name(state.step);
        match Fields::read(&stored, state.step, problem) {
            Ok(fields) => fields.put(problem, &mut state, &mut |what, difference, scale| {
                found.differ(name, format!("{what} of {file} against the checkpoint"), difference, scale);
            }),
            Err(_) => found.unchecked.push(format!("final figures from {file}: it cannot be read")),
        }
        let now = Snapshot {
            problem,
            discretization: forms,
            state: &state,
            report: checkpoint.report.as_ref(),
            work: Work::default(),
            scheme: None,
        };
        if let Some(summary) = summary {
            let mut figures = Vec::new();
            let of_last = serde_json::to_value(output::of_last(&now)).unwrap_or_default();
            flatten("final", &of_last, &summary["final"], &mut figures);
            let energy = state.ledger.clone();
            let [closing, heat] = [energy.relative_closing_error(), energy.relative_heat_closing_error()];
            let mut energy = serde_json::to_value(energy).unwrap_or_default();
            (energy["closing_error"], energy["heat_closing_error"]) = (closing.into(), heat.into());
            flatten("energy", &energy, &summary["energy"], &mut figures);
            let counts = serde_json::to_value(&state.counts).unwrap_or_default();
            flatten("solver", &counts, &summary["solver"], &mut figures);
            for (what, computed, reference) in figures {
                match reference {
                    Some(reference) => found.compare(name, what, computed, reference),
                    None => found.faults.push(format!("summary.json has no number {what}, expected {computed:e}")),
                }
            }
            found.compare(name, "steps", state.step as f64, summary["steps"].as_f64().unwrap_or(f64::NAN));
            found.compare(name, "time", state.t, summary["time"].as_f64().unwrap_or(f64::NAN));
        }
        if let (Some(history), Some(values)) = (history, history_values(&now)) {
            let last = history.rows.last().map_or(&[][..], Vec::as_slice);
            let pairs = values.iter().zip(last);
            // Words are NaN.
            let is_same = |(a, b): &(&f64, &f64)| (*a - *b).abs() <= ROUND_OFF * a.abs() || a.is_nan() && b.is_nan();
            let same = pairs.filter(is_same).count();
            found.compare(name, "last row of history.csv against the checkpoint", same as f64, values.len() as f64);
        }
        let text = machine::read_text(&self.folder.join(CONTACT), LONGEST).unwrap_or_default();
        let rows = output::contact_rows(&Snapshot { state: &checkpoint.state, ..now });
        let same = text.lines().skip(1).zip(&rows).filter(|(there, row)| there == row).count();
        let all = rows.len().max(text.lines().count().saturating_sub(1));
        found.compare(name, "rows of contact.csv against the checkpoint", same as f64, all as f64);
    }

    /// Makes the comparisons of `[expected]` and `[verify]` of the case.
    fn asked_for(
        &self,
        checkpoint: Option<&Checkpoint>,
        history: Option<&NumberTable>,
        summary: Option<&Value>,
        found: &mut Recomputed,
    ) {
        let set: Vec<&str> = self.inspection.overrides.iter().map(String::as_str).collect();
        let others = set.iter().filter(|set| !set.trim_start().starts_with("output")).count();
        if others > 0 && (self.case.expected.is_some() || self.case.verify.is_some()) {
            found
                .unchecked
                .push(format!("[expected] and [verify]: the case was run with --set {}", set.join(" --set ")));
            return;
        }
        if let (Some(expected), Some(summary)) = (&self.case.expected, summary) {
            match super::of_summary(self.name(), summary, expected) {
                Ok(verdicts) => found.verdicts.extend(verdicts),
                Err(error) => found.faults.push(error.to_string()),
            }
        }
        for check in self.case.verify.iter().flat_map(|verify| &verify.checks) {
            let what = super::title(check);
            let computed = match check {
                Check::History { column, time, take, .. } => history.and_then(|h| h.take(column, *time, *take)),
                // A folder does not keep the slopes of the laws at its last step.
                Check::Mode { .. } => None,
                Check::Probe { probe, time, .. } => checkpoint.and_then(|end| {
                    let PhaseForms { problem, forms } = self.phases.at(end.state.step)?;
                    let now = Snapshot {
                        problem,
                        discretization: forms,
                        state: &end.state,
                        report: end.report.as_ref(),
                        work: Work::default(),
                        scheme: None,
                    };
                    let set = ProbeSet::new(&self.case.problem, std::slice::from_ref(probe)).ok()?;
                    let at_end = (end.state.t - time).abs() <= ROUND_OFF * time.abs();
                    at_end.then(|| set.values(&now).first().copied()).flatten()
                }),
                Check::Order { .. } | Check::Error { .. } => None,
            };
            match computed {
                Some(computed) => found.verdicts.push(verdict(self.name(), what, computed, check.comparison())),
                None => found
                    .unchecked
                    .push(format!("{what}: its value is not in the files; run `amontons verify` with the case file")),
            }
        }
    }
}

/// The numbers of a value with their paths, paired with those of another value; `None` for missing ones.
fn flatten(place: &str, value: &Value, beside: &Value, all: &mut Vec<(String, f64, Option<f64>)>) {
    match value {
        Value::Number(number) => all.push((place.to_owned(), number.as_f64().unwrap_or(f64::NAN), beside.as_f64())),
        Value::Array(values) => {
            for (i, value) in values.iter().enumerate() {
                flatten(&format!("{place}.{i}"), value, beside.get(i).unwrap_or(&Value::Null), all);
            }
        }
        Value::Object(values) => {
            for (key, value) in values {
                flatten(&format!("{place}.{key}"), value, beside.get(key).unwrap_or(&Value::Null), all);
            }
        }
        Value::Null if !beside.is_null() => all.push((place.to_owned(), f64::NAN, beside.as_f64().or(Some(0.0)))),
        _ => {}
    }
}

impl NumberTable {
    /// A value of a column as requested by a check.
    fn take(&self, name: &str, time: Option<f64>, take: ColumnTake) -> Option<f64> {
        self.names.iter().any(|n| n == name).then_some(())?;
        let values = self.column(name);
        match (time, take) {
            (Some(t), _) => interpolate(&self.column("t"), &values, t),
            (None, ColumnTake::Last) => values.last().copied(),
            (None, ColumnTake::Min) => values.into_iter().reduce(f64::min),
            (None, ColumnTake::Max) => values.into_iter().reduce(f64::max),
        }
    }
}
