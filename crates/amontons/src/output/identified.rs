//! The results folder of identified parameters.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::OutputError;
use super::claimed::{ClaimedFolder, DESCENT, FIT};
use super::files::{remove_file, sha256, write_atomically, write_json};
use super::inputs::{Input, write_inputs};
use super::names::CASE;

/// Where an unfinished descent stands, with what it is a descent of.
#[derive(Serialize, Deserialize)]
struct KeptDescent<S> {
    /// SHA-256 of the case, the data, the parameters and their bounds.
    of: String,
    state: S,
}

/// A results folder that holds identified parameters: `fit.csv`, `fit.json`, `residuals.csv`, and the case with the
/// values found. While it is not finished it holds where the descent stands.
#[derive(Debug)]
pub struct IdentifiedFolder {
    folder: ClaimedFolder,
    of: String,
}

impl IdentifiedFolder {
    /// A folder for identified parameters, created if it does not exist, with the state of an unfinished descent in it
    /// of the same case, data, parameters and bounds, which `of` identifies.
    ///
    /// # Errors
    /// The folder holds other results, or identified parameters or an unfinished descent of something else and `force`
    /// is false; another process writes into it; or it cannot be created or read.
    pub fn create<S: for<'d> Deserialize<'d>>(
        path: impl Into<PathBuf>,
        of: &str,
        force: bool,
    ) -> Result<(IdentifiedFolder, Option<S>), OutputError> {
        let folder = ClaimedFolder::create(path.into(), FIT, force)?;
        let of = sha256(of);
        let path = folder.path().to_owned();
        let kept = match std::fs::read(path.join(DESCENT)) {
            Ok(bytes) if !force => Some(bytes),
            Ok(_) => None,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
            Err(source) => return Err(OutputError::Io { doing: "read", path: path.join(DESCENT), source }),
        };
        let state = match kept.map(|bytes| serde_json::from_slice::<KeptDescent<S>>(&bytes)) {
            None => None,
            Some(Ok(kept)) if kept.of == of => Some(kept.state),
            Some(_) => {
                let found = "an unfinished fit of another case, other data or other parameters".to_owned();
                let advice = "begin anew with --force, or give another folder with --out".to_owned();
                return Err(OutputError::HoldsResults { path, found, advice });
            }
        };
        Ok((IdentifiedFolder { folder, of }, state))
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Keeps where the descent stands.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep(&self, state: &impl Serialize) -> Result<(), OutputError> {
        let kept = KeptDescent { of: self.of.clone(), state };
        write_json(&self.path().join(DESCENT), &kept).map(|_| ())
    }

    /// Writes the parameters and the residuals as CSV, all of it as JSON, and the case with the values found and the
    /// files that it refers to.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(
        &self,
        (parameters, residuals): (&str, &str),
        json: &serde_json::Value,
        case: &str,
        inputs: &[Input],
    ) -> Result<(), OutputError> {
        let text = |name: &str, text: &str| {
            write_atomically(&self.path().join(name), |out| out.write_all(text.as_bytes())).map(|_| ())
        };
        text(CASE, case)?;
        write_inputs(self.path(), inputs)?;
        text("residuals.csv", residuals)?;
        write_json(&self.path().join("fit.json"), json)?;
        text(FIT, parameters)?;
        remove_file(&self.path().join(DESCENT))
    }
}
