//! Time stepping: Problem 4.1, one step after the other.

mod discretization;
mod euler;
mod ledger;

pub use discretization::Discretization;
pub use euler::{ACCEPTED, BackwardEuler, REFINE};
pub use ledger::Ledger;

use crate::contact::Flux;
use crate::linalg::{FactorError, Multipliers, NotConverged, PointState};

/// The state at a time t_n: what the next step starts from.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// n.
    pub step: usize,
    /// t_n in s.
    pub t: f64,
    /// u_n in m, node-major.
    pub u: Vec<f64>,
    /// w_n in m/s, node-major.
    pub w: Vec<f64>,
    /// θ_n in K.
    pub theta: Vec<f64>,
    /// Friction multipliers at the contact points.
    pub multipliers: Multipliers,
    /// Energies and flows since the start.
    pub ledger: Ledger,
    /// Newton iterations since the start.
    pub counts: Counts,
}

/// Counted work since the start of a run.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Counts {
    /// Newton iterations of mechanical steps.
    pub newton_mechanics_total: usize,
    /// Most Newton iterations of one mechanical step.
    pub newton_mechanics_max: usize,
    /// Newton iterations of heat steps.
    pub newton_heat_total: usize,
    /// Sweeps over a factor, forward or backward.
    pub sweeps: usize,
    /// Largest residual of an accepted step, relative to its largest term.
    pub residual_max: f64,
}

/// What happened in one step.
#[derive(Clone, Debug)]
pub struct StepReport {
    /// Newton iterations on Γ_C, mechanics.
    pub newton_mechanics: usize,
    /// Newton iterations on Γ_C, heat.
    pub newton_heat: usize,
    /// Residual of (4.1), (4.2), complementarity and cone, relative to the largest term.
    pub residual: f64,
    /// The contact points.
    pub contact: ContactReport,
}

/// State of the contact points.
#[derive(Clone, Debug, Default)]
pub struct ContactReport {
    /// Kinematics and tractions.
    pub states: Vec<PointState>,
    /// Temperature of the body at each point, K.
    pub temperature: Vec<f64>,
    /// Heat flux q·ν at each point.
    pub flux: Vec<Flux>,
    /// Resultant of σν on Γ_C, N per unit of thickness in two dimensions.
    pub force: [f64; 3],
    /// ∫_{Γ_C} q·ν in W.
    pub heat_flow: f64,
}

/// Why a step could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The iteration on Γ_C did not end.
    #[error(
        "step {step} (t = {t:.6e} s): {part} did not converge in {} iterations; relative residual {:.3e}; contact points {} open, {} stick, {} slip",
        .why.iterations, .why.residual, .why.pattern[0], .why.pattern[1], .why.pattern[2]
    )]
    NotConverged {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// `mechanics` or `heat`.
        part: &'static str,
        /// Iterations, residual and contact pattern.
        why: NotConverged,
    },
    /// The solution of the step does not satisfy its equations: the system is too ill-conditioned.
    #[error("step {step} (t = {t:.6e} s): {part} leaves a relative residual of {residual:.3e}, expected below {accepted:.0e}")]
    Residual {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// `mechanics` or `heat`.
        part: &'static str,
        /// The residual.
        residual: f64,
        /// The residual that is accepted.
        accepted: f64,
    },
    /// A number is infinite or not a number.
    #[error("step {step} (t = {t:.6e} s): {part} has values that are not finite; the data grow beyond what a number can hold")]
    NotFinite {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// `mechanics`, `heat` or `the data`.
        part: &'static str,
    },
}

/// Why a scheme could not be set up.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// A system could not be factorized.
    #[error("the system of the {part} step: {source}")]
    Factor {
        /// `mechanical` or `heat`.
        part: &'static str,
        /// Why.
        source: FactorError,
    },
    /// Initial data are not finite.
    #[error("the initial {0} is not finite at every node")]
    Initial(&'static str),
}

/// A time-stepping scheme for a problem.
pub trait Scheme {
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
}
