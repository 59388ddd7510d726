//! Which backend solves a system: that which takes less memory and work.

use std::sync::Arc;

use super::error::SolveError;
use super::factor::{Backend, Factor};
use super::multigrid::Multigrid;
use super::sparse::BlockMatrix;
use super::supernodal::Supernodal;
use super::unknowns::{Layout, Unknowns};

/// Unknowns in space from which on an iteration takes less than a factor, whose work grows with their square.
const LARGE: usize = 20_000;

/// A factor in the plane and for small bodies in space, else an iteration.
#[derive(Debug, Clone, Copy, Default)]
pub struct Automatic;

impl Automatic {
    fn is_large(layout: &Layout) -> bool {
        let in_space = layout.points.iter().any(|p| p[2] != 0.0);
        in_space && layout.free.iter().filter(|free| **free).count() > LARGE * layout.components / 3
    }
}

impl Backend for Automatic {
    fn order(&self, matrix: &BlockMatrix, layout: &Layout) -> Unknowns {
        if Automatic::is_large(layout) { Multigrid.order(matrix, layout) } else { Supernodal.order(matrix, layout) }
    }

    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError> {
        // Only the iteration asks for coordinates.
        if unknowns.points.is_empty() {
            Supernodal.factorize(matrix, unknowns)
        } else {
            Multigrid.factorize(matrix, unknowns)
        }
    }

    fn is_positive_definite(&self, matrix: &Arc<BlockMatrix>, layout: &Layout) -> Result<bool, SolveError> {
        if Automatic::is_large(layout) {
            Multigrid.is_positive_definite(matrix, layout)
        } else {
            Supernodal.is_positive_definite(matrix, layout)
        }
    }
}
