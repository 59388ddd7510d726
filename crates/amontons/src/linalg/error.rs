//! Why a linear system could not be solved.

/// Why a linear system could not be factorized or solved.
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
    /// The factor does not fit.
    #[error("the factor of {size} unknowns does not fit into memory: take an iteration, solver.solver = \"iterative\"")]
    Memory {
        /// Size of the matrix.
        size: usize,
    },
    /// What was found leaves much of the right-hand side.
    #[error("the linearised system of {size} unknowns is singular")]
    Singular {
        /// Unknowns of the system.
        size: usize,
    },
    /// It was asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// An iteration did not end.
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
    /// Whether the system has no solution that was found; another one may be solved. Everything else, an interruption
    /// or a lack of memory, is so whatever is tried.
    #[must_use]
    pub fn is_unsolved(&self) -> bool {
        match self {
            SolveError::NotPositive { .. } | SolveError::Singular { .. } | SolveError::NotConverged { .. } => true,
            SolveError::Memory { .. } | SolveError::Interrupted => false,
        }
    }
}
