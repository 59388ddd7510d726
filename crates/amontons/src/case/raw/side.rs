//! `[[side]]`.

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

/// A side that the case names: facets of the boundary by their place, by a region, or sides that have names already.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Side {
    /// Name of the side: one that neither the mesh nor an entry before has.
    pub name: String,
    /// Where its facets lie: in all places of a table; several tables add their facets. Default: anywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<Loci>,
    /// Names of the sides whose facets it takes, of the mesh or of entries before; default: the whole boundary.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub of: Vec<String>,
    /// Name of the region whose facets it takes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<String>,
}

/// One table of places, or several.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a table of places, or an array of tables")]
pub(in crate::case) enum Loci {
    /// One table.
    One(Box<Locus>),
    /// Several.
    Several(Vec<Locus>),
}

impl Loci {
    /// The tables with their paths below this one.
    pub fn each(&self) -> Vec<(String, &Locus)> {
        match self {
            Loci::One(locus) => vec![(String::new(), &**locus)],
            Loci::Several(all) => all.iter().enumerate().map(|(i, locus)| (format!("[{i}]"), locus)).collect(),
        }
    }
}

/// Where facets lie: their vertices in all the places that are given.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Locus {
    /// In a plane, in two dimensions a line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<InPlane>,
    /// In a box, in two dimensions a rectangle.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub within: Option<InBox>,
    /// On the surface of a circular cylinder, in two dimensions on a circle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cylinder: Option<OnCylinder>,
    /// On the surface of a ball.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sphere: Option<OnSphere>,
    /// Near a point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub near: Option<Near>,
    /// Where the outward normal has a direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<Facing>,
}

/// A plane.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct InPlane {
    /// A point of the plane in m, one entry per component.
    pub point: Vec<f64>,
    /// Normal of the plane, one entry per component, of either sign.
    pub normal: Vec<f64>,
}

/// A box along the axes.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct InBox {
    /// Corner with the least coordinates in m, one entry per component.
    pub from: Vec<f64>,
    /// Corner with the largest coordinates in m, one entry per component.
    pub to: Vec<f64>,
}

/// A circular cylinder.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct OnCylinder {
    /// A point of the axis in m, one entry per component; default: the origin.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub point: Vec<f64>,
    /// Direction of the axis, three entries; not given in two dimensions, where it is z.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub axis: Vec<f64>,
    /// Radius in m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
}

/// A ball.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct OnSphere {
    /// Centre in m, one entry per component.
    pub center: Vec<f64>,
    /// Radius in m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
}

/// What is near a point.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Near {
    /// The point in m, one entry per component.
    pub point: Vec<f64>,
    /// Largest distance from the point in m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub distance: f64,
}

/// A cone of directions.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Facing {
    /// The direction, one entry per component.
    pub direction: Vec<f64>,
    /// Largest angle between the outward normal and the direction in rad.
    #[serde(default = "half_a_right_angle")]
    #[schemars(transform = an_angle)]
    pub angle: f64,
}

fn half_a_right_angle() -> f64 {
    std::f64::consts::FRAC_PI_4
}

/// Asks for an angle between two directions.
fn an_angle(schema: &mut Schema) {
    if let Some(schema) = schema.as_object_mut() {
        schema.insert("minimum".to_owned(), 0.into());
        schema.insert("maximum".to_owned(), std::f64::consts::PI.into());
    }
}
