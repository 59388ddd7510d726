//! `[contact.obstacle]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Datum, Turn};

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
        /// Rotation of the obstacle.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        turning: Option<Turning>,
        /// Force that presses the obstacle against the body and determines its displacement.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        load: Option<ObstacleLoad>,
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
        /// Rotation of the obstacle.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        turning: Option<Turning>,
        /// Force that presses the obstacle against the body and determines its displacement.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        load: Option<ObstacleLoad>,
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
        /// Rotation of the obstacle.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        turning: Option<Turning>,
        /// Force that presses the obstacle against the body and determines its displacement.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        load: Option<ObstacleLoad>,
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
        /// Rotation of the obstacle.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        turning: Option<Turning>,
        /// Force that presses the obstacle against the body and determines its displacement.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        load: Option<ObstacleLoad>,
    },
    /// A solid from a file: its boundary in a mesh file, or in space a closed surface of triangles (STL).
    File {
        /// Path of the file, relative to the case file: `.stl`, or a mesh file of a body in as many dimensions.
        file: String,
        /// Factor of the coordinates of the file: 0.001 if it is in mm.
        #[serde(default = "one")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        scale: f64,
        /// Rotation of the solid about the origin of the file, before it is moved; it does not change with time.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        turn: Option<Turn>,
        /// Where the origin of the file comes to lie in m, one entry per component, numbers or expressions in t;
        /// default: the origin.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        origin: Vec<Datum>,
        /// Whether the body is inside the surface.
        #[serde(default)]
        inside: bool,
        /// Configuration of the body in which distances and normals are evaluated.
        #[serde(default)]
        geometry: Geometry,
        /// Rotation of the obstacle.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        turning: Option<Turning>,
        /// Force that presses the obstacle against the body and determines its displacement.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        load: Option<ObstacleLoad>,
    },
    /// The zero level of a function of x, y, z, t.
    Surface {
        /// Expression in x, y, z, t that is positive outside the obstacle and negative inside. It need not be a
        /// distance.
        level: String,
        /// Configuration of the body in which distances and normals are evaluated.
        #[serde(default)]
        geometry: Geometry,
        /// Rotation of the obstacle.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        turning: Option<Turning>,
        /// Force that presses the obstacle against the body and determines its displacement.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        load: Option<ObstacleLoad>,
    },
}

impl Obstacle {
    /// The data common to all shapes.
    pub fn common(&self) -> (Geometry, Option<&Turning>, Option<&ObstacleLoad>) {
        match self {
            Obstacle::Plane { geometry, turning, load, .. }
            | Obstacle::Sphere { geometry, turning, load, .. }
            | Obstacle::Cylinder { geometry, turning, load, .. }
            | Obstacle::Wave { geometry, turning, load, .. }
            | Obstacle::File { geometry, turning, load, .. }
            | Obstacle::Surface { geometry, turning, load, .. } => (*geometry, turning.as_ref(), load.as_ref()),
        }
    }
}

/// Rotation of an obstacle. Friction sees the velocity ω × r of its surface, even if the surface keeps its place, as
/// for a roller about its axis or a plane about its normal.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Turning {
    /// Angle in rad, a number, an expression in t or a table in time.
    pub angle: Datum,
    /// Direction of the axis, three entries, by the right-hand rule; not given in two dimensions, where it is z.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub axis: Vec<f64>,
    /// A point of the axis in m, one entry per component, numbers or expressions in t; default: `point`, `center` or
    /// `origin` of the obstacle, moving with it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<Vec<Datum>>,
}

/// Force that presses an obstacle, which is guided along its direction.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct ObstacleLoad {
    /// Force in N along `direction`, per unit of thickness in two dimensions: a number, an expression in t or a table
    /// in time.
    pub force: Datum,
    /// Direction in which the force acts and the obstacle moves, one entry per component.
    pub direction: Vec<f64>,
    /// Mass of the obstacle in kg, per unit of thickness in two dimensions; 0, the default: the obstacle is in
    /// equilibrium at each time.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub mass: f64,
}

fn one() -> f64 {
    1.0
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
