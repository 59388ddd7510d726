//! Comparison of the files of a results folder with those that the run wrote.

use std::path::Path;

use super::files::WrittenFile;
use super::manifest::Manifest;
use super::names::{FIELDS_FOLDER, MANIFEST, PACKED};
use super::packed::StoredFields;
use super::{OutputError, owned};

/// The files of a results folder compared with its manifest.
#[derive(Clone, Debug, Default)]
pub struct Inspection {
    /// Number of files that the manifest lists.
    pub listed: usize,
    /// Number of listed files that are unchanged.
    pub intact: usize,
    /// Changed or missing files, and files that are not listed.
    pub faults: Vec<String>,
    /// Steps of the field snapshots that are there, ascending.
    pub snapshots: Vec<usize>,
    /// The step at which the run ended, or `None` if it is running or was killed.
    pub ended: Option<usize>,
    /// SHA-256 of the inputs of the run, hexadecimal.
    pub input_sha256: String,
    /// The overrides that the case was run with.
    pub overrides: Vec<String>,
}

/// Compares the files of a results folder with its manifest.
///
/// # Errors
/// The manifest is missing or cannot be read.
pub fn inspect(folder: &Path) -> Result<Inspection, OutputError> {
    let run = Manifest::read(folder)?;
    let listed = run.outputs();
    let mut found = Inspection {
        listed: listed.len(),
        ended: run.ended(),
        input_sha256: run.input_sha256().to_owned(),
        overrides: run.settings().overrides.clone(),
        ..Inspection::default()
    };
    if !run.is_intact(folder) {
        found.faults.push(format!("{MANIFEST} is not as it was written"));
    }
    for (name, written) in &listed {
        let path = folder.join(name);
        match (WrittenFile::read(&path), written) {
            (Ok(now), Some(then)) if now == **then => found.intact += 1,
            (Ok(now), Some(then)) if now.bytes != then.bytes => {
                found.faults.push(format!("{name} has {} bytes, {} were written", now.bytes, then.bytes));
            }
            (Ok(_), Some(_)) => found.faults.push(format!("{name} does not hold what was written")),
            // The run has not ended: what it writes has no hash yet.
            (Ok(_), None) if found.ended.is_none() => found.intact += 1,
            (Ok(_), None) => found.faults.push(format!("{name} is listed without a hash")),
            (Err(_), None) if found.ended.is_none() => found.listed -= 1,
            (Err(error), _) => found.faults.push(format!("{name} cannot be read: {error}")),
        }
    }
    for (step, name) in owned::snapshots(folder) {
        if name.starts_with(FIELDS_FOLDER) {
            found.snapshots.push(step);
        }
        if found.ended.is_some() && !listed.iter().any(|(other, _)| *other == name) {
            found.faults.push(format!("{name} is not listed in {MANIFEST}"));
        }
    }
    match StoredFields::of(folder).packed() {
        Ok(packed) => found.snapshots.extend(packed.iter().map(|(step, _)| *step)),
        Err(what) => found.faults.push(format!("{PACKED}: {what}")),
    }
    found.snapshots.sort_unstable();
    found.snapshots.dedup();
    Ok(found)
}
