//! The phases of a run.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A phase of the run.
///
/// A phase begins where the one before ends; the first one begins at t = 0. State, wear, heat and contact go on from
/// phase to phase.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct RunPhase {
    /// Name of the phase: a letter, then letters, digits, `-` and `_`.
    pub name: String,
    /// Time at the end of the phase in s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub end: f64,
    /// Number of equal time steps of the phase.
    #[schemars(range(min = 1, max = 1_000_000_000))]
    pub steps: usize,
    /// Whether inertia acts in the phase.
    #[serde(default)]
    pub analysis: PhaseAnalysis,
}

/// Whether inertia acts in a phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum PhaseAnalysis {
    /// Inertia acts. A dynamic phase behind a quasistatic one starts at rest.
    #[default]
    Dynamic,
    /// Inertia does not act: the body is in balance at the end of each step, by backward Euler in every scheme.
    Quasistatic,
}
