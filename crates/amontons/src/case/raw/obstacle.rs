//! `[contact.obstacle]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Datum;

/// Shape of a rigid foundation. It may move as a whole: its points and centres may depend on time.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "shape", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Obstacle {
    /// The half-space below a plane.
    Plane {
        /// A point of the plane in m, one entry per component, numbers or expressions in t.
        point: Vec<Datum>,
        /// Outward normal of the obstacle, one entry per component.
        normal: Vec<f64>,
        /// Configuration of the body in which distances and normals are evaluated.
        #[serde(default)]
        geometry: Geometry,
    },
    /// A ball, or a socket if `inside` is true; a disc in two dimensions.
    Sphere {
        /// Centre in m, one entry per component, numbers or expressions in t.
        center: Vec<Datum>,
        /// Radius in m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
        /// Whether the body is inside the surface.
        #[serde(default)]
        inside: bool,
        /// Configuration of the body in which distances and normals are evaluated.
        #[serde(default)]
        geometry: Geometry,
    },
    /// An infinite cylinder, or a bore if `inside` is true; a disc in two dimensions.
    Cylinder {
        /// A point of the axis in m, one entry per component, numbers or expressions in t.
        center: Vec<Datum>,
        /// Direction of the axis, three entries; not given in two dimensions, where it is z.
        #[serde(default)]
        axis: Vec<f64>,
        /// Radius in m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
        /// Whether the body is inside the surface.
        #[serde(default)]
        inside: bool,
        /// Configuration of the body in which distances and normals are evaluated.
        #[serde(default)]
        geometry: Geometry,
    },
    /// The region below the wavy surface n·(x − p) = amplitude · cos(2π d·(x − p)/wavelength).
    Wave {
        /// The point p in m, below a crest, one entry per component, numbers or expressions in t.
        point: Vec<Datum>,
        /// Outward normal n of the mean plane, one entry per component.
        normal: Vec<f64>,
        /// Direction d of the wave, one entry per component; only its part perpendicular to the normal is used.
        direction: Vec<f64>,
        /// Amplitude in m: half the height of the crests above the troughs.
        amplitude: f64,
        /// Wavelength in m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        wavelength: f64,
        /// Configuration of the body in which distances and normals are evaluated.
        #[serde(default)]
        geometry: Geometry,
    },
    /// The zero level of a function of x, y, z, t.
    Surface {
        /// Expression in x, y, z, t that is positive outside the obstacle and negative inside. It need not be a
        /// distance.
        level: String,
        /// Configuration of the body in which distances and normals are evaluated.
        #[serde(default)]
        geometry: Geometry,
    },
}

/// Configuration of the body in which distances and normals are evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Geometry {
    /// The undeformed body: for displacements that are small compared with the radii of the obstacle.
    #[default]
    Reference,
    /// The displaced body, updated in each step.
    Updated,
}
