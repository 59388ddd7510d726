//! `manifest.json`: what made the results.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::SystemTime;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::OutputError;
use super::files::write_json;
use crate::inclusion::TOLERANCE;
use crate::scheme::{ACCEPTED, REFINE};
use crate::units::{Measure, Units};

/// Name of the file in a results folder.
pub(super) const FILE: &str = "manifest.json";

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Manifest {
    program: String,
    version: String,
    case: String,
    /// SHA-256 of `case.toml` and of what the files hold that it refers to, hexadecimal.
    input_sha256: String,
    settings: Settings,
    tolerances: Tolerances,
    platform: Platform,
    threads: usize,
    /// Units of the numbers.
    #[serde(default)]
    units: Units,
    /// The units of the columns of each table that have one.
    #[serde(default)]
    columns: BTreeMap<String, BTreeMap<String, String>>,
    start: String,
    end: Option<String>,
    /// One entry each time the run was started or resumed.
    sessions: Vec<Session>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Settings {
    /// Steps between field snapshots.
    pub every: usize,
    /// Seconds between checkpoints.
    pub checkpoint_seconds: f64,
}

/// Relative residuals that the solver works with; none of them is for users to set.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Tolerances {
    /// At which the iteration on Γ_C ends.
    newton: f64,
    /// Above which a half-step gets another pass of sweeps.
    refined_above: f64,
    /// Below which a step is a result.
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
    pub fn new(case: &str, fingerprint: &str, settings: Settings) -> Manifest {
        Manifest {
            program: "amontons".to_owned(),
            version: version(),
            case: case.to_owned(),
            input_sha256: hexadecimal(&Sha256::digest(fingerprint)),
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
            start: now(),
            end: None,
            sessions: Vec::new(),
        }
    }

    /// Whether it is that of a run with these inputs, made and ended by this version of the program.
    pub fn is_of(&self, fingerprint: &str) -> bool {
        self.version == version()
            && self.input_sha256 == hexadecimal(&Sha256::digest(fingerprint))
            && self.end.is_some()
    }

    /// Reads the manifest of a results folder.
    pub fn read(folder: &Path) -> Result<Manifest, OutputError> {
        let path = folder.join(FILE);
        let text = fs::read_to_string(&path).map_err(OutputError::io("read", &path))?;
        serde_json::from_str(&text).map_err(|error| OutputError::Inconsistent {
            path,
            found: error.to_string(),
            expected: "the manifest of a run".to_owned(),
        })
    }

    /// Notes the units of the tables, given by their names and columns.
    pub fn units(&mut self, units: Units, tables: &[(&str, Vec<(String, Measure)>)]) {
        let of = |columns: &[(String, Measure)]| {
            let with_unit = columns.iter().filter(|(_, measure)| !units.of(*measure).is_empty());
            with_unit.map(|(name, measure)| (name.clone(), units.of(*measure).to_owned())).collect()
        };
        self.units = units;
        self.columns = tables.iter().map(|(name, columns)| ((*name).to_owned(), of(columns))).collect();
    }

    /// Notes that the run starts, or goes on, from a step.
    pub fn begin(&mut self, threads: usize, from_step: usize) {
        (self.version, self.threads, self.end) = (version(), threads, None);
        self.sessions.push(Session { version: version(), threads, from_step, to_step: None, start: now(), end: None });
    }

    /// Notes that the run ends at a step.
    pub fn end(&mut self, to_step: usize) {
        self.end = Some(now());
        if let Some(session) = self.sessions.last_mut() {
            (session.to_step, session.end) = (Some(to_step), self.end.clone());
        }
    }

    /// Writes the manifest into a results folder.
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        write_json(&folder.join(FILE), self)
    }
}

/// Two digits per byte.
pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
}

fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// Now, as RFC 3339 in UTC.
fn now() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}
