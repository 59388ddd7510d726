//! Derivatives of runs: an independent program, closed forms, differences of whole runs.

use amontons::adjoint::{Gradient, GradientRequest, Parameter, gradient};
use amontons::case::{self, Case, Source};
use amontons::problem::{Fault, Problem};

use super::common::file;

fn read(path: &str) -> String {
    std::fs::read_to_string(file(path)).expect("a file")
}

/// The text of a case whose derivatives are known.
fn source(name: &str) -> Source {
    let path = format!("crates/amontons/tests/reference/gradients/{name}.toml");
    Source::new(name, read(&path))
}

fn parsed(source: &Source, overrides: &[String]) -> Case {
    case::parse(source, overrides).expect("a case")
}

/// What a parameter sets, by its value.
type Overrides = Box<dyn Fn(f64) -> Vec<String>>;

fn key(key: &'static str) -> Overrides {
    Box::new(move |value| vec![format!("{key}={value:e}")])
}

fn parameter<'a>(source: &'a Source, (name, value): (&str, f64), sets: &'a Overrides) -> Parameter<'a> {
    let problem = move |value: f64| -> Result<Problem, Fault> { Ok(parsed(source, &sets(value)).problem) };
    Parameter { name: name.to_owned(), value, problem: Box::new(problem) }
}

/// The overrides of a parameter of a case of `gradients.csv`.
fn overrides(case: &str, parameter: &str) -> Overrides {
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
        ("thermal-pressure", "amplitude") => {
            expression(|v| format!("boundary[0].displacement=[\"0\", \"-{v:e}*t\"]"))
        }
        ("wear", "amplitude") => expression(|v| format!("boundary[0].displacement=[\"0\", \"-{v:e}*min(2*t, 1)\"]")),
        ("pair", "amplitude") => expression(|v| format!("boundary[1].traction=[\"{v:e}*sin(3*t)\", -1.0]")),
        ("paper-8", "amplitude") => {
            expression(|v| format!("boundary[1].traction=[{:e}, {:e}]", 1.4 * v, 0.4 * v))
        }
        _ => panic!("{case}: {parameter}"),
    }
}

/// The name of an output of `gradients.csv`, and the sign of its value.
fn output(case: &str, name: &str) -> (String, f64) {
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
struct Known {
    output: String,
    parameter: String,
    at: f64,
    value: f64,
    derivative: f64,
}

fn known(case: &str) -> Vec<Known> {
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

fn unique(all: impl Iterator<Item = String>) -> Vec<String> {
    let mut seen: Vec<String> = Vec::new();
    all.for_each(|one| {
        if !seen.contains(&one) {
            seen.push(one);
        }
    });
    seen
}

/// The derivatives of a case by parameters with their values.
fn derivatives(source: &Source, outputs: &[String], parameters: &[(String, f64, Overrides)]) -> Gradient {
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
        println!("{case}: d {} / d {}: {derivative:e}, expected {:e}: {error:.1e}", row.output, row.parameter, row.derivative);
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
