//! Requests for a convergence study of a case.

use super::fault::CaseError;
use crate::convergence::Vary;

/// A study to be made of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyRequest {
    /// The refined quantity.
    pub vary: Vary,
    /// Cells per side of each level (steps if only time is refined), coarsest first.
    pub levels: Vec<usize>,
    /// The reference for the errors.
    pub reference: ReferenceRequest,
    /// If mesh and step are refined together: the steps grow with this power of the cells.
    pub power: u32,
}

/// The reference for the errors of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceRequest {
    /// The finest of the levels, which then has no error of its own.
    Finest,
    /// A level finer than all.
    Level(usize),
    /// The `[exact]` of the case.
    Exact,
}

/// The reason why a study cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum StudyRequestError {
    /// The case has faults.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The request does not fit the case.
    #[error("{found}, expected {expected}")]
    Request {
        /// The value found.
        found: String,
        /// The values that are allowed.
        expected: String,
    },
}

/// The accuracy that a case asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct AskedAccuracy {
    /// Names of probes, or of columns of `history.csv` and `probes.csv`.
    pub of: Vec<String>,
    /// The largest error of each, relative to it.
    pub relative: f64,
    /// True if cells and steps are refined already.
    pub refined: bool,
}
