//! The phases in which something acts.

use super::phase::TimePhase;

/// The part of a run in which a condition acts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum During {
    /// The whole run.
    #[default]
    Run,
    /// The phases of these names.
    Phases(Vec<String>),
}

impl During {
    /// No part of the run.
    pub(crate) const NEVER: During = During::Phases(Vec::new());

    /// The phases of these names.
    pub fn phases(names: impl IntoIterator<Item = impl Into<String>>) -> During {
        During::Phases(names.into_iter().map(Into::into).collect())
    }

    /// True if it has a phase.
    #[must_use]
    pub fn has(&self, phase: &TimePhase) -> bool {
        match self {
            During::Run => true,
            During::Phases(names) => names.contains(&phase.name),
        }
    }
}
