//! Until the bound of the error in the norm of the energy is small enough.

use super::{AccuracyEnding, AccuracyError, AccuracyRequest, AccurateCase, no_mesh, rounds_of, stands};
use crate::case::Case;
use crate::mesh::{MarkedCells, RefinementRounds};
use crate::output::ErrorOfRun;
use crate::run;

/// A run on one of the meshes.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyLevel {
    /// Number of cells of the mesh.
    pub cells: usize,
    /// Number of its nodes.
    pub nodes: usize,
    /// The largest ‖u_h − u‖ of a step over the largest ‖u_h‖ is at most this.
    pub relative: f64,
    /// ½‖u_h − u‖² is at most this, J.
    pub energy: f64,
    /// True if the bound is proven.
    pub is_guaranteed: bool,
}

/// Refines until the relative error in the norm of the energy is small enough. Each level is told.
///
/// # Errors
/// The case cannot be read, its first run fails, or its error has no bound.
pub fn of_energy(
    request: &AccuracyRequest,
    tell: &mut dyn FnMut(&EnergyLevel),
) -> Result<AccurateCase<EnergyLevel>, AccuracyError> {
    request.check()?;
    let more = ["output.error=true".to_owned()];
    let start = request.refined(&RefinementRounds::default(), &more)?;
    let mut rounds = rounds_of(&start);
    let (mut case, mut before): (Case, Option<Case>) = (start, None);
    let mut levels: Vec<EnergyLevel> = Vec::new();
    loop {
        let judged = judged(&case, request)?;
        let worst = match (judged.worst(), before.take()) {
            (Ok(worst), _) => worst,
            // The bound of a finer mesh may take too much memory.
            (Err(refused), Some(case)) => {
                let ending = AccuracyEnding::NoMesh(refused.reason().to_owned());
                return Ok(AccurateCase { case, levels, ending });
            }
            (Err(refused), None) => return Err(AccuracyError::Refused(no_bound(&refused.to_string()))),
        };
        let level = EnergyLevel {
            cells: case.problem.mesh.cell_count(),
            nodes: case.problem.mesh.points.len(),
            relative: judged.relative(),
            energy: worst.energy,
            is_guaranteed: judged.is_guaranteed(),
        };
        tell(&level);
        let (marked, relative) = (worst.marked(), level.relative);
        levels.push(level);
        if relative <= request.relative {
            return Ok(AccurateCase { case, levels, ending: AccuracyEnding::Reached });
        }
        if marked.is_empty() || stands(levels.iter().map(|level| level.relative)) {
            let ending = AccuracyEnding::Stands("it does not fall with finer cells any more".to_owned());
            return Ok(AccurateCase { case, levels, ending });
        }
        rounds.marked.push(MarkedCells::These(marked));
        match request.refined(&rounds, &more) {
            Ok(finer) => before = Some(std::mem::replace(&mut case, finer)),
            Err(error) => return no_mesh(error).map(|ending| AccurateCase { case, levels, ending }),
        }
    }
}

/// The error of the run of a case, which writes no results.
fn judged(case: &Case, request: &AccuracyRequest) -> Result<ErrorOfRun, AccuracyError> {
    let mut judge = ErrorOfRun::every(case.every);
    run::run(&case.problem, &request.settings(), &mut [&mut judge])?;
    Ok(judge)
}

fn no_bound(why: &str) -> String {
    format!("--accuracy: {why}; ask for that of values (--of with a probe), which every case has")
}
