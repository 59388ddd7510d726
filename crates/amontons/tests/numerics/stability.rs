//! Eigenvalues of steady sliding against other programs and closed forms: blocks on a belt (squeal), layers on a
//! foundation that slides out of the plane (hot spots), with and without drag, and a rod whose conductance grows with
//! the pressure.

use amontons::case::{self, Case};
use amontons::run::{Settings, Stepping};
use amontons::stability::{Kind, Modes, Wanted, modes};
use serde_json::Value;

use crate::common::file;

fn reference(name: &str) -> String {
    let path = file("crates/amontons/tests/reference/stability").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn with(name: &str, overrides: &[String]) -> Case {
    let path = file("crates/amontons/tests/reference/stability").join(name);
    case::read(&path, overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// The modes at the end of a run.
fn at_end(case: &Case, kind: Kind, count: usize) -> Modes {
    let mut run = Stepping::new(&case.problem, &Settings::default()).expect("a run");
    while !run.is_done() {
        run.step().expect("a step");
    }
    let seen = run.snapshot();
    let wanted = Wanted { kind, count, region: None };
    modes(&case.problem, seen.discretization, seen.state, seen.report.expect("a step"), &wanted).expect("modes")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|value| value.as_f64().unwrap_or(f64::NAN)).collect()
}

/// Asserts that the modes are those of a table: frequency and growth, to 1e-8 of the modulus.
fn assert_modes(name: &str, found: &Modes, growth: &[f64], frequency: &[f64]) {
    assert_eq!(found.missing, 0, "{name}: the count finds others");
    assert!(found.modes.len() >= growth.len(), "{name}: {} modes", found.modes.len());
    // Where two have nearly the same frequency, their order is round-off.
    for (growth, frequency) in growth.iter().zip(frequency) {
        let off = found.modes.iter().map(|mode| (mode.growth - growth).hypot(mode.frequency - frequency));
        let off = off.fold(f64::INFINITY, f64::min) / growth.hypot(*frequency);
        assert!(off < 1e-8, "{name}: {growth:e} + {frequency:e} i is {off:e} off");
    }
    assert!(found.modes.iter().all(|mode| mode.residual < 1e-9), "{name}: residuals");
}

#[test]
fn blocks_on_a_belt_squeal_as_elsewhere() {
    let all: Value = serde_json::from_str(&reference("squeal.json")).expect("a table");
    for block in all.as_array().expect("blocks") {
        let law = block["law"].as_str().expect("a law");
        let law = if law == "compliance" { "compliance" } else { "signorini" };
        let name = format!("{}-{law}", block["name"].as_str().expect("a name"));
        for (mu, expected) in block["eigenvalues"].as_object().expect("by μ") {
            let case = with(&format!("{name}.toml"), &[format!("contact.friction.coefficient={mu}")]);
            let found = at_end(&case, Kind::Squeal, 6);
            let name = format!("{name}, μ = {mu}");
            assert_modes(&name, &found, &numbers(&expected["growth"]), &numbers(&expected["frequency"]));
        }
    }
}

/// The rows of a table by column name.
fn table(name: &str) -> Vec<std::collections::BTreeMap<String, String>> {
    let text = reference(name);
    let split = |line: &str| -> Vec<String> {
        let (mut fields, mut quoted) = (vec![String::new()], false);
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => fields.push(String::new()),
                c => fields.last_mut().expect("a field").push(c),
            }
        }
        fields
    };
    let mut lines = text.lines();
    let head = split(lines.next().expect("a header"));
    lines.map(|line| head.iter().cloned().zip(split(line)).collect()).collect()
}

fn number(row: &std::collections::BTreeMap<String, String>, key: &str) -> f64 {
    row[key].parse().unwrap_or(f64::NAN)
}

/// The hot spots of a layer with pressures too small to drag, against the discrete problem of another program: four
/// eigenvalues each.
#[test]
fn layers_grow_hot_spots_as_elsewhere() {
    for row in table("tei-fe.csv").iter().filter(|row| ["symmetry", "clamped"].contains(&row["top"].as_str())) {
        if number(row, "n") > 8.0 {
            continue;
        }
        let law = if row["c"] == "inf" { "rigid" } else { "compliance" };
        let name = format!("tei-{}-{}-{law}-{}", row["data"], row["top"], row["elements"]);
        let overrides = [
            format!("mesh.n={}", row["n"]),
            "time.end=1e-9".to_owned(),
            "time.steps=1".to_owned(),
            "initial.temperature=0".to_owned(),
            format!("contact.heat.conductance={}", row["h"]),
            format!("contact.foundation_velocity=[0, 0, {}]", row["V"]),
        ];
        let top = if row["top"] == "clamped" {
            "boundary[2].displacement=[0, -1e-13]"
        } else {
            "boundary[2].displacement=[\"free\", -1e-13]"
        };
        let case = with(&format!("{name}.toml"), &[&overrides[..], &[top.to_owned()]].concat());
        let found = at_end(&case, Kind::Thermal, 4);
        let growth: Vec<f64> = (1..5).map(|k| number(row, &format!("eigenvalue_{k}"))).collect();
        let frequency: Vec<f64> = (1..5).map(|k| number(row, &format!("imag_{k}")).abs()).collect();
        assert_modes(&format!("{name}, n = {}, h = {}", row["n"], row["h"]), &found, &growth, &frequency);
    }
}

/// Drag across the direction of sliding damps all modes but the even one.
#[test]
fn drag_damps_hot_spots_as_elsewhere() {
    for row in table("tei-drag.csv") {
        let modulus = 2.0 * 0.7 / (1.3 * 0.4);
        let press = (number(&row, "pstar") / modulus).max(1e-13);
        let overrides = [
            "time.end=1e-12".to_owned(),
            "time.steps=1".to_owned(),
            "initial.temperature=0".to_owned(),
            format!("boundary[2].displacement=[\"free\", {:?}]", -press),
        ];
        let found = at_end(&with("tei-a-symmetry-rigid-Q1.toml", &overrides), Kind::Thermal, 4);
        let growth: Vec<f64> = (1..5).map(|k| number(&row, &format!("eigenvalue_{k}"))).collect();
        assert_modes(&format!("drag at {}", row["pstar"]), &found, &growth, &[0.0; 4]);
    }
}

/// A rod between walls whose conductance grows with the pressure (Barber): P1, and of order 2 to the closed form.
#[test]
fn a_rod_with_a_conductance_of_pressure_grows_as_elsewhere() {
    for row in table("rod.csv") {
        // θ_L = h Δ L/K and p = 𝓜⟨θ⟩ − E g/L = ½, so that h = h₀ + p dh/dp holds with h₀ = ½.
        let (h, difference, young) = (number(&row, "h"), number(&row, "theta_F_minus_theta"), number(&row, "young"));
        let (slope, expansion) = (number(&row, "dh_dp"), number(&row, "expansion"));
        let end = h * difference;
        let (p, foundation) = (0.5, end + difference);
        let gap = (expansion * 0.5 * end - p) / young;
        let text = format!(
            r#"
name = "rod"
units = "dimensionless"
[mesh]
kind = "interval"
size = 1.0
n = {n}
[time]
end = 1e-12
steps = 1
[initial]
temperature = "{end:?}*x"
[material]
density = 0.0
heat_capacity = 1.0
conductivity = 1.0
expansion = {expansion}
elasticity = {{ law = "isotropic", young = {young}, poisson = 0.0 }}
[[boundary]]
on = "left"
displacement = [0]
temperature = 0
[contact]
on = "right"
gap = {gap:?}
normal = {{ law = "signorini" }}
heat = {{ law = "sum", foundation_temperature = {foundation:?}, laws = [
    {{ law = "constant", conductance = {rest:?} }},
    {{ law = "pressure", coefficient = {slope} }},
] }}
"#,
            n = row["n"],
            rest = h - p * slope,
        );
        let case = case::parse(&case::Source::new("rod.toml", text), &[]).unwrap_or_else(|error| panic!("{error}"));
        let found = at_end(&case, Kind::Thermal, 4);
        let growth: Vec<f64> =
            ["growth_fe", "eigenvalue_2", "eigenvalue_3", "eigenvalue_4"].map(|key| number(&row, key)).to_vec();
        assert_modes(&format!("rod, n = {}, {difference}", row["n"]), &found, &growth, &[0.0; 4]);
    }
}
