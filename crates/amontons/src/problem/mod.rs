//! Problem 2.1 with its data. The data are checked once and trusted afterwards.
//!
//! [`ProblemData`] can be built and changed freely; [`ProblemData::check`] makes it a [`Problem`], which cannot change.
//! Solver, certificate and sinks take a [`Problem`].

mod boundary;
mod check;
mod choices;
mod cyclic;
mod data;
mod drive;
mod equilibrium;
mod fluid;
mod jump;
mod loads;
mod misfit;
mod pairs;
use crate::time::{TimeScheme, Timeline};
pub use pairs::with_supports;
mod physics;
mod range;
mod rigid;
mod rules;
mod schedule;
mod scheme;
mod steady;
mod tables;
mod temperature;

use std::collections::BTreeSet;
use std::fmt;
use std::ops::Deref;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

pub use boundary::{BoundaryCondition, Convection, Release, Support};
pub use choices::Choice;
pub(crate) use data::{Datum, DatumRole, MaterialSample};
pub use equilibrium::StartState;
pub(crate) use jump::PrescribedJump;
pub use loads::RegionLoad;
pub use misfit::{Misfit, MisfitOf};
pub use physics::Physics;
pub use rigid::RigidPart;
use schedule::{Schedule, Scheduled};
pub use tables::Uncovered;
pub(crate) use tables::first_warm;
pub use temperature::GivenTemperature;

use crate::contact::{Contact, ContactBoundary, Supports};
use crate::field::Field;
use crate::linalg::{Backend, Decided, Supernodal};
use crate::mass::MassMatrix;
use crate::material::{Dilatation, Material, Prony};
use crate::mesh::{Cyclic, FacetSet, Mesh};
use crate::units::{Extent, TemperatureScale, UnitSystem, Units};

/// One fault of the data: place, found, expected, hint.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Dotted path of the datum, as in the case file: `material.density`, `boundary[1].on`.
    pub path: String,
    /// The value found, or a description of it.
    pub found: String,
    /// The values that are allowed.
    pub expected: String,
    /// Instruction how to correct it.
    pub hint: Option<String>,
}

impl Fault {
    /// A fault without a hint.
    pub fn new(path: impl Into<String>, found: impl Into<String>, expected: impl Into<String>) -> Fault {
        Fault { path: path.into(), found: found.into(), expected: expected.into(), hint: None }
    }

    /// Adds a hint to the fault.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Fault {
        self.hint = Some(hint.into());
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: found {}, expected {}", self.path, self.found, self.expected)?;
        match &self.hint {
            Some(hint) => write!(f, "; {hint}"),
            None => Ok(()),
        }
    }
}

/// Faults of the data, all of them at once.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct Faults(pub Vec<Fault>);

/// Initial data u₀, u̇₀ and θ₀ of (2.11).
#[derive(Clone, Debug, Default)]
pub struct Initial {
    /// u₀ in m, one field per component; empty for zero.
    pub displacement: Vec<Field>,
    /// u̇₀ in m/s, one field per component; empty for zero.
    pub velocity: Vec<Field>,
    /// θ₀ in K.
    pub temperature: Field,
    /// Whether the run starts from u₀ and u̇₀, or from rest in equilibrium.
    pub state: StartState,
}

/// The coupling of (4.1) and (4.2) within a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coupling {
    /// One after the other, with θ_{n−1} in m and u_{n−1} in e: the scheme of the paper.
    #[default]
    Staggered,
    /// Mechanics first, with the temperature extrapolated from t_{n−1} and t_{n−2} to the time of the equations, then
    /// heat, with the displacement found.
    Extrapolated,
    /// θ_n in m and u_n in e, by iterating the operator Φ of (3.10) within the step.
    FixedPoint,
    /// θ_n in m and u_n in e, by Newton's method for u and θ together.
    Monolithic,
}

impl Coupling {
    /// True if mechanics and heat of a step depend on each other: θ_n stands in m and u_n in e.
    #[must_use]
    pub fn is_mutual(self) -> bool {
        matches!(self, Coupling::FixedPoint | Coupling::Monolithic)
    }
}

impl fmt::Display for Coupling {
    /// The word of the case file.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Coupling::Staggered => "staggered",
            Coupling::Extrapolated => "extrapolated",
            Coupling::FixedPoint => "fixed-point",
            Coupling::Monolithic => "monolithic",
        })
    }
}

/// The data of a problem, not yet checked: made by [`ProblemData::new`], the fields then set.
///
/// ```
/// use amontons::contact::{Compliance, Contact, Coulomb};
/// use amontons::material::{Isotropic, Material, StressState::PlaneStrain};
/// use amontons::mesh::{Diagonal, Mesh};
/// use amontons::problem::{BoundaryCondition, Physics, ProblemData};
///
/// let mesh = Mesh::rectangle([0.2, 0.1], [16, 8], Diagonal::Right)?;
/// let rubber = Material::new(2, Isotropic::elastic(2, 5e6, 0.4, PlaneStrain)).viscosity(Isotropic::lame(2, 0.0, 2e4,
/// PlaneStrain)); let mut block = ProblemData::new("block", mesh, rubber, 1.0, 20);
/// block.physics = Physics::Mechanics;
/// block.boundary = vec![BoundaryCondition::on("top").displacement([0.0, -1e-3])];
/// block.contacts = vec![Contact::new("bottom", Compliance { stiffness: 1e10 }).friction(Coulomb { coefficient: 0.3
/// })]; let block = block.check()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ProblemData {
    /// Name, used for result folders and titles.
    pub name: String,
    /// SI units or no units.
    pub system: UnitSystem,
    /// The temperature scale of the data: kelvin or degrees Celsius. The numbers are the same, the unit has another
    /// name.
    pub temperature_scale: TemperatureScale,
    /// The body.
    pub mesh: Arc<Mesh>,
    /// The instants t_0 … t_N of the run.
    pub timeline: Timeline,
    /// The scheme in time.
    pub scheme: TimeScheme,
    /// The mass matrix of the inertia term.
    pub mass: MassMatrix,
    /// The equations that are solved.
    pub physics: Physics,
    /// The materials by region, as [`Mesh::regions`] lists them, or one for all.
    pub materials: Vec<Material>,
    /// f₀ in N/m³, one field per component; empty for zero.
    pub body_force: Vec<Field>,
    /// q₀ in W/m³.
    pub heat_source: Field,
    /// Body forces and heat sources of regions, which add to those of the whole body.
    pub region_loads: Vec<RegionLoad>,
    /// Prescribed temperature for [`Physics::Warmed`], which has no heat equation. At a node of several regions the
    /// first entry counts; an entry of the whole body counts where no region has one.
    pub temperature: Vec<GivenTemperature>,
    /// Conditions on the parts of the boundary; at a node of two parts the first entry that prescribes a value holds.
    pub boundary: Vec<BoundaryCondition>,
    /// Pairs of sides between which the body is one sector of a cyclic structure: loads on the body act on all sectors,
    /// rotated. These sides bear no condition and no contact.
    pub cyclic: Vec<Cyclic>,
    /// Sides and regions that move as rigid bodies.
    pub rigid: Vec<RigidPart>,
    /// Contact of sides with their foundations; a side may have several, all but one of them with obstacles.
    pub contacts: Vec<Contact>,
    /// Initial data.
    pub initial: Initial,
    /// The coupling of mechanics and heat within a step.
    pub coupling: Coupling,
    /// The solver of linear systems in runs, studies and the certificate.
    pub backend: Arc<dyn Backend>,
    /// Choices made while the problem was built, such as the nonmortar side of a pair, for readers of the results.
    pub chosen: Vec<Choice>,
}

/// A problem whose data are checked; it reads like its [`ProblemData`], with the conditions of one phase: of the first
/// one, or of that which was asked for by [`Problem::in_phase`]. Conditions that do not act there are free and
/// insulated sides.
#[derive(Clone, Debug)]
pub struct Problem(ProblemData, Schedule);

impl Deref for Problem {
    type Target = ProblemData;

    fn deref(&self) -> &ProblemData {
        &self.0
    }
}

impl Problem {
    /// Returns the problem with data changed by `change` and checked again.
    ///
    /// # Errors
    /// All faults that the changed data have.
    pub fn with(&self, change: impl FnOnce(&mut ProblemData)) -> Result<Problem, Faults> {
        let mut data = self.clone().into_data();
        change(&mut data);
        data.check()
    }

    /// Returns the problem with linear solvers that stop when the flag becomes true, if the backend can be interrupted.
    #[must_use]
    pub(crate) fn interruptible(&self, flag: Option<&Arc<AtomicBool>>) -> Problem {
        let backend = flag.and_then(|flag| self.backend.interruptible(flag));
        Problem(
            ProblemData { backend: backend.unwrap_or_else(|| Arc::clone(&self.backend)), ..self.0.clone() },
            self.1.clone(),
        )
    }

    /// Returns the problem as a single process may use it, without the others.
    pub(crate) fn alone(&self) -> Problem {
        self.backend.alone().map_or_else(|| self.clone(), |backend| self.solved_by(&backend))
    }

    /// Returns the problem with another backend for its linear systems.
    #[must_use]
    pub fn solved_by(&self, backend: &Arc<dyn Backend>) -> Problem {
        Problem(ProblemData { backend: Arc::clone(backend), ..self.0.clone() }, self.1.clone())
    }

    /// Returns the problem with the displacement δ(t) of each loaded obstacle as found by a run, by number of the
    /// contact.
    #[must_use]
    pub fn with_found(&self, found: &dyn Fn(usize) -> Option<Field>) -> Problem {
        let (mut data, mut all) = (self.0.clone(), Scheduled::clone(&self.1.all));
        for contacts in [&mut data.contacts, &mut all.contacts] {
            for (number, contact) in contacts.iter_mut().enumerate() {
                if let Some(load) = contact.obstacle.as_mut().and_then(|obstacle| obstacle.load.as_mut()) {
                    load.found = found(number);
                }
            }
        }
        Problem(data, Schedule { all: Arc::new(all), ..self.1.clone() })
    }

    /// Returns the problem with a backend that repeats earlier decisions about its linear systems.
    #[must_use]
    pub(crate) fn decided(&self, before: &[Decided]) -> Problem {
        let backend = if before.is_empty() { None } else { self.backend.decided(before) };
        Problem(
            ProblemData { backend: backend.unwrap_or_else(|| Arc::clone(&self.backend)), ..self.0.clone() },
            self.1.clone(),
        )
    }

    /// Returns the problem with all densities zero, as a quasistatic phase has it; loads stay.
    pub(crate) fn without_inertia(&self) -> Problem {
        self.with_materials(|material| Material { density: 0.0.into(), ..material.clone() })
    }

    /// Returns the problem with each material replaced. The new ones must have laws on the same strains, and the same
    /// densities or none.
    pub(crate) fn with_materials(&self, other: impl Fn(&Material) -> Material) -> Problem {
        let materials = self.materials.iter().map(other).collect();
        Problem(ProblemData { materials, ..self.0.clone() }, self.1.clone())
    }
}

impl ProblemData {
    /// A body of one material in SI units from t = 0 to t = `end` s in `steps` steps. Nothing acts on it and nothing
    /// holds it; it is at rest, its temperature is 0, and it has both mechanics and heat.
    #[must_use]
    pub fn new(name: impl Into<String>, mesh: Mesh, material: Material, end: f64, steps: usize) -> ProblemData {
        ProblemData {
            name: name.into(),
            system: UnitSystem::Si,
            temperature_scale: TemperatureScale::Kelvin,
            mesh: Arc::new(mesh),
            timeline: Timeline::equal(end, steps),
            scheme: TimeScheme::default(),
            mass: MassMatrix::default(),
            physics: Physics::Coupled,
            materials: vec![material],
            body_force: Vec::new(),
            heat_source: Field::ZERO,
            region_loads: Vec::new(),
            temperature: Vec::new(),
            boundary: Vec::new(),
            cyclic: Vec::new(),
            rigid: Vec::new(),
            contacts: Vec::new(),
            initial: Initial::default(),
            coupling: Coupling::Staggered,
            backend: Arc::new(Supernodal),
            chosen: Vec::new(),
        }
    }

    /// The units of its numbers.
    #[must_use]
    pub fn units(&self) -> Units {
        let extent = match self.mesh.dim {
            1 => Extent::Line,
            2 if self.mesh.axisymmetric => Extent::Revolution,
            2 if self.mesh.thickness.is_some() => Extent::Sheet,
            2 => Extent::Plane,
            _ => Extent::Space,
        };
        Units { system: self.system, extent, temperature: self.temperature_scale }
    }

    /// True if a foundation, or the other side of a pair, slides out of the plane of the body or about its axis.
    #[must_use]
    pub fn slides_out(&self) -> bool {
        self.contacts.iter().any(|contact| contact.slides_out(self.mesh.dim))
    }

    /// Number of components of tractions and slip velocities on Γ_C.
    #[must_use]
    pub fn components_on_contact(&self) -> usize {
        if self.slides_out() { 3 } else { self.mesh.dim }
    }

    /// True if a foundation turns about the axis of a body of revolution.
    #[must_use]
    pub fn turns(&self) -> bool {
        self.mesh.axisymmetric && self.slides_out()
    }

    /// Number of components of forces on Γ_C. If a foundation turns about the axis, its moment is a column of its own.
    #[must_use]
    pub fn components_of_force(&self) -> usize {
        if self.turns() { self.mesh.dim } else { self.components_on_contact() }
    }

    /// The material of a region of the mesh, or `None` if there are no materials.
    #[must_use]
    pub fn material_of(&self, region: usize) -> Option<&Material> {
        self.materials.get(region).or(self.materials.last())
    }

    /// Kind of dilatation that the laws of each region see.
    #[must_use]
    pub fn dilatation(&self) -> Vec<Dilatation> {
        self.materials.iter().map(|material| material.dilatation).collect()
    }

    /// The relaxation times of all materials that are the same everywhere, s, ascending, each once.
    #[must_use]
    pub fn relaxation_times(&self) -> Vec<f64> {
        let branches = self.materials.iter().filter_map(|material| material.prony.as_ref()).flat_map(Prony::branches);
        let mut times: Vec<f64> = branches.filter(|b| !b.time_varies()).map(|b| b.time).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// The largest number of branches of a material whose relaxation time varies over the body.
    #[must_use]
    pub fn varying_branches(&self) -> usize {
        self.materials.iter().map(|material| material.varying_branches().count()).max().unwrap_or(0)
    }

    /// The place of a contact in the case file: `contact`, or `contact[1]` where there are several.
    #[must_use]
    pub fn contact_path(&self, side: usize) -> String {
        if self.contacts.len() == 1 { "contact".to_owned() } else { format!("contact[{side}]") }
    }

    /// Γ_C with the contact points of all sides; sides that the mesh does not have are left out.
    #[must_use]
    pub fn contact_boundary(&self) -> ContactBoundary {
        let asks = !self.cyclic.is_empty() || self.contacts.iter().any(|contact| contact.pair.is_some());
        let space = asks.then(|| self.displacement_space());
        let of = |supports: Supports| ContactBoundary::of_contacts(&self.contacts, &self.mesh, supports);
        space.map_or_else(|| of(Supports::NONE), |space| with_supports(&space, None, of))
    }

    /// The facets of Γ_C, each side once, or `None` without contact.
    #[must_use]
    pub fn contact_facets(&self) -> Option<FacetSet> {
        let sides: BTreeSet<&str> = self.contacts.iter().map(Contact::bearing).collect();
        let mut sets = sides.into_iter().filter_map(|side| self.mesh.facets.get(side)).cloned();
        let mut all = sets.next()?;
        sets.for_each(|set| all.blocks.extend(set.blocks));
        Some(all)
    }
}
