//! Automatic choice of the backend: the one predicted to take less time, if it fits into memory. An iteration that
//! takes more work than a factor would have is replaced by the factor ([`super::relief`]).

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::error::SolveError;
use super::estimate::{Choice, Decided, Estimate, Workload};
use super::factor::{Backend, Factor, has_factor};
use super::graph::Graph;
use super::multigrid::Multigrid;
use super::relief::Relief;
use super::sparse::BlockMatrix;
use super::stop::StopFlag;
use super::supernodal::Interruptible;
use super::unknowns::{Layout, Unknowns};
use crate::machine;

/// Backend that solves with a factor or an iteration, whichever is predicted to take less time.
#[derive(Debug, Clone, Default)]
pub struct Automatic {
    direct: Interruptible,
    multigrid: Multigrid,
    work: Workload,
    before: Arc<[Decided]>,
}

impl Automatic {
    /// Creates the backend for an expected workload.
    #[must_use]
    pub fn for_work(work: Workload) -> Automatic {
        Automatic { work, ..Automatic::default() }
    }
}

impl Backend for Automatic {
    fn choice(&self, estimate: &Estimate) -> Choice {
        Choice::new(estimate, &self.work, machine::memory().map(|memory| memory.bytes))
    }

    fn order(&self, matrix: &BlockMatrix, layout: &Layout) -> Unknowns {
        let graph: &Graph = matrix.graph();
        let ordering = layout.ordering(graph);
        let estimate = Estimate::of(graph, layout.free, layout.components, &ordering);
        let choice = match self.before.iter().find(|decided| decided.components == layout.components) {
            Some(decided) => Choice::again(decided, &estimate, &self.work),
            None => self.choice(&estimate),
        };
        let unknowns = if choice.is_direct() {
            Unknowns::ordered(&ordering, layout)
        } else {
            self.multigrid.order(matrix, layout)
        };
        let relief = || Arc::new(Relief::new(&estimate, self.work.joins, layout.leading_contact()));
        let relief = choice.may_change.then(relief);
        Unknowns { choice: Some(Arc::new(choice)), relief, ..unknowns }
    }

    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError> {
        if unknowns.choice.as_ref().is_none_or(|choice| choice.is_direct()) {
            self.direct.factorize(matrix, unknowns)
        } else {
            self.multigrid.factorize(matrix, unknowns)
        }
    }

    fn interruptible(&self, flag: &Arc<AtomicBool>) -> Option<Arc<dyn Backend>> {
        let (direct, multigrid) = (Interruptible(StopFlag::when(flag)), Multigrid::stopped_by(flag));
        Some(Arc::new(Automatic { direct, multigrid, work: self.work, before: Arc::clone(&self.before) }))
    }

    fn decided(&self, before: &[Decided]) -> Option<Arc<dyn Backend>> {
        Some(Arc::new(Automatic { before: before.into(), ..self.clone() }))
    }

    fn proves(&self, matrix: &BlockMatrix, layout: &Layout) -> bool {
        proof(matrix.graph(), layout).is_some()
    }

    fn is_positive_definite(&self, matrix: &Arc<BlockMatrix>, layout: &Layout) -> Result<bool, SolveError> {
        match proof(matrix.graph(), layout) {
            Some(unknowns) => has_factor(self.direct.factorize(&layout.matrix(matrix), &unknowns)),
            None => self.multigrid.is_positive_definite(matrix, &Layout { contact: &[], ..*layout }),
        }
    }
}

/// Elimination order for a factor without contact, or `None` if an iteration is predicted to take less time.
fn proof(graph: &Graph, layout: &Layout) -> Option<Unknowns> {
    let layout = Layout { contact: &[], ..*layout };
    let graph = layout.graph(graph);
    let ordering = layout.ordering(&graph);
    // Definiteness follows from the factorization; no system is solved.
    let work = Workload { steps: 1.0, ..Workload::default() };
    let estimate = Estimate::of(&graph, layout.free, layout.components, &ordering);
    let choice = Choice::new(&estimate, &work, machine::memory().map(|memory| memory.bytes));
    choice.is_direct().then(|| Unknowns::ordered(&ordering, &layout))
}
