//! Whether inertia acts.

use serde::{Deserialize, Serialize};

/// The equations of motion of a phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Analysis {
    /// With inertia.
    #[default]
    Dynamic,
    /// Without the inertia term of (2.3): the body is in balance at the end of each step.
    Quasistatic,
}

impl Analysis {
    /// Its name in the case file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Analysis::Dynamic => "dynamic",
            Analysis::Quasistatic => "quasistatic",
        }
    }
}
