//! What several tests need: the paper's case with overrides, and relative differences.
#![allow(dead_code, reason = "each test uses its part")]
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

pub mod interrupts;

use std::path::{Path, PathBuf};

use amontons::case::{self, Case, Source};
use amontons::output::Memory;
use amontons::problem::{BoundaryCondition, Problem, ProblemData};
use amontons::run::{self, Settings};
use amontons::state::State;
use amontons::step::{March, Scheme};
use amontons::verify::{Verdict, verify_case};

/// A square with every term, of few cells, for spoiled data.
pub const SMALL: &str = r#"
name = "small"
[mesh]
kind = "rectangle"
size = [1.0, 1.0]
n = 2
diagonal = "right"
[time]
end = 1.0
steps = 4
[material]
density = 1.0
heat_capacity = 1.0
conductivity = 1.0
expansion = 0.3
coupling = 0.2
elasticity = { law = "isotropic", young = 10.0, poisson = 0.3, stress_state = "plane-strain" }
viscosity = { law = "lame", first = 0.1, second = 0.2 }
[contact]
on = "bottom"
normal = { law = "compliance", stiffness = 100 }
friction = { law = "coulomb", coefficient = 0.3 }
heat = { law = "ramp", conductance = 1, width = 1e-3, foundation_temperature = 0.5 }
[[boundary]]
on = "top"
displacement = [0, 0]
temperature = 0
"#;

/// A file of the repository.
pub fn file(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// A shipped case with overrides.
pub fn case(path: &str, overrides: &[String]) -> Case {
    case::read(&file(path), overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// The paper's example with overrides.
pub fn paper(overrides: &[&str]) -> Case {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    case("cases/paper.toml", &overrides)
}

/// Data that have to pass the checks.
pub fn checked(data: ProblemData) -> Problem {
    data.check().unwrap_or_else(|faults| panic!("{faults}"))
}

/// A problem with other data, which have to pass the checks.
pub fn changed(problem: &Problem, change: impl FnOnce(&mut ProblemData)) -> Problem {
    problem.with(change).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Overrides that turn the default reading of the paper's tensors into another.
pub fn reading(name: &str) -> Vec<String> {
    let overrides: &[&str] = match name {
        "MR" => &[],
        "identity" => &["material.expansion=1", "material.coupling=1", "material.conductivity=1"],
        "literal" => &["material.conductivity=[[1, 1], [1, 1]]"],
        _ => panic!("no reading {name}"),
    };
    overrides.iter().map(|&o| o.to_owned()).collect()
}

/// Largest absolute value.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// Numbers in [−1, 1) that are the same in every run (xorshift; Marsaglia, 2003).
pub struct Random(pub u64);

impl Random {
    pub fn number(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A text with a piece of it, which must occur once, replaced.
pub fn spoil(text: &str, old: &str, new: &str) -> String {
    assert!(old.is_empty() || text.matches(old).count() == 1, "`{old}` does not occur once");
    if old.is_empty() { text.to_owned() } else { text.replace(old, new) }
}

/// What is said about a case that has faults.
pub fn told(source: &Source, overrides: &[&str]) -> String {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    case::parse(source, &overrides).map_or_else(|error| error.to_string(), |_| "no fault".to_owned())
}

/// A random state in the plane, smooth or rough, with sizes over four orders of magnitude.
pub fn disturb(state: &mut State, problem: &Problem, scheme: &March, random: &mut Random, smooth: bool) {
    let size = [-2.5, -1.0, 1.0].map(|centre: f64| 10f64.powf(centre + 2.0 * random.number()));
    let wave = [0; 4].map(|_: i32| 20.0 * random.number());
    for (i, p) in problem.mesh.points.iter().enumerate() {
        for c in 0..2 {
            let dof = 2 * i + c;
            if scheme.discretization().v.free[dof] {
                let phase = c as f64;
                state.u[dof] =
                    size[0] * if smooth { (wave[0] * p[0] + wave[1] * p[1] + phase).sin() } else { random.number() };
                state.w[dof] =
                    size[1] * if smooth { (wave[2] * p[0] + wave[3] * p[1] + phase).cos() } else { random.number() };
            }
        }
        if scheme.discretization().q.free[i] {
            state.theta[i] = size[2] * random.number();
        }
    }
    for q in &mut state.multipliers.q {
        q[0] = 10.0 * random.number();
    }
}

/// A rod of length 1 and height 1/4 in plane stress, on rollers at its left and lower side, pulled at its right end by
/// the traction `pull`; without inertia and contact.
pub fn rod(steps: usize, pull: f64) -> ProblemData {
    let overrides = [format!("time.steps={steps}"), "time.end=1".to_owned()];
    let mut problem = case("crates/amontons/benchmarks/kelvin-voigt-rod.toml", &overrides).problem.into_data();
    let roller = |on: &str, free: usize| {
        let displacement = Some((0..2).map(|c| if c == free { None } else { Some(0.0.into()) }).collect());
        BoundaryCondition { displacement, ..BoundaryCondition::on(on) }
    };
    let pulled = BoundaryCondition::on("right").traction([pull, 0.0]);
    problem.boundary = vec![roller("left", 1), roller("bottom", 0), pulled];
    problem.contacts.clear();
    problem
}

/// A run with every state and report, without a certificate.
pub fn solve(problem: &Problem) -> Memory {
    let mut memory = Memory::new().states_every(1).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    run::run(problem, &settings, &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    memory
}

/// Runs all cases of a folder; every value of their `[expected]` and `[verify]` holds. The number of cases that have
/// some.
pub fn verified(folder: &Path) -> usize {
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("a folder of cases").flatten() {
        let path = entry.path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let source = case::source(&path).expect("a readable case");
        let settings = Settings { certificate: false, ..Settings::default() };
        let verdicts = verify_case(&source, &[], &settings).unwrap_or_else(|error| panic!("{}: {error}", source.name));
        for Verdict { holds, what, computed, reference, .. } in &verdicts {
            assert!(holds, "{}: {what} is {computed:e}, expected {reference:e}", path.display());
        }
        count += usize::from(!verdicts.is_empty());
    }
    count
}
