//! The instants of a run from `[time]` and `[[phase]]`.

use super::build::{self, Build};
use super::place::At;
use super::raw;

impl Build<'_> {
    /// Checks that the case says each instant once: by phases, or by the end and the steps.
    pub(super) fn instants(&mut self, raw: &raw::Case) {
        let (end, steps) = (raw.time.end, raw.time.steps);
        let analysis = raw.time.analysis.map(|analysis| analysis.quoted().to_owned());
        if raw.phase.is_empty() {
            if let Some(found) = analysis.filter(|_| !raw.time.inertia) {
                let found = format!("{found} with time.inertia = false");
                self.note("time.analysis", At::Value, found, "one of both", Some("remove time.inertia"));
            }
            self.accuracy("time", steps, raw.time.accuracy, None);
            return self.step_length("time.end", self.timeline.longest());
        }
        let given = [("end", end.map(|end| format!("{end:?}"))), ("steps", steps.map(told)), ("analysis", analysis)];
        for (key, found) in given.into_iter().filter_map(|(key, found)| Some((key, found?))) {
            let hint = format!("remove it: each [[phase]] has its `{key}`");
            self.note(&format!("time.{key}"), At::Value, format!("{found} beside phases"), "no such key", Some(&hint));
        }
        let are_chosen = raw.phase.iter().any(|phase| phase.steps.is_some_and(is_chosen));
        if let Some(accuracy) = raw.time.accuracy.filter(|_| !are_chosen) {
            self.beside_equal_steps("time", accuracy, "no phase with steps = \"auto\"");
        }
        for (i, phase) in raw.phase.iter().enumerate() {
            self.accuracy(&format!("phase[{i}]"), phase.steps, phase.accuracy, raw.time.accuracy);
        }
        self.phases(&raw.phase, raw.time.inertia);
    }

    fn phases(&mut self, phases: &[raw::RunPhase], inertia: bool) {
        let mut before = 0.0;
        for (i, phase) in phases.iter().enumerate() {
            let path = |key: &str| format!("phase[{i}].{key}");
            let quoted = format!("\"{}\"", phase.name.escape_debug());
            if !is_name(&phase.name) {
                let expected = "a letter, then letters, digits, `-` and `_`, at most 40";
                self.note(&path("name"), At::Value, &quoted, expected, Some("the name is used in files and in --set"));
            } else if phases.iter().take(i).any(|other| other.name == phase.name) {
                self.note(
                    &path("name"),
                    At::Value,
                    format!("{quoted} again"),
                    "a name of its own for each phase",
                    None,
                );
            }
            // The order of the phases is checked with the problem.
            if i == 0 || phase.end > before {
                let steps = build::steps(phase.steps, phase.accuracy).nominal();
                self.step_length(&path("end"), (phase.end - before) / steps as f64);
            }
            before = phase.end;
            if !inertia && phase.analysis != raw::PhaseAnalysis::Dynamic {
                let hint = "remove time.inertia, and say of each phase what acts";
                let found = format!("{} with time.inertia = false", phase.analysis.quoted());
                self.note(&path("analysis"), At::Value, found, "one of both", Some(hint));
            }
        }
    }

    /// Checks that chosen steps have an accuracy, and equal steps none.
    fn accuracy(&mut self, place: &str, steps: Option<raw::StepNumber>, own: Option<f64>, all: Option<f64>) {
        match steps {
            Some(steps) if is_chosen(steps) => {
                if own.or(all).is_none() {
                    let hint = format!("add `accuracy = 1e-3` to {place}, or give a number of equal steps");
                    let found = "\"auto\" without an accuracy";
                    let expected = "`accuracy` beside it, above 0 and at most 0.1";
                    self.note(&format!("{place}.steps"), At::Value, found, expected, Some(&hint));
                }
            }
            _ => {
                if let Some(accuracy) = own {
                    self.beside_equal_steps(place, accuracy, "equal steps");
                }
            }
        }
    }

    fn beside_equal_steps(&mut self, place: &str, accuracy: f64, beside: &str) {
        let hint = "remove it, or write steps = \"auto\": equal steps have no accuracy to keep";
        let found = format!("{accuracy:?} beside {beside}");
        self.note(&format!("{place}.accuracy"), At::Value, found, "no such key", Some(hint));
    }

    /// Checks that steps are long enough to divide by.
    fn step_length(&mut self, path: &str, k: f64) {
        if !(k.is_normal() && k.recip().is_finite()) {
            let expected = "a step length that is a normal number";
            self.note(path, At::Value, format!("steps of {k:?} s"), expected, None);
        }
    }
}

fn is_chosen(steps: raw::StepNumber) -> bool {
    matches!(steps, raw::StepNumber::Chosen(_))
}

/// The steps as the case has them.
fn told(steps: raw::StepNumber) -> String {
    match steps {
        raw::StepNumber::Equal(steps) => steps.to_string(),
        raw::StepNumber::Chosen(_) => "\"auto\"".to_owned(),
    }
}

/// True for a name that columns and overrides can have.
fn is_name(name: &str) -> bool {
    const LONGEST: usize = 40;
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.len() <= LONGEST
        && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_'))
}
