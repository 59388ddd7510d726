//! Cases: read, checked and studied.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};

use amontons::case::{self, Files, ReferenceRequest, Source, StudyRequest};
use amontons::convergence::{self, ReferenceProgress, StudyError, StudyLevel, StudySettings, StudyTable, Vary};
use amontons::hypotheses;
use amontons::model::Model;
use amontons::output::{OutputError, StudyFolder};
use amontons::run::{Settings, with_threads};
use amontons::state::State;
use amontons::verify::{BENCHMARKS, Recomputed, benchmark, recompute, verify_case};
use pyo3::prelude::*;
use serde_json::json;

use crate::attend::attend;
use crate::errors;
use crate::laws::{Alarm, Law, with_laws};

/// A case that was read and has no faults.
#[pyclass(frozen, module = "amontons._amontons")]
pub struct Case {
    pub read: case::Case,
    pub source: Source,
    pub overrides: Vec<String>,
}

/// The text of a case and the folder of the files that it refers to.
fn source_of(name: String, text: String, folder: PathBuf) -> Source {
    Source { files: Files::Folder(folder), ..Source::new(name, text) }
}

#[pymethods]
impl Case {
    #[new]
    fn new(py: Python<'_>, name: String, text: String, folder: PathBuf, overrides: Vec<String>) -> PyResult<Case> {
        let source = source_of(name, text, folder);
        match py.detach(|| case::parse(&source, &overrides)) {
            Ok(read) => Ok(Case { read, source, overrides }),
            Err(error) => Err(errors::of_case(py, &error)),
        }
    }

    /// Name of the case.
    #[getter]
    fn name(&self) -> &str {
        &self.read.problem.name
    }

    /// Number of steps; `None` if steps are chosen by their errors.
    #[getter]
    fn steps(&self) -> Option<usize> {
        let timeline = &self.read.problem.timeline;
        (!timeline.is_automatic()).then(|| timeline.steps())
    }

    /// The text of the case as run, overrides applied.
    #[getter]
    fn text(&self) -> &str {
        &self.read.text
    }
}

/// Reads the text of a case file.
#[pyfunction]
pub fn read(py: Python<'_>, path: PathBuf) -> PyResult<(String, String, PathBuf)> {
    let source = case::source(&path).map_err(|error| errors::of_case(py, &error))?;
    let folder = path.parent().map(std::path::Path::to_owned).unwrap_or_default();
    Ok((source.name, source.text, folder))
}

/// A value as JSON.
pub fn text(value: &serde_json::Value) -> PyResult<String> {
    serde_json::to_string(value).map_err(|error| errors::wrong(&error))
}

/// Checks a case; returns the output of `amontons check --format json`.
#[pyfunction]
pub fn check(py: Python<'_>, case: &Bound<'_, Case>, laws: Vec<Law>) -> PyResult<String> {
    let alarm = Alarm::default();
    let problem = with_laws(py, &case.get().read.problem, &laws, &alarm)?;
    let skipped = &case.get().read.skipped;
    let (made, raised) = attend(py, &alarm.flag, |_| {
        let (certificate, model) = (hypotheses::full(&problem), Model::new(&problem));
        json!({
            "case": problem.name,
            "dimension": problem.mesh.dim,
            "nodes": problem.mesh.points.len(),
            "cells": problem.mesh.cell_count(),
            "h": problem.mesh.h(),
            "steps": (!problem.timeline.is_automatic()).then(|| problem.timeline.steps()),
            "k": (!problem.timeline.is_automatic()).then(|| problem.timeline.longest()),
            "time": problem.timeline.end(),
            "model": model,
            "skipped": skipped,
            "findings": certificate.findings,
            "constants": certificate.constants,
        })
    })?;
    raised.or_else(|| alarm.take()).map_or_else(|| text(&made), Err)
}

/// Request for a study from the Python layer.
#[derive(FromPyObject)]
pub struct Study {
    levels: Vec<usize>,
    /// A level, `exact`, or `None` for the finest of the levels.
    reference: Option<usize>,
    exact: bool,
    vary: String,
    out: Option<PathBuf>,
    force: bool,
    threads: Option<usize>,
}

impl Study {
    /// The request in the form of the library.
    fn request(&self, py: Python<'_>) -> PyResult<StudyRequest> {
        let vary = match self.vary.as_str() {
            "both" => Vary::Both,
            "space" => Vary::Space,
            "time" => Vary::Time,
            other => {
                let text = format!("vary: found \"{other}\", expected \"both\", \"space\" or \"time\"");
                return Err(errors::request(py, &text));
            }
        };
        let reference = match (self.exact, self.reference) {
            (true, _) => ReferenceRequest::Exact,
            (false, Some(level)) => ReferenceRequest::Level(level),
            (false, None) => ReferenceRequest::Finest,
        };
        Ok(StudyRequest { vary, levels: self.levels.clone(), reference, power: 1 })
    }
}

/// Makes a convergence study; the table is that of `convergence.json`.
#[pyfunction]
pub fn converge(py: Python<'_>, case: &Bound<'_, Case>, request: Study) -> PyResult<String> {
    let Case { read: case, source, overrides } = case.get();
    let study = case::study(source, overrides, &request.request(py)?).map_err(|e| errors::of_study_request(py, &e))?;
    let folder = request.out.as_ref().map(|out| StudyFolder::create(out, request.force)).transpose();
    let folder = folder.map_err(|error| errors::of_output(py, &error))?;
    let flag = AtomicBool::new(false);
    let work = || solved(&study, folder.as_ref(), &flag);
    let (made, raised) = attend(py, &flag, |_| with_threads(request.threads, work))?;
    if let Some(raised) = raised {
        return Err(raised);
    }
    let (table, written) = made.map_err(|error| errors::of_run(py, &error))?;
    let table = table.map_err(|error| errors::of_study(py, &error))?;
    let finished = written.and_then(|()| match &folder {
        Some(folder) => folder.finish(&table, &case.text, &case.inputs),
        None => Ok(()),
    });
    finished.map_err(|error| errors::of_output(py, &error))?;
    text(&json!(table))
}

/// Solves the levels of a study. Levels stored in the folder are reused, and the others are stored there.
fn solved(
    study: &convergence::Study,
    folder: Option<&StudyFolder>,
    flag: &AtomicBool,
) -> (Result<StudyTable, StudyError>, Result<(), OutputError>) {
    let written = Mutex::new(Ok(()));
    let note = |result: Result<(), OutputError>| {
        if result.is_err() {
            *written.lock().unwrap_or_else(PoisonError::into_inner) = result;
        }
    };
    let keep = |level: &StudyLevel, states: &[State]| note(folder.map_or(Ok(()), |folder| folder.keep(level, states)));
    let keep_reference =
        |progress: &ReferenceProgress| note(folder.map_or(Ok(()), |folder| folder.keep_reference(study, progress)));
    let load = |level: &StudyLevel| folder?.load(level);
    let load_reference = || folder?.load_reference(study);
    let table = study.run(&StudySettings {
        interrupt: Some(flag),
        load: Some(&load),
        keep: Some(&keep),
        load_reference: Some(&load_reference),
        keep_reference: Some(&keep_reference),
        ..StudySettings::default()
    });
    (table, written.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Names of the shipped benchmarks.
#[pyfunction]
pub fn benchmarks() -> Vec<&'static str> {
    BENCHMARKS.iter().map(|(name, _)| *name).collect()
}

/// Verifies a shipped benchmark.
#[pyfunction]
pub fn verify_benchmark(py: Python<'_>, name: &str) -> PyResult<String> {
    let known = BENCHMARKS.iter().find(|(known, _)| *known == name);
    let Some((name, text)) = known else {
        let known = benchmarks().join(", ");
        return Err(errors::request(
            py,
            &format!("{name} is no case file, no results folder and no benchmark; the benchmarks are {known}"),
        ));
    };
    verified(py, &benchmark(name, text), &[])
}

/// Verifies a case by its `[expected]` and `[verify]`.
#[pyfunction]
pub fn verify(py: Python<'_>, case: &Bound<'_, Case>) -> PyResult<String> {
    verified(py, &case.get().source, &case.get().overrides)
}

fn verified(py: Python<'_>, source: &Source, overrides: &[String]) -> PyResult<String> {
    let flag = Arc::new(AtomicBool::new(false));
    let (made, raised) = attend(py, &flag, |_| {
        let settings = Settings { certificate: false, interrupt: Some(Arc::clone(&flag)), ..Settings::default() };
        verify_case(source, overrides, &settings)
    })?;
    match (raised, made) {
        (Some(raised), _) => Err(raised),
        (None, Ok(verdicts)) => text(&json!({ "verdicts": verdicts, "faults": [], "unchecked": [] })),
        (None, Err(error)) => Err(errors::of_verify(py, &error)),
    }
}

/// Recomputes the figures of a results folder from its files.
#[pyfunction]
pub fn verify_folder(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
    let found = py.detach(|| recompute(&folder)).map_err(|error| errors::of_verify(py, &error))?;
    let Recomputed { verdicts, unchecked, faults } = found;
    text(&json!({ "verdicts": verdicts, "faults": faults, "unchecked": unchecked }))
}
