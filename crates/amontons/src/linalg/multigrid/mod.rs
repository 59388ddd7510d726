//! Iterative solver for large systems: Krylov iteration with algebraic multigrid, without a factor. All unknowns are
//! kept, so that S is K.
//!
//! The preconditioner is smoothed aggregation with rigid-body modes ([`aggregate`], [`prolongation`], [`hierarchy`],
//! [`precondition`]) between two local solutions where contact acts ([`local`]).

mod aggregate;
mod blocks;
mod condensed;
mod hierarchy;
mod kept;
pub mod limits;
mod local;
mod masked;
mod precondition;
mod product;
mod prolongation;
mod relieved;
mod surface;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::condensed::Condensed;
use super::error::SolveError;
use super::estimate::{Choice, Estimate};
use super::factor::{Backend, Factor};
use super::sparse::BlockMatrix;
use super::stop::StopFlag;
use super::unknowns::{Layout, Unknowns};
use condensed::Iterative;
pub use kept::{ContactParts, KeptMatrix};
pub use local::ContactBlocks;

/// Backend of conjugate gradients or GMRES with smoothed aggregation.
#[derive(Debug, Clone, Default)]
pub struct Multigrid {
    stop: StopFlag,
}

impl Multigrid {
    /// Backend that ends its work when the flag becomes true.
    pub(super) fn stopped_by(flag: &Arc<AtomicBool>) -> Multigrid {
        Multigrid { stop: StopFlag::when(flag) }
    }
}

impl Backend for Multigrid {
    fn order(&self, _matrix: &BlockMatrix, layout: &Layout) -> Unknowns {
        let dofs = (0..layout.free.len() as u32).filter(|&dof| layout.free[dof as usize]).collect();
        Unknowns { points: layout.points.into(), ..layout.unknowns(dofs, 0) }
    }

    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError> {
        KeptMatrix::checked(matrix, unknowns)?;
        Ok(Box::new(WholeMatrix { matrix: Arc::clone(matrix), unknowns: unknowns.clone(), stop: self.stop.clone() }))
    }

    fn interruptible(&self, flag: &Arc<AtomicBool>) -> Option<Arc<dyn Backend>> {
        Some(Arc::new(Multigrid::stopped_by(flag)))
    }

    fn choice(&self, estimate: &Estimate) -> Choice {
        Choice::asked("iterative", estimate)
    }

    fn proves(&self, _matrix: &BlockMatrix, _layout: &Layout) -> bool {
        false
    }
}

/// A matrix without eliminated unknowns, in the place of a factor.
#[derive(Debug)]
struct WholeMatrix {
    matrix: Arc<BlockMatrix>,
    unknowns: Unknowns,
    stop: StopFlag,
}

impl Factor for WholeMatrix {
    fn forward(&self, _r: &mut [f64]) -> Result<(), SolveError> {
        Ok(())
    }
    fn backward(&self, _x: &mut [f64]) -> Result<(), SolveError> {
        Ok(())
    }
    fn condensed(&self) -> Box<dyn Condensed> {
        Box::new(Iterative::new(&self.matrix, &self.unknowns, self.stop.clone()))
    }
    fn name(&self) -> &'static str {
        "iterative"
    }
    fn stored(&self) -> usize {
        let (components, _) = self.matrix.block_shape();
        self.matrix.graph().pairs() * components * components
    }
}
