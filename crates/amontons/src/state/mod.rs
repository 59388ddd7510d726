//! State of a problem at a time, from which a step starts and which a checkpoint holds, and the report of a step.

mod carried;
mod ledger;
mod report;
mod surface;

pub use carried::{Carried, Rigid};
pub use ledger::Ledger;
pub use report::{ContactReport, Contraction, CouplingReport, Reactions, StepReport};
pub use surface::Accumulated;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::inclusion::Multipliers;
use crate::linalg::dot;
use crate::problem::Misfit;
use crate::time::{Instant, Pace, TimePhase, Timeline};

/// Motion in a step, relative to the displacement, below which its sense does not matter.
const MOVES: f64 = 1e-6;

/// State at a time t_n, from which the next step starts.
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
    /// Mean rate of θ in the last step, K/s, if the coupling extrapolates temperatures; else, and at t = 0, empty.
    pub theta_rate: Vec<f64>,
    /// Friction multipliers at the contact points.
    pub multipliers: Multipliers,
    /// The state one step before, if the next step adds to both.
    pub earlier: Option<Earlier>,
    /// Steps in which a next one adds to this state alone, in a scheme that adds to two: a rigid foundation was hit,
    /// and the velocities before it say nothing of those after.
    pub settling: u32,
    /// Displacement z_i whose strain is that of the springs of each branch that relaxes, m, node-major.
    pub branches: Vec<Vec<f64>>,
    /// u with the rigid motions of far-moved bodies split off; empty if no body has moved far.
    pub carried: Carried,
    /// Memory of Γ_C and of the foundation.
    pub surface: Accumulated,
    /// Energies and flows since the start.
    pub ledger: Ledger,
    /// Newton iterations since the start.
    pub counts: Counts,
    /// Least and largest nodal temperature since the start, K.
    pub temperatures: [f64; 2],
    /// Forces of the supports that ended with the phase before, or end with this step, and that give them up in the
    /// course of the phase, as they were at its start, N, node-major; empty if there are none.
    pub released: Vec<f64>,
    /// The place in a run whose steps are chosen.
    pub pace: Pace,
    /// In a phase whose steps are chosen: the state at the same time of a run with steps of twice the length, made from
    /// the start of the phase on.
    pub coarse: Option<Arc<State>>,
}

impl State {
    /// The step that led to the state; at t = 0 that of number 0, with the length of the first one.
    #[must_use]
    pub fn made(&self, timeline: &Timeline) -> Instant {
        timeline.made(self.step, &self.pace)
    }

    /// The phase in which the step was made, or `None` in a run without phases. The state at t = 0 counts to the first
    /// one.
    #[must_use]
    pub fn phase<'t>(&self, timeline: &'t Timeline) -> Option<&'t TimePhase> {
        let phase = self.made(timeline).phase;
        timeline.phases().nth(phase).filter(|_| timeline.has_phases())
    }

    /// True if the velocity at the end of a step is nearly that at its start with the other sign: of their sum less
    /// than half of the larger is left. Velocities that move the body by less than a millionth of its displacement do
    /// not count.
    pub(crate) fn is_reversal_of(&self, start: &State) -> bool {
        let end = self;
        let [before, after, product] =
            [[&start.w, &start.w], [&end.w, &end.w], [&start.w, &end.w]].map(|[a, b]| dot(a, b));
        let moves = (end.t - start.t) * after.sqrt() > MOVES * dot(&end.u, &end.u).sqrt();
        moves && product < 0.0 && before + 2.0 * product + after < 0.25 * before.max(after)
    }

    /// True after the last step.
    #[must_use]
    pub fn is_last(&self, timeline: &Timeline) -> bool {
        timeline.is_over(self.step, &self.pace)
    }
}

/// What a scheme of two steps keeps of the state one step before.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Earlier {
    /// Length of the step since, s.
    pub k: f64,
    /// u in m, node-major.
    pub u: Vec<f64>,
    /// w in m/s, node-major.
    pub w: Vec<f64>,
    /// θ, K.
    pub theta: Vec<f64>,
    /// State of the branches that relax.
    pub branches: Vec<Vec<f64>>,
    /// θ_F of each contact, K, or `None` if its foundation has no heat capacity.
    pub foundation: Vec<Option<f64>>,
    /// u with the rigid motions split off; empty if they are not.
    pub carried: Carried,
}

impl Earlier {
    /// Keeps a state from which a step of length `k` in s is made.
    #[must_use]
    pub fn of(state: &State, k: f64) -> Earlier {
        let State { u, w, theta, branches, surface, carried, .. } = state.clone();
        Earlier { k, u, w, theta, branches, foundation: surface.foundation, carried }
    }
}

/// Counted work since the start of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    /// Newton iterations of mechanical steps.
    pub newton_mechanics_total: usize,
    /// Most Newton iterations of one mechanical step.
    pub newton_mechanics_max: usize,
    /// Newton iterations of heat steps.
    pub newton_heat_total: usize,
    /// Sweeps over a factor, forward or backward.
    pub sweeps: usize,
    /// Krylov iterations; 0 if systems are solved by a factor.
    pub krylov_iterations: usize,
    /// Largest residual of an accepted step, relative to its largest term. A residual that is round-off is relative to
    /// the sizes of the summands of its terms.
    pub residual_max: f64,
    /// Passes over both half-steps: one per step if they are staggered.
    pub passes_total: usize,
    /// Largest contraction factors of the fixed-point coupling over the steps; 0 if none was observed.
    pub contraction_max: Contraction,
    /// Steps that were made in halves.
    pub halved_steps: usize,
    /// Steps that may have several solutions.
    pub ambiguous_steps: usize,
    /// Steps at whose end a contact point bears a traction.
    pub contact_steps: usize,
    /// Steps that reverse the velocity: at their end it is nearly that of their start with the other sign.
    pub reversed_steps: usize,
    /// Conditions that began with a phase where the body was not.
    pub misfits: Vec<Misfit>,
}
