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
    /// Number of equal time steps of the phase, or "auto" for steps that follow from the accuracy.
    ///
    /// In a steady phase 1 if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-required-unless-steady" = true))]
    pub steps: Option<StepNumber>,
    /// Accuracy of steps that are "auto", if it is another than that of `[time]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 0.1))]
    pub accuracy: Option<f64>,
    /// What of the equations acts in the phase.
    #[serde(default)]
    pub analysis: PhaseAnalysis,
}

/// Number of time steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "an integer ≥ 1 and ≤ 1000000000, or \"auto\"")]
pub(in crate::case) enum StepNumber {
    /// So many equal steps.
    Equal(#[schemars(range(min = 1, max = 1_000_000_000))] usize),
    /// Steps that follow from the accuracy.
    Chosen(ChosenByProgram),
}

/// Said of what the program chooses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum ChosenByProgram {
    /// The program chooses.
    Auto,
}

/// What of the equations acts in a phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum PhaseAnalysis {
    /// All of them. A dynamic phase behind one of another kind starts at rest.
    #[default]
    Dynamic,
    /// Inertia does not act: the body is in balance at the end of each step, by backward Euler in every scheme.
    Quasistatic,
    /// Nothing that depends on a rate acts: each step leads to the state that the data at its end would lead to if they
    /// lasted, with the heat of friction of foundations that slide.
    Steady,
}

impl PhaseAnalysis {
    /// Its name in the case file, with quotation marks.
    pub fn quoted(self) -> &'static str {
        match self {
            PhaseAnalysis::Dynamic => "\"dynamic\"",
            PhaseAnalysis::Quasistatic => "\"quasistatic\"",
            PhaseAnalysis::Steady => "\"steady\"",
        }
    }
}
