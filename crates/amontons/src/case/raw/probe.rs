//! `[[probe]]`.

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::output::{Quantity, Selection};

/// A number, or the components of a vector or tensor, that is recorded after every step.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Probe {
    /// Name of the probe: its columns in probes.csv begin with it.
    pub name: String,
    /// Quantity that is recorded.
    #[schemars(transform = quantities)]
    pub quantity: String,
    /// The point in m, one entry per coordinate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1, max = 3))]
    pub at: Option<Vec<f64>>,
    /// Name of the side; of a reaction also of an edge or of points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<String>,
    /// Name of the contact whose points are read, in the place of `on` or besides `at`, where a side has several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<String>,
    /// Name of the region.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<String>,
    /// Reduction of the values on the side, of the contact or in the region.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub take: Option<Over>,
    /// The point in m about which a moment is taken, one entry per coordinate; default: `at` of the rigid part on this
    /// side, if given, else the centre of the side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1, max = 3))]
    pub about: Option<Vec<f64>>,
}

/// Reduction of the values on a side or in a region, component by component.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Over {
    /// The mean: the integral divided by the length, area or volume.
    Mean,
    /// The largest value at a node.
    Max,
    /// The smallest value at a node.
    Min,
    /// The integral.
    Integral,
}

/// The names of all quantities.
fn quantities(schema: &mut Schema) {
    name_quantities(schema, |_| true);
}

/// The names of quantities that are one number in every body.
pub(super) fn numbers(schema: &mut Schema) {
    name_quantities(schema, |quantity| quantity.part != Selection::All || quantity.columns(3).len() == 1);
}

fn name_quantities(schema: &mut Schema, wanted: impl Fn(Quantity) -> bool) {
    let names: Vec<String> = Quantity::all().filter(|(_, quantity)| wanted(*quantity)).map(|(name, _)| name).collect();
    schema.insert("enum".to_owned(), names.into());
    schema.insert(
        "title".to_owned(),
        "the name of a quantity, such as \"displacement_x\", \"temperature\", \"stress_xx\" or \"von_mises\"".into(),
    );
}
