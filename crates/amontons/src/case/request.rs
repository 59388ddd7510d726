//! What a study of a case is to be.

use super::fault::CaseError;
use crate::convergence::Vary;

/// A study to be made of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyRequest {
    /// What is refined.
    pub vary: Vary,
    /// Cells per side of each level (steps where only time is refined), coarsest first.
    pub levels: Vec<usize>,
    /// What the levels are compared with.
    pub reference: ReferenceRequest,
    /// With mesh and step together: the steps grow with this power of the cells.
    pub power: u32,
}

/// What the levels of a study are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceRequest {
    /// The finest of the levels, which then has no error of its own.
    Finest,
    /// A level finer than all.
    Level(usize),
    /// The `[exact]` of the case.
    Exact,
}

/// Why no study can be made.
#[derive(Debug, thiserror::Error)]
pub enum StudyRequestError {
    /// The case has faults.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The request does not fit the case.
    #[error("{found}, expected {expected}")]
    Request {
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
}
