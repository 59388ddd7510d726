//! `manifest.json`: program, inputs and settings that made the results.

use std::collections::BTreeMap;
use std::io;
use std::path::{Component, Path};
use std::time::SystemTime;

use serde::{Deserialize, Serialize};

use super::OutputError;
use super::files::{LONGEST, WrittenFile, sha256, write_atomically};
use super::names::{FILES, MANIFEST, PACKED};
use crate::equation::{ACCEPTED, REFINE};
use crate::inclusion::TOLERANCE;
use crate::machine;
use crate::units::{Measure, Units};

const PROGRAM: &str = "amontons";

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Manifest {
    program: String,
    version: String,
    case: String,
    /// SHA-256 of `case.toml` and of the files it refers to, hexadecimal.
    input_sha256: String,
    settings: ManifestSettings,
    tolerances: Tolerances,
    platform: Platform,
    threads: usize,
    /// Units of the numbers.
    #[serde(default)]
    units: Units,
    /// The units of the columns of each table that have one.
    #[serde(default)]
    columns: BTreeMap<String, BTreeMap<String, String>>,
    /// Names of the regions and of the sides of contact, in the order of their numbers in the files for ParaView.
    #[serde(default)]
    regions: Vec<String>,
    #[serde(default)]
    sides: Vec<String>,
    start: String,
    end: Option<String>,
    /// One entry per start or resumption of the run; empty before the start.
    sessions: Vec<Session>,
    /// The files that the run has written, with lengths and hashes once it has ended. Files in the snapshot folders
    /// belong to the run even if they are not listed.
    #[serde(default)]
    outputs: Option<BTreeMap<String, Option<WrittenFile>>>,
    /// The step of the snapshot written only because the run ended there.
    #[serde(default)]
    passing: Option<usize>,
    /// SHA-256 of this file with an empty value here.
    #[serde(default)]
    sha256: String,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ManifestSettings {
    /// Steps between field snapshots.
    pub every: usize,
    /// Most seconds between checkpoints.
    pub checkpoint_seconds: Option<f64>,
    /// Most steps between checkpoints.
    #[serde(default)]
    pub checkpoint_steps: Option<usize>,
    /// True if the run evaluates all hypotheses.
    #[serde(default = "yes")]
    pub certificate: bool,
    /// The overrides of all sessions. `[expected]` and `[verify]` apply to the case without them.
    #[serde(default)]
    pub overrides: Vec<String>,
}

fn yes() -> bool {
    true
}

/// Relative residuals used by the solver; users cannot set them.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Tolerances {
    /// The iteration on Γ_C ends below it.
    newton: f64,
    /// A half-step gets another pass of sweeps above it.
    refined_above: f64,
    /// A step is accepted below it.
    accepted_below: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Platform {
    os: String,
    architecture: String,
    cores: Option<usize>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Session {
    version: String,
    threads: usize,
    from_step: usize,
    to_step: Option<usize>,
    start: String,
    end: Option<String>,
}

impl Manifest {
    /// The manifest of a run that starts now.
    pub fn new(fingerprint: &str, settings: ManifestSettings) -> Manifest {
        Manifest {
            program: PROGRAM.to_owned(),
            version: version(),
            case: String::new(),
            input_sha256: sha256(fingerprint),
            settings,
            tolerances: Tolerances { newton: TOLERANCE, refined_above: REFINE, accepted_below: ACCEPTED },
            platform: Platform {
                os: std::env::consts::OS.to_owned(),
                architecture: std::env::consts::ARCH.to_owned(),
                cores: std::thread::available_parallelism().ok().map(usize::from),
            },
            threads: 0,
            units: Units::default(),
            columns: BTreeMap::new(),
            regions: Vec::new(),
            sides: Vec::new(),
            start: now(),
            end: None,
            sessions: Vec::new(),
            outputs: Some(BTreeMap::new()),
            passing: None,
            sha256: String::new(),
        }
    }

    /// Notes the inputs and settings of a new session.
    pub fn change(&mut self, fingerprint: &str, settings: ManifestSettings) {
        let before = std::mem::replace(&mut self.settings, settings).overrides;
        self.settings.overrides.splice(0..0, before);
        self.input_sha256 = sha256(fingerprint);
    }

    /// SHA-256 of the inputs, hexadecimal.
    pub fn input_sha256(&self) -> &str {
        &self.input_sha256
    }

    /// Name of the case.
    pub fn case(&self) -> &str {
        &self.case
    }

    /// Settings of the last session.
    pub fn settings(&self) -> &ManifestSettings {
        &self.settings
    }

    /// True if the run has started time stepping at least once.
    pub fn is_started(&self) -> bool {
        !self.sessions.is_empty()
    }

    /// The step at which the run ended, or `None` if it is running or was killed.
    pub fn ended(&self) -> Option<usize> {
        self.end.as_ref()?;
        self.sessions.last()?.to_step
    }

    /// The files listed by the run, by their paths in the folder. Paths that lead out of the folder are left out.
    pub fn outputs(&self) -> Vec<(&str, Option<&WrittenFile>)> {
        let inside = |name: &str| {
            let mut parts = Path::new(name).components();
            parts.by_ref().all(|part| matches!(part, Component::Normal(_)))
        };
        if let Some(all) = &self.outputs {
            let inside = all.iter().filter(|(name, _)| inside(name));
            return inside.map(|(name, written)| (name.as_str(), written.as_ref())).collect();
        }
        // Older versions did not list these files, but wrote them.
        FILES.iter().filter(|name| **name != PACKED).map(|name| (*name, None)).collect()
    }

    /// Notes a file that the run writes, with its length and hash once they are known.
    pub fn list(&mut self, name: &str, written: Option<WrittenFile>) {
        self.outputs.get_or_insert_default().insert(name.to_owned(), written);
    }

    /// Notes a file that the run may write.
    pub fn name(&mut self, name: &str) {
        self.outputs.get_or_insert_default().entry(name.to_owned()).or_default();
    }

    /// Forgets the files of these names that have not been written.
    pub fn forget_unwritten(&mut self, names: &[&str]) {
        let outputs = self.outputs.get_or_insert_default();
        outputs.retain(|name, written| written.is_some() || !names.contains(&name.as_str()));
    }

    /// Forgets the files that do not satisfy a condition.
    pub fn retain(&mut self, keep: impl Fn(&str) -> bool) {
        self.outputs.get_or_insert_default().retain(|name, _| keep(name));
    }

    /// The step of the snapshot written only because the run ended there.
    pub fn passing(&self) -> Option<usize> {
        self.passing
    }

    /// True if it belongs to a run with these inputs, made and finished by this version of the program.
    pub fn is_of(&self, fingerprint: &str) -> bool {
        self.version == version() && self.input_sha256 == sha256(fingerprint) && self.end.is_some()
    }

    /// Reads the manifest of a results folder.
    pub fn read(folder: &Path) -> Result<Manifest, OutputError> {
        let path = folder.join(MANIFEST);
        Manifest::find(folder)?.ok_or_else(|| OutputError::io("read", &path)(io::Error::from(io::ErrorKind::NotFound)))
    }

    /// Reads the manifest of a results folder, or `None` if there is no such file.
    pub fn find(folder: &Path) -> Result<Option<Manifest>, OutputError> {
        let path = folder.join(MANIFEST);
        let text = match machine::read_text(&path, LONGEST) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            text => text.map_err(OutputError::io("read", &path))?,
        };
        let inconsistent = |found: String| OutputError::Inconsistent {
            path: path.clone(),
            found,
            expected: "the manifest of a run".to_owned(),
        };
        let manifest: Manifest = serde_json::from_str(&text).map_err(|error| inconsistent(error.to_string()))?;
        if manifest.program == PROGRAM { Ok(Some(manifest)) } else { Err(inconsistent("another file".to_owned())) }
    }

    /// True if the file in a results folder has exactly the text of this manifest.
    pub fn is_intact(&self, folder: &Path) -> bool {
        let text = machine::read_text(&folder.join(MANIFEST), LONGEST).unwrap_or_default();
        self.text().is_ok_and(|own| own == text)
    }

    /// The text of the file.
    fn text(&self) -> serde_json::Result<String> {
        let empty = Manifest { sha256: String::new(), ..self.clone() };
        let sha256 = sha256(serde_json::to_string_pretty(&empty)?);
        Ok(serde_json::to_string_pretty(&Manifest { sha256, ..empty })? + "\n")
    }

    /// Notes the name of the case and the units of the tables, given by name and columns.
    pub fn units(&mut self, case: &str, units: Units, tables: &[(&str, Vec<(String, Measure)>)]) {
        let of = |columns: &[(String, Measure)]| {
            let with_unit = columns.iter().filter(|(_, measure)| !units.of(*measure).is_empty());
            with_unit.map(|(name, measure)| (name.clone(), units.of(*measure).to_owned())).collect()
        };
        (self.case, self.units) = (case.to_owned(), units);
        self.columns = tables.iter().map(|(name, columns)| ((*name).to_owned(), of(columns))).collect();
    }

    /// The units of the columns of a table that have one.
    pub fn units_of(&self, table: &str) -> &BTreeMap<String, String> {
        static NONE: BTreeMap<String, String> = BTreeMap::new();
        self.columns.get(table).unwrap_or(&NONE)
    }

    /// Notes the names of the regions and of the sides of contact, in the order of their numbers.
    pub fn parts(&mut self, regions: &[String], sides: Vec<String>) {
        (self.regions, self.sides) = (regions.to_vec(), sides);
    }

    /// Notes that the run starts or continues from a step.
    pub fn begin(&mut self, threads: usize, from_step: usize) {
        (self.version, self.threads, self.end, self.passing) = (version(), threads, None, None);
        self.sessions.push(Session { version: version(), threads, from_step, to_step: None, start: now(), end: None });
    }

    /// Notes that the run ends at a step. `is_passing` is true if its snapshot was written only because of that.
    pub fn end(&mut self, to_step: usize, is_passing: bool) {
        (self.end, self.passing) = (Some(now()), is_passing.then_some(to_step));
        if let Some(session) = self.sessions.last_mut() {
            (session.to_step, session.end) = (Some(to_step), self.end.clone());
        }
    }

    /// Writes the manifest into a results folder.
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        let path = folder.join(MANIFEST);
        let text =
            self.text().map_err(|error| OutputError::Encode { path: path.clone(), message: error.to_string() })?;
        write_atomically(&path, |out| io::Write::write_all(out, text.as_bytes())).map(|_| ())
    }
}

fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// Now, as RFC 3339 in UTC.
fn now() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}
