//! Problem 2.1 with its data: what is to be solved, checked once and trusted afterwards.

mod boundary;
mod data;
mod physics;
mod range;

use std::fmt;
use std::sync::Arc;

pub use boundary::{BoundaryCondition, Convection, Support};
pub(crate) use data::Datum;
pub use physics::Physics;

use crate::contact::{Contact, ContactBoundary};
use crate::field::Field;
use crate::material::{Dilatation, Material, Prony};
use crate::mesh::defects::{Component, components};
use crate::mesh::{FacetSet, Mesh};
use crate::units::{Extent, System, Units};

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

/// A problem with all its data, checked.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Name, used for result folders and titles.
    pub name: String,
    /// Whether the data are in SI units or without units.
    pub system: System,
    /// The body.
    pub mesh: Arc<Mesh>,
    /// T in s.
    pub end: f64,
    /// N, the number of steps; k = T/N.
    pub steps: usize,
    /// The equations that are solved.
    pub physics: Physics,
    /// The materials by region, as [`Mesh::regions`] lists them, or one for all.
    pub materials: Vec<Material>,
    /// f₀ in N/m³, one field per component; empty for zero.
    pub body_force: Vec<Field>,
    /// q₀ in W/m³.
    pub heat_source: Field,
    /// Conditions on the parts of the boundary; at a node of two parts the first entry that prescribes a value holds.
    pub boundary: Vec<BoundaryCondition>,
    /// Contact of sides with their foundations, each side once.
    pub contacts: Vec<Contact>,
    /// Initial data.
    pub initial: Initial,
    /// How mechanics and heat are coupled within a step.
    pub coupling: Coupling,
    /// The strain that elasticity and viscosity see.
    pub dilatation: Dilatation,
}

impl Problem {
    /// The units of its numbers.
    #[must_use]
    pub fn units(&self) -> Units {
        let extent = match self.mesh.dim {
            1 => Extent::Line,
            2 if self.mesh.axisymmetric => Extent::Revolution,
            2 => Extent::Plane,
            _ => Extent::Space,
        };
        Units { system: self.system, extent }
    }

    /// Length of a time step, s.
    #[must_use]
    pub fn k(&self) -> f64 {
        self.end / self.steps as f64
    }

    /// t_n = n k, with t_N = T to the last bit.
    #[must_use]
    pub fn time(&self, n: usize) -> f64 {
        self.end * (n as f64 / self.steps as f64)
    }

    /// The material of a region of the mesh; none where there are no materials.
    #[must_use]
    pub fn material_of(&self, region: usize) -> Option<&Material> {
        self.materials.get(region).or(self.materials.last())
    }

    /// The relaxation times of all materials, s, ascending, each once.
    #[must_use]
    pub fn relaxation_times(&self) -> Vec<f64> {
        let branches = self.materials.iter().filter_map(|material| material.prony.as_ref()).flat_map(Prony::branches);
        let mut times: Vec<f64> = branches.map(|branch| branch.time).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// The place of a contact in the case file: `contact`, or `contact[1]` where there are several.
    #[must_use]
    pub fn contact_path(&self, side: usize) -> String {
        if self.contacts.len() == 1 { "contact".to_owned() } else { format!("contact[{side}]") }
    }

    /// Γ_C with the contact points of all sides; sides that the mesh does not have are left out.
    #[must_use]
    pub fn contact_boundary(&self) -> ContactBoundary {
        static NONE: FacetSet = FacetSet { blocks: Vec::new() };
        let sides: Vec<_> = self.contacts.iter().map(|contact| (self.mesh.facets.get(&contact.on).unwrap_or(&NONE), contact.quadrature)).collect();
        ContactBoundary::on(&self.mesh, &sides)
    }

    /// The facets of Γ_C; none without contact.
    #[must_use]
    pub fn contact_facets(&self) -> Option<FacetSet> {
        let mut sets = self.contacts.iter().filter_map(|contact| self.mesh.facets.get(&contact.on)).cloned();
        let mut all = sets.next()?;
        sets.for_each(|set| all.blocks.extend(set.blocks));
        Some(all)
    }

    /// Checks the data and returns the problem.
    ///
    /// # Errors
    /// All faults that the data have, with the place of each named as in a case file.
    pub fn checked(self) -> Result<Problem, Faults> {
        let mut faults = Vec::new();
        self.check_time(&mut faults);
        self.check_material(&mut faults);
        if let Err(error) = self.mesh.check_nodes() {
            faults.push(Fault::new("mesh", error.to_string(), "cells and facets whose nodes exist"));
            return Err(Faults(faults));
        }
        self.check_parts(&mut faults);
        self.check_shapes(&mut faults);
        self.check_boundary(&mut faults);
        self.check_times(&mut faults);
        if let Err(error) = self.mesh.check() {
            faults.push(Fault::new("mesh", error.to_string(), "cells of positive measure"));
        }
        if faults.is_empty() {
            // Both evaluate the data, which must be in order.
            self.check_temperatures(&mut faults);
            self.check_range(&mut faults);
        }
        if faults.is_empty() { Ok(self) } else { Err(Faults(faults)) }
    }

    fn check_time(&self, faults: &mut Vec<Fault>) {
        if !(self.end.is_finite() && self.end > 0.0) {
            faults.push(Fault::new("time.end", self.end.to_string(), "a positive time in s"));
        }
        if self.steps == 0 {
            faults.push(Fault::new("time.steps", "0", "at least one step"));
        }
    }

    fn check_material(&self, faults: &mut Vec<Fault>) {
        let (found, regions) = (self.materials.len(), self.mesh.regions.len());
        if found != 1 && found != regions {
            faults.push(Fault::new("material", format!("{found} materials"), format!("one for all, or one for each of the {regions} regions")));
        }
        for m in &self.materials {
            for (path, value) in [("material.density", m.density), ("material.heat_capacity", m.heat_capacity)] {
                if !(value.is_finite() && value >= 0.0) {
                    faults.push(Fault::new(path, value.to_string(), "a number that is not negative"));
                }
            }
        }
    }

    /// Each part of the body that is not held somewhere has inertia, and heat capacity if its temperature is not.
    ///
    /// A part without inertia or without heat capacity anywhere in it needs the hold.
    fn check_parts(&self, faults: &mut Vec<Fault>) {
        let parts = components(&self.mesh);
        let mut part_of = vec![0; self.mesh.points.len()];
        for (number, part) in parts.iter().enumerate() {
            for &node in &part.nodes {
                part_of[node as usize] = number;
            }
        }
        // What every part has: a displacement that is held, a temperature that is held; and what it lacks: ρ, c.
        let mut held = vec![[false; 2]; parts.len()];
        let mut lacks = vec![[false; 2]; parts.len()];
        let exchange = self.contacts.iter().filter(|c| c.heat.conductance_bound() > 0.0).map(|c| (c.on.as_str(), [false, true]));
        let sides = self.boundary.iter().map(|b| (b.on.as_str(), [b.holds_body(), b.holds_temperature()])).chain(exchange);
        for (on, holds) in sides {
            // Of a side that is not there it is not known what it holds: that it is not there is told.
            let nodes = self.mesh.facets.get(on).map(FacetSet::node_list);
            let touched = nodes.map(|nodes| nodes.into_iter().filter_map(|node| part_of.get(node as usize).copied()).collect());
            for part in touched.unwrap_or_else(|| (0..parts.len()).collect::<Vec<usize>>()) {
                if let Some(part) = held.get_mut(part) {
                    *part = [part[0] || holds[0], part[1] || holds[1]];
                }
            }
        }
        for block in &self.mesh.blocks {
            let Some(m) = self.material_of(block.region) else { continue };
            for cell in block.cells() {
                let part = &mut lacks[part_of[cell[0] as usize]];
                *part = [part[0] || m.density == 0.0, part[1] || m.heat_capacity == 0.0];
            }
        }
        for (what, found, expected, hint) in [
            (0, "no displacement prescribed and density 0", "a part Γ_D that holds the body", "give `displacement` on a side, or a positive material.density"),
            (
                1,
                "no temperature prescribed and heat_capacity 0",
                "a side whose temperature is known",
                "give `temperature` on a side, or a positive material.heat_capacity",
            ),
        ] {
            let solved = [self.physics.has_mechanics(), self.physics.has_heat()][what];
            let Some(number) = (0..parts.len()).find(|&part| solved && lacks[part][what] && !held[part][what]) else { continue };
            let found =
                if parts.len() == 1 { found.to_owned() } else { format!("{found} in part {} of the body, {}", number + 1, extent(&parts[number], &self.mesh)) };
            faults.push(Fault::new("boundary", found, expected).hint(hint));
        }
    }

    /// Tables have values at all times of the run.
    fn check_times(&self, faults: &mut Vec<Fault>) {
        let mut check = |path: String, field: &Field| {
            let [first, last] = field.span();
            let hint = "give more rows, or `extend = \"hold\"` to keep the value at the end";
            if first > 0.0 {
                faults.push(Fault::new(&*path, format!("a table that begins at t = {first:?}"), "values from t = 0").hint(hint));
            }
            if last < self.end {
                faults.push(
                    Fault::new(path, format!("a table that ends at t = {last:?}"), format!("values to the end of the run, t = {:?}", self.end)).hint(hint),
                );
            }
        };
        for (i, field) in self.body_force.iter().enumerate() {
            check(format!("load.body_force[{i}]"), field);
        }
        check("load.heat_source".to_owned(), &self.heat_source);
        for (i, condition) in self.boundary.iter().enumerate() {
            for (key, field) in condition.fields() {
                check(format!("boundary[{i}].{key}"), field);
            }
        }
        for (path, field) in self.contact_fields() {
            check(path, field);
        }
    }

    /// The data of contact that may vary in time, with their places.
    pub(crate) fn contact_fields(&self) -> Vec<(String, &Field)> {
        let mut all = Vec::new();
        for (side, contact) in self.contacts.iter().enumerate() {
            let path = self.contact_path(side);
            all.push((format!("{path}.gap"), &contact.gap));
            all.push((format!("{path}.heat.foundation_temperature"), &contact.foundation_temperature));
            all.extend(contact.foundation_velocity.iter().enumerate().map(|(c, field)| (format!("{path}.foundation_velocity[{c}]"), field)));
            all.extend(contact.foundation_heat.iter().map(|foundation| (format!("{path}.foundation.surroundings"), &foundation.surroundings)));
            let obstacle = contact.obstacle.iter().flat_map(|obstacle| obstacle.fields());
            all.extend(obstacle.map(|(key, field)| (format!("{path}.obstacle.{key}"), field)));
        }
        all
    }

    /// Vector data have d components.
    fn check_shapes(&self, faults: &mut Vec<Fault>) {
        let dim = self.mesh.dim;
        let mut check = |path: String, found: Option<usize>| {
            if let Some(n) = found
                && n != dim
            {
                faults.push(Fault::new(path, format!("{n} components"), format!("{dim} components")));
            }
        };
        let filled = |v: &Vec<Field>| if v.is_empty() { None } else { Some(v.len()) };
        check("load.body_force".into(), filled(&self.body_force));
        check("initial.displacement".into(), filled(&self.initial.displacement));
        check("initial.velocity".into(), filled(&self.initial.velocity));
        for (i, b) in self.boundary.iter().enumerate() {
            check(format!("boundary[{i}].displacement"), b.displacement.as_ref().map(Vec::len));
            check(format!("boundary[{i}].traction"), b.traction.as_ref().map(Vec::len));
            check(format!("boundary[{i}].spring"), b.spring.as_ref().and_then(Support::components));
            check(format!("boundary[{i}].dashpot"), b.dashpot.as_ref().and_then(Support::components));
        }
    }
}

/// Where a part of the body is: `x from 0.0 to 1.0, y from 2.0 to 3.0`.
fn extent(part: &Component, mesh: &Mesh) -> String {
    let [low, high] = part.bounds(mesh);
    let along = |(c, axis): (usize, &str)| format!("{axis} from {:?} to {:?}", low[c], high[c]);
    ["x", "y", "z"].into_iter().take(mesh.dim).enumerate().map(along).collect::<Vec<_>>().join(", ")
}
