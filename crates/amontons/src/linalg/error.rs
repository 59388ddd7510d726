//! Errors of linear systems.

/// Reason why a linear system could not be factorized or solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// A pivot was not positive: the matrix is not positive definite.
    #[error(
        "the matrix is not positive definite: pivot {pivot} of {size} is not positive; a body that no side holds needs inertia: a larger density or shorter steps"
    )]
    NotPositive {
        /// Number of the pivot in elimination order.
        pivot: usize,
        /// Size of the matrix.
        size: usize,
    },
    /// The factor does not fit into memory.
    #[error("the factor of {size} unknowns does not fit into memory: take an iteration, solver.solver = \"iterative\"")]
    Memory {
        /// Size of the matrix.
        size: usize,
    },
    /// The solution found leaves a large part of the right-hand side: the system is singular.
    #[error("the linearised system of {size} unknowns is singular")]
    Singular {
        /// Unknowns of the system.
        size: usize,
    },
    /// The computation was asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// A library that solves the systems failed.
    #[error("the library that solves the linear systems failed: {message}")]
    Library {
        /// What it says.
        message: String,
    },
    /// An iteration did not reach the requested residual.
    #[error(
        "the linear system of {size} unknowns is not solved after {iterations} iterations: relative residual {residual:.3e}"
    )]
    NotConverged {
        /// Unknowns of the system.
        size: usize,
        /// Iterations made.
        iterations: usize,
        /// ‖b − A x‖ / ‖b‖.
        residual: f64,
    },
}

impl SolveError {
    /// True if no solution of this system was found but that of another system may be. Lack of memory and interruption
    /// end every attempt.
    #[must_use]
    pub fn is_unsolved(&self) -> bool {
        match self {
            SolveError::NotPositive { .. } | SolveError::Singular { .. } | SolveError::NotConverged { .. } => true,
            SolveError::Memory { .. } | SolveError::Interrupted | SolveError::Library { .. } => false,
        }
    }
}
