//! The `[verify]` block: reference values that make a case a benchmark.

use std::collections::BTreeMap;

use super::request::StudyRequest;
use crate::convergence::ErrorRow;
use crate::output::Probe;

/// The reference values of a benchmark.
#[derive(Clone, Debug, PartialEq)]
pub struct Verify {
    /// The claim of the benchmark, in one line.
    pub title: String,
    /// Source of the reference values.
    pub source: String,
    /// The values to compare.
    pub checks: Vec<Check>,
}

/// A reference value with the allowed deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Reference value.
    pub reference: f64,
    /// Allowed deviation relative to `scale`.
    pub tolerance: f64,
    /// Magnitude to which the deviation is relative: by default the reference.
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
        /// The reference value.
        is: Comparison,
    },
    /// A column of the history.
    History {
        /// The column.
        column: String,
        /// The time in s, or `None` for an extreme or the last value.
        time: Option<f64>,
        /// Value taken if no time is given.
        take: ColumnTake,
        /// The reference value.
        is: Comparison,
    },
    /// The order of an error against the exact solution.
    Order {
        /// The study.
        study: StudyRequest,
        /// The error.
        error: ErrorName,
        /// The reference order; the scale is 1.
        is: Comparison,
    },
    /// A mode of the state at the end.
    Mode {
        /// Its number, from 1.
        mode: usize,
        /// True for its frequency in Hz, false for its growth in 1/s.
        is_frequency: bool,
        /// The reference value.
        is: Comparison,
    },
    /// An error against the exact solution on the mesh of the case.
    Error {
        /// The error.
        error: ErrorName,
        /// The reference value.
        is: Comparison,
    },
}

impl Check {
    /// The reference value with its tolerance.
    #[must_use]
    pub fn comparison(&self) -> &Comparison {
        match self {
            Check::Probe { is, .. }
            | Check::History { is, .. }
            | Check::Mode { is, .. }
            | Check::Order { is, .. }
            | Check::Error { is, .. } => is,
        }
    }
}

/// The value taken from a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnTake {
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
    pub fn of(self, row: &ErrorRow) -> f64 {
        match self {
            ErrorName::W => row.error_w,
            ErrorName::U => row.error_u,
            ErrorName::Theta => row.error_theta,
            ErrorName::UH => row.error_u_h,
            ErrorName::Sum => row.error,
        }
    }
}

/// Values that a run of a case must reproduce.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Allowed deviation, relative to the largest magnitude in the value.
    pub tolerance: f64,
    /// The values by their dotted path in `summary.json`, one entry per component.
    pub values: BTreeMap<String, Vec<f64>>,
}
