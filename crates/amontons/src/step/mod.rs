//! Time stepping: Problem 4.1, one step after the other.

mod alone;
mod change;
mod chosen;
mod coupling;
mod datum;
mod end;
mod initial;
mod linearised;
mod march;
mod steady;

pub use crate::equation::{Kept, KeptRule};
pub(crate) use alone::across_gaps;
pub(crate) use initial::state as initial_state;
pub(crate) use march::EquilibriumStep;
pub use march::March;

use std::fmt;
use std::sync::Arc;

use crate::discretization::Discretization;
use crate::equation::{SetupError, Solvers, StepError, StepInputs};
use crate::linalg::Backend;
use crate::problem::Problem;
use crate::pulse::Pulse;
use crate::state::{State, StepReport};

/// Makes the scheme that steps a problem with these forms through time, with the backend that solves its linear
/// systems: the setting of runs and studies, [`March::make`] by default.
pub type MakeScheme = fn(&Problem, &Arc<Discretization>, &Arc<dyn Backend>) -> Result<Box<dyn Scheme>, SetupError>;

/// A time-stepping scheme for a problem.
pub trait Scheme: fmt::Debug + Send + Sync {
    /// The discrete problem.
    fn discretization(&self) -> &Discretization;
    /// The problem with the conditions of the phase of the last step, or `None` if the scheme has those of the first
    /// phase in all of them.
    fn problem(&self) -> Option<&Problem> {
        None
    }
    /// The state at t = 0, (4.3).
    ///
    /// # Errors
    /// If initial data are not finite.
    fn initial(&self) -> Result<State, SetupError>;
    /// Makes the next step and returns the new state.
    ///
    /// # Errors
    /// If the step does not converge or is not finite. There is then no new state.
    fn step(&mut self, state: &State) -> Result<(State, StepReport), StepError>;
    /// The systems of the scheme and the work done with them so far.
    fn solvers(&self) -> Solvers;
    /// Factorizations that a resumed run has to repeat.
    fn kept(&self) -> Kept {
        Kept::default()
    }
    /// Repeats the factorizations of the matrices that the previous run had kept, and treats its tangents as
    /// factorized.
    ///
    /// # Errors
    /// If a matrix cannot be factorized.
    fn recall(&mut self, _kept: &Kept) -> Result<(), SetupError> {
        Ok(())
    }
    /// Goes back to what it kept at an earlier state of this run, so that the next step from that state has the bits
    /// that it had then. Called after a failed step, too.
    ///
    /// # Errors
    /// If a matrix cannot be factorized.
    fn go_back(&mut self, kept: &Kept) -> Result<(), SetupError> {
        self.recall(kept)
    }
    /// Makes the steps from now on with these inputs. Returns false if the scheme has no use for them.
    fn take_inputs(&mut self, _inputs: &Arc<StepInputs>) -> bool {
        false
    }
    /// Reports the progress of each step to `pulse` from now on.
    fn watched_by(&mut self, _pulse: &Pulse) {}
}
