//! Contact on several processes: linear systems with their rows distributed, solved by PETSc.
//!
//! Mesh and state are on every process, and every process runs the same program. The rows of K, its products and its
//! solutions are distributed: conjugate gradients or GMRES of PETSc with smoothed aggregation (GAMG) and rigid motions,
//! between two local solutions where contact acts. The command `amontons-mpi` is made of this; see the page "Several
//! processes" of the guide.
//!
//! Results have the same bits on all processes of a run, but not with another number of processes.
#![cfg(feature = "petsc")]

mod distributed;
mod operators;
mod rows;
mod session;
mod sys;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use amontons::linalg::{
    Automatic, Backend, BlockMatrix, Choice, Condensed, Estimate, Factor, KeptMatrix, Layout, Multigrid, SolveError,
    Unknowns,
};

use distributed::{Distributed, Shared};
pub use session::Session;
use session::{Step, mark};
pub use sys::Failure;

/// The backend of several processes.
#[derive(Clone, Debug)]
pub struct Petsc {
    session: Arc<Session>,
}

impl Petsc {
    /// The backend of the processes of a session.
    #[must_use]
    pub fn new(session: &Arc<Session>) -> Petsc {
        Petsc { session: Arc::clone(session) }
    }
}

impl Backend for Petsc {
    fn order(&self, matrix: &BlockMatrix, layout: &Layout) -> Unknowns {
        Multigrid::default().order(matrix, layout)
    }

    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError> {
        let _held = self.session.hold();
        self.session.agree(Step::Matrix, mark(&[&[matrix.largest()]]))?;
        let kept = KeptMatrix::checked(matrix, unknowns)?;
        Ok(Box::new(DistributedFactor(Arc::new(Shared::new(&self.session, kept)?))))
    }

    fn interruptible(&self, _flag: &Arc<AtomicBool>) -> Option<Arc<dyn Backend>> {
        // The flags are those of the session: all processes have to see them at the same place.
        None
    }

    fn is_collective(&self) -> bool {
        self.session.size() > 1
    }

    fn alone(&self) -> Option<Arc<dyn Backend>> {
        Some(Arc::new(Automatic::default()))
    }

    fn reason(&self) -> Option<String> {
        Some(match self.session.size() {
            1 => "PETSc in one process".to_owned(),
            size => format!("PETSc in {size} processes"),
        })
    }

    fn choice(&self, estimate: &Estimate) -> Choice {
        Choice::asked("iterative", estimate)
    }

    fn proves(&self, _matrix: &BlockMatrix, _layout: &Layout) -> bool {
        false
    }
}

/// A matrix whose rows are distributed, in the place of a factor.
#[derive(Debug)]
struct DistributedFactor(Arc<Shared>);

impl Factor for DistributedFactor {
    fn forward(&self, _r: &mut [f64]) -> Result<(), SolveError> {
        Ok(())
    }
    fn backward(&self, _x: &mut [f64]) -> Result<(), SolveError> {
        Ok(())
    }
    fn condensed(&self) -> Box<dyn Condensed> {
        Box::new(Distributed::new(&self.0))
    }
    fn name(&self) -> &'static str {
        "iterative"
    }
    fn stored(&self) -> usize {
        let (components, _) = self.0.kept.matrix().block_shape();
        self.0.kept.matrix().graph().pairs() * components * components
    }
}
