//! The worked case `cases/brake-disc`: a pad on a disc that turns, warms up and wears, with sums of our own over what
//! each step reports.

use std::f64::consts::PI;

use crate::common::case;
use amontons::case::{self, Source};
use amontons::contact::{ContactBoundary, PointOnBoundary, Quadrature, Status};
use amontons::element::ShapeTable;
use amontons::inclusion::PointState;
use amontons::mesh::CellMap;
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{Settings, run};
use amontons::state::State;

/// A run that keeps all.
fn solved(problem: &Problem) -> Memory {
    let mut memory = Memory::new().states_every(1).reports();
    run(problem, &Settings { certificate: false, ..Settings::default() }, &mut [&mut memory]).expect("a run");
    memory
}

/// Ten steps of the shipped case on a coarse mesh, with changes: that of `pad.geo` with
/// `-setnumber radial 2 -setnumber around 2`.
fn stop(changes: &[&str]) -> (Problem, Memory) {
    let changes: Vec<String> = ["time.steps=10", "mesh.file=\"../../crates/amontons/tests/meshes/brake-disc.msh\""]
        .iter()
        .chain(changes)
        .map(|&change| change.to_owned())
        .collect();
    let problem = case("cases/brake-disc/disc.toml", &changes).problem;
    let memory = solved(&problem);
    (problem, memory)
}

fn points(problem: &Problem) -> Vec<PointOnBoundary> {
    ContactBoundary::new(
        &problem.mesh,
        problem.mesh.facets.get(&problem.contacts[0].on).expect("the side"),
        Quadrature::Nodal,
    )
    .points
}

/// Σ ω f over the contact points.
fn integral(
    points: &[PointOnBoundary],
    states: &[PointState],
    f: impl Fn(&PointOnBoundary, &PointState) -> f64,
) -> f64 {
    assert_eq!(points.len(), states.len());
    points.iter().zip(states).map(|(point, state)| point.weight * f(point, state)).sum()
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// ∫ c θ over the body.
fn heat_content(problem: &Problem, state: &State) -> f64 {
    let mut sum = 0.0;
    for block in &problem.mesh.blocks {
        let table = ShapeTable::new(block.element, 6);
        let mut map = CellMap::new(&problem.mesh, &table);
        for cell in block.cells() {
            for (q, weight) in table.weights.iter().enumerate() {
                map.at(cell, q);
                let theta: f64 =
                    cell.iter().zip(table.values(q)).map(|(&node, value)| value * state.theta[node as usize]).sum();
                sum += problem.materials[block.region].heat_capacity.at(&[0.0; 3]) * weight * map.measure * theta;
            }
        }
    }
    sum
}

/// With an insulated back all that friction works is found again as heat: in the pad, in the disc C θ_F, and in the
/// air Σ k H θ_F.
#[test]
fn the_work_of_friction_is_the_heat_of_pad_disc_and_air() {
    let (problem, memory) = stop(&["boundary.2.convection.coefficient=0"]);
    let (k, points) = (problem.timeline.longest(), points(&problem));
    let work: f64 = memory
        .reports
        .iter()
        .map(|report| k * integral(&points, &report.contact.states, |_, s| dot(&s.q, &s.slip)))
        .sum();
    let temperatures: Vec<f64> =
        memory.states[1..].iter().map(|state| state.surface.foundation[0].expect("a temperature")).collect();
    let last = memory.states.last().expect("a state");
    let [pad, disc, air] = [
        heat_content(&problem, last),
        1760.0 * temperatures.last().expect("a step"),
        temperatures.iter().map(|t| k * 4.0 * t).sum(),
    ];
    println!(
        "work {work:.6e}, pad {pad:.6e}, disc {disc:.6e}, air {air:.6e}, error {:e}",
        (pad + disc + air) / work - 1.0
    );
    // Each step satisfies its equations to 1e-10 of their largest term, by the guarantee of the solver.
    assert!(((pad + disc + air) / work - 1.0).abs() < 1e-10, "{pad} + {disc} + {air}, expected {work}");
    assert!(pad > 0.02 * work && air > 1e-3 * work, "each takes a part: {pad}, {air} of {work}");

    let ledger = &last.ledger;
    for (name, value) in
        [("friction_dissipation", ledger.friction_dissipation), ("heat_friction", ledger.heat_friction)]
    {
        assert!((value / work - 1.0).abs() < 1e-12, "{name} {value}, expected {work}");
    }
    assert!((ledger.heat_surroundings / air - 1.0).abs() < 1e-12);
    assert!(ledger.relative_closing_error().abs() < 1e-12, "{:e}", ledger.relative_closing_error());
    assert!(ledger.relative_heat_closing_error().abs() < 1e-12, "{:e}", ledger.relative_heat_closing_error());

    // While the disc turns all that touches slips; at rest there are points of every state.
    let count =
        |n: usize, status| memory.reports[n].contact.states.iter().filter(|state| state.status == status).count();
    assert_eq!(count(4, Status::Stick), 0, "a point sticks to a disc that turns");
    let at_rest = [Status::Open, Status::Stick, Status::Slip].map(|status| count(9, status));
    assert!(at_rest.iter().all(|&n| n > 0), "open, stick, slip at rest: {at_rest:?}");
}

/// Archard: V = κ ∫∫ p ‖w_τ‖ dA dt, whatever the field of pressures; and the hottest points wear fastest where κ grows
/// with the temperature.
#[test]
fn the_worn_volume_is_that_of_archard() {
    let coefficient = 5e-13;
    let (problem, memory) = stop(&[&format!("contact.wear={{ law = \"archard\", coefficient = {coefficient:e} }}")]);
    let (k, points) = (problem.timeline.longest(), points(&problem));
    let rubbing = |s: &PointState| s.pressure.max(0.0) * dot(&s.slip, &s.slip).sqrt();
    let expected: f64 = memory
        .reports
        .iter()
        .map(|report| coefficient * k * integral(&points, &report.contact.states, |_, s| rubbing(s)))
        .sum();
    let last = memory.states.last().expect("a state");
    let volume: f64 = points.iter().zip(&last.surface.wear).map(|(point, wear)| point.weight * wear).sum();
    println!("volume {volume:.6e}, error {:e}", volume / expected - 1.0);
    assert!((volume / expected - 1.0).abs() < 1e-10, "{volume:e}, expected {expected:e}");
    // The gap grows by it: what is worn off presses less than it would.
    let (_, fresh) = stop(&["contact.wear={ law = \"archard\", coefficient = 0 }"]);
    let most = |memory: &Memory| {
        memory.reports.last().expect("a report").contact.states.iter().map(|s| s.pressure).fold(0.0, f64::max)
    };
    assert!(most(&memory) < most(&fresh), "{} against {} without wear", most(&memory), most(&fresh));
}

/// An annular pad under a uniform pressure: M = (2π/3) μ p (R³ − r³), and the power M ω (J. E. Shigley, "Mechanical
/// Engineering Design", disc clutches with uniform pressure). With ν = 0 the pressure is uniform in every step; what is
/// left is the quadrature of r on curved quadratic facets, of order 4.
#[test]
fn the_torque_of_an_annular_pad() {
    let (inner, outer, mu, pressure, omega, spring) = (0.095f64, 0.145f64, 0.4, 1.2e6, 30.0, 1e3);
    // A spring that keeps the pad where it would be free before it touches takes its share of the pressure: p
    // (1/c + H/E) of depth.
    let held = spring * (1e-11 + 0.01 / 5e8);
    let exact = 2.0 * PI / 3.0 * mu * pressure * (outer.powi(3) - inner.powi(3));
    let torque = |around: usize| {
        let text = format!(
            "name = \"clutch\"\n\
             [mesh]\nkind = \"cylinder\"\nradii = [{inner}, {outer}]\nheight = 0.01\nn = [1, {around}, 1]\nelements = \"Q2\"\n\
             [time]\nend = 0.02\nsteps = 2\n\
             [material]\ndensity = 0.0\nheat_capacity = 2.5e6\nexpansion = 0.0\ncoupling = 0.0\nconductivity = 3.0\n\
             elasticity = {{ law = \"isotropic\", young = 5e8, poisson = 0.0 }}\nviscosity = {{ law = \"lame\", first = 0.0, second = 0.0 }}\n\
             [[boundary]]\non = \"top\"\ndisplacement = [0, 0, \"free\"]\npressure = {pressure}\nspring = [0, 0, {spring}]\n\
             [contact]\non = \"bottom\"\nfoundation_velocity = [\"{omega}*y\", \"-{omega}*x\", 0]\n\
             normal = {{ law = \"compliance\", stiffness = 1e11 }}\nfriction = {{ law = \"coulomb\", coefficient = {mu} }}\n"
        );
        let problem = case::parse(&Source::new("clutch.toml", text), &[]).expect("a valid case").problem;
        let (points, memory) = (points(&problem), solved(&problem));
        let states = &memory.reports.last().expect("a report").contact.states;
        for state in states {
            assert!(state.status == Status::Slip && (state.pressure / pressure - 1.0).abs() < 1.01 * held, "{state:?}");
        }
        // q is what the body does to the disc: against its motion, which is clockwise.
        let torque = integral(&points, states, |point, s| point.x[0] * s.q[1] - point.x[1] * s.q[0]);
        let power = integral(&points, states, |_, s| dot(&s.q, &s.slip));
        assert!((power / (torque * omega) - 1.0).abs() < 1e-8, "{power} W, {torque} N m");
        torque
    };
    let errors = [8, 16, 32].map(|around| (torque(around) / exact - 1.0).abs());
    let orders = [0, 1].map(|i| (errors[i] / errors[i + 1]).log2());
    println!("errors {errors:?}, orders {orders:?}");
    assert!(orders.iter().all(|order| (order - 4.0).abs() < 0.2), "orders {orders:?} of {errors:?}");
}
