//! Output of the program.

use std::io::{self, Write};
use std::path::Path;

use amontons::case::Case;
use amontons::contact::names;
use amontons::hypotheses::{Certificate, Finding, Kind};
use amontons::mesh::Skipped;
use amontons::model::Model;
use amontons::output::Summary;
use amontons::problem::Problem;
use amontons::time::{Instant, TimePhase};
use amontons::units::Measure;
use serde_json::{Value, json};

use crate::model::{self, row};
use crate::plain::{self, plain};
use crate::voices;

/// Prints a value as indented JSON on standard output.
pub fn json(value: &Value) -> io::Result<()> {
    write(&plain::json(&format!("{value:#}\n")))
}

/// Prints a text on standard output.
pub fn text(text: &str) -> io::Result<()> {
    write(&plain(text))
}

fn write(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes())?;
    out.flush()
}

/// Prints an error on standard error.
pub fn error(message: &str, hint: Option<&str>) {
    let message = plain::message(message);
    let hint = hint.map_or_else(String::new, |hint| format!("{}\n", plain::message(hint)));
    // If standard error fails, nothing can be reported.
    let _ = write!(io::stderr().lock(), "Error: {message}\n{hint}");
}

/// Prints a note for the user on standard error; the command continues.
pub fn note(text: &str) {
    // If standard error fails, nothing can be reported.
    let _ = writeln!(io::stderr().lock(), "Note: {}", plain::message(text));
}

/// The skipped content of a mesh file in one line, if any.
fn not_of_the_mesh(skipped: &[Skipped]) -> Option<String> {
    Skipped::in_one_line(skipped).map(|skipped| row("not of the mesh", &skipped))
}

/// The summary of a run as text.
pub fn summary(summary: &Summary, skipped: &[Skipped], folder: &Path) -> String {
    let rows = summary.rows();
    let results = ("results".to_owned(), folder.display().to_string());
    let mut lines = vec![summary.headline()];
    lines.extend(rows.iter().chain([&results]).map(|(name, text)| row(name, text)));
    lines.extend(not_of_the_mesh(skipped));
    lines.extend(voices::of_run(&summary.findings));
    lines.join("\n") + "\n"
}

/// Sizes of a valid case and the verdicts on it, as text.
pub fn valid(name: &str, case: &Case, model: &Model, certificate: &Certificate) -> String {
    let problem = &case.problem;
    let mesh = &problem.mesh;
    let sides: Vec<String> = names(&problem.contacts).iter().map(|name| format!("\"{name}\"")).collect();
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
            &if let Some(accuracy) = problem.timeline.accuracy(0).filter(|_| !problem.timeline.has_phases()) {
                let end = write(problem.timeline.end(), Measure::Time);
                format!("steps for an accuracy of {accuracy:?} to {end}")
            } else if problem.timeline.has_phases() {
                let [steps, end] = [problem.timeline.steps().to_string(), write(problem.timeline.end(), Measure::Time)];
                let about = if problem.timeline.is_automatic() { "chosen and equal" } else { &steps };
                format!("{about} steps in {} phases to {end}", problem.timeline.phases().len())
            } else {
                let [k, end] = [problem.timeline.longest(), problem.timeline.end()].map(|t| write(t, Measure::Time));
                format!("{} steps of {k} to {end}", problem.timeline.steps())
            },
        ),
    ];
    if problem.physics.has_mechanics() {
        lines.push(row("contact", &contact));
    }
    lines.extend(not_of_the_mesh(&case.skipped));
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

/// A verdict in full: id, status, value found and value needed, meaning, place, repair.
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

/// The phases of a run with their steps.
fn phases(problem: &Problem) -> Vec<Value> {
    let all = problem.timeline.phases().zip(problem.timeline.ends_from(0));
    let one = |(phase, end): (&TimePhase, Instant)| {
        json!({
            "name": phase.name, "end": end.t, "steps": equal(phase), "k": equal(phase).map(|_| end.k),
            "accuracy": phase.steps.accuracy(), "analysis": end.analysis.name(),
        })
    };
    all.map(one).collect()
}

/// The number of equal steps of a phase, or `None` if its steps are chosen.
fn equal(phase: &TimePhase) -> Option<usize> {
    phase.steps.accuracy().is_none().then(|| phase.steps.nominal())
}

/// Sizes of a valid case and the verdicts on it, as JSON.
pub fn valid_json(case: &Case, model: &Model, certificate: &Certificate) -> Value {
    let problem = &case.problem;
    let mesh = &problem.mesh;
    let sides = names(&problem.contacts);
    json!({
        "case": problem.name,
        "valid": true,
        "dimension": mesh.dim,
        "nodes": mesh.points.len(),
        "cells": mesh.cell_count(),
        "h": mesh.h(),
        "steps": (!problem.timeline.is_automatic()).then(|| problem.timeline.steps()),
        "choices": problem.choices(),
        "k": (!problem.timeline.is_automatic()).then(|| problem.timeline.longest()),
        "time": problem.timeline.end(),
        "phases": problem.timeline.has_phases().then(|| phases(problem)),
        // A name, or an array of the names of several contacts.
        "contact": match sides.as_slice() { [] => Value::Null, [one] => json!(one), several => json!(several) },
        "model": model,
        "skipped": case.skipped,
        "findings": certificate.findings,
        "constants": certificate.constants,
    })
}
