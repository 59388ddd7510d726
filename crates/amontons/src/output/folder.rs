//! The results folder.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::columns::{contact_measures, history_columns, history_measures, history_values};
use super::csv::{Rows, write_contact};
use super::earlier::{CERTIFICATE, write_certificate};
use super::files::{copy, create_folder, remove, write_atomically, write_json};
use super::inputs::{INPUTS, Input, fingerprint, write_inputs};
use super::manifest::{Manifest, Settings};
use super::vtu::{write_collection, write_fields};
use super::{
    OutputError, OutputField, Probe, ProbeSet, RunStart, Sink, Snapshot, StressRecovery, Summary, checkpoint, manifest,
};
use crate::problem::Problem;
use crate::units::Measure;

const HISTORY: &str = "history.csv";
const PROBES: &str = "probes.csv";
/// Folder of the contact points at the times of the field snapshots.
const CONTACT: &str = "contact";
/// What a results folder may hold, studies included.
const RESULTS: [&str; 15] = [
    "summary.json",
    manifest::FILE,
    CERTIFICATE,
    HISTORY,
    PROBES,
    "contact.csv",
    "contact",
    "fields.pvd",
    "fields",
    "checkpoint",
    "case.toml",
    INPUTS,
    "convergence.csv",
    "convergence.json",
    "convergence.svg",
];
/// Where a run that replaces another keeps its results until its first step is made.
const STAGING: &str = ".starting";

/// How results are written.
#[derive(Clone, Debug)]
pub struct FolderOptions {
    /// The text of the case as run.
    pub text: String,
    /// The files that the text refers to.
    pub inputs: Vec<Input>,
    /// Steps between field snapshots; 0: only the last.
    pub every: usize,
    /// Fields of the snapshots beside those that every one has.
    pub fields: Vec<OutputField>,
    /// What is read off the run after every step.
    pub probes: Vec<Probe>,
    /// Whether results that are there may be replaced.
    pub force: bool,
    /// Time between checkpoints.
    pub checkpoint_interval: Duration,
}

impl FolderOptions {
    /// Options for a case with this text: only the last fields, nothing replaced, one checkpoint per minute.
    #[must_use]
    pub fn new(text: impl Into<String>) -> FolderOptions {
        FolderOptions {
            text: text.into(),
            inputs: Vec::new(),
            every: 0,
            fields: OutputField::DEFAULT.to_vec(),
            probes: Vec::new(),
            force: false,
            checkpoint_interval: Duration::from_mins(1),
        }
    }

    fn fingerprint(&self) -> String {
        fingerprint(&self.text, &self.inputs)
    }
}

/// Writes the results folder of a run.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    options: FolderOptions,
    /// Whether results of another run are there, to be replaced once this one has made a step.
    replaces: bool,
    history: Option<Rows>,
    probes: Option<(ProbeSet, Rows)>,
    manifest: Option<Manifest>,
    /// The recovery of stresses on the mesh of the run, from its first snapshot on.
    recovery: Option<StressRecovery>,
    /// Time and file of the field snapshots.
    snapshots: Vec<(f64, String)>,
    last_checkpoint: Instant,
}

impl Folder {
    /// A folder for a new run; it is created if it is not there.
    ///
    /// # Errors
    /// When it holds results and `force` is not given, or when it cannot be created.
    pub fn create(path: impl Into<PathBuf>, options: FolderOptions) -> Result<Folder, OutputError> {
        let path = path.into();
        let found = RESULTS.iter().find(|name| path.join(name).symlink_metadata().is_ok());
        if let Some(found) = found.filter(|_| !options.force) {
            return Err(OutputError::HoldsResults { path, found: (*found).to_owned() });
        }
        remove(&path.join(STAGING))?;
        let folder = Folder::new(path, options, found.is_some());
        create_folder(&folder.root())?;
        Ok(folder)
    }

    /// The folder of a run that goes on.
    ///
    /// # Errors
    /// When there is no such folder.
    pub fn reopen(path: impl Into<PathBuf>, options: FolderOptions) -> Result<Folder, OutputError> {
        let path = path.into();
        fs::read_dir(&path).map_err(OutputError::io("read", &path))?;
        Ok(Folder::new(path, options, false))
    }

    /// The folder of a run that goes on in a new place: the results of `from` are copied, and stay.
    ///
    /// # Errors
    /// When the new folder holds results and `force` is not given, or when files cannot be copied.
    pub fn copy(from: &Path, to: impl Into<PathBuf>, options: FolderOptions) -> Result<Folder, OutputError> {
        let mut folder = Folder::create(to, options)?;
        let staging = folder.root();
        for name in RESULTS {
            copy(&from.join(name), &staging.join(name))?;
        }
        if folder.replaces {
            folder.replace()?;
        }
        Ok(folder)
    }

    /// Whether results of an earlier run are still there: the new run has not made a step.
    #[must_use]
    pub fn keeps_older_results(&self) -> bool {
        self.replaces
    }

    fn new(path: PathBuf, options: FolderOptions, replaces: bool) -> Folder {
        let last_checkpoint = Instant::now();
        Folder {
            path,
            options,
            replaces,
            history: None,
            probes: None,
            manifest: None,
            recovery: None,
            snapshots: Vec::new(),
            last_checkpoint,
        }
    }

    /// Where results go at present.
    fn root(&self) -> PathBuf {
        if self.replaces { self.path.join(STAGING) } else { self.path.clone() }
    }

    /// Replaces the results of the run before by those of this one.
    fn replace(&mut self) -> Result<(), OutputError> {
        for name in RESULTS {
            remove(&self.path.join(name))?;
        }
        let staging = self.root();
        for name in RESULTS {
            let (from, to) = (staging.join(name), self.path.join(name));
            match fs::rename(&from, &to) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    return Err(OutputError::io("move", &from)(error));
                }
                _ => {}
            }
        }
        remove(&staging)?;
        self.replaces = false;
        if let Some(history) = &mut self.history {
            history.moved(self.path.join(HISTORY));
        }
        if let Some((_, rows)) = &mut self.probes {
            rows.moved(self.path.join(PROBES));
        }
        Ok(())
    }

    fn is_due(&self, step: usize) -> bool {
        self.options.every > 0 && step.is_multiple_of(self.options.every)
    }

    fn write_fields(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        let root = self.root();
        let file = fields_file(now.state.step);
        if self.recovery.is_none() && now.problem.physics.has_mechanics() {
            self.recovery = Some(StressRecovery::new(&now.problem.mesh));
        }
        write_fields(&root.join(&file), now, &self.options.fields, self.recovery.as_ref())?;
        if !now.problem.contacts.is_empty() && now.report.is_some() {
            create_folder(&root.join(CONTACT))?;
            write_contact(&root.join(contact_file(now.state.step)), now)?;
        }
        self.snapshots.push((now.state.t, file));
        write_collection(&root.join("fields.pvd"), &self.snapshots)
    }

    fn write_checkpoint(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        // The rows come first: a checkpoint must not be ahead of the history.
        for rows in self.history.iter().chain(self.probes.iter().map(|(_, rows)| rows)) {
            rows.sync()?;
        }
        checkpoint::write(&self.root(), &self.options.fingerprint(), now)?;
        self.last_checkpoint = Instant::now();
        Ok(())
    }

    /// The probes of the run, if it has any, with their table.
    fn probe_rows(
        &self,
        problem: &Problem,
        open: impl FnOnce(&[String]) -> Result<Rows, OutputError>,
    ) -> Result<Option<(ProbeSet, Rows)>, OutputError> {
        let probes = &self.options.probes;
        if probes.is_empty() {
            return Ok(None);
        }
        let named = |(i, source): (usize, _)| OutputError::Probe {
            name: probes.get(i).map(|probe| probe.name.clone()).unwrap_or_default(),
            source,
        };
        let set = ProbeSet::new(problem, probes).map_err(named)?;
        let mut columns = vec!["step".to_owned(), "t".to_owned()];
        columns.extend_from_slice(set.columns());
        Ok(Some((set, open(&columns)?)))
    }

    fn start_anew(&mut self, start: &RunStart) -> Result<(), OutputError> {
        let (root, problem) = (self.root(), start.from.problem);
        for folder in ["fields", "checkpoint"] {
            create_folder(&root.join(folder))?;
        }
        write_atomically(&root.join("case.toml"), |out| out.write_all(self.options.text.as_bytes()))?;
        write_inputs(&root, &self.options.inputs)?;
        self.history = Some(Rows::create(root.join(HISTORY), &history_columns(problem))?);
        self.probes = self.probe_rows(problem, |columns| Rows::create(root.join(PROBES), columns))?;
        let settings =
            Settings { every: self.options.every, checkpoint_seconds: self.options.checkpoint_interval.as_secs_f64() };
        let mut manifest = Manifest::new(&problem.name, &self.options.fingerprint(), settings);
        manifest.units(problem.units(), &self.tables(problem));
        self.manifest = Some(manifest);
        if self.is_due(0) {
            self.write_fields(&start.from)?;
        }
        Ok(())
    }

    /// The tables of the run, and what their columns measure where it is known.
    fn tables(&self, problem: &Problem) -> [(&'static str, Vec<(String, Measure)>); 3] {
        let of_points = contact_measures(problem.mesh.dim)
            .into_iter()
            .filter_map(|(name, measure)| Some((name, measure?)))
            .collect();
        let probes = self.options.probes.iter().filter_map(|probe| Some((probe, probe.measure()?)));
        let columns = |(probe, measure): (&Probe, Measure)| {
            let endings = probe.quantity.columns(problem.mesh.dim);
            endings.into_iter().map(move |ending| (format!("{}{ending}", probe.name), measure)).collect::<Vec<_>>()
        };
        let of_probes = std::iter::once(("t".to_owned(), Measure::Time)).chain(probes.flat_map(columns)).collect();
        [(HISTORY, history_measures(problem)), ("contact.csv", of_points), (PROBES, of_probes)]
    }

    /// Brings the files back to the step of the checkpoint.
    fn go_on(&mut self, start: &RunStart) -> Result<(), OutputError> {
        let (problem, step) = (start.from.problem, start.from.state.step);
        self.history = Some(Rows::reopen(self.path.join(HISTORY), &history_columns(problem), step)?);
        self.probes = self.probe_rows(problem, |columns| Rows::reopen(self.path.join(PROBES), columns, step))?;
        self.manifest = Some(Manifest::read(&self.path)?);
        let due = (0..=step).filter(|&n| self.is_due(n)).map(|n| (problem.time(n), fields_file(n)));
        self.snapshots = due.filter(|(_, file)| self.path.join(file).is_file()).collect();
        for folder in ["fields", CONTACT] {
            self.remove_later(folder)?;
        }
        write_collection(&self.path.join("fields.pvd"), &self.snapshots)
    }

    /// Removes the snapshots in a folder that are not of the run so far.
    fn remove_later(&self, folder: &str) -> Result<(), OutputError> {
        let path = self.path.join(folder);
        create_folder(&path)?;
        let stem = |name: &str| Path::new(name).file_stem().map(std::ffi::OsStr::to_os_string);
        for entry in fs::read_dir(&path).map_err(OutputError::io("read", &path))? {
            let entry = entry.map_err(OutputError::io("read", &path))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let ours = name.starts_with("step_") || name.starts_with(".step_");
            if ours && !self.snapshots.iter().any(|(_, file)| stem(file) == stem(&name)) {
                remove(&entry.path())?;
            }
        }
        Ok(())
    }
}

/// The file of the contact points beside the fields at a step, seen from the results folder.
fn contact_file(step: usize) -> String {
    format!("{CONTACT}/step_{step:07}.csv")
}

/// The file of the fields at a step, seen from the results folder.
fn fields_file(step: usize) -> String {
    format!("fields/step_{step:07}.vtu")
}

impl Sink for Folder {
    fn start(&mut self, start: &RunStart) -> Result<(), OutputError> {
        self.recovery = None;
        if start.resumed {
            self.go_on(start)?;
        } else {
            self.start_anew(start)?;
        }
        let root = self.root();
        match start.certificate {
            Some(findings) => write_certificate(&root, &self.options.fingerprint(), findings)?,
            None => remove(&root.join(CERTIFICATE))?,
        }
        if let Some(manifest) = &mut self.manifest {
            manifest.begin(start.threads, start.from.state.step);
            manifest.write(&root)?;
        }
        self.last_checkpoint = Instant::now();
        Ok(())
    }

    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        if self.replaces {
            self.replace()?;
        }
        if let Some((history, values)) = self.history.as_mut().zip(history_values(now)) {
            history.push(&values)?;
        }
        if let Some((set, rows)) = &mut self.probes {
            let mut values = vec![now.state.step as f64, now.state.t];
            values.extend(set.values(now));
            rows.push(&values)?;
        }
        if self.is_due(now.state.step) {
            self.write_fields(now)?;
        }
        if self.last_checkpoint.elapsed() >= self.options.checkpoint_interval {
            self.write_checkpoint(now)?;
        }
        Ok(())
    }

    fn last(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        if self.replaces {
            return Ok(());
        }
        let file = fields_file(last.state.step);
        if self.snapshots.last().is_none_or(|(_, newest)| *newest != file) {
            self.write_fields(last)?;
        }
        write_contact(&self.path.join("contact.csv"), last)?;
        self.write_checkpoint(last)
    }

    fn finish(&mut self, summary: &Summary) -> Result<(), OutputError> {
        if self.replaces {
            // The run has not made a step: what was there before stays.
            return remove(&self.root());
        }
        write_json(&self.path.join("summary.json"), summary)?;
        if let Some(manifest) = &mut self.manifest {
            manifest.end(summary.steps);
            manifest.write(&self.path)?;
        }
        Ok(())
    }
}
