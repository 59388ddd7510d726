//! Failures: exit codes and messages.

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use amontons::case::{CaseError, StudyRequestError};
use amontons::convergence::StudyError;
use amontons::equation::SetupError;
use amontons::linalg::SolveError;
use amontons::mesh::MeshFileError;
use amontons::output::{CheckpointError, OutputError, Summary};
use amontons::plot::PlotError;
use amontons::run::RunError;
use amontons::verify::VerifyError;
use serde_json::{Value, json};

use crate::arguments::Format;
use crate::{faults, print};

/// The reason why a command failed.
#[derive(Debug)]
pub enum Failure {
    Case(CaseError),
    Run {
        error: RunError,
        hint: Option<String>,
    },
    Output(OutputError),
    Checkpoint(CheckpointError),
    /// A study that did not finish.
    Study {
        error: StudyError,
        folder: PathBuf,
    },
    /// A study that does not fit the case.
    Request(String),
    /// Arguments that cannot be carried out.
    Usage(String),
    /// Checks that failed: the message, and the table as JSON.
    Verification {
        message: String,
        table: Value,
    },
    /// A mesh file that cannot be read.
    Mesh(MeshFileError),
    /// Constants of the domain that cannot be computed.
    Constants(SolveError),
    /// A picture that cannot be drawn.
    Plot(PlotError),
    /// A file that must not be replaced.
    Exists(PathBuf),
    /// Standard output cannot be written.
    Print(io::Error),
}

impl From<CaseError> for Failure {
    fn from(error: CaseError) -> Failure {
        Failure::Case(error)
    }
}

impl From<StudyRequestError> for Failure {
    fn from(error: StudyRequestError) -> Failure {
        match error {
            StudyRequestError::Case(error) => Failure::Case(error),
            StudyRequestError::Request { .. } => Failure::Request(error.to_string()),
        }
    }
}

impl From<VerifyError> for Failure {
    fn from(error: VerifyError) -> Failure {
        match error {
            VerifyError::Case(error) => error.into(),
            VerifyError::Run(error) => Failure::Run { error, hint: None },
            VerifyError::Request(error) => error.into(),
            VerifyError::Files(error) => error.into(),
            VerifyError::Study(error) => Failure::Study { error, folder: PathBuf::new() },
            error @ (VerifyError::Nothing(_) | VerifyError::Check(_)) => Failure::Request(error.to_string()),
        }
    }
}

impl From<MeshFileError> for Failure {
    fn from(error: MeshFileError) -> Failure {
        Failure::Mesh(error)
    }
}

impl From<SolveError> for Failure {
    fn from(error: SolveError) -> Failure {
        Failure::Constants(error)
    }
}

impl From<PlotError> for Failure {
    fn from(error: PlotError) -> Failure {
        Failure::Plot(error)
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Failure {
        Failure::Output(error)
    }
}

impl From<CheckpointError> for Failure {
    fn from(error: CheckpointError) -> Failure {
        Failure::Checkpoint(error)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Failure {
        Failure::Print(error)
    }
}

/// Kind of failure in JSON, and exit code.
type Class = (&'static str, u8);
const CHECK: Class = ("check", 1);
const USAGE: Class = ("usage", 2);
const CASE: Class = ("case", 2);
const MESH: Class = ("mesh", 2);
const SOLVER: Class = ("solver", 3);
const FILE: Class = ("file", 4);
pub(crate) const INTERRUPTED: Class = ("interrupted", 130);

impl Failure {
    fn class(&self) -> Class {
        match self {
            Failure::Case(CaseError::Faults { .. }) => CASE,
            Failure::Exists(_) | Failure::Request(_) | Failure::Usage(_) => USAGE,
            Failure::Verification { .. } => CHECK,
            Failure::Mesh(error) if error.is_unreadable() => FILE,
            Failure::Mesh(_) => MESH,
            Failure::Constants(_) => SOLVER,
            Failure::Plot(_) => FILE,
            Failure::Study { error, .. } => match error {
                StudyError::Interrupted => INTERRUPTED,
                StudyError::Setup { source: SetupError::Initial(_) | SetupError::Data(_), .. } => CASE,
                StudyError::Times { .. } | StudyError::Transfer { .. } => USAGE,
                StudyError::Setup { .. } | StudyError::Step { .. } => SOLVER,
            },
            Failure::Case(CaseError::Read { .. }) | Failure::Print(_) => FILE,
            Failure::Output(error) => of_output(error),
            Failure::Checkpoint(error) => of_checkpoint(error),
            Failure::Run { error, .. } => match error {
                RunError::Threads { .. } => USAGE,
                RunError::Setup(SetupError::Initial(_) | SetupError::Data(_)) => CASE,
                RunError::Setup(_) | RunError::Step { .. } | RunError::Unsound(_) => SOLVER,
                RunError::Interrupted(_) | RunError::Unstarted { .. } => INTERRUPTED,
                RunError::Output(error) => of_output(error),
                RunError::Checkpoint(error) => of_checkpoint(error),
            },
        }
    }

    pub fn message(&self) -> String {
        match self {
            Failure::Case(error) => error.to_string(),
            Failure::Run { error, .. } => error.to_string(),
            Failure::Output(error) => error.to_string(),
            Failure::Checkpoint(error) => error.to_string(),
            Failure::Study { error: StudyError::Interrupted, folder } => {
                format!(
                    "interrupted; finished levels and the progress of the reference are kept in {}; the same command goes on",
                    folder.display()
                )
            }
            Failure::Study { error, .. } => error.to_string(),
            Failure::Request(message) | Failure::Usage(message) | Failure::Verification { message, .. } => {
                message.clone()
            }
            Failure::Mesh(error) => error.to_string(),
            Failure::Constants(error) => format!("the constants of the domain: {error}"),
            Failure::Plot(error) => error.to_string(),
            Failure::Exists(path) => format!("{} already exists; give another name", path.display()),
            Failure::Print(error) => format!("cannot write to standard output: {error}"),
        }
    }

    fn hint(&self) -> Option<&str> {
        match self {
            Failure::Run { hint, .. } => hint.as_deref(),
            Failure::Checkpoint(CheckpointError::Damaged { .. }) => {
                Some("both checkpoints cannot be used; start the run anew with --force")
            }
            _ => None,
        }
    }

    /// The summary of the run until it failed.
    fn summary(&self) -> Option<&Summary> {
        match self {
            Failure::Run {
                error: RunError::Step { summary, .. } | RunError::Unsound(summary) | RunError::Interrupted(summary),
                ..
            } => Some(summary),
            _ => None,
        }
    }

    fn json(&self) -> Value {
        let (kind, code) = self.class();
        let mut error = json!({ "kind": kind, "exit_code": code, "message": self.message() });
        if let Some(hint) = self.hint() {
            error["hint"] = json!(hint);
        }
        if let Failure::Case(CaseError::Faults { file, faults, more }) = self {
            error["faults"] = faults::json(file, faults);
            error["more_faults"] = json!(more);
        }
        if let Failure::Verification { table, .. } = self {
            let mut table = table.clone();
            table["error"] = error;
            return table;
        }
        match self.summary() {
            Some(summary) => json!({ "error": error, "summary": summary }),
            None => json!({ "error": error }),
        }
    }

    /// Prints the failure and returns its exit code.
    pub fn report(&self, format: Format) -> ExitCode {
        let (_, code) = self.class();
        // A reader that closes the pipe has seen what it wanted.
        if let Failure::Print(error) = self
            && error.kind() == io::ErrorKind::BrokenPipe
        {
            return ExitCode::SUCCESS;
        }
        if format == Format::Json && !matches!(self, Failure::Print(_)) {
            // If standard output fails, the exit code still shows the failure.
            let _ = print::json(&self.json());
        } else {
            match self {
                Failure::Case(CaseError::Faults { file, faults, more }) => faults::print(file, faults, *more),
                _ => print::error(&self.message(), self.hint()),
            }
        }
        ExitCode::from(code)
    }
}

fn of_output(error: &OutputError) -> Class {
    match error {
        OutputError::HoldsResults { .. } | OutputError::Stranger { .. } => USAGE,
        _ => FILE,
    }
}

fn of_checkpoint(error: &CheckpointError) -> Class {
    match error {
        CheckpointError::OtherCase { .. } | CheckpointError::Shape { .. } | CheckpointError::StepLength { .. } => CASE,
        CheckpointError::Read { .. }
        | CheckpointError::Damaged { .. }
        | CheckpointError::Version { .. }
        | CheckpointError::Missing { .. } => FILE,
    }
}
