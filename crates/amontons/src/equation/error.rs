//! Errors of a step and of the setup of a scheme.

use crate::contact::Status;
use crate::inclusion::NotConverged;
use crate::linalg::SolveError;
use crate::problem::{Coupling, Faults, Uncovered};
use crate::state::Contraction;
use crate::tensor::Point;

/// Reason why a step could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The iteration on Γ_C did not converge.
    #[error(
        "step {step} (t = {t:.6e}): {part} did not converge in {} iterations{}; relative residual {:.3e}; contact points {} open, {} stick, {} slip{unsettled}",
        .why.iterations,
        if *.parts > 1 { format!(", not even in a part of 1/{} of the step: the step and its longer parts were tried before", .parts) } else { String::new() },
        .why.residual, .why.count(Status::Open), .why.count(Status::Stick), .why.count(Status::Slip)
    )]
    NotConverged {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// `mechanics` or `heat`.
        part: &'static str,
        /// Number of parts of the step, one of which was tried: more than one if the step was halved.
        parts: usize,
        /// Iterations, residual and contact pattern.
        why: Box<NotConverged>,
        /// The contact points whose states did not settle, in words; empty if all did.
        unsettled: String,
        /// True if no point sticks of a body without inertia that is supported by contact only: it may slide away.
        slides: bool,
    },
    /// Loads drive strain-free motions that no support and no contact resists.
    #[error("step {step} (t = {t:.6e}): a load drives what no support and no contact holds: {motions}")]
    Driven {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// The motions in words.
        motions: String,
    },
    /// A section does not reach the tension however far its sides are drawn together, or a body does not reach the
    /// force however far an obstacle is pressed in.
    #[error(
        "step {step} (t = {t:.6e}): {at}: {}{reached:.6e} N, expected {force:.6e} N: {}",
        if at.ends_with("preload") { "the section bears " } else { "the body bears " },
        if at.ends_with("preload") {
            "nothing holds its sides apart as they are drawn together"
        } else {
            "nothing resists the obstacle as it moves along the force"
        }
    )]
    Unborne {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// Dotted path of the force in the case file.
        at: String,
        /// The prescribed force, N per unit of thickness in two dimensions.
        force: f64,
        /// The force reached, N per unit of thickness in two dimensions.
        reached: f64,
    },
    /// The solution of the step does not satisfy its equations: the system is too ill-conditioned.
    #[error(
        "step {step} (t = {t:.6e}): {part} leaves a relative residual of {residual:.3e}, expected below {accepted:.0e}"
    )]
    Residual {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// `mechanics` or `heat`.
        part: &'static str,
        /// The residual.
        residual: f64,
        /// Largest accepted residual.
        accepted: f64,
    },
    /// A linear system of the step could not be solved.
    #[error("step {step} (t = {t:.6e}): {part}: {source}")]
    Linear {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// `mechanics` or `heat`.
        part: &'static str,
        /// Error of the linear solver.
        source: SolveError,
    },
    /// The tangent of laws that are not linear could not be factorized.
    #[error("step {step} (t = {t:.6e}): the tangent of the body: {source}")]
    Singular {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// Error of the factorization.
        source: SolveError,
    },
    /// The coupling of the half-steps did not converge.
    #[error(
        "step {step} (t = {t:.6e}): the {coupling} coupling of mechanics and heat did not converge in {passes} passes: defect {defect:.3e}{}; {}",
        .contraction.map(|c| format!(", mean contraction factor {:.3}, largest {:.3}", c.mean, c.largest)).unwrap_or_default(),
        match .coupling { Coupling::FixedPoint => "take scheme.coupling = \"monolithic\" or more steps", _ => "take more steps" }
    )]
    Coupling {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// The requested coupling.
        coupling: Coupling,
        /// Passes over both half-steps.
        passes: usize,
        /// Remaining defect.
        defect: f64,
        /// Observed contraction factors.
        contraction: Option<Contraction>,
    },
    /// No steady state was found.
    #[error(
        "step {step} (t = {t:.6e}): no steady state was found in {passes} passes of mechanics and heat, defect {defect:.3e}: there may be none, as above the critical speed of sliding, where the heat of friction presses the body on faster than it leaves; take a lower speed, or follow the heat in time with analysis = \"quasistatic\""
    )]
    NotSteady {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// Passes over both half-steps.
        passes: usize,
        /// Remaining defect.
        defect: f64,
    },
    /// A body sticks to a foundation that slides, and goes along with it without end.
    #[error(
        "step {step} (t = {t:.6e}): no steady state was found: the body sticks to a foundation that slides, at ({:.6e}, {:.6e}, {:.6e}) m with {:.3} of its velocity, and is drawn along without end, as where friction jams a body that cannot leave its foundation", .at[0], .at[1], .at[2], .share
    )]
    DrawnAlong {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// Position of the node that moves fastest, m.
        at: [f64; 3],
        /// Its velocity over the largest velocity of a foundation.
        share: f64,
    },
    /// A datum has no finite value at a position and time at which a step needs it.
    #[error("step {step} (t = {t:.6e}): {key} is {value} at ({}, {}, {}), t = {t:?}: data must be finite wherever they act and at all times of the run", .at[0], .at[1], .at[2])]
    Data {
        /// The step n that failed.
        step: usize,
        /// The time at which the datum was evaluated, s.
        t: f64,
        /// Its dotted path in the case file.
        key: String,
        /// The value.
        value: f64,
        /// Position, m.
        at: Point,
    },
    /// A table of a material does not cover a temperature of the step.
    #[error(
        "step {step} (t = {t:.6e}): the temperature is {:?} at ({}, {}, {}), but the table of {} covers the temperatures from {:?} to {:?} only",
        .found.theta, .found.at[0], .found.at[1], .found.at[2], .found.key, .found.range[0], .found.range[1]
    )]
    Uncovered {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// The table and the temperature.
        found: Box<Uncovered>,
    },
    /// A number is infinite or not a number.
    #[error("step {step} (t = {t:.6e}): {part} has values that are not finite: data overflow or are not defined there")]
    NotFinite {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// `mechanics`, `heat`, `the data`, or `the foundation`: its gap, velocity, or nearest point.
        part: &'static str,
    },
}

impl StepError {
    /// True if the step was not made because it was asked to stop.
    #[must_use]
    pub fn is_interruption(&self) -> bool {
        matches!(
            self,
            StepError::Linear { source: SolveError::Interrupted, .. }
                | StepError::Singular { source: SolveError::Interrupted, .. }
        )
    }

    /// True if the equations of the step were not solved, or the attempt left the range of its data: a shorter step or
    /// another method may succeed. All other errors (interruption, data without a value, lack of memory) persist
    /// whatever is tried.
    #[must_use]
    pub fn is_unsolved(&self) -> bool {
        match self {
            StepError::NotConverged { .. }
            | StepError::Driven { .. }
            | StepError::Unborne { .. }
            | StepError::Residual { .. }
            | StepError::Coupling { .. }
            | StepError::NotSteady { .. }
            | StepError::DrawnAlong { .. }
            | StepError::Uncovered { .. }
            | StepError::NotFinite { .. } => true,
            StepError::Linear { source, .. } | StepError::Singular { source, .. } => source.is_unsolved(),
            StepError::Data { .. } => false,
        }
    }
}

/// Result of an attempt, or `None` if its equations were not solved. Any other error is returned.
pub(crate) fn tried<T>(made: Result<T, StepError>) -> Result<Option<T>, StepError> {
    match made {
        Ok(made) => Ok(Some(made)),
        Err(error) if error.is_unsolved() => Ok(None),
        Err(error) => Err(error),
    }
}

/// Reason why a scheme could not be set up.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// A system could not be factorized.
    #[error("the system of the {part} step: {source}")]
    Factor {
        /// `mechanical`, `heat`, or the inertia of the first.
        part: &'static str,
        /// Error of the factorization.
        source: SolveError,
    },
    /// Initial data are not finite.
    #[error("the initial {0} is not finite at every node")]
    Initial(&'static str),
    /// There is no equilibrium to start from, or it was not found.
    #[error("found no equilibrium to start from (initial.state): {source}")]
    Equilibrium {
        /// Error of the static step.
        source: Box<StepError>,
    },
    /// The problem that a scheme derives from the given one has faults.
    #[error(transparent)]
    Data(#[from] Faults),
}
