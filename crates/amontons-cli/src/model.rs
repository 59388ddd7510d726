//! The size of a model, in words.

use amontons::mesh::Skipped;
use amontons::model::{Cost, MeshModel, Model, Size};
use amontons::output::{computed_with, unknowns_in_words};
use amontons::problem::Problem;
use amontons::units::Measure;

/// A line with a name.
pub fn row(name: &str, value: &str) -> String {
    format!("  {name:<17} {value}")
}

/// Rows of the size of a model.
pub fn rows(problem: &Problem, model: &Model) -> Vec<String> {
    let (mechanics, heat) = (problem.physics.has_mechanics(), problem.physics.has_heat());
    let write =
        |value: f64, measure: Measure| format!("{value:.5e} {}", problem.units().of(measure)).trim_end().to_owned();
    let [low, high] = &model.bounds;
    let extents =
        low.iter().zip(high).map(|(low, high)| format!("{low:.5e} … {high:.5e}")).collect::<Vec<_>>().join(" × ");
    let parts = if model.parts == 1 { String::new() } else { format!(" in {} parts", model.parts) };
    let sectors = model.sectors.map(|sectors| format!(", one of {sectors} sectors")).unwrap_or_default();
    let mass = if mechanics { format!(", mass {}", write(model.mass, Measure::Mass)) } else { String::new() };
    let mut rows = vec![
        row("bounding box", format!("{extents} {}", problem.units().of(Measure::Length)).trim_end()),
        row("body", &format!("volume {}{mass}{parts}{sectors}", write(model.volume, Measure::Volume))),
    ];
    rows.extend(model.sides.iter().map(|(side, size)| {
        let points =
            model.contact_points.get(side).map_or_else(String::new, |points| format!(", {points} contact points"));
        row(&format!("side \"{side}\""), &format!("area {}{points}", write(*size, Measure::Area)))
    }));
    rows.extend(times(problem, model));
    rows.extend(model.thermal_layers.iter().map(|layer| {
        let length = |value: f64| problem.units().write(value, Measure::Length);
        let [step, end, cell] = [layer.step, layer.end, layer.cell].map(length);
        row(
            "thermal layer",
            &format!("√(k K/c) = {step} in a step, {end} in the run, cell {cell} high on \"{}\"", layer.side),
        )
    }));
    rows.extend(computed_with(&problem.choices()).iter().map(|(name, text)| row(name, text)));
    rows.extend(cost(&model.cost, mechanics, heat));
    rows
}

/// Unknowns, solver of the linear systems, and its work and memory.
fn cost(cost: &Cost, mechanics: bool, heat: bool) -> Vec<String> {
    let mut rows = vec![row("unknowns", &unknowns_in_words(cost.unknowns, mechanics, heat))];
    let way = if cost.solver.is_direct() { "by a factor" } else { "by an iteration without a factor" };
    rows.push(row("linear systems", &format!("{way}: {}", cost.solver.why)));
    if cost.solver.is_direct() {
        let [by_u, by_theta] = cost.factors;
        let numbers = if mechanics && heat { format!("{by_u} + {by_theta}") } else { (by_u + by_theta).to_string() };
        rows.push(row(
            "factors",
            &format!("{numbers} numbers, {} operations to compute them", short(cost.factorization_flops)),
        ));
    }
    let step = format!("{} operations, reads {}", short(cost.step_flops), bytes(cost.step_bytes));
    rows.push(row("per step", &format!("{step}; {} memory for matrices and forms", bytes(cost.memory_bytes))));
    rows
}

/// The content of a mesh file, in words.
pub fn mesh(name: &str, model: &MeshModel, skipped: &[Skipped]) -> String {
    let kind = match (model.dimension, model.axisymmetric) {
        (1, _) => "a body on a line",
        (2, true) => "the half section of a body of revolution",
        (2, false) => "a plane body",
        _ => "a body in space",
    };
    let parts = if model.parts == 1 { String::new() } else { format!(" in {} parts", model.parts) };
    let mut rows = vec![format!("{name}: {kind}{parts}, {} nodes", model.nodes)];
    rows.extend(model.cells.iter().map(|(element, count)| row("cells", &format!("{count} {element}"))));
    let [low, high] = &model.bounds;
    let extents: Vec<String> =
        low.iter().zip(high).map(|(low, high)| format!("{} … {}", figure(*low), figure(*high))).collect();
    rows.push(row("bounding box", &extents.join(" × ")));
    let counted = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    let whole = |of: &Size| if of.is_whole_boundary { ", the whole boundary" } else { "" };
    let sizes = |what: &str, part: &str, measure: &str, of: &Size| {
        row(
            &format!("{what} \"{}\"", of.name),
            &format!("{}, {measure} {}{}", counted(of.count, part), figure(of.measure), whole(of)),
        )
    };
    let [of_region, of_side] = match (model.dimension, model.axisymmetric) {
        (1, _) => ["length", "area"],
        (2, false) => ["area", "length"],
        _ => ["volume", "area"],
    };
    rows.extend(model.regions.iter().map(|region| sizes("region", "cell", of_region, region)));
    rows.extend(model.sides.iter().map(|side| sizes("side", "facet", of_side, side)));
    rows.extend(model.edges.iter().map(|edge| sizes("edge", "segment", "length", edge)));
    rows.extend(
        model.points.iter().map(|points| row(&format!("points \"{}\"", points.name), &counted(points.count, "node"))),
    );
    if model.unnamed_facets > 0 {
        rows.push(row("in no side", &format!("{} of the boundary", counted(model.unnamed_facets, "facet"))));
    }
    let (quality, at) = model.quality;
    let at: Vec<String> = at.iter().take(model.dimension).map(|x| figure(*x)).collect();
    rows.push(row(
        "quality",
        &format!("the worst cell, about ({}), has {quality:.4} (1: regular, 0: flat)", at.join(", ")),
    ));
    rows.extend(skipped.iter().map(|skipped| row("skipped", &format!("{}{}", skipped.what, place(skipped)))));
    rows.join("\n") + "\n"
}

/// The place where something was skipped, and its count, in brackets.
fn place(skipped: &Skipped) -> String {
    let mut words: Vec<String> = skipped.file.iter().cloned().collect();
    words.extend(skipped.line.map(|line| format!("line {line}")));
    words.extend((skipped.count != 1).then(|| format!("{} of them", skipped.count)));
    if words.is_empty() { String::new() } else { format!(" ({})", words.join(", ")) }
}

/// Time scales relative to the step.
fn times(problem: &Problem, model: &Model) -> Vec<String> {
    let times = &model.times;
    let write = |time: f64| format!("{time:.5e} {}", problem.units().of(Measure::Time)).trim_end().to_owned();
    let steps = |time: f64| format!("{}, {:.3} steps", write(time), time / problem.timeline.longest());
    let or = |time: Option<f64>, none: &str| time.map_or_else(|| none.to_owned(), steps);
    let inert = problem.materials.iter().all(|m| m.density == 0.0);
    let steady = problem.materials.iter().all(|m| m.heat_capacity == 0.0);
    let mut rows = Vec::new();
    if problem.physics.has_mechanics() {
        rows.push(row(
            "first period",
            &or(times.first_period, if inert { "none: density 0" } else { "none: only contact holds the body" }),
        ));
    }
    if problem.physics.has_heat() {
        rows.push(row(
            "heat time",
            &or(
                times.heat,
                if steady { "none: heat_capacity 0" } else { "none: no side holds the temperature, or conductivity 0" },
            ),
        ));
    }
    rows.extend(
        times
            .retardation
            .map(|[low, high]| row("viscosity", &format!("retardation times {low:.5e} … {}", write(high)))),
    );
    if !times.relaxation.is_empty() {
        rows.push(row("relaxation", &times.relaxation.iter().map(|time| write(*time)).collect::<Vec<_>>().join(", ")));
    }
    rows
}

/// A large number, rounded.
fn short(count: f64) -> String {
    if count < 1e4 { format!("{count:.0}") } else { format!("{count:.2e}") }
}

/// A number of bytes with a prefix.
fn bytes(count: f64) -> String {
    let (unit, name) =
        [(1e12, "TB"), (1e9, "GB"), (1e6, "MB")].into_iter().find(|(unit, _)| count >= *unit).unwrap_or((1e3, "kB"));
    format!("{:.3} {name}", count / unit)
}

/// A number with six digits, without trailing zeros: `0.06`, `1.2e-7`.
pub fn figure(number: f64) -> String {
    let rounded: f64 = format!("{number:.5e}").parse().unwrap_or(number);
    let is_plain = rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs());
    if is_plain { rounded.to_string() } else { format!("{rounded:e}") }
}
