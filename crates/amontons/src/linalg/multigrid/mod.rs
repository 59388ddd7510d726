//! Iterative solver for large systems: Krylov iteration with algebraic multigrid, without a factor. All unknowns are
//! kept, so that S is K.
//!
//! The preconditioner is smoothed aggregation with rigid-body modes ([`aggregate`], [`prolongation`], [`hierarchy`],
//! [`precondition`]) between two local solutions where contact acts ([`local`]).

mod aggregate;
mod blocks;
mod condensed;
mod hierarchy;
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
use super::tangent::Tangent;
use super::unknowns::{Layout, Unknowns};
use condensed::Iterative;

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
        let (components, _) = matrix.block_shape();
        let rigid: Vec<usize> = unknowns.rigid_stiffness(matrix).into_iter().map(|(unknown, _)| unknown).collect();
        // Rigid motions that contact alone holds have a stiffness of round-off size.
        let own = unknowns.dofs.iter().enumerate().filter(|(unknown, _)| !rigid.contains(unknown));
        for (pivot, &dof) in own {
            let (node, c) = (dof as usize / components, dof as usize % components);
            let diagonal = matrix.get(node, c, node, c);
            if diagonal <= 0.0 || diagonal.is_nan() {
                return Err(SolveError::NotPositive { pivot, size: unknowns.len() });
            }
        }
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

    fn is_positive_definite(&self, matrix: &Arc<BlockMatrix>, layout: &Layout) -> Result<bool, SolveError> {
        let matrix = layout.matrix(matrix);
        let unknowns = self.order(&matrix, layout);
        match self.factorize(&matrix, &unknowns) {
            Ok(factor) => factor.condensed().is_positive_definite(&Tangent::new()),
            Err(SolveError::NotPositive { .. }) => Ok(false),
            Err(error) => Err(error),
        }
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
