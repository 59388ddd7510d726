//! The size of a model for reading.

use amontons::model::Model;
use amontons::problem::Problem;

/// A line with a name.
pub fn row(name: &str, value: &str) -> String {
    format!("  {name:<17} {value}")
}

/// Rows of the size of a model.
pub fn rows(problem: &Problem, model: &Model) -> Vec<String> {
    let dim = problem.mesh.dim;
    // Volumes and areas of a plane body are per metre of thickness, those of a body of revolution are of all of it.
    let (volume, area, mass) = match (dim, problem.mesh.axisymmetric) {
        (1, _) => ("m", "", "kg/m²"),
        (2, false) => ("m²", " m", "kg/m"),
        _ => ("m³", " m²", "kg"),
    };
    let [low, high] = &model.bounds;
    let extents = low.iter().zip(high).map(|(low, high)| format!("{low:.5e} … {high:.5e}")).collect::<Vec<_>>().join(" × ");
    let parts = if model.parts == 1 { String::new() } else { format!(" in {} parts", model.parts) };
    let mut rows = vec![
        row("bounding box", &format!("{extents} m")),
        row("body", &format!("volume {:.5e} {volume}, mass {:.5e} {mass}{parts}", model.volume, model.mass)),
    ];
    rows.extend(model.sides.iter().map(|(side, size)| {
        let points = model.contact_points.get(side).map_or_else(String::new, |points| format!(", {points} contact points"));
        row(&format!("side \"{side}\""), &format!("area {size:.5e}{area}{points}"))
    }));
    rows.extend(times(problem, model));
    rows.extend(model.thermal_layers.iter().map(|layer| {
        let text = format!("√(k K/c) = {:.3e} m in a step, {:.3e} m in the run, cell {:.3e} m high on \"{}\"", layer.step, layer.end, layer.cell, layer.side);
        row("thermal layer", &text)
    }));
    if let Some(cost) = &model.cost {
        let [u, theta, contact] = cost.unknowns;
        rows.push(row("unknowns", &format!("{u} displacement, {theta} temperature, {contact} on the contact side")));
        let [by_u, by_theta] = cost.factors;
        rows.push(row("factors", &format!("{by_u} + {by_theta} numbers, {} operations to make them", short(cost.factorization_flops))));
        let step = format!("{} operations, reads {}", short(cost.step_flops), bytes(cost.step_bytes));
        rows.push(row("a step", &format!("{step}; {} memory for factors and forms", bytes(cost.memory_bytes))));
    }
    rows
}

/// Time scales beside the step.
fn times(problem: &Problem, model: &Model) -> Vec<String> {
    let times = &model.times;
    let steps = |time: f64| format!("{time:.5e} s, {:.3} steps", time / problem.k());
    let or = |time: Option<f64>, none: &str| time.map_or_else(|| none.to_owned(), steps);
    let inert = problem.materials.iter().all(|m| m.density == 0.0);
    let steady = problem.materials.iter().all(|m| m.heat_capacity == 0.0);
    let mut rows = vec![
        row("first period", &or(times.first_period, if inert { "none: density 0" } else { "none: nothing but contact holds the body" })),
        row("heat time", &or(times.heat, if steady { "none: heat_capacity 0" } else { "none: no side holds the temperature, or it is not conducted" })),
    ];
    rows.extend(times.retardation.map(|[low, high]| row("viscosity", &format!("follows in {low:.5e} … {high:.5e} s"))));
    if !times.relaxation.is_empty() {
        rows.push(row("relaxation", &times.relaxation.iter().map(|time| format!("{time:.5e} s")).collect::<Vec<_>>().join(", ")));
    }
    rows
}

/// A large number for reading.
fn short(count: f64) -> String {
    if count < 1e4 { format!("{count:.0}") } else { format!("{count:.2e}") }
}

/// A number of bytes for reading.
fn bytes(count: f64) -> String {
    let (unit, name) = [(1e12, "TB"), (1e9, "GB"), (1e6, "MB")].into_iter().find(|(unit, _)| count >= *unit).unwrap_or((1e3, "kB"));
    format!("{:.3} {name}", count / unit)
}
