//! The case file as it is written: types that mirror the TOML key by key.
//!
//! Their doc comments, ranges and defaults are the JSON Schema of the file, which the check in
//! [`super::check`] walks: a key is described here and nowhere else. The first paragraph of a
//! comment goes into messages, so it starts with what the number is and names its unit.

use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

/// A contact problem of a thermo-viscoelastic body with friction and heat.
///
/// SI units; a case may also be dimensionless throughout.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Case file of amontons")]
pub(super) struct Case {
    /// Name of the case, also of its results folder.
    pub name: String,
    /// The mesh of the body.
    pub mesh: Mesh,
    /// The time interval (0, end) and its steps.
    pub time: Time,
    /// The material of the body.
    pub material: Material,
    /// Loads in the body.
    #[serde(default)]
    pub load: Load,
    /// Conditions on the sides, one entry a side.
    ///
    /// A side without a displacement and without a traction is free; a side without a temperature
    /// and without a heat inflow is insulated.
    #[serde(default)]
    pub boundary: Vec<Boundary>,
    /// Contact with a foundation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<Contact>,
    /// State at t = 0.
    #[serde(default)]
    pub initial: Initial,
    /// The time-stepping scheme.
    #[serde(default)]
    pub scheme: Scheme,
    /// What is written during a run.
    #[serde(default)]
    pub output: Output,
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

/// A number or an expression.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number or an expression in x, y, z, t")]
pub(super) enum Scalar {
    /// The same value everywhere and always.
    Number(f64),
    /// An expression in x, y, z, t, such as "sin(pi*x)*exp(-t)".
    Expression(String),
}

impl Default for Scalar {
    fn default() -> Scalar {
        Scalar::Number(0.0)
    }
}

/// A symmetric tensor.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number or a symmetric matrix [[…], […]]")]
pub(super) enum Tensor {
    /// That multiple of the identity.
    Multiple(f64),
    /// The components, row by row.
    Matrix(Vec<Vec<f64>>),
}

/// The mesh by its kind.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Mesh {
    /// The rectangle (0, size₀) × (0, size₁) of squares cut into triangles; its sides are named
    /// left, right, bottom and top.
    Rectangle {
        /// Lengths of the sides in m.
        #[schemars(transform = positive_items)]
        size: [f64; 2],
        /// Cells per side.
        n: Cells,
        /// How the squares are cut.
        #[serde(default)]
        diagonal: Diagonal,
    },
}

/// Numbers of cells.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "an integer ≥ 1 or two of them, [nx, ny]")]
pub(super) enum Cells {
    /// The same number in both directions.
    Same(#[schemars(range(min = 1))] usize),
    /// A number a direction.
    Each(#[schemars(inner(range(min = 1)))] [usize; 2]),
}

/// How the squares of a mesh are cut into triangles.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Diagonal {
    /// From lower left to upper right: /.
    #[default]
    Right,
    /// From upper left to lower right: \.
    Left,
    /// Both: ×.
    Crossed,
}

/// Time.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Time {
    /// End of the time interval in s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub end: f64,
    /// Number of equal time steps.
    #[schemars(range(min = 1, max = 1_000_000_000))]
    pub steps: usize,
}

/// Material: σ = 𝓔ε(u) + 𝓥ε(u̇) − θ𝓜 (2.1), q = −𝓚∇θ (2.2).
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Material {
    /// Density ρ in kg/m³; 0: quasistatic.
    #[schemars(range(min = 0.0))]
    pub density: f64,
    /// Heat capacity, the factor of θ̇ in (2.4), in J/(m³ K); 0: steady heat.
    #[schemars(range(min = 0.0))]
    pub heat_capacity: f64,
    /// Thermal expansion tensor 𝓜 of (2.1) in Pa/K.
    pub expansion: Tensor,
    /// Tensor 𝓡 of (2.4), heat per strain, in W/m³.
    pub coupling: Tensor,
    /// Heat conductivity tensor 𝓚 of (2.2) in W/(m K).
    pub conductivity: Tensor,
    /// Elasticity 𝓔.
    pub elasticity: Elasticity,
    /// Viscosity 𝓥.
    pub viscosity: Viscosity,
}

/// Elasticity by its law.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Elasticity {
    /// 𝓔τ = Eν/(1−ν²) tr(τ) I + E/(1+ν) τ in plane stress, (5.1).
    Isotropic {
        /// Young's modulus E in Pa.
        #[schemars(extend("exclusiveMinimum" = 0))]
        young: f64,
        /// Poisson's ratio ν.
        ///
        /// Above −1; below 1 in plane stress, below 0.5 in plane strain.
        #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 1))]
        poisson: f64,
        /// How the third direction of a plane body is held.
        #[serde(default)]
        stress_state: StressState,
    },
}

/// How the third direction of a plane body is held.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum StressState {
    /// σ₃₃ = 0: a thin sheet.
    #[default]
    PlaneStress,
    /// ε₃₃ = 0: a long body.
    PlaneStrain,
}

/// Viscosity by its law.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Viscosity {
    /// 𝓥τ = first tr(τ) I + second τ, (5.1).
    Lame {
        /// Factor of tr(τ) I in Pa s.
        first: f64,
        /// Factor of τ in Pa s.
        #[schemars(range(min = 0.0))]
        second: f64,
    },
}

/// Loads.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Load {
    /// Body force f₀ in N/m³, one entry a component; empty for zero.
    #[serde(default)]
    pub body_force: Vec<Scalar>,
    /// Heat source q₀ in W/m³.
    #[serde(default)]
    pub heat_source: Scalar,
}

/// Conditions on one side.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Boundary {
    /// Name of the side.
    pub on: String,
    /// Prescribed displacement in m, one entry a component.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<Vec<Scalar>>,
    /// Traction f₁ = σν in Pa, one entry a component.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub traction: Option<Vec<Scalar>>,
    /// Prescribed temperature in K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<Scalar>,
    /// Heat flux into the body, −q·ν, in W/m².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heat_inflow: Option<Scalar>,
}

/// Contact of one side with a foundation: (2.8)–(2.10).
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Contact {
    /// Name of the side that is Γ_C.
    pub on: String,
    /// Gap g to the foundation along the outward normal, in m.
    #[serde(default)]
    pub gap: Scalar,
    /// Where the integrals over Γ_C are evaluated.
    #[serde(default)]
    pub quadrature: Quadrature,
    /// Law of the contact pressure p_ν (2.8).
    pub normal: Normal,
    /// Law of the friction bound p_τ (2.9).
    #[serde(default)]
    pub friction: Friction,
    /// Law of the heat exchange with the foundation (2.10).
    #[serde(default)]
    pub heat: Heat,
}

/// Where the integrals over Γ_C are evaluated.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Quadrature {
    /// At the nodes: each contact node obeys the laws on its own.
    #[default]
    Nodal,
    /// At Gauss points, two a segment.
    Gauss,
}

/// Contact pressure by its law.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Normal {
    /// p_ν(r) = stiffness · max(r, 0), r the penetration.
    Compliance {
        /// Stiffness c_ν of the contact in Pa/m.
        #[schemars(range(min = 0.0))]
        stiffness: f64,
    },
}

/// Friction bound by its law.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Friction {
    /// No friction.
    #[default]
    None,
    /// p_τ = coefficient · p_ν.
    Coulomb {
        /// Friction coefficient μ.
        #[schemars(range(min = 0.0))]
        coefficient: f64,
    },
}

/// Heat exchange by its law.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Heat {
    /// No heat exchange.
    #[default]
    None,
    /// k_c(r) rises linearly over 0 ≤ r ≤ width and is the conductance above, r the penetration.
    Ramp {
        /// Conductance of closed contact in W/(m² K).
        #[schemars(range(min = 0.0))]
        conductance: f64,
        /// Penetration in m at which the conductance is reached.
        #[schemars(extend("exclusiveMinimum" = 0))]
        width: f64,
        /// Temperature θ_F of the foundation in K.
        foundation_temperature: Scalar,
        /// Bound L of the temperature difference in φ_L, in K; without it φ_L(s) = s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        truncation: Option<f64>,
    },
}

/// State at t = 0: (2.11). The expressions do not use t.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Initial {
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
pub(super) struct Scheme {
    /// How mechanics and heat are coupled within a step.
    #[serde(default)]
    pub coupling: Coupling,
}

/// How mechanics and heat are coupled within a step.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Coupling {
    /// One after the other, with the temperature and the displacement of the step before in the coupling terms.
    #[default]
    Staggered,
    /// With those of the step itself, by iterating the two half-steps; it may fail to settle where they act strongly on each other.
    FixedPoint,
    /// With those of the step itself, by Newton's method for both together.
    Monolithic,
}

/// What is written during a run.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Output {
    /// Steps between field snapshots; 0: only the last.
    #[serde(default)]
    pub every: usize,
}

/// Values that a run of the case must give.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Expected {
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
pub(super) struct Exact {
    /// Displacement in m, one entry a component.
    pub displacement: Vec<Scalar>,
    /// Temperature in K.
    pub temperature: Scalar,
}

/// What makes a case a benchmark.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Verify {
    /// What is shown, in one line.
    pub title: String,
    /// Where the reference values come from.
    pub source: String,
    /// The values to compare.
    pub check: Vec<Check>,
}

/// A value to compare, by kind.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Check {
    /// A field at a point and a time, interpolated in space and time.
    Probe {
        /// The field.
        field: ProbeField,
        /// The point in m.
        at: [f64; 2],
        /// The time in s.
        time: f64,
        /// Reference value.
        reference: f64,
        /// Allowed deviation, relative to the reference or to `scale`.
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
        /// Magnitude that the deviation is relative to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        scale: Option<f64>,
    },
    /// A column of history.csv at a time, or its extreme over all times.
    History {
        /// The column.
        column: String,
        /// The time in s, interpolated.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        time: Option<f64>,
        /// Which value where no time is given.
        #[serde(default)]
        take: Take,
        /// Reference value.
        reference: f64,
        /// Allowed deviation, relative to the reference or to `scale`.
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
        /// Magnitude that the deviation is relative to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        scale: Option<f64>,
    },
    /// The least-squares order of an error against `[exact]`.
    Order {
        /// What is refined.
        #[serde(default)]
        vary: Vary,
        /// Cells per side of the levels, or steps where time is varied.
        levels: Vec<usize>,
        /// Steps are those of the case times (level / cells of the case) to this power.
        #[serde(default = "one")]
        #[schemars(range(min = 1, max = 2))]
        power: u32,
        /// The error.
        error: ErrorName,
        /// Expected order.
        reference: f64,
        /// Allowed deviation.
        #[serde(default = "tenth")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
    },
    /// An error against `[exact]` on the mesh and with the steps of the case.
    Error {
        /// The error.
        error: ErrorName,
        /// Reference value.
        reference: f64,
        /// Allowed deviation, relative to the reference or to `scale`.
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
        /// Magnitude that the deviation is relative to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        scale: Option<f64>,
    },
}

/// A field that a probe reads.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum ProbeField {
    /// u_x in m.
    DisplacementX,
    /// u_y in m.
    DisplacementY,
    /// u̇_x in m/s.
    VelocityX,
    /// u̇_y in m/s.
    VelocityY,
    /// θ in K.
    Temperature,
}

/// Which value of a column is taken.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Take {
    /// The last.
    #[default]
    Last,
    /// The smallest.
    Min,
    /// The largest.
    Max,
}

/// What a study refines.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Vary {
    /// Mesh and step together.
    #[default]
    Both,
    /// The mesh.
    Space,
    /// The step.
    Time,
}

/// An error of a study, the maximum over time.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum ErrorName {
    /// ‖w − w^{hk}‖_H.
    ErrorW,
    /// ‖ε(u − u^{hk})‖.
    ErrorU,
    /// ‖θ − θ^{hk}‖_{L²}.
    ErrorTheta,
    /// ‖u − u^{hk}‖_H.
    ErrorUH,
    /// E^{hk} of (5.2).
    Error,
}

/// A value of a summary.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number or an array of numbers")]
pub(super) enum Values {
    /// A number.
    One(f64),
    /// An array, one entry a component.
    Several(Vec<f64>),
}

fn tolerance() -> f64 {
    1e-8
}

fn one() -> u32 {
    1
}

fn tenth() -> f64 {
    0.1
}

/// Asks for positive entries of an array.
fn positive_items(schema: &mut Schema) {
    if let Some(items) = schema.get_mut("items").and_then(|items| items.as_object_mut()) {
        items.insert("exclusiveMinimum".to_owned(), 0.into());
    }
}
