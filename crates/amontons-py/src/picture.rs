//! Pictures of runs in memory.

use std::path::PathBuf;

use amontons::plot::{self, Options, PictureKind, RunPanel};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors;
use crate::run::Run;
use crate::snapshot::Snapshot;

/// Draws a picture of a run at one of its snapshots: SVG and PNG.
#[pyfunction]
pub fn picture<'py>(
    run: &Bound<'py, Run>,
    snapshot: &Bound<'py, Snapshot>,
    name: &str,
    pixels: f64,
) -> PyResult<(String, Bound<'py, PyBytes>)> {
    let py = run.py();
    let Some(kind) = PictureKind::ALL.into_iter().find(|kind| kind.file_name() == name) else {
        let known: Vec<String> = PictureKind::ALL.iter().map(|kind| format!("\"{}\"", kind.file_name())).collect();
        return Err(errors::request(
            py,
            &format!("found the picture \"{name}\", expected one of {}", known.join(", ")),
        ));
    };
    let draw = || {
        let (run, at) = (run.get(), snapshot.get());
        let history = run.history().map(|(name, values)| (name.clone(), values)).collect();
        let drawn = py.detach(|| plot::DrawnRun::of_state(run.problem(), &at.state, &at.contact, history))?;
        let picture = plot::picture(kind, &[RunPanel { title: "", run: &drawn }], &Options::default())?;
        Ok((picture.svg(), picture.png(picture.density(pixels))?))
    };
    let (svg, png) = draw().map_err(|error| errors::of_plot(py, &error))?;
    Ok((svg, PyBytes::new(py, &png)))
}

/// Draws all pictures of a results folder, as `amontons plot` does; returns their paths.
#[pyfunction]
pub fn plot_folder(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<PathBuf>> {
    py.detach(|| plot::folder(&folder, &Options::default())).map_err(|error| errors::of_plot(py, &error))
}
