//! What the program prints.

use std::io::{self, Write};
use std::path::Path;

use amontons::hypotheses::{Certificate, Finding, Kind};
use amontons::model::Model;
use amontons::output::{ContactSummary, Outcome, Solver, Summary};
use amontons::problem::Problem;
use serde_json::{Value, json};

use crate::{model, voices};

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

/// The summary of a run for reading.
pub fn summary(summary: &Summary, folder: &Path) -> String {
    let end = &summary.last;
    let unknowns = &summary.unknowns;
    let state = match summary.outcome {
        Outcome::Done => "done",
        Outcome::NotConverged => "not converged",
        Outcome::Interrupted => "interrupted",
        Outcome::Unsound => "unsound",
    };
    let seconds = &summary.seconds;
    let mut lines = vec![
        format!("{}: {state}, {} steps to t = {} s in {:.2} s", summary.case, summary.steps, summary.time, seconds.total),
        row("unknowns", &format!("{} displacement, {} temperature, {} on the contact side", unknowns.displacement, unknowns.temperature, unknowns.contact)),
        row(
            "time",
            &format!(
                "{:.2} s certificate, {:.2} s setup, {:.2} s factor, {:.2} s steps, {:.2} s output",
                seconds.certificate, seconds.setup, seconds.factor, seconds.steps, seconds.output
            ),
        ),
    ];
    for (axis, (min, max)) in ["x", "y", "z"].iter().zip(end.displacement_min.iter().zip(&end.displacement_max)) {
        lines.push(row(&format!("displacement {axis}"), &format!("{min:.5e} … {max:.5e} m")));
    }
    if let (Some(min), Some(max)) = (end.temperature_min, end.temperature_max) {
        lines.push(row("temperature", &format!("{min:.5e} … {max:.5e} K")));
    }
    lines.extend(end.von_mises_max.map(|most| row("von Mises stress", &format!("up to {most:.5e} Pa"))));
    lines.extend(end.strain_max.map(|most| row("strain", &format!("up to {most:.5e}"))));
    if let Some(contact) = end.contact.as_ref().filter(|c| c.open + c.stick + c.slip > 0) {
        lines.extend(touching("contact", contact));
        for (side, contact) in &contact.sides {
            lines.extend(touching(&format!("on \"{side}\""), contact));
        }
    }
    lines.push(row(
        "energy closes to",
        &format!("{:.1e} of the energy turned over, heat to {:.1e}", summary.energy.closing_error, summary.energy.heat_closing_error),
    ));
    lines.extend(halved(&summary.solver));
    lines.push(row("results", &folder.display().to_string()));
    lines.extend(voices::of_run(&summary.findings));
    lines.join("\n") + "\n"
}

/// What is to be known where steps were made in halves.
fn halved(solver: &Solver) -> Option<String> {
    let Solver { halved_steps, ambiguous_steps, .. } = *solver;
    let ambiguous = match ambiguous_steps {
        0 => "none of them with several solutions left".to_owned(),
        some => format!("{some} of all may have had several solutions"),
    };
    (halved_steps > 0 || ambiguous_steps > 0).then(|| row("made in halves", &format!("{halved_steps} steps, {ambiguous}")))
}

/// A line with a name.
pub fn row(name: &str, value: &str) -> String {
    format!("  {name:<17} {value}")
}

/// Contact on one side or on all, what there is of wear and of a foundation that warms up included.
fn touching(name: &str, contact: &ContactSummary) -> Vec<String> {
    let force = contact.force.iter().map(|f| format!("{f:.6e}")).collect::<Vec<_>>().join(", ");
    let mut lines = vec![
        row(name, &format!("{} open, {} stick, {} slip; area {:.5e}", contact.open, contact.stick, contact.slip, contact.area)),
        row("contact force", &format!("({force}) N, pressure up to {:.5e} Pa", contact.pressure_max)),
        row("heat through it", &format!("{:.5e} W", contact.heat_flow)),
    ];
    if contact.wear_max > 0.0 {
        lines.push(row("wear", &format!("up to {:.5e} m deep, volume {:.5e}", contact.wear_max, contact.wear_volume)));
    }
    lines.extend(contact.foundation_temperature.map(|theta| row("foundation", &format!("{theta:.5e} K"))));
    lines
}

/// Sizes of a valid case and the verdicts on it, for reading.
pub fn valid(name: &str, problem: &Problem, model: &Model, certificate: &Certificate) -> String {
    let mesh = &problem.mesh;
    let sides: Vec<String> = problem.contacts.iter().map(|c| format!("\"{}\"", c.on)).collect();
    let contact = if sides.is_empty() { "none".to_owned() } else { format!("on {}", sides.join(", ")) };
    let mut lines = vec![
        format!("{name}: case is valid"),
        row("mesh", &format!("{} dimensions, {} nodes, {} cells, h = {:.5e} m", mesh.dim, mesh.points.len(), mesh.cell_count(), mesh.h())),
        row("time", &format!("{} steps of {:.5e} s to {} s", problem.steps, problem.k(), problem.end)),
        row("contact", &contact),
    ];
    let width = certificate.findings.iter().map(|f| f.id.len()).max().unwrap_or(0) + 2;
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
