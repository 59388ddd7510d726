//! Ending work early.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::error::SolveError;

/// Request to end the work, shared between threads.
#[derive(Debug, Clone, Default)]
pub(super) struct StopFlag {
    flag: Option<Arc<AtomicBool>>,
    /// Number of times the flag has been read.
    looks: Arc<AtomicUsize>,
}

impl StopFlag {
    /// Stops when the flag becomes true.
    pub fn when(flag: &Arc<AtomicBool>) -> StopFlag {
        StopFlag { flag: Some(Arc::clone(flag)), looks: Arc::default() }
    }

    /// Returns an error if the work is to end.
    pub fn go_on(&self) -> Result<(), SolveError> {
        self.looks.fetch_add(1, Ordering::Relaxed);
        let is_set = self.flag.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed));
        if is_set { Err(SolveError::Interrupted) } else { Ok(()) }
    }

    /// Number of times the flag has been read.
    #[cfg(test)]
    pub fn looks(&self) -> usize {
        self.looks.load(Ordering::Relaxed)
    }
}
