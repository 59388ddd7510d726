//! Numbers at the end of a run to an accuracy.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use amontons::accuracy::{AccuracyEnding, AccuracyError, AccuracyRequest, AccurateCase, BarRow, ValueLevel, of_values};
use amontons::run::{Settings, with_threads};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::attend::attend;
use crate::case::{Case, text};
use crate::errors;

/// Refines cells and steps of a case until the numbers `of` at its end have bars of at most `relative` of them: the
/// levels, and all numbers of the last one with their bars.
#[pyfunction]
pub fn accurate(
    py: Python<'_>,
    case: &Bound<'_, Case>,
    of: Vec<String>,
    relative: f64,
    threads: Option<usize>,
) -> PyResult<String> {
    let Case { source, overrides, .. } = case.get();
    let flag = Arc::new(AtomicBool::new(false));
    let settings = Settings { interrupt: Some(Arc::clone(&flag)), certificate: false, ..Settings::default() };
    let request = AccuracyRequest { source, overrides, relative, settings: &settings };
    let (made, raised) = attend(py, &flag, |_| with_threads(threads, || of_values(&request, &of, &mut |_| ())))?;
    if let Some(raised) = raised {
        return Err(raised);
    }
    match made.map_err(|error| errors::of_run(py, &error))? {
        Ok(found) => text(&table(&found)),
        Err(AccuracyError::Run(error)) => Err(errors::of_run(py, &error)),
        Err(error) => Err(errors::request(py, &error.to_string())),
    }
}

fn table(found: &AccurateCase<ValueLevel>) -> Value {
    let why = match &found.ending {
        AccuracyEnding::Reached => None,
        AccuracyEnding::NoMesh(why) | AccuracyEnding::Stands(why) => Some(why),
    };
    let row = |row: &BarRow| json!({"t": row.t, "name": row.name, "value": row.value, "bar": row.bar()});
    let level = |level: &ValueLevel| {
        let goals: Vec<Value> = level.goals.iter().map(|goal| row(&goal.row)).collect();
        json!({"cells": level.cells, "nodes": level.nodes, "steps": level.steps, "goals": goals})
    };
    let levels: Vec<Value> = found.levels.iter().map(level).collect();
    let bars: Vec<Value> = found.levels.last().map_or(Vec::new(), |last| last.bars.iter().map(row).collect());
    json!({"reached": why.is_none(), "why": why, "levels": levels, "bars": bars})
}
