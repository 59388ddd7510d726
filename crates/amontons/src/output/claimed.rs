//! Results folders that are known by one table: of a study, of derivatives, of modes.

use std::path::{Path, PathBuf};

use super::files::{create_folder, remove_empty_folder};
use super::names::MANIFEST;
use super::{FolderLock, OutputError};

/// The table of a study, of derivatives, and of modes.
pub(super) const STUDY: &str = "convergence.csv";
pub(super) const GRADIENT: &str = "gradient.csv";
pub(super) const MODES: &str = "modes.csv";
/// That of identified parameters, and where an unfinished descent to them stands.
pub(super) const FIT: &str = "fit.csv";
pub(super) const DESCENT: &str = "descent.json";

/// Files by which a results folder is known, and what it then holds.
const KNOWN_BY: [(&str, &str); 5] = [
    (MANIFEST, "a run"),
    (STUDY, "a finished study"),
    (GRADIENT, "derivatives"),
    (MODES, "modes"),
    (FIT, "identified parameters"),
];

/// A results folder with one writer. If nothing was written into it, it is removed when it is dropped.
#[derive(Debug)]
pub(super) struct ClaimedFolder {
    path: PathBuf,
    lock: Option<FolderLock>,
}

impl ClaimedFolder {
    /// The folder of a table, created if it does not exist.
    ///
    /// # Errors
    /// The folder holds results of another kind, or the table and `force` is false; another process writes into it; or
    /// it cannot be created.
    pub fn create(path: PathBuf, table: &str, force: bool) -> Result<ClaimedFolder, OutputError> {
        let is_there = |name: &str| path.join(name).symlink_metadata().is_ok();
        if let Some((name, found)) = KNOWN_BY.iter().find(|(name, _)| is_there(name) && !(force && *name == table)) {
            let other = "give another folder with --out";
            let advice = if *name == table { format!("replace it with --force, or {other}") } else { other.to_owned() };
            return Err(OutputError::HoldsResults { path, found: (*found).to_owned(), advice });
        }
        create_folder(&path)?;
        let lock = Some(FolderLock::take(&path)?);
        Ok(ClaimedFolder { path, lock })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for ClaimedFolder {
    fn drop(&mut self) {
        // The lock is a file of the folder.
        drop(self.lock.take());
        remove_empty_folder(&self.path);
    }
}
