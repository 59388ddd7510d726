//! Loads and prescribed values of a step, with the inputs that are set from the outside.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::inputs::StepInputs;
use super::system::Step;
use crate::space::Replacing;

/// A load with the one set from the outside, which is empty if nothing is set.
fn with(load: Arc<Vec<f64>>, set: &[f64]) -> Arc<Vec<f64>> {
    if set.is_empty() { load } else { Arc::new(load.iter().zip(set).map(|(load, set)| load + set).collect()) }
}

impl<'a> Step<'a> {
    /// The load of (4.1), N.
    pub fn load(&self) -> Arc<Vec<f64>> {
        with(self.discrete.f.at(self.level), &self.nodal_forces())
    }

    /// The forces set from the outside, and those that supports are giving up, N; empty if there are none.
    pub fn nodal_forces(&self) -> Vec<f64> {
        let (set, released) = (&self.inputs.forces, &self.old.released);
        if released.is_empty() {
            return set.clone();
        }
        let left = self.problem.timeline.left_of_phase(self.n, self.level);
        let set = set.iter().copied().chain(std::iter::repeat(0.0));
        released.iter().zip(set).map(|(released, set)| left * released + set).collect()
    }

    /// The load of (4.2), W.
    pub fn supply(&self) -> Arc<Vec<f64>> {
        with(self.discrete.q_h.at(self.level), &self.inputs.heat)
    }

    /// The values that replace prescribed ones at the end of this part of the step.
    pub fn replacing(&self, of: fn(&StepInputs) -> &BTreeMap<usize, Vec<f64>>) -> Replacing<'a> {
        let end = self.problem.timeline.time(self.n);
        let share = if self.t < end { (self.t - self.old.t) / (end - self.old.t) } else { 1.0 };
        Replacing { values: of(self.inputs), share }
    }
}
