//! Rigid motions in a step: those that no contact can determine are held from its start, those that the contact found
//! does not determine take the least size at its end, and what a load drives is refused.

use std::sync::Arc;

use super::Failure;
use super::loose::{DOUBTFUL, Free, Holds, Jumps, Resists, Undetermined, resisting};
use super::mechanical::{Mechanical, MechanicalStep};
use super::newton::{Iterate, Right, Term};
use super::point::{Laws, Multiplier};
use crate::contact::Status;
use crate::linalg::{Condensed, SolveError, Spring, Tangent, dot, max_abs};

/// Share of the forces on a part, each by what it does along a motion, that drives it: less is round-off.
const DRIVES: f64 = 1e-6;
/// Stiffness of a soft spring, relative to the mean one of the operator over its motion.
const SOFT: f64 = 1e-9;
/// Share of the force that the spring of a motion would have if all unknowns moved along it that counts as round-off.
const ROUNDED: f64 = 1e3 * f64::EPSILON;
/// Share of the motion of all contact nodes above which a motion that nothing determines is not the least: one that is
/// not resisted at all, and one in doubt.
const LEAST: f64 = 1e-9;
const LARGE: f64 = 0.1;
/// Distance that counts as far away, in multiples of the extent of all contact nodes and gaps.
const FAR: f64 = 1e3;
/// Share of the forces along a motion that is out of balance where a body slides.
const SLIPS: f64 = 1e-3;
/// An iterate of the mechanical step.
pub(super) type Mechanics = Iterate<Vec<Multiplier>>;

/// The solution of a step with its rigid motions.
pub(super) struct Settled {
    pub end: Mechanics,
    pub iterations: usize,
    pub loose: Vec<Undetermined>,
    /// The forces of springs by unknown, in the axes of space; empty if there are none.
    pub held: Vec<f64>,
}

impl Mechanical<'_> {
    /// Finds the rigid motions of the step, and holds those that no point of contact could determine if all were closed
    /// and stuck.
    pub(super) fn find_motions(&mut self, condensed: &dyn Condensed) {
        if self.step.loose.is_empty() {
            return;
        }
        let size = condensed.len();
        let MechanicalStep { loose, boundary, contacts, dim, u_bar, .. } = self.step;
        let doubts = loose.doubts(boundary, contacts, dim, u_bar);
        let jumps = Arc::new(Jumps::new(loose, &self.interface, doubts, size));
        let may = |i: usize| -> Resists {
            let rubs = !self.contact(i).friction.is_frictionless();
            let [first, second] = self.held(i).map(|held| f64::from(u8::from(rubs && !held)));
            [[1.0, 0.0, 0.0], [0.0, first, 0.0], [0.0, 0.0, second]]
        };
        let free = jumps.free(&self.interface, may, &[], (true, size));
        let mut holds = Holds { jumps, scale: condensed.scale().into(), held: Vec::new() };
        holds.add(&free);
        self.holds = Some(holds);
    }

    /// Adds the springs of the motions that are held, and of those that the points leave free.
    pub(super) fn hold(&self, tangent: &mut Tangent, resists: impl Fn(usize) -> Resists) {
        let Some(holds) = &self.holds else { return };
        holds.held.iter().for_each(|(_, spring)| tangent.hold(spring.clone()));
        let free = holds.jumps.free(&self.interface, resists, &holds.frees(), (false, holds.scale.len()));
        for spring in Jumps::springs(&free, &holds.scale) {
            tangent.hold(spring);
        }
    }

    /// The step in which a soft spring holds each motion that nothing but contact does, and these springs; `None` if
    /// there is no such motion. A part that has to cross its clearance or to roll before friction holds it gets there
    /// in one step of Newton's method, which the springs of [`Mechanical::hold`] allow it in many.
    pub(super) fn softly_held(&self) -> Option<(Mechanical<'_>, Vec<Spring>)> {
        let mut holds = self.holds.clone()?;
        let free = holds.jumps.free(&self.interface, |_| [[0.0; 3]; 3], &holds.frees(), (true, holds.scale.len()));
        if free.is_empty() {
            return None;
        }
        let first = holds.held.len();
        holds.add(&free);
        holds.held.iter_mut().skip(first).for_each(|(_, spring)| spring.stiffness *= SOFT);
        let springs = holds.springs();
        Some((self.with_holds(holds), springs))
    }

    /// Solves the step: see [`Mechanical::solve`].
    pub(super) fn solve_held(
        &mut self,
        condensed: &mut dyn Condensed,
        [r, guess]: [&[f64]; 2],
        start: Mechanics,
    ) -> Result<Settled, Failure> {
        let pulse = Some(self.step.pulse);
        let Some(holds) = &self.holds else {
            let is_repeated = self.step.is_repeated;
            let right = Right { r, guess, proximal: None, is_repeated, springs: &[], rigid: None, pulse };
            let (end, iterations) = self.solve_branches(condensed, &right, start)?;
            return Ok(Settled { end, iterations, loose: Vec::new(), held: Vec::new() });
        };
        let driven: Vec<Undetermined> = holds.held.iter().filter_map(|(free, _)| self.driven(free)).collect();
        if !driven.is_empty() {
            return Err(Failure::Driven(driven));
        }
        let springs = holds.springs();
        // If the interior is eliminated, the unknowns are those of the contact nodes, and the resultants are known.
        let jumps = Arc::clone(&holds.jumps);
        let rigid = (jumps.covers() == condensed.len()).then_some(&*jumps);
        let mut r = r.to_vec();
        if let Some(rigid) = rigid {
            rigid.take_off(&mut r);
            rigid.put_on(self.step.loads, &mut r);
        }
        let is_repeated = self.step.is_repeated;
        let right = Right { r: &r, guess, proximal: None, is_repeated, springs: &springs, rigid, pulse };
        let (end, iterations) = self.solve_branches(condensed, &right, start)?;
        let excess = self.excess(&end);
        if !excess.is_empty() {
            return Err(Failure::Driven(excess));
        }
        self.least(condensed, &right, (end, iterations))
    }

    /// The end of a step with the motions that the contact found leaves free at their least.
    fn least(
        &mut self,
        condensed: &mut dyn Condensed,
        right: &Right,
        (mut end, mut iterations): (Mechanics, usize),
    ) -> Result<Settled, Failure> {
        let free = self.left_free(&end);
        let size = dot(&end.x, &end.x).sqrt();
        let moves = |free: &&Free| {
            let share = if free.is_exact { LEAST } else { LARGE };
            dot(&free.vector, &end.x).abs() > share * size
        };
        let moving: Vec<Free> = free.iter().filter(moves).cloned().collect();
        let before = self.holds.clone();
        if !moving.is_empty() {
            if let Some(holds) = &mut self.holds {
                holds.add(&moving);
            }
            let springs = self.holds.as_ref().map(Holds::springs).unwrap_or_default();
            match self.solve_branches(condensed, &Right { springs: &springs, ..right.clone() }, end.clone()) {
                Ok((least, more)) if self.excess(&least).is_empty() => {
                    (end, iterations) = (least, iterations + more);
                }
                Ok(_) | Err(Failure::NotConverged(_) | Failure::Driven(_)) => self.holds = before,
                Err(error) => return Err(error),
            }
        }
        let of_free = |free: Free| Undetermined { load: 0.0, sum: free.a.clone() };
        let mut loose: Vec<Undetermined> = self.left_free(&end).into_iter().map(of_free).collect();
        let mut held = vec![0.0; end.x.len()];
        for (free, spring) in self.holds.iter().flat_map(|holds| &holds.held) {
            let motion = spring.motion(&end.x);
            spring.add(-motion, &mut held);
            loose.push(Undetermined { load: spring.stiffness * motion, sum: free.a.clone() });
        }
        Ok(Settled { end, iterations, loose, held: self.interface.back(&held) })
    }

    /// The motions that the points at an iterate do not determine, beside those that are held.
    fn left_free(&self, end: &Mechanics) -> Vec<Free> {
        let Some(holds) = &self.holds else { return Vec::new() };
        let laws = self.laws(&end.x, &end.multipliers);
        let resists = |i: usize| resisting(&laws[i], self.step.dim);
        holds.jumps.free(&self.interface, resists, &holds.frees(), (true, holds.scale.len()))
    }

    /// The motions that are held by more than what the mesh does not know of the forces of contact.
    fn excess(&self, end: &Mechanics) -> Vec<Undetermined> {
        let Some(holds) = &self.holds else { return Vec::new() };
        let laws = self.laws(&end.x, &end.multipliers);
        let of = |(free, spring): &(Free, Spring)| {
            let load = spring.stiffness * spring.motion(&end.x);
            let size = max_abs(&free.vector);
            let of_point = |(i, laws): (usize, &Laws)| {
                let [p, q1, q2] = laws.force();
                let doubt = holds.jumps.doubt(i, &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], &free.a);
                self.interface.rows[i].weight * (p.abs() + q1.hypot(q2)) * (DOUBTFUL * doubt + DRIVES * size)
            };
            let doubtful: f64 = laws.iter().enumerate().map(of_point).sum();
            // Where neither loads nor contacts act, the spring bears the round-off of S x.
            let rounded = ROUNDED * spring.stiffness * dot(&end.x, &end.x).sqrt();
            let driven = load.abs() > doubtful + DRIVES * self.load(free)[1] + rounded;
            driven.then(|| Undetermined { load, sum: free.a.clone() })
        };
        holds.held.iter().filter_map(of).collect()
    }

    /// Resultant of the loads along a motion, and its value if no loads cancelled.
    fn load(&self, free: &Free) -> [f64; 2] {
        let terms = || free.a.iter().zip(self.step.loads);
        [terms().map(|(a, load)| a * load[0]).sum(), terms().map(|(a, load)| a.abs() * load[1]).sum()]
    }

    /// Resultant of the loads along a motion that no contact resists, or `None` if it is round-off.
    fn driven(&self, free: &Free) -> Option<Undetermined> {
        let [load, size] = self.load(free);
        (free.is_exact && load.abs() > DRIVES * size).then(|| Undetermined { load, sum: free.a.clone() })
    }

    /// Beyond which distance a part of the body meets nothing, as a velocity in m/s; infinite where no part is loose.
    pub(super) fn far(&self) -> f64 {
        let Some(holds) = &self.holds else { return f64::INFINITY };
        let gap = (0..self.interface.len()).map(|i| self.opening(i).abs()).fold(0.0, f64::max);
        FAR * (holds.jumps.extent() + gap) / self.step.rule.span
    }

    /// The rigid motion that drives the parts of the body apart without end: that of the loads, if it closes no point,
    /// else that which a direction is made of.
    pub(super) fn moved(&self, direction: &[f64]) -> Vec<Undetermined> {
        let Some(holds) = &self.holds else { return Vec::new() };
        let loads: Vec<f64> = self.step.loads.iter().map(|[load, _]| *load).collect();
        let sum =
            if holds.jumps.opens(&loads) { loads } else { holds.jumps.motion_of(&self.interface.back(direction)) };
        vec![Undetermined { sum, load: 0.0 }]
    }

    /// The motions that the points resist by no more than slip at an iterate, and that are not in balance.
    pub(super) fn slipping(
        &self,
        condensed: &dyn Condensed,
        right: &Right,
        at: &Mechanics,
    ) -> Result<Vec<Undetermined>, SolveError> {
        let Some(holds) = &self.holds else { return Ok(Vec::new()) };
        let laws = self.laws(&at.x, &at.multipliers);
        // Along motions that close no point: what opens may yet be held.
        let resists = |i: usize| {
            let [_, first, second] = resisting(&laws[i], self.step.dim);
            let sticks = laws[i].status == Status::Stick;
            [[1.0, 0.0, 0.0], if sticks { first } else { [0.0; 3] }, if sticks { second } else { [0.0; 3] }]
        };
        let free = holds.jumps.free(&self.interface, resists, &holds.frees(), (false, holds.scale.len()));
        let increment: Vec<f64> = at.x.iter().zip(right.guess).map(|(x, guess)| x - guess).collect();
        let inner = right.product(condensed, increment)?;
        let mut forces = vec![0.0; at.x.len()];
        for (i, laws) in laws.iter().enumerate() {
            self.interface.scatter(i, &laws.projected(), &mut forces);
        }
        let rest: Vec<f64> = right.r.iter().zip(&inner).zip(&forces).map(|((r, s), f)| r - s - f).collect();
        let drives = |free: &Free| {
            let load = dot(&free.vector, &rest);
            let [acts, size] = self.load(free);
            (acts.abs() > SLIPS * size && load.abs() > SLIPS * acts.abs())
                .then(|| Undetermined { load, sum: free.a.clone() })
        };
        Ok(free.iter().filter_map(drives).collect())
    }
}
