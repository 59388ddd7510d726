//! The error of a whole run, and the cells that cause it.

use super::{DiscretizationError, Majorant, Refused};
use crate::output::{OutputError, RunStart, Sink, Snapshot, Summary};

/// Share of the energy of the error that the marked cells have (Dörfler, 1996): with a half of it refinement has the
/// best rate, and more rounds than with more.
const MARKED: f64 = 0.5;
/// Relative difference of two energies of cells that are equal but for round-off, as those of mirrored cells.
const SAME: f64 = 1e-6;

impl DiscretizationError {
    /// The cells with the largest errors, as few as have half of the energy of the error together, ascending. Cells with
    /// equal errors are all marked or none, so that what is symmetric stays so.
    #[must_use]
    pub fn marked(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.cells.len()).collect();
        order.sort_by(|&a, &b| self.cells[b].total_cmp(&self.cells[a]).then(a.cmp(&b)));
        let (mut sum, mut last) = (0.0, f64::INFINITY);
        let enough = MARKED * self.cells.iter().sum::<f64>();
        let is_marked = |&cell: &usize| {
            let energy = self.cells[cell];
            let takes = sum < enough || energy >= last * (1.0 - SAME);
            if takes {
                (sum, last) = (sum + energy, energy);
            }
            takes && energy > 0.0
        };
        let mut marked: Vec<usize> = order.into_iter().take_while(is_marked).collect();
        marked.sort_unstable();
        marked
    }
}

/// The error of a run, the largest of all steps at which it is asked for.
#[derive(Debug, Default)]
pub struct ErrorOfRun {
    /// Steps between those at which it is asked for; 0 for the ends of phases alone.
    every: usize,
    /// The bounds of the phase with this number.
    prepared: Option<(usize, Majorant)>,
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
            (None, None) => Err(Refused::new("a run without steps")),
        }
    }

    /// The largest ‖u_h − u‖ of a step over the largest ‖u_h‖ is at most this.
    #[must_use]
    pub fn relative(&self) -> f64 {
        let energy = self.worst.as_ref().map_or(0.0, |worst| worst.energy);
        if energy == 0.0 { 0.0 } else { (energy / self.of_solution).sqrt() }
    }

    /// True if all bounds are proven.
    #[must_use]
    pub fn is_guaranteed(&self) -> bool {
        self.is_guaranteed
    }

    fn take(&mut self, now: &Snapshot) {
        let Some(report) = now.report.filter(|_| self.refused.is_none()) else { return };
        let phase = now.state.made(&now.problem.timeline).phase;
        if self.prepared.as_ref().is_none_or(|(known, _)| *known != phase) {
            match Majorant::new(now.problem, now.discretization) {
                Ok(majorant) => self.prepared = Some((phase, majorant)),
                Err(refused) => self.refused = Some(refused),
            }
        }
        let Some((_, majorant)) = &mut self.prepared else { return };
        match majorant.at(now.problem, now.discretization, (now.state, report)) {
            Ok(found) => {
                self.of_solution = self.of_solution.max(found.of_solution);
                self.is_guaranteed &= found.is_guaranteed();
                if self.worst.as_ref().is_none_or(|worst| found.energy > worst.energy) {
                    self.worst = Some(found);
                }
            }
            Err(refused) => self.refused = Some(refused),
        }
    }
}

impl Sink for ErrorOfRun {
    fn start(&mut self, _start: &RunStart) -> Result<(), OutputError> {
        Ok(())
    }

    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        let timeline = &now.problem.timeline;
        let is_due = self.every > 0 && now.state.step.is_multiple_of(self.every);
        if is_due || timeline.is_between(now.state.step, &now.state.pace) {
            self.take(now);
        }
        Ok(())
    }

    fn last(&mut self, _last: &Snapshot) -> Result<(), OutputError> {
        Ok(())
    }

    fn finish(&mut self, _summary: &Summary) -> Result<(), OutputError> {
        Ok(())
    }
}
