//! Heat alone through pairs, gaps and foundations: no mechanics is asked for, and what it would not change stays.

use std::sync::Arc;

use amontons::case::{self, Source};
use amontons::output::Memory;
use amontons::problem::Problem;

use crate::common::{Random, changed, largest, solve, told};

/// Two slabs, 0.5 and 0.3 thick, of conductivity 0.5, between 0 and 100 K. `more` has the keys of the contact.
fn slabs(n: [usize; 2], more: &str) -> String {
    format!(
        r#"name = "slabs"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [
  {{ name = "cold", size = [1.0, 0.5], n = [{}, 4], elements = "Q1" }},
  {{ name = "hot", size = [1.0, 0.3], origin = [0, 0.5], n = [{}, 3], elements = "Q1" }},
]
[time]
end = 1.0
steps = 2
[material]
heat_capacity = 0
conductivity = 0.5
[[boundary]]
on = "cold_bottom"
temperature = 0
[[boundary]]
on = "hot_top"
temperature = 100
[contact]
{more}
"#,
        n[0], n[1]
    )
}

fn problem(text: &str, overrides: &[&str]) -> Problem {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    case::parse(&Source::new("slabs.toml", text), &overrides).unwrap_or_else(|e| panic!("{e}\n{text}")).problem
}

/// The mean temperature of a side at the end.
fn mean(memory: &Memory, problem: &Problem, side: &str) -> f64 {
    let state = memory.states.last().expect("a state");
    let nodes: Vec<u32> = problem.mesh.facets[side].node_list();
    nodes.iter().map(|&node| state.theta[node as usize]).sum::<f64>() / nodes.len() as f64
}

/// The largest difference of the temperatures of a side from a value.
fn off(memory: &Memory, problem: &Problem, side: &str, value: f64) -> f64 {
    let state = memory.states.last().expect("a state");
    let nodes: Vec<u32> = problem.mesh.facets[side].node_list();
    nodes.iter().map(|&node| (state.theta[node as usize] - value).abs()).fold(0.0, f64::max)
}

const PAIR: &str = "on = \"hot_bottom\"\nwith = \"cold_top\"\nheat = { law = \"constant\", conductance = 2.5 }";

/// Resistances in series, 0.3/0.5 + 1/2.5 + 0.5/0.5 = 2: 70 and 50 K on the faces, whatever the meshes, the side that
/// bears the points, the solver and the place.
#[test]
fn two_slabs_are_resistances_in_series() {
    let mut random = Random(11);
    for n in [[4, 6], [7, 3], [5, 5]] {
        for bearing in ["hot_bottom", "cold_top"] {
            for solver in ["direct", "iterative"] {
                let text = slabs(n, &format!("{PAIR}\nnonmortar = \"{bearing}\""));
                let problem = problem(&text, &[&format!("solver.solver=\"{solver}\"")]);
                let (sin, cos) = (3.0 * random.number()).sin_cos();
                let [right, up] = [10.0 * random.number(), 10.0 * random.number()];
                let turned = changed(&problem, |data| {
                    for x in &mut Arc::make_mut(&mut data.mesh).points {
                        *x = [cos * x[0] - sin * x[1] + right, sin * x[0] + cos * x[1] + up, 0.0];
                    }
                });
                let memory = solve(&turned);
                for (side, value) in [("hot_bottom", 70.0), ("cold_top", 50.0)] {
                    let off = off(&memory, &turned, side, value);
                    assert!(off < 1e-8, "{n:?} {bearing} {solver} {side}: {off}");
                }
            }
        }
    }
}

/// Gas conducts over the gap that the bodies leave: 1/h = (d + ℓ)/k, here (0.02 + 0.01)/0.06 = 1/2, and 0.6 + 0.5 + 1
/// in series. A datum takes the place of that gap.
#[test]
fn gaps_conduct_by_their_width() {
    let gas =
        "on = \"cold_top\"\nwith = \"hot_bottom\"\nheat = { law = \"gap\", conductivity = 0.06, roughness = 0.01 }";
    for (more, width) in [("", 0.02), ("gap = 0.05\n", 0.05), ("gap = 0\n", 0.0)] {
        let text = slabs([4, 6], &format!("{more}{gas}")).replace("origin = [0, 0.5]", "origin = [0, 0.52]");
        let problem = problem(&text, &[]);
        let flux = 100.0 / (0.6 + (width + 0.01) / 0.06 + 1.0);
        let memory = solve(&problem);
        for (side, value) in [("hot_bottom", 100.0 - 0.6 * flux), ("cold_top", flux)] {
            let off = off(&memory, &problem, side, value);
            assert!(off < 1e-11, "{more} {side}: {off}");
        }
    }
}

/// A core that makes 5e4 W/m³, a gap of gas and radiation, and a shell. Temperatures of the faces in closed form: P =
/// 2e5 π W, θ = 300 + P/(2π 2.7·10) + P ln(2.7/2.2)/(2π 34.6) on the shell, and on the core that at which the gap
/// passes P.
#[test]
fn a_wide_gap_conducts_and_radiates() {
    let text = r#"name = "vessel"
[mesh]
kind = "blocks"
axisymmetric = true
blocks = [
  { name = "core", size = [2.0, 1.0], n = [40, 2], elements = "Q2" },
  { name = "shell", size = [0.5, 1.0], origin = [2.2, 0], n = [10, 3], elements = "Q2" },
]
[time]
end = 1.0
steps = 1
[material]
heat_capacity = 0
conductivity = 34.6
[load]
heat_source = "if(x < 2.1, 5e4, 0)"
[[boundary]]
on = "shell_right"
convection = { coefficient = 10, ambient = 300 }
[contact]
on = "core_right"
with = "shell_left"
nonmortar = "core_right"
[contact.heat]
law = "sum"
laws = [
  { law = "constant", conductance = 0.5246029 },
  { law = "radiation", emissivity = 0.67692308, absolute_zero = 0.0 },
]
"#;
    let problem = problem(text, &[]);
    let memory = solve(&problem);
    for (side, value) in [("core_right", 4_598.946_601_618), ("shell_left", 4_595.595_069_733)] {
        let found = mean(&memory, &problem, side);
        assert!((found - value).abs() < 1e-5, "{side}: {found}");
    }
}

/// What is solved without mechanics is what tied bodies that do not move have, at every step, with a capacity, too.
#[test]
fn bodies_that_rest_have_the_same_temperatures_as_bodies_that_do_not_move() {
    let capacity = ["time.steps=7", "material.heat_capacity=2", "initial.temperature=\"30 + 10*x\""];
    let alone = problem(&slabs([4, 6], PAIR), &capacity);
    let tied = format!("{PAIR}\nnormal = {{ law = \"bilateral\" }}\nfriction = {{ law = \"stick\" }}");
    let text = slabs([4, 6], &tied)
        .replace("heat_capacity = 0", "density = 1\nelasticity = { law = \"isotropic\", young = 1, poisson = 0, stress_state = \"plane-strain\" }\nheat_capacity = 0")
        .replace("temperature = 0\n", "temperature = 0\ndisplacement = [0, 0]\n");
    let tied = problem(&text, &capacity);
    let [alone, tied] = [alone, tied].map(|problem| solve(&problem));
    for (a, b) in alone.states.iter().zip(&tied.states) {
        let difference: Vec<f64> = a.theta.iter().zip(b.theta.iter()).map(|(a, b)| a - b).collect();
        assert!(largest(&difference) < 1e-11, "{}: {}", a.step, largest(&difference));
    }
    assert_eq!(alone.states.len(), 8);
    for state in &alone.states {
        let ledger = &state.ledger;
        assert!(ledger.heat_closing_error.abs() < 1e-13 * ledger.heat_turned_over, "{}", ledger.heat_closing_error);
    }
}

/// A foundation with a temperature, one with a heat capacity, and an obstacle whose distance grows along the side.
#[test]
fn a_foundation_needs_no_mechanics() {
    let wall = |contact: &str| {
        format!(
            r#"name = "wall"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 0.5]
n = [8, 4]
elements = "Q1"
[time]
end = 1.0
steps = 4
[material]
heat_capacity = 0
conductivity = 0.5
[[boundary]]
on = "top"
temperature = 100
[contact]
on = "bottom"
{contact}
"#
        )
    };
    let prescribed = problem(&wall("heat = { law = \"constant\", conductance = 1, foundation_temperature = 20 }"), &[]);
    // 80 K over 0.5/0.5 + 1/1: half of it over the slab.
    assert!(off(&solve(&prescribed), &prescribed, "bottom", 60.0) < 1e-11);
    let warms = wall(
        "heat = { law = \"constant\", conductance = 1, foundation_temperature = 20 }\nfoundation = { heat_capacity = 3 }",
    );
    let warms = problem(&warms, &[]);
    let memory = solve(&warms);
    // θ_F' = (100 − θ_F)/(R c) with R = 2: backward Euler of four steps of 1/4.
    let mut foundation = 20.0;
    for state in memory.states.iter().skip(1) {
        foundation = (foundation + 0.25 / 6.0 * 100.0) / (1.0 + 0.25 / 6.0);
        let found = state.surface.foundation[0].expect("a temperature");
        assert!((found - foundation).abs() < 1e-11, "{found} {foundation}");
    }
    let wedge = wall(
        "heat = { law = \"expression\", conductance = \"1/(-r + 0.5)\", foundation_temperature = 0 }\nobstacle = { shape = \"plane\", point = [0, -0.25], normal = [-0.6, 0.8] }",
    );
    let wedge = problem(&wedge, &[]);
    let memory = solve(&wedge);
    let flux: Vec<f64> = memory.reports.last().expect("a report").contact.flux.iter().map(|f| f.value).collect();
    for (point, flux) in wedge.contact_boundary().points.iter().zip(flux) {
        let distance = 0.8 * 0.25 - 0.6 * point.x[0];
        let state = memory.states.last().expect("a state");
        let theta = state.theta[point_node(&wedge, point.x)];
        assert!((flux - theta / (distance + 0.5)).abs() < 1e-11 * flux, "{flux} {theta} {distance}");
    }
}

fn point_node(problem: &Problem, x: [f64; 3]) -> usize {
    problem.mesh.points.iter().position(|p| p.map(f64::to_bits) == x.map(f64::to_bits)).expect("a node")
}

/// Where no heat flows, both slabs have the temperature of their ends, which may be any number: the flux that the
/// law has for the last bits of equal temperatures is none. So it is on a layer as on one that hardly resists.
#[test]
fn no_heat_flows_between_equal_temperatures() {
    for (ends, conductance) in [("both", 2.5), ("both", 1e9), ("both", 1e-3), ("one", 2.5), ("one", 313.0)] {
        for temperature in [17.3, 293.15, -1.1e3] {
            for analysis in ["steps = 2", "analysis = \"steady\""] {
                let pair = PAIR.replace("2.5", &format!("{conductance:?}"));
                let hot = "[[boundary]]\non = \"hot_top\"\ntemperature = 100\n";
                let at_hot =
                    if ends == "both" { hot.replace("100", &format!("{temperature:?}")) } else { String::new() };
                let text = slabs([5, 7], &pair)
                    .replace(hot, &at_hot)
                    .replace("temperature = 0\n", &format!("temperature = {temperature:?}\n"))
                    .replace("steps = 2", analysis);
                let problem = problem(&text, &[]);
                let memory = solve(&problem);
                let state = memory.states.last().expect("a state");
                let off = state.theta.iter().map(|theta| (theta - temperature).abs()).fold(0.0, f64::max);
                assert!(off < 1e-12 * temperature.abs(), "{off:e}\n{text}");
            }
        }
    }
}

/// What only mechanics gives is named, a line each.
#[test]
fn keys_of_mechanics_are_named() {
    let said = |more: &str| told(&Source::new("slabs.toml", slabs([4, 6], &format!("{PAIR}\n{more}"))), &[]);
    let alone = "in a case without mechanics, expected keys of heat only: no material has any of mechanics; remove it, or give material.density and material.elasticity";
    for (key, value, found) in [
        ("normal", "{ law = \"signorini\" }", "a law of contact pressure"),
        ("friction", "{ law = \"coulomb\", coefficient = 0.3 }", "friction"),
        ("wear", "{ law = \"archard\", coefficient = 1e-9 }", "wear"),
        ("frictional_heat", "0.5", "heat of friction"),
        ("foundation_velocity", "[1, 0]", "a velocity of the foundation"),
    ] {
        let text = said(&format!("{key} = {value}"));
        assert!(text.ends_with(&format!("contact.{key}: found {found} {alone}")), "{text}");
        assert_eq!(text.lines().count(), 1, "{text}");
    }
    for (law, found) in [
        ("{ law = \"pressure\", coefficient = 2 }", "a conductance of the pressure"),
        ("{ law = \"ramp\", conductance = 2, width = 1e-3 }", "a conductance of the penetration"),
        ("{ law = \"power\", coefficient = 2, exponent = 1 }", "a conductance of the penetration"),
        ("{ law = \"expression\", conductance = \"2 + p\" }", "a conductance of the pressure"),
    ] {
        let text = slabs([4, 6], PAIR).replace("{ law = \"constant\", conductance = 2.5 }", law);
        let text = told(&Source::new("slabs.toml", text), &[]);
        assert!(text.ends_with(&format!("contact.heat: found {found} {alone}")), "{text}");
    }
    // With mechanics the law of the pressure is missing.
    let text = slabs([4, 6], PAIR).replace("heat_capacity = 0", "density = 1\nelasticity = { law = \"isotropic\", young = 1, poisson = 0, stress_state = \"plane-strain\" }\nheat_capacity = 0");
    let text = told(&Source::new("slabs.toml", text), &[]);
    assert!(text.contains("contact.normal: found no such key, expected a table"), "{text}");
    assert_eq!(text.lines().count(), 1, "{text}");
}
