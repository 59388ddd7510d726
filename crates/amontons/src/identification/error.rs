//! Reasons why parameters cannot be identified.

use crate::adjoint::GradientError;
use crate::problem::Fault;

/// Reason why parameters cannot be identified.
#[derive(Debug, thiserror::Error)]
pub enum IdentificationError {
    /// The data, the parameters or their bounds cannot be used.
    #[error("{0}")]
    Data(Box<Fault>),
    /// A run or its derivatives failed at the parameters from which the descent starts or goes on.
    #[error("{0}")]
    Run(#[from] GradientError),
    /// No minimum was found.
    #[error(
        "no minimum in {steps} steps, with χ² = {chi_square:.6e}: start from other values (--set), give bounds, or free fewer parameters"
    )]
    NoMinimum {
        /// Steps of Gauss–Newton.
        steps: usize,
        /// χ² after the last one.
        chi_square: f64,
    },
    /// The state of the descent could not be kept.
    #[error("{0}")]
    Kept(Box<dyn std::error::Error + Send + Sync>),
    /// The computation was asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl IdentificationError {
    /// A fault of what was asked for.
    pub(super) fn data(fault: Fault) -> IdentificationError {
        IdentificationError::Data(Box::new(fault))
    }
}
