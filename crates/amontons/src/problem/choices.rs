//! The choices that the program makes where a case leaves them open. All of them are reported.

use serde::{Deserialize, Serialize};

use super::{Coupling, ProblemData};
use crate::contact::{Contact, Quadrature};
use crate::material::Dilatation;
use crate::time::{Analysis, Instant, Steps, TimePhase, TimeScheme};
use crate::units::Measure;

/// A choice: its subject, the value taken, and the reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Choice {
    /// Subject of the choice, as the key of the case names it.
    pub what: String,
    /// The value taken.
    pub value: String,
    /// The reason, or its meaning.
    pub why: String,
}

impl Choice {
    /// A choice.
    #[must_use]
    pub fn new(what: impl Into<String>, value: impl Into<String>, why: impl Into<String>) -> Choice {
        Choice { what: what.into(), value: value.into(), why: why.into() }
    }
}

impl ProblemData {
    /// All choices of the problem: those made while it was built, the scheme, its coupling, the dilatation and the
    /// contact points.
    #[must_use]
    pub fn choices(&self) -> Vec<Choice> {
        let scheme = match self.scheme {
            TimeScheme::BackwardEuler => {
                Choice::new("scheme", "backward Euler", "of first order; it damps what oscillates within few steps")
            }
            TimeScheme::Theta { level, .. } => {
                let why = "of second order at ϑ = 0.5; pressures and friction are means of the step";
                Choice::new("scheme", format!("ϑ-scheme, ϑ = {level}"), why)
            }
            TimeScheme::Bdf2 => {
                Choice::new("scheme", "BDF2", "of second order; it damps what oscillates within few steps")
            }
            TimeScheme::ContactStabilised => {
                let why = "of second order without impacts; rigid foundations are met exactly at the end of each step";
                Choice::new("scheme", "contact-stabilised Newmark", why)
            }
        };
        let mut all = vec![scheme];
        all.extend(self.choice_of_phases());
        all.extend(self.choice_of_impacts());
        all.extend(self.choice_of_mass());
        all.extend(self.chosen.iter().cloned());
        all.extend(self.choice_of_coupling());
        if self.physics.has_mechanics() {
            all.extend(self.choice_of_dilatation());
        }
        let places = |contact: &Contact| match contact.quadrature {
            Quadrature::Nodal => "nodal",
            Quadrature::Gauss => "gauss",
        };
        if let Some(first) = self.contacts.first() {
            let same = self.contacts.iter().all(|contact| places(contact) == places(first));
            let (value, why) = match places(first) {
                _ if !same => ("nodal and gauss", "as each contact says"),
                "nodal" => ("nodal", "the laws of contact hold at the nodes of the side"),
                other => (other, "the laws of contact hold at points within the facets"),
            };
            all.push(Choice::new("quadrature", value, why));
        }
        all
    }

    /// The coupling of mechanics and heat, if both are solved.
    fn choice_of_coupling(&self) -> Option<Choice> {
        let is_steady = |phase: &TimePhase| phase.analysis == Analysis::Steady;
        let coupling = if self.timeline.phases().all(is_steady) { Coupling::Monolithic } else { self.coupling };
        let (value, why) = match coupling {
            Coupling::Staggered => ("staggered", "mechanics with the temperature of the step before, then heat"),
            Coupling::Extrapolated => ("extrapolated", "mechanics with an extrapolated temperature, then heat"),
            Coupling::FixedPoint => ("fixed-point", "both repeated until they agree"),
            Coupling::Monolithic => ("monolithic", "both at once"),
        };
        let differs = coupling != Coupling::Monolithic && self.timeline.phases().any(is_steady);
        let why = if differs { format!("{why}; in steady phases both at once") } else { why.to_owned() };
        (self.physics.has_mechanics() && self.physics.has_heat()).then(|| Choice::new("coupling", value, why))
    }

    /// The phases with their steps, if the run has them; else what is left out of its equations.
    fn choice_of_phases(&self) -> Option<Choice> {
        let timeline = &self.timeline;
        let write = |t: f64| self.units().write(t, Measure::Time);
        let of = |(phase, end): (&TimePhase, Instant)| {
            let TimePhase { name, steps, analysis, .. } = phase;
            let (analysis, until) = (analysis.name(), write(end.t));
            match steps {
                Steps::Equal(steps) => format!("{name}: {steps} {analysis} steps of {} to {until}", write(end.k)),
                Steps::Automatic { accuracy } => {
                    format!("{name}: {analysis} steps for an accuracy of {accuracy:?} to {until}")
                }
                Steps::Made(ends) => format!("{name}: {} {analysis} steps of several lengths to {until}", ends.len()),
            }
        };
        let names: Vec<&str> = timeline.phases().map(|phase| phase.name.as_str()).collect();
        let all: Vec<String> = timeline.phases().zip(timeline.ends_from(0)).map(of).collect();
        if timeline.has_phases() {
            return Some(Choice::new("phases", names.join(", "), all.join("; ")));
        }
        let why = match timeline.instant(1).analysis {
            Analysis::Dynamic => return None,
            Analysis::Quasistatic => "without inertia: in balance at the end of each step",
            Analysis::Steady => "the state that the data would lead to if they lasted",
        };
        Some(Choice::new("analysis", timeline.instant(1).analysis.name(), why))
    }

    /// How impacts on rigid foundations rebound, if the scheme has them.
    fn choice_of_impacts(&self) -> Option<Choice> {
        let TimeScheme::Theta { contact, .. } = self.scheme else { return None };
        let value = format!("restitution {}", contact.restitution);
        let why = "on a rigid foundation a point leaves an impact with this share of its velocity of approach";
        self.has_impacts().then(|| Choice::new("impacts", value, why))
    }

    /// Where the mass of the nodes in contact is, if it is moved.
    fn choice_of_mass(&self) -> Option<Choice> {
        let why = "nodes in contact have no mass: it is moved to nodes near them, and impacts lose no energy";
        (!self.massless_nodes().is_empty()).then(|| Choice::new("mass", "redistributed", why))
    }

    fn choice_of_dilatation(&self) -> Option<Choice> {
        let is_mean = |dilatation: Dilatation| dilatation == Dilatation::Mean;
        let mean = self.materials.iter().filter(|material| is_mean(material.dilatation)).count();
        let (value, why) = match mean {
            0 => ("full", "near ν = 0.5 linear cells lock: \"mean\" is for them"),
            some if some == self.materials.len() => ("mean", "the mean of each cell, against locking near ν = 0.5"),
            _ => ("full and mean", "as each region says"),
        };
        (!self.materials.is_empty() && self.mesh.dim > 1).then(|| Choice::new("dilatation", value, why))
    }
}
