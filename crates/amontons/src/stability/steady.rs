//! A steady state, linearised: the laws at its contact points and the forms of its body.

use super::contact::PointTerm;
use super::polynomial::{Forms, Polynomial};
use super::unknowns::{Perturbed, PerturbedUnknowns};
use super::waves::WaveNumber;
use super::{ModeKind, StabilityError, Wanted, contact};
use crate::contact::{Contact, ContactBoundary, Status};
use crate::discretization::Discretization;
use crate::equation::acting::contacts_at;
use crate::problem::{Fault, Problem};
use crate::state::{State, StepReport};
use crate::tensor::length;

/// A state with its problem, and the report of the step that led to it.
#[derive(Clone, Copy, Debug)]
pub struct SteadyState<'a> {
    /// The problem.
    pub problem: &'a Problem,
    /// Its discretization.
    pub discrete: &'a Discretization,
    /// The state.
    pub state: &'a State,
    /// The report.
    pub report: &'a StepReport,
}

/// A state with its linearised laws.
pub(super) struct LinearisedState<'a> {
    at: SteadyState<'a>,
    pub contacts: Vec<Contact>,
    pub boundary: &'a ContactBoundary,
    points: Vec<PointTerm>,
    pub forms: Forms,
    what: Perturbed,
}

impl<'a> LinearisedState<'a> {
    /// Linearises a state.
    ///
    /// # Errors
    /// If a part of the problem has no steady state or is not linearised.
    pub fn new(at: SteadyState<'a>, wanted: &Wanted) -> Result<LinearisedState<'a>, StabilityError> {
        let SteadyState { problem, discrete, state, report } = at;
        check(problem, discrete, wanted)?;
        let what = Perturbed {
            displacement: problem.physics.has_mechanics(),
            temperature: wanted.kind != ModeKind::Squeal && problem.physics.has_heat(),
        };
        let contacts = contacts_at(problem, state.t);
        let boundary = report.contact.boundary.as_ref().unwrap_or(&discrete.boundary);
        let points = contact::linearised(&contacts, boundary, report, what.temperature)?;
        let mut forms = forms(discrete, state, what, wanted.kind);
        let lumped = |contact: &Contact| contact.foundation_heat.as_ref().map(|heat| [heat.exchange, heat.capacity]);
        forms.foundations = contacts.iter().map(lumped).collect();
        Ok(LinearisedState { at, contacts: contacts.into_owned(), boundary, points, forms, what })
    }

    /// The unknowns of perturbations with some waves around the body.
    pub fn unknowns(&self, waves: WaveNumber) -> PerturbedUnknowns {
        let node = |i: usize| {
            let (node, _) = self.boundary.points.get(i)?.nodes.first()?;
            self.boundary.nodes.get(*node).copied()
        };
        let wearing = |(i, point): (usize, &PointTerm)| point.wearing.as_ref().and_then(|_| node(i));
        let wearing: Vec<Option<u32>> = self.points.iter().enumerate().map(wearing).collect();
        PerturbedUnknowns::new((self.at.discrete, &self.contacts), (self.what, &wearing), waves)
    }

    /// The pencil on these unknowns, with the basis of one `beside` it; `None` if that does not suit.
    pub fn pencil(&self, unknowns: PerturbedUnknowns, beside: Option<&Polynomial>) -> Option<Polynomial> {
        Polynomial::new(unknowns, &self.forms, (self.boundary, &self.points), &self.at.discrete.mesh, beside)
    }

    /// The status of each contact point, and the number of components that it holds.
    pub fn statuses(&self) -> Vec<(Status, usize)> {
        let states = self.at.report.contact.states.iter();
        states.zip(&self.points).map(|(state, point)| (state.status, point.held.len())).collect()
    }

    /// Contact points that are open, stick and slip.
    pub fn points(&self) -> [usize; 3] {
        let statuses = self.at.report.contact.states.iter().map(|state| state.status);
        [Status::Open, Status::Stick, Status::Slip].map(|status| statuses.clone().filter(|own| *own == status).count())
    }

    /// Largest velocity of the body over the largest slip velocity.
    pub fn unsteady(&self) -> f64 {
        let SteadyState { discrete, state, report, .. } = self.at;
        let largest = |sizes: &mut dyn Iterator<Item = f64>| sizes.fold(0.0, f64::max);
        let slip = largest(&mut report.contact.states.iter().map(|state| length(&state.slip)));
        let speed = |w: &[f64]| w.iter().map(|c| c * c).sum::<f64>().sqrt();
        let velocity = largest(&mut state.w.chunks(discrete.mesh.dim).map(speed));
        if slip > 0.0 { velocity / slip } else { 0.0 }
    }
}

/// Checks that all parts of the problem are linearised.
fn check(problem: &Problem, discrete: &Discretization, wanted: &Wanted) -> Result<(), StabilityError> {
    let kind = wanted.kind;
    let fault = |path: String, found: &str, expected: &str, hint: &str| {
        Err(StabilityError::Problem(Fault::new(path, found, expected).hint(hint)))
    };
    let of = |contact: &Contact| {
        let damps = contact.normal.lipschitz_in_rate().is_none_or(|slope| slope > 0.0);
        let load = contact.obstacle.as_ref().is_some_and(|obstacle| obstacle.load.is_some());
        let all = [
            (contact.wear.is_some() && contact.pair.is_some(), "wear", "wear of a pair"),
            (contact.wear.is_some() && damps, "wear", "wear of a layer that damps"),
            (contact.preload.is_some(), "preload", "a preload, whose section is drawn together"),
            (contact.fluid.is_some(), "fluid", "a fluid"),
            (load, "obstacle.load", "an obstacle under a force"),
        ];
        all.into_iter().find(|(is, ..)| *is).map(|(_, key, found)| (key, found))
    };
    for (side, contact) in problem.contacts.iter().enumerate() {
        if let Some((key, found)) = of(contact) {
            let path = format!("{}.{key}", problem.contact_path(side));
            return fault(path, found, "none in a search for modes", "remove it, or hold what it does fixed");
        }
    }
    if discrete.branches.iter().any(|branches| branches.uniform().is_none()) {
        let hint = "give regions of their own a number each";
        return fault("material".to_owned(), "relaxation times that vary in space", "numbers per region", hint);
    }
    let region_holds_poles =
        wanted.region.map_or(kind == ModeKind::Thermal, |region| region.frequency[0] <= 0.0 && region.growth[0] < 0.0);
    if !discrete.branches.is_empty() && region_holds_poles {
        let hint = "give stability.growth a lower bound of 0 or more, or stability.frequency one above 0";
        let found =
            "decaying modes of frequency 0 in a body with branches, which relax in as many modes as they have unknowns";
        return fault("stability".to_owned(), found, "a region without them", hint);
    }
    if kind != ModeKind::Thermal && !problem.physics.has_mechanics()
        || kind != ModeKind::Squeal && !problem.physics.has_heat()
    {
        let found = format!(
            "\"{}\" in a problem without {}",
            kind.name(),
            if problem.physics.has_heat() { "mechanics" } else { "heat" }
        );
        return fault("stability.kind".to_owned(), &found, "a kind whose equations are solved", "take another kind");
    }
    Ok(())
}

/// The forms of the body at a state.
pub(super) fn forms(discrete: &Discretization, state: &State, what: Perturbed, kind: ModeKind) -> Forms {
    let State { u, w, theta, .. } = state;
    let mut forms = Forms::default();
    if what.displacement {
        let [damping, stiffness] = discrete.mechanical_forms(u, w, theta);
        (forms.damping, forms.stiffness) = (Some(damping), Some(stiffness));
        forms.inertia = (kind != ModeKind::Thermal).then(|| discrete.inertia_matrix(1.0));
        let branches = discrete.branches.iter().filter_map(|branches| branches.uniform());
        forms.branches = branches.map(|(time, form)| (time.recip(), form.clone())).collect();
    }
    if what.temperature {
        let [storage, conduction] = discrete.thermal_forms(theta);
        forms.storage = Some(storage);
        forms.conduction = [Some(conduction), discrete.thermal_slope(theta)].into_iter().flatten().collect();
    }
    if what.displacement && what.temperature {
        forms.force = Some(discrete.mechanical_slope(u, w, theta).unwrap_or_else(|| discrete.m.clone()));
        forms.heat = Some(discrete.e.clone());
    }
    forms
}
