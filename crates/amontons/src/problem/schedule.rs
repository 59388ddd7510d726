//! The conditions of each phase: those that act in it, by the list of all conditions of the run.

use std::borrow::Cow;
use std::sync::Arc;

use super::boundary::{BoundaryCondition, Convection, Release, unknown};
use super::{Fault, Initial, Problem, ProblemData, RegionLoad, RigidPart};
use crate::contact::Contact;
use crate::field::Field;
use crate::tensor::Point;
use crate::time::{During, TimePhase, Timeline};

/// All conditions of a run, and the phase whose conditions a problem has.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    pub all: Arc<Scheduled>,
    pub phase: usize,
}

/// What may act in some phases only.
#[derive(Clone, Debug)]
pub(super) struct Scheduled {
    pub boundary: Vec<BoundaryCondition>,
    pub contacts: Vec<Contact>,
    loads: Vec<RegionLoad>,
    rigid: Vec<RigidPart>,
}

impl Scheduled {
    pub fn of(data: &ProblemData) -> Scheduled {
        Scheduled {
            boundary: data.boundary.clone(),
            contacts: data.contacts.clone(),
            loads: data.region_loads.clone(),
            rigid: data.rigid.clone(),
        }
    }

    /// The data with these conditions in the place of their own.
    fn into_data(self, data: ProblemData) -> ProblemData {
        let Scheduled { boundary, contacts, loads, rigid } = self;
        ProblemData { boundary, contacts, region_loads: loads, rigid, ..data }
    }

    /// When each of them acts.
    fn durings(&self) -> impl Iterator<Item = &During> {
        let boundary = self.boundary.iter().map(|condition| &condition.during);
        let contacts = self.contacts.iter().map(|contact| &contact.during);
        let loads = self.loads.iter().map(|load| &load.during).chain(self.rigid.iter().map(|part| &part.during));
        boundary.chain(contacts).chain(loads)
    }

    fn change(&self) -> bool {
        self.durings().any(|during| *during != During::Run)
    }

    /// The conditions in a phase. Those that do not act there keep their places: a side is free and insulated, a
    /// contact is one that never acts, and a load is zero.
    fn in_phase(&self, timeline: &Timeline, phase: usize) -> Scheduled {
        let acts = |during: &During| timeline.phases().nth(phase).is_none_or(|phase| during.has(phase));
        let mut own = self.clone();
        for condition in own.boundary.iter_mut().filter(|condition| !acts(&condition.during)) {
            let free = BoundaryCondition::on(condition.on.clone());
            *condition = BoundaryCondition { during: During::NEVER, ..free };
        }
        for contact in own.contacts.iter_mut().filter(|contact| !acts(&contact.during)) {
            contact.during = During::NEVER;
        }
        for load in own.loads.iter_mut().filter(|load| !acts(&load.during)) {
            let keys = load.keys.clone();
            *load = RegionLoad { during: During::NEVER, keys, ..RegionLoad::on(load.region) };
        }
        for part in own.rigid.iter_mut().filter(|part| !acts(&part.during)) {
            (part.force, part.moment, part.during) = (Vec::new(), Vec::new(), During::NEVER);
        }
        own
    }
}

impl BoundaryCondition {
    /// The part of the condition that matrices and their unknowns depend on: everything but values.
    fn form(&self) -> BoundaryCondition {
        let zero = || Field::ZERO;
        let components = |all: &Vec<Option<Field>>| all.iter().map(|of| of.as_ref().map(|_| zero())).collect();
        BoundaryCondition {
            displacement: self.displacement.as_ref().map(components),
            normal_displacement: self.normal_displacement.as_ref().map(|_| zero()),
            spring: self.spring.clone(),
            dashpot: self.dashpot.clone(),
            temperature: self.temperature.as_ref().map(|_| zero()),
            convection: self.convection.as_ref().map(|of| Convection { ambient: zero(), ..of.clone() }),
            ..BoundaryCondition::on(self.on.clone())
        }
    }
}

impl ProblemData {
    /// True if conditions begin or end with a phase.
    #[must_use]
    pub fn changes_conditions(&self) -> bool {
        Scheduled::of(self).change()
    }

    /// The data as each phase has them, with that phase alone in the timeline; the data themselves if no condition
    /// changes.
    pub(super) fn of_phases(&self) -> Vec<Cow<'_, ProblemData>> {
        if !self.changes_conditions() {
            return vec![Cow::Borrowed(self)];
        }
        let phases = self.timeline.phases().enumerate();
        let all = Scheduled::of(self);
        let of = |(number, phase): (usize, &TimePhase)| {
            let own = all.in_phase(&self.timeline, number).into_data(self.clone());
            ProblemData {
                timeline: Timeline::in_phases(vec![phase.clone()]),
                initial: if number == 0 { self.initial.clone() } else { Initial::default() },
                ..own
            }
        };
        phases.map(|phase| Cow::Owned(of(phase))).collect()
    }

    /// The places of what may act in some phases only, each once, and when it acts.
    fn places_in_phases(&self) -> Vec<(String, &During)> {
        let boundary = self.boundary.iter().enumerate().map(|(i, of)| (format!("boundary[{i}]"), &of.during));
        let contacts = self.contacts.iter().enumerate().map(|(i, of)| (self.contact_path(i), &of.during));
        let rigid = self.rigid.iter().enumerate().map(|(i, of)| (format!("rigid[{i}]"), &of.during));
        let mut all: Vec<_> = boundary.chain(contacts).chain(rigid).collect();
        // A load of several regions is one entry.
        for load in &self.region_loads {
            if all.iter().all(|(path, _)| *path != load.keys[0]) {
                all.push((load.keys[0].clone(), &load.during));
            }
        }
        all
    }

    /// Checks the phases of conditions. Returns true if all of them are known.
    pub(super) fn check_phases(&self, faults: &mut Vec<Fault>) -> bool {
        let before = faults.len();
        let names: Vec<&str> = self.timeline.phases().map(|phase| phase.name.as_str()).collect();
        for (path, during) in self.places_in_phases() {
            let path = format!("{path}.phases");
            let During::Phases(own) = during else { continue };
            if !self.timeline.has_phases() {
                let fault = Fault::new(path, format!("{own:?} in a run without phases"), "no such key");
                faults.push(fault.hint("give the run its [[phase]] entries, or remove `phases`"));
                continue;
            }
            if own.is_empty() {
                let fault = Fault::new(path, "no phase", format!("some of the phases {}", names.join(", ")));
                faults.push(fault.hint("name the phases, or remove `phases`: the entry then acts in all of them"));
                continue;
            }
            for (j, name) in own.iter().enumerate() {
                if own.iter().take(j).any(|other| other == name) {
                    let path = format!("{path}[{j}]");
                    faults.push(Fault::new(path, format!("\"{name}\" again"), "each phase once").hint("remove it"));
                } else if !names.contains(&name.as_str()) {
                    faults.push(unknown(format!("{path}[{j}]"), name, "phases", &names));
                }
            }
        }
        for (i, condition) in self.boundary.iter().enumerate() {
            self.check_release(i, condition, faults);
        }
        for (i, part) in self.rigid.iter().enumerate() {
            if part.during != During::Run && part.force.is_empty() && part.moment.is_empty() {
                let found = "phases of a part without a force and a moment";
                let fault = Fault::new(format!("rigid[{i}].phases"), found, "`force` or `moment` beside it");
                faults.push(fault.hint("remove it: a rigid part is rigid in all phases"));
            }
        }
        faults.len() == before
    }

    /// Checks that a release belongs to a displacement that ends before the run does.
    fn check_release(&self, i: usize, condition: &BoundaryCondition, faults: &mut Vec<Fault>) {
        if condition.release == Release::AtOnce {
            return;
        }
        let path = format!("boundary[{i}].release");
        if condition.displacement.is_none() && condition.normal_displacement.is_none() {
            let found = "a release of a side without a displacement";
            let hint = "remove it: loads, springs and temperatures end at once";
            faults.push(Fault::new(path, found, "a prescribed displacement beside it").hint(hint));
        } else if !self.ends(condition) {
            let found = "a release of a displacement that acts to the end of the run";
            let hint = "name in `phases` those in which it acts, without the last one, or remove `release`";
            faults.push(Fault::new(path, found, "a displacement that ends before").hint(hint));
        }
    }

    /// True if a phase without this condition follows one with it.
    fn ends(&self, condition: &BoundaryCondition) -> bool {
        let acts: Vec<bool> = self.timeline.phases().map(|phase| condition.during.has(phase)).collect();
        acts.windows(2).any(|two| two[0] && !two[1])
    }
}

impl Problem {
    /// The number of the phase whose conditions this problem has. A problem that was checked has those of the first
    /// phase.
    #[must_use]
    pub fn phase(&self) -> usize {
        self.1.phase
    }

    /// The problem with the conditions of a phase.
    #[must_use]
    pub fn in_phase(&self, phase: usize) -> Problem {
        if !self.changes_conditions_of_run() || phase == self.1.phase {
            return self.clone();
        }
        let own = self.1.all.in_phase(&self.timeline, phase);
        Problem(own.into_data(self.0.clone()), Schedule { phase, ..self.1.clone() })
    }

    /// The problem with other steps of its phases.
    #[must_use]
    pub(crate) fn with_timeline(&self, timeline: Timeline) -> Problem {
        Problem(ProblemData { timeline, ..self.0.clone() }, self.1.clone())
    }

    /// The contacts of the run, with the phases in which they act.
    #[must_use]
    pub fn contacts_of_run(&self) -> &[Contact] {
        &self.1.all.contacts
    }

    /// True if conditions begin or end with a phase.
    #[must_use]
    pub fn changes_conditions_of_run(&self) -> bool {
        self.1.all.change()
    }

    /// True if the same conditions act in two phases.
    #[must_use]
    pub fn has_same_conditions(&self, phases: [usize; 2]) -> bool {
        let acts =
            |during: &During, phase: usize| self.timeline.phases().nth(phase).is_none_or(|phase| during.has(phase));
        self.1.all.durings().all(|during| acts(during, phases[0]) == acts(during, phases[1]))
    }

    /// What is wrong if a pair has other contact points in another phase: where both sides are held in all directions
    /// there are none, and what contact keeps at its points has no place to go on from.
    pub(super) fn check_pairs_in_phases(&self) -> Option<Fault> {
        if !self.changes_conditions_of_run() || self.contacts.iter().all(|contact| contact.pair.is_none()) {
            return None;
        }
        let places = |phase: usize| -> Vec<(usize, Point)> {
            self.in_phase(phase).contact_boundary().points.iter().map(|point| (point.contact, point.x)).collect()
        };
        let first = places(0);
        let phases = self.timeline.phases().enumerate().skip(1);
        let changed =
            phases.filter(|(number, _)| !(0..*number).any(|before| self.has_same_conditions([before, *number])));
        let mut changed = changed.map(|(number, phase)| (phase, places(number)));
        let (phase, other) = changed.find(|(_, other)| *other != first)?;
        let (number, _) = other.iter().chain(&first).find(|point| other.contains(point) != first.contains(point))?;
        let first_name = self.timeline.phases().next().map_or("", |phase| &phase.name);
        let found = format!(
            "{} contact points in the phase \"{}\" and {} in the phase \"{first_name}\", because supports hold nodes of both sides",
            other.len(),
            phase.name,
            first.len()
        );
        let fault = Fault::new(self.contact_path(*number), found, "the same contact points in all phases");
        Some(fault.hint("hold the nodes of one side only, or both in all phases"))
    }

    /// True if two phases prescribe the same degrees of freedom and have the same springs, dashpots and heat exchange,
    /// so that their systems are the same.
    #[must_use]
    pub(crate) fn has_same_systems(&self, other: &Problem) -> bool {
        let forms = |problem: &Problem| -> Vec<BoundaryCondition> {
            let forms = problem.boundary.iter().map(BoundaryCondition::form);
            forms.filter(|form| !form.is_empty()).collect()
        };
        forms(self) == forms(other)
    }

    /// For each prescription of V^h, in order: true if its force is given up in the course of the next phase.
    pub(crate) fn releases_in_phase(&self) -> Vec<bool> {
        let of = |condition: &BoundaryCondition| {
            vec![condition.release == Release::InPhase; condition.prescriptions(&self.mesh).len()]
        };
        self.boundary.iter().flat_map(of).collect()
    }

    /// The data with all conditions of the run, to be changed and checked again.
    #[must_use]
    pub fn into_data(self) -> ProblemData {
        Scheduled::clone(&self.1.all).into_data(self.0)
    }
}
