//! How often a step takes memory.

use crate::backends::BODY;
use crate::common;
use amontons::case::{self, Source};
use amontons::problem::Problem;
use amontons::scheme::{BackwardEuler, Scheme};

/// What makes of the box of the tests of backends one on a layer with friction and heat, solved with a factor.
const WITH_HEAT: &[&str] = &[
    "solver.solver=direct",
    "time.steps=8",
    "time.end=0.25",
    "material.density=1",
    "material.heat_capacity=1",
    "material.conductivity=1",
    "material.viscosity={ law = \"lame\", first = 10.0, second = 10.0 }",
    "load.body_force=[0.3, 0.0, -1.0]",
    "load.heat_source=1",
    "contact.normal={ law = \"compliance\", stiffness = 1e4 }",
    "contact.friction={ law = \"coulomb\", coefficient = 0.2 }",
    "contact.heat={ law = \"ramp\", conductance = 1.0, width = 1e-5, foundation_temperature = 0.0 }",
];

/// How often a step takes memory at the most, and each Newton iteration on Γ_C after the first.
const STEP: u64 = 280;
const ITERATION: u64 = 40;

/// Asserts that no step takes memory more often than that, but for the first two, in which work space is made. On one
/// thread, so that all of a step is counted.
fn assert_taken(name: &str, problem: &Problem) {
    let mut scheme = BackwardEuler::new(problem).expect("a regular system");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut state = scheme.initial().expect("finite initial data");
    for step in 1..=problem.steps {
        let mut made = None;
        let taken = pool.install(|| allocation_counter::measure(|| made = Some(scheme.step(&state)))).count_total;
        let (next, report) = made.expect("a result").expect("a step");
        let most = STEP + ITERATION * (report.newton_mechanics + report.newton_heat - 2) as u64;
        assert!(step <= 2 || (1..=most).contains(&taken), "{name}, step {step}: memory is taken {taken} times");
        state = next;
    }
}

/// A step takes memory for its vectors: as often on a fine mesh as on a coarse one, and not for each node, point of Γ_C
/// or panel of the factor.
#[test]
fn a_step_takes_memory_for_vectors_alone() {
    for quadrature in ["nodal", "gauss"] {
        for n in [8, 32, 128] {
            let overrides =
                [format!("mesh.n={n}"), "time.steps=12".to_owned(), format!("contact.quadrature={quadrature}")];
            assert_taken(&overrides.join(", "), &common::case("cases/paper.toml", &overrides).problem);
        }
    }
    for n in [3, 6, 12] {
        let overrides: Vec<String> =
            WITH_HEAT.iter().map(|&set| set.to_owned()).chain([format!("mesh.n=[{n}, {n}, {n}]")]).collect();
        let case = case::parse(&Source::new("box.toml", BODY), &overrides);
        assert_taken(&format!("a box of n = {n}"), &case.unwrap_or_else(|faults| panic!("{faults}")).problem);
    }
}
