//! Depths of wear of the sides of pairs, which the vertices of the sides keep.

use crate::contact::PointOnBoundary;
use crate::equation::system::Step;
use crate::inclusion::PointOutput;
use crate::state::State;

/// True if the depth at a contact point is that of the vertices of both sides.
fn is_of_pair(step: &Step, point: &PointOnBoundary) -> bool {
    step.contacts.get(point.contact).is_some_and(|contact| contact.pair.is_some())
}

/// Numbers per contact point: those of pairs from one list, those of foundations from another.
pub(super) fn of_pairs_or(step: &Step, of_pairs: &[f64], others: &[f64]) -> Vec<f64> {
    let all = step.boundary.points.iter().zip(of_pairs.iter().zip(others));
    all.map(|(point, (of_pair, other))| if is_of_pair(step, point) { *of_pair } else { *other }).collect()
}

/// At each contact point the depth that depths of the vertices give.
pub(super) fn seen(step: &Step, depths: &[Vec<f64>]) -> Vec<f64> {
    step.discrete.worn.depths_at(step.contacts, step.boundary, depths)
}

/// The transposed of [`seen`].
pub(super) fn seen_transposed(step: &Step, weights: &[f64]) -> Vec<Vec<f64>> {
    step.discrete.worn.depths_at_transposed(step.contacts, step.boundary, weights)
}

/// The growth of the depths of the vertices by the depths that come off at the contact points.
pub(super) fn grown(step: &Step, worn: &[f64]) -> Vec<Vec<f64>> {
    step.discrete.worn.growth(step.contacts, step.boundary, worn)
}

/// The transposed of [`grown`].
pub(super) fn grown_transposed(step: &Step, weights: &[Vec<f64>]) -> Vec<f64> {
    step.discrete.worn.growth_transposed(step.contacts, step.boundary, weights)
}

/// What of wear follows from the unknowns of a step: at each contact point the depth that comes off in the step, or
/// that of both sides of its pair at the end of the step; and the growth of the depths of the vertices.
pub(super) fn wear(step: &Step, new: &State, points: &[PointOutput]) -> [Vec<f64>; 2] {
    let worn: Vec<f64> = points.iter().map(|point| point.worn).collect();
    let depths = seen(step, &new.surface.worn.depths);
    [of_pairs_or(step, &depths, &worn), grown(step, &worn).concat()]
}

/// Adds lists of numbers to others.
pub(super) fn add_lists(to: &mut [Vec<f64>], factor: f64, from: &[Vec<f64>]) {
    for (to, from) in to.iter_mut().zip(from) {
        to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
    }
}
