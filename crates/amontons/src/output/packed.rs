//! `fields.vtkhdf`: the fields of all snapshots of a run in one file, with one copy of the mesh.
//!
//! During a run its snapshots are the files `fields/*.vtu`. At its end they are packed into this file; if the run
//! continues, they are unpacked first. So each snapshot is on the disk at all times, and the file does not depend on
//! the number of interruptions.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::OutputError;
use super::files::{LONGEST, WrittenFile, make_atomically};
use super::names::{PACKED, fields_file};
use super::vtu::write_grid;
use crate::machine;
use crate::vtkhdf::{self, GridSeries, Reader, WriteError};
use crate::vtu::{self, Grid};

/// Format of the fields of a finished run. During a run, and after an interruption, they are in `fields/*.vtu`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FieldsFormat {
    /// `fields.pvd` with `fields/*.vtu`, one file per snapshot.
    #[default]
    Vtu,
    /// `fields.vtkhdf`, one file for all snapshots.
    Vtkhdf,
    /// Both.
    Both,
}

/// Result of packing.
pub(super) enum Packed {
    /// The file is written.
    Written(WrittenFile),
    /// The snapshots cannot be packed.
    Refused(String),
}

/// Packs the snapshots of some steps and times; `units` has the units of arrays.
pub(super) fn pack(root: &Path, at: &[(usize, f64)], units: &BTreeMap<String, String>) -> Result<Packed, OutputError> {
    let path = root.join(PACKED);
    let source = |index: usize, wanted: &dyn Fn(&str) -> bool| read(&root.join(fields_file(at[index].0)), wanted);
    let unit = |name: &str| units.get(name).cloned();
    let series = GridSeries { at, source: &source, unit: &unit, room: GridSeries::room() };
    match make_atomically(&path, |temporary| vtkhdf::write(temporary, &series))? {
        Ok(written) => Ok(Packed::Written(written)),
        Err(WriteError::Snapshots(why)) => Ok(Packed::Refused(why)),
        Err(WriteError::File(hdf5_pure::Error::Io(source))) => Err(OutputError::io("write", &path)(source)),
        Err(WriteError::File(error)) => Err(OutputError::Encode { path, message: error.to_string() }),
    }
}

/// Writes the wanted snapshots that are missing as separate files. Returns the steps of all wanted ones.
pub(super) fn unpack(root: &Path, wanted: impl Fn(usize) -> bool) -> Result<Vec<usize>, OutputError> {
    let path = root.join(PACKED);
    if path.symlink_metadata().is_err() {
        return Ok(Vec::new());
    }
    let damaged = |found: String| OutputError::Inconsistent {
        path: path.clone(),
        found,
        expected: "the fields of the run; move the file away to go on without them".to_owned(),
    };
    let reader = Reader::open(&path).map_err(damaged)?;
    let mut steps = Vec::new();
    for (index, &(step, _)) in reader.at().iter().enumerate().filter(|(_, (step, _))| wanted(*step)) {
        let file = root.join(fields_file(step));
        if file.symlink_metadata().is_err() {
            write_grid(&file, &reader.grid(index).map_err(damaged)?)?;
        }
        steps.push(step);
    }
    Ok(steps)
}

fn read(path: &Path, wanted: impl Fn(&str) -> bool) -> Result<Grid, String> {
    let bytes = machine::read(path, LONGEST).map_err(|error| format!("cannot be read: {error}"))?;
    vtu::parse(&bytes, wanted)
}

/// The fields of a results folder, packed or in separate files.
pub(crate) struct StoredFields {
    #[cfg_attr(not(feature = "case"), expect(dead_code, reason = "a verification, which has a case, reads it"))]
    root: PathBuf,
    /// The file of all snapshots, if it is there.
    packed: Option<Result<Reader, String>>,
}

impl StoredFields {
    /// Opens the fields of a folder.
    pub fn of(root: &Path) -> StoredFields {
        let path = root.join(PACKED);
        let packed = path.symlink_metadata().is_ok().then(|| Reader::open(&path));
        StoredFields { root: root.to_owned(), packed }
    }

    /// Steps and times in the packed file; empty if there is no such file.
    ///
    /// # Errors
    /// The fault of the file.
    pub fn packed(&self) -> Result<&[(usize, f64)], String> {
        match &self.packed {
            Some(Ok(reader)) => Ok(reader.at()),
            Some(Err(what)) => Err(what.clone()),
            None => Ok(&[]),
        }
    }
}

/// Access for `amontons verify`.
#[cfg(feature = "case")]
impl StoredFields {
    /// Name of the file of the fields at a step.
    pub fn name(&self, step: usize) -> String {
        let own = fields_file(step);
        if self.packed.is_some() && !self.root.join(&own).exists() { format!("{PACKED}, step {step}") } else { own }
    }

    /// The grid with all fields at a step.
    ///
    /// # Errors
    /// The fault of the file.
    pub fn grid(&self, step: usize) -> Result<Grid, String> {
        let own = self.root.join(fields_file(step));
        let packed = self.packed.as_ref().filter(|_| !own.exists());
        let Some(packed) = packed else { return read(&own, |_| true) };
        let reader = packed.as_ref().map_err(String::clone)?;
        let index = reader.at().iter().position(|(other, _)| *other == step);
        reader.grid(index.ok_or_else(|| format!("it does not have step {step}"))?)
    }
}
