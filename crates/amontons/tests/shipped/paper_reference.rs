//! The paper's example against numbers of two independent programs: `reference/paper.csv`.

use std::collections::BTreeMap;

use crate::common;
use amontons::output::{Memory, Outcome};
use amontons::run::{self, Settings};

/// Deviation allowed, relative to the scale of a quantity.
const TOLERANCE: f64 = 1e-8;

/// Names of the columns whose largest magnitude is the scale of each.
const SCALES: [&[&str]; 6] = [
    &[
        "displacement_min_x",
        "displacement_max_x",
        "displacement_min_y",
        "displacement_max_y",
        "ux_00",
        "uy_00",
        "ux_h0",
        "uy_h0",
        "ux_10",
        "uy_10",
        "ux_hh",
        "uy_hh",
    ],
    &["velocity_max_x", "velocity_max_y"],
    &["temperature_min", "temperature_max", "theta_h0", "theta_hh"],
    &["force_x", "force_y"],
    &["penetration_max"],
    &["pressure_max"],
];

/// Compares all columns of a table but those that say what was computed; returns how many figures that are.
fn compare(table: &str, inputs: &[&str]) -> usize {
    let path = format!("crates/amontons/tests/reference/{table}");
    let text = std::fs::read_to_string(common::file(&path)).expect("the reference numbers");
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let mut compared = 0;
    for line in lines {
        let row: BTreeMap<&str, &str> = header.iter().copied().zip(line.split(',')).collect();
        let number = |name: &str| -> f64 { row[name].parse().unwrap_or_else(|_| panic!("{name} is no number")) };
        let computed = compute(&row);
        for (name, value) in &computed {
            let scale = SCALES
                .iter()
                .find(|names| names.contains(&name.as_str()))
                .map_or(number(name).abs(), |names| names.iter().map(|name| number(name).abs()).fold(0.0, f64::max));
            let deviation = (value - number(name)).abs();
            assert!(deviation <= TOLERANCE * scale, "{name} of {line}: {value:e}, off by {deviation:e}");
            compared += 1;
        }
        assert_eq!(computed.len() + inputs.len(), header.len(), "every column is compared");
    }
    compared
}

#[test]
fn summaries_agree_with_two_independent_programs() {
    let compared = compare("paper.csv", &["reading", "theta_F", "n", "steps", "quadrature", "diagonal"]);
    assert_eq!(compared, 12 * 31);
    let readme = std::fs::read_to_string(common::file("README.md")).expect("the README");
    assert!(readme.contains(&format!("\n- {compared} figures of the paper's example")), "{compared} figures");
}

/// ϑ = ½, 16 to 128 steps, staggered and with both half-steps at the middle of the step. `closing` is the error of the
/// identity that the other program found.
#[test]
fn summaries_of_the_theta_scheme_agree_with_an_independent_program() {
    let inputs =
        ["reading", "theta_F", "n", "steps", "scheme", "theta", "coupling", "quadrature", "diagonal", "closing"];
    assert_eq!(compare("time/paper.csv", &inputs), 16 * 31);
}

/// The columns of a row, by a run.
fn compute(row: &BTreeMap<&str, &str>) -> BTreeMap<String, f64> {
    let mut overrides = common::reading(row["reading"]);
    overrides
        .push(format!("contact.heat.foundation_temperature={}", row["theta_F"].parse::<f64>().expect("a temperature")));
    overrides.push(format!("mesh.n={}", row["n"]));
    overrides.push(format!("mesh.diagonal=\"{}\"", row["diagonal"]));
    overrides.push(format!("time.steps={}", row["steps"]));
    overrides.push(format!("contact.quadrature=\"{}\"", row["quadrature"]));
    for (key, column) in [("time.scheme", "scheme"), ("time.theta", "theta")] {
        overrides.extend(row.get(column).map(|value| format!("{key}={value}")));
    }
    // Both half-steps with the values of the other at the middle of the step. With 16 steps and θ_F = 10 a step has two
    // solutions, of which the monolithic coupling finds the other one.
    if row.get("coupling") == Some(&"midpoint") {
        overrides.push("scheme.coupling=fixed-point".to_owned());
    }
    let problem = common::case("cases/paper.toml", &overrides).problem;
    let mut memory = Memory::new();
    let summary =
        run::run(&problem, &Settings { certificate: false, ..Settings::default() }, &mut [&mut memory]).expect("a run");
    assert_eq!(summary.outcome, Outcome::Done);

    let mut computed = BTreeMap::new();
    let mut put = |name: &str, value: f64| computed.insert(name.to_owned(), value);
    let end = &summary.last;
    for (c, axis) in ["x", "y"].into_iter().enumerate() {
        put(&format!("displacement_min_{axis}"), end.displacement_min[c]);
        put(&format!("displacement_max_{axis}"), end.displacement_max[c]);
        put(&format!("velocity_max_{axis}"), end.velocity_max[c]);
    }
    put("temperature_min", end.temperature_min.expect("a coupled run"));
    put("temperature_max", end.temperature_max.expect("a coupled run"));
    put("von_mises_max", end.von_mises_max.expect("a coupled run"));
    put("displacement_l2", end.norms.displacement_l2.expect("a norm"));
    put("displacement_v", end.norms.displacement_v.expect("a norm"));
    put("velocity_l2", end.norms.velocity_l2.expect("a norm"));
    put("temperature_l2", end.norms.temperature_l2.expect("a norm"));
    let contact = end.contact.as_ref().expect("contact");
    put("force_x", contact.force[0]);
    put("force_y", contact.force[1]);
    put("heat_flow", contact.heat_flow.expect("heat"));
    put("penetration_max", contact.penetration_max);
    put("pressure_max", contact.pressure_max);
    put("open", contact.open as f64);
    put("stick", contact.stick as f64);
    put("slip", contact.slip as f64);

    let state = memory.states.last().expect("the last state");
    let node = |x: f64, y: f64| {
        problem.mesh.points.iter().position(|p| (p[0] - x).abs() + (p[1] - y).abs() < 1e-12).expect("a node")
    };
    for (name, at) in [("00", node(0.0, 0.0)), ("h0", node(0.5, 0.0)), ("10", node(1.0, 0.0)), ("hh", node(0.5, 0.5))] {
        put(&format!("ux_{name}"), state.u[2 * at]);
        put(&format!("uy_{name}"), state.u[2 * at + 1]);
        if name.starts_with('h') {
            put(&format!("theta_{name}"), state.theta[at]);
        }
    }
    computed
}
