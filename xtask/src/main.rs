//! Developer commands: `cargo run --release -p xtask -- COMMAND`.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program prints")]

mod ordering;
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
    /// Tabulates fill and operations of the Cholesky factor of a cube of tetrahedra by the order of elimination.
    Ordering(ordering::Arguments),
}

fn main() -> ExitCode {
    match Arguments::parse().command {
        Command::Search(arguments) => search::run(&arguments),
        Command::Ordering(arguments) => ordering::run(&arguments),
    }
}
