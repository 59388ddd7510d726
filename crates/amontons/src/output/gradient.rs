//! The results folder of derivatives.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::files::{create_folder, write_atomically, write_json};
use super::inputs::{Input, write_inputs};
use super::names::{CASE, MANIFEST};
use super::{FolderLock, OutputError};

/// Name of the table.
const TABLE: &str = "gradient.csv";

/// A results folder that holds derivatives of a run: `gradient.csv` and `gradient.json`.
#[derive(Debug)]
pub struct GradientFolder {
    path: PathBuf,
    _lock: FolderLock,
}

impl GradientFolder {
    /// A folder for derivatives, created if it does not exist.
    ///
    /// # Errors
    /// The folder holds a run, or derivatives and `force` is false; another process writes into it; or it cannot be
    /// created.
    pub fn create(path: impl Into<PathBuf>, force: bool) -> Result<GradientFolder, OutputError> {
        let path = path.into();
        let holds = |found: &str, advice: &str| {
            Err(OutputError::HoldsResults { path: path.clone(), found: found.to_owned(), advice: advice.to_owned() })
        };
        let is_there = |name: &str| path.join(name).symlink_metadata().is_ok();
        if is_there(MANIFEST) || is_there("convergence.csv") {
            return holds("a run or a study", "give another folder with --out");
        }
        if is_there(TABLE) && !force {
            return holds("derivatives", "replace them with --force, or give another folder with --out");
        }
        create_folder(&path)?;
        let lock = FolderLock::take(&path)?;
        Ok(GradientFolder { path, _lock: lock })
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the table as CSV and as JSON, the text of the case and the files that it refers to.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(
        &self,
        (csv, table): (&str, &impl Serialize),
        case: &str,
        inputs: &[Input],
    ) -> Result<(), OutputError> {
        write_atomically(&self.path.join(CASE), |out| out.write_all(case.as_bytes()))?;
        write_inputs(&self.path, inputs)?;
        write_json(&self.path.join("gradient.json"), table)?;
        write_atomically(&self.path.join(TABLE), |out| out.write_all(csv.as_bytes())).map(|_| ())
    }
}
