//! Gravity and the loads of regions: stacks of two materials with closed forms.

use amontons::case::{self, Source};
use amontons::output::Memory;
use amontons::problem::Problem;

use crate::common::{solve, told};

/// A column of height 2 and width 1, ν = 0 and E = 100: the lower half has the density 3, the upper one 5, and the heat
/// conductivity is 2.
fn column(load: &str, regions: &str) -> String {
    format!(
        r#"name = "column"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [
  {{ name = "low", size = [1.0, 1.0], n = [2, 4], elements = "Q2" }},
  {{ name = "high", size = [1.0, 1.0], n = [2, 4], origin = [0, 1], elements = "Q2" }},
]
[time]
end = 1.0
steps = 2
inertia = false
[material]
density = 3
elasticity = {{ law = "isotropic", young = 100, poisson = 0, stress_state = "plane-stress" }}
heat_capacity = 0
conductivity = 2
[load]
{load}
{regions}
[[boundary]]
on = "low_bottom"
displacement = [0, 0]
temperature = 0
[[contact]]
on = "high_bottom"
with = "low_top"
normal = {{ law = "bilateral" }}
friction = {{ law = "stick" }}
heat = {{ law = "constant", conductance = 1e9 }}
"#
    )
}

const HIGH: &str = "[[region]]\non = \"high\"\n[region.material]\ndensity = 5\nelasticity = { law = \"isotropic\", young = 100, poisson = 0, stress_state = \"plane-stress\" }\nheat_capacity = 0\nconductivity = 2\n";

fn problem(text: &str) -> Problem {
    case::parse(&Source::new("column.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

/// u_y or θ at a height of the column at the end; of the two nodes at y = 1 the upper one.
fn value(problem: &Problem, memory: &Memory, y: f64, of_heat: bool) -> f64 {
    let node = problem.mesh.points.iter().rposition(|x| (x[1] - y).abs() < 1e-12).expect("a node");
    let state = memory.states.last().expect("a state");
    if of_heat { state.theta[node] } else { state.u[2 * node + 1] }
}

/// The stress at y is the weight above: u(1) = −(5 + 3/2) g/E, u(2) = u(1) − 5 g/(2E), whatever inertia is.
#[test]
fn gravity_acts_by_the_density_of_each_material() {
    let problem = problem(&column("gravity = [0, \"-4*t\"]", HIGH));
    let memory = solve(&problem);
    let (g, young) = (4.0, 100.0);
    let first = -6.5 * g / young;
    for (y, u) in [(1.0, first), (2.0, first - 2.5 * g / young)] {
        assert!((value(&problem, &memory, y, false) - u).abs() < 1e-11, "{y}");
    }
    let force = &memory.reports.last().expect("a report").reactions.force;
    let held: f64 = force.iter().skip(1).step_by(2).sum();
    assert!((held - 8.0 * g).abs() < 1e-10, "{held}");
}

/// A body force and a heat source of one region, which has the material of the body, add to those of the whole.
#[test]
fn a_region_has_loads_of_its_own() {
    let own = "[[region]]\non = \"high\"\nbody_force = [0, -2]\nheat_source = \"3*t\"\n";
    let problem = problem(&column("body_force = [0, -1]\nheat_source = 0.5", own));
    let memory = solve(&problem);
    // u(1) = −(3 + ½)/E, u(2) = u(1) − 3/(2E); θ(1) = (3.5 + ¼)/k, θ(2) = θ(1) + 3.5/(2k).
    for (y, u, theta) in [(1.0, -0.035, 1.875), (2.0, -0.05, 2.75)] {
        assert!((value(&problem, &memory, y, false) - u).abs() < 1e-11, "{y}");
        assert!((value(&problem, &memory, y, true) - theta).abs() < 1e-8, "{y}");
    }
}

/// What is wrong with them is named.
#[test]
fn faults_are_named() {
    let said = |load: &str, regions: &str| told(&Source::new("case.toml", column(load, regions)), &[]);
    for (load, regions, expected) in [
        ("gravity = [0, -1, 0]", "", "load.gravity: found 3 components, expected 2 components"),
        (
            "gravity = [0, \"x\"]",
            "",
            "load.gravity: found an expression in x, y or z, expected numbers or expressions in t; a force that varies in space is a `body_force`",
        ),
        (
            "",
            "[[region]]\non = \"high\"\nbody_force = [1]",
            "region[0].body_force: found 1 components, expected 2 components",
        ),
        (
            "",
            "[[region]]\non = \"hihg\"\nbody_force = [0, 1]",
            "region[0].on: found \"hihg\", expected one of the regions low, high; did you mean \"high\"?",
        ),
        (
            "",
            "[[region]]\non = \"high\"\nheat_source = 1\n[[region]]\non = \"high\"\nheat_source = 1",
            "region[1].on: found \"high\" again, expected each region in one [[region]] entry",
        ),
    ] {
        let text = said(load, regions);
        assert!(text.contains(expected) && text.lines().count() == 1, "{text}");
    }
    let text = column("gravity = [0, -1]", "").replace("density = 3\n", "");
    let text = told(&Source::new("case.toml", text), &[]);
    assert!(text.contains("material.density: found no such key") && text.lines().count() == 1, "{text}");
}
