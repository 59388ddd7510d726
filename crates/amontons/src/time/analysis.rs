//! What of the equations acts in a phase.

use serde::{Deserialize, Serialize};

/// The equations of a phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Analysis {
    /// With inertia.
    #[default]
    Dynamic,
    /// Without the inertia term of (2.3): the body is in balance at the end of each step.
    Quasistatic,
    /// Without all that depends on a rate: the body is in balance and heat flows as it always will, in the state that
    /// the data at the end of each step would lead to if they lasted.
    Steady,
}

impl Analysis {
    /// Its name in the case file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Analysis::Dynamic => "dynamic",
            Analysis::Quasistatic => "quasistatic",
            Analysis::Steady => "steady",
        }
    }

    /// True if inertia acts.
    #[must_use]
    pub fn has_inertia(self) -> bool {
        self == Analysis::Dynamic
    }
}
