//! How the contact points start into a step of the ϑ-scheme: impacts, and slip at the start.

use super::system::Step;
use crate::contact::{GraphKind, PointOnBoundary};
use crate::inclusion::{Frame, Onset, PointState};
use crate::linalg::max_abs;
use crate::tensor::{Point, dot, length};
use crate::time::{ContactRule, FrictionRule};

/// Gap that counts as contact: over the path of the fastest node in a step, and over the largest displacement or gap of
/// a contact point; besides, the last bits of the positions of nodes, so that the round-off of a body at rest does not
/// open its contact. More points may bear pressure by it, which does nothing to one that opens.
const TOUCHES: [f64; 2] = [1e-9, 1e-12];

impl Step<'_> {
    /// How the points start into the step; empty if it has no law of impact.
    pub fn onsets(&self, frames: &[Frame]) -> Vec<Onset> {
        let Some(rule) = self.rule.contact.filter(|_| self.rule.has_impacts()) else { return Vec::new() };
        let touches =
            if self.contacts.iter().any(|contact| contact.normal.is_rigid()) { self.touches(frames) } else { 0.0 };
        let points = self.boundary.points.iter().zip(frames).enumerate();
        points.map(|(i, (point, frame))| self.onset(i, point, frame, touches, rule)).collect()
    }

    /// True if a point hit a rigid foundation in the step: it bears pressure, did not in the step before, and
    /// approached. A point without mass does not hit.
    pub fn hits(&self, frames: &[Frame], states: &[PointState]) -> bool {
        if !self.discrete.massless().is_empty() {
            return false;
        }
        let least = TOUCHES[0] * max_abs(&self.old.w);
        let points = self.boundary.points.iter().zip(frames).zip(states).enumerate();
        points.into_iter().any(|(i, ((point, frame), state))| {
            let is_graph = self.contacts[point.contact].normal.graph() == GraphKind::Multivalued;
            let is_new = state.pressure > 0.0 && self.old.multipliers.p.get(i).is_none_or(|p| *p <= 0.0);
            is_graph && is_new && self.at(point, &self.old.w, frame).0 - frame.gap_rate > least
        })
    }

    /// Gap that counts as contact, m.
    fn touches(&self, frames: &[Frame]) -> f64 {
        let along = |(point, frame): (&PointOnBoundary, &Frame)| self.at(point, &self.old.u, frame).0.abs();
        let displaced = self.boundary.points.iter().zip(frames).map(along).fold(0.0, f64::max);
        let gap = frames.iter().map(|frame| frame.gap.abs()).fold(0.0, f64::max);
        let nodes = &self.discrete.mesh.points;
        let from = |x: &Point| nodes.first().map_or(0.0, |first| length(&std::array::from_fn(|c| x[c] - first[c])));
        let extent = nodes.iter().map(from).fold(0.0, f64::max);
        let moved = TOUCHES[0] * self.rule.k * max_abs(&self.old.w) + TOUCHES[1] * displaced.max(gap);
        moved + f64::EPSILON * extent
    }

    /// Normal and tangential component of a field at a point.
    fn at(&self, point: &PointOnBoundary, field: &[f64], frame: &Frame) -> (f64, Point) {
        let v = self.boundary.vector_at(point, self.discrete.mesh.dim, field);
        let along = dot(&v, &frame.normal);
        (along, std::array::from_fn(|c| v[c] - along * frame.normal[c]))
    }

    /// A point bears pressure in the step if it would touch at the end of it with the velocity of its start, or did in
    /// the step before: without the latter a point caught before it touched is let go in the next step.
    fn onset(&self, i: usize, point: &PointOnBoundary, frame: &Frame, touches: f64, rule: ContactRule) -> Onset {
        let (k, theta) = (self.rule.k, self.rule.level);
        let (w_nu, w_tau) = self.at(point, &self.old.w, frame);
        let slip = match rule.friction {
            FrictionRule::Mean => [0.0; 3],
            FrictionRule::End => std::array::from_fn(|c| (1.0 - theta) * (w_tau[c] - frame.velocity[c])),
        };
        let speed = w_nu - frame.gap_rate;
        let approach = match self.contacts[point.contact].normal.graph() {
            GraphKind::Function => 0.0,
            GraphKind::Bilateral => (1.0 - theta) * speed,
            GraphKind::Multivalued => {
                let start = self.at(point, &self.old.u, frame).0 - (frame.gap - k * frame.gap_rate);
                let pressed = self.old.multipliers.p.get(i).is_some_and(|p| *p > 0.0);
                if pressed || start + k * speed >= -touches {
                    (1.0 - theta * (1.0 + rule.restitution)) * speed.max(0.0)
                } else {
                    f64::INFINITY
                }
            }
        };
        Onset { approach, slip }
    }
}
