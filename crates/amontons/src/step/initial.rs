//! The state at t = 0.

use crate::contact::Contact;
use crate::discretization::Discretization;
use crate::equation::SetupError;
use crate::equation::foundation::{at_rest, frames};
use crate::inclusion::Multipliers;
use crate::linalg::dot;
use crate::problem::{Physics, Problem};
use crate::state::{Accumulated, Carried, Counts, Ledger, State};
use crate::tensor;
use crate::time::{Interval, Pace};

/// θ₀ at the nodes: the initial data, or the prescribed temperature.
pub(super) fn first_temperature(problem: &Problem, discrete: &Discretization) -> Vec<f64> {
    match problem.physics {
        Physics::Warmed => problem.given_temperature(0.0),
        _ => discrete.q.interpolate(&discrete.mesh, std::slice::from_ref(&problem.initial.temperature), 0.0),
    }
}

/// The state at t = 0, (4.3), or at rest in the equilibrium that was found.
///
/// # Errors
/// If initial data are not finite.
pub(crate) fn state(
    problem: &Problem,
    discrete: &Discretization,
    equilibrium: Option<&State>,
) -> Result<State, SetupError> {
    let (mesh, data) = (&discrete.mesh, &problem.initial);
    let given = || discrete.v.interpolate(mesh, &data.displacement, 0.0);
    let u = equilibrium.map_or_else(given, |found| found.u.clone());
    let w = discrete.v.interpolate(mesh, &data.velocity, 0.0);
    let theta = first_temperature(problem, discrete);
    for (values, name) in [(&u, "displacement"), (&w, "velocity"), (&theta, "temperature")] {
        if values.iter().any(|v| !v.is_finite()) {
            return Err(SetupError::Initial(name));
        }
    }
    let ((rho, inertia), (c, _)) = (discrete.inertia(), discrete.storage());
    let kinetic = 0.5 * rho * dot(&w, &inertia.apply(&w));
    // Without a potential the energy is counted from the initial state, which is 0.
    let elastic = discrete.stored_energy(&u, &theta).unwrap_or(0.0);
    let branches = discrete.branches.iter().map(|branch| vec![0.0; branch.size(u.len())]).collect();
    let boundary = &discrete.boundary;
    let mut surface = Accumulated::new(problem, discrete);
    if let Some(found) = equilibrium {
        surface.advance.clone_from(&found.surface.advance);
        surface.wet.clone_from(&found.surface.wet);
    }
    let contact_energy = stored_in_layers(problem, discrete, &u, &surface.advance);
    let temperatures = extremes([f64::INFINITY, f64::NEG_INFINITY], &theta);
    let stores = problem.physics.has_heat();
    let heat_content = if stores { c * discrete.stored_heat(&theta).iter().sum::<f64>() } else { 0.0 };
    let heat_foundation = stored_in_foundations(problem, &surface);
    let ledger = Ledger {
        kinetic,
        elastic,
        contact_energy,
        turned_over: kinetic + elastic + contact_energy,
        heat_content,
        heat_foundation,
        heat_turned_over: heat_content.abs() + heat_foundation.abs(),
        ..Ledger::default()
    };
    let first = [0.0, problem.timeline.instant(1).k];
    let free = || Multipliers::free(at_rest(problem, boundary, [&u, &w], first));
    let multipliers = equilibrium.map_or_else(free, |found| found.multipliers.clone());
    Ok(State {
        step: 0,
        t: 0.0,
        u,
        w,
        theta,
        theta_rate: Vec::new(),
        earlier: None,
        settling: 0,
        multipliers,
        branches,
        carried: Carried::default(),
        surface,
        ledger,
        counts: Counts::default(),
        temperatures,
        released: Vec::new(),
        pace: Pace::default(),
        coarse: None,
    })
}

/// Heat of the foundations at t = 0, J.
fn stored_in_foundations(problem: &Problem, surface: &Accumulated) -> f64 {
    let heat = |(contact, theta): (&Contact, &Option<f64>)| {
        contact.foundation_heat.as_ref().map_or(0.0, |of| of.capacity) * theta.unwrap_or(0.0)
    };
    problem.contacts.iter().zip(&surface.foundation).map(heat).sum()
}

/// Ψ at t = 0, J.
fn stored_in_layers(problem: &Problem, discrete: &Discretization, u: &[f64], advance: &[f64]) -> f64 {
    let (boundary, dim) = (&discrete.boundary, discrete.mesh.dim);
    let mut energy = 0.0;
    let foundation = frames(problem, boundary, u, (&[], [advance; 2]), Interval::default());
    for (point, frame) in boundary.points.iter().zip(foundation) {
        let r = tensor::dot(&boundary.vector_at(point, dim, u), &frame.normal) - frame.gap;
        let contact = problem.contacts.get(point.contact).filter(|contact| contact.acts());
        energy += point.weight * contact.map_or(0.0, |contact| contact.normal.potential(&point.x, r));
    }
    energy
}

/// The range extended to include `values`.
pub(super) fn extremes([low, high]: [f64; 2], values: &[f64]) -> [f64; 2] {
    values.iter().fold([low, high], |[low, high], value| [low.min(*value), high.max(*value)])
}
