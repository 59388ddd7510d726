//! Time stepping: Problem 4.1, one step after the other.

mod alone;
mod apart;
mod audit;
mod coupling;
mod datum;
mod euler;
mod fluid;
mod foundation;
mod given;
mod heat;
mod ledger;
mod mechanics;
mod mixing;
mod system;

pub use crate::discretization::Discretization;
pub use apart::{Carried, Rigid};
pub use euler::BackwardEuler;
pub use foundation::Accumulated;
pub use ledger::Ledger;
pub use system::{ACCEPTED, REFINE};

use std::fmt;
use std::sync::Arc;

use crate::contact::{ContactBoundary, Flux, Status};
use crate::inclusion::{Multipliers, NotConverged, PointState};
use crate::linalg::{Account, Backend, Decided, SolveError, TangentKey};
use crate::problem::{Coupling, Faults, Problem, Uncovered};
use crate::pulse::Pulse;
use crate::tensor::Point;

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
    /// Displacement z_i whose strain is that of the springs of each branch that relaxes, m, node-major.
    pub branches: Vec<Vec<f64>>,
    /// u with the rigid motions of bodies taken apart that have moved far; empty where none is.
    pub carried: Carried,
    /// What Γ_C and the foundation keep.
    pub surface: Accumulated,
    /// Energies and flows since the start.
    pub ledger: Ledger,
    /// Newton iterations since the start.
    pub counts: Counts,
    /// Least and largest nodal temperature since the start, K.
    pub temperatures: [f64; 2],
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
    /// Krylov iterations; 0 where systems are solved by a factor.
    pub krylov_iterations: usize,
    /// Largest residual of an accepted step, relative to its largest term; one that is round-off, relative to the sizes
    /// of what its terms are sums of.
    pub residual_max: f64,
    /// Passes over both half-steps: one per step where they are staggered.
    pub passes_total: usize,
    /// Largest contraction factors of the fixed-point coupling over the steps; 0 where none was seen.
    pub contraction_max: Contraction,
    /// Steps that were made in halves.
    pub halved_steps: usize,
    /// Steps in which there may be several solutions.
    pub ambiguous_steps: usize,
    /// Steps at whose end a contact point bears a traction.
    pub contact_steps: usize,
}

/// What happened in one step.
#[derive(Clone, Debug)]
pub struct StepReport {
    /// Newton iterations on Γ_C, mechanics.
    pub newton_mechanics: usize,
    /// Newton iterations on Γ_C, heat.
    pub newton_heat: usize,
    /// Parts that the step was made in: more than one where it was halved.
    pub parts: usize,
    /// Whether laws that fall may have several solutions between the state before and this one, however short the
    /// parts.
    pub is_ambiguous: bool,
    /// Residual of (4.1), (4.2), complementarity and cone, relative to the largest term.
    pub residual: f64,
    /// How the half-steps were coupled.
    pub coupling: CouplingReport,
    /// Rigid motions that nothing determines, in words: they are the least.
    pub loose: Vec<String>,
    /// What the prescribed displacements and temperatures take.
    pub reactions: Reactions,
    /// The contact points.
    pub contact: ContactReport,
}

impl StepReport {
    /// The report of two parts of a step in turn.
    fn after(self, first: &StepReport) -> StepReport {
        StepReport {
            newton_mechanics: first.newton_mechanics + self.newton_mechanics,
            newton_heat: first.newton_heat + self.newton_heat,
            parts: first.parts + self.parts,
            is_ambiguous: first.is_ambiguous || self.is_ambiguous,
            residual: first.residual.max(self.residual),
            coupling: CouplingReport {
                passes: first.coupling.passes + self.coupling.passes,
                contraction: [first.coupling.contraction, self.coupling.contraction]
                    .into_iter()
                    .flatten()
                    .reduce(Contraction::max),
                defect: [first.coupling.defect, self.coupling.defect].into_iter().flatten().reduce(f64::max),
            },
            loose: self.loose,
            reactions: self.reactions,
            contact: self.contact,
        }
    }
}

/// What holds the prescribed values: what is left of (4.1) and (4.2) tested with the basis functions of the prescribed
/// degrees of freedom, in their order in the spaces V^h and Q^h. A physics that is not computed has none.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Reactions {
    /// Forces on the body, N per unit of thickness in two dimensions.
    pub force: Vec<f64>,
    /// Heat supplied to the body, W per unit of thickness in two dimensions.
    pub heat: Vec<f64>,
}

/// How the half-steps of a step were coupled.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CouplingReport {
    /// Passes over both half-steps.
    pub passes: usize,
    /// Contraction factors of Φ seen; fixed-point coupling only, and none where one pass was enough.
    pub contraction: Option<Contraction>,
    /// By how much (4.1) with θ_n in m and (4.2) with u_n in e fail, relative to their largest terms; none where they
    /// are staggered.
    pub defect: Option<f64>,
}

/// Contraction factors of the fixed-point coupling within a step: ratios of two defects in turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Contraction {
    /// Geometric mean: the rate at which the iteration settles.
    pub mean: f64,
    /// Largest; above 1 where the contact changes from pass to pass.
    pub largest: f64,
}

impl Contraction {
    /// The larger of both numbers.
    #[must_use]
    pub fn max(self, other: Contraction) -> Contraction {
        Contraction { mean: self.mean.max(other.mean), largest: self.largest.max(other.largest) }
    }
}

/// State of the contact points.
#[derive(Clone, Debug, Default)]
pub struct ContactReport {
    /// Γ_C of the step where pairs are made anew; none where it is that of the bodies at rest, and where the step was
    /// made before a break.
    pub boundary: Option<Arc<ContactBoundary>>,
    /// Weight ω of each contact point in the step, m^(d−1): pairs may be made anew.
    pub weights: Vec<f64>,
    /// Kinematics and tractions.
    pub states: Vec<PointState>,
    /// Temperature of the body at each point, K.
    pub temperature: Vec<f64>,
    /// Temperature of what each point faces, K: of the foundation, or of the other body of a pair. Zero where a point
    /// of a pair faces nothing.
    pub opposite: Vec<f64>,
    /// Heat flux q·ν at each point, of the side that bears it.
    pub flux: Vec<Flux>,
    /// Power of friction that enters both bodies of a pair at each point, W/m²; zero at foundations.
    pub rubbed: Vec<f64>,
    /// Resultant of σν on Γ_C, N per unit of thickness in two dimensions.
    pub force: [f64; 3],
    /// Moment of the forces that each contact puts on both its bodies, N m: the defect of the angular momentum, as
    /// their resultant is zero. Zero at foundations.
    pub moments: Vec<Point>,
    /// ∫_{Γ_C} q·ν in W.
    pub heat_flow: f64,
}

/// Why a step could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The iteration on Γ_C did not end.
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
        /// Parts of the step, of which one was tried: more than one where the step was halved.
        parts: usize,
        /// Iterations, residual and contact pattern.
        why: Box<NotConverged>,
        /// The contact points whose states did not settle, in words; empty if all did.
        unsettled: String,
        /// Whether no point of a body without inertia that contact alone holds sticks: it may slide away.
        slides: bool,
    },
    /// Loads drive motions without strain that nothing resists.
    #[error("step {step} (t = {t:.6e}): a load drives what no support and no contact holds: {motions}")]
    Driven {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// The motions in words.
        motions: String,
    },
    /// A section bears no such tension however far its sides are drawn together, or a body no such force however far an
    /// obstacle is pressed in.
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
        /// The force asked for, N per unit of thickness in two dimensions.
        force: f64,
        /// That reached.
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
        /// The residual that is accepted.
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
        /// Why.
        source: SolveError,
    },
    /// The tangent of laws that are not linear could not be factorized.
    #[error("step {step} (t = {t:.6e}): the tangent of the body: {source}")]
    Singular {
        /// The step n that failed.
        step: usize,
        /// t_n in s.
        t: f64,
        /// Why.
        source: SolveError,
    },
    /// The half-steps could not be brought together.
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
        /// The coupling asked for.
        coupling: Coupling,
        /// Passes over both half-steps.
        passes: usize,
        /// What is left of the defect.
        defect: f64,
        /// Contraction factors seen.
        contraction: Option<Contraction>,
    },
    /// A datum has no finite value where a step needs it.
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
        /// Where, m.
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
    /// Whether the step was not made because it was asked to stop.
    #[must_use]
    pub fn is_interruption(&self) -> bool {
        matches!(
            self,
            StepError::Linear { source: SolveError::Interrupted, .. }
                | StepError::Singular { source: SolveError::Interrupted, .. }
        )
    }

    /// Whether the equations of the step were not solved, or what was tried left the range of its data: a shorter step
    /// or another way may do. Everything else, an interruption, data without a value, a lack of memory, stays whatever
    /// is tried.
    #[must_use]
    pub fn is_unsolved(&self) -> bool {
        match self {
            StepError::NotConverged { .. }
            | StepError::Driven { .. }
            | StepError::Unborne { .. }
            | StepError::Residual { .. }
            | StepError::Coupling { .. }
            | StepError::Uncovered { .. }
            | StepError::NotFinite { .. } => true,
            StepError::Linear { source, .. } | StepError::Singular { source, .. } => source.is_unsolved(),
            StepError::Data { .. } => false,
        }
    }
}

/// What was tried, none where its equations were not solved; any other error goes up.
fn tried<T>(made: Result<T, StepError>) -> Result<Option<T>, StepError> {
    match made {
        Ok(made) => Ok(Some(made)),
        Err(error) if error.is_unsolved() => Ok(None),
        Err(error) => Err(error),
    }
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
        source: SolveError,
    },
    /// Initial data are not finite.
    #[error("the initial {0} is not finite at every node")]
    Initial(&'static str),
    /// The problem that a scheme makes of its own has faults.
    #[error(transparent)]
    Data(#[from] Faults),
}

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
/// systems: the setting of runs and studies, [`BackwardEuler::make`] by default.
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
