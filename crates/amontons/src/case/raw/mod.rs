//! The case file as it is written: types that mirror the TOML key by key.
//!
//! Their doc comments, ranges and defaults are the JSON Schema of the file, which the check in
//! [`super::check`] walks: a key is described here and nowhere else. The first paragraph of a
//! comment goes into messages, so it starts with what the number is and names its unit.

mod accuracy;
mod boundary;
mod contact;
mod contact_loads;
mod cyclic;
mod data;
mod material;
mod mesh;
mod obstacle;
mod phase;
mod probe;
mod rigid;
mod side;
mod stability;
mod verify;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(in crate::case) use accuracy::Accuracy;
pub(in crate::case) use boundary::{Boundary, Releasing, Support};
pub(in crate::case) use contact::{Automatic, Contact, Contacts, Friction, Heat, HeatTerm, Normal, Quadrature, Wear};
pub(in crate::case) use contact_loads::{Fluid, Foundation, Preload};
pub(in crate::case) use cyclic::Cyclic;
pub(in crate::case) use data::{Coefficient, Column, Component, Datum, Extend, Scalar, Steady, TableData};
pub(in crate::case) use material::{
    Dilatation, Elasticity, Expansion, ExpansionKind, Material, Orientation, Region, StressState, Tensor, Viscosity,
};
pub(in crate::case) use mesh::{Block, Cells2, Cells3, Diagonal, Elements, Mesh, RefineWhere, Turn};
pub(in crate::case) use obstacle::{Geometry, Obstacle, ObstacleLoad, Turning};
pub(in crate::case) use phase::{PhaseAnalysis, RunPhase, StepNumber};
pub(in crate::case) use probe::{Over, Probe};
pub(in crate::case) use rigid::Rigid;
pub(in crate::case) use side::{Locus, Side};
pub(in crate::case) use stability::{Stability, StabilityKind};
pub(in crate::case) use verify::{Check, ErrorName, ModeValue, Take, Vary, Verify};

use crate::expression::NamedConstants;

/// A contact problem of a thermo-viscoelastic body with friction and heat.
///
/// Numbers are in SI units, or without units throughout: `units = "dimensionless"`.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Case file of amontons")]
pub(in crate::case) struct Case {
    /// Name of the case and of its results folder.
    pub name: String,
    /// Units of all numbers: SI, or none. It decides what summary and pictures write behind a number.
    #[serde(default)]
    pub units: Units,
    /// Thickness of a plane body in m.
    ///
    /// Forces, energies, heat flows and areas are then those of the whole body, in N, J, W and m²; without it they are
    /// per metre of thickness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub thickness: Option<f64>,
    /// Numbers with names that expressions and formulas of the case may mention: `[constants]` with `mu0 = 0.4`.
    ///
    /// `--set constants.mu0=0.3` and `--each` change them, and derivatives and `amontons fit` take them as parameters.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub constants: BTreeMap<String, f64>,
    /// The mesh of the body.
    pub mesh: Mesh,
    /// Sides that the case names by their place, one entry per side.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub side: Vec<Side>,
    /// The time interval (0, end) and its steps.
    #[serde(default)]
    #[schemars(extend("x-required-without-phases" = true))]
    pub time: Time,
    /// Phases of the run, one after the other, one entry per phase; `[time]` then has neither `end` nor `steps`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub phase: Vec<RunPhase>,
    /// Material of the body, except in regions with their own.
    pub material: Material,
    /// Regions of the mesh with their own material, one entry per region.
    #[serde(default)]
    pub region: Vec<Region>,
    /// Loads in the body, or one entry per load that acts in some phases or in one region only.
    #[serde(default)]
    pub load: Loads,
    /// Conditions on the sides, one entry per side.
    ///
    /// A side without displacement and traction is free of load; a side without temperature and heat
    /// inflow is insulated.
    #[serde(default)]
    pub boundary: Vec<Boundary>,
    /// Sides and regions that move as rigid bodies, one entry per part.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rigid: Vec<Rigid>,
    /// Sectors that are repeated about an axis, one entry per pair of sides along which a sector meets its neighbours.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cyclic: Vec<Cyclic>,
    /// Contact with a foundation, one entry per side in contact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<Contacts>,
    /// State at t = 0.
    #[serde(default)]
    pub initial: Initial,
    /// The time-stepping scheme.
    #[serde(default)]
    pub scheme: Scheme,
    /// How linear systems are solved.
    #[serde(default)]
    pub solver: Solver,
    /// Results written during a run.
    #[serde(default)]
    pub output: Output,
    /// Values recorded after every step in probes.csv, one entry per probe.
    #[serde(default)]
    pub probe: Vec<Probe>,
    /// The accuracy up to which `amontons run` refines cells and steps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<Accuracy>,
    /// What `amontons modes` looks for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<Stability>,
    /// Values that a run of the case must reproduce.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected: Option<Expected>,
    /// Exact solution, for convergence studies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exact: Option<Exact>,
    /// Reference values that make the case a benchmark.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verify: Option<Verify>,
}

impl Case {
    /// The constants whose names may be those of constants.
    pub fn constants(&self) -> NamedConstants {
        let mut constants = NamedConstants::default();
        for (name, value) in &self.constants {
            // The build of the case tells what is wrong with the other names.
            let _ = constants.add(name, *value);
        }
        constants
    }
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
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-required-without-phases" = true))]
    pub end: Option<f64>,
    /// Number of equal time steps, or "auto" for steps that follow from `accuracy`.
    ///
    /// In a steady run 1 if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-required-without-phases" = true, "x-required-unless-steady" = true))]
    pub steps: Option<StepNumber>,
    /// Accuracy of steps that are "auto": their errors over a phase, relative to the largest norm of the solution, such
    /// as 1e-3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 0.1))]
    pub accuracy: Option<f64>,
    /// What of the equations acts in a run without phases: `"dynamic"`, the default, `"quasistatic"` or `"steady"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub analysis: Option<PhaseAnalysis>,
    /// Whether inertia acts, ρü of (2.3).
    ///
    /// With `false` the body is in balance at every time, and the density of no material counts, which may then be
    /// left out.
    #[serde(default = "yes")]
    pub inertia: bool,
    /// Scheme in time.
    #[serde(default)]
    pub scheme: TimeScheme,
    /// Level ϑ of the scheme `theta`: 0.5, the default, is of second order and adds no damping; 1 is backward Euler.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.5, max = 1.0))]
    pub theta: Option<f64>,
    /// Coefficient of restitution e of rigid foundations in the scheme `theta`: 0, the default, for impacts without
    /// rebound, at most (1 − ϑ)/ϑ.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub restitution: Option<f64>,
    /// The pressure of a layer in a step of the scheme `theta`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure: Option<PressureRule>,
    /// The slip velocity that friction follows in a step of the scheme `theta`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionRule>,
    /// The mass matrix of the inertia term.
    #[serde(default)]
    pub mass: MassMatrix,
}

impl Default for Time {
    fn default() -> Time {
        Time {
            end: None,
            steps: None,
            analysis: None,
            accuracy: None,
            inertia: true,
            scheme: TimeScheme::default(),
            theta: None,
            restitution: None,
            pressure: None,
            friction: None,
            mass: MassMatrix::default(),
        }
    }
}

/// The mass matrix of the inertia term.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum MassMatrix {
    /// That of the shape functions: every node has its mass.
    #[default]
    Consistent,
    /// Nodes in contact have no mass: it is moved to nodes near them, with the same total, centre and inertia. Impacts
    /// then lose no energy.
    Redistributed,
}

/// The pressure of a layer in a step of the ϑ-scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum PressureRule {
    /// The mean over the penetrations of the step: it keeps the energy of the layer. The default.
    Gradient,
    /// That of the penetration at t_ϑ: it gains or loses energy where the gap closes or opens.
    Plain,
}

impl PressureRule {
    /// The word of the case, in quotes.
    pub fn quoted(self) -> &'static str {
        match self {
            PressureRule::Gradient => "\"gradient\"",
            PressureRule::Plain => "\"plain\"",
        }
    }
}

/// The slip velocity that friction follows in a step of the ϑ-scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum FrictionRule {
    /// The mean of the step: friction never gives energy. The default.
    Mean,
    /// That at the end of the step: a point that sticks is at rest there.
    End,
}

impl FrictionRule {
    /// The word of the case, in quotes.
    pub fn quoted(self) -> &'static str {
        match self {
            FrictionRule::Mean => "\"mean\"",
            FrictionRule::End => "\"end\"",
        }
    }
}

/// Scheme in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum TimeScheme {
    /// Backward Euler: of first order; it damps vibrations and takes every law.
    #[default]
    Euler,
    /// The ϑ-scheme: of second order at ϑ = 0.5, where it keeps the energy of contact layers; impacts on rigid
    /// foundations by Newton's law.
    Theta,
    /// BDF2, the backward differentiation formula of second order, for smooth motions and heat: it damps vibrations
    /// that no step resolves, and little of others.
    Bdf2,
    /// The ϑ-scheme at ϑ = 0.5, stabilised for impacts on rigid foundations, which are met exactly at the end of each
    /// step; velocities of points in contact are those from before the impact.
    ContactStabilised,
}

impl TimeScheme {
    /// The word of the case, in quotes.
    pub fn quoted(self) -> &'static str {
        match self {
            TimeScheme::Euler => "\"euler\"",
            TimeScheme::Theta => "\"theta\"",
            TimeScheme::Bdf2 => "\"bdf2\"",
            TimeScheme::ContactStabilised => "\"contact-stabilised\"",
        }
    }
}

fn yes() -> bool {
    true
}

/// Loads of the body: `[load]`; several: `[[load]]`.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a table, or an array of tables")]
pub(in crate::case) enum Loads {
    /// One.
    One(#[serde(deserialize_with = "one_load")] Box<Load>),
    /// Several, which add up.
    Several(Vec<Load>),
}

/// Reads a load from a table: an array without entries is no load.
fn one_load<'de, D: serde::Deserializer<'de>>(raw: D) -> Result<Box<Load>, D::Error> {
    let table = toml::Table::deserialize(raw)?;
    Load::deserialize(table).map(Box::new).map_err(serde::de::Error::custom)
}

impl Default for Loads {
    fn default() -> Loads {
        Loads::One(Box::default())
    }
}

impl Loads {
    /// The loads with their paths in the case file.
    pub fn each(&self) -> Vec<(String, &Load)> {
        match self {
            Loads::One(load) => vec![("load".to_owned(), &**load)],
            Loads::Several(all) => all.iter().enumerate().map(|(i, load)| (format!("load[{i}]"), load)).collect(),
        }
    }

    /// The load that acts in all of the body in all phases, if it is the only one.
    pub fn of_all(&self) -> Option<&Load> {
        match self {
            Loads::One(load) if load.phases.is_none() && load.on.is_none() => Some(load),
            _ => None,
        }
    }
}

/// Loads.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Load {
    /// Name of the region in which the load acts; without the key it acts in all of the body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<String>,
    /// Body force f₀ in N/m³, one entry per component; empty for zero.
    #[serde(default)]
    pub body_force: Vec<Datum>,
    /// Acceleration of gravity in m/s², one entry per component, numbers or expressions in t: the body force is the
    /// density of each material times it, also with `time.inertia = false`; empty for none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gravity: Vec<Datum>,
    /// Heat source q₀ in W/m³.
    #[serde(default)]
    pub heat_source: Datum,
    /// Temperature θ in K that is given at all times, in the place of the heat equation.
    ///
    /// Materials then need no `heat_capacity` and `conductivity`, and no other key of heat may stand beside it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<Datum>,
    /// Names of the phases in which the load acts; without the key it acts in all of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phases: Option<Vec<String>>,
}

/// State at t = 0: (2.11). The expressions do not use t.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Initial {
    /// Displacement u₀ in m, one entry per component; empty for zero.
    #[serde(default)]
    pub displacement: Vec<Scalar>,
    /// Velocity in m/s, one entry per component; empty for zero.
    #[serde(default)]
    pub velocity: Vec<Scalar>,
    /// Temperature θ₀ in K.
    #[serde(default)]
    pub temperature: Scalar,
    /// Whether the run starts from these data or in equilibrium.
    #[serde(default)]
    pub state: Starting,
}

/// How a run starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Starting {
    /// From the initial displacement and velocity.
    #[default]
    Given,
    /// From rest, in the static equilibrium under the loads at t = 0, with contact and friction; the temperature is the
    /// initial one.
    Equilibrium,
}

/// How linear systems are solved.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Solver {
    /// By a factor or by an iteration. Results agree to the accuracy to which a step is accepted.
    #[serde(default)]
    pub solver: Backend,
}

/// How linear systems are solved.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Backend {
    /// The program predicts time and memory of both, takes the faster one that fits, and says why.
    #[default]
    Auto,
    /// One factor of each matrix: the fastest in the plane, and in space up to some ten thousand unknowns.
    Direct,
    /// A Krylov iteration with algebraic multigrid: for large bodies in space.
    Iterative,
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
    /// Mechanics and heat are solved in turn; the coupling terms use the temperature and displacement of the previous
    /// step.
    #[default]
    Staggered,
    /// Mechanics, with the temperature extrapolated from the two steps before, and then heat, with the displacement
    /// found: as cheap as `staggered`, and of second order in the scheme `theta` at ϑ = 0.5.
    Extrapolated,
    /// The coupling terms use the present step; the two half-steps are iterated. Strong coupling may keep the iteration
    /// from converging.
    FixedPoint,
    /// The coupling terms use the present step; Newton's method solves both half-steps together.
    Monolithic,
}

/// What is written during a run.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::case) struct Output {
    /// Number of steps between field snapshots; 0: only the last step.
    pub every: usize,
    /// Fields written in addition to displacement, velocity, temperature, von Mises stress and region.
    pub fields: Vec<OutputField>,
    /// Format of the fields of a finished run.
    pub format: FieldsFormat,
    /// Bound the discretization error at each snapshot, per cell and as a whole, in error.csv.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub error: bool,
    /// When checkpoints are written besides those at the start, after the first step and at the end. By default at
    /// least every minute, and more often if that takes less than 1 % of the time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checkpoint: Option<Checkpoint>,
}

/// Most steps and most seconds between two checkpoints; one is written as soon as either has passed.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Checkpoint {
    /// Most steps between two checkpoints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub steps: Option<usize>,
    /// Longest time between two checkpoints in s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 1_000_000_000))]
    pub seconds: Option<f64>,
}

impl Default for Output {
    fn default() -> Output {
        Output {
            every: 0,
            fields: vec![OutputField::Stress],
            format: FieldsFormat::Vtu,
            error: false,
            checkpoint: None,
        }
    }
}

/// Format of the fields of a finished run.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum FieldsFormat {
    /// fields.pvd, with one file in fields/ per snapshot.
    Vtu,
    /// fields.vtkhdf: one file, which has the mesh once and the fields at all snapshots. Until the run has ended they
    /// are files in fields/.
    Vtkhdf,
    /// Both.
    Both,
}

/// A field of the snapshots.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum OutputField {
    /// Stress per cell.
    Stress,
    /// Strain per cell.
    Strain,
    /// Principal stresses and their directions per cell.
    Principal,
    /// Heat flux per cell.
    HeatFlux,
    /// Stress at the nodes, recovered from the cells.
    NodalStress,
}

/// Values that a run of the case must give.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Expected {
    /// Tolerance relative to the largest magnitude in the value.
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
    /// Displacement in m, one entry per component; left out in a case without mechanics.
    #[serde(default)]
    pub displacement: Vec<Scalar>,
    /// Temperature in K; left out in a case without heat.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<Scalar>,
}

/// A value of a summary.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number or an array of numbers")]
pub(in crate::case) enum Values {
    /// A number.
    One(f64),
    /// An array, one entry per component.
    Several(Vec<f64>),
}

fn tolerance() -> f64 {
    1e-8
}
