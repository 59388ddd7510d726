//! The case file as it is written: types that mirror the TOML key by key.
//!
//! Their doc comments, ranges and defaults are the JSON Schema of the file, which the check in
//! [`super::check`] walks: a key is described here and nowhere else. The first paragraph of a
//! comment goes into messages, so it starts with what the number is and names its unit.

mod boundary;
mod contact;
mod data;
mod material;
mod mesh;
mod obstacle;
mod probe;
mod verify;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(in crate::case) use boundary::{Boundary, Support};
pub(in crate::case) use contact::{Contact, Contacts, Foundation, Friction, HeatTerm, Normal, Quadrature, Wear};
pub(in crate::case) use data::{Column, Component, Datum, Extend, Scalar, TableData};
pub(in crate::case) use material::{Branch, Dilatation, Elasticity, Material, Orientation, Region, StressState, Tensor, Viscosity};
pub(in crate::case) use mesh::{Diagonal, Elements, Mesh};
pub(in crate::case) use obstacle::{Geometry, Obstacle};
pub(in crate::case) use probe::{Over, Probe};
pub(in crate::case) use verify::{Check, ErrorName, Take, Vary, Verify};

/// A contact problem of a thermo-viscoelastic body with friction and heat.
///
/// Numbers are in SI units, or without units throughout: `units = "dimensionless"`.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Case file of amontons")]
pub(in crate::case) struct Case {
    /// Name of the case, also of its results folder.
    pub name: String,
    /// Units of all numbers: SI, or none. It decides what summary and pictures write behind a number.
    #[serde(default)]
    pub units: Units,
    /// The mesh of the body.
    pub mesh: Mesh,
    /// The time interval (0, end) and its steps.
    pub time: Time,
    /// The material of the body, but for regions with their own.
    pub material: Material,
    /// Regions of the mesh with materials of their own, one entry a region.
    #[serde(default)]
    pub region: Vec<Region>,
    /// Loads in the body.
    #[serde(default)]
    pub load: Load,
    /// Conditions on the sides, one entry a side.
    ///
    /// A side without a displacement and without a traction is free; a side without a temperature
    /// and without a heat inflow is insulated.
    #[serde(default)]
    pub boundary: Vec<Boundary>,
    /// Contact of a side with its foundation, or of several sides, one entry a side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<Contacts>,
    /// State at t = 0.
    #[serde(default)]
    pub initial: Initial,
    /// The time-stepping scheme.
    #[serde(default)]
    pub scheme: Scheme,
    /// What is written during a run.
    #[serde(default)]
    pub output: Output,
    /// Numbers read off the run after every step, one entry a probe: probes.csv.
    #[serde(default)]
    pub probe: Vec<Probe>,
    /// Values that a run of the case must give.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected: Option<Expected>,
    /// A solution in closed form, for studies of the error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exact: Option<Exact>,
    /// What makes the case a benchmark.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verify: Option<Verify>,
}

/// Units of a case.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
pub(in crate::case) enum Units {
    /// SI units: m, s, kg, K.
    #[default]
    #[serde(rename = "SI")]
    Si,
    /// Numbers without units.
    #[serde(rename = "dimensionless")]
    Dimensionless,
}

/// Time.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Time {
    /// End of the time interval in s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub end: f64,
    /// Number of equal time steps.
    #[schemars(range(min = 1, max = 1_000_000_000))]
    pub steps: usize,
}

/// Loads.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Load {
    /// Body force f₀ in N/m³, one entry a component; empty for zero.
    #[serde(default)]
    pub body_force: Vec<Datum>,
    /// Heat source q₀ in W/m³.
    #[serde(default)]
    pub heat_source: Datum,
}

/// State at t = 0: (2.11). The expressions do not use t.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Initial {
    /// Displacement u₀ in m, one entry a component; empty for zero.
    #[serde(default)]
    pub displacement: Vec<Scalar>,
    /// Velocity in m/s, one entry a component; empty for zero.
    #[serde(default)]
    pub velocity: Vec<Scalar>,
    /// Temperature θ₀ in K.
    #[serde(default)]
    pub temperature: Scalar,
}

/// The time-stepping scheme: backward Euler.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Scheme {
    /// How mechanics and heat are coupled within a step.
    #[serde(default)]
    pub coupling: Coupling,
}

/// How mechanics and heat are coupled within a step.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Coupling {
    /// One after the other, with the temperature and the displacement of the step before in the coupling terms.
    #[default]
    Staggered,
    /// With those of the step itself, by iterating the two half-steps; it may fail to settle where they act strongly on each other.
    FixedPoint,
    /// With those of the step itself, by Newton's method for both together.
    Monolithic,
}

/// What is written during a run.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::case) struct Output {
    /// Steps between field snapshots; 0: only the last.
    pub every: usize,
    /// Fields of the snapshots besides displacement, velocity, temperature, von Mises stress and region.
    pub fields: Vec<OutputField>,
}

impl Default for Output {
    fn default() -> Output {
        Output { every: 0, fields: vec![OutputField::Stress] }
    }
}

/// A field of the snapshots.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum OutputField {
    /// Stress of the cells.
    Stress,
    /// Strain of the cells.
    Strain,
    /// Principal stresses of the cells with their directions.
    Principal,
    /// Heat flux of the cells.
    HeatFlux,
    /// Stress at the nodes, recovered from the cells.
    NodalStress,
}

/// Values that a run of the case must give.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Expected {
    /// Allowed deviation, relative to the largest magnitude in the value.
    #[serde(default = "tolerance")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub tolerance: f64,
    /// The values by their dotted path in summary.json, such as "final.temperature_max".
    pub values: BTreeMap<String, Values>,
}

/// A solution in closed form. Its velocity is the time derivative of the displacement.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Exact {
    /// Displacement in m, one entry a component.
    pub displacement: Vec<Scalar>,
    /// Temperature in K.
    pub temperature: Scalar,
}

/// A value of a summary.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number or an array of numbers")]
pub(in crate::case) enum Values {
    /// A number.
    One(f64),
    /// An array, one entry a component.
    Several(Vec<f64>),
}

fn tolerance() -> f64 {
    1e-8
}
