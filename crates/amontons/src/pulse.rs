//! Where a step is, for whoever watches it from another thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Counts within the present step. Clones share them.
#[derive(Clone, Debug, Default)]
pub struct Pulse(Arc<PulseCounts>);

#[derive(Debug, Default)]
struct PulseCounts {
    iterations: AtomicUsize,
    parts: AtomicUsize,
}

impl Pulse {
    /// Iterations on Γ_C since the step began, of all its parts.
    #[must_use]
    pub fn iterations(&self) -> usize {
        self.0.iterations.load(Ordering::Relaxed)
    }

    /// Attempts at the step and at its parts: 1, or more where it is made in halves.
    #[must_use]
    pub fn parts(&self) -> usize {
        self.0.parts.load(Ordering::Relaxed)
    }

    pub(crate) fn begin_step(&self) {
        self.0.iterations.store(0, Ordering::Relaxed);
        self.0.parts.store(0, Ordering::Relaxed);
    }

    pub(crate) fn begin_part(&self) {
        self.0.parts.fetch_add(1, Ordering::Relaxed);
    }

    pub(crate) fn iterate(&self) {
        self.0.iterations.fetch_add(1, Ordering::Relaxed);
    }
}
