//! The results folder of a convergence study.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::checkpoint::{read_states, write_states};
use super::claimed::{ClaimedFolder, STUDY};
use super::files::{LONGEST, create_folder, remove_folder, sha256, write_atomically, write_json};
use super::inputs::{Input, write_inputs};
use super::names::CASE;
use super::{OutputError, StudyTable};
use crate::convergence::{Reference, ReferenceProgress, Study, StudyLevel, values_csv};
use crate::machine;
use crate::state::State;

/// A results folder that holds a study: `convergence.csv`, `convergence-values.csv`, `convergence.json`, and `levels/`
/// with the states of finished levels, from which an interrupted study continues.
#[derive(Debug)]
pub struct StudyFolder(ClaimedFolder);

impl StudyFolder {
    /// A folder for a study, created if it does not exist.
    ///
    /// # Errors
    /// The folder holds other results, or a finished study and `force` is false; another process writes into it; or it
    /// cannot be created.
    pub fn create(path: impl Into<PathBuf>, force: bool) -> Result<StudyFolder, OutputError> {
        let folder = ClaimedFolder::create(path.into(), STUDY, force)?;
        create_folder(&folder.path().join("levels"))?;
        Ok(StudyFolder(folder))
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    fn file(&self, level: &StudyLevel) -> PathBuf {
        self.path().join("levels").join(format!("{}.bin", level.level))
    }

    /// The states of a level finished before with the same case, or `None` if they are missing or unreadable.
    #[must_use]
    pub fn load(&self, level: &StudyLevel) -> Option<Vec<State>> {
        // A level whose file is damaged or of another case is solved anew.
        read_states(&self.file(level), &key(level)).ok()
    }

    /// Keeps the states of a finished level.
    ///
    /// # Errors
    /// The states cannot be written.
    pub fn keep(&self, level: &StudyLevel, states: &[State]) -> Result<(), OutputError> {
        write_states(&self.file(level), &key(level), states)
    }

    /// The table of a study finished before with the same inputs, or `None` if it is missing or unreadable.
    #[must_use]
    pub fn finished(path: &Path, study: &Study) -> Option<StudyTable> {
        let read = |name: &str| machine::read_text(&path.join(name), LONGEST).ok();
        (read(INPUT)?.trim() == study_hash(study)).then_some(())?;
        serde_json::from_str(&read("convergence.json")?).ok()
    }

    /// Progress of the reference of an interrupted study with these inputs.
    #[must_use]
    pub fn load_reference(&self, study: &Study) -> Option<ReferenceProgress> {
        let key = study_hash(study);
        let state = read_states(&self.levels(REFERENCE), &key).ok()?.pop()?;
        let (step, worst): (usize, _) =
            serde_json::from_str(&machine::read_text(&self.levels(REFERENCE_ERRORS), LONGEST).ok()?).ok()?;
        // The two files are written one after the other, so their steps may differ.
        (state.step == step).then_some(ReferenceProgress { state, worst })
    }

    /// Keeps the progress of the reference.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn keep_reference(&self, study: &Study, progress: &ReferenceProgress) -> Result<(), OutputError> {
        write_states(&self.levels(REFERENCE), &study_hash(study), std::slice::from_ref(&progress.state))?;
        write_json(&self.levels(REFERENCE_ERRORS), &(progress.state.step, &progress.worst)).map(|_| ())
    }

    /// Removes the states of the levels and of the reference, which a finished study does not need.
    ///
    /// # Errors
    /// They cannot be removed.
    pub fn clean(&self) -> Result<(), OutputError> {
        remove_folder(&self.path().join("levels"))
    }

    fn levels(&self, name: &str) -> PathBuf {
        self.path().join("levels").join(name)
    }

    /// Writes the hash of the inputs of a finished study, by which it is recognized. Call this last.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn seal(&self, study: &Study) -> Result<(), OutputError> {
        write_atomically(&self.path().join(INPUT), |out| writeln!(out, "{}", study_hash(study))).map(|_| ())
    }

    /// Writes the table, the text of the case and the files that it refers to.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(&self, table: &StudyTable, case: &str, inputs: &[Input]) -> Result<(), OutputError> {
        write_atomically(&self.path().join(CASE), |out| out.write_all(case.as_bytes()))?;
        write_inputs(self.path(), inputs)?;
        write_json(&self.path().join("convergence.json"), table)?;
        let values = values_csv(&table.values);
        write_atomically(&self.path().join(VALUES), |out| out.write_all(values.as_bytes()))?;
        write_atomically(&self.path().join("convergence.csv"), |out| out.write_all(table.csv().as_bytes())).map(|_| ())
    }
}

/// The numbers at the end on each level.
const VALUES: &str = "convergence-values.csv";
/// Files of a study: the hash of its inputs, and the progress of its reference.
const INPUT: &str = "study.sha256";
const REFERENCE: &str = "reference.bin";
const REFERENCE_ERRORS: &str = "reference.json";

/// SHA-256 of the inputs of a study: its levels and its reference.
fn study_hash(study: &Study) -> String {
    let reference = match &study.reference {
        Reference::Level(level) => key(level),
        // The closed form is part of the case.
        Reference::Exact(_) => "exact".to_owned(),
    };
    sha256(study.levels.iter().map(key).chain([reference]).map(|text| sha256(&text)).collect::<String>())
}

/// The data that the states of a level depend on.
fn key(level: &StudyLevel) -> String {
    format!("{}\n{}", env!("CARGO_PKG_VERSION"), level.text)
}
