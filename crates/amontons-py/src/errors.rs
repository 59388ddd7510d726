//! Errors of the library as Python exceptions, with the texts that the program prints.

use std::fmt::Display;
use std::io;

use amontons::case::{CaseError, CaseFault, FaultPlace, StudyRequestError};
use amontons::convergence::StudyError;
use amontons::output::OutputError;
use amontons::plot::PlotError;
use amontons::problem::Faults;
use amontons::run::{RunError, SteppingError};
use amontons::verify::VerifyError;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// An exception of `amontons._errors`, made from its arguments.
fn exception<'py>(py: Python<'py>, class: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let made =
        py.import("amontons._errors").and_then(|module| module.getattr(class)).and_then(|class| class.call1(arguments));
    match made {
        Ok(value) => PyErr::from_value(value),
        Err(error) => error,
    }
}

/// An error that data of this package cannot cause.
pub fn wrong(error: &dyn Display) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}

fn system(text: String, error: &io::Error) -> PyErr {
    match error.kind() {
        io::ErrorKind::NotFound => PyFileNotFoundError::new_err(text),
        _ => PyOSError::new_err(text),
    }
}

pub fn of_case(py: Python<'_>, error: &CaseError) -> PyErr {
    match error {
        CaseError::Read { source, .. } => system(error.to_string(), source),
        CaseError::Faults { file, faults, more } => {
            let faults: PyResult<Vec<Py<PyAny>>> = faults.iter().map(|fault| of_fault(py, fault)).collect();
            match faults {
                Ok(faults) => exception(py, "CaseError", (error.to_string(), faults, *more, &file.name, &file.text)),
                Err(error) => error,
            }
        }
    }
}

fn of_fault(py: Python<'_>, fault: &CaseFault) -> PyResult<Py<PyAny>> {
    let (mut line, mut column, mut given) = (None, None, None);
    match &fault.place {
        FaultPlace::File { line: l, column: c, .. } => (line, column) = (Some(*l), Some(*c)),
        FaultPlace::Override(text) => given = Some(text),
        FaultPlace::Whole => {}
    }
    let arguments = PyDict::new(py);
    arguments.set_item("key", &fault.path)?;
    arguments.set_item("found", &fault.found)?;
    arguments.set_item("expected", &fault.expected)?;
    arguments.set_item("hint", &fault.hint)?;
    arguments.set_item("line", line)?;
    arguments.set_item("column", column)?;
    arguments.set_item("override", given)?;
    let class = py.import("amontons._errors")?.getattr("Fault")?;
    Ok(class.call(PyTuple::empty(py), Some(&arguments))?.unbind())
}

/// Faults of data that come from laws given in place of those of the case.
pub fn of_faults(py: Python<'_>, faults: &Faults) -> PyErr {
    exception(py, "RequestError", (faults.to_string(),))
}

pub fn request(py: Python<'_>, text: &str) -> PyErr {
    exception(py, "RequestError", (text,))
}

pub fn of_study_request(py: Python<'_>, error: &StudyRequestError) -> PyErr {
    match error {
        StudyRequestError::Case(error) => of_case(py, error),
        StudyRequestError::Request { .. } => request(py, &error.to_string()),
    }
}

pub fn of_output(py: Python<'_>, error: &OutputError) -> PyErr {
    exception(py, "ResultsError", (error.to_string(),))
}

pub fn of_plot(py: Python<'_>, error: &PlotError) -> PyErr {
    match error {
        PlotError::Read { source, .. } | PlotError::Write { source, .. } => system(error.to_string(), source),
        _ => request(py, &error.to_string()),
    }
}

/// The exception of a run that did not reach its end. The results so far are added in Python.
pub fn of_run(py: Python<'_>, error: &RunError) -> PyErr {
    let class = match error {
        RunError::Threads { .. } => "ThreadsError",
        RunError::Setup(_) => "SetupError",
        RunError::Step { .. } => "StepError",
        RunError::Unsound(_) => "UnsoundError",
        RunError::Interrupted(_) | RunError::Unstarted { .. } => "Interrupted",
        RunError::Output(_) | RunError::Checkpoint(_) => "ResultsError",
    };
    exception(py, class, (error.to_string(), error.advice()))
}

/// The exception of a run that is made step by step.
pub fn of_stepping(py: Python<'_>, error: &SteppingError) -> PyErr {
    let class = match error {
        SteppingError::Step { source } if source.is_interruption() => "Interrupted",
        SteppingError::Step { .. } => "StepError",
        SteppingError::Setup(_) => "SetupError",
        SteppingError::AtEnd { .. } | SteppingError::Input(_) | SteppingError::Scheme { .. } => {
            return request(py, &error.to_string());
        }
        SteppingError::Checkpoint(_) => return request(py, &format!("the saved state is of another case: {error}")),
    };
    exception(py, class, (error.to_string(), error.advice()))
}

pub fn of_study(py: Python<'_>, error: &StudyError) -> PyErr {
    match error {
        StudyError::Interrupted => exception(py, "Interrupted", (error.to_string(),)),
        StudyError::Times { .. } | StudyError::Transfer { .. } => request(py, &error.to_string()),
        StudyError::Setup { .. } | StudyError::Step { .. } => exception(py, "StudyError", (error.to_string(),)),
    }
}

pub fn of_verify(py: Python<'_>, error: &VerifyError) -> PyErr {
    match error {
        VerifyError::Case(error) => of_case(py, error),
        VerifyError::Run(error) => of_run(py, error),
        VerifyError::Study(error) => of_study(py, error),
        VerifyError::Request(error) => of_study_request(py, error),
        VerifyError::Files(error) => of_output(py, error),
        VerifyError::Nothing(_) | VerifyError::Check(_) => request(py, &error.to_string()),
    }
}
