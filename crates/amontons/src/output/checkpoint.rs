//! Checkpoints: everything that a run needs to continue with the same bits.
//!
//! `checkpoint/state.bin` is the newest one, `checkpoint/previous.bin` the one before, in case the newest is damaged.
//! Each consists of
//!
//! | bytes | hold |
//! |---|---|
//! | 16 | `amontons state\r\n`, which a transfer as text would spoil |
//! | 4 | version of the format, little-endian, in `VERSION` |
//! | 32 | SHA-256 of the data that the state depends on, [`Identity`] |
//! | 8 | length of the body, little-endian |
//! | … | the body: the fields of `CheckpointBody` in the wire format of `postcard` 1; every real has its 8 bytes, little-endian |
//! | 32 | SHA-256 of all bytes before |

mod fits;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use self::fits::same;
use super::files::{LONGEST, WrittenFile, move_file, sync_folder, write_atomically};
use super::names::{CHECKPOINT, HISTORY, NEWER_CHECKPOINT, PREVIOUS_CHECKPOINT};
use super::{Identity, OutputError, Snapshot, Work};
use crate::contact::{Flux, Status};
use crate::discretization::Discretization;
use crate::inclusion::{Multipliers, PointState};
use crate::machine;

use crate::problem::Problem;
use crate::state::{
    Accumulated, Carried, ContactReport, Counts, CouplingReport, Earlier, Ledger, Reactions, State, StepReport,
};
use crate::step::{Kept, Scheme};
use crate::tensor::Point;
use crate::time::Pace;

const MAGIC: &[u8; 16] = b"amontons state\r\n";
const VERSION: u32 = 24;
const HASH: usize = 32;
const HEADER: usize = MAGIC.len() + 4 + HASH + 8;

/// A state from which a run can continue, with the report of the step that led to it.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    /// The state.
    pub state: State,
    /// Report of the step that led to the state, or `None` at t = 0.
    pub report: Option<StepReport>,
    /// Work done up to here.
    pub work: Work,
    /// The factors that the run has to make again.
    pub kept: Kept,
    /// Length k of the step that led to the state, or of the first step at t = 0, s.
    pub k: f64,
    /// Reason why it is the previous checkpoint of its folder, or `None` if it is the newest.
    pub fallback: Option<String>,
}

/// The reasons why a run cannot continue from a checkpoint.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The file cannot be read.
    #[error("cannot read the checkpoint {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The file is not a whole checkpoint.
    #[error("the checkpoint {} is damaged: found {found}, expected {expected}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The part that is wrong.
        found: String,
        /// The expected value.
        expected: String,
    },
    /// The file has a format of another version of the program.
    #[error("the checkpoint {} has format {found}, expected {VERSION}; go on with the version of the program that wrote it", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Version of the format.
        found: u32,
    },
    /// The case is not the one of the checkpoint.
    #[error(
        "the checkpoint {} is of another case: {}; undo the change, or start a run of its own with --out; a run goes on with other [output], [expected], [verify], comments, and with a longer time.end at the same step length",
        path.display(), keys.join("; ")
    )]
    OtherCase {
        /// The file.
        path: PathBuf,
        /// The keys that differ, with both values.
        keys: Vec<String>,
    },
    /// The case has steps of another length.
    #[error(
        "the checkpoint has time steps of {found:?} s, the case has steps of {expected:?} s; change time.end and time.steps in proportion"
    )]
    StepLength {
        /// Step length of the checkpoint, s.
        found: f64,
        /// Step length of the problem, s.
        expected: f64,
    },
    /// There is no checkpoint although the run has made steps.
    #[error("{} has no checkpoint but results of steps; start the run anew with --force", path.display())]
    Missing {
        /// The folder.
        path: PathBuf,
    },
    /// The state does not belong to the problem.
    #[error("the checkpoint has {found} {what}, expected {expected}; its mesh is another")]
    Shape {
        /// Name of the quantity that was counted.
        what: &'static str,
        /// Number in the checkpoint.
        found: usize,
        /// Number in the problem.
        expected: usize,
    },
}

/// The body of the file; it mirrors the types of the scheme so that the format changes only on purpose.
#[derive(Serialize, Deserialize)]
struct CheckpointBody {
    case: Identity,
    k: f64,
    step: usize,
    t: f64,
    u: Vec<f64>,
    w: Vec<f64>,
    theta: Vec<f64>,
    theta_rate: Vec<f64>,
    earlier: Option<Earlier>,
    settling: u32,
    p: Vec<f64>,
    q: Vec<Point>,
    sticks: Vec<bool>,
    branches: Vec<Vec<f64>>,
    carried: Carried,
    surface: Accumulated,
    ledger: Ledger,
    counts: Counts,
    temperatures: [f64; 2],
    released: Vec<f64>,
    pace: Pace,
    coarse: Option<Box<CheckpointBody>>,
    work: Work,
    kept: Kept,
    report: Option<Report>,
}

#[derive(Serialize, Deserialize)]
struct Report {
    newton_mechanics: usize,
    newton_heat: usize,
    parts: usize,
    is_ambiguous: bool,
    residual: f64,
    coupling: CouplingReport,
    loose: Vec<String>,
    force: Point,
    moments: Vec<Point>,
    heat_flow: f64,
    reactions: Reactions,
    points: Vec<ReportPoint>,
}

#[derive(Serialize, Deserialize)]
struct ReportPoint {
    normal: Point,
    penetration: f64,
    pressure: f64,
    bound: f64,
    q: Point,
    slip: Point,
    wear: f64,
    opened: f64,
    status: u8,
    temperature: f64,
    opposite: f64,
    flux: f64,
    flux_by_temperature: f64,
    rubbed: f64,
    weight: f64,
}

const STATUS: [Status; 3] = [Status::Open, Status::Stick, Status::Slip];

impl Report {
    fn of(report: &StepReport) -> Report {
        let contact = &report.contact;
        let temperatures = contact.temperature.iter().zip(&contact.opposite);
        let of_heat = temperatures.zip(contact.flux.iter().zip(&contact.rubbed));
        let at_points = contact.states.iter().zip(of_heat).zip(&contact.weights);
        let points = at_points.map(|((state, ((&temperature, &opposite), (flux, &rubbed))), &weight)| ReportPoint {
            normal: state.normal,
            penetration: state.penetration,
            pressure: state.pressure,
            bound: state.bound,
            q: state.q,
            slip: state.slip,
            wear: state.wear,
            opened: state.opened,
            status: STATUS.iter().position(|s| *s == state.status).unwrap_or_default() as u8,
            temperature,
            opposite,
            flux: flux.value,
            flux_by_temperature: flux.by_temperature,
            rubbed,
            weight,
        });
        Report {
            newton_mechanics: report.newton_mechanics,
            newton_heat: report.newton_heat,
            parts: report.parts,
            is_ambiguous: report.is_ambiguous,
            residual: report.residual,
            coupling: report.coupling,
            loose: report.loose.clone(),
            force: contact.force,
            moments: contact.moments.clone(),
            heat_flow: contact.heat_flow,
            reactions: report.reactions.clone(),
            points: points.collect(),
        }
    }

    fn into_report(self) -> StepReport {
        StepReport {
            newton_mechanics: self.newton_mechanics,
            newton_heat: self.newton_heat,
            parts: self.parts,
            is_ambiguous: self.is_ambiguous,
            residual: self.residual,
            coupling: self.coupling,
            loose: self.loose,
            reactions: self.reactions,
            forces: Vec::new(),
            contact: ContactReport {
                boundary: None,
                weights: self.points.iter().map(|p| p.weight).collect(),
                rubbed: self.points.iter().map(|p| p.rubbed).collect(),
                states: self
                    .points
                    .iter()
                    .map(|p| PointState {
                        normal: p.normal,
                        penetration: p.penetration,
                        at_level: p.penetration,
                        pressure: p.pressure,
                        bound: p.bound,
                        q: p.q,
                        slip: p.slip,
                        wear: p.wear,
                        opened: p.opened,
                        status: STATUS.get(usize::from(p.status)).copied().unwrap_or(Status::Open),
                    })
                    .collect(),
                temperature: self.points.iter().map(|p| p.temperature).collect(),
                opposite: self.points.iter().map(|p| p.opposite).collect(),
                flux: self
                    .points
                    .iter()
                    .map(|p| Flux { value: p.flux, by_temperature: p.flux_by_temperature, ..Flux::default() })
                    .collect(),
                force: self.force,
                moments: self.moments,
                heat_flow: self.heat_flow,
            },
        }
    }
}

impl CheckpointBody {
    fn new(case: &Identity, now: &Snapshot) -> CheckpointBody {
        CheckpointBody {
            case: case.clone(),
            k: now.state.made(&now.problem.timeline).k,
            work: now.work,
            kept: now.scheme.map(Scheme::kept).unwrap_or_default(),
            report: now.report.map(Report::of),
            ..CheckpointBody::of_state(now.state)
        }
    }

    fn of_state(state: &State) -> CheckpointBody {
        let state = state.clone();
        CheckpointBody {
            case: Identity::default(),
            k: 0.0,
            step: state.step,
            t: state.t,
            u: state.u,
            w: state.w,
            theta: state.theta,
            theta_rate: state.theta_rate,
            earlier: state.earlier,
            settling: state.settling,
            p: state.multipliers.p,
            q: state.multipliers.q,
            sticks: state.multipliers.sticks,
            branches: state.branches,
            carried: state.carried,
            surface: state.surface,
            ledger: state.ledger,
            counts: state.counts,
            temperatures: state.temperatures,
            released: state.released,
            pace: state.pace,
            coarse: state.coarse.map(|coarse| Box::new(CheckpointBody::of_state(&coarse))),
            work: Work::default(),
            kept: Kept::default(),
            report: None,
        }
    }

    fn into_checkpoint(mut self) -> Checkpoint {
        let report = self.report.take().map(Report::into_report);
        let (work, kept, k) = (self.work, std::mem::take(&mut self.kept), self.k);
        Checkpoint { state: self.into_state(), report, work, kept, k, fallback: None }
    }

    fn into_state(self) -> State {
        State {
            step: self.step,
            t: self.t,
            u: self.u,
            w: self.w,
            theta: self.theta,
            theta_rate: self.theta_rate,
            earlier: self.earlier,
            settling: self.settling,
            multipliers: Multipliers { p: self.p, q: self.q, sticks: self.sticks },
            branches: self.branches,
            carried: self.carried,
            surface: self.surface,
            ledger: self.ledger,
            counts: self.counts,
            temperatures: self.temperatures,
            released: self.released,
            pace: self.pace,
            coarse: self.coarse.map(|coarse| Arc::new(coarse.into_state())),
        }
    }
}

impl Checkpoint {
    /// Reads the newest checkpoint of a results folder, or the one before if the newest is damaged. `None` if the run
    /// has not written its first one.
    ///
    /// # Errors
    /// All checkpoints are damaged, have another format or belong to another case, or there is none although the run
    /// has made steps.
    pub fn read(folder: &Path, case: &Identity) -> Result<Option<Checkpoint>, CheckpointError> {
        let one = |name: &str| {
            let path = folder.join(name);
            machine::read(&path, LONGEST)
                .map_err(|source| CheckpointError::Read { path: path.clone(), source })
                .and_then(|bytes| of_case(&path, &bytes, case))
        };
        let is_absent = |error: &CheckpointError| matches!(error, CheckpointError::Read { source, .. } if source.kind() == std::io::ErrorKind::NotFound);
        let newest = match one(CHECKPOINT) {
            Ok(checkpoint) => return Ok(Some(checkpoint)),
            Err(error @ (CheckpointError::Damaged { .. } | CheckpointError::Read { .. })) => error,
            Err(error) => return Err(error),
        };
        match one(PREVIOUS_CHECKPOINT) {
            Ok(checkpoint) => Ok(Some(Checkpoint { fallback: Some(newest.to_string()), ..checkpoint })),
            Err(error @ CheckpointError::OtherCase { .. }) => Err(error),
            Err(error) if is_absent(&error) && is_absent(&newest) => {
                let rows = machine::read_text(&folder.join(HISTORY), LONGEST).unwrap_or_default();
                if rows.lines().count() > 1 {
                    return Err(CheckpointError::Missing { path: folder.to_owned() });
                }
                // A missing folder is reported by the caller that needs it.
                Ok(None)
            }
            Err(_) => Err(newest),
        }
    }

    /// Writes the checkpoint into a file, for [`Checkpoint::read_file`]. `case` says what it belongs to: the identity
    /// of a case, or the default for a problem without a case file.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path, case: &Identity) -> Result<(), OutputError> {
        let body = CheckpointBody {
            case: case.clone(),
            k: self.k,
            work: self.work,
            kept: self.kept.clone(),
            report: self.report.as_ref().map(Report::of),
            ..CheckpointBody::of_state(&self.state)
        };
        let bytes = encoded(path, case, &body)?;
        write_atomically(path, |out| out.write_all(&bytes)).map(|_| ())
    }

    /// Reads a checkpoint that [`Checkpoint::write`] wrote for the same case.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged, has another format or belongs to another case.
    pub fn read_file(path: &Path, case: &Identity) -> Result<Checkpoint, CheckpointError> {
        let bytes =
            machine::read(path, LONGEST).map_err(|source| CheckpointError::Read { path: path.to_owned(), source })?;
        of_case(path, &bytes, case)
    }

    /// Checks that the checkpoint fits a problem with this discretization.
    pub(crate) fn check(&self, discretization: &Discretization, problem: &Problem) -> Result<(), CheckpointError> {
        // Lengths computed as quotients may differ in their last bits.
        if let Some(expected) = problem.timeline.other_length(self.state.step, &self.state.pace, self.k) {
            return Err(CheckpointError::StepLength { found: self.k, expected });
        }
        fits::state(&self.state, discretization, problem)?;
        if let Some(coarse) = &self.state.coarse {
            fits::state(coarse, discretization, problem)?;
        }
        let points = discretization.boundary.points.len();
        if let Some(report) = &self.report {
            let of_points = [report.contact.states.len(), report.contact.temperature.len(), report.contact.flux.len()];
            of_points.into_iter().try_for_each(|kept| same("contact points", kept, points))?;
        }
        if problem.timeline.is_automatic() {
            let ends = self.state.pace.ends.len();
            return same("phases that are over", ends, ends.min(problem.timeline.phases().len()));
        }
        same("steps", self.state.step, self.state.step.min(problem.timeline.steps()))
    }
}

/// Writes a checkpoint into a results folder. If `keeps` is true, the newest one there becomes the previous one.
pub(super) fn write(folder: &Path, case: &Identity, now: &Snapshot, keeps: bool) -> Result<(), OutputError> {
    let path = folder.join(CHECKPOINT);
    let bytes = encoded(&path, case, &CheckpointBody::new(case, now))?;
    let newer = folder.join(NEWER_CHECKPOINT);
    write_atomically(&newer, |out| out.write_all(&bytes))?;
    // A crash between the two moves leaves the previous checkpoint, which is then read.
    if keeps {
        move_file(&path, &folder.join(PREVIOUS_CHECKPOINT))?;
    }
    move_file(&newer, &path)?;
    sync_folder(path.parent()).map_err(OutputError::io("write", &path))
}

/// The bytes of a checkpoint.
fn encoded(path: &Path, case: &Identity, body: &CheckpointBody) -> Result<Vec<u8>, OutputError> {
    let body = postcard::to_stdvec(body)
        .map_err(|error| OutputError::Encode { path: path.to_owned(), message: error.to_string() })?;
    Ok(seal(&case.hash(), &body))
}

/// The files of the checkpoints as they are on the disk.
pub(super) fn written(folder: &Path) -> Vec<(&'static str, WrittenFile)> {
    let of = |name: &'static str| Some((name, WrittenFile::read(&folder.join(name)).ok()?));
    [CHECKPOINT, PREVIOUS_CHECKPOINT].into_iter().filter_map(of).collect()
}

/// True if the newest checkpoint of a folder is undamaged.
pub(super) fn is_whole(folder: &Path) -> bool {
    let path = folder.join(CHECKPOINT);
    machine::read(&path, LONGEST).is_ok_and(|bytes| unseal(&path, &bytes).is_ok())
}

/// Puts a body between the header and the checksum.
fn seal(case: &[u8; HASH], body: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER + body.len() + HASH);
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(case);
    bytes.extend_from_slice(&(body.len() as u64).to_le_bytes());
    bytes.extend_from_slice(body);
    let checksum = Sha256::digest(&bytes);
    bytes.extend_from_slice(&checksum);
    bytes
}

/// Writes the states of one level of a study. A case with the same fingerprint finds them again.
pub(super) fn write_states(path: &Path, case: &str, states: &[State]) -> Result<(), OutputError> {
    let bodies: Vec<CheckpointBody> = states.iter().map(CheckpointBody::of_state).collect();
    let body = postcard::to_stdvec(&bodies)
        .map_err(|error| OutputError::Encode { path: path.to_owned(), message: error.to_string() })?;
    let bytes = seal(&Sha256::digest(case).into(), &body);
    write_atomically(path, |out| out.write_all(&bytes)).map(|_| ())
}

/// Reads the states that [`write_states`] wrote for a case with this fingerprint.
pub(super) fn read_states(path: &Path, case: &str) -> Result<Vec<State>, CheckpointError> {
    let bytes =
        machine::read(path, LONGEST).map_err(|source| CheckpointError::Read { path: path.to_owned(), source })?;
    let (hash, body) = unseal(path, &bytes)?;
    if Sha256::digest(case).as_slice() != hash {
        return Err(CheckpointError::OtherCase {
            path: path.to_owned(),
            keys: vec!["the text has changed".to_owned()],
        });
    }
    let bodies: Vec<CheckpointBody> = decode(path, body)?;
    Ok(bodies.into_iter().map(|body| body.into_checkpoint().state).collect())
}

/// The checkpoint in `bytes`, which must belong to a case of this identity.
fn of_case(path: &Path, bytes: &[u8], case: &Identity) -> Result<Checkpoint, CheckpointError> {
    let (hash, body) = unseal(path, bytes)?;
    let body: CheckpointBody = decode(path, body)?;
    if *hash != case.hash() || body.case != *case {
        let keys = body.case.differences(case);
        return Err(CheckpointError::OtherCase { path: path.to_owned(), keys });
    }
    Ok(body.into_checkpoint())
}

fn decode<T: serde::de::DeserializeOwned>(path: &Path, body: &[u8]) -> Result<T, CheckpointError> {
    postcard::from_bytes(body).map_err(|error| CheckpointError::Damaged {
        path: path.to_owned(),
        found: error.to_string(),
        expected: "a state".to_owned(),
    })
}

/// The hash of the case and the body of a file, after a check of header and checksum.
fn unseal<'b>(path: &Path, bytes: &'b [u8]) -> Result<(&'b [u8; HASH], &'b [u8]), CheckpointError> {
    let damaged = |found: String, expected: String| CheckpointError::Damaged { path: path.to_owned(), found, expected };
    let too_short = || damaged(format!("{} bytes", bytes.len()), "the whole file".to_owned());
    let rest = bytes
        .strip_prefix(MAGIC)
        .ok_or_else(|| damaged("another file".to_owned(), "a checkpoint of amontons".to_owned()))?;
    let (version, rest) = rest.split_first_chunk::<4>().ok_or_else(too_short)?;
    let version = u32::from_le_bytes(*version);
    if version != VERSION {
        return Err(CheckpointError::Version { path: path.to_owned(), found: version });
    }
    let (hash, rest) = rest.split_first_chunk::<HASH>().ok_or_else(too_short)?;
    let (length, rest) = rest.split_first_chunk::<8>().ok_or_else(too_short)?;
    let (body, checksum) = rest.split_last_chunk::<HASH>().ok_or_else(too_short)?;
    if u64::from_le_bytes(*length) != body.len() as u64 {
        return Err(damaged(
            format!("a body of {} bytes", body.len()),
            format!("one of {}", u64::from_le_bytes(*length)),
        ));
    }
    if Sha256::digest(&bytes[..bytes.len() - HASH]).as_slice() != checksum {
        return Err(damaged("a checksum that does not match".to_owned(), "the one written with the file".to_owned()));
    }
    Ok((hash, body))
}
