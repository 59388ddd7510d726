//! Failures: exit codes and messages.

use std::io;
use std::path::PathBuf;

use amontons::adjoint::GradientError;
use amontons::case::{CaseError, StudyRequestError};
use amontons::convergence::StudyError;
use amontons::equation::SetupError;
use amontons::identification::IdentificationError;
use amontons::linalg::SolveError;
use amontons::mesh::MeshFileError;
use amontons::output::{CheckpointError, OutputError, Summary};
use amontons::plot::PlotError;
use amontons::run::RunError;
use amontons::stability::StabilityError;
use amontons::verify::VerifyError;
use serde_json::{Value, json};

use crate::arguments::OutputFormat;
use crate::team::Team;
use crate::{faults, print};

/// The reason why a command failed.
#[derive(Debug)]
pub enum CommandFailure {
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
    /// Derivatives that cannot be computed.
    Gradient(GradientError),
    /// Parameters that cannot be identified.
    Fit {
        error: IdentificationError,
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
    /// Modes that were not found.
    Modes(StabilityError),
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
    /// The first of several processes has failed with this exit code, and says why.
    Elsewhere(u8),
}

impl From<CaseError> for CommandFailure {
    fn from(error: CaseError) -> CommandFailure {
        CommandFailure::Case(error)
    }
}

impl From<GradientError> for CommandFailure {
    fn from(error: GradientError) -> CommandFailure {
        CommandFailure::Gradient(error)
    }
}

impl From<IdentificationError> for CommandFailure {
    fn from(error: IdentificationError) -> CommandFailure {
        CommandFailure::Fit { error, folder: PathBuf::new() }
    }
}

impl From<StudyRequestError> for CommandFailure {
    fn from(error: StudyRequestError) -> CommandFailure {
        match error {
            StudyRequestError::Case(error) => CommandFailure::Case(error),
            StudyRequestError::Request { .. } => CommandFailure::Request(error.to_string()),
        }
    }
}

impl From<VerifyError> for CommandFailure {
    fn from(error: VerifyError) -> CommandFailure {
        match error {
            VerifyError::Case(error) => error.into(),
            VerifyError::Run(error) => CommandFailure::Run { error, hint: None },
            VerifyError::Request(error) => error.into(),
            VerifyError::Files(error) => error.into(),
            VerifyError::Study(error) => CommandFailure::Study { error, folder: PathBuf::new() },
            error @ (VerifyError::Nothing(_) | VerifyError::Check(_)) => CommandFailure::Request(error.to_string()),
        }
    }
}

impl From<MeshFileError> for CommandFailure {
    fn from(error: MeshFileError) -> CommandFailure {
        CommandFailure::Mesh(error)
    }
}

impl From<SolveError> for CommandFailure {
    fn from(error: SolveError) -> CommandFailure {
        CommandFailure::Constants(error)
    }
}

impl From<PlotError> for CommandFailure {
    fn from(error: PlotError) -> CommandFailure {
        CommandFailure::Plot(error)
    }
}

impl From<OutputError> for CommandFailure {
    fn from(error: OutputError) -> CommandFailure {
        CommandFailure::Output(error)
    }
}

impl From<CheckpointError> for CommandFailure {
    fn from(error: CheckpointError) -> CommandFailure {
        CommandFailure::Checkpoint(error)
    }
}

impl From<io::Error> for CommandFailure {
    fn from(error: io::Error) -> CommandFailure {
        CommandFailure::Print(error)
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

impl CommandFailure {
    fn class(&self) -> Class {
        match self {
            CommandFailure::Case(CaseError::Faults { .. }) => CASE,
            CommandFailure::Exists(_) | CommandFailure::Request(_) | CommandFailure::Usage(_) => USAGE,
            CommandFailure::Verification { .. } => CHECK,
            CommandFailure::Modes(StabilityError::Problem(_)) => CASE,
            CommandFailure::Modes(StabilityError::Solve(SolveError::Interrupted)) => INTERRUPTED,
            CommandFailure::Modes(_) => SOLVER,
            CommandFailure::Elsewhere(code) => ("elsewhere", *code),
            CommandFailure::Mesh(error) if error.is_unreadable() => FILE,
            CommandFailure::Mesh(_) => MESH,
            CommandFailure::Constants(_) => SOLVER,
            CommandFailure::Plot(_) => FILE,
            CommandFailure::Gradient(error) | CommandFailure::Fit { error: IdentificationError::Run(error), .. } => {
                match error {
                    GradientError::Refused(_) => USAGE,
                    GradientError::Interrupted => INTERRUPTED,
                    _ => SOLVER,
                }
            }
            CommandFailure::Fit { error: IdentificationError::Data(_), .. } => USAGE,
            CommandFailure::Fit { error: IdentificationError::Interrupted, .. } => INTERRUPTED,
            CommandFailure::Fit { error: IdentificationError::NoMinimum { .. }, .. } => SOLVER,
            CommandFailure::Fit { error: IdentificationError::Kept(error), .. } => {
                error.downcast_ref().map_or(FILE, of_output)
            }
            CommandFailure::Study { error, .. } => match error {
                StudyError::Interrupted => INTERRUPTED,
                StudyError::Setup { source: SetupError::Initial(_) | SetupError::Data(_), .. } => CASE,
                StudyError::Times { .. } | StudyError::Transfer { .. } => USAGE,
                StudyError::Setup { .. } | StudyError::Step { .. } => SOLVER,
            },
            CommandFailure::Case(CaseError::Read { .. }) | CommandFailure::Print(_) => FILE,
            CommandFailure::Output(error) => of_output(error),
            CommandFailure::Checkpoint(error) => of_checkpoint(error),
            CommandFailure::Run { error, .. } => match error {
                RunError::Threads { .. } => USAGE,
                RunError::Setup(SetupError::Initial(_) | SetupError::Data(_)) => CASE,
                RunError::Setup(_) | RunError::Step { .. } | RunError::Unsound(_) => SOLVER,
                RunError::Interrupted(_) | RunError::Unstarted { .. } => INTERRUPTED,
                RunError::Output(error) => of_output(error),
                RunError::Checkpoint(error) => of_checkpoint(error),
            },
        }
    }

    /// The exit code.
    pub fn code(&self) -> u8 {
        self.class().1
    }

    pub fn message(&self) -> String {
        match self {
            CommandFailure::Case(error) => error.to_string(),
            CommandFailure::Run { error, .. } => error.to_string(),
            CommandFailure::Output(error) => error.to_string(),
            CommandFailure::Checkpoint(error) => error.to_string(),
            CommandFailure::Study { error: StudyError::Interrupted, folder } => {
                format!(
                    "interrupted; finished levels and the progress of the reference are kept in {}; the same command goes on",
                    folder.display()
                )
            }
            CommandFailure::Study { error, .. } => error.to_string(),
            CommandFailure::Request(message)
            | CommandFailure::Usage(message)
            | CommandFailure::Verification { message, .. } => message.clone(),
            CommandFailure::Modes(error) => error.to_string(),
            CommandFailure::Mesh(error) => error.to_string(),
            CommandFailure::Constants(error) => format!("the constants of the domain: {error}"),
            CommandFailure::Plot(error) => error.to_string(),
            CommandFailure::Gradient(error) => error.to_string(),
            CommandFailure::Fit { error: IdentificationError::Interrupted, folder } => {
                format!("interrupted; the parameters so far are kept in {}; the same command goes on", folder.display())
            }
            CommandFailure::Fit { error: error @ IdentificationError::NoMinimum { .. }, folder } => {
                format!(
                    "{error}; the last values are in {}, and --force begins anew",
                    folder.join("descent.json").display()
                )
            }
            CommandFailure::Fit { error, .. } => error.to_string(),
            CommandFailure::Exists(path) => format!("{} already exists; give another name", path.display()),
            CommandFailure::Elsewhere(_) => OutputError::Elsewhere.to_string(),
            CommandFailure::Print(error) => format!("cannot write to standard output: {error}"),
        }
    }

    fn hint(&self) -> Option<&str> {
        match self {
            CommandFailure::Run { hint, .. } => hint.as_deref(),
            CommandFailure::Checkpoint(CheckpointError::Damaged { .. }) => {
                Some("both checkpoints cannot be used; start the run anew with --force")
            }
            _ => None,
        }
    }

    /// The summary of the run until it failed.
    fn summary(&self) -> Option<&Summary> {
        match self {
            CommandFailure::Run {
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
        if let CommandFailure::Case(CaseError::Faults { file, faults, more }) = self {
            error["faults"] = faults::json(file, faults);
            error["more_faults"] = json!(more);
        }
        if let CommandFailure::Verification { table, .. } = self {
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
    pub fn report(&self, format: OutputFormat) -> u8 {
        // A reader that closes the pipe has seen what it wanted.
        if let CommandFailure::Print(error) = self
            && error.kind() == io::ErrorKind::BrokenPipe
        {
            return 0;
        }
        if format == OutputFormat::Json && !matches!(self, CommandFailure::Print(_)) {
            // If standard output fails, the exit code still shows the failure.
            let _ = print::json(&self.json());
        } else {
            match self {
                CommandFailure::Case(CaseError::Faults { file, faults, more }) => faults::print(file, faults, *more),
                _ => print::error(&self.message(), self.hint()),
            }
        }
        self.code()
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

impl Team {
    /// What the first process makes; `None` in the others, which wait until it has succeeded.
    ///
    /// # Errors
    /// That of the first process, and [`CommandFailure::Elsewhere`] in the others.
    pub fn first<T, E: Into<CommandFailure>>(
        &self,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<Option<T>, CommandFailure> {
        let made = self.is_first().then(make).transpose().map_err(Into::into);
        let code = self.share(made.as_ref().err().map_or(0, CommandFailure::code));
        match made {
            Ok(None) if code != 0 => Err(CommandFailure::Elsewhere(code)),
            made => made,
        }
    }
}
