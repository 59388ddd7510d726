//! What acts in a step: loads and prescribed values, with the inputs that are set from the outside, Γ_C and its laws.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::inputs::StepInputs;
use super::system::Step;
use crate::contact::{Contact, ContactBoundary, Supports};
use crate::discretization::Discretization;
use crate::problem::{Problem, with_supports};
use crate::space::Replacing;
use crate::state::State;

/// A load with the one set from the outside, which is empty if nothing is set.
fn with(load: Arc<Vec<f64>>, set: &[f64]) -> Arc<Vec<f64>> {
    if set.is_empty() { load } else { Arc::new(load.iter().zip(set).map(|(load, set)| load + set).collect()) }
}

impl<'a> Step<'a> {
    /// The load of (4.1), N.
    pub fn load(&self) -> Arc<Vec<f64>> {
        self.load_at(self.level)
    }

    /// The load of (4.1) at a time, N.
    pub fn load_at(&self, t: f64) -> Arc<Vec<f64>> {
        with(self.discrete.f.at(t), &self.nodal_forces_at(t))
    }

    /// The forces set from the outside, and those that supports are giving up, N; empty if there are none.
    pub fn nodal_forces(&self) -> Vec<f64> {
        self.nodal_forces_at(self.level)
    }

    fn nodal_forces_at(&self, t: f64) -> Vec<f64> {
        let (set, released) = (&self.inputs.forces, &self.old.released);
        if released.is_empty() {
            return set.clone();
        }
        let left = self.problem.timeline.left_of_phase(t);
        let set = set.iter().copied().chain(std::iter::repeat(0.0));
        released.iter().zip(set).map(|(released, set)| left * released + set).collect()
    }

    /// The load of (4.2), W.
    pub fn supply(&self) -> Arc<Vec<f64>> {
        with(self.discrete.q_h.at(self.level), &self.inputs.heat)
    }

    /// The values that replace prescribed ones at the end of this part of the step.
    pub fn replacing(&self, of: fn(&StepInputs) -> &BTreeMap<usize, Vec<f64>>) -> Replacing<'a> {
        let [end, _] = self.whole;
        let share = if self.t < end { (self.t - self.old.t) / (end - self.old.t) } else { 1.0 };
        Replacing { values: of(self.inputs), share }
    }
}

/// Γ_C in a step that starts from the state `old`, with updated pairs searched anew.
pub(crate) fn boundary_at(discrete: &Discretization, problem: &Problem, old: &State) -> Arc<ContactBoundary> {
    let of = |supports: Supports| discrete.boundary.updated(&problem.contacts, &discrete.mesh, &old.u, supports);
    let updated = with_supports(&discrete.v, Some(&discrete.outside), of);
    updated.unwrap_or_else(|| Arc::clone(&discrete.boundary))
}

/// The contacts of a problem with their laws at a time, and idle those that do not act in its phase. This is the only
/// place that leaves them out: all that is computed on Γ_C takes its laws from here.
pub(crate) fn contacts_at(problem: &Problem, t: f64) -> Cow<'_, [Contact]> {
    if problem.contacts.iter().all(|contact| contact.acts() && contact.at_time(t).is_none()) {
        return Cow::Borrowed(&problem.contacts);
    }
    let at = |contact: &Contact| {
        if !contact.acts() {
            return contact.idle();
        }
        contact.at_time(t).unwrap_or_else(|| contact.clone())
    };
    Cow::Owned(problem.contacts.iter().map(at).collect())
}
