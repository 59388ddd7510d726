//! The results folder of derivatives.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::OutputError;
use super::claimed::{ClaimedFolder, GRADIENT};
use super::files::{write_atomically, write_json};
use super::inputs::{Input, write_inputs};
use super::names::CASE;

/// A results folder that holds derivatives of a run: `gradient.csv` and `gradient.json`.
#[derive(Debug)]
pub struct GradientFolder(ClaimedFolder);

impl GradientFolder {
    /// A folder for derivatives, created if it does not exist.
    ///
    /// # Errors
    /// The folder holds other results, or derivatives and `force` is false; another process writes into it; or it
    /// cannot be created.
    pub fn create(path: impl Into<PathBuf>, force: bool) -> Result<GradientFolder, OutputError> {
        let folder = ClaimedFolder::create(path.into(), GRADIENT, force)?;
        Ok(GradientFolder(folder))
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.0.path()
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
        write_atomically(&self.path().join(CASE), |out| out.write_all(case.as_bytes()))?;
        write_inputs(self.path(), inputs)?;
        write_json(&self.path().join("gradient.json"), table)?;
        write_atomically(&self.path().join(GRADIENT), |out| out.write_all(csv.as_bytes())).map(|_| ())
    }
}
