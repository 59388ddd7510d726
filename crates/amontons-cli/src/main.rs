//! The program `amontons`: contact with friction and heat from one case file.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(amontons_cli::main(&amontons_cli::Team::default()))
}
