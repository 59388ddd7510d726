//! The program `amontons`: contact with friction and heat from one case file.

mod arguments;
mod commands;
mod constants;
mod converge;
mod faults;
mod model;
mod print;
mod progress;
mod reproduce;
mod status;
mod verify;
mod voices;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    let arguments = arguments::Arguments::parse();
    let format = arguments.command.format();
    match commands::execute(arguments.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(format),
    }
}
