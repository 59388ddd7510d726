//! Memory that steps keep: none, once the first steps have made the factors. A program of its own, because other tests
//! would come between.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[macro_use]
#[path = "../common/body.rs"]
mod body;
#[path = "../common/mod.rs"]
mod common;

use amontons::case::{self, Source};
use amontons::problem::Problem;
use amontons::step::{March, Scheme};
use amontons::verify::{BENCHMARKS, benchmark};

/// A box on a layer with friction and heat, held at its top.
const BOX: &str = body!(
    "kind = \"box\", size = [1.0, 1.0, 1.0], n = 4",
    "end = 1.0, steps = 48",
    1.0,
    "young = 2.0, poisson = 0.3",
    r#"
heat_capacity = 1.0
conductivity = 1.0
viscosity = { law = "lame", first = 10.0, second = 10.0 }
[load]
body_force = ["0.3*sin(9*t)", 0.0, -1.0]
heat_source = 1.0
[contact]
on = "bottom"
normal = { law = "compliance", stiffness = 1e4 }
friction = { law = "coulomb", coefficient = 0.2 }
heat = { law = "ramp", conductance = 1.0, width = 1e-5, foundation_temperature = 0.0 }
[[boundary]]
on = "top"
displacement = [0, 0, 0]
temperature = 0
[solver]
solver = "direct"
"#
);

/// Benchmarks of further laws and supports.
const NAMES: [&str; 10] = [
    "bouncing-bar-signorini",
    "bowl-oscillation",
    "conveyor-drift",
    "creep-standard-linear-solid",
    "manufactured-b-time",
    "obstacle-plane-stick",
    "pair-dragged-block",
    "pair-friction-heat",
    "rod-on-springs",
    "stribeck-steady-sliding",
];

/// The most bytes that the second half of the steps may keep, per step.
const KEPT: i64 = 64;

/// The bytes that each step keeps beyond the state that it replaces, zero of a step with a contact pattern that is new:
/// its factor is kept, of up to eight patterns. On one thread, so that all of a step is counted.
fn kept(problem: &Problem) -> Vec<i64> {
    let mut scheme = March::new(problem).expect("a regular system");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut state = Some(scheme.initial().expect("finite initial data"));
    let step = |_| {
        let before = scheme.solvers().factorizations[1];
        let advance = || {
            let old = state.take().expect("a state");
            state = Some(scheme.step(&old).expect("a step").0);
        };
        let measured = pool.install(|| allocation_counter::measure(advance));
        assert!(measured.count_total > 0, "nothing is counted");
        if scheme.solvers().factorizations[1] == before { measured.bytes_current } else { 0 }
    };
    (0..problem.timeline.steps()).map(step).collect()
}

/// The name of a problem whose later steps keep memory, with the bytes of each step.
fn growing(name: &str, problem: &Problem) -> Option<String> {
    let kept = kept(problem);
    let later = &kept[problem.timeline.steps() / 2..];
    let grows = later.iter().sum::<i64>() > KEPT * later.len() as i64;
    grows.then(|| format!("{name}: {:?}", &kept[..kept.len().min(50)]))
}

/// The paper's case and a box, of few cells and of many. And further laws and supports: Signorini's contact, obstacles,
/// pairs, springs, supports that move, creep. In one test: the memory of several would be counted together.
#[test]
fn later_steps_keep_no_memory() {
    let mut problems = Vec::new();
    for quadrature in ["nodal", "gauss"] {
        for n in [8, 32, 128] {
            let overrides =
                [format!("mesh.n={n}"), "time.steps=40".to_owned(), format!("contact.quadrature={quadrature}")];
            problems.push((overrides.join(", "), common::case("cases/paper.toml", &overrides).problem));
        }
    }
    for n in [3, 6, 10] {
        let case = case::parse(&Source::new("box.toml", BOX), &[format!("mesh.n={n}")]);
        problems.push((format!("a box of n = {n}"), case.unwrap_or_else(|faults| panic!("{faults}")).problem));
    }
    for (name, text) in BENCHMARKS.iter().filter(|(name, _)| NAMES.contains(name)) {
        let case = case::parse(&benchmark(name, text), &["solver.solver=direct".to_owned()]);
        problems.push(((*name).to_owned(), case.unwrap_or_else(|faults| panic!("{faults}")).problem));
    }
    let growing: Vec<String> = problems.iter().filter_map(|(name, problem)| growing(name, problem)).collect();
    assert!(growing.is_empty(), "{}", growing.join("\n"));
}
