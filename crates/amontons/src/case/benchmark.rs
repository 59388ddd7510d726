//! `[verify]`: converts the raw checks to those of the library.

use super::build::Build;
use super::nearest::meant;
use super::place::At;
use super::raw;
use super::request::{ReferenceRequest, StudyRequest};
use super::verify::{Check, ColumnTake, Comparison, ErrorName, Verify};
use crate::convergence::Vary;
use crate::output::{Probe, history_columns};
use crate::problem::ProblemData;

fn comparison(reference: f64, tolerance: f64, scale: Option<f64>) -> Comparison {
    Comparison { reference, tolerance, scale: scale.unwrap_or(reference.abs()) }
}

impl From<raw::ErrorName> for ErrorName {
    fn from(raw: raw::ErrorName) -> ErrorName {
        match raw {
            raw::ErrorName::ErrorW => ErrorName::W,
            raw::ErrorName::ErrorU => ErrorName::U,
            raw::ErrorName::ErrorTheta => ErrorName::Theta,
            raw::ErrorName::ErrorUH => ErrorName::UH,
            raw::ErrorName::Error => ErrorName::Sum,
        }
    }
}

impl Build<'_> {
    /// The block; checks that have faults are left out.
    pub fn verify(&mut self, raw: &raw::Verify, problem: &ProblemData, has_exact: bool) -> Verify {
        let mut checks = Vec::new();
        for (i, raw) in raw.check.iter().enumerate() {
            let path = format!("verify.check[{i}]");
            match raw {
                raw::Check::Probe { time, .. } => self.check_time(&path, Some(*time), 0.0),
                raw::Check::History { column, time, .. } => {
                    self.check_column(&path, column, problem);
                    self.check_time(&path, *time, problem.timeline.time(1));
                }
                raw::Check::Order { .. } | raw::Check::Error { .. } if !has_exact => {
                    self.note(
                        &format!("{path}.kind"),
                        At::Value,
                        "no [exact] to compare with",
                        "a case with a solution in closed form",
                        None,
                    );
                }
                raw::Check::Mode { .. } | raw::Check::Order { .. } | raw::Check::Error { .. } => {}
            }
            let probe = self.checked_probe(i, raw, problem);
            checks.extend(check(raw, probe));
        }
        Verify { title: raw.title.clone(), source: raw.source.clone(), checks }
    }

    /// Notes a time outside the interval that has values.
    fn check_time(&mut self, path: &str, time: Option<f64>, first: f64) {
        let slack = 1e-12 * self.timeline.end();
        if let Some(time) = time
            .filter(|_| !self.has_other_end)
            .filter(|&time| !(first - slack..=self.timeline.end() + slack).contains(&time))
        {
            self.note(
                &format!("{path}.time"),
                At::Value,
                time.to_string(),
                format!("a time from {first} to time.end = {}", self.timeline.end()),
                None,
            );
        }
    }

    /// Notes a column that history.csv does not have.
    fn check_column(&mut self, path: &str, column: &str, problem: &ProblemData) {
        let columns = history_columns(problem);
        if !columns.iter().any(|known| known == column) {
            let words: Vec<&str> = columns.iter().map(String::as_str).collect();
            let hint = meant(column, &words);
            let expected = format!("one of the columns of history.csv: {}", words.join(", "));
            self.note(
                &format!("{path}.column"),
                At::Value,
                format!("\"{}\"", column.escape_debug()),
                expected,
                hint.as_deref(),
            );
        }
    }
}

fn check(raw: &raw::Check, probe: Option<Probe>) -> Option<Check> {
    Some(match raw {
        raw::Check::Probe { time, reference, tolerance, scale, .. } => {
            Check::Probe { probe: probe?, time: *time, is: comparison(*reference, *tolerance, *scale) }
        }
        raw::Check::History { column, time, take, reference, tolerance, scale } => Check::History {
            column: column.clone(),
            time: *time,
            take: match take {
                raw::Take::Last => ColumnTake::Last,
                raw::Take::Min => ColumnTake::Min,
                raw::Take::Max => ColumnTake::Max,
            },
            is: comparison(*reference, *tolerance, *scale),
        },
        raw::Check::Order { vary, levels, power, error, reference, tolerance } => Check::Order {
            study: StudyRequest {
                vary: match vary {
                    raw::Vary::Both => Vary::Both,
                    raw::Vary::Space => Vary::Space,
                    raw::Vary::Time => Vary::Time,
                },
                levels: levels.clone(),
                reference: ReferenceRequest::Exact,
                power: *power,
            },
            error: (*error).into(),
            is: comparison(*reference, *tolerance, Some(1.0)),
        },
        raw::Check::Mode { mode, of, reference, tolerance, scale } => Check::Mode {
            mode: *mode,
            is_frequency: matches!(of, raw::ModeValue::Frequency),
            is: comparison(*reference, *tolerance, *scale),
        },
        raw::Check::Error { error, reference, tolerance, scale } => {
            Check::Error { error: (*error).into(), is: comparison(*reference, *tolerance, *scale) }
        }
    })
}
