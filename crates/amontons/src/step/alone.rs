//! A step of a problem with both half-steps, or with only one. The other one is not computed then; its fields are zero,
//! or the prescribed temperature.

use super::coupling::{Coupled, Made};
use crate::contact::{Flux, Status};
use crate::equation::StepError;
use crate::equation::foundation::frames;
use crate::equation::given::Given;
use crate::equation::heat::{Amounts, Begun, Heat};
use crate::equation::iterate::Iterate;
use crate::equation::mechanics::{Balanced, Mechanics};
use crate::equation::system::{HalfStep, Step};
use crate::equation::systems::Systems;
use crate::inclusion::{Exchange, Frame, PointState};
use crate::problem::Physics;
use crate::state::CouplingReport;

/// Solves the half-steps that the problem has.
pub(crate) fn solved(step: &Step, systems: &mut Systems) -> Result<Made, StepError> {
    match (&mut systems.mechanics, &mut systems.heat) {
        (Some(of_mechanics), Some(of_heat)) => Coupled::new(step, of_mechanics, of_heat).solve(),
        (Some(of_mechanics), None) => mechanics(step, of_mechanics),
        (None, Some(of_heat)) => heat(step, of_heat),
        // No value of `Physics` leads here.
        (None, None) => Err(StepError::NotFinite { step: step.n, t: step.t, part: "the data" }),
    }
}

/// Solves (4.1) without a temperature, or with the temperature prescribed at the time of the equations.
fn mechanics(step: &Step, half: &mut HalfStep) -> Result<Made, StepError> {
    let theta: Vec<f64> = match step.problem.physics {
        Physics::Warmed => step.problem.given_temperature(step.level),
        _ => vec![0.0; step.old.theta.len()],
    };
    Ok(made(Mechanics::solve(step, half, &theta, None, &mut ())?, no_heat(step, theta)))
}

/// Solves (4.2) of bodies that do not move. They exchange heat across their gaps at rest, without contact pressure.
fn heat(step: &Step, half: &mut HalfStep) -> Result<Made, StepError> {
    let states = across_gaps(step);
    let heat = Begun::new(step, half, &step.old.u, None)?.solve(step, half, &states)?;
    Ok(made(no_mechanics(step, states), heat))
}

/// The contact points of bodies at rest: r = −g, and no traction.
pub(crate) fn across_gaps(step: &Step) -> Vec<PointState> {
    let frames = frames(step.problem, step.boundary, &step.old.u, (&[], [&[]; 2]), step.interval());
    let at_rest = |frame: &Frame| PointState {
        normal: frame.normal,
        penetration: 0.0 - frame.gap,
        at_level: 0.0 - frame.gap,
        pressure: 0.0,
        bound: 0.0,
        q: [0.0; 3],
        slip: [0.0; 3],
        wear: 0.0,
        opened: 0.0,
        status: Status::Open,
    };
    frames.iter().map(at_rest).collect()
}

fn made(mechanics: Mechanics, heat: Heat) -> Made {
    let (iterations, sweeps) = ([mechanics.iterations, heat.iterations], mechanics.sweeps + heat.sweeps);
    Made { mechanics, heat, report: CouplingReport { passes: 1, ..CouplingReport::default() }, iterations, sweeps }
}

/// A heat half-step with the temperature `theta` and no heat flow.
fn no_heat(step: &Step, theta: Vec<f64>) -> Heat {
    let (zero, points) = (vec![0.0; step.old.theta.len()], step.boundary.points.len());
    Heat {
        mass_theta: zero.clone(),
        d_theta: zero.clone(),
        supply: step.discrete.q_h.at(step.level),
        coupling: zero,
        exchange: Exchange {
            temperature: step.boundary.scalars_on(step.contacts, &theta),
            opposite: vec![0.0; points],
            flux: vec![Flux::default(); points],
            rubbed: vec![0.0; points],
            foundation: step.old.surface.foundation.clone(),
            passed: Vec::new(),
        },
        through_contact: 0.0,
        reactions: Vec::new(),
        iterations: 0,
        sweeps: 0,
        residual: 0.0,
        scale: 0.0,
        amounts: Amounts::default(),
        theta,
    }
}

/// A mechanical half-step with u = w = 0 and no forces.
fn no_mechanics(step: &Step, states: Vec<PointState>) -> Mechanics {
    let zero = || vec![0.0; step.old.u.len()];
    let [mass_w, a_u, a_w, b_w] = std::array::from_fn(|_| zero().into());
    let multipliers = step.old.multipliers.clone();
    let mut given = Given::default();
    given.advance.clone_from(&step.old.surface.advance);
    let at = Iterate { w: zero(), multipliers, mass_w, a_u, a_w, b_w, ..Iterate::default() };
    Mechanics {
        end: Balanced { at, u: zero(), states, ..Balanced::default() },
        whole: None,
        branches: step.old.branches.clone(),
        is_unique: true,
        iterations: 0,
        sweeps: 0,
        residual: 0.0,
        wet: Vec::new(),
        theta: step.old.theta.clone(),
        thermal: zero(),
        given,
    }
}
