//! Reads the fields of a results folder.

use std::path::Path;

use quick_xml::events::Event;

use super::PlotError;
pub(super) use crate::vtu::{Array, Grid};
use crate::vtu::{attribute, parse};

/// Reads a grid with all its data from a file.
pub(super) fn read(path: &Path) -> Result<Grid, PlotError> {
    let fault = |what: String| PlotError::Format { path: path.to_owned(), what };
    let bytes = std::fs::read(path).map_err(|source| PlotError::Read { path: path.to_owned(), source })?;
    parse(&bytes, |_| true).map_err(fault)
}

/// The data set of the latest time in a collection: its time and file.
pub(super) fn latest(path: &Path) -> Result<(f64, String), PlotError> {
    let text = super::table::text(path)?;
    let fault = |what: String| PlotError::Format { path: path.to_owned(), what };
    let mut reader = quick_xml::Reader::from_str(&text);
    let mut latest: Option<(f64, String)> = None;
    loop {
        match reader.read_event().map_err(|e| fault(e.to_string()))? {
            Event::Start(tag) | Event::Empty(tag) if tag.name().as_ref() == b"DataSet" => {
                let file = attribute(&tag, "file").map_err(fault)?.ok_or_else(|| fault("a DataSet has no file".to_owned()))?;
                let time = attribute(&tag, "timestep").map_err(fault)?.and_then(|t| t.parse::<f64>().ok()).filter(|t| t.is_finite());
                let time = time.ok_or_else(|| fault(format!("the DataSet of {file} has no timestep that is a number")))?;
                if latest.as_ref().is_none_or(|(t, _)| time >= *t) {
                    latest = Some((time, file));
                }
            }
            Event::Eof => break,
            _ => {}
        }
    }
    latest.ok_or_else(|| fault("it names no DataSet".to_owned()))
}
