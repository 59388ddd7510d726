//! Time stepping: Problem 4.1, one step after the other.

mod alone;
mod coupling;
mod datum;
mod march;

pub use march::March;

use std::fmt;
use std::sync::Arc;

use crate::discretization::Discretization;
use crate::equation::{SetupError, StepError};
use crate::linalg::{Account, Backend, Decided, TangentKey};
use crate::problem::Problem;
use crate::pulse::Pulse;
use crate::state::{State, StepReport};

/// Factorizations that a scheme keeps between steps and how it solves its systems, so that bits and counts of a run
/// that goes on are those of one without a break.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Kept {
    /// How many of the step lengths k/2, k/4, … have matrices.
    pub halvings: usize,
    /// The temperature of each system whose matrix was factorized anew for it; empty for others.
    #[serde(default)]
    pub temperatures: Vec<Vec<f64>>,
    /// The tangents on Γ_C of each system.
    pub tangents: Vec<Vec<TangentKey>>,
    /// How systems are solved, where the program has chosen.
    pub solvers: Vec<Decided>,
    /// The work of the iteration of each system.
    #[serde(default)]
    pub accounts: Vec<Account>,
}

/// Makes the scheme that steps a problem with these forms through time, with the backend that solves its linear
/// systems: the setting of runs and studies, [`March::make`] by default.
pub type MakeScheme = fn(&Problem, &Arc<Discretization>, &Arc<dyn Backend>) -> Result<Box<dyn Scheme>, SetupError>;

/// A time-stepping scheme for a problem.
pub trait Scheme: fmt::Debug + Send + Sync {
    /// The discrete problem.
    fn discretization(&self) -> &Discretization;
    /// The state at t = 0, (4.3).
    ///
    /// # Errors
    /// When initial data are not finite.
    fn initial(&self) -> Result<State, SetupError>;
    /// The state one step on.
    ///
    /// # Errors
    /// When the step does not converge or is not finite; there is then no new state.
    fn step(&mut self, state: &State) -> Result<(State, StepReport), StepError>;
    /// Factorizations of the matrices so far, and of contact systems.
    fn factorizations(&self) -> (usize, usize);
    /// What a run that goes on from here has to factorize again.
    fn kept(&self) -> Kept {
        Kept::default()
    }
    /// Makes the factorizations of the matrices that the run before had kept, and takes its tangents as factorized.
    ///
    /// # Errors
    /// When a matrix cannot be factorized.
    fn recall(&mut self, _kept: &Kept) -> Result<(), SetupError> {
        Ok(())
    }
    /// Tells from now on where each step is.
    fn watched_by(&mut self, _pulse: &Pulse) {}
    /// Unknowns of displacement, temperature and on Γ_C.
    fn unknowns(&self) -> [usize; 3];
    /// How systems are solved: `iterative` if one of them is, else `direct`.
    fn backend(&self) -> &'static str;
    /// Why: what either way was predicted to take, of the mechanical half-step where there is one.
    fn backend_reason(&self) -> String;
}
