//! The commands of `amontons`, for the program of that name and for `amontons-mpi`, in which several processes execute
//! a command together.

mod accuracy;
mod after;
mod arguments;
mod commands;
mod constants;
mod converge;
mod explain;
mod faults;
mod fit;
mod gradient;
mod import;
mod materials;
mod model;
mod modes;
mod new;
mod plain;
mod print;
mod progress;
mod reproduce;
mod signals;
mod single;
mod status;
mod sweep;
mod team;
mod threads;
mod variants;
mod verify;
mod voices;

use clap::Parser;

use status::CommandFailure;
pub use team::{Processes, Team};

/// What is said of a command that several processes cannot execute together.
const ALONE: &str =
    "several processes execute run without --each, resume, verify and gradient; use the program amontons for the rest";

/// Executes the command of the arguments of this process; returns its exit code.
#[must_use]
pub fn main(team: &Team) -> u8 {
    signals::prepare();
    let mut arguments = match arguments::Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // If neither output can be written, the exit code still says how it ended.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
    let format = arguments.command.format();
    let ended = match arguments.command.shared() {
        None if team.is_several() => Err(CommandFailure::Usage(ALONE.to_owned())),
        shared => {
            if let Some(common) = shared {
                common.team = team.clone();
            }
            threads::within(arguments.command.threads(), || commands::execute(arguments.command))
        }
    };
    match ended {
        Ok(()) => 0,
        Err(failure) => failure.report(format),
    }
}
