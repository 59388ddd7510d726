//! The program `amontons`: contact with friction and heat from one case file.

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
mod threads;
mod variants;
mod verify;
mod voices;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    signals::prepare();
    let arguments = arguments::Arguments::parse();
    let format = arguments.command.format();
    match threads::within(arguments.command.threads(), || commands::execute(arguments.command)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(format),
    }
}
