//! Derivatives of runs: an independent program, closed forms, differences of whole runs.

use amontons::adjoint::{GradientError, GradientRequest, GradientTable, Parameter, gradient};
use amontons::case::{self, Case, Source};
use amontons::problem::{Fault, Problem};

use super::common::file;

pub(super) fn read(path: &str) -> String {
    std::fs::read_to_string(file(path)).expect("a file")
}

/// The text of a case whose derivatives are known.
pub(super) fn source(name: &str) -> Source {
    let path = format!("crates/amontons/tests/reference/gradients/{name}.toml");
    Source::new(name, read(&path))
}

pub(super) fn parsed(source: &Source, overrides: &[String]) -> Case {
    case::parse(source, overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// What a parameter sets, by its value.
pub(super) type Overrides = Box<dyn Fn(f64) -> Vec<String>>;

fn key(key: &'static str) -> Overrides {
    Box::new(move |value| vec![format!("{key}={value:e}")])
}

pub(super) fn parameter<'a>(source: &'a Source, (name, value): (&str, f64), sets: &'a Overrides) -> Parameter<'a> {
    let problem = move |value: f64| -> Result<Problem, Fault> { Ok(parsed(source, &sets(value)).problem) };
    Parameter { name: name.to_owned(), value, problem: Box::new(problem) }
}

/// The overrides of a parameter of a case of `gradients.csv`.
pub(super) fn overrides(case: &str, parameter: &str) -> Overrides {
    let expression = |of: fn(f64) -> String| -> Overrides { Box::new(move |value| vec![of(value)]) };
    match (case, parameter) {
        ("pair", "young_1") => key("material.elasticity.young"),
        ("pair", "young_2") => key("region[0].material.elasticity.young"),
        (_, "young") => key("material.elasticity.young"),
        (_, "mu") => key("contact.friction.coefficient"),
        (_, "stiffness") => key("contact.normal.stiffness"),
        (_, "gap") => key("contact.gap"),
        (_, "kappa") => key("contact.wear.coefficient"),
        (_, "eta") => key("contact.frictional_heat"),
        (_, "theta_F") => key("contact.heat.foundation_temperature"),
        ("paper-8", "conductance") => key("contact.heat.conductance"),
        (_, "conductance") => key("contact.heat.coefficient"),
        ("thermal-pressure", "belt") => expression(|v| format!("contact.foundation_velocity=[\"{v:e}*(1 + t)\", 0]")),
        ("wear", "belt") => expression(|v| format!("contact.foundation_velocity=[{v:e}, 0]")),
        ("rod" | "rod-dynamic", "amplitude") => expression(|v| format!("boundary[0].displacement=[\"{v:e}*t\"]")),
        ("block-stick-slip", "amplitude") => {
            expression(|v| format!("boundary[0].displacement=[\"{v:e}*0.8*sin(3*t)\", \"-{v:e}*t\"]"))
        }
        ("thermal-pressure", "amplitude") => expression(|v| format!("boundary[0].displacement=[\"0\", \"-{v:e}*t\"]")),
        ("wear", "amplitude") => expression(|v| format!("boundary[0].displacement=[\"0\", \"-{v:e}*min(2*t, 1)\"]")),
        ("pair", "amplitude") => expression(|v| format!("boundary[1].traction=[\"{v:e}*sin(3*t)\", -1.0]")),
        ("paper-8", "amplitude") => expression(|v| format!("boundary[1].traction=[{:e}, {:e}]", 1.4 * v, 0.4 * v)),
        _ => panic!("{case}: {parameter}"),
    }
}

/// The name of an output of `gradients.csv`, and the sign of its value.
pub(super) fn output(case: &str, name: &str) -> (String, f64) {
    let text = match name {
        "displacement_x" => "corner_x",
        "displacement" => "end_x",
        "force_x" => "final.contact.force.0",
        "force_y" => "final.contact.force.1",
        "friction_work" => "energy.friction_dissipation",
        "wear_volume" => "final.contact.wear_volume",
        other => other,
    };
    // Of a pair the force on the side `on`, the lower block.
    let sign = if case == "pair" && name.starts_with("force") { -1.0 } else { 1.0 };
    (text.to_owned(), sign)
}

/// A row of `gradients.csv`.
pub(super) struct Known {
    pub output: String,
    pub parameter: String,
    pub at: f64,
    pub value: f64,
    pub derivative: f64,
}

pub(super) fn known(case: &str) -> Vec<Known> {
    let text = read("crates/amontons/tests/reference/gradients/gradients.csv");
    let rows = text.lines().skip(1).filter_map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |i: usize| cells[i].parse().expect("a number");
        (cells[0] == case).then(|| Known {
            output: cells[1].to_owned(),
            parameter: cells[2].to_owned(),
            at: number(3),
            value: number(4),
            derivative: number(5),
        })
    });
    rows.collect()
}

pub(super) fn unique(all: impl Iterator<Item = String>) -> Vec<String> {
    let mut seen: Vec<String> = Vec::new();
    all.for_each(|one| {
        if !seen.contains(&one) {
            seen.push(one);
        }
    });
    seen
}

/// The derivatives of a case by parameters with their values.
fn derivatives(source: &Source, outputs: &[String], parameters: &[(String, f64, Overrides)]) -> GradientTable {
    let base = parsed(source, &[]);
    let parameters: Vec<Parameter> =
        parameters.iter().map(|(name, value, sets)| parameter(source, (name, *value), sets)).collect();
    let request = GradientRequest {
        problem: &base.problem,
        probes: &base.probes,
        outputs,
        parameters: &parameters,
        memory: None,
        interrupt: None,
    };
    gradient(&request).expect("a gradient")
}

/// Compares a case with `gradients.csv` to 1e-8 of the larger of derivative and 1e-6 times value over parameter.
fn compare(case: &str, margin: Option<f64>) {
    let (source, known) = (source(case), known(case));
    let outputs = unique(known.iter().map(|row| row.output.clone()));
    let names = unique(known.iter().map(|row| row.parameter.clone()));
    let parameters: Vec<(String, f64, Overrides)> = names
        .iter()
        .map(|name| {
            let at = known.iter().find(|row| row.parameter == *name).expect("a row").at;
            (name.clone(), at, overrides(case, name))
        })
        .collect();
    let asked: Vec<String> = outputs.iter().map(|name| output(case, name).0).collect();
    let found = derivatives(&source, &asked, &parameters);
    let mut worst: f64 = 0.0;
    for row in &known {
        let i = outputs.iter().position(|name| *name == row.output).expect("an output");
        let j = names.iter().position(|name| *name == row.parameter).expect("a parameter");
        let sign = output(case, &row.output).1;
        let (value, derivative) = (sign * found.outputs[i].1, sign * found.derivatives[i][j]);
        let scale = if row.at == 0.0 { 0.0 } else { 1e-6 * (row.value / row.at).abs() };
        let error = (derivative - row.derivative).abs() / row.derivative.abs().max(scale);
        worst = worst.max(error);
        println!(
            "{case}: d {} / d {}: {derivative:e}, expected {:e}: {error:.1e}",
            row.output, row.parameter, row.derivative
        );
        assert!((value - row.value).abs() <= 1e-9 * row.value.abs(), "{} {value:e} {:e}", row.output, row.value);
    }
    println!("{case}: worst {worst:.2e}, margin {:?} at {:?}", found.margin, found.nearest);
    assert!(worst <= 1e-8, "{case}: {worst:e}");
    if let Some(margin) = margin {
        let found = found.margin.expect("a margin");
        assert!((found - margin).abs() <= 1e-6 * margin, "{case}: margin {found:e}, expected {margin:e}");
    }
}

#[test]
fn a_rod_has_the_derivatives_of_its_closed_form() {
    compare("rod", None);
}

#[test]
fn a_dynamic_rod_agrees_with_an_independent_program() {
    compare("rod-dynamic", None);
}

#[test]
fn stick_and_slip_agree_with_an_independent_program() {
    compare("block-stick-slip", Some(0.009_727_076_120_470_23));
}

#[test]
fn the_example_of_the_paper_agrees_with_an_independent_program() {
    compare("paper-8", Some(0.002_396_641_413_014_182));
}

#[test]
fn a_pair_agrees_with_an_independent_program() {
    compare("pair", Some(0.004_192_077_153_719_218_6));
}

#[test]
fn conductance_by_pressure_agrees_with_an_independent_program() {
    compare("thermal-pressure", Some(0.166_714_710_465_794_6));
}

#[test]
fn wear_agrees_with_an_independent_program() {
    compare("wear", Some(0.177_910_043_341_817_85));
}

/// One step of a block that touches all along: no point slips, one of them is at its bound.
const FIRST_SLIP: &str = r#"
name = "block-first-slip"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 0.5]
n = [4, 2]
diagonal = "right"
[time]
end = 1.0
steps = 1
[material]
density = 0.0
elasticity = { law = "isotropic", young = 50.0, poisson = 0.0, stress_state = "plane-strain" }
[[boundary]]
on = "top"
traction = [0.22110114385648322, -1.0]
[contact]
on = "bottom"
gap = 0.0
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.5 }
[[probe]]
name = "corner"
quantity = "displacement"
at = [1.0, 0.5]
[[probe]]
name = "pressure"
quantity = "pressure"
at = [0.5, 0.0]
"#;

/// Derivatives of a text by keys.
pub(super) fn by_keys(
    text: &str,
    outputs: &[&str],
    keys: &[&str],
    memory: Option<usize>,
) -> Result<GradientTable, GradientError> {
    let source = Source::new("case", text);
    let base = parsed(&source, &[]);
    let outputs: Vec<String> = outputs.iter().map(ToString::to_string).collect();
    let made = keys.iter().map(|key| case::parameter(&source, &[], key).map_err(|fault| fault.to_string()));
    let parameters = made.collect::<Result<Vec<Parameter>, String>>().expect("parameters");
    gradient(&GradientRequest {
        problem: &base.problem,
        probes: &base.probes,
        outputs: &outputs,
        parameters: &parameters,
        memory,
        interrupt: None,
    })
}

/// A rod whose contact is just reached at the end has two one-sided derivatives, in closed form.
#[test]
fn a_rod_that_just_touches_has_both_one_sided_derivatives() {
    let source = Source::new("rod", source("rod").text.replace("0.1*t", "0.02*t"));
    let parameters = ["amplitude", "gap"].map(|name| (name.to_owned(), 0.02, overrides("rod", name)));
    let found = derivatives(&source, &["end_x".to_owned(), "pressure".to_owned()], &parameters);
    assert!(found.margin.is_some_and(|margin| margin <= 1e-12) && found.ties == 1, "{found:?}");
    let beyond = found.beyond.expect("the other side");
    let (apart, pressed) =
        if found.derivatives[1][0] == 0.0 { (found.derivatives, beyond) } else { (beyond, found.derivatives) };
    let close = |a: &[Vec<f64>], b: [[f64; 2]; 2]| {
        for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
            assert!((a - b).abs() <= 1e-9, "{a} {b}");
        }
    };
    close(&apart, [[1.0, 0.0], [0.0, 0.0]]);
    close(&pressed, [[0.25, 0.75], [7.5, -7.5]]);
}

/// At the amplitude at which the first point reaches its bound the derivatives of the sides of sticking and of slipping
/// are those of an independent program.
#[test]
fn a_point_at_its_bound_has_both_one_sided_derivatives() {
    let text = read("crates/amontons/tests/reference/gradients/kinks.json");
    let known: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let known = &known["block-first-slip"];
    let source = Source::new("first-slip", FIRST_SLIP);
    let amplitude: Overrides = Box::new(|value| vec![format!("boundary[0].traction=[{value:e}, -1.0]")]);
    let parameters = [
        ("young".to_owned(), 50.0, key("material.elasticity.young")),
        ("mu".to_owned(), 0.5, key("contact.friction.coefficient")),
        ("gap".to_owned(), 0.0, key("contact.gap")),
        ("amplitude".to_owned(), 0.221_101_143_856_483_22, amplitude),
    ];
    let names = ["force_x", "force_y", "friction_work"];
    let outputs: Vec<String> = names.iter().map(|name| output("block", name).0).collect();
    let found = derivatives(&source, &outputs, &parameters);
    assert!(found.margin.is_some_and(|margin| margin <= 1e-9) && found.ties == 1, "{found:?}");
    let of = |side: &str, i: usize, j: usize| known[side][names[i]][&parameters[j].0].as_f64().expect("a number");
    let differs = |found: &[Vec<f64>], side: &str| -> f64 {
        let all = (0..names.len()).flat_map(|i| (0..parameters.len()).map(move |j| (i, j)));
        all.map(|(i, j)| (found[i][j] - of(side, i, j)).abs()).fold(0.0, f64::max)
    };
    let beyond = found.beyond.as_ref().expect("the other side");
    println!("first slip: {:?} {:?}", found.derivatives, beyond);
    let [here, there] = [[&found.derivatives, beyond], [beyond, &found.derivatives]]
        .map(|[stick, slip]| differs(stick, "stick_side").max(differs(slip, "slip_side")));
    assert!(here.min(there) <= 1e-9, "{here:e} {there:e}");
}

/// A turned body with a Maxwell branch, heat, friction of the slip speed and wear of the temperature.
pub(super) const TURNED: &str = r#"
name = "turned"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [{ name = "body", size = [1.0, 0.5], n = [4, 2], diagonal = "right", turn = { angle = 0.4 } }]
[time]
end = 1.0
steps = 6
[material]
density = 1.3
heat_capacity = 2.0
expansion = 1.5
coupling = 0.4
conductivity = 0.8
elasticity = { law = "isotropic", young = 100.0, poisson = 0.3, stress_state = "plane-strain" }
viscosity = { law = "lame", first = 0.2, second = 0.5 }
prony = [{ ratio = 0.4, time = 0.3 }]
[load]
body_force = [0.3, -1.1]
heat_source = 0.5
[initial]
temperature = 1.0
velocity = [0.01, -0.02]
[[boundary]]
on = "body_top"
displacement = ["0.014*t", "-0.021*t"]
temperature = 1.0
[[boundary]]
on = "body_left"
traction = ["0.4*sin(2*t)", 0.3]
[contact]
on = "body_bottom"
gap = -0.002
normal = { law = "damped", stiffness = 4000.0, damping = 7.0 }
friction = { law = "static-kinetic", static = 0.4, kinetic = 0.3, decay_speed = 0.2 }
foundation_velocity = ["0.2*(1 + t)*cos(0.4)", "0.2*(1 + t)*sin(0.4)"]
frictional_heat = 0.6
heat = { law = "pressure", coefficient = 0.5, exponent = 0.95, foundation_temperature = 3.0 }
wear = { law = "archard-temperature", temperature = [0.0, 4.0], coefficient = [0.001, 0.004] }
[[probe]]
name = "corner"
quantity = "displacement"
at = [0.6, 0.4]
[[probe]]
name = "stress"
quantity = "von_mises"
at = [0.3, 0.4]
[[probe]]
name = "pressure"
quantity = "pressure"
on = "body_bottom"
take = "integral"
[[probe]]
name = "warm"
quantity = "temperature"
on = "body_bottom"
take = "mean"
"#;

/// A block in space that slides on a rigid foundation in a direction that turns.
pub(super) const IN_SPACE: &str = r#"
name = "in-space"
units = "dimensionless"
[mesh]
kind = "box"
size = [1.0, 0.8, 0.5]
n = [2, 2, 1]
[time]
end = 1.0
steps = 5
[material]
density = 1.0
elasticity = { law = "isotropic", young = 50.0, poisson = 0.3 }
viscosity = { law = "lame", first = 0.5, second = 1.0 }
[[boundary]]
on = "top"
displacement = ["0.012*sin(3*t)", "-0.02*t", "0.009*t*t"]
[contact]
on = "bottom"
gap = 0.0011
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.25 }
foundation_velocity = ["0.02*t", 0, "0.03*(1 - t)"]
[[probe]]
name = "corner"
quantity = "displacement"
at = [0.0, 0.0, 0.0]
[[probe]]
name = "pressure"
quantity = "pressure"
on = "bottom"
take = "mean"
"#;

/// Compares the derivatives of a text by keys with differences of runs: their errors fall with the square of the step.
fn check_by_runs(text: &str, outputs: &[&str], keys: &[&str]) {
    let found = by_keys(text, outputs, keys, None).expect("a gradient");
    let known = derivatives_by_runs(&Source::new("case", text), outputs, keys, [4e-3, 2e-3, 1e-3]);
    for (j, key) in keys.iter().enumerate() {
        for (i, output) in outputs.iter().enumerate() {
            let exact = found.derivatives[i][j];
            let [a, b, c] = known[j].each_ref().map(|all| all[i] - exact);
            let scale = exact.abs().max(1e-3 * (found.outputs[i].1 / found.parameters[j].1).abs());
            println!("{output} by {key}: {exact:e}, {:.1e} {:.1e} {:.1e}", a / scale, b / scale, c / scale);
            let is_small = [a, b, c].iter().all(|error| error.abs() <= 1e-8 * scale);
            let falls = (a / b - 4.0).abs() < 0.2 && (b / c - 4.0).abs() < 0.4;
            assert!(c.abs() <= 1e-4 * scale && (is_small || falls), "{output} by {key}: {a:e} {b:e} {c:e}");
        }
    }
}

/// Differences of whole runs approach the derivatives with the square of the step.
#[test]
fn differences_of_runs_approach_the_derivatives() {
    let outputs = ["corner_x", "stress", "pressure", "warm", "final.contact.force.1", "energy.friction_dissipation"];
    let keys = [
        "material.elasticity.poisson",
        "material.density",
        "material.prony[0].time",
        "contact.normal.damping",
        "contact.friction.static",
        "contact.heat.exponent",
        "contact.wear.coefficient[1]",
        "initial.velocity[1]",
        "time.end",
        "mesh.blocks[0].size[0]",
        "mesh.blocks[0].turn.angle",
        "load.body_force[1]",
    ];
    check_by_runs(TURNED, &outputs, &keys);
}

/// In space the direction of slip turns with the load.
#[test]
fn differences_of_runs_approach_the_derivatives_in_space() {
    let outputs = ["corner_x", "corner_z", "pressure", "final.contact.force.0", "final.contact.force.2"];
    let keys = ["material.elasticity.young", "contact.friction.coefficient", "contact.gap", "mesh.size[1]"];
    check_by_runs(IN_SPACE, &outputs, &keys);
}

/// Central differences of whole runs, by key, relative step and output.
fn derivatives_by_runs(source: &Source, outputs: &[&str], keys: &[&str], steps: [f64; 3]) -> Vec<[Vec<f64>; 3]> {
    let values = |key: &str, value: f64| -> Vec<f64> {
        let case = parsed(source, &[format!("{key}={value:?}")]);
        let outputs: Vec<String> = outputs.iter().map(ToString::to_string).collect();
        let request = GradientRequest {
            problem: &case.problem,
            probes: &case.probes,
            outputs: &outputs,
            parameters: &[],
            memory: None,
            interrupt: None,
        };
        gradient(&request).expect("values").outputs.into_iter().map(|(_, value)| value).collect()
    };
    let of = |key: &&str| {
        let at = case::parameter(source, &[], key).expect("a parameter").value;
        steps.map(|step| {
            let h = step * at;
            let (below, above) = (values(key, at - h), values(key, at + h));
            above.iter().zip(&below).map(|(above, below)| (above - below) / (2.0 * h)).collect()
        })
    };
    keys.iter().map(of).collect()
}

/// States that do not fit in memory are made again; the derivatives are the same.
#[test]
fn states_that_are_made_again_give_the_same_derivatives() {
    let text = source("thermal-pressure").text;
    let of = |memory| by_keys(&text, &["pressure", "warm_x"][..1], &["contact.friction.coefficient"], memory);
    let (kept, again) = (of(None).expect("a gradient"), of(Some(0)).expect("a gradient"));
    let [kept, again] = [kept, again].map(|found| found.derivatives[0][0]);
    assert!((kept - again).abs() <= 1e-10 * kept.abs(), "{kept:e} {again:e}");
}

/// What has no derivative is refused by name, with the place, the value found and the expected ones.
#[test]
fn what_has_no_derivative_is_refused() {
    let text = source("block-stick-slip").text;
    let told =
        |text: &str, outputs: &[&str], keys: &[&str]| by_keys(text, outputs, keys, None).unwrap_err().to_string();
    let young = ["material.elasticity.young"];
    let tool = "obstacle = { shape = \"plane\", point = [0, 0], normal = [0, 1], geometry = \"updated\" }";
    for (at, more, words) in [
        ("steps = 20", "scheme = \"contact-stabilised\"", "time.scheme: found steps from admissible velocities"),
        ("gap = 0.0011", tool, "obstacle.updated: found an obstacle that is followed"),
    ] {
        let found = told(&text.replace(at, &format!("{at}\n{more}")), &["corner_x"], &young);
        assert!(found.contains(words), "{found}");
    }
    let found = told(&text, &["corner_z"], &young);
    assert!(found.contains("output corner_z: found no number with derivatives, expected one of corner_x"), "{found}");
    let found = told(&text, &["corner_x"], &["time.steps"]);
    assert!(found.contains("time.steps: found 19.9609375, expected an integer"), "{found}");
    let found = told(&text, &["corner_x"], &["mesh.n[0]"]);
    assert!(found.contains("mesh.n[0]"), "{found}");
    let source = Source::new("case", text);
    let refused = |key: &str| case::parameter(&source, &[], key).err().expect("a fault").to_string();
    assert!(refused("boundary[0].displacement[0]").contains("expected a key with a number"));
    assert!(refused("material.youngs").contains("found no value"));
}
