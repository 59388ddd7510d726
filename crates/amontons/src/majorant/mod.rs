//! A bound of the discretization error of a step: the error of the constitutive relation (Prager–Synge).
//!
//! A step of a linear body is a minimum problem. Let u be its solution on the body as it is, u_h the discrete one, and
//! σ̂ any stress in balance with the loads and with admissible tractions p̂ ≥ 0, ‖q̂‖ ≤ s on Γ_C. Then
//!
//! ```text
//! ½‖u_h − u‖²_a + ½‖σ̂ − σ‖² + (contact terms ≥ 0)
//!     = ½‖Cε(u_h) + σ₀ − σ̂‖² + Σ ∫_{Γ_C} Φ(r_h) + Φ*(p̂) − p̂ r_h + s‖d_h‖ − q̂·d_h,
//! ```
//!
//! with the norm of C⁻¹ for stresses, C = 𝓔 + 𝓥/γ with the springs of branches, and σ₀ all stress that does not depend
//! on u. The right-hand side is computed and is never below the energy of the error; the chapter on the theory in the
//! book has the proof.
//!
//! The stress σ̂ is made in four steps: admissible tractions on Γ_C (`contact`); one solution with the matrix of the
//! step, after which σ_h balances them on the mesh; tractions on all facets that balance each cell (`balance`); a
//! symmetric stress in each cell with these tractions (`composite`, `energy`).

mod balance;
mod composite;
mod contact;
mod cube;
mod dense;
mod discrete;
mod energy;
mod hexahedron;
mod modes;
mod parallelogram;
mod patches;
mod quadrilateral;
mod relax;
mod revolution;
mod scope;
mod shapes;
mod simplex;
mod skeleton;
mod stress;

use std::sync::Arc;

use rayon::prelude::*;

use crate::contact::Contact;
use crate::discretization::Discretization;
use crate::field::Field;
use crate::linalg::{Layout, System, max_abs};
use crate::machine;
use crate::mesh::{CellMap, FacetMap, FacetSet, decisive_cells};
use crate::problem::{BoundaryCondition, Problem};
use crate::state::{State, StepReport};
use crate::tensor::{Point, dot, length};
use crate::time::Rule;
use balance::{CellForces, FacetGiven, balanced, means};
use contact::{SolvedContact, Touching};
use discrete::CellStress;
use energy::{CellEnergy, EnergyEvaluation};
use patches::{PatchData, Patches};
use relax::TractionDescent;
use shapes::CellShapes;
use skeleton::Skeleton;
use stress::{RelaxingStress, StepLaws, StepMotion};

/// A reason why there is no bound of the error.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the discretization error has no bound here: {0}")]
pub struct Refused(String);

impl Refused {
    fn new(reason: &str) -> Refused {
        Refused(reason.to_owned())
    }

    /// The refusal of a run that has made no step.
    #[must_use]
    pub fn without_steps() -> Refused {
        Refused::new("a run without steps")
    }

    /// The reason in words.
    #[must_use]
    pub fn reason(&self) -> &str {
        &self.0
    }
}

/// What is said of a bound.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Remarks {
    estimate: Vec<String>,
    notes: Vec<String>,
}

impl Remarks {
    fn estimate(&mut self, reason: &str) {
        if !self.estimate.iter().any(|known| known == reason) {
            self.estimate.push(reason.to_owned());
        }
    }

    fn note(&mut self, note: &str) {
        if !self.notes.iter().any(|known| known == note) {
            self.notes.push(note.to_owned());
        }
    }
}

/// The discretization error of a step in the norm of its energy, ‖v‖² = ∫ C ε(v):ε(v), C = 𝓔 + 𝓥/γ + Σ 𝓖/(1 + γ/τ).
#[derive(Clone, Debug, PartialEq)]
pub struct DiscretizationError {
    /// ½‖u_h − u‖² is at most this, J.
    pub energy: f64,
    /// The parts of the energy from the cells and from Γ_C, J.
    pub mesh: f64,
    /// See `mesh`.
    pub contact: f64,
    /// Half the square of the norm of what was changed of u_h to be admissible between the nodes of Γ_C, J.
    pub repair: f64,
    /// ½‖u_h‖², J.
    pub of_solution: f64,
    /// What of these energies is round-off of the tractions on Γ_C, J.
    pub round_off: f64,
    /// The energy of the error by cell, J; they sum to `mesh` + `contact`.
    pub cells: Vec<f64>,
    /// Reasons why the number is an estimate; empty if it is a proven bound, up to round-off.
    pub estimate: Vec<String>,
    /// What the bound does not count.
    pub notes: Vec<String>,
}

impl DiscretizationError {
    /// ‖u_h − u‖/‖u_h‖ is at most this; zero if nothing is deformed but by round-off.
    #[must_use]
    pub fn relative(&self) -> f64 {
        if self.is_at_rest() { 0.0 } else { (self.energy / self.of_solution).sqrt() }
    }

    /// The cells that have half of the energy of the error together, as few as possible.
    #[must_use]
    pub fn marked(&self) -> Vec<usize> {
        decisive_cells(&self.cells)
    }

    /// True if nothing is deformed but by round-off, and the error is no more.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.energy.max(self.of_solution) <= self.round_off
    }

    /// True if the number is a proven bound.
    #[must_use]
    pub fn is_guaranteed(&self) -> bool {
        self.estimate.is_empty()
    }
}

/// Bounds of the error for the steps of a problem in one phase.
#[derive(Debug)]
pub struct Majorant {
    skeleton: Skeleton,
    system: Option<(Rule, System)>,
    shared: Option<(Rule, SharedShapes)>,
}

/// What the steps of a rule share: the shapes of cells and the patches of facets.
#[derive(Debug)]
struct SharedShapes {
    shapes: CellShapes,
    patches: Patches,
    is_warm: bool,
}

/// Roundings of the energy of a body that tractions leave at rest.
const ROUNDINGS: f64 = 64.0;
/// Corrections of the discrete stress until its forces are round-off.
const CORRECTIONS: usize = 2;

impl Majorant {
    /// Prepares the bounds.
    ///
    /// # Errors
    /// If there is no bound for the problem.
    pub fn new(problem: &Problem, discrete: &Discretization) -> Result<Majorant, Refused> {
        scope::check(problem, discrete)?;
        scope::check_memory(&problem.mesh, machine::memory())?;
        Ok(Majorant { skeleton: Skeleton::new(&problem.mesh)?, system: None, shared: None })
    }

    /// The bound of the error of the step that led to a state.
    ///
    /// # Errors
    /// If there is no bound for the step.
    pub fn at(
        &mut self,
        problem: &Problem,
        discrete: &Discretization,
        (state, report): (&State, &StepReport),
    ) -> Result<DiscretizationError, Refused> {
        let (made, rule) = scope::rule_of(problem, state, report)?;
        let gamma = rule.gamma;
        let before: Vec<f64> = state.u.iter().zip(&state.w).map(|(u, w)| u - made.k * w).collect();
        let theta = scope::temperature(problem, discrete, state)?;
        let contacts: Vec<Contact> = problem
            .contacts
            .iter()
            .map(|contact| contact.at_time(state.t).unwrap_or_else(|| contact.clone()))
            .collect();
        let branches = discrete.branches.iter().zip(&state.branches);
        let relaxing = branches.filter_map(|(branches, z)| {
            let (time, _) = branches.uniform()?;
            Some(RelaxingStress::new(problem, time, rule, (z, &state.u)))
        });
        let laws = StepLaws::new(problem, if rule.is_steady() { 0.0 } else { gamma.recip() }, relaxing.collect())?;
        let mut remarks = Remarks::default();
        scope::remark(problem, &laws, &contacts, state.t, &mut remarks);
        let discrete_motion = StepMotion { u: &state.u, before: &before, theta };
        let solved = SolvedContact {
            problem,
            contacts: &contacts,
            boundary: &discrete.boundary,
            space: &discrete.v,
            states: &report.contact.states,
            temperature: theta,
            t: state.t,
            gamma,
        };
        let mut touching = Touching::new(solved, &self.skeleton, &discrete_motion)?;
        touching.remark(&mut remarks);
        let repaired = touching.admissible(&state.u)?;
        if repaired.is_some() && problem.mesh.axisymmetric {
            remarks.estimate("a side of a body of revolution penetrates between nodes: its repair is no polynomial");
        }
        let u = repaired.as_ref().unwrap_or(&state.u);
        let motion = StepMotion { u, ..discrete_motion };
        touching.press(&laws, &self.skeleton, &motion);
        let mut given = self.given(problem, discrete, state.t, &mut remarks);
        let mut right = discrete.f.at(state.t).to_vec();
        touching.enter(&self.skeleton, &mut given, &mut right);
        let (corrected, inner) = self.corrected(problem, discrete, (&laws, rule), &motion, &right)?;
        let balanced_motion = StepMotion { u: &corrected, ..motion };
        self.share((&laws, rule), &given, !theta.is_empty())?;
        let Some((_, shared)) = &self.shared else { return Err(held_by_contact()) };
        let is_loaded = problem.body_force.iter().any(|force| !force.is_zero()) || !problem.region_loads.is_empty();
        let step = MadeStep { skeleton: &self.skeleton, laws: &laws, problem, t: state.t, shared, is_loaded };
        let parts = step.parts(&given, (&balanced_motion, &inner), (&motion, &touching))?;
        // The energy that the tractions on Γ_C would cause: they work on displacements of round-off.
        let round_off = ROUNDINGS * f64::EPSILON * 0.5 * parts.softness * touching.largest_traction().powi(2);
        Ok(DiscretizationError { round_off, ..step.sum(parts, (&state.u, repaired.as_deref()), remarks) })
    }

    /// Makes what the steps of a rule share, if it is not known.
    fn share(&mut self, (laws, rule): (&StepLaws, Rule), given: &[FacetGiven], is_warm: bool) -> Result<(), Refused> {
        let skeleton = &self.skeleton;
        let fits = |(known, shared): &(Rule, SharedShapes)| *known == rule && shared.is_warm == is_warm;
        if !self.shared.as_ref().is_some_and(fits) {
            self.shared = None;
            let shapes = CellShapes::new(laws, skeleton, is_warm)?;
            let patches = Patches::new(&PatchData { mesh: laws.mesh, skeleton, given, shapes: &shapes });
            self.shared = Some((rule, SharedShapes { shapes, patches, is_warm }));
        }
        Ok(())
    }

    /// What is known of the tractions on the facets: zero outside, loads, and directions that are held.
    fn given(&self, problem: &Problem, discrete: &Discretization, t: f64, remarks: &mut Remarks) -> Vec<FacetGiven> {
        let of = |facet: &skeleton::SkeletonFacet| {
            let n = facet.vertices.len();
            if facet.cells.len() > 1 { FacetGiven::inner(n) } else { FacetGiven::outer(n) }
        };
        let mut given: Vec<FacetGiven> = self.skeleton.facets.iter().map(of).collect();
        for condition in &problem.boundary {
            let Some(set) = problem.mesh.facets.get(&condition.on) else { continue };
            for prescription in condition.prescriptions(&discrete.mesh) {
                for (element, nodes) in set.facets() {
                    if let Some(facet) = self.skeleton.find(element, nodes) {
                        given[facet].release(&prescription.direction);
                    }
                }
            }
            self.load(problem, (condition, set), t, (&mut given, remarks));
        }
        given
    }

    /// Adds the moments of the loads of a condition.
    fn load(
        &self,
        problem: &Problem,
        (condition, set): (&BoundaryCondition, &FacetSet),
        t: f64,
        (given, remarks): (&mut [FacetGiven], &mut Remarks),
    ) {
        let mesh = &problem.mesh;
        let size = mesh.measure(set);
        let BoundaryCondition { traction, force, pressure, .. } = condition;
        let fields: Vec<&Field> = traction.iter().flatten().chain(force.iter().flatten()).chain(pressure).collect();
        if fields.iter().all(|field| field.is_zero()) {
            return;
        }
        if fields.iter().any(|field| field.depends_on_space()) {
            remarks
                .estimate("a traction varies in space: its deviation from a linear one on each facet is not counted");
        }
        let value = |fields: &Option<Vec<Field>>, c: usize, x: &Point| {
            fields.as_ref().and_then(|fields| fields.get(c)).map_or(0.0, |field| field.value(x, t))
        };
        for (element, nodes) in set.facets() {
            let Some(facet) = self.skeleton.find(element, nodes) else { continue };
            let rule = crate::quadrature::rule(element.shape, crate::forms::data_degree(element));
            let points = rule.points.clone();
            let table = crate::element::ShapeTable::of_rule(element, rule);
            let mut map = FacetMap::new(mesh, &table);
            for (q, reference) in points.iter().enumerate() {
                map.at(nodes, q);
                let x = &map.position;
                let p = pressure.as_ref().map_or(0.0, |field| field.value(x, t));
                let traction: Point =
                    std::array::from_fn(|c| value(traction, c, x) + value(force, c, x) / size - p * map.normal[c]);
                let hats = skeleton::linear_functions(element.shape, element, reference);
                for (hat, &node) in hats.iter().zip(nodes) {
                    if let Some(place) = self.skeleton.facets[facet].place(node) {
                        let weight = table.weights[q] * map.area * hat;
                        given[facet].add(place, weight, &traction);
                    }
                }
            }
        }
    }

    /// A displacement near that of the step whose stress balances the forces in `right` on the mesh, and the forces of
    /// its stress per cell and node.
    fn corrected(
        &mut self,
        problem: &Problem,
        discrete: &Discretization,
        (laws, rule): (&StepLaws, Rule),
        motion: &StepMotion,
        right: &[f64],
    ) -> Result<(Vec<f64>, Vec<Vec<Point>>), Refused> {
        if self.system.as_ref().is_none_or(|(known, _)| *known != rule) {
            let matrix = Arc::new(discrete.mechanical_matrix(rule));
            let layout = Layout::of(&discrete.mesh, &discrete.v, &[]);
            let system = System::new(&problem.backend, &matrix, &layout).map_err(|_| held_by_contact())?;
            self.system = Some((rule, system));
        }
        let mut u = motion.u.to_vec();
        let Some((_, system)) = &mut self.system else { return Err(held_by_contact()) };
        let mut corrections = 0;
        loop {
            let (rest, largest, forces) = residual(laws, &self.skeleton, &StepMotion { u: &u, ..*motion }, right);
            let mut x = system.unknowns().gather(&rest);
            let left = max_abs(&x) / largest.max(max_abs(right)).max(f64::MIN_POSITIVE);
            if left <= BALANCED || corrections == CORRECTIONS {
                return if left.is_nan() || left > LEFT { Err(held_by_contact()) } else { Ok((u, forces)) };
            }
            system.solve(&mut x).map_err(|_| held_by_contact())?;
            let mut change = vec![0.0; u.len()];
            system.unknowns().add(&x, &mut change);
            u.iter_mut().zip(&change).for_each(|(u, change)| *u += rule.gamma * change);
            corrections += 1;
        }
    }
}

/// What of the balance of the nodes is round-off, relative to the largest force.
const BALANCED: f64 = 1e-14;
/// What may be left of the balance of the nodes, relative to the largest force: more is a body that nothing holds.
const LEFT: f64 = 1e-9;

fn held_by_contact() -> Refused {
    Refused::new("a body that contact alone holds")
}

/// What is left of the balance of the nodes, the largest force of a cell on a node, and these forces, N.
fn residual(
    laws: &StepLaws,
    skeleton: &Skeleton,
    motion: &StepMotion,
    right: &[f64],
) -> (Vec<f64>, f64, Vec<Vec<Point>>) {
    let dim = laws.mesh.dim;
    let forces: Vec<Vec<Point>> =
        (0..skeleton.cells.len()).into_par_iter().map(|cell| laws.forces(skeleton, cell, motion)).collect();
    let (mut rest, mut largest) = (right.to_vec(), 0.0f64);
    for (cell, forces) in forces.iter().enumerate() {
        for (&node, force) in skeleton.nodes(laws.mesh, cell).iter().zip(forces) {
            largest = largest.max(dot(force, force));
            (0..dim).for_each(|c| rest[node as usize * dim + c] -= force[c]);
        }
    }
    (rest, largest.sqrt(), forces)
}

/// A step whose stress in balance is made.
struct MadeStep<'a> {
    skeleton: &'a Skeleton,
    laws: &'a StepLaws<'a>,
    problem: &'a Problem,
    t: f64,
    shared: &'a SharedShapes,
    /// True if a body force may act.
    is_loaded: bool,
}

/// Parts of the energy: per cell from the body, and per contact facet with its cell.
struct EnergyParts {
    cells: Vec<f64>,
    contact: Vec<(usize, f64)>,
    /// ∫ of the size of the compliance, m³/Pa.
    softness: f64,
}

impl MadeStep<'_> {
    /// ∫ σ∇φ − ∫ f φ per vertex of a cell, from the forces of the stress per node.
    fn forces(&self, cell: usize, motion: &StepMotion, inner: &[Point]) -> CellForces {
        let (mesh, tables) = (self.laws.mesh, self.skeleton.tables(cell));
        let nodes = self.skeleton.nodes(mesh, cell);
        let region = self.laws.region(self.skeleton, cell);
        let (mut outer, mut volume, mut softness) = (vec![[0.0; 3]; nodes.len()], 0.0, 0.0);
        let table = if self.is_loaded { &tables.load } else { &tables.body };
        self.laws.integrate(table, nodes, |map, weight| {
            if self.is_loaded {
                let load = self.body_force(region, map);
                for (force, value) in outer.iter_mut().zip(map.values()) {
                    (0..3).for_each(|c| force[c] += weight * value * load[c]);
                }
            }
            volume += weight;
            softness += weight * self.laws.softness(region, &map.position);
        });
        let (mut load, mut rest) = ([[0.0; 3]; 8], [[0.0; 3]; 8]);
        for ((load, rest), hats) in load.iter_mut().zip(&mut rest).zip(&tables.hats) {
            for ((hat, outer), inner) in hats.iter().zip(&outer).zip(inner) {
                (0..3).for_each(|c| load[c] += hat * outer[c]);
                (0..3).for_each(|c| rest[c] += hat * (inner[c] - outer[c]));
            }
        }
        // The hoop stress loads the plane of a body of revolution.
        if mesh.axisymmetric {
            let hoops = self.laws.hoop_forces(self.skeleton, cell, motion);
            for (load, hats) in load.iter_mut().zip(&tables.hats) {
                load[0] -= hats.iter().zip(&hoops).map(|(hat, hoop)| hat * hoop).sum::<f64>();
            }
        }
        CellForces { rest, load, softness, volume }
    }

    fn body_force(&self, region: usize, map: &CellMap) -> Point {
        let x = &map.position;
        let value = |fields: &[Field], c: usize| fields.get(c).map_or(0.0, |field| field.value(x, self.t));
        let of_region = self.problem.region_loads.iter().filter(|load| load.region == region);
        let mut force: Point = std::array::from_fn(|c| value(&self.problem.body_force, c));
        for load in of_region {
            let (gravity, density) = load.gravity.as_ref().map_or((&[][..], 0.0), |(g, rho)| (&g[..], rho.at(x)));
            (0..3).for_each(|c| force[c] += value(&load.body_force, c) + density * value(gravity, c));
        }
        force
    }

    fn parts(
        &self,
        given: &[FacetGiven],
        (balanced_motion, inner): (&StepMotion, &[Vec<Point>]),
        (motion, touching): (&StepMotion, &Touching),
    ) -> Result<EnergyParts, Refused> {
        let cells = 0..self.skeleton.cells.len();
        let forces: Vec<CellForces> =
            cells.clone().into_par_iter().map(|cell| self.forces(cell, balanced_motion, &inner[cell])).collect();
        let stress = |cell: usize| CellStress::new(self.laws, self.skeleton, balanced_motion, cell);
        let stresses: Vec<CellStress> = cells.clone().into_par_iter().map(stress).collect();
        let (means, weights) = means(self.skeleton, &forces, &stresses);
        drop(stresses);
        let moments = balanced(self.skeleton, self.laws.mesh.dim, given, &forces, (&means, &weights))?;
        let SharedShapes { shapes, patches, .. } = self.shared;
        let (mesh, skeleton) = (self.laws.mesh, self.skeleton);
        let body_force = |region: usize, map: &CellMap| self.body_force(region, map);
        let evaluation = EnergyEvaluation { laws: self.laws, skeleton, motion, shapes, body_force: &body_force };
        let of_cell = |cell: usize| evaluation.of_cell(cell, &forces[cell]);
        let energies = cells.into_par_iter().map(of_cell).collect::<Result<Vec<CellEnergy>, Refused>>()?;
        let descent = TractionDescent { mesh, skeleton, given, energies: &energies, patches };
        let cells = descent.least(&moments, &forces)?;
        let of_facet = |facet: &contact::ContactFacet| {
            let cell = self.skeleton.facets[facet.facet].cells.first().map_or(0, |first| first.0);
            (cell, touching.term(facet, motion.u))
        };
        let softness = forces.iter().map(|cell| cell.softness).sum();
        Ok(EnergyParts { cells, softness, contact: touching.facets.par_iter().map(of_facet).collect() })
    }

    /// The square of the norm of a field per cell.
    fn norms(&self, u: &[f64]) -> Vec<f64> {
        let of_cell = |cell: usize| {
            let (region, nodes) = (self.laws.region(self.skeleton, cell), self.skeleton.nodes(self.laws.mesh, cell));
            let mut sum = 0.0;
            self.laws.integrate(&self.skeleton.tables(cell).body, nodes, |map, weight| {
                sum += weight * self.laws.energy(region, map, nodes, u);
            });
            sum
        };
        (0..self.skeleton.cells.len()).into_par_iter().map(of_cell).collect()
    }

    fn sum(
        &self,
        parts: EnergyParts,
        (u, repaired): (&[f64], Option<&[f64]>),
        remarks: Remarks,
    ) -> DiscretizationError {
        let EnergyParts { mut cells, contact, .. } = parts;
        let mesh: f64 = cells.iter().sum();
        let on_contact: f64 = contact.iter().map(|(_, energy)| energy).sum();
        for (cell, energy) in &contact {
            cells[*cell] += energy;
        }
        let repair = repaired.map_or(0.0, |repaired| {
            let change: Vec<f64> = u.iter().zip(repaired).map(|(a, b)| a - b).collect();
            0.5 * self.norms(&change).iter().sum::<f64>()
        });
        // ‖u_h − u‖ ≤ ‖u_h − ũ‖ + ‖ũ − u‖.
        let energy = ((mesh + on_contact).sqrt() + repair.sqrt()).powi(2);
        DiscretizationError {
            energy,
            mesh,
            contact: on_contact,
            repair,
            of_solution: 0.5 * self.norms(u).iter().sum::<f64>(),
            round_off: 0.0,
            cells,
            estimate: remarks.estimate,
            notes: remarks.notes,
        }
    }
}

/// True if two unit vectors are equal up to round-off.
fn is_along(a: &Point, b: &Point) -> bool {
    length(&std::array::from_fn(|c| a[c] - b[c])) < 1e-7
}
