//! How the contact points see that the opposite side of their contact moves by δ.

use std::cell::RefCell;
use std::collections::BTreeMap;

use super::balances::moves;
use super::instance::{SolvedStep, data};
use super::stencil::derivative;
use crate::contact::PointOnBoundary;
use crate::equation::system::Step;
use crate::inclusion::{Local, PointState};
use crate::linalg::max_abs;
use crate::tensor::{Point, dot};

/// Number of inputs of a contact point.
pub(super) const INPUTS: usize = 8;

/// The changes of a contact point with δ of its contact, at fixed velocities and fixed (p, q) in its basis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PointAdvance {
    /// Changes of the jump of the velocities and of ū_ν − g with δ at the start and at the end of the step.
    changes: [[f64; 4]; 2],
    /// Changes of ν, t₁ and t₂ with δ at the end of the step.
    turning: [Point; 3],
}

impl PointAdvance {
    /// The changes of the inputs of the point with δ at the start of the step.
    pub fn at_start(&self) -> [f64; INPUTS] {
        inputs(&self.changes[0])
    }

    /// The same with δ at its end.
    pub fn at_end(&self) -> [f64; INPUTS] {
        inputs(&self.changes[1])
    }

    /// Turns a state of the point by a change of δ, with (p, q) and the slip in its basis.
    pub fn turn(&self, state: &mut PointState, (force, slip): (&Local, [f64; 2]), change: f64) {
        let add = |to: &mut Point, v: Local| {
            to.iter_mut().zip(self.turned(&v)).for_each(|(to, more)| *to += change * more);
        };
        add(&mut state.normal, [1.0, 0.0, 0.0]);
        add(&mut state.q, [0.0, force[1], force[2]]);
        add(&mut state.slip, [0.0, slip[0], slip[1]]);
    }

    /// The largest change of a component of the basis, per m.
    pub fn turning(&self) -> f64 {
        max_abs(self.turning.as_flattened())
    }

    /// The change of a vector with these components in the basis of the point, with δ at the end of the step.
    pub fn turned(&self, v: &Local) -> Point {
        super::instance::global(&self.turning, v)
    }
}

fn inputs([v1, v2, v3, opening]: &[f64; 4]) -> [f64; INPUTS] {
    [*v1, *v2, *v3, 0.0, 0.0, 0.0, *opening, 0.0]
}

/// What of a point depends on δ: the inputs, and the basis.
const SEEN: usize = 4 + 9;

/// The changes of all points of a step with δ of their contacts, or the first point that sees a kink.
pub(super) fn advances(step: &Step, of: &SolvedStep) -> Result<Vec<PointAdvance>, usize> {
    let mut all = vec![PointAdvance::default(); step.boundary.points.len()];
    for (contact, _) in step.problem.contacts.iter().enumerate().filter(|(_, contact)| moves(contact)) {
        let own: Vec<usize> = (0..all.len()).filter(|&i| step.boundary.points[i].contact == contact).collect();
        let scale = scale(step, contact, of);
        for k in [0, 1] {
            let known = RefCell::new(BTreeMap::<u64, Vec<[f64; SEEN]>>::new());
            let seen = |i: usize, h: f64| -> [f64; SEEN] {
                let mut known = known.borrow_mut();
                let all = known.entry(h.to_bits()).or_insert_with(|| seen_at(step, of, contact, (k, h)));
                all.get(i).copied().unwrap_or([0.0; SEEN])
            };
            for &i in &own {
                let found = derivative(|h| (seen(i, h), ()), scale, sizes(step, (i, &seen(i, 0.0))), ()).ok_or(i)?;
                let [v1, v2, v3, opening, basis @ ..] = found;
                all[i].changes[k] = [v1, v2, v3, opening];
                if k == 1 {
                    all[i].turning = std::array::from_fn(|a| std::array::from_fn(|c| basis[3 * a + c]));
                }
            }
        }
    }
    Ok(all)
}

/// The size of a contact, over which its obstacle turns away, or what it has moved by; 1 of a point.
fn scale(step: &Step, contact: usize, of: &SolvedStep) -> f64 {
    let own = || step.boundary.points.iter().filter(|point| point.contact == contact).map(|point| point.x);
    let size = |c: usize| {
        let [low, high] =
            own().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [x[c].min(low), x[c].max(high)]);
        (high - low).max(0.0)
    };
    let extent = max_abs(&[0, 1, 2].map(size));
    let advance = of.new.surface.advance.get(contact).map_or(0.0, |advance| advance.abs());
    [extent, advance].into_iter().find(|size| *size > 0.0).unwrap_or(1.0)
}

/// The sizes of the terms of what a point sees: distances are differences of places.
fn sizes(step: &Step, (i, seen): (usize, &[f64; SEEN])) -> [f64; SEEN] {
    let place = step.boundary.points.get(i).map_or(0.0, |point| max_abs(&point.x));
    let length = place + seen[3].abs();
    std::array::from_fn(|j| match j {
        0..3 => seen[j].abs() + length / step.rule.span,
        3 => length,
        _ => 1.0,
    })
}

/// What the points see with δ of a contact larger by `h` at the start of the step, or at its end. A rate of the gap
/// counts as one of the body away from it.
fn seen_at(step: &Step, of: &SolvedStep, contact: usize, (k, h): (usize, f64)) -> Vec<[f64; SEEN]> {
    let mut given = data(step, of.at);
    let mut advance = [step.old.surface.advance.clone(), of.at.surface.advance.clone()];
    advance[k].get_mut(contact).into_iter().for_each(|advance| *advance += h);
    given.lead(step, [&advance[0], &advance[1]]);
    let Some(term) = given.frozen(step, of.unknown, of.chosen) else { return Vec::new() };
    let of_point = |(i, (point, frame)): (usize, (&PointOnBoundary, &crate::inclusion::Frame))| {
        let (basis, v) = (term.basis(i), step.boundary.vector_at(point, step.discrete.mesh.dim, &of.at.w));
        let relative: Point = std::array::from_fn(|c| v[c] - frame.velocity[c]);
        let opening = term.distance(i) + step.rule.span * frame.gap_rate;
        let inputs =
            [dot(&basis[0], &v) - frame.gap_rate, dot(&basis[1], &relative), dot(&basis[2], &relative), opening];
        let mut all = inputs.iter().chain(basis.as_flattened());
        std::array::from_fn(|_| all.next().copied().unwrap_or(0.0))
    };
    step.boundary.points.iter().zip(&given.frames).enumerate().map(of_point).collect()
}
