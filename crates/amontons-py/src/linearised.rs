//! What the linearised steps of a case give: derivatives of a run, and modes of its last state.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use amontons::adjoint::{GradientError, GradientRequest, GradientTable, Parameter, gradient as derivatives};
use amontons::case;
use amontons::output::{ModesOf, OutputError, RunStart, Sink, Snapshot, Summary, modes_json};
use amontons::run::{self, RunError, Settings, with_threads};
use amontons::stability::{self, Modes, Reason, StabilityError, Wanted};
use pyo3::prelude::*;

use crate::attend::attend;
use crate::case::{Case, text};
use crate::errors;

/// Derivatives of numbers at the end of a run by keys; the table is that of `gradient.json`.
#[pyfunction]
pub fn gradient(
    py: Python<'_>,
    case: &Bound<'_, Case>,
    of: Vec<String>,
    wrt: Vec<String>,
    threads: Option<usize>,
) -> PyResult<String> {
    let Case { read, source, overrides } = case.get();
    let flag = AtomicBool::new(false);
    let work = || -> Result<GradientTable, String> {
        let parameter = |key: &String| case::parameter(source, overrides, key).map_err(|fault| fault.to_string());
        let parameters = wrt.iter().map(parameter).collect::<Result<Vec<Parameter>, String>>()?;
        let request = GradientRequest {
            problem: &read.problem,
            probes: &read.probes,
            outputs: &of,
            parameters: &parameters,
            memory: None,
            interrupt: Some(&flag),
        };
        derivatives(&request).map_err(|error| match error {
            GradientError::Interrupted => String::new(),
            error => error.to_string(),
        })
    };
    let (made, raised) = attend(py, &flag, |_| with_threads(threads, work))?;
    if let Some(raised) = raised {
        return Err(raised);
    }
    let table = made.map_err(|error| errors::of_run(py, &error))?;
    let table = table.map_err(|message| errors::request(py, &message))?;
    text(&serde_json::json!(table))
}

/// Finds the modes of the last state of a run.
struct ModesOfLast<'a> {
    wanted: &'a Wanted<'a>,
    found: Result<Modes, StabilityError>,
}

impl Sink for ModesOfLast<'_> {
    fn start(&mut self, _start: &RunStart) -> Result<(), OutputError> {
        Ok(())
    }

    fn step(&mut self, _now: &Snapshot) -> Result<(), OutputError> {
        Ok(())
    }

    fn last(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        if let (Some(report), true) = (last.report, last.state.is_last(&last.problem.timeline)) {
            self.found = stability::modes(last.problem, last.discretization, last.state, report, self.wanted);
        }
        Ok(())
    }

    fn finish(&mut self, _summary: &Summary) -> Result<(), OutputError> {
        Ok(())
    }
}

/// The modes of the state at the end of a run, as `[stability]` asks for them; the table is that of `modes.json`.
#[pyfunction]
pub fn modes(py: Python<'_>, case: &Bound<'_, Case>, threads: Option<usize>) -> PyResult<String> {
    let Case { read, .. } = case.get();
    let flag = Arc::new(AtomicBool::new(false));
    let work = || -> Result<Result<Modes, StabilityError>, RunError> {
        let settings = Settings { interrupt: Some(Arc::clone(&flag)), certificate: false, ..Settings::default() };
        let wanted = read.stability.wanted(&read.problem, Some(&flag));
        let mut seen = ModesOfLast { wanted: &wanted, found: Err(StabilityError::State(Reason::NoStep)) };
        run::run(&read.problem, &settings, &mut [&mut seen])?;
        Ok(seen.found)
    };
    let (made, raised) = attend(py, &flag, |_| with_threads(threads, work))?;
    if let Some(raised) = raised {
        return Err(raised);
    }
    let found = made.and_then(|made| made).map_err(|error| errors::of_run(py, &error))?;
    let modes = found.map_err(|error| errors::request(py, &error.to_string()))?;
    text(&modes_json(&read.problem, &[ModesOf { values: Vec::new(), modes }]))
}
