//! `[[cyclic]]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Cyclic symmetry: the body is one of the equal sectors that make a wheel, and all sectors do the same.
///
/// All fields on the second side are those on the first one, turned about the axis by 360° over the number of sectors,
/// which follows from the sides. Both sides have the same mesh, one turned. Loads, prescribed values, foundations and
/// materials are taken to be the same in every sector, turned.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Cyclic {
    /// Names of the two sides along which the sector meets its neighbours. They bear no conditions and no contact.
    pub sides: [String; 2],
    /// A point of the axis in m, one entry per component; default: the origin.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub center: Vec<f64>,
    /// Direction of the axis, three entries; not given in two dimensions, where it is z.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub axis: Vec<f64>,
}
