//! Ownership of the files in a folder by a run, and replacement of one run by another.
//!
//! A run owns the files listed in its `manifest.json` and the snapshots in its folders `fields` and `contact`. It
//! starts only if no file of others has a name that it may use, and removes only its own files.

use std::fs;
use std::path::{Path, PathBuf};

use super::files::{
    LONGEST, copy_file, create_folder, move_file, of_temporary, remove_empty_folder, remove_file, remove_folder,
};
use super::inputs::Input;
use super::manifest::Manifest;
use super::names::{FILES, FOLDERS, HISTORY, MANIFEST, SNAPSHOTS, SUMMARY, step_of};
use super::{Outcome, OutputError, Summary};
use crate::machine;

/// Folder in which a run that replaces another keeps its results until its first step is made.
pub(super) const STAGING: &str = ".amontons-starting";

/// The names in a folder; empty if it does not exist.
fn names_in(path: &Path) -> Vec<String> {
    let entries = fs::read_dir(path).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort();
    names
}

/// The existing snapshots: steps, and paths in the results folder.
pub(super) fn snapshots(root: &Path) -> Vec<(usize, String)> {
    let of = |(folder, ending): (&str, &str)| {
        let names = names_in(&root.join(folder)).into_iter();
        let steps = names.filter_map(|name| Some((step_of(&name, ending)?, format!("{folder}/{name}"))));
        steps.collect::<Vec<_>>()
    };
    SNAPSHOTS.into_iter().flat_map(of).collect()
}

/// Refuses a folder in which files of others have names that the run may use.
pub(super) fn refuse_strangers(root: &Path, earlier: Option<&Manifest>, inputs: &[Input]) -> Result<(), OutputError> {
    let listed: Vec<&str> = earlier.map_or_else(Vec::new, |m| m.outputs().into_iter().map(|(name, _)| name).collect());
    let mut names: Vec<String> = FILES.iter().map(|name| (*name).to_owned()).collect();
    names.extend(inputs.iter().map(|input| input.path.clone()));
    if earlier.is_none() {
        names.extend(snapshots(root).into_iter().map(|(_, name)| name));
    }
    let is_strange = |name: &&String| {
        *name != MANIFEST && !listed.contains(&name.as_str()) && root.join(name).symlink_metadata().is_ok()
    };
    match names.iter().find(is_strange) {
        Some(name) => Err(OutputError::Stranger { path: root.join(name) }),
        None => Ok(()),
    }
}

/// The refusal of a folder that holds a run: `an interrupted run of "paper": 941 of its steps are made`, with advice.
pub(super) fn told(root: &Path, manifest: &Manifest) -> OutputError {
    let summary = machine::read_text(&root.join(SUMMARY), LONGEST).ok();
    let summary: Option<Summary> = summary.and_then(|text| serde_json::from_str(&text).ok());
    let rows = || {
        let rows = machine::read_text(&root.join(HISTORY), LONGEST).unwrap_or_default();
        rows.lines().count().saturating_sub(1)
    };
    let steps = manifest.ended().unwrap_or_else(rows);
    let outcome = summary.filter(|_| manifest.ended().is_some()).map(|summary| summary.outcome);
    let (what, goes_on) = match outcome {
        Some(Outcome::Done) => ("a finished run", false),
        Some(Outcome::Unsound) => ("a run whose results cannot be trusted", false),
        Some(Outcome::NotConverged) => ("a run that did not converge", false),
        Some(Outcome::Interrupted) => ("an interrupted run", true),
        None => ("a run that was broken off", true),
    };
    let found = format!("{what} of \"{}\": {steps} steps are made", manifest.case());
    let go_on = if goes_on { format!("go on with: amontons resume {}; or ", root.display()) } else { String::new() };
    let advice = format!("{go_on}replace it with --force, keep it with --again, or give another folder with --out");
    OutputError::HoldsResults { path: root.to_owned(), found, advice }
}

/// Removes the files of a run, and folders left empty; the manifest last, if at all.
pub(super) fn remove(root: &Path, run: &Manifest, with_manifest: bool) -> Result<(), OutputError> {
    let listed = run.outputs().into_iter().map(|(name, _)| name.to_owned());
    let all = listed.chain(snapshots(root).into_iter().map(|(_, name)| name));
    for name in all.filter(|name| name != MANIFEST) {
        remove_file(&root.join(name))?;
    }
    for folder in FOLDERS {
        remove_empty_folder(&root.join(folder));
    }
    if with_manifest { remove_file(&root.join(MANIFEST)) } else { Ok(()) }
}

/// Removes temporary files left by killed writers.
fn remove_temporary(root: &Path) -> Result<(), OutputError> {
    for name in names_in(root).iter().filter(|name| of_temporary(name).is_some_and(|file| FILES.contains(&file))) {
        remove_file(&root.join(name))?;
    }
    for folder in FOLDERS.iter().map(|folder| root.join(folder)) {
        for name in names_in(&folder).iter().filter(|name| of_temporary(name).is_some()) {
            remove_file(&folder.join(name))?;
        }
    }
    Ok(())
}

/// Moves the results of the run in the staging folder to the place of the earlier run.
///
/// The manifest is moved as soon as the files of the earlier run are gone: a staging folder without one tells
/// [`settle`] that a crash came in between.
pub(super) fn replace(root: &Path, earlier: &Manifest) -> Result<(), OutputError> {
    let staging = root.join(STAGING);
    // The new run still writes into its folders, including empty ones.
    let folders: Vec<&str> = FOLDERS.into_iter().filter(|folder| staging.join(folder).is_dir()).collect();
    remove(root, earlier, false)?;
    move_file(&staging.join(MANIFEST), &root.join(MANIFEST))?;
    settle(root)?;
    folders.into_iter().try_for_each(|folder| create_folder(&root.join(folder)))
}

/// Repairs a folder in which a run was killed while writing a file or replacing another run.
pub(super) fn settle(root: &Path) -> Result<(), OutputError> {
    let staging = root.join(STAGING);
    let is_moving = staging.is_dir() && staging.join(MANIFEST).symlink_metadata().is_err();
    if is_moving {
        let run = Manifest::find(root)?;
        let listed = run.iter().flat_map(|run| run.outputs().into_iter().map(|(name, _)| name.to_owned()));
        let all: Vec<String> = listed.chain(snapshots(&staging).into_iter().map(|(_, name)| name)).collect();
        for name in all.iter().filter(|name| staging.join(name).symlink_metadata().is_ok()) {
            let to = root.join(name);
            create_folder(to.parent().unwrap_or(root))?;
            move_file(&staging.join(name), &to)?;
        }
    }
    remove_temporary(root)?;
    remove_folder(&staging)
}

/// Copies the files of a run to another folder.
pub(super) fn copy(from: &Path, run: &Manifest, to: &Path) -> Result<(), OutputError> {
    let listed = run.outputs().into_iter().map(|(name, _)| name.to_owned());
    let all: std::collections::BTreeSet<String> =
        listed.chain(snapshots(from).into_iter().map(|(_, name)| name)).collect();
    for name in all.iter().filter(|name| from.join(name).symlink_metadata().is_ok()) {
        let target: PathBuf = to.join(name);
        create_folder(target.parent().unwrap_or(to))?;
        copy_file(&from.join(name), &target)?;
    }
    Ok(())
}
