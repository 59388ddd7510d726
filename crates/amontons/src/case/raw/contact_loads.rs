//! Parts of a contact besides its laws: a foundation that warms up, the preload of a bolt, a fluid.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Datum;

/// A fluid beside a contact, as on the pressure side of a seal.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Fluid {
    /// Its pressure in Pa, besides the pressure of the sides on each other.
    pub pressure: Datum,
    /// Name of the side, edge or points at which it stands before the contact: they meet the side `on` or `with` there.
    pub from: String,
    /// Name of the side, edge or points that it should not reach: a leak through the contact to it is reported.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub to: String,
    /// Contact pressure in Pa above which a point keeps it out, as rough faces need it; default: every point that is
    /// pressed does.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub sealed_above: f64,
}

/// The preload of a bolt that is cut at a section and tied there.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Preload {
    /// Tension of the section in N, per unit of thickness in two dimensions, while it is tightened: a number, an
    /// expression in t or a table in time.
    pub force: Datum,
    /// Time in s up to which the section is tightened; after that its sides stay where they are on each other.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub until: f64,
}

/// A foundation with one temperature, heated through the contact and by friction.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Foundation {
    /// Heat capacity of the foundation in J/K, per unit of thickness in two dimensions.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub heat_capacity: f64,
    /// Temperature at t = 0 in K; default: `heat.foundation_temperature` at t = 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<f64>,
    /// Heat transfer to the surroundings in W/K, per unit of thickness in two dimensions.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub exchange: f64,
    /// Temperature of the surroundings in K, a number or an expression in t; default: the temperature at t = 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surroundings: Option<Datum>,
}
