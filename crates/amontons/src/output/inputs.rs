//! Files that a case refers to, kept with its results.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use super::OutputError;
use super::files::{create_folder, sha256, write_atomically};
use super::names::INPUTS;

/// A file that a case refers to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// Its path seen from the case as run, `inputs/…`.
    pub path: String,
    /// Its bytes.
    pub bytes: Arc<[u8]>,
}

/// Identifies a case by its text and the SHA-256 of the files that it refers to.
///
/// Without such files it is the text alone.
#[must_use]
pub fn fingerprint(text: &str, inputs: &[Input]) -> String {
    let mut all = text.to_owned();
    for input in inputs {
        let _ = write!(all, "\n# {} sha256 {}", input.path, sha256(&input.bytes));
    }
    all
}

/// Writes copies of the files into a results folder.
pub(super) fn write_inputs(folder: &Path, inputs: &[Input]) -> Result<(), OutputError> {
    if !inputs.is_empty() {
        create_folder(&folder.join(INPUTS))?;
    }
    inputs.iter().try_for_each(|input| {
        write_atomically(&folder.join(&input.path), |out| std::io::Write::write_all(out, &input.bytes)).map(|_| ())
    })
}
