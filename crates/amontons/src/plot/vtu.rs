//! Reads the fields of a results folder.

use std::path::Path;

use quick_xml::events::Event;

use super::PlotError;
use crate::machine;
use crate::output::LONGEST;
pub(super) use crate::vtu::{Array, Grid};
use crate::vtu::{attribute, parse};

/// Reads a grid with all its data from a file.
pub(super) fn read(path: &Path) -> Result<Grid, PlotError> {
    let fault = |what: String| PlotError::Format { path: path.to_owned(), what };
    let bytes = machine::read(path, LONGEST).map_err(|source| PlotError::Read { path: path.to_owned(), source })?;
    parse(&bytes, |_| true).map_err(fault)
}

/// The data sets of a collection, times and files, in the order of time; at least one.
pub(super) fn snapshots(path: &Path) -> Result<Vec<(f64, String)>, PlotError> {
    let text = super::table::text(path)?;
    let fault = |what: String| PlotError::Format { path: path.to_owned(), what };
    let mut reader = quick_xml::Reader::from_str(&text);
    let mut all: Vec<(f64, String)> = Vec::new();
    loop {
        match reader.read_event().map_err(|e| fault(e.to_string()))? {
            Event::Start(tag) | Event::Empty(tag) if tag.name().as_ref() == b"DataSet" => {
                let file =
                    attribute(&tag, "file").map_err(fault)?.ok_or_else(|| fault("a DataSet has no file".to_owned()))?;
                let time = attribute(&tag, "timestep")
                    .map_err(fault)?
                    .and_then(|t| t.parse::<f64>().ok())
                    .filter(|t| t.is_finite());
                let time =
                    time.ok_or_else(|| fault(format!("the DataSet of {file} has no timestep that is a number")))?;
                all.push((time, file));
            }
            Event::Eof => break,
            _ => {}
        }
    }
    if all.is_empty() {
        return Err(fault("it names no DataSet".to_owned()));
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(all)
}
