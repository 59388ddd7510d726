//! Ending work early.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::error::SolveError;

/// Whether work is to end.
#[derive(Debug, Clone, Default)]
pub(super) struct StopFlag {
    flag: Option<Arc<AtomicBool>>,
    /// How often the flag has been looked at.
    looks: Arc<AtomicUsize>,
}

impl StopFlag {
    /// When the flag becomes true.
    pub fn when(flag: &Arc<AtomicBool>) -> StopFlag {
        StopFlag { flag: Some(Arc::clone(flag)), looks: Arc::default() }
    }

    /// An error if the work is to end.
    pub fn go_on(&self) -> Result<(), SolveError> {
        self.looks.fetch_add(1, Ordering::Relaxed);
        let is_set = self.flag.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed));
        if is_set { Err(SolveError::Interrupted) } else { Ok(()) }
    }

    /// How often it was asked.
    #[cfg(test)]
    pub fn looks(&self) -> usize {
        self.looks.load(Ordering::Relaxed)
    }
}
