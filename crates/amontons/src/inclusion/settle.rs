//! Rigid motions in a step: those that no contact can determine are held from its start, those that the contact found
//! does not determine take the least size at its end, and what a load drives is refused.

use std::sync::Arc;

use super::loose::{Free, Jumps, Resists, Undetermined};
use super::mechanical::Mechanical;
use super::newton::{Right, Term};
use super::point::Laws;
use super::solve::Mechanics;
use super::{Failure, NotConverged};
use crate::linalg::{Condensed, Spring, Tangent};
use crate::list::List;

/// Share of the forces on a part, each by what it does along a motion, that drives it: less is round-off.
const DRIVES: f64 = 1e-6;
/// Share of the motion of all contact nodes above which a motion that nothing determines is not the least: one that is
/// not resisted at all, and one in doubt.
const LEAST: f64 = 1e-9;
const LARGE: f64 = 0.1;
/// Stiffness of a point, relative to the largest of its tangent, below which it resists nothing.
const RESISTS: f64 = 1e-9;

/// What holds the rigid motions of a step.
#[derive(Clone, Debug)]
pub(super) struct Holds {
    jumps: Arc<Jumps>,
    /// The stiffness of S at each unknown.
    scale: Arc<[f64]>,
    /// The motions that are held at rest, with their springs.
    held: Vec<(Free, Spring)>,
}

impl Holds {
    fn frees(&self) -> Vec<Free> {
        self.held.iter().map(|(free, _)| free.clone()).collect()
    }

    fn springs(&self) -> Vec<Spring> {
        self.held.iter().map(|(_, spring)| spring.clone()).collect()
    }

    fn add(&mut self, free: &[Free]) {
        let with_spring = |free: &Free| (free.clone(), Jumps::spring(free, &self.scale));
        let more: Vec<_> = free.iter().map(with_spring).collect();
        self.held.extend(more);
    }
}

/// The solution of a step with its rigid motions.
pub(super) struct Settled {
    pub end: Mechanics,
    pub iterations: usize,
    pub loose: Vec<Undetermined>,
    /// The forces of springs by unknown, in the axes of space; empty if there are none.
    pub held: List<f64>,
}

/// The directions in which a point resists a motion at an iterate.
pub(super) fn resisting(laws: &Laws, dim: usize) -> Resists {
    let (_, t) = laws.linear(dim);
    let normal = if t[0][0] > 0.0 { [1.0, 0.0, 0.0] } else { [0.0; 3] };
    // The principal directions of the symmetric part along the tangents.
    let (mean, half, mixed) = (0.5 * (t[1][1] + t[2][2]), 0.5 * (t[1][1] - t[2][2]), 0.5 * (t[1][2] + t[2][1]));
    let radius = half.hypot(mixed);
    let along = |value: f64, angle: f64| {
        let resists = value > RESISTS * (mean.abs() + radius);
        if resists { [0.0, angle.cos(), angle.sin()] } else { [0.0; 3] }
    };
    let angle = 0.5 * mixed.atan2(half);
    [normal, along(mean + radius, angle), along(mean - radius, angle + std::f64::consts::FRAC_PI_2)]
}

impl Mechanical<'_> {
    /// Finds the rigid motions of the step, and holds those that no point of contact could determine if all were closed
    /// and stuck.
    pub fn find_motions(&mut self, condensed: &dyn Condensed) {
        if self.step.loose.is_empty() {
            return;
        }
        let size = condensed.len();
        let jumps = Arc::new(Jumps::new(self.step.loose, &self.interface, self.step.boundary, size));
        let may = |i: usize| -> Resists {
            let smooth = self.contact(i).friction.is_frictionless() || self.step.boundary.points[i].is_smooth;
            let friction = f64::from(u8::from(!smooth));
            [[1.0, 0.0, 0.0], [0.0, friction, 0.0], [0.0, 0.0, friction]]
        };
        let free = jumps.free(&self.interface, may, &[], (true, size));
        let mut holds = Holds { jumps, scale: condensed.scale().into(), held: Vec::new() };
        holds.add(&free);
        self.holds = Some(holds);
    }

    /// Adds the springs of the motions that are held, and of those that the points leave free.
    pub fn hold(&self, tangent: &mut Tangent, resists: impl Fn(usize) -> Resists) {
        let Some(holds) = &self.holds else { return };
        holds.held.iter().for_each(|(_, spring)| tangent.hold(spring.clone()));
        let free = holds.jumps.free(&self.interface, resists, &holds.frees(), (false, holds.scale.len()));
        free.iter().for_each(|free| tangent.hold(Jumps::spring(free, &holds.scale)));
    }

    /// Solves the step: see [`super::MechanicalStep::solve`].
    pub fn solve_held(
        &mut self,
        condensed: &mut dyn Condensed,
        [r, guess]: [&[f64]; 2],
        start: Mechanics,
    ) -> Result<Settled, Failure> {
        let Some(holds) = &self.holds else {
            let (end, iterations) = self.solve(condensed, &Right { r, guess, proximal: None, springs: &[] }, start)?;
            return Ok(Settled { end, iterations, loose: Vec::new(), held: List::new() });
        };
        let driven: Vec<Undetermined> = holds.held.iter().filter_map(|(free, _)| driven(free, r)).collect();
        if holds.held.iter().any(|(free, _)| free.is_exact) && !driven.is_empty() {
            return Err(Failure::Driven(driven));
        }
        let springs = holds.springs();
        let right = Right { r, guess, proximal: None, springs: &springs };
        let (end, iterations) = self.solve(condensed, &right, start).map_err(|why| self.driven_by(why, r))?;
        let excess = self.excess(r, &end);
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
        let size = crate::linalg::dot(&end.x, &end.x).sqrt();
        let moves = |free: &&Free| {
            let share = if free.is_exact { LEAST } else { LARGE };
            crate::linalg::dot(&free.vector, &end.x).abs() > share * size
        };
        let moving: Vec<Free> = free.iter().filter(moves).cloned().collect();
        let before = self.holds.clone();
        if !moving.is_empty() {
            if let Some(holds) = &mut self.holds {
                holds.add(&moving);
            }
            let springs = self.holds.as_ref().map(Holds::springs).unwrap_or_default();
            match self.solve(condensed, &Right { springs: &springs, ..right.clone() }, end.clone()) {
                Ok((least, more)) if self.excess(right.r, &least).is_empty() => {
                    (end, iterations) = (least, iterations + more);
                }
                Ok(_) | Err(Failure::NotConverged(_) | Failure::Driven(_)) => self.holds = before,
                Err(error) => return Err(error),
            }
        }
        let of_free = |free: Free| Undetermined { load: 0.0, sum: free.a.to_vec() };
        let mut loose: Vec<Undetermined> = self.left_free(&end).into_iter().map(of_free).collect();
        let mut held = List::filled(0.0, end.x.len());
        for (free, spring) in self.holds.iter().flat_map(|holds| &holds.held) {
            let motion = spring.motion(&end.x);
            spring.add(-motion, &mut held);
            loose.push(Undetermined { load: spring.stiffness * motion, sum: free.a.to_vec() });
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
    fn excess(&self, r: &[f64], end: &Mechanics) -> Vec<Undetermined> {
        let Some(holds) = &self.holds else { return Vec::new() };
        let laws = self.laws(&end.x, &end.multipliers);
        let of = |(free, spring): &(Free, Spring)| {
            let load = spring.stiffness * spring.motion(&end.x);
            let of_point = |(i, laws): (usize, &Laws)| {
                let [p, q1, q2] = laws.force();
                let doubt = holds.jumps.doubt(i, &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], &free.a);
                self.interface.rows[i].weight * (p.abs() + q1.hypot(q2)) * doubt
            };
            let doubtful: f64 = laws.iter().enumerate().map(of_point).sum();
            let is_borne = load.abs() <= super::loose::DOUBTFUL * doubtful + DRIVES * along(free, r);
            (!is_borne).then(|| Undetermined { load, sum: free.a.to_vec() })
        };
        holds.held.iter().filter_map(of).collect()
    }

    /// Why a step has no solution: what drives the body, where no contact holds it against its load.
    fn driven_by(&self, why: Failure, _r: &[f64]) -> Failure {
        match why {
            Failure::NotConverged(NotConverged { .. }) | Failure::Linear(_) | Failure::Driven(_) => why,
        }
    }
}

/// The sizes of forces by what they do along a motion.
fn along(free: &Free, r: &[f64]) -> f64 {
    free.vector.iter().zip(r).map(|(v, r)| (v * r).abs()).sum()
}

/// What forces do along a motion, if it is not their round-off.
fn driven(free: &Free, r: &[f64]) -> Option<Undetermined> {
    let load = crate::linalg::dot(&free.vector, r);
    (free.is_exact && load.abs() > DRIVES * along(free, r)).then(|| Undetermined { load, sum: free.a.to_vec() })
}
