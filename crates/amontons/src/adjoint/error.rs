//! Reasons why there is no derivative.

use crate::equation::{SetupError, StepError};
use crate::linalg::SolveError;
use crate::problem::Fault;

/// Reason why the derivatives of a run cannot be computed.
#[derive(Debug, thiserror::Error)]
pub enum GradientError {
    /// The problem has something whose derivative is not there, an output is none, or a parameter cannot be changed.
    #[error(transparent)]
    Refused(#[from] Box<RefusedGradient>),
    /// The scheme could not be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A step of the run failed.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A system with a transposed matrix was not solved.
    #[error("step {step}: the transposed system of {part}: {source}")]
    Linear {
        /// The step n.
        step: usize,
        /// `mechanics`, `heat` or `driven contacts`.
        part: &'static str,
        /// The cause.
        source: SolveError,
    },
    /// The derivative is asked for where a law has none on either side.
    #[error("step {step}: the laws of the contact point ({}, {}, {}) have a kink where it is", .x[0], .x[1], .x[2])]
    Kink {
        /// The step n.
        step: usize,
        /// The contact point, m.
        x: [f64; 3],
    },
    /// The run was asked to stop.
    #[error("interrupted")]
    Interrupted,
}

/// A refusal: the place, the value found, the expected ones, and a hint.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct RefusedGradient(pub Fault);

impl GradientError {
    /// A refusal.
    pub(crate) fn refused(fault: Fault) -> GradientError {
        GradientError::Refused(Box::new(RefusedGradient(fault)))
    }
}
