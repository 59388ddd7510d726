//! Checkpoints: all that a run needs to go on, to the last bit.
//!
//! `checkpoint/state.bin` consists of
//!
//! | bytes | hold |
//! |---|---|
//! | 16 | `amontons state\r\n`, which a transfer as text would spoil |
//! | 4 | version of the format, little-endian, now 6 |
//! | 32 | SHA-256 of the fingerprint of the case: its text, and what the files hold that it refers to |
//! | 8 | length of the body, little-endian |
//! | … | the body: the fields of `Body` in the wire format of `postcard` 1; every real has its 8 bytes, little-endian |
//! | 32 | SHA-256 of all that stands before |

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::files::write_atomically;
use super::{OutputError, Snapshot, Work};
use crate::contact::{Flux, Status};
use crate::inclusion::{Multipliers, PointState};
use crate::problem::Problem;
use crate::scheme::{Accumulated, ContactReport, Counts, CouplingReport, Discretization, Ledger, State, StepReport};
use crate::tensor::Point;

/// Where the newest checkpoint is in a results folder.
pub(super) const FILE: &str = "checkpoint/state.bin";
const MAGIC: &[u8; 16] = b"amontons state\r\n";
const VERSION: u32 = 6;
const HASH: usize = 32;
const HEADER: usize = MAGIC.len() + 4 + HASH + 8;

/// A state to go on from, with the report of the step that led to it.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    /// The state.
    pub state: State,
    /// How the step that led here went; none at t = 0.
    pub report: Option<StepReport>,
    /// Work done up to here.
    pub work: Work,
}

/// Why a run cannot go on from a checkpoint.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The file cannot be read.
    #[error("cannot read the checkpoint {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        source: std::io::Error,
    },
    /// The file is not a whole checkpoint.
    #[error("the checkpoint {} is damaged: found {found}, expected {expected}; start the run anew", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What was found.
        found: String,
        /// What was expected.
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
    #[error("the checkpoint {} is of another case; a run goes on with the case it was started with: undo the change or start anew", path.display())]
    OtherCase {
        /// The file.
        path: PathBuf,
    },
    /// The state does not belong to the problem.
    #[error("the checkpoint has {found} {what}, expected {expected}; its mesh is another")]
    Shape {
        /// What was counted.
        what: &'static str,
        /// Number in the checkpoint.
        found: usize,
        /// Number in the problem.
        expected: usize,
    },
}

/// The body of the file; it mirrors the types of the scheme so that the format changes only on purpose.
#[derive(Serialize, Deserialize)]
struct Body {
    step: usize,
    t: f64,
    u: Vec<f64>,
    w: Vec<f64>,
    theta: Vec<f64>,
    p: Vec<f64>,
    q: Vec<Point>,
    sticks: Vec<bool>,
    branches: Vec<Vec<f64>>,
    surface: Accumulated,
    ledger: Ledger,
    counts: Counts,
    temperatures: [f64; 2],
    work: Work,
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
    force: Point,
    heat_flow: f64,
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
    status: u8,
    temperature: f64,
    flux: f64,
    flux_by_temperature: f64,
}

const STATUS: [Status; 3] = [Status::Open, Status::Stick, Status::Slip];

impl Body {
    fn new(now: &Snapshot) -> Body {
        let report = now.report.map(|report| {
            let contact = &report.contact;
            let at_points = contact.states.iter().zip(contact.temperature.iter().zip(&contact.flux));
            let points = at_points.map(|(state, (&temperature, flux))| ReportPoint {
                normal: state.normal,
                penetration: state.penetration,
                pressure: state.pressure,
                bound: state.bound,
                q: state.q,
                slip: state.slip,
                wear: state.wear,
                status: STATUS.iter().position(|s| *s == state.status).unwrap_or_default() as u8,
                temperature,
                flux: flux.value,
                flux_by_temperature: flux.by_temperature,
            });
            Report {
                newton_mechanics: report.newton_mechanics,
                newton_heat: report.newton_heat,
                parts: report.parts,
                is_ambiguous: report.is_ambiguous,
                residual: report.residual,
                coupling: report.coupling,
                force: contact.force,
                heat_flow: contact.heat_flow,
                points: points.collect(),
            }
        });
        Body { work: now.work, report, ..Body::of_state(now.state) }
    }

    fn of_state(state: &State) -> Body {
        let state = state.clone();
        Body {
            step: state.step,
            t: state.t,
            u: state.u,
            w: state.w,
            theta: state.theta,
            p: state.multipliers.p,
            q: state.multipliers.q,
            sticks: state.multipliers.sticks,
            branches: state.branches,
            surface: state.surface,
            ledger: state.ledger,
            counts: state.counts,
            temperatures: state.temperatures,
            work: Work::default(),
            report: None,
        }
    }

    fn into_checkpoint(self) -> Checkpoint {
        let report = self.report.map(|report| StepReport {
            newton_mechanics: report.newton_mechanics,
            newton_heat: report.newton_heat,
            parts: report.parts,
            is_ambiguous: report.is_ambiguous,
            residual: report.residual,
            coupling: report.coupling,
            contact: ContactReport {
                states: report
                    .points
                    .iter()
                    .map(|p| PointState {
                        normal: p.normal,
                        penetration: p.penetration,
                        pressure: p.pressure,
                        bound: p.bound,
                        q: p.q,
                        slip: p.slip,
                        wear: p.wear,
                        status: STATUS.get(usize::from(p.status)).copied().unwrap_or(Status::Open),
                    })
                    .collect(),
                temperature: report.points.iter().map(|p| p.temperature).collect(),
                flux: report
                    .points
                    .iter()
                    .map(|p| Flux { value: p.flux, by_temperature: p.flux_by_temperature, ..Flux::default() })
                    .collect(),
                force: report.force,
                heat_flow: report.heat_flow,
            },
        });
        let state = State {
            step: self.step,
            t: self.t,
            u: self.u,
            w: self.w,
            theta: self.theta,
            multipliers: Multipliers { p: self.p, q: self.q, sticks: self.sticks },
            branches: self.branches,
            surface: self.surface,
            ledger: self.ledger,
            counts: self.counts,
            temperatures: self.temperatures,
        };
        Checkpoint { state, report, work: self.work }
    }
}

impl Checkpoint {
    /// Reads the newest checkpoint of a results folder whose case has the fingerprint `case`.
    ///
    /// # Errors
    /// When it is not there, damaged, of another format or of another case.
    pub fn read(folder: &Path, case: &str) -> Result<Checkpoint, CheckpointError> {
        let path = folder.join(FILE);
        let bytes = fs::read(&path).map_err(|source| CheckpointError::Read { path: path.clone(), source })?;
        decode(&path, &bytes, case).map(Body::into_checkpoint)
    }

    /// Whether the checkpoint is one of a problem with this discretization.
    pub(crate) fn check(&self, discretization: &Discretization, problem: &Problem) -> Result<(), CheckpointError> {
        let (nodes, dim) = (discretization.mesh.points.len(), discretization.mesh.dim);
        let same = |what, found, expected| {
            if found == expected { Ok(()) } else { Err(CheckpointError::Shape { what, found, expected }) }
        };
        same("displacements", self.state.u.len(), nodes * dim)?;
        same("velocities", self.state.w.len(), nodes * dim)?;
        same("temperatures", self.state.theta.len(), nodes)?;
        same("branches", self.state.branches.len(), discretization.branches.len())?;
        for branch in &self.state.branches {
            same("displacements of a branch", branch.len(), nodes * dim)?;
        }
        let points = discretization.boundary.points.len();
        for kept in [
            self.state.multipliers.q.len(),
            self.state.multipliers.p.len(),
            self.state.multipliers.sticks.len(),
            self.state.surface.wear.len(),
            self.state.surface.friction_work.len(),
        ] {
            same("contact points", kept, points)?;
        }
        same("foundations", self.state.surface.foundation.len(), problem.contacts.len())?;
        same("steps", self.state.step, self.state.step.min(problem.steps))
    }
}

/// Writes a checkpoint into a results folder, in place of the one before.
pub(super) fn write(folder: &Path, case: &str, now: &Snapshot) -> Result<(), OutputError> {
    let path = folder.join(FILE);
    let body = postcard::to_stdvec(&Body::new(now))
        .map_err(|error| OutputError::Encode { path: path.clone(), message: error.to_string() })?;
    let bytes = seal(case, &body);
    write_atomically(&path, |out| out.write_all(&bytes))
}

/// Puts a body between the header and the checksum.
fn seal(case: &str, body: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER + body.len() + HASH);
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(&Sha256::digest(case));
    bytes.extend_from_slice(&(body.len() as u64).to_le_bytes());
    bytes.extend_from_slice(body);
    let checksum = Sha256::digest(&bytes);
    bytes.extend_from_slice(&checksum);
    bytes
}

/// States of a level of a study, to be found again for a case of the same fingerprint.
pub(super) fn write_states(path: &Path, case: &str, states: &[State]) -> Result<(), OutputError> {
    let bodies: Vec<Body> = states.iter().map(Body::of_state).collect();
    let body = postcard::to_stdvec(&bodies)
        .map_err(|error| OutputError::Encode { path: path.to_owned(), message: error.to_string() })?;
    let bytes = seal(case, &body);
    write_atomically(path, |out| out.write_all(&bytes))
}

/// States that [`write_states`] wrote for a case of this fingerprint.
pub(super) fn read_states(path: &Path, case: &str) -> Result<Vec<State>, CheckpointError> {
    let bytes = fs::read(path).map_err(|source| CheckpointError::Read { path: path.to_owned(), source })?;
    let bodies: Vec<Body> = decode(path, &bytes, case)?;
    Ok(bodies.into_iter().map(|body| body.into_checkpoint().state).collect())
}

/// The body of a file whose header and checksum are right.
fn decode<T: serde::de::DeserializeOwned>(path: &Path, bytes: &[u8], case: &str) -> Result<T, CheckpointError> {
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
    if Sha256::digest(case).as_slice() != hash {
        return Err(CheckpointError::OtherCase { path: path.to_owned() });
    }
    postcard::from_bytes(body).map_err(|error| damaged(error.to_string(), "a state".to_owned()))
}
