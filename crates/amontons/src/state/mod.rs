//! State of a problem at a time: what a step starts from and a checkpoint holds, with the report of a step.

mod carried;
mod ledger;
mod report;
mod surface;

pub use carried::{Carried, Rigid};
pub use ledger::Ledger;
pub use report::{ContactReport, Contraction, CouplingReport, Reactions, StepReport};
pub use surface::Accumulated;

use crate::inclusion::Multipliers;

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
