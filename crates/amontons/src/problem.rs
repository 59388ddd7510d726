//! Problem 2.1 with its data: what is to be solved, checked once and trusted afterwards.

use std::fmt;
use std::sync::Arc;

use crate::contact::Contact;
use crate::field::Field;
use crate::material::Material;
use crate::mesh::Mesh;

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

/// What holds on one named part of the boundary, contact apart.
#[derive(Clone, Debug, Default)]
pub struct BoundaryCondition {
    /// Name of the facet set.
    pub on: String,
    /// Prescribed displacement, m, one field a component: (2.5).
    pub displacement: Option<Vec<Field>>,
    /// Traction f₁, Pa, one field a component: (2.6).
    pub traction: Option<Vec<Field>>,
    /// Prescribed temperature, K: (2.7).
    pub temperature: Option<Field>,
    /// Heat flux into the body −q·ν, W/m².
    pub heat_inflow: Option<Field>,
}

/// u₀, u̇₀ and θ₀ of (2.11).
#[derive(Clone, Debug, Default)]
pub struct Initial {
    /// u₀ in m, one field a component; empty for zero.
    pub displacement: Vec<Field>,
    /// u̇₀ in m/s, one field a component; empty for zero.
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
    /// The body.
    pub mesh: Arc<Mesh>,
    /// T in s.
    pub end: f64,
    /// N, the number of steps; k = T/N.
    pub steps: usize,
    /// The material.
    pub material: Material,
    /// f₀ in N/m³, one field a component; empty for zero.
    pub body_force: Vec<Field>,
    /// q₀ in W/m³.
    pub heat_source: Field,
    /// Conditions on the parts of the boundary; at a node of two parts the first entry that prescribes a value holds.
    pub boundary: Vec<BoundaryCondition>,
    /// Contact, if any.
    pub contact: Option<Contact>,
    /// Initial data.
    pub initial: Initial,
    /// How mechanics and heat are coupled within a step.
    pub coupling: Coupling,
}

impl Problem {
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

    /// Checks the data and returns the problem.
    ///
    /// # Errors
    /// All faults that the data have, with the place of each named as in a case file.
    pub fn checked(self) -> Result<Problem, Faults> {
        let mut faults = Vec::new();
        self.check_time(&mut faults);
        self.check_material(&mut faults);
        self.check_shapes(&mut faults);
        self.check_boundary(&mut faults);
        if let Err(error) = self.mesh.check() {
            faults.push(Fault::new("mesh", error.to_string(), "cells of positive measure"));
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
        let m = &self.material;
        for (path, value) in [("material.density", m.density), ("material.heat_capacity", m.heat_capacity)] {
            if !(value.is_finite() && value >= 0.0) {
                faults.push(Fault::new(path, value.to_string(), "a number that is not negative"));
            }
        }
        if m.density == 0.0 && !self.boundary.iter().any(|b| b.displacement.is_some()) {
            faults.push(
                Fault::new("boundary", "no displacement prescribed and density 0", "a part Γ_D that holds the body")
                    .hint("give `displacement` on a side, or a positive material.density"),
            );
        }
        if m.heat_capacity == 0.0
            && !self.boundary.iter().any(|b| b.temperature.is_some())
            && self.contact.as_ref().is_none_or(|c| c.heat.conductance_bound() <= 0.0)
        {
            faults.push(
                Fault::new("boundary", "no temperature prescribed and heat_capacity 0", "a side whose temperature is known")
                    .hint("give `temperature` on a side, or a positive material.heat_capacity"),
            );
        }
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
        }
    }

    /// Sides exist, are named once, and bear no two conditions that exclude each other.
    fn check_boundary(&self, faults: &mut Vec<Fault>) {
        let known: Vec<&str> = self.mesh.facets.keys().map(String::as_str).collect();
        let mut exists = |path: String, name: &str| {
            let found = self.mesh.facets.contains_key(name);
            if !found {
                let near = known.iter().min_by_key(|k| strsim::damerau_levenshtein(k, name));
                let mut fault = Fault::new(path, format!("\"{name}\""), format!("one of the facet sets {}", known.join(", ")));
                if let Some(near) = near.filter(|k| strsim::damerau_levenshtein(k, name) <= 2) {
                    fault = fault.hint(format!("did you mean \"{near}\"?"));
                }
                faults.push(fault);
            }
        };
        for (i, b) in self.boundary.iter().enumerate() {
            exists(format!("boundary[{i}].on"), &b.on);
        }
        if let Some(contact) = &self.contact {
            exists("contact.on".into(), &contact.on);
        }
        for (i, b) in self.boundary.iter().enumerate() {
            if let Some(first) = self.boundary[..i].iter().position(|other| other.on == b.on) {
                faults.push(
                    Fault::new(format!("boundary[{i}].on"), format!("\"{}\" again", b.on), "each side in one [[boundary]] entry")
                        .hint(format!("join it with entry {} of the file, which is on the same side", first + 1)),
                );
            }
            if b.displacement.is_some() && b.traction.is_some() {
                faults.push(
                    Fault::new(format!("boundary[{i}].traction"), "a traction besides a displacement", "one of the two: Γ_D and Γ_N do not overlap")
                        .hint("drop one of them"),
                );
            }
            if b.temperature.is_some() && b.heat_inflow.is_some() {
                faults.push(Fault::new(format!("boundary[{i}].heat_inflow"), "a heat inflow besides a temperature", "one of the two").hint("drop one of them"));
            }
            if let Some(contact) = self.contact.as_ref().filter(|c| c.on == b.on) {
                if b.displacement.is_some() {
                    faults.push(
                        Fault::new(format!("boundary[{i}].displacement"), format!("a displacement on \"{}\"", b.on), "Γ_D apart from Γ_C")
                            .hint("[contact] is on the same side; a side that bears contact takes `traction` and `heat_inflow` only"),
                    );
                }
                if b.temperature.is_some() && contact.heat.conductance_bound() > 0.0 {
                    faults.push(
                        Fault::new(format!("boundary[{i}].temperature"), format!("a temperature on \"{}\"", b.on), "heat exchange or a temperature, not both")
                            .hint("drop contact.heat or the temperature"),
                    );
                }
            }
        }
    }
}
