//! Runs for an accuracy: on meshes that are refined where it matters, until the error is small enough.
//!
//! | error | by |
//! |---|---|
//! | ‖u_h − u‖/‖u_h‖ in the norm of the energy | [`of_energy`]: its bound, [`crate::majorant`] |
//! | of probes, resultants and energies | [`of_values`]: the same run with halved cells and halved steps |
//!
//! The last run is one of an ordinary case: `mesh.refined_cells` names the cells that were marked in each round.

mod bars;
mod energy;
mod goals;
mod marks;
mod values;

pub use bars::{BarRow, bars_csv};
pub use energy::{EnergyLevel, of_energy};
pub use values::{AccuracyNews, GoalBar, ValueLevel, of_values};

use crate::case::{self, Case, CaseError, Source};
use crate::mesh::RefinementRounds;
use crate::run::{RunError, Settings};

/// Name of the file with the marked cells, in the case that is run.
const CELLS: &str = "refined-cells.txt";
/// Rounds over which an error has to fall to [`FALLEN`] of it: it does so where cells or steps are the reason for it.
const PATIENCE: usize = 4;
const FALLEN: f64 = 0.9;

/// What is asked for.
pub struct AccuracyRequest<'a> {
    /// The case.
    pub source: &'a Source,
    /// Its overrides.
    pub overrides: &'a [String],
    /// The largest error, relative to the solution or to the values, between 0 and 1.
    pub relative: f64,
    /// Settings of the runs. Their certificates are not evaluated.
    pub settings: &'a Settings,
}

/// Why the last mesh is the last.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AccuracyEnding {
    /// The error is small enough.
    Reached,
    /// The next mesh, or its run, cannot be had: the reason.
    NoMesh(String),
    /// The error does not fall any more: of what, and the usual reason.
    Stands(String),
}

/// The runs so far, and the case of the last one.
#[derive(Debug)]
pub struct AccurateCase<Level> {
    /// The case of the last level.
    pub case: Case,
    /// The levels, from the first mesh on.
    pub levels: Vec<Level>,
    /// Why there are no more.
    pub ending: AccuracyEnding,
}

/// Reason why there are no results.
#[derive(Debug, thiserror::Error)]
pub enum AccuracyError {
    /// The case cannot be read.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The first run fails, or a run is interrupted.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The error of the run is not known, or what is asked for is not.
    #[error("{0}")]
    Refused(String),
}

impl AccuracyRequest<'_> {
    /// Settings of a run that writes no results.
    fn settings(&self) -> Settings {
        Settings { certificate: false, ..self.settings.clone() }
    }

    /// The case with cells that are refined in rounds, and with more overrides.
    fn refined(&self, rounds: &RefinementRounds, more: &[String]) -> Result<Case, CaseError> {
        let mut overrides: Vec<String> = self.overrides.iter().chain(more).cloned().collect();
        if rounds.marked.is_empty() {
            return case::parse(self.source, &overrides);
        }
        overrides.push(format!("mesh.refined_cells=\"{CELLS}\""));
        case::parse(&self.source.with_file(CELLS, rounds.to_string().into_bytes()), &overrides)
    }

    /// Returns an error unless the accuracy is a part of the solution.
    fn check(&self) -> Result<(), AccuracyError> {
        let relative = self.relative;
        if relative > 0.0 && relative < 1.0 {
            return Ok(());
        }
        let found =
            format!("--accuracy: found {relative}, expected a part of the solution between 0 and 1, such as 0.01");
        Err(AccuracyError::Refused(found))
    }
}

/// The rounds with which a case begins.
fn rounds_of(start: &Case) -> RefinementRounds {
    let none = || RefinementRounds { cells: start.problem.mesh.cell_count(), marked: Vec::new() };
    start.rounds.clone().unwrap_or_else(none)
}

/// The first line of the faults of a mesh that cannot be had, or the error if it is another one.
fn no_mesh(error: CaseError) -> Result<AccuracyEnding, AccuracyError> {
    match error {
        CaseError::Faults { .. } => {
            Ok(AccuracyEnding::NoMesh(error.to_string().lines().next().unwrap_or_default().to_owned()))
        }
        error @ CaseError::Read { .. } => Err(error.into()),
    }
}

/// True if an error of rounds does not fall any more.
fn stands(errors: impl Iterator<Item = f64>) -> bool {
    let errors: Vec<f64> = errors.collect();
    let earlier = errors.len().checked_sub(PATIENCE + 1).and_then(|place| errors.get(place));
    earlier.zip(errors.last()).is_some_and(|(earlier, now)| *now > FALLEN * earlier)
}
