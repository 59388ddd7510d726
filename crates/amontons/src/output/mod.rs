//! Results: a run pushes its steps to [`Sink`]s, which keep, write or show them.
//!
//! | sink | does |
//! |---|---|
//! | [`Memory`] | keeps states and reports for tests and studies |
//! | [`Folder`] | writes the results folder |
//!
//! Values derived from a state: [`cell_values`] (strain, stress, heat flux of the cells), [`nodal_stress`] (stresses
//! recovered at the nodes), and [`ProbeSet`] (numbers at points, over sides and regions).

mod borne;
mod cells;
pub mod checkpoint;
mod claimed;
pub mod columns;
mod csv;
mod discretization_error;
mod earlier;
mod error_of_run;
mod files;
mod final_values;
mod fit;
mod folder;
mod gradient;
mod identified;
mod identity;
mod inputs;
mod inspect;
mod jumps;
mod limits;
mod lock;
mod manifest;
mod memory;
mod modes;
pub(crate) mod names;
mod owned;
mod packed;
mod probe;
mod probe_place;
mod probe_take;
mod quantity;
mod reaction;
mod recovery;
mod room;
mod shown;
mod study;
mod summary;
mod surface;
mod turned;
mod vtu;
mod whole;
mod words;

use std::io;
use std::path::{Path, PathBuf};

pub use cells::{PointValues, cell_values, largest_strain, strain_norm};
pub use checkpoint::{Checkpoint, CheckpointError};
#[cfg(feature = "case")]
pub(crate) use columns::contact_rows;
pub use columns::{
    ContactValues, contact_columns, contact_measures, history_columns, history_measures, history_values,
};
pub use discretization_error::{ErrorSummary, per_cent};
pub use earlier::{finished_run, has_certificate, known_certificate};
pub use error_of_run::ErrorOfRun;
#[cfg(feature = "plot")]
pub(crate) use files::write_file;
#[cfg(feature = "case")]
pub(crate) use files::{LONGEST, sha256};
#[cfg(feature = "case")]
pub(crate) use final_values::compared_columns;
pub use final_values::{ValuesOfRun, final_values};
pub use folder::{CheckpointInterval, Folder, FolderOptions};
pub use gradient::GradientFolder;
pub use identified::IdentifiedFolder;
pub use identity::Identity;
pub use inputs::{Input, fingerprint};
pub use inspect::{Inspection, inspect};
pub use jumps::{JumpsOfRun, gradient_jumps};
pub use lock::FolderLock;
pub use memory::Memory;
pub use modes::{ModesFolder, ModesOf, modes_json};
pub use names::{ACCURACY, BARS, INPUTS};
pub use packed::FieldsFormat;
#[cfg(feature = "case")]
pub(crate) use packed::StoredFields;
pub use probe::ProbeSet;
pub use probe_place::{Probe, ProbeError, ProbePlace, Take};
pub(crate) use quantity::OF_WHOLE;
pub use quantity::{Base, Quantity, Selection, quantities};
pub use recovery::{NodalStress, StressRecovery, nodal_stress};
pub use shown::{Lives, ResultTable, Shown};
pub use study::StudyFolder;
#[cfg(feature = "case")]
pub(crate) use summary::of_last;
pub use summary::{ContactSummary, Final, Norms, Outcome, Seconds, SolverCounts, Summary, UnknownCounts};
#[cfg(feature = "plot")]
pub(crate) use surface::{measures as surface_measures, sides as surface_sides};
pub use vtu::OutputField;
pub use words::{computed_with, unknowns_in_words};

use crate::convergence::StudyTable;
use crate::discretization::Discretization;
use crate::hypotheses::Finding;
use crate::problem::Problem;
use crate::state::{State, StepReport};
use crate::step::Scheme;

/// Every value that a run can show, for a body in space, without the names of sides.
#[must_use]
pub fn shown() -> Vec<Shown> {
    let of_tables = columns::history_shown().chain(columns::contact_shown());
    shown::summary_shown().chain(of_tables).chain(vtu::shown()).chain(surface::shown()).collect()
}

/// A receiver of the results of a run. A run calls `start` once, `step` after every step, and at its end, for whatever
/// reason, `last` (or `interrupted`) and `finish` once, unless a sink itself has failed. A method that a sink leaves
/// out does nothing.
pub trait Sink {
    /// Called when the system is set up, before the first step.
    ///
    /// # Errors
    /// The sink cannot take results: the run ends.
    fn start(&mut self, start: &RunStart) -> Result<(), OutputError> {
        let _ = start;
        Ok(())
    }
    /// Called after each step.
    ///
    /// # Errors
    /// The step cannot be kept: the run ends.
    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        let _ = now;
        Ok(())
    }
    /// Called when the run is over; `last` is the last good step, whatever the outcome.
    ///
    /// # Errors
    /// The results cannot be kept.
    fn last(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        let _ = last;
        Ok(())
    }
    /// Called instead of `last` if the run was asked to stop; the sink should finish soon.
    ///
    /// # Errors
    /// The results cannot be kept.
    fn interrupted(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        self.last(last)
    }
    /// Called last, with the summary of the run.
    ///
    /// # Errors
    /// The results cannot be kept.
    fn finish(&mut self, summary: &Summary) -> Result<(), OutputError> {
        let _ = summary;
        Ok(())
    }
}

/// Information available when a run starts.
#[derive(Clone, Copy, Debug)]
pub struct RunStart<'a> {
    /// The state from which the run starts: at t = 0, or of a checkpoint.
    pub from: Snapshot<'a>,
    /// Number of threads of the run.
    pub threads: usize,
    /// True if the run continues from a checkpoint.
    pub resumed: bool,
    /// The findings of the certificate, if the run has one.
    pub certificate: Option<&'a [Finding]>,
}

/// A run at a time t_n, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<'a> {
    /// The problem.
    pub problem: &'a Problem,
    /// Its discretization.
    pub discretization: &'a Discretization,
    /// The state.
    pub state: &'a State,
    /// Report of the step that led here, or `None` at t = 0.
    pub report: Option<&'a StepReport>,
    /// Work done so far.
    pub work: Work,
    /// The scheme that makes the steps, or `None` if results are read from files.
    pub scheme: Option<&'a dyn Scheme>,
}

/// Work since the start of a run, including the sessions before a checkpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Work {
    /// Factorizations of the systems.
    pub factorizations: usize,
    /// Factorizations of condensed systems on Γ_C.
    pub contact_factorizations: usize,
    /// Times spent.
    pub seconds: Seconds,
}

/// Results that could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The system refused an operation on a file.
    #[error("cannot {doing} {}: {source}", path.display())]
    Io {
        /// The attempted operation: `write`, `create`, `read`.
        doing: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// The process that writes could not; it says why.
    #[error("the results cannot be written: the first process says why")]
    Elsewhere,
    /// The folder holds results that would be lost.
    #[error("{} holds {found}; {advice}", path.display())]
    HoldsResults {
        /// The folder.
        path: PathBuf,
        /// Its contents.
        found: String,
        /// Instruction what to do.
        advice: String,
    },
    /// A file that the run would replace does not belong to a run.
    #[error("{} was not written by a run that the folder's manifest.json lists, and would be replaced; move it away, or give another folder with --out", path.display())]
    Stranger {
        /// The file.
        path: PathBuf,
    },
    /// Another process writes into the folder.
    #[error("{} is in use{}; wait until that run has ended, or give another folder with --out", path.display(), if holder.is_empty() { String::new() } else { format!(" by {holder}") })]
    InUse {
        /// The folder.
        path: PathBuf,
        /// The writing process.
        holder: String,
    },
    /// The results do not fit on the disk.
    #[error("{}: the results need about {:.3e} bytes, and {:.3e} are free on its disk; write fewer snapshots (output.every), or give a folder on another disk with --out", path.display(), needed, free)]
    NoRoom {
        /// The folder.
        path: PathBuf,
        /// Required space, bytes.
        needed: f64,
        /// Free space, bytes.
        free: f64,
    },
    /// The files of a run do not fit together.
    #[error("{}: found {found}, expected {expected}", path.display())]
    Inconsistent {
        /// The file.
        path: PathBuf,
        /// The contradiction found.
        found: String,
        /// The expected state.
        expected: String,
    },
    /// A probe that cannot be read.
    #[error("probe {name}: found {source}")]
    Probe {
        /// Its name.
        name: String,
        /// The reason.
        source: ProbeError,
    },
    /// The file of the fields could not be made.
    #[error("cannot encode {}: {message}", path.display())]
    Encode {
        /// The file.
        path: PathBuf,
        /// The error message.
        message: String,
    },
}

impl OutputError {
    /// An operation that the system refused.
    pub(crate) fn io(doing: &'static str, path: &Path) -> impl FnOnce(io::Error) -> OutputError + use<> {
        let path = path.to_owned();
        move |source| OutputError::Io { doing, path, source }
    }
}
