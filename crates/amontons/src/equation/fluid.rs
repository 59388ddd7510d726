//! Fluids in a step: the contact points that they wet, and their pressure.

use std::sync::Arc;

use super::system::{Step, difference, on_degrees};
use crate::contact::{Leak, Wet};
use crate::discretization::Discretization;
use crate::inclusion::{Frame, PointState};
use crate::problem::Problem;
use crate::tensor::Point;

/// The contact points wet by fluids in a step, and the points that fluids have left in it; empty without a fluid.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pools {
    pub wet: Vec<bool>,
    pub left: Vec<bool>,
}

/// The wet points before the first step: none.
pub(crate) fn dry(problem: &Problem, discrete: &Discretization) -> Wet {
    if discrete.ways.is_empty() {
        return Wet::default();
    }
    Wet { points: vec![false; discrete.boundary.points.len()], leaks: vec![None; problem.contacts.len()] }
}

/// True if a fluid passes a point in its state; false if the contact has no fluid.
fn passes(step: &Step, i: usize, states: &[PointState]) -> bool {
    let (Some(point), Some(state)) = (step.boundary.points.get(i), states.get(i)) else { return false };
    let fluid = step.contacts.get(point.contact).and_then(|contact| contact.fluid.as_ref());
    fluid.is_some_and(|fluid| fluid.passes(point, state.penetration, state.pressure))
}

impl Step<'_> {
    /// The loads plus the pressure of fluids at the wet points, −Σ ω Nᵀ p_f ν.
    pub(crate) fn with_fluid(&self, load: &Arc<Vec<f64>>, wet: &[bool], frames: &[Frame]) -> Arc<Vec<f64>> {
        if !wet.contains(&true) {
            return Arc::clone(load);
        }
        let points = self.boundary.points.iter().zip(frames).zip(wet);
        let pressed = points.map(|((point, frame), wet)| -> Point {
            let fluid = self.contacts.get(point.contact).and_then(|contact| contact.fluid.as_ref());
            let pressure = fluid.filter(|_| *wet).map_or(0.0, |fluid| fluid.pressure.value(&point.x, self.level));
            frame.normal.map(|c| pressure * c)
        });
        Arc::new(difference(load, &on_degrees(self.boundary, &self.discrete.v, pressed)))
    }

    /// The next wet points, by the states of the contact points: fluids first spread to the points that they reach. If
    /// they reach no more, they leave closed points, and the points cut off behind these. A point is left once per
    /// step. Returns `None` if nothing changes.
    pub(crate) fn spread(&self, pools: &Pools, states: &[PointState]) -> Option<Pools> {
        let ways = &self.discrete.ways;
        if ways.is_empty() {
            return None;
        }
        let Pools { wet, left } = pools;
        let at = |all: &[bool], i: usize| all.get(i).copied().unwrap_or(false);
        let found = |reached: Vec<Option<usize>>| -> Vec<bool> { reached.iter().map(Option::is_some).collect() };
        let reached = found(ways.reached(|i| at(wet, i) || passes(self, i, states)));
        let grown: Vec<bool> = (0..reached.len()).map(|i| at(&reached, i) || at(wet, i)).collect();
        if grown != *wet {
            return Some(Pools { wet: grown, left: left.clone() });
        }
        let stays = found(ways.reached(|i| at(wet, i) && (passes(self, i, states) || at(left, i))));
        let leaves = |i: usize| at(wet, i) && !at(&stays, i) && !at(left, i);
        let left: Vec<bool> = (0..wet.len()).map(|i| at(left, i) || leaves(i)).collect();
        let kept: Vec<bool> = (0..wet.len()).map(|i| at(wet, i) && !leaves(i)).collect();
        (kept != *wet).then_some(Pools { wet: kept, left })
    }
}

/// The wet points after a step in which the points `wet` were wet. Closed points hold no fluid in the next step.
pub(crate) fn after(step: &Step, before: &Wet, wet: &[bool], states: &[PointState]) -> Wet {
    let ways = &step.discrete.ways;
    if ways.is_empty() {
        return Wet::default();
    }
    let is_wet = |i: usize| wet.get(i).copied().unwrap_or(false);
    let mut leaks = before.leaks.clone();
    for way in ways.through(&ways.reached(is_wet)) {
        let gap = |i: &usize| states.get(*i).map_or(0.0, |state| 0.0 - state.penetration);
        let Some(narrowest) = way.iter().copied().min_by(|i, j| gap(i).total_cmp(&gap(j))) else { continue };
        let contact = step.boundary.points.get(narrowest).map_or(usize::MAX, |point| point.contact);
        if let Some(leak) = leaks.get_mut(contact).filter(|leak| leak.is_none()) {
            *leak = Some(Leak { t: step.t, narrowest, gap: gap(&narrowest) });
        }
    }
    let left = ways.reached(|i| is_wet(i) && passes(step, i, states));
    Wet { points: left.iter().map(Option::is_some).collect(), leaks }
}
