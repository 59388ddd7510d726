//! What the program prints.

use std::io::{self, Write};
use std::path::Path;

use amontons::hypotheses::{Certificate, Finding, Kind};
use amontons::model::Model;
use amontons::output::{ContactSummary, Outcome, Seconds, Solver, Summary};
use amontons::problem::Problem;
use amontons::units::{Extent, Measure, Units};
use serde_json::{Value, json};

use crate::model::{self, row, unknowns};
use crate::voices;

/// Prints a value as indented JSON on standard output.
pub fn json(value: &Value) -> io::Result<()> {
    text(&format!("{value:#}\n"))
}

/// Prints a text on standard output.
pub fn text(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes())?;
    out.flush()
}

/// Prints an error on standard error.
pub fn error(message: &str, hint: Option<&str>) {
    let hint = hint.map_or_else(String::new, |hint| format!("{hint}\n"));
    // Where standard error fails there is no one to tell.
    let _ = write!(io::stderr().lock(), "Error: {message}\n{hint}");
}

/// Prints on standard error what a user has to know although the command goes on.
pub fn note(text: &str) {
    // Where standard error fails there is no one to tell.
    let _ = writeln!(io::stderr().lock(), "Note: {text}");
}

/// The summary of a run for reading.
pub fn summary(summary: &Summary, folder: &Path) -> String {
    let end = &summary.last;
    let (mechanics, heat) = (!end.displacement_min.is_empty(), end.temperature_min.is_some());
    let state = match summary.outcome {
        Outcome::Done => "done",
        Outcome::NotConverged => "not converged",
        Outcome::Interrupted => "interrupted",
        Outcome::Unsound => "unsound",
    };
    let (seconds, units) = (&summary.seconds, summary.units);
    let mut lines = vec![
        format!(
            "{}: {state}, {} steps to t = {} in {:.2} s",
            summary.case,
            summary.steps,
            units.exact(summary.time, Measure::Time),
            seconds.total
        ),
        row(
            "unknowns",
            &unknowns(
                [summary.unknowns.displacement, summary.unknowns.temperature, summary.unknowns.contact],
                mechanics,
                heat,
            ),
        ),
        row("time", &phases(seconds)),
    ];
    lines.push(systems(&summary.solver));
    for (axis, (min, max)) in ["x", "y", "z"].iter().zip(end.displacement_min.iter().zip(&end.displacement_max)) {
        lines.push(row(&format!("displacement {axis}"), &range(units, [*min, *max], Measure::Length)));
    }
    if let (Some(min), Some(max)) = (end.temperature_min, end.temperature_max) {
        lines.push(row("temperature", &range(units, [min, max], Measure::Temperature)));
    }
    lines.extend(
        end.von_mises_max.map(|most| row("von Mises stress", &format!("up to {}", units.write(most, Measure::Stress)))),
    );
    lines.extend(end.strain_max.map(|most| row("strain", &format!("up to {}", units.write(most, Measure::Number)))));
    if let Some(contact) = end.contact.as_ref().filter(|c| c.open + c.stick + c.slip > 0) {
        lines.extend(touching("contact", contact, units));
        for (side, contact) in &contact.sides {
            lines.extend(touching(&format!("on \"{side}\""), contact, units));
        }
    }
    lines.extend(extent(units, mechanics));
    lines.extend(
        mechanics.then(|| {
            row("energy closes to", &format!("{:.1e} of the energy turned over", summary.energy.closing_error))
        }),
    );
    lines.extend(
        heat.then(|| {
            row("heat closes to", &format!("{:.1e} of the heat turned over", summary.energy.heat_closing_error))
        }),
    );
    lines.extend(halved(&summary.solver));
    lines.push(row("results", &folder.display().to_string()));
    lines.extend(voices::of_run(&summary.findings));
    lines.join("\n") + "\n"
}

/// The times of the phases of a run.
fn phases(seconds: &Seconds) -> String {
    let Seconds { certificate, setup, factor, steps, output, .. } = seconds;
    format!(
        "{certificate:.2} s certificate, {setup:.2} s setup, {factor:.2} s factor, {steps:.2} s steps, {output:.2} s output"
    )
}

/// A line on how linear systems were solved.
fn systems(solver: &Solver) -> String {
    let way = match solver.backend.as_str() {
        "iterative" => format!("by an iteration without a factor, {} Krylov iterations", solver.krylov_iterations),
        _ => "by a factor".to_owned(),
    };
    row("linear systems", &format!("{way}: {}", solver.backend_reason))
}

/// A line on halved and ambiguous steps, if there are any.
fn halved(solver: &Solver) -> Option<String> {
    let Solver { halved_steps, ambiguous_steps, .. } = *solver;
    let ambiguous = match ambiguous_steps {
        0 => "none of them remains ambiguous".to_owned(),
        some => format!("{some} of all steps remain ambiguous"),
    };
    (halved_steps > 0 || ambiguous_steps > 0)
        .then(|| row("halved steps", &format!("{halved_steps} steps, {ambiguous}")))
}

/// The ends of a range in one unit.
fn range(units: Units, ends: [f64; 2], measure: Measure) -> String {
    let (low, high, unit) = units.range(ends, measure);
    format!("{low} … {high} {unit}").trim_end().to_owned()
}

/// What integrals over a body are over. Absent in space, where they are over the body.
fn extent(units: Units, mechanics: bool) -> Option<String> {
    let text = match units.extent {
        Extent::Line => "per unit of cross-section",
        Extent::Plane => "per unit of thickness",
        Extent::Revolution => "of the full turn",
        Extent::Space => return None,
    };
    Some(row(if mechanics { "forces, energies" } else { "heat" }, text))
}

/// Contact on one side or on all, with wear and the temperature of the foundation if there are any.
fn touching(name: &str, contact: &ContactSummary, units: Units) -> Vec<String> {
    let write = |value: f64, measure: Measure| units.write(value, measure);
    let force = units.vector(&contact.force, Measure::Force);
    let mut lines = vec![
        row(
            name,
            &format!(
                "{} open, {} stick, {} slip; area {}",
                contact.open,
                contact.stick,
                contact.slip,
                write(contact.area, Measure::Area)
            ),
        ),
        row("contact force", &format!("{force}, pressure up to {}", write(contact.pressure_max, Measure::Stress))),
    ];
    lines.extend(
        contact.heat_flow.filter(|flow| *flow != 0.0).map(|flow| row("heat through it", &write(flow, Measure::Power))),
    );
    if contact.wear_max > 0.0 {
        let [deep, volume] = [write(contact.wear_max, Measure::Length), write(contact.wear_volume, Measure::Volume)];
        lines.push(row("wear", &format!("up to {deep} deep, volume {volume}")));
    }
    lines.extend(contact.foundation_temperature.map(|theta| row("foundation", &write(theta, Measure::Temperature))));
    lines
}

/// Sizes of a valid case and the verdicts on it, for reading.
pub fn valid(name: &str, problem: &Problem, model: &Model, certificate: &Certificate) -> String {
    let mesh = &problem.mesh;
    let sides: Vec<String> = problem.contacts.iter().map(|c| format!("\"{}\"", c.on)).collect();
    let contact = if sides.is_empty() { "none".to_owned() } else { format!("on {}", sides.join(", ")) };
    let write = |value: f64, measure: Measure| problem.units().write(value, measure);
    let mut lines = vec![
        format!("{name}: case is valid"),
        row(
            "mesh",
            &format!(
                "{} {}, {} nodes, {} cells, h = {}",
                mesh.dim,
                if mesh.dim == 1 { "dimension" } else { "dimensions" },
                mesh.points.len(),
                mesh.cell_count(),
                write(mesh.h(), Measure::Length)
            ),
        ),
        row(
            "time",
            &format!(
                "{} steps of {} to {}",
                problem.steps,
                write(problem.k(), Measure::Time),
                write(problem.end, Measure::Time)
            ),
        ),
    ];
    if problem.physics.has_mechanics() {
        lines.push(row("contact", &contact));
    }
    let width = certificate.findings.iter().map(|f| f.id.as_str().len()).max().unwrap_or(0) + 2;
    lines.extend(model::rows(problem, model));
    for (title, kind) in [("What you can act on:", Kind::Warning), ("What the theory covers:", Kind::Theory)] {
        lines.push(title.to_owned());
        for finding in certificate.findings.iter().filter(|f| f.kind == kind) {
            lines.extend(verdict(finding, width));
        }
    }
    lines.join("\n") + "\n"
}

/// A verdict in full: id, status, the number found and the one needed, what it means, its place, what would repair it.
fn verdict(finding: &Finding, width: usize) -> Vec<String> {
    let Finding { status, value, needed, message, place, repair, .. } = finding;
    let number = |v: &Option<f64>| v.map(|v| format!("{v:.6e}"));
    let numbers = match (number(value), number(needed)) {
        (Some(value), Some(needed)) => format!("{value}, compared with {needed}"),
        (Some(value), None) => value,
        (None, _) => "-".to_owned(),
    };
    let id = format!("({})", finding.id);
    let mut lines = vec![format!("  {id:<width$} {status:<11} {numbers}"), format!("      {message} ({place})")];
    lines.extend(repair.iter().map(|repair| format!("      to repair it: {repair}")));
    lines
}

/// Sizes of a valid case and the verdicts on it, for programs.
pub fn valid_json(problem: &Problem, model: &Model, certificate: &Certificate) -> Value {
    let mesh = &problem.mesh;
    let sides: Vec<&str> = problem.contacts.iter().map(|c| c.on.as_str()).collect();
    json!({
        "case": problem.name,
        "valid": true,
        "dimension": mesh.dim,
        "nodes": mesh.points.len(),
        "cells": mesh.cell_count(),
        "h": mesh.h(),
        "steps": problem.steps,
        "k": problem.k(),
        "time": problem.end,
        // A name, or an array of the names of several sides.
        "contact": match sides.as_slice() { [] => Value::Null, [one] => json!(one), several => json!(several) },
        "model": model,
        "findings": certificate.findings,
        "constants": certificate.constants,
    })
}
