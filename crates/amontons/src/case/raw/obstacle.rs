//! `[contact.obstacle]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Datum;

/// A rigid foundation by its shape. It may move as a whole: points and centres are data in time.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "shape", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Obstacle {
    /// The half-space below a plane.
    Plane {
        /// A point of the plane in m, one entry a component, numbers or expressions in t.
        point: Vec<Datum>,
        /// Normal out of the obstacle, one entry a component.
        normal: Vec<f64>,
        /// Where distances and normals are taken.
        #[serde(default)]
        geometry: Geometry,
    },
    /// A ball, or with `inside` a socket; in two dimensions a disc.
    Sphere {
        /// Centre in m, one entry a component, numbers or expressions in t.
        center: Vec<Datum>,
        /// Radius in m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
        /// Whether the body is within.
        #[serde(default)]
        inside: bool,
        /// Where distances and normals are taken.
        #[serde(default)]
        geometry: Geometry,
    },
    /// A cylinder without ends, or with `inside` a bore; in two dimensions a disc.
    Cylinder {
        /// A point of the axis in m, one entry a component, numbers or expressions in t.
        center: Vec<Datum>,
        /// Direction of the axis, three entries; left out in two dimensions, where it is z.
        #[serde(default)]
        axis: Vec<f64>,
        /// Radius in m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
        /// Whether the body is within.
        #[serde(default)]
        inside: bool,
        /// Where distances and normals are taken.
        #[serde(default)]
        geometry: Geometry,
    },
    /// What is below the wavy surface n·(x − p) = amplitude · cos(2π d·(x − p)/wavelength).
    Wave {
        /// The point p in m, below a crest, one entry a component, numbers or expressions in t.
        point: Vec<Datum>,
        /// Normal n of the mean plane out of the obstacle, one entry a component.
        normal: Vec<f64>,
        /// Direction d of the wave, one entry a component, of which the part across the normal counts.
        direction: Vec<f64>,
        /// Amplitude in m: half of what crests are above troughs.
        amplitude: f64,
        /// Wavelength in m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        wavelength: f64,
        /// Where distances and normals are taken.
        #[serde(default)]
        geometry: Geometry,
    },
    /// The zero level of a function of x, y, z, t.
    Surface {
        /// Expression in x, y, z, t that is positive outside the obstacle and negative inside; it need not be a distance.
        level: String,
        /// Where distances and normals are taken.
        #[serde(default)]
        geometry: Geometry,
    },
}

/// Where distances and normals are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Geometry {
    /// At the points of the body as it was at first: for displacements that are small beside the radii of the obstacle.
    #[default]
    Reference,
    /// At the points displaced, anew in each step.
    Updated,
}
