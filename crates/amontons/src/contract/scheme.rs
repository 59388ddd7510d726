//! What every scheme in time must satisfy.

use std::sync::Arc;

use crate::contact::{Compliance, Contact, Coulomb};
use crate::discretization::Discretization;
use crate::linalg::max_abs;
use crate::material::{Isotropic, Material, StressState};
use crate::mesh::{Diagonal, Mesh};
use crate::problem::{BoundaryCondition, Physics, Problem, ProblemData};
use crate::state::State;
use crate::step::{MakeScheme, Scheme};
use crate::tensor::Point;
use crate::time::TimeScheme;

/// Steps of the coarsest run.
const STEPS: usize = 12;

/// A scheme for a problem; panics if it cannot be set up.
fn made(problem: &Problem, make: MakeScheme) -> Box<dyn Scheme> {
    let scheme = make(problem, &Arc::new(Discretization::new(problem)), &problem.backend);
    scheme.unwrap_or_else(|error| panic!("a scheme for a small block: {error}"))
}

/// The states of a run from one on.
fn run(scheme: &mut dyn Scheme, from: State, steps: usize) -> Vec<State> {
    let mut states = vec![from];
    for _ in 0..steps {
        let old = &states[states.len() - 1];
        let (next, _) = scheme.step(old).unwrap_or_else(|error| panic!("{error}"));
        states.push(next);
    }
    states
}

/// All states of a problem.
fn states(problem: &Problem, make: MakeScheme) -> Vec<State> {
    let mut scheme = made(problem, make);
    let start = scheme.initial().unwrap_or_else(|error| panic!("{error}"));
    run(scheme.as_mut(), start, problem.timeline.steps())
}

/// A block that is held on top and pushed sideways, turned by quarter turns. With contact its other end lies on a
/// foundation that it is pressed on.
fn block(scheme: TimeScheme, steps: usize, quarters: usize, has_contact: bool) -> Problem {
    let turned = |x: Point| (0..quarters).fold(x, |[x, y, z], _| [-y, x, z]);
    let side = |names: [&'static str; 4], at: usize| names[(at + quarters) % 4];
    let counter_clockwise = ["right", "top", "left", "bottom"];
    let (top, bottom) = (side(counter_clockwise, 1), side(counter_clockwise, 3));
    let mesh = Mesh::rectangle([1.0, 1.0], [4, 4], Diagonal::Crossed);
    let mut mesh = mesh.unwrap_or_else(|error| panic!("{error}"));
    mesh.points.iter_mut().for_each(|x| *x = [x[0] - 0.5, x[1] - 0.5, 0.0]);
    let law = |young, poisson| Isotropic::elastic(2, young, poisson, StressState::PlaneStrain);
    let mut material = Material::new(2, law(20.0, 0.3));
    material.density = 1.0.into();
    material.viscosity = law(0.1, 0.3).into();
    let mut data = ProblemData::new("a block", mesh, material, 0.6, steps);
    (data.physics, data.scheme) = (Physics::Mechanics, scheme);
    let [x, y, _] = turned([0.3, -1.0, 0.0]);
    data.body_force = vec![x.into(), y.into()];
    data.boundary = vec![BoundaryCondition::on(top).displacement([0.0; 2])];
    if has_contact {
        let mut contact = Contact::new(bottom, Compliance { stiffness: 300.0 });
        contact.friction = Coulomb { coefficient: 0.3 }.into();
        data.contacts = vec![contact];
    }
    data.check().unwrap_or_else(|faults| panic!("{faults}"))
}

/// Largest difference of two vectors over the largest entry of the second one.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let change: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    max_abs(&change) / max_abs(b)
}

/// Checks that the identity of energy holds to round-off with contact and friction; that the error of a smooth motion
/// falls with at least this order of the step length; that a run continues from any of its states, with what the scheme
/// kept, with the same bits; and that a turned problem has the turned motion.
///
/// # Panics
/// Panics if the scheme violates the contract.
pub fn assert_scheme(make: MakeScheme, scheme: TimeScheme, order: f64) {
    let problem = block(scheme, STEPS, 0, true);
    let all = states(&problem, make);
    for state in &all {
        let (ledger, name) = (&state.ledger, scheme.name());
        let open = ledger.closing_error.abs() / ledger.turned_over.max(f64::MIN_POSITIVE);
        assert!(open <= 1e-10, "{name}: step {} leaves {open:e} of the energy unexplained", state.step);
    }
    let end = &all[STEPS];
    assert!(end.multipliers.p.iter().any(|p| *p > 0.0), "the block lies on its foundation");

    let mut first = made(&problem, make);
    let mut again = made(&problem, make);
    let start = first.initial().unwrap_or_else(|error| panic!("{error}"));
    let half = run(first.as_mut(), start, STEPS / 2).pop().unwrap_or_else(|| panic!("a state"));
    again.recall(&first.kept()).unwrap_or_else(|error| panic!("{error}"));
    let continued = run(again.as_mut(), half, STEPS - STEPS / 2);
    assert!(continued.last() == Some(end), "{}: a run that continues has other bits", scheme.name());

    let turned = states(&block(scheme, STEPS, 1, true), make);
    // The crossed mesh turned by a quarter is itself, with other numbers of its nodes.
    let points = &problem.mesh.points;
    let image = |[x, y, _]: &Point| {
        let is_there = |p: &Point| (p[0] + y).abs() + (p[1] - x).abs() < 1e-9;
        points.iter().position(is_there).unwrap_or_else(|| panic!("a node of the turned mesh"))
    };
    let back = |values: &[f64]| -> Vec<f64> {
        let at = points.iter().map(image);
        at.flat_map(|node| [values[2 * node + 1], -values[2 * node]]).collect()
    };
    let found = difference(&back(&turned[STEPS].u), &end.u);
    assert!(found <= 1e-9, "{}: the turned block moves otherwise, by {found:e}", scheme.name());

    let u = |steps: usize| states(&block(scheme, steps, 0, false), make).pop().map(|state| state.u);
    let [coarse, fine, finest] = [4, 8, 64].map(|by| u(by * STEPS).unwrap_or_else(|| panic!("a state")));
    let found = (difference(&coarse, &finest) / difference(&fine, &finest)).log2();
    assert!(found >= order - 0.25, "{}: order {found}, expected {order}", scheme.name());
}
