//! Which backend solves a system: that which takes less memory and work.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::error::SolveError;
use super::factor::{Backend, Factor};
use super::multigrid::Multigrid;
use super::sparse::BlockMatrix;
use super::supernodal::Supernodal;
use super::unknowns::{Layout, Unknowns};

/// Unknowns in space from which on an iteration takes less than a factor, whose work grows with their square.
const LARGE: usize = 20_000;

/// A factor in the plane and for small bodies in space, else an iteration.
#[derive(Debug, Clone, Default)]
pub struct Automatic {
    multigrid: Multigrid,
}

impl Automatic {
    /// Whether a body in space with so many unknowns of its displacement is solved by an iteration.
    #[must_use]
    pub fn takes_an_iteration(unknowns: f64) -> bool {
        unknowns > LARGE as f64
    }

    fn is_large(layout: &Layout) -> bool {
        let in_space = layout.points.iter().any(|p| p[2] != 0.0);
        in_space && layout.free.iter().filter(|free| **free).count() > LARGE * layout.components / 3
    }
}

impl Backend for Automatic {
    fn order(&self, matrix: &BlockMatrix, layout: &Layout) -> Unknowns {
        if Automatic::is_large(layout) {
            self.multigrid.order(matrix, layout)
        } else {
            Supernodal.order(matrix, layout)
        }
    }

    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError> {
        // Only the iteration asks for coordinates.
        if unknowns.points.is_empty() {
            Supernodal.factorize(matrix, unknowns)
        } else {
            self.multigrid.factorize(matrix, unknowns)
        }
    }

    fn interruptible(&self, flag: &Arc<AtomicBool>) -> Option<Arc<dyn Backend>> {
        Some(Arc::new(Automatic { multigrid: Multigrid::stopped_by(flag) }))
    }

    fn is_positive_definite(&self, matrix: &Arc<BlockMatrix>, layout: &Layout) -> Result<bool, SolveError> {
        if Automatic::is_large(layout) {
            self.multigrid.is_positive_definite(matrix, layout)
        } else {
            Supernodal.is_positive_definite(matrix, layout)
        }
    }
}
