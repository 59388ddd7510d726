//! Newton's method on the contact boundary.
//!
//! After condensation, a step is a small nonsmooth problem on Γ_C. In mechanics, with
//! r = u_{n−1,ν} + k w_ν − g and the slip w_τ against the foundation at each contact point,
//!
//! ```text
//!     S w + Σ ω Nᵀ (p ν + q) = r̂,      p = J(r + λ p),      q = Π_{‖·‖ ≤ s}(q + ρ w_τ),  s = p_τ(r, p, ‖w_τ‖)
//! ```
//!
//! where J(z) solves p ∈ G(z − λ p, ṙ) for the graph G of the normal law. A function has λ = 0 and p = G(r, ṙ); Signorini's conditions
//! have p = (r/λ + p)₊. The semismooth Newton iteration (Alart and Curnier, 1988) with p and q eliminated point by point
//! needs linear systems in w only. ρ is the diagonal of S over the weight of the point and λ = k/ρ, so decisions
//! do not depend on units. In heat, S θ + Σ ω Nᵀ k_c φ_L(θ − θ_F) = r̂ is the same without q.
//!
//! **Globalisation.** After a first full step, which leaves the pattern of the guess, steps are halved
//! until the residual decreases; where that ends at a kink, a full step leaves it. After a few of those
//! the solution is approached by proximal steps, each of which has one solution.

mod descent;
mod heat;
mod mechanical;
mod point;

pub use heat::{Exchange, HeatStep, Lumped};
pub use mechanical::{MechanicalStep, Multipliers};
pub use point::{Frame, PointDerivative, PointState, PointTangent};

/// Residual, relative to the largest term, at which the iteration ends. Round-off of a
/// well-conditioned condensed system is two orders below.
pub const TOLERANCE: f64 = 1e-12;
/// Iterations after which, and step length below which, an iteration has failed.
pub(super) const ITERATIONS: usize = 200;
pub(super) const SHORTEST_STEP: f64 = 1e-4;

/// A nonsmooth iteration that ended.
#[derive(Clone, Debug)]
pub struct Solved {
    /// The contact unknowns.
    pub x: Vec<f64>,
    /// Newton iterations.
    pub iterations: usize,
}

/// A nonsmooth iteration that did not end.
#[derive(Clone, Debug, PartialEq)]
pub struct NotConverged {
    /// Newton iterations.
    pub iterations: usize,
    /// Residual relative to the largest term.
    pub residual: f64,
    /// Points that were open, stuck and slipping at the last iterate.
    pub pattern: [usize; 3],
}
