//! The instants of a run from `[time]` and `[[phase]]`.

use super::build::Build;
use super::place::At;
use super::raw;

impl Build<'_> {
    /// Checks that the case says each instant once: by phases, or by the end and the number of equal steps.
    pub(super) fn instants(&mut self, raw: &raw::Case) {
        let (end, steps) = (raw.time.end, raw.time.steps);
        let analysis = raw.time.analysis.map(|analysis| analysis.quoted().to_owned());
        if raw.phase.is_empty() {
            if let Some(found) = analysis.filter(|_| !raw.time.inertia) {
                let found = format!("{found} with time.inertia = false");
                self.note("time.analysis", At::Value, found, "one of both", Some("remove time.inertia"));
            }
            return self.step_length("time.end", self.timeline.longest());
        }
        let given = [
            ("end", end.map(|end| format!("{end:?}"))),
            ("steps", steps.map(|steps| steps.to_string())),
            ("analysis", analysis),
        ];
        for (key, found) in given.into_iter().filter_map(|(key, found)| Some((key, found?))) {
            let hint = format!("remove it: each [[phase]] has its `{key}`");
            self.note(&format!("time.{key}"), At::Value, format!("{found} beside phases"), "no such key", Some(&hint));
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
                self.step_length(&path("end"), (phase.end - before) / phase.steps.unwrap_or(1) as f64);
            }
            before = phase.end;
            if !inertia && phase.analysis != raw::PhaseAnalysis::Dynamic {
                let hint = "remove time.inertia, and say of each phase what acts";
                let found = format!("{} with time.inertia = false", phase.analysis.quoted());
                self.note(&path("analysis"), At::Value, found, "one of both", Some(hint));
            }
        }
    }

    /// Checks that steps are long enough to divide by.
    fn step_length(&mut self, path: &str, k: f64) {
        if !(k.is_normal() && k.recip().is_finite()) {
            let expected = "a step length that is a normal number";
            self.note(path, At::Value, format!("steps of {k:?} s"), expected, None);
        }
    }
}

/// True for a name that columns and overrides can have.
fn is_name(name: &str) -> bool {
    const LONGEST: usize = 40;
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.len() <= LONGEST
        && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_'))
}
