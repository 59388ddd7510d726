//! Commands and flags.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

/// Contact of deformable bodies with friction and heat
#[derive(Debug, Parser)]
#[command(
    name = "amontons",
    version,
    after_help = "Exit codes: 0 done, 1 a check did not hold, 2 bad usage, case file or mesh, 3 the solver did not converge,\n\
                  4 a file could not be read or written, 130 interrupted (a checkpoint is left)."
)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Solve a case, write results, print a summary
    Run {
        /// The case file
        case: PathBuf,
        #[command(flatten)]
        common: Common,
    },
    /// Go on from the newest checkpoint of a run
    Resume {
        /// The results folder of the run
        dir: PathBuf,
        #[command(flatten)]
        common: Common,
    },
    /// Read and validate a case; solve nothing
    Check {
        /// The case file
        case: PathBuf,
        #[command(flatten)]
        common: Common,
    },
    /// Print the JSON Schema of the case file
    Schema,
    /// Write a commented starter case
    New {
        /// The file to write; one that is there is kept
        file: PathBuf,
    },
    /// Print shell completions
    Completions {
        /// The shell
        shell: Shell,
    },
}

#[derive(Debug, Args)]
pub struct Common {
    /// Results folder [default: results/<case name>; of `resume`: the folder of the run]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Set a value of the case: KEY is its dotted path, VALUE is TOML; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Number of threads; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Print no text but errors, and no progress
    #[arg(long)]
    pub quiet: bool,
    /// What is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub format: Format,
    /// Replace the results that a folder holds, once the new run has made its first step
    #[arg(long)]
    pub force: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For reading
    Text,
    /// For programs
    Json,
}

impl Command {
    /// In what form messages are printed.
    pub fn format(&self) -> Format {
        match self {
            Command::Run { common, .. } | Command::Resume { common, .. } | Command::Check { common, .. } => common.format,
            Command::Schema | Command::New { .. } | Command::Completions { .. } => Format::Text,
        }
    }
}
