//! The program `amontons-mpi`: the commands of `amontons` on several processes.

use std::process::ExitCode;

use amontons_cli::Team;
use amontons_petsc::{Failure, Session};

fn main() -> ExitCode {
    let session = match Session::start() {
        Ok(session) => session,
        Err(Failure(message)) => {
            eprintln!("Error: MPI or PETSc cannot be started: {message}");
            return ExitCode::from(3);
        }
    };
    session.end_together();
    let code = amontons_cli::main(&Team::of(session.clone()));
    ExitCode::from(session.end(code))
}
