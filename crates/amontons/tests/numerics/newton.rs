//! Newton's method on Γ_C: it ends from any state, its solutions satisfy the contact conditions, and its
//! work is counted.
#![allow(clippy::float_cmp, reason = "counts are exact")]

use crate::common::{self, Random, disturb, paper, reading};
use amontons::case::{self, Source};
use amontons::contact::Status;
use amontons::state::{State, StepReport};
use amontons::step::{March, Scheme};
use amontons::tensor::{dot, length};

fn scheme(overrides: &[&str]) -> (amontons::problem::Problem, March) {
    let problem = paper(overrides).problem;
    let scheme = March::new(&problem).expect("a regular system");
    (problem, scheme)
}

/// (2.8), (2.9) and (2.10) at every contact point, from the state alone.
fn assert_contact_conditions(report: &StepReport, c_nu: f64, mu: f64) {
    let largest = report.contact.states.iter().fold(0.0f64, |m, s| m.max(s.pressure));
    let fastest = report.contact.states.iter().fold(0.0f64, |m, s| m.max(length(&s.slip)));
    for (state, flux) in report.contact.states.iter().zip(&report.contact.flux) {
        assert!((state.pressure - c_nu * state.penetration.max(0.0)).abs() <= 1e-12 * largest, "(2.8)");
        let bound = mu * state.pressure;
        assert!(length(&state.q) <= bound + 1e-10 * largest, "(2.9): outside the cone");
        let speed = length(&state.slip);
        // Where a point moves, q·w = s ‖w‖: at the bound and against the slip.
        if speed > 1e-9 * fastest {
            assert!(
                (dot(&state.q, &state.slip) - bound * speed).abs() <= 1e-8 * largest * speed,
                "(2.9): not against the slip"
            );
        }
        match state.status {
            Status::Open => assert!(state.penetration <= 0.0 && flux.value == 0.0),
            Status::Stick => assert!(speed <= 1e-9 * fastest, "a stuck point moves at {speed:e} of {fastest:e}"),
            Status::Slip => assert!((length(&state.q) - bound).abs() <= 1e-8 * largest),
        }
    }
}

/// Random states, smooth and rough, small and large, on meshes and steps where the step has one solution
/// and where it may have several.
#[test]
fn steps_converge_from_any_state() {
    let mut random = Random(88_172_645_463_325_252);
    for quadrature in ["nodal", "gauss"] {
        for n in [4, 16, 32] {
            for steps in [1, 8, 64, 1024] {
                let (problem, mut scheme) = scheme(&[
                    &format!("mesh.n={n}"),
                    &format!("time.steps={steps}"),
                    &format!("contact.quadrature={quadrature}"),
                    "contact.heat.foundation_temperature=10",
                ]);
                let start = scheme.initial().expect("finite initial data");
                for trial in 0..30 {
                    let mut state = start.clone();
                    disturb(&mut state, &problem, &scheme, &mut random, trial % 2 == 0);
                    for _ in 0..2 {
                        let (next, report) = scheme
                            .step(&state)
                            .unwrap_or_else(|e| panic!("{quadrature}, n = {n}, N = {steps}, trial {trial}: {e}"));
                        assert!(report.residual <= 1e-10);
                        assert_contact_conditions(&report, 1e4, 0.2);
                        state = State { step: 0, ..next };
                    }
                }
            }
        }
    }
}

/// A block pushed along a compliant foundation, with Coulomb friction at Gauss points of its bottom.
fn block(elements: &str) -> (amontons::problem::Problem, March) {
    let text = format!(
        r#"
name = "block"
[mesh]
kind = "box"
size = [1.0, 0.5, 1.0]
n = [3, 2, 3]
elements = "{elements}"
[time]
end = 0.5
steps = 5
[material]
density = 1.0
heat_capacity = 1.0
expansion = 0.5
coupling = 0.5
conductivity = 1.0
elasticity = {{ law = "isotropic", young = 20.0, poisson = 0.3 }}
viscosity = {{ law = "lame", first = 0.1, second = 0.1 }}
[load]
body_force = [0.6, -1.0, 0.3]
[[boundary]]
on = "top"
traction = ["0.8*sin(6*t)", -0.6, "0.5*cos(7*t)"]
[contact]
on = "bottom"
quadrature = "gauss"
normal = {{ law = "compliance", stiffness = 1e4 }}
friction = {{ law = "coulomb", coefficient = 0.3 }}
heat = {{ law = "ramp", conductance = 1.0, width = 1e-3, foundation_temperature = 1.0 }}
"#
    );
    let problem = case::parse(&Source::new("block.toml", text), &[]).expect("a case without faults").problem;
    let scheme = March::new(&problem).expect("a regular system");
    (problem, scheme)
}

/// On quadratic triangles the shape functions of the vertices take either sign and integrate to zero. Newton's method
/// takes no more than half again as many iterations there as on quadratic quadrilaterals, where all integrals are
/// positive: from rest, and from random velocities.
#[test]
fn gauss_points_of_quadratic_faces() {
    let iterations = |elements: &str| {
        let (problem, mut scheme) = block(elements);
        let mut state = scheme.initial().expect("finite initial data");
        let mut step = |state: &State| {
            let (next, report) = scheme.step(state).unwrap_or_else(|e| panic!("{elements}: {e}"));
            assert_contact_conditions(&report, 1e4, 0.3);
            (next, report.newton_mechanics)
        };
        let (mut total, start) = (0, state.clone());
        for _ in 0..problem.timeline.steps() {
            let (next, newton) = step(&state);
            total += newton;
            state = next;
        }
        let mut random = Random(88_172_645_463_325_252);
        for _ in 0..10 {
            let mut state = start.clone();
            state.w.iter_mut().for_each(|w| *w = random.number());
            for _ in 0..2 {
                let (next, newton) = step(&state);
                total += newton;
                state = State { step: 0, ..next };
            }
        }
        total
    };
    let [triangles, quadrilaterals] = ["P2", "Q2"].map(iterations);
    assert!(2 * triangles <= 3 * quadrilaterals, "{triangles} iterations against {quadrilaterals}");
}

#[test]
fn contact_conditions_hold_in_every_step_of_every_reading() {
    for name in ["MR", "identity", "literal"] {
        for foundation in ["0", "10"] {
            let mut overrides = reading(name);
            overrides.extend([
                "mesh.n=16".to_owned(),
                "time.steps=32".to_owned(),
                format!("contact.heat.foundation_temperature={foundation}"),
            ]);
            let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
            let (problem, mut scheme) = scheme(&overrides);
            let mut state = scheme.initial().expect("finite initial data");
            for _ in 0..problem.timeline.steps() {
                let (next, report) = scheme.step(&state).expect("a step");
                assert_contact_conditions(&report, 1e4, 0.2);
                state = next;
            }
            assert!(
                state.ledger.relative_closing_error().abs() < 1e-12,
                "{name}: energy {:e}",
                state.ledger.relative_closing_error()
            );
            assert!(
                state.ledger.relative_heat_closing_error().abs() < 1e-12,
                "{name}: heat {:e}",
                state.ledger.relative_heat_closing_error()
            );
        }
    }
}

/// One factorization per matrix, one pair of sweeps per half-step, one or two Newton iterations once the
/// contact has settled.
#[test]
fn counted_work() {
    for (n, foundation, newton, settled) in [(16, "0", 23, 1), (32, "0", 47, 1), (32, "10", 110, 3), (64, "10", 250, 3)]
    {
        let (problem, mut scheme) = scheme(&[
            &format!("mesh.n={n}"),
            &format!("time.steps={n}"),
            &format!("contact.heat.foundation_temperature={foundation}"),
        ]);
        let mut state = scheme.initial().expect("finite initial data");
        for step in 1..=problem.timeline.steps() {
            let (next, report) = scheme.step(&state).expect("a step");
            assert!(
                step <= problem.timeline.steps() / 2 || report.newton_mechanics <= settled,
                "n = {n}, step {step}: {} iterations",
                report.newton_mechanics
            );
            assert_eq!(report.newton_heat, 1, "without truncation the heat step is linear");
            state = next;
        }
        assert_eq!(scheme.solvers().factorizations[0], 2);
        assert_eq!(state.counts.sweeps, 4 * problem.timeline.steps());
        assert!(
            state.counts.newton_mechanics_total <= newton,
            "n = {n}, θ_F = {foundation}: {} iterations",
            state.counts.newton_mechanics_total
        );
        assert!(scheme.solvers().factorizations[1] <= state.counts.newton_mechanics_total + problem.timeline.steps());
    }
}

/// The truncation φ_L changes the flux where |θ − θ_F| > L and nothing below.
#[test]
fn truncation_of_the_temperature_difference() {
    let run = |extra: &[&str]| {
        let mut overrides = vec!["mesh.n=16", "time.steps=16", "contact.heat.foundation_temperature=10"];
        overrides.extend(extra);
        let (problem, mut scheme) = scheme(&overrides);
        let mut state = scheme.initial().expect("finite initial data");
        let mut flow = 0.0;
        for _ in 0..problem.timeline.steps() {
            let (next, report) = scheme.step(&state).expect("a step");
            (state, flow) = (next, report.contact.heat_flow);
            for (temperature, flux) in report.contact.temperature.iter().zip(&report.contact.flux) {
                if extra == ["contact.heat.truncation=2"] {
                    assert!(flux.value.abs() <= 2.0 && (temperature - 10.0).abs() <= 10.0 + 1e-9);
                }
            }
        }
        flow
    };
    let (free, wide, narrow) = (run(&[]), run(&["contact.heat.truncation=1e3"]), run(&["contact.heat.truncation=2"]));
    assert_eq!(free.to_bits(), wide.to_bits());
    assert!(narrow.abs() < 0.5 * free.abs(), "{narrow} against {free}");
}

/// Without friction a step with pressures that do not fall is the minimum of a convex energy: few iterations whatever
/// the body is held by, and however stiff it is beside the layer. (Steps that only make the residual less failed here
/// after 4000 iterations. A dozen find the contact pattern; what a stiff body leaves of round-off takes some more, pass
/// by pass.)
#[test]
fn steps_without_friction_take_few_iterations() {
    for quadrature in ["nodal", "gauss"] {
        for (name, most) in
            [("block-eccentric", ["1e4", "1e6", "1e8"].as_slice()), ("beam-tensionless", &["1e3", "1e4", "1e5"])]
        {
            for young in most {
                let overrides =
                    [format!("material.elasticity.young={young}"), format!("contact.quadrature=\"{quadrature}\"")];
                let problem = common::case(&format!("crates/amontons/benchmarks/{name}.toml"), &overrides).problem;
                let mut scheme = March::new(&problem).expect("a regular system");
                let start = scheme.initial().expect("finite initial data");
                let (_, report) =
                    scheme.step(&start).unwrap_or_else(|error| panic!("{name}, {quadrature}, E = {young}: {error}"));
                let iterations = report.newton_mechanics;
                assert!(iterations <= 30, "{name}, {quadrature}, E = {young}: {iterations} iterations");
            }
        }
    }
}
