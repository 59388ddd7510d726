//! The inclusion K x + N(x_C) ∋ r of a half-step: a constant matrix and a nonsmooth term that lives on Γ_C.
//!
//! After condensation, a half-step is a small nonsmooth problem on Γ_C. In mechanics, with r = ū_ν + γ w_ν − g and the
//! slip w_τ against the foundation at each contact point,
//!
//! ```text
//!     S w + Σ ω Nᵀ (p ν + q) = r̂,      p = J(r + λ p),      q = Π_{‖·‖ ≤ s}(q + ρ w_τ),  s = p_τ(r, p, ‖w_τ‖)
//! ```
//!
//! where J(z) solves p ∈ G(z − λ p) for the graph G of the normal law, of which λ p/γ shifts the rate likewise. The
//! pressure is a multiplier of every law that does not fall, soft, stiff or rigid; a law that falls is taken as the
//! function p = G(r, ṙ) that it is. The semismooth Newton iteration (Alart and Curnier, 1988) with p and q eliminated
//! point by point needs linear systems in w only. ρ is the diagonal of S over the weight of the point and λ = γ/ρ, so
//! decisions do not depend on units. In heat, S θ + Σ ω Nᵀ Q = r̂ with Q = k_c φ_L(θ − θ_F) is the same without
//! friction.
//!
//! | module | holds |
//! |---|---|
//! | `interface` | the rows of N with the basis of each contact point: jump, Nᵀ f, entries of Nᵀ T N |
//! | `normal`, `friction`, `point` | (2.8), (2.9) and wear at a point, linearised |
//! | `mechanical`, `heat` | the terms of both half-steps |
//! | `frozen` | the equations of the points at a solution, for derivatives of a step |
//! | `multipliers` | pressure and friction of the points, which a step starts from and ends with |
//! | `passed` | heat that passes a contact, by what it passes by |
//! | `newton` | the semismooth Newton iteration over a term |
//! | `solve`, `descent` | what is done where it does not end |
//! | `loose`, `settle` | rigid motions that contact leaves free, and what holds them |

mod descent;
mod drive;
mod frame;
mod friction;
mod frozen;
mod heat;
mod interface;
mod loose;
mod mechanical;
mod multipliers;
mod newton;
mod normal;
mod passed;
mod point;
pub(crate) mod residual;

mod settle;
mod solve;

pub use drive::{Drive, Drives};
pub use frame::{Frame, Onset, PointDerivative, PointState, PointTangent};
pub use frozen::{Chosen, PointInput, PointOutput};
pub use heat::{Exchange, HeatStep, Lumped};
pub use interface::{Interface, Local, LocalTangent, Row, basis};
pub use loose::{Loose, Undetermined};
pub use mechanical::{Mechanical, MechanicalStep};
pub use multipliers::Multipliers;
pub use passed::Passed;

use crate::contact::Status;
use crate::linalg::SolveError;

/// Residual, relative to the largest term, at which the iteration ends. Round-off of a
/// well-conditioned condensed system is two orders below.
pub const TOLERANCE: f64 = 1e-12;
/// Iterations after which, and step length below which, an iteration has failed.
const ITERATIONS: usize = 200;
const SHORTEST_STEP: f64 = 1e-4;
/// Stiffness of a point that sticks, or lies on a rigid foundation, over ρ. The error of one iteration is of the order
/// of its inverse and vanishes with the iterations, because each starts from the multiplier of the one before.
const STIFF: f64 = (1u64 << 27) as f64;

/// A nonsmooth iteration that ended.
#[derive(Clone, Debug, Default)]
pub struct Solved {
    /// The unknowns on Γ_C.
    pub x: Vec<f64>,
    /// Newton iterations.
    pub iterations: usize,
    /// The rigid motions that nothing determines.
    pub loose: Vec<Undetermined>,
    /// The forces of the springs that hold some of them, by unknown, N; empty if they bear nothing.
    pub held: Vec<f64>,
}

/// Why a step on Γ_C has no solution.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// The nonsmooth iteration did not end.
    NotConverged(NotConverged),
    /// The condensed system could not be applied or solved.
    Linear(SolveError),
    /// Loads drive rigid motions that nothing resists.
    Driven(Vec<Undetermined>),
    /// A contact that is driven does not bear its force, however far what is beyond it moves.
    Unborne {
        /// The contact.
        drive: Drive,
        /// Force borne, N per unit of thickness in two dimensions.
        reached: f64,
    },
}

impl From<NotConverged> for Failure {
    fn from(why: NotConverged) -> Failure {
        Failure::NotConverged(why)
    }
}

impl From<SolveError> for Failure {
    fn from(why: SolveError) -> Failure {
        Failure::Linear(why)
    }
}

/// A nonsmooth iteration that did not end.
#[derive(Clone, Debug, PartialEq)]
pub struct NotConverged {
    /// Newton iterations.
    pub iterations: usize,
    /// Residual relative to the largest term.
    pub residual: f64,
    /// The states of the points at the last iterate.
    pub states: Vec<Status>,
    /// Contact points whose states or forces did not settle, the worst first, with their states at the last iterates.
    pub unsettled: Vec<(usize, Vec<Status>)>,
}

impl NotConverged {
    /// The number of points of a state.
    #[must_use]
    pub fn count(&self, status: Status) -> usize {
        self.states.iter().filter(|of| **of == status).count()
    }
}
