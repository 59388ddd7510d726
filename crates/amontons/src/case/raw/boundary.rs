//! `[[boundary]]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Component, Datum, Scalar};

/// Conditions on one side, or on an edge or on points.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Boundary {
    /// Name of the side; in a mesh file also that of an edge or of points, which take `displacement`, `force` and
    /// `temperature` alone.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub on: String,
    /// Coordinates in m of a node of the mesh, in place of `on`: conditions at one point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<Vec<f64>>,
    /// Prescribed displacement in m, one entry per component.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<Vec<Component>>,
    /// Prescribed displacement u_ν along the outward normal in m.
    ///
    /// 0 on a plane of symmetry or on rollers. The side must lie in one plane, of any direction; the support takes the
    /// normal part of a load on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal_displacement: Option<Datum>,
    /// Traction f₁ = σν in Pa, one entry per component.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub traction: Option<Vec<Datum>>,
    /// Force in N, one entry per component, spread evenly over the side.
    ///
    /// On an edge of a body in space it is spread along it, on points in equal parts. In two dimensions it is the force
    /// per unit of thickness, in N/m; on a body of revolution it acts on the whole ring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<Vec<Datum>>,
    /// Pressure p in Pa, the traction −p ν.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure: Option<Datum>,
    /// Stiffness of springs to the ground in Pa/m.
    ///
    /// One number k acts along the normal, with the traction −k u_ν ν; entries per component act with −k_i u_i.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spring: Option<Support>,
    /// Damping of dashpots to the ground in Pa s/m.
    ///
    /// One number c acts along the normal, with the traction −c u̇_ν ν; entries per component act with −c_i u̇_i.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dashpot: Option<Support>,
    /// Prescribed temperature in K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<Datum>,
    /// Heat flux into the body, −q·ν, in W/m².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heat_inflow: Option<Datum>,
    /// Heat exchange with the surroundings, −q·ν = coefficient (ambient − θ).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub convection: Option<Convection>,
    /// Names of the phases in which the entry acts; without the key it acts in all of them.
    ///
    /// A side may have several entries if no two of them act in one phase.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phases: Option<Vec<String>>,
    /// What becomes of the force that holds a prescribed displacement when it ends with a phase.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub release: Option<Releasing>,
}

/// What becomes of the force of a support that ends with a phase.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Releasing {
    /// It is gone at once, as when a clamp is opened: a shock if inertia acts. The default.
    AtOnce,
    /// It falls in proportion to time, to zero at the end of the next phase.
    Phase,
}

/// Stiffness or damping to the ground.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number or an expression in x, y, z, or one per component")]
pub(in crate::case) enum Support {
    /// Along the normal.
    Number(f64),
    /// Along the normal, an expression in x, y, z.
    Expression(String),
    /// By component.
    Components(Vec<Scalar>),
}

/// Heat exchange with the surroundings.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Convection {
    /// Heat transfer coefficient h in W/(m² K), constant in time.
    pub coefficient: Scalar,
    /// Temperature θ_a of the surroundings in K.
    #[serde(default)]
    pub ambient: Datum,
}
