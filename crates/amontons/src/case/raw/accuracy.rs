//! The accuracy that is asked for.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What `amontons run` refines cells and steps for: numbers at the end of the run with error bars.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Accuracy {
    /// The numbers: names of probes, or of columns of `history.csv` and `probes.csv`.
    pub of: Vec<String>,
    /// The largest bar of each, relative to it; of a vector relative to its largest component.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub relative: f64,
    /// True in the case of results that were refined: it is run as it is.
    #[serde(default, skip_serializing_if = "is_false")]
    pub refined: bool,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_false(value: &bool) -> bool {
    !*value
}
