//! The cells that cause an error.

use super::DiscretizationError;

/// Share of the energy of the error that the marked cells have (Dörfler, 1996): with a half of it refinement has the
/// best rate, and more rounds than with more.
const MARKED: f64 = 0.5;
/// Relative difference of two energies of cells that are equal but for round-off, as those of mirrored cells.
const SAME: f64 = 1e-6;

impl DiscretizationError {
    /// The cells with the largest errors, as few as have half of the energy of the error together, ascending. Cells
    /// with equal errors are all marked or none, so that what is symmetric stays so.
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
