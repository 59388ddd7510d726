//! Problem 2.1 with its data: what is to be solved, checked once and trusted afterwards.
//!
//! [`ProblemData`] can be built and changed freely; [`ProblemData::check`] makes it a [`Problem`], which cannot change.
//! What solves, judges or writes takes a [`Problem`].

mod boundary;
mod check;
mod choices;
mod cyclic;
mod data;
mod drive;
mod fluid;
mod loads;
mod pairs;
use crate::time::Timeline;
pub use pairs::with_supports;
mod physics;
mod range;
mod rigid;
mod tables;
mod temperature;

use std::collections::BTreeSet;
use std::fmt;
use std::ops::Deref;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

pub use boundary::{BoundaryCondition, Convection, Support};
pub use choices::Choice;
pub(crate) use data::{Datum, Role, Sample};
pub use loads::RegionLoad;
pub use physics::Physics;
pub use rigid::RigidPart;
pub use tables::Uncovered;
pub(crate) use tables::first_warm;
pub use temperature::GivenTemperature;

use crate::contact::{Contact, ContactBoundary, Supports};
use crate::field::Field;
use crate::linalg::{Backend, Decided, Supernodal};
use crate::material::{Dilatation, Material, Prony};
use crate::mesh::{Cyclic, FacetSet, Mesh};
use crate::units::{Extent, System, TemperatureScale, Units};

/// One fault of the data: where, what was found, what was expected, what to try.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Dotted path of the datum, as in the case file: `material.density`, `boundary[1].on`.
    pub path: String,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
    /// What to try.
    pub hint: Option<String>,
}

impl Fault {
    /// A fault without a hint.
    pub fn new(path: impl Into<String>, found: impl Into<String>, expected: impl Into<String>) -> Fault {
        Fault { path: path.into(), found: found.into(), expected: expected.into(), hint: None }
    }

    /// The same fault with a hint.
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

/// u₀, u̇₀ and θ₀ of (2.11).
#[derive(Clone, Debug, Default)]
pub struct Initial {
    /// u₀ in m, one field per component; empty for zero.
    pub displacement: Vec<Field>,
    /// u̇₀ in m/s, one field per component; empty for zero.
    pub velocity: Vec<Field>,
    /// θ₀ in K.
    pub temperature: Field,
}

/// How (4.1) and (4.2) are coupled within a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coupling {
    /// One after the other, with θ_{n−1} in m and u_{n−1} in e: the scheme of the paper.
    #[default]
    Staggered,
    /// θ_n in m and u_n in e, by iterating the operator Φ of (3.10) within the step.
    FixedPoint,
    /// θ_n in m and u_n in e, by Newton's method for u and θ together.
    Monolithic,
}

impl fmt::Display for Coupling {
    /// The word of the case file.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Coupling::Staggered => "staggered",
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
/// let rubber = Material::new(2, Isotropic::elastic(2, 5e6, 0.4, PlaneStrain)).viscosity(Isotropic::lame(2, 0.0, 2e4, PlaneStrain));
/// let mut block = ProblemData::new("block", mesh, rubber, 1.0, 20);
/// block.physics = Physics::Mechanics;
/// block.boundary = vec![BoundaryCondition::on("top").displacement([0.0, -1e-3])];
/// block.contacts = vec![Contact::new("bottom", Compliance { stiffness: 1e10 }).friction(Coulomb { coefficient: 0.3 })];
/// let block = block.check()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ProblemData {
    /// Name, used for result folders and titles.
    pub name: String,
    /// Whether the data are in SI units or without units.
    pub system: System,
    /// The scale of its temperatures: the same numbers, otherwise named.
    pub temperature_scale: TemperatureScale,
    /// The body.
    pub mesh: Arc<Mesh>,
    /// The instants t_0 … t_N of the run.
    pub timeline: Timeline,
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
    /// The temperature that is given where [`Physics::Warmed`] has no equation for it: of a node in several regions
    /// that of the first entry, and of the others that of the entry of the whole body.
    pub temperature: Vec<GivenTemperature>,
    /// Conditions on the parts of the boundary; at a node of two parts the first entry that prescribes a value holds.
    pub boundary: Vec<BoundaryCondition>,
    /// Sides along which the body is one sector of a whole that turns into itself: what acts on the body is taken to
    /// act on the other sectors as well, turned. No condition and no contact is on these sides.
    pub cyclic: Vec<Cyclic>,
    /// Sides and regions that move as rigid bodies.
    pub rigid: Vec<RigidPart>,
    /// Contact of sides with their foundations; a side may have several, all but one of them with obstacles.
    pub contacts: Vec<Contact>,
    /// Initial data.
    pub initial: Initial,
    /// How mechanics and heat are coupled within a step.
    pub coupling: Coupling,
    /// How linear systems are solved: of a run, a study and the certificate.
    pub backend: Arc<dyn Backend>,
    /// What was chosen while the problem was made, such as the side of a pair that bears the points: for those who read
    /// the results.
    pub chosen: Vec<Choice>,
}

/// A problem whose data are checked; it reads like its [`ProblemData`].
#[derive(Clone, Debug)]
pub struct Problem(ProblemData);

impl Deref for Problem {
    type Target = ProblemData;

    fn deref(&self) -> &ProblemData {
        &self.0
    }
}

impl Problem {
    /// The data, to be changed and checked again.
    #[must_use]
    pub fn into_data(self) -> ProblemData {
        self.0
    }

    /// The same problem with data changed by `change`, checked again.
    ///
    /// # Errors
    /// All faults that the changed data have.
    pub fn with(&self, change: impl FnOnce(&mut ProblemData)) -> Result<Problem, Faults> {
        let mut data = self.0.clone();
        change(&mut data);
        data.check()
    }

    /// The same problem with linear systems that end their work when the flag becomes true, as far as they can.
    #[must_use]
    pub(crate) fn interruptible(&self, flag: Option<&Arc<AtomicBool>>) -> Problem {
        let backend = flag.and_then(|flag| self.backend.interruptible(flag));
        Problem(ProblemData { backend: backend.unwrap_or_else(|| Arc::clone(&self.backend)), ..self.0.clone() })
    }

    /// The same problem with obstacles under a load where a run has found them: δ(t) by the number of the contact.
    #[must_use]
    pub fn with_found(&self, found: &dyn Fn(usize) -> Option<Field>) -> Problem {
        let mut data = self.0.clone();
        for (number, contact) in data.contacts.iter_mut().enumerate() {
            if let Some(load) = contact.obstacle.as_mut().and_then(|obstacle| obstacle.load.as_mut()) {
                load.found = found(number);
            }
        }
        Problem(data)
    }

    /// The same problem with linear systems solved as was decided before.
    #[must_use]
    pub(crate) fn decided(&self, before: &[Decided]) -> Problem {
        let backend = if before.is_empty() { None } else { self.backend.decided(before) };
        Problem(ProblemData { backend: backend.unwrap_or_else(|| Arc::clone(&self.backend)), ..self.0.clone() })
    }

    /// The same problem with each material replaced by another, which has laws on the same strains and the same
    /// densities.
    pub(crate) fn with_materials(&self, other: impl Fn(&Material) -> Material) -> Problem {
        let materials = self.materials.iter().map(other).collect();
        Problem(ProblemData { materials, ..self.0.clone() })
    }
}

impl ProblemData {
    /// A body of one material in SI units from t = 0 to t = `end` s in `steps` steps. Nothing acts on it and nothing
    /// holds it; it is at rest, its temperature is 0, and it has both mechanics and heat.
    #[must_use]
    pub fn new(name: impl Into<String>, mesh: Mesh, material: Material, end: f64, steps: usize) -> ProblemData {
        ProblemData {
            name: name.into(),
            system: System::Si,
            temperature_scale: TemperatureScale::Kelvin,
            mesh: Arc::new(mesh),
            timeline: Timeline::equal(end, steps),
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

    /// Whether a foundation, or the other side of a pair, slides out of the plane of the body, or about its axis.
    #[must_use]
    pub fn slides_out(&self) -> bool {
        self.contacts.iter().any(|contact| contact.slides_out(self.mesh.dim))
    }

    /// Number of components of tractions and slip velocities on Γ_C.
    #[must_use]
    pub fn components_on_contact(&self) -> usize {
        if self.slides_out() { 3 } else { self.mesh.dim }
    }

    /// Whether a foundation turns about the axis of a body of revolution.
    #[must_use]
    pub fn turns(&self) -> bool {
        self.mesh.axisymmetric && self.slides_out()
    }

    /// Number of components of forces on Γ_C: about the axis of revolution there is a moment in the place of a force.
    #[must_use]
    pub fn components_of_force(&self) -> usize {
        if self.turns() { self.mesh.dim } else { self.components_on_contact() }
    }

    /// The material of a region of the mesh; none where there are no materials.
    #[must_use]
    pub fn material_of(&self, region: usize) -> Option<&Material> {
        self.materials.get(region).or(self.materials.last())
    }

    /// Which strain the laws of each region see.
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

    /// The facets of Γ_C, each side once; none without contact.
    #[must_use]
    pub fn contact_facets(&self) -> Option<FacetSet> {
        let sides: BTreeSet<&str> = self.contacts.iter().map(Contact::bearing).collect();
        let mut sets = sides.into_iter().filter_map(|side| self.mesh.facets.get(side)).cloned();
        let mut all = sets.next()?;
        sets.for_each(|set| all.blocks.extend(set.blocks));
        Some(all)
    }
}
