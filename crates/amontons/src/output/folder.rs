//! The results folder.

mod snapshots;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::columns::{contact_measures, history_columns, history_measures, history_row};
use super::csv::StepTable;
use super::discretization_error::{self, ErrorTable};
use super::earlier::write_certificate;
use super::files::{LONGEST, WrittenFile, create_folder, remove_file, remove_folder, write_atomically, write_json};
use super::inputs::{Input, fingerprint, write_inputs};
use super::manifest::{Manifest, ManifestSettings};
use super::names::{
    CASE, CERTIFICATE, CHECKPOINT_FOLDER, CONTACT, ERROR, FIELDS, FIELDS_FOLDER, FILES, HISTORY, INPUTS, MANIFEST,
    PACKED, PROBES, SIDES, SUMMARY,
};
use super::owned::{self, STAGING};
use super::room::demand;
use super::{
    FieldsFormat, FolderLock, Identity, OutputError, OutputField, Probe, ProbeSet, RunStart, Sink, Snapshot,
    StressRecovery, Summary, checkpoint, surface, vtu,
};
use crate::machine::{self, Instant};
use crate::problem::Problem;
use crate::units::Measure;
use snapshots::{is_due, write_contact};

/// Largest number of nodes for which the fields of a step are written within a second. An interrupted run of a larger
/// body leaves a checkpoint without them.
const SOON: usize = 100_000;
/// Default checkpoint interval: its longest time, and the fraction 1/SHARE of the run time spent on checkpoints.
const LONGEST_INTERVAL: Duration = Duration::from_mins(1);
const SHARE: u32 = 100;

/// Options of a results folder.
#[derive(Clone, Debug)]
pub struct FolderOptions {
    /// The text of the case as run.
    pub text: String,
    /// The files that the text refers to.
    pub inputs: Vec<Input>,
    /// The data that the states of the run depend on.
    pub identity: Identity,
    /// Steps between field snapshots; 0 for the last only.
    pub every: usize,
    /// Fields of the snapshots in addition to the standard ones.
    pub fields: Vec<OutputField>,
    /// Format of the fields of a finished run.
    pub format: FieldsFormat,
    /// Values recorded after every step.
    pub probes: Vec<Probe>,
    /// True if existing results may be replaced.
    pub force: bool,
    /// The interval between checkpoints.
    pub checkpoint: CheckpointInterval,
    /// True if the run evaluates all hypotheses.
    pub certificate: bool,
    /// True if the discretization error is bounded at each snapshot.
    pub error: bool,
    /// The overrides already applied in the text.
    pub overrides: Vec<String>,
    /// Tables of what was found before the run, with the names of their files: [`ACCURACY`](super::ACCURACY) and
    /// [`BARS`](super::BARS).
    pub tables: Vec<(&'static str, String)>,
}

/// The interval between checkpoints, in addition to those at the start, after the first step and at the end. A
/// checkpoint is written as soon as one of the two has passed.
///
/// By default at least every minute, and more often as long as it takes at most one per cent of the time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CheckpointInterval {
    /// Steps since the last one.
    pub steps: Option<usize>,
    /// Time since the last one.
    pub time: Option<Duration>,
}

impl FolderOptions {
    /// Options for a case with this text: only the last fields, no replacement, default checkpoints. For a case read
    /// from a file use `Case::folder_options`.
    #[must_use]
    pub fn new(text: impl Into<String>) -> FolderOptions {
        let text = text.into();
        FolderOptions {
            identity: Identity::of_text(&text, &[]),
            text,
            inputs: Vec::new(),
            every: 0,
            fields: OutputField::DEFAULT.to_vec(),
            format: FieldsFormat::default(),
            probes: Vec::new(),
            force: false,
            checkpoint: CheckpointInterval::default(),
            certificate: true,
            error: false,
            overrides: Vec::new(),
            tables: Vec::new(),
        }
    }

    fn fingerprint(&self) -> String {
        fingerprint(&self.text, &self.inputs)
    }

    fn settings(&self) -> ManifestSettings {
        let CheckpointInterval { steps, time } = self.checkpoint;
        let longest = time.or(steps.is_none().then_some(LONGEST_INTERVAL));
        ManifestSettings {
            every: self.every,
            checkpoint_seconds: longest.map(|time| time.as_secs_f64()),
            checkpoint_steps: steps,
            certificate: self.certificate,
            overrides: self.overrides.clone(),
        }
    }
}

/// Writes the results folder of a run. It holds a lock against other writers.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    options: FolderOptions,
    /// The earlier run in the folder, to be replaced once this one has made a step.
    replaces: Option<Manifest>,
    manifest: Manifest,
    history: Option<StepTable>,
    probes: Option<(ProbeSet, StepTable)>,
    /// The recovery of stresses on the mesh of the run, from its first snapshot on.
    recovery: Option<StressRecovery>,
    /// Step and time of the field snapshots; time and file of the sides of contact.
    snapshots: Vec<(usize, f64)>,
    /// Bounds of the discretization error.
    errors: ErrorTable,
    surfaces: Vec<(f64, String)>,
    /// Last step of each phase.
    phase_ends: Vec<usize>,
    last_checkpoint: LastCheckpoint,
    /// Notes for the user about the contents found in the folder.
    notes: Vec<String>,
    _lock: FolderLock,
}

/// The newest checkpoint of the session.
#[derive(Debug)]
struct LastCheckpoint {
    /// Its step, or `None` before the first.
    step: Option<usize>,
    at: Instant,
    /// Time it took to write.
    took: Duration,
    /// The first step of the session.
    first: usize,
}

impl Folder {
    /// A folder for a new run, created if it does not exist.
    ///
    /// # Errors
    /// The folder holds results and `force` is false, or files of others under names of results; another process writes
    /// into it; or it cannot be created.
    pub fn create(path: impl Into<PathBuf>, options: FolderOptions) -> Result<Folder, OutputError> {
        let folder = Folder::prepare(path.into(), options)?;
        folder.write_inputs()?;
        Ok(folder)
    }

    /// Checks that a new run may write into a folder, without a trace: before work whose results it is to hold.
    ///
    /// # Errors
    /// The folder holds results and `force` is false, or files of others under names of results.
    pub fn check(path: &Path, force: bool) -> Result<(), OutputError> {
        if !path.exists() {
            return Ok(());
        }
        match Manifest::find(path)? {
            Some(run) if run.is_started() && !force => Err(owned::told(path, &run)),
            earlier => owned::refuse_strangers(path, earlier.as_ref(), &[]),
        }
    }

    fn prepare(path: PathBuf, options: FolderOptions) -> Result<Folder, OutputError> {
        create_folder(&path)?;
        let lock = FolderLock::take(&path)?;
        owned::settle(&path)?;
        let mut earlier = Manifest::find(&path)?;
        if let Some(run) = &earlier
            && run.is_started()
            && !options.force
        {
            return Err(owned::told(&path, run));
        }
        owned::refuse_strangers(&path, earlier.as_ref(), &options.inputs)?;
        if let Some(run) = earlier.take_if(|run| !run.is_started()) {
            // The staging folder has no results yet.
            owned::remove(&path, &run, true)?;
        }
        let manifest = Manifest::new(&options.fingerprint(), options.settings());
        let folder = Folder::new(path, options, manifest, earlier, lock);
        create_folder(&folder.root())?;
        Ok(folder)
    }

    /// The folder of a run that continues.
    ///
    /// # Errors
    /// The folder holds no run, or another process writes into it.
    pub fn reopen(path: impl Into<PathBuf>, options: FolderOptions) -> Result<Folder, OutputError> {
        let path = path.into();
        std::fs::read_dir(&path).map_err(OutputError::io("read", &path))?;
        let lock = FolderLock::take(&path)?;
        owned::settle(&path)?;
        let manifest = Manifest::read(&path)?;
        Ok(Folder::new(path, options, manifest, None, lock))
    }

    /// The folder of a run that continues in a new place: the results of `from` are copied and stay. Take the
    /// [`FolderLock`] of `from` before.
    ///
    /// # Errors
    /// The new folder holds results and `force` is false, or files cannot be copied.
    pub fn copy(from: &Path, to: impl Into<PathBuf>, options: FolderOptions) -> Result<Folder, OutputError> {
        let run = Manifest::read(from)?;
        let mut folder = Folder::prepare(to.into(), options)?;
        owned::copy(from, &run, &folder.root())?;
        run.write(&folder.root())?;
        folder.manifest = run;
        folder.replace()?;
        Ok(folder)
    }

    /// True if results of an earlier run are still there because the new run has not made a step.
    #[must_use]
    pub fn keeps_older_results(&self) -> bool {
        self.replaces.is_some()
    }

    /// Notes for the user about the contents found in the folder.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    fn new(
        path: PathBuf,
        options: FolderOptions,
        manifest: Manifest,
        replaces: Option<Manifest>,
        lock: FolderLock,
    ) -> Folder {
        Folder {
            path,
            options,
            replaces,
            manifest,
            history: None,
            probes: None,
            recovery: None,
            snapshots: Vec::new(),
            errors: ErrorTable::default(),
            surfaces: Vec::new(),
            phase_ends: Vec::new(),
            last_checkpoint: LastCheckpoint { step: None, at: Instant::now(), took: Duration::ZERO, first: 0 },
            notes: Vec::new(),
            _lock: lock,
        }
    }

    /// A summary of the run with the bound of the discretization error of its last step, if the folder has one.
    #[must_use]
    pub fn completed(&self, summary: &Summary) -> Summary {
        let last = self.errors.last.as_ref().filter(|(step, _)| *step == summary.steps);
        let discretization_error = last.map(|(_, error)| error.clone());
        Summary { discretization_error, ..summary.clone() }
    }

    /// The folder into which results are written at present.
    fn root(&self) -> PathBuf {
        if self.replaces.is_some() { self.path.join(STAGING) } else { self.path.clone() }
    }

    /// Writes the manifest and the case: from here on the folder belongs to this run.
    fn write_inputs(&self) -> Result<(), OutputError> {
        let (root, mut manifest) = (self.root(), self.manifest.clone());
        self.list_names(&mut manifest);
        manifest.write(&root)?;
        write_atomically(&root.join(CASE), |out| out.write_all(self.options.text.as_bytes()))?;
        for (name, text) in &self.options.tables {
            write_atomically(&root.join(name), |out| out.write_all(text.as_bytes()))?;
        }
        write_inputs(&root, &self.options.inputs)
    }

    /// Lists the files that the run may write.
    fn list_names(&self, manifest: &mut Manifest) {
        FILES.into_iter().filter(|name| *name != MANIFEST).for_each(|name| manifest.name(name));
        self.options.inputs.iter().for_each(|input| manifest.list(&input.path, Some(WrittenFile::of(&input.bytes))));
        let tables = self.options.tables.iter().map(|(name, text)| (*name, text));
        for (name, text) in tables.chain([(CASE, &self.options.text)]) {
            manifest.list(name, Some(WrittenFile::of(text.as_bytes())));
        }
    }

    /// Replaces the results of the earlier run by those of this one.
    fn replace(&mut self) -> Result<(), OutputError> {
        let Some(earlier) = self.replaces.take() else { return Ok(()) };
        owned::replace(&self.path, &earlier)?;
        if let Some(history) = &mut self.history {
            history.moved(self.path.join(HISTORY));
        }
        if let Some((_, rows)) = &mut self.probes {
            rows.moved(self.path.join(PROBES));
        }
        Ok(())
    }

    fn is_due(&self, step: usize) -> bool {
        is_due(self.options.every, &self.phase_ends, step)
    }

    fn write_checkpoint(&mut self, now: &Snapshot, keeps: bool) -> Result<(), OutputError> {
        let begin = Instant::now();
        // The rows come first: a checkpoint must not be ahead of the history.
        for rows in self.history.iter().chain(self.probes.iter().map(|(_, rows)| rows)) {
            rows.sync()?;
        }
        checkpoint::write(&self.root(), &self.options.identity, now, keeps)?;
        let last = &mut self.last_checkpoint;
        (last.step, last.at, last.took) = (Some(now.state.step), Instant::now(), begin.elapsed());
        Ok(())
    }

    /// Writes the contact points and the checkpoint of the last step.
    fn write_end(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        let written = write_contact(&self.path.join(CONTACT), last)?;
        self.manifest.list(CONTACT, Some(written));
        if self.last_checkpoint.step == Some(last.state.step) { Ok(()) } else { self.write_checkpoint(last, true) }
    }

    fn checkpoint_is_due(&self, step: usize) -> bool {
        let LastCheckpoint { step: last, at, took, first } = self.last_checkpoint;
        let CheckpointInterval { steps, time } = self.options.checkpoint;
        let interval = match (steps, time) {
            (_, Some(time)) => time,
            (Some(_), None) => Duration::MAX,
            (None, None) => LONGEST_INTERVAL.min(took.saturating_mul(SHARE)),
        };
        step == first + 1
            || steps.is_some_and(|steps| step >= last.unwrap_or(first) + steps.max(1))
            || at.elapsed() >= interval
    }

    /// The probes of the run, if it has any, with their table.
    fn probe_rows(
        &self,
        problem: &Problem,
        open: impl FnOnce(&[String]) -> Result<StepTable, OutputError>,
    ) -> Result<Option<(ProbeSet, StepTable)>, OutputError> {
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

    /// Refuses to start if the results of the remaining steps do not fit on the disk.
    fn check_room(&self, start: &RunStart) -> Result<(), OutputError> {
        let (problem, first) = (start.from.problem, start.from.state.step);
        let due = (first..problem.timeline.steps()).filter(|&n| self.is_due(n)).count() + 1;
        let is_packed = start.resumed && self.path.join(PACKED).exists();
        let unpacked = if is_packed { (0..first).filter(|&n| self.is_due(n)).count() } else { 0 };
        let left = problem.timeline.steps() - first.min(problem.timeline.steps());
        let needed = demand(&start.from, &self.options.fields, self.options.format, due + unpacked, left);
        match machine::disk_free(&self.path) {
            Some(free) if needed > free as f64 => {
                Err(OutputError::NoRoom { path: self.path.clone(), needed, free: free as f64 })
            }
            _ => Ok(()),
        }
    }

    fn start_anew(&mut self, start: &RunStart) -> Result<(), OutputError> {
        let (root, problem) = (self.root(), start.from.problem);
        for folder in [FIELDS_FOLDER, CHECKPOINT_FOLDER] {
            create_folder(&root.join(folder))?;
        }
        self.manifest = Manifest::new(&self.options.fingerprint(), self.options.settings());
        let mut manifest = self.manifest.clone();
        self.list_names(&mut manifest);
        manifest.units(&problem.name, problem.units(), &self.tables(problem));
        let sides = surface::sides(&problem.contacts).map(|side| side.name);
        manifest.parts(&problem.mesh.regions, sides.collect());
        self.manifest = manifest;
        self.history = Some(StepTable::create(root.join(HISTORY), &history_columns(problem))?);
        self.probes = self.probe_rows(problem, |columns| StepTable::create(root.join(PROBES), columns))?;
        if self.is_due(0) {
            self.write_fields(&start.from)?;
        }
        Ok(())
    }

    /// The tables and ParaView files of the run, with the quantities measured by their columns and arrays if known.
    fn tables(&self, problem: &Problem) -> Vec<(&'static str, Vec<(String, Measure)>)> {
        let of_points =
            contact_measures(problem).into_iter().filter_map(|(name, measure)| Some((name, measure?))).collect();
        let probes = self.options.probes.iter().filter_map(|probe| Some((probe, probe.measure()?)));
        let columns = |(probe, measure): (&Probe, Measure)| {
            let endings = probe.quantity.columns(problem.mesh.dim);
            endings.into_iter().map(move |ending| (format!("{}{ending}", probe.name), measure)).collect::<Vec<_>>()
        };
        let of_probes = std::iter::once(("t".to_owned(), Measure::Time)).chain(probes.flat_map(columns)).collect();
        let mut tables = vec![
            (HISTORY, history_measures(problem)),
            (CONTACT, of_points),
            (PROBES, of_probes),
            (ERROR, discretization_error::measures()),
            (FIELDS, vtu::measures()),
            (SIDES, surface::measures()),
        ];
        if self.options.format != FieldsFormat::Vtu {
            tables.push((PACKED, vtu::measures()));
        }
        tables
    }

    /// Takes over the tables of a finished run. They must still have the noted hashes, so that rows changed since are
    /// not accepted under a new hash. The old hashes are then forgotten because the tables grow.
    fn take_over_tables(&mut self) -> Result<(), OutputError> {
        let noted: Vec<(&str, WrittenFile)> = self
            .manifest
            .outputs()
            .into_iter()
            .filter_map(|(name, noted)| {
                let name = [HISTORY, PROBES].into_iter().find(|table| *table == name)?;
                Some((name, noted?.clone()))
            })
            .collect();
        for (name, noted) in &noted {
            let path = self.path.join(name);
            let found = machine::read(&path, LONGEST).map_err(OutputError::io("read", &path))?;
            let whole = usize::try_from(noted.bytes).ok().and_then(|bytes| found.get(..bytes));
            if whole.map(WrittenFile::of).as_ref() != Some(noted) {
                let (found, expected) = ("another hash than that in manifest.json", "the file that the run wrote");
                return Err(OutputError::Inconsistent { path, found: found.to_owned(), expected: expected.to_owned() });
            }
        }
        if noted.is_empty() {
            return Ok(());
        }
        for (name, _) in &noted {
            self.manifest.list(name, None);
        }
        self.manifest.write(&self.path)
    }

    /// Brings the files back to the step of the checkpoint.
    fn go_on(&mut self, start: &RunStart) -> Result<(), OutputError> {
        let (problem, step) = (start.from.problem, start.from.state.step);
        self.take_over_tables()?;
        self.history = Some(StepTable::reopen(self.path.join(HISTORY), &history_columns(problem), step)?);
        self.probes = self.probe_rows(problem, |columns| StepTable::reopen(self.path.join(PROBES), columns, step))?;
        self.keep_snapshots(problem, step)?;
        self.errors = ErrorTable::reopen(&self.path.join(ERROR), step)?;
        let mut manifest = self.manifest.clone();
        manifest.change(&self.options.fingerprint(), self.options.settings());
        let copies = |name: &str| !Path::new(name).starts_with(INPUTS);
        manifest.retain(copies);
        self.list_names(&mut manifest);
        self.manifest = manifest;
        self.write_inputs_again()?;
        if !checkpoint::is_whole(&self.path) {
            self.write_checkpoint(&start.from, false)?;
        }
        Ok(())
    }

    /// Writes the case and its files again if they differ from those of the continued run.
    fn write_inputs_again(&self) -> Result<(), OutputError> {
        let path = self.path.join(CASE);
        if WrittenFile::read(&path).ok() != Some(WrittenFile::of(self.options.text.as_bytes())) {
            write_atomically(&path, |out| out.write_all(self.options.text.as_bytes()))?;
        }
        write_inputs(&self.path, &self.options.inputs)
    }
}

impl Sink for Folder {
    fn start(&mut self, start: &RunStart) -> Result<(), OutputError> {
        self.recovery = None;
        self.phase_ends = start.from.problem.timeline.ends_at(&start.from.state.pace);
        self.check_room(start)?;
        if start.resumed {
            self.go_on(start)?;
        } else {
            self.start_anew(start)?;
        }
        let root = self.root();
        match start.certificate {
            Some(findings) => {
                let written = write_certificate(&root, &self.options.fingerprint(), findings)?;
                self.manifest.list(CERTIFICATE, Some(written));
            }
            None => remove_file(&root.join(CERTIFICATE))?,
        }
        let step = start.from.state.step;
        self.manifest.begin(start.threads, step);
        self.manifest.write(&root)?;
        if start.resumed {
            // The snapshots are now listed as separate files.
            remove_file(&root.join(PACKED))?;
        } else {
            self.write_checkpoint(&start.from, false)?;
        }
        (self.last_checkpoint.step, self.last_checkpoint.first) = (Some(step), step);
        self.last_checkpoint.at = Instant::now();
        Ok(())
    }

    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        self.replace()?;
        self.phase_ends = now.problem.timeline.ends_at(&now.state.pace);
        if let Some((history, row)) = self.history.as_mut().zip(history_row(now)) {
            history.push_row(&row)?;
        }
        if let Some((set, rows)) = &mut self.probes {
            let mut values = vec![now.state.step as f64, now.state.t];
            values.extend(set.values(now));
            rows.push(&values)?;
        }
        if self.is_due(now.state.step) {
            self.write_fields(now)?;
        }
        if self.checkpoint_is_due(now.state.step) {
            self.write_checkpoint(now, true)?;
        }
        Ok(())
    }

    fn last(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        if self.replaces.is_some() {
            return Ok(());
        }
        self.write_last_fields(last)?;
        self.write_end(last)?;
        self.pack()
    }

    /// Ends an interrupted run: snapshots are not packed, and the last one of a large body is left out.
    fn interrupted(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        if self.replaces.is_some() {
            return Ok(());
        }
        if last.problem.mesh.points.len() <= SOON {
            self.write_last_fields(last)?;
        }
        self.write_end(last)
    }

    fn finish(&mut self, summary: &Summary) -> Result<(), OutputError> {
        if self.replaces.is_some() {
            // The run has not made a step: the earlier results stay.
            return remove_folder(&self.root());
        }
        let written = write_json(&self.path.join(SUMMARY), &self.completed(summary))?;
        self.manifest.list(SUMMARY, Some(written));
        for (name, written) in checkpoint::written(&self.path) {
            self.manifest.list(name, Some(written));
        }
        let rows = self.history.iter().map(|rows| (HISTORY, rows));
        for (name, rows) in rows.chain(self.probes.iter().map(|(_, rows)| (PROBES, rows))) {
            self.manifest.list(name, Some(rows.written()));
        }
        self.manifest.forget_unwritten(&FILES);
        self.manifest.end(summary.steps, !self.is_due(summary.steps));
        self.manifest.write(&self.path)
    }
}
