//! `[verify]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Reference values that make a case a benchmark.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Verify {
    /// What the benchmark shows, in one line.
    pub title: String,
    /// Source of the reference values.
    pub source: String,
    /// Values to compare.
    pub check: Vec<Check>,
}

/// A value to compare.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Check {
    /// A field at a point, on a side or in a region at one time, interpolated in space and time.
    Probe {
        /// The field, one number.
        #[schemars(transform = super::probe::numbers)]
        field: String,
        /// The point in m, one entry per coordinate.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(length(min = 1, max = 3))]
        at: Option<Vec<f64>>,
        /// Name of the side.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        on: Option<String>,
        /// Name of the contact whose points are read, in the place of `on` or besides `at`, where a side has several.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        contact: Option<String>,
        /// Name of the region.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        region: Option<String>,
        /// Reduction of the values on the side, of the contact or in the region.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        take: Option<super::Over>,
        /// The point in m about which a moment is taken, one entry per coordinate.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(length(min = 1, max = 3))]
        about: Option<Vec<f64>>,
        /// The time in s.
        time: f64,
        /// Reference value.
        reference: f64,
        /// Tolerance relative to the reference, or to `scale` if given.
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
        /// Magnitude to which the tolerance is relative.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        scale: Option<f64>,
    },
    /// A column of history.csv at one time, or its extreme over all times.
    History {
        /// The column.
        column: String,
        /// The time in s, interpolated.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        time: Option<f64>,
        /// Which value is taken if no time is given.
        #[serde(default)]
        take: Take,
        /// Reference value.
        reference: f64,
        /// Tolerance relative to the reference, or to `scale` if given.
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
        /// Magnitude to which the tolerance is relative.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        scale: Option<f64>,
    },
    /// The least-squares order of an error against `[exact]`.
    Order {
        /// What is refined.
        #[serde(default)]
        vary: Vary,
        /// Cells per side of the levels, or numbers of steps if time is refined.
        levels: Vec<usize>,
        /// Power p in: number of steps = steps of the case · (level / cells of the case)^p.
        #[serde(default = "one")]
        #[schemars(range(min = 1, max = 2))]
        power: u32,
        /// The error.
        error: ErrorName,
        /// Expected order.
        reference: f64,
        /// Tolerance of the order.
        #[serde(default = "tenth")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
    },
    /// A mode of the state at the end, as `[stability]` asks for it.
    Mode {
        /// Its number in the table of `amontons modes`.
        #[schemars(range(min = 1))]
        mode: usize,
        /// Which value of it.
        of: ModeValue,
        /// Reference value.
        reference: f64,
        /// Tolerance relative to the reference, or to `scale` if given.
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
        /// Magnitude to which the tolerance is relative.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        scale: Option<f64>,
    },
    /// An error against `[exact]` on the mesh and with the steps of the case.
    Error {
        /// The error.
        error: ErrorName,
        /// Reference value.
        reference: f64,
        /// Tolerance relative to the reference, or to `scale` if given.
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
        /// Magnitude to which the tolerance is relative.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        scale: Option<f64>,
    },
}

/// A value of a mode.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum ModeValue {
    /// Growth Re λ in 1/s.
    Growth,
    /// Frequency Im λ/2π in Hz.
    Frequency,
}

/// Which value of a column is taken.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Take {
    /// The last.
    #[default]
    Last,
    /// The smallest.
    Min,
    /// The largest.
    Max,
}

/// What a study refines.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Vary {
    /// Mesh and step together.
    #[default]
    Both,
    /// The mesh.
    Space,
    /// The step.
    Time,
}

/// An error of a study, the maximum over time.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(in crate::case) enum ErrorName {
    /// ‖w − w^{hk}‖_H.
    ErrorW,
    /// ‖ε(u − u^{hk})‖.
    ErrorU,
    /// ‖θ − θ^{hk}‖_{L²}.
    ErrorTheta,
    /// ‖u − u^{hk}‖_H.
    ErrorUH,
    /// E^{hk} of (5.2).
    Error,
}

fn one() -> u32 {
    1
}

fn tenth() -> f64 {
    0.1
}
