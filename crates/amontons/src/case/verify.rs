//! The `[verify]` block: what makes a case a benchmark.

use super::build::Build;
use super::check::nearest;
use super::place::At;
use super::raw;
use super::study::{ReferenceRequest, StudyRequest};
use crate::convergence::{Row, Vary};
use crate::output::{Probe, history_columns};
use crate::problem::ProblemData;

/// What makes a case a benchmark.
#[derive(Clone, Debug, PartialEq)]
pub struct Verify {
    /// What is shown, in one line.
    pub title: String,
    /// Where the reference values come from.
    pub source: String,
    /// The values to compare.
    pub checks: Vec<Check>,
}

/// A reference value with the deviation that is allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Reference value.
    pub reference: f64,
    /// Allowed deviation relative to `scale`.
    pub tolerance: f64,
    /// Magnitude that the deviation is relative to: that of the reference where the case gives none.
    pub scale: f64,
}

/// A value to compare.
#[derive(Clone, Debug, PartialEq)]
pub enum Check {
    /// A field at a point, on a side or in a region at a time.
    Probe {
        /// The field and the place; its name says both.
        probe: Probe,
        /// The time in s.
        time: f64,
        /// What it must be.
        is: Comparison,
    },
    /// A column of the history.
    History {
        /// The column.
        column: String,
        /// The time in s; none for an extreme or the last.
        time: Option<f64>,
        /// Which value where no time is given.
        take: Take,
        /// What it must be.
        is: Comparison,
    },
    /// The order of an error against the exact solution.
    Order {
        /// The study.
        study: StudyRequest,
        /// The error.
        error: ErrorName,
        /// What the order must be; the scale is 1.
        is: Comparison,
    },
    /// An error against the exact solution on the mesh of the case.
    Error {
        /// The error.
        error: ErrorName,
        /// What it must be.
        is: Comparison,
    },
}

/// Which value of a column is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Take {
    /// The last.
    Last,
    /// The smallest.
    Min,
    /// The largest.
    Max,
}

/// An error of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorName {
    /// ‖w − w^{hk}‖_H.
    W,
    /// ‖ε(u − u^{hk})‖.
    U,
    /// ‖θ − θ^{hk}‖_{L²}.
    Theta,
    /// ‖u − u^{hk}‖_H.
    UH,
    /// E^{hk} of (5.2).
    Sum,
}

impl ErrorName {
    /// The name of the column in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            ErrorName::W => "error_w",
            ErrorName::U => "error_u",
            ErrorName::Theta => "error_theta",
            ErrorName::UH => "error_u_h",
            ErrorName::Sum => "error",
        }
    }

    /// The error in a row.
    #[must_use]
    pub fn of(self, row: &Row) -> f64 {
        match self {
            ErrorName::W => row.error_w,
            ErrorName::U => row.error_u,
            ErrorName::Theta => row.error_theta,
            ErrorName::UH => row.error_u_h,
            ErrorName::Sum => row.error,
        }
    }
}

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
                    self.check_time(&path, *time, problem.k());
                }
                raw::Check::Order { .. } | raw::Check::Error { .. } if !has_exact => {
                    self.note(&format!("{path}.kind"), At::Value, "no [exact] to compare with", "a case with a solution in closed form", None);
                }
                raw::Check::Order { .. } | raw::Check::Error { .. } => {}
            }
            let probe = self.checked_probe(i, raw, problem);
            checks.extend(check(raw, probe));
        }
        Verify { title: raw.title.clone(), source: raw.source.clone(), checks }
    }

    /// Notes a time outside the interval for which there are values.
    fn check_time(&mut self, path: &str, time: Option<f64>, first: f64) {
        let slack = 1e-12 * self.end;
        if let Some(time) = time.filter(|_| !self.has_other_end).filter(|&time| !(first - slack..=self.end + slack).contains(&time)) {
            self.note(&format!("{path}.time"), At::Value, time.to_string(), format!("a time from {first} to time.end = {}", self.end), None);
        }
    }

    /// Notes a column that history.csv does not have.
    fn check_column(&mut self, path: &str, column: &str, problem: &ProblemData) {
        let columns = history_columns(problem);
        if !columns.iter().any(|known| known == column) {
            let words: Vec<&str> = columns.iter().map(String::as_str).collect();
            let hint = nearest(column, &words).map(|near| format!("did you mean \"{near}\"?"));
            let expected = format!("one of the columns of history.csv: {}", words.join(", "));
            self.note(&format!("{path}.column"), At::Value, format!("\"{}\"", column.escape_debug()), expected, hint.as_deref());
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
                raw::Take::Last => Take::Last,
                raw::Take::Min => Take::Min,
                raw::Take::Max => Take::Max,
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
        raw::Check::Error { error, reference, tolerance, scale } => Check::Error { error: (*error).into(), is: comparison(*reference, *tolerance, *scale) },
    })
}
