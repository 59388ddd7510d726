//! How often a step takes memory: never, once the first steps have taken it. A program of its own, because lists of
//! other tests would come between.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[macro_use]
#[path = "../common/body.rs"]
mod body;
#[path = "../common/mod.rs"]
mod common;

use amontons::case::{self, Source};
use amontons::problem::Problem;
use amontons::scheme::{BackwardEuler, Scheme};
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

/// Benchmarks of further laws and supports. Not those of bodies that contact alone holds, whose motions are looked at
/// in each step, and of pairs that wear, whose depths are: they take memory for it.
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

/// How often memory is taken for the factor of a contact pattern that is new, as long as less than eight are kept: for
/// the matrix, its two permutations, and what tells the pattern from others.
const FACTOR: usize = 6;

/// How often each step takes memory, but for factors that are new. On one thread, so that all of a step is counted.
fn taken(problem: &Problem) -> Vec<usize> {
    let mut scheme = BackwardEuler::new(problem).expect("a regular system");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut state = scheme.initial().expect("finite initial data");
    let step = |_| {
        let (before, mut made) = (scheme.factorizations().1, None);
        let taken = pool.install(|| allocation_counter::measure(|| made = Some(scheme.step(&state)))).count_total;
        state = made.expect("a result").expect("a step").0;
        (taken as usize).saturating_sub(FACTOR * (scheme.factorizations().1 - before))
    };
    (0..problem.steps).map(step).collect()
}

/// A step that needs more lists at once than any before it takes memory; the first one for all of them. Otherwise what
/// was taken is told.
fn told(name: &str, problem: &Problem) -> Option<String> {
    let taken = taken(problem);
    let (first, later) = taken.split_first().expect("a step");
    assert!(*first > 0, "{name}: nothing is counted");
    let holds = later.iter().sum::<usize>() <= 8 && later[problem.steps / 2..].iter().all(|taken| *taken == 0);
    (!holds).then(|| format!("{name}: {:?}", &taken[..taken.len().min(50)]))
}

/// The paper's case and a box, of few cells and of many. And further laws and supports: Signorini's contact, obstacles,
/// pairs, springs, supports that move, creep. In one test: lists of several would come
/// between.
#[test]
fn steps_take_no_memory() {
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
    let told: Vec<String> = problems.iter().filter_map(|(name, problem)| told(name, problem)).collect();
    assert!(told.is_empty(), "{}", told.join("\n"));
}
