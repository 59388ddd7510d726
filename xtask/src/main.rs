//! Developer commands: `cargo run --release -p xtask -- COMMAND`.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program prints")]

mod bench;
mod endure;
mod fuzz;
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
    /// Times the paper's square and the cube in space, beside other programs where they are asked for.
    Bench(bench::Arguments),
    /// Feeds hostile inputs to every reader of the library.
    Fuzz(fuzz::Arguments),
    /// Kills runs and fails their writes, and resumes each to the same bits.
    Endure(endure::Arguments),
    /// Tabulates fill and operations of the Cholesky factor of a cube of tetrahedra by the order of elimination.
    Ordering(ordering::Arguments),
}

fn main() -> ExitCode {
    match Arguments::parse().command {
        Command::Search(arguments) => search::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Fuzz(arguments) => fuzz::run(&arguments),
        Command::Endure(arguments) => endure::run(&arguments),
        Command::Ordering(arguments) => ordering::run(&arguments),
    }
}
