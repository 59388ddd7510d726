//! The results folder of a convergence study.

use std::path::{Path, PathBuf};

use super::checkpoint::{read_states, write_states};
use super::files::{create_folder, write_atomically, write_json};
use super::inputs::{Input, write_inputs};
use super::{OutputError, Table};
use crate::convergence::Level;
use crate::scheme::State;

/// A results folder that holds a study: `convergence.csv`, `convergence.json`, and `levels/` with the states of
/// finished levels, which a study that was interrupted goes on with.
#[derive(Debug)]
pub struct StudyFolder {
    path: PathBuf,
}

impl StudyFolder {
    /// A folder for a study; it is created if it is not there.
    ///
    /// # Errors
    /// When it holds a finished study or a run and `force` is not given, or cannot be created.
    pub fn create(path: impl Into<PathBuf>, force: bool) -> Result<StudyFolder, OutputError> {
        let path = path.into();
        let found = ["convergence.csv", "summary.json", "history.csv"].iter().find(|name| path.join(name).symlink_metadata().is_ok());
        if let Some(found) = found.filter(|_| !force) {
            return Err(OutputError::HoldsResults { path, found: (*found).to_owned() });
        }
        create_folder(&path.join("levels"))?;
        Ok(StudyFolder { path })
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn file(&self, level: &Level) -> PathBuf {
        self.path.join("levels").join(format!("{}.bin", level.level))
    }

    /// States of a level that was finished before with the same case; none if there are none to be had.
    #[must_use]
    pub fn load(&self, level: &Level) -> Option<Vec<State>> {
        // A file that is damaged or of another case is no level that was finished: it is solved anew.
        read_states(&self.file(level), &key(level)).ok()
    }

    /// Keeps the states of a finished level.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn keep(&self, level: &Level, states: &[State]) -> Result<(), OutputError> {
        write_states(&self.file(level), &key(level), states)
    }

    /// Writes the table, with the text of the case and the files that it refers to beside it.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn finish(&self, table: &Table, case: &str, inputs: &[Input]) -> Result<(), OutputError> {
        write_atomically(&self.path.join("case.toml"), |out| std::io::Write::write_all(out, case.as_bytes()))?;
        write_inputs(&self.path, inputs)?;
        write_json(&self.path.join("convergence.json"), table)?;
        write_atomically(&self.path.join("convergence.csv"), |out| std::io::Write::write_all(out, table.csv().as_bytes()))
    }
}

/// What the states of a level depend on.
fn key(level: &Level) -> String {
    format!("{}\n{}", env!("CARGO_PKG_VERSION"), level.text)
}
