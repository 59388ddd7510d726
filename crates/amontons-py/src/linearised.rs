//! What the linearised steps of a case give: derivatives of a run, parameters from measured values, and modes of its
//! last state.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use amontons::adjoint::{GradientError, GradientRequest, GradientTable, Parameter, gradient as derivatives};
use amontons::case;
use amontons::identification::{IdentificationRequest, Identified, MeasuredTable, identify};
use amontons::output::{ModesOf, modes_json};
use amontons::problem::Fault;
use amontons::run::{ModeSlopesError, RunError, Settings, modes_with, with_threads};
use amontons::stability::{Modes, StabilityError};
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

/// Identifies keys of a case from a table of measured values; the answer is that of `fit.json`, with the overrides that
/// set the values found.
#[pyfunction]
pub fn fit(
    py: Python<'_>,
    case: &Bound<'_, Case>,
    data: String,
    free: Vec<String>,
    bounds: Vec<[f64; 2]>,
    threads: Option<usize>,
) -> PyResult<String> {
    let Case { read, source, overrides } = case.get();
    let flag = AtomicBool::new(false);
    let work = || -> Result<(Identified, Vec<String>), String> {
        let told = |fault: Fault| fault.to_string();
        let measured = MeasuredTable::parse("data", data.as_bytes()).map_err(told)?;
        let family = case::family(source, overrides, &free).map_err(told)?;
        let request = IdentificationRequest {
            family: &family,
            bounds: &bounds,
            probes: &read.probes,
            measured: &measured,
            from: None,
            interrupt: Some(&flag),
        };
        let found = identify(&request, &mut |_| Ok(())).map_err(|error| error.to_string())?;
        let values: Vec<(&str, f64)> = found.parameters.iter().map(|of| (of.name.as_str(), of.value)).collect();
        let set = case::settings(source, overrides, &values).map_err(told)?;
        Ok((found, set))
    };
    let (made, raised) = attend(py, &flag, |_| with_threads(threads, work))?;
    if let Some(raised) = raised {
        return Err(raised);
    }
    let found = made.map_err(|error| errors::of_run(py, &error))?;
    let (found, set) = found.map_err(|message| errors::request(py, &message))?;
    let mut table = serde_json::json!(found);
    table["overrides"] = serde_json::json!(set);
    text(&table)
}

/// The modes of the state at the end of a run, as `[stability]` asks for them, with their derivatives by keys; the table
/// is that of `modes.json`.
#[pyfunction]
pub fn modes(py: Python<'_>, case: &Bound<'_, Case>, wrt: Vec<String>, threads: Option<usize>) -> PyResult<String> {
    let Case { read, source, overrides } = case.get();
    let flag = Arc::new(AtomicBool::new(false));
    let work = || -> Result<Result<Modes, StabilityError>, RunError> {
        let parameter = |key: &String| case::parameter(source, overrides, key);
        let parameters = match wrt.iter().map(parameter).collect::<Result<Vec<Parameter>, Fault>>() {
            Ok(parameters) => parameters,
            Err(fault) => return Ok(Err(StabilityError::Problem(fault))),
        };
        let settings = Settings { interrupt: Some(Arc::clone(&flag)), certificate: false, ..Settings::default() };
        match modes_with(&read.problem, &read.stability, &parameters, &settings, None) {
            Ok(found) => Ok(Ok(found.modes)),
            Err(ModeSlopesError::Modes(error)) => Ok(Err(error)),
            Err(ModeSlopesError::Run(error)) => Err(error),
        }
    };
    let (made, raised) = attend(py, &flag, |_| with_threads(threads, work))?;
    if let Some(raised) = raised {
        return Err(raised);
    }
    let found = made.and_then(|made| made).map_err(|error| errors::of_run(py, &error))?;
    let modes = found.map_err(|error| errors::request(py, &error.to_string()))?;
    text(&modes_json(&read.problem, &[ModesOf { values: Vec::new(), modes }]))
}
