//! The search for modes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What `amontons modes` looks for at the end of the run: modes (u′, θ′) exp(λt) of the state there.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Stability {
    /// What is perturbed; if left out, squeal in a case with a density, else thermal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<StabilityKind>,
    /// Number of modes: those of lowest frequency, or of hot spots those of largest growth; of a sector per number of
    /// waves.
    #[serde(default = "six")]
    #[schemars(range(min = 1, max = 1000))]
    pub count: usize,
    /// Least and largest frequency in Hz: all modes between them in place of `count` of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 0.0)))]
    pub frequency: Option<[f64; 2]>,
    /// Least and largest growth in 1/s: all modes between them in place of `count` of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growth: Option<[f64; 2]>,
    /// Numbers of waves around a body of which the mesh is a sector, in both senses; if left out, 0 to half the number
    /// of sectors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub waves: Option<Vec<usize>>,
}

fn six() -> usize {
    6
}

impl Default for Stability {
    fn default() -> Stability {
        Stability { kind: None, count: six(), frequency: None, growth: None, waves: None }
    }
}

/// What is perturbed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum StabilityKind {
    /// The motion with its inertia, at the temperature of the state.
    Squeal,
    /// Temperature, and motion without inertia: hot spots.
    Thermal,
    /// Temperature, and motion with its inertia.
    Coupled,
}
