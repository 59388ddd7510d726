//! Developer commands: `cargo run --release -p xtask -- COMMAND`.
#![allow(clippy::print_stdout, reason = "a program prints")]

mod random;
mod search;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(about = "Developer commands of amontons")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Runs random contact cases, turned in space, and tabulates how many Newton iterations their steps take.
    Search(search::Arguments),
}

fn main() -> ExitCode {
    match Arguments::parse().command {
        Command::Search(arguments) => search::run(&arguments),
    }
}
