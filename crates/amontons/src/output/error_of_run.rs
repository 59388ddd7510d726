//! The discretization error of a whole run.

use super::discretization_error::PhaseBounds;
use super::{OutputError, Sink, Snapshot};
use crate::majorant::{DiscretizationError, Refused};

/// The error of a run, the largest of all steps at which it is asked for.
#[derive(Debug, Default)]
pub struct ErrorOfRun {
    /// Steps between those at which it is asked for; 0 for the ends of phases alone.
    every: usize,
    bounds: PhaseBounds,
    worst: Option<DiscretizationError>,
    /// Largest energy of the solution, J.
    of_solution: f64,
    refused: Option<Refused>,
    is_guaranteed: bool,
}

impl ErrorOfRun {
    /// Asks for the error after every so many steps, and at the ends of phases; at these alone with 0.
    #[must_use]
    pub fn every(every: usize) -> ErrorOfRun {
        ErrorOfRun { every, is_guaranteed: true, ..ErrorOfRun::default() }
    }

    /// The largest error of a step, whose cells say where the mesh is too coarse.
    ///
    /// # Errors
    /// Why there is no bound of the error of a step.
    pub fn worst(&self) -> Result<&DiscretizationError, Refused> {
        match (&self.refused, &self.worst) {
            (None, Some(worst)) => Ok(worst),
            (Some(refused), _) => Err(refused.clone()),
            (None, None) => Err(Refused::without_steps()),
        }
    }

    /// The largest ‖u_h − u‖ of a step over the largest ‖u_h‖ is at most this.
    #[must_use]
    pub fn relative(&self) -> f64 {
        match &self.worst {
            Some(worst) if !worst.is_at_rest() => (worst.energy / self.of_solution).sqrt(),
            _ => 0.0,
        }
    }

    /// True if all bounds are proven.
    #[must_use]
    pub fn is_guaranteed(&self) -> bool {
        self.is_guaranteed
    }

    fn take(&mut self, now: &Snapshot) {
        if self.refused.is_some() {
            return;
        }
        match self.bounds.at(now) {
            None => {}
            Some(Err(refused)) => self.refused = Some(refused),
            Some(Ok(found)) => {
                self.of_solution = self.of_solution.max(found.of_solution);
                self.is_guaranteed &= found.is_guaranteed();
                if self.worst.as_ref().is_none_or(|worst| found.energy > worst.energy) {
                    self.worst = Some(found);
                }
            }
        }
    }
}

impl Sink for ErrorOfRun {
    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        let timeline = &now.problem.timeline;
        let is_due = self.every > 0 && now.state.step.is_multiple_of(self.every);
        if is_due || timeline.is_between(now.state.step, &now.state.pace) {
            self.take(now);
        }
        Ok(())
    }
}
