//! Changes of a state along a direction, for the derivatives of outputs at all steps.

use super::instance::global;
use super::points::LinearPoint;
use super::sweep::OfPoints;
use super::vector::StateVector;
use crate::inclusion::PointState;
use crate::state::{State, StepReport};

/// A copy of a state with the report of its step, which is changed and restored.
pub(super) struct Scratch {
    pub state: State,
    pub report: Option<StepReport>,
}

/// A state with the report of its step, and a change of both.
pub(super) struct StateChange<'a> {
    pub base: (&'a State, Option<&'a StepReport>),
    pub change: (&'a StateVector, &'a OfPoints),
    pub points: &'a [LinearPoint],
    /// The nodes that are read, ascending; `None` if these are contact points.
    pub nodes: Option<Vec<u32>>,
    /// True if stresses or strains are read.
    pub is_of_strains: bool,
    pub dim: usize,
}

/// A part of a state whose numbers are of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ChangedPart {
    Displacement,
    Velocity,
    Temperature,
    Branches,
    Wear,
    /// Depths of wear of the sides of pairs.
    Depths,
    Work,
    /// (p, q).
    Traction,
    Penetration,
    Slip,
}

impl ChangedPart {
    /// The parts that probes of bodies read.
    pub const OF_BODY: [ChangedPart; 4] =
        [ChangedPart::Displacement, ChangedPart::Velocity, ChangedPart::Temperature, ChangedPart::Branches];
    /// The parts that probes of contact points read.
    pub const OF_CONTACT: [ChangedPart; 6] = [
        ChangedPart::Wear,
        ChangedPart::Depths,
        ChangedPart::Work,
        ChangedPart::Traction,
        ChangedPart::Penetration,
        ChangedPart::Slip,
    ];

    /// Lists of numbers of a part of a state.
    fn of(self, state: &State) -> Vec<&[f64]> {
        match self {
            ChangedPart::Displacement => vec![&state.u],
            ChangedPart::Velocity => vec![&state.w],
            ChangedPart::Temperature => vec![&state.theta],
            ChangedPart::Branches => state.branches.iter().map(|branch| &branch[..]).collect(),
            ChangedPart::Wear => vec![&state.surface.wear],
            ChangedPart::Depths => state.surface.worn.depths.iter().map(|of| &of[..]).collect(),
            ChangedPart::Work => vec![&state.surface.friction_work],
            ChangedPart::Traction | ChangedPart::Penetration | ChangedPart::Slip => Vec::new(),
        }
    }

    fn of_mut(self, state: &mut State) -> Vec<&mut [f64]> {
        match self {
            ChangedPart::Displacement => vec![&mut state.u],
            ChangedPart::Velocity => vec![&mut state.w],
            ChangedPart::Temperature => vec![&mut state.theta],
            ChangedPart::Branches => state.branches.iter_mut().map(|branch| &mut branch[..]).collect(),
            ChangedPart::Wear => vec![&mut state.surface.wear],
            ChangedPart::Depths => state.surface.worn.depths.iter_mut().map(|of| &mut of[..]).collect(),
            ChangedPart::Work => vec![&mut state.surface.friction_work],
            ChangedPart::Traction | ChangedPart::Penetration | ChangedPart::Slip => Vec::new(),
        }
    }

    fn of_change(self, change: &StateVector) -> Vec<&[f64]> {
        match self {
            ChangedPart::Displacement => vec![&change.u],
            ChangedPart::Velocity => vec![&change.w],
            ChangedPart::Temperature => vec![&change.theta],
            ChangedPart::Branches => change.branches.iter().map(|branch| &branch[..]).collect(),
            ChangedPart::Wear => vec![&change.wear],
            ChangedPart::Depths => change.depths.iter().map(|of| &of[..]).collect(),
            ChangedPart::Work => vec![&change.work],
            ChangedPart::Traction | ChangedPart::Penetration | ChangedPart::Slip => Vec::new(),
        }
    }

    /// True if the numbers are of displacements or velocities of nodes, whose differences strain the body.
    fn strains(self) -> bool {
        matches!(self, ChangedPart::Displacement | ChangedPart::Velocity | ChangedPart::Branches)
    }

    /// The places among (p, q), penetration and slip of a contact point.
    fn of_point(self) -> std::ops::Range<usize> {
        match self {
            ChangedPart::Traction => 0..3,
            ChangedPart::Penetration => 3..4,
            ChangedPart::Slip => 4..6,
            _ => 0..0,
        }
    }

    /// The size of the numbers of a contact point.
    fn size(self, state: &PointState) -> f64 {
        match self {
            ChangedPart::Traction => state.pressure.abs().max(largest(&state.q, |_| true)),
            ChangedPart::Penetration => state.penetration.abs(),
            ChangedPart::Slip => largest(&state.slip, |_| true),
            _ => 0.0,
        }
    }
}

impl StateChange<'_> {
    /// How often the change of a part is contained in it; `None` if nothing of it changes.
    pub fn scale(&self, part: ChangedPart) -> Option<f64> {
        let (state, report) = self.base;
        let (all, changes) = (part.of(state), part.of_change(self.change.0));
        let reads = |i: usize| self.reads(part, i);
        let over = |lists: &[&[f64]], reads: &dyn Fn(usize) -> bool| -> f64 {
            lists.iter().fold(0.0, |most: f64, list| most.max(largest(list, reads)))
        };
        let turned = self.points.iter().fold(0.0, |most: f64, point| most.max(self.turned(part, point)));
        let of_points =
            self.change.1.iter().fold(0.0, |most: f64, all| most.max(largest(&all[part.of_point()], |_| true)));
        let change = over(&changes, &reads).max(of_points).max(turned);
        if change == 0.0 {
            return None;
        }
        let states = report.map_or(&[][..], |report| &report.contact.states);
        let at_points = states.iter().fold(0.0, |most: f64, state| most.max(part.size(state)));
        let size = over(&all, &reads).max(at_points);
        if self.is_of_strains && part.strains() {
            let apart =
                |lists: &[&[f64]]| lists.iter().fold(0.0, |most: f64, list| most.max(spread(list, self.dim, reads)));
            let strained = apart(&changes).max(RIGID * change);
            return Some(strain_scale(size, apart(&all)) / strained);
        }
        let sizes = [size, over(&all, &|_| true), 1.0];
        sizes.into_iter().find(|size| *size > 0.0).map(|size| size / change)
    }

    /// Changes a part of the copy by `h` times the change.
    pub fn change(&self, part: ChangedPart, scratch: &mut Scratch, h: f64) {
        let (state, report) = self.base;
        let lists = part.of(state).into_iter().zip(part.of_change(self.change.0));
        for (to, (from, change)) in part.of_mut(&mut scratch.state).into_iter().zip(lists) {
            for i in (0..to.len()).filter(|&i| self.reads(part, i)) {
                to[i] = from[i] + h * change[i];
            }
        }
        let (Some(to), Some(from)) = (&mut scratch.report, report) else { return };
        let range = part.of_point();
        if range.is_empty() {
            return;
        }
        let all = to.contact.states.iter_mut().zip(&from.contact.states);
        for ((to, from), (of, point)) in all.zip(self.change.1.iter().zip(self.points)) {
            *to = *from;
            let [p, q1, q2, penetration, s1, s2] =
                std::array::from_fn(|k| if range.contains(&k) { h * of[k] } else { 0.0 });
            to.pressure += p;
            to.penetration += penetration;
            to.q.iter_mut().zip(global(&point.basis, &[0.0, q1, q2])).for_each(|(q, more)| *q += more);
            to.slip.iter_mut().zip(global(&point.basis, &[0.0, s1, s2])).for_each(|(s, more)| *s += more);
            let advance = h * self.advance(point);
            match part {
                ChangedPart::Traction => point.advance.turn(to, (&point.force, [0.0; 2]), advance),
                ChangedPart::Slip => {
                    let normal = to.normal;
                    point.advance.turn(to, (&[0.0; 3], point.slip), advance);
                    to.normal = normal;
                }
                _ => {}
            }
        }
    }

    /// The change of δ of the contact of a point.
    fn advance(&self, point: &LinearPoint) -> f64 {
        self.change.0.advance.get(point.contact).copied().unwrap_or(0.0)
    }

    /// The size of the change of the numbers of a point that turns with δ.
    fn turned(&self, part: ChangedPart, point: &LinearPoint) -> f64 {
        let size = match part {
            ChangedPart::Traction => point.force.iter().fold(0.0, |most: f64, force| most.max(force.abs())),
            ChangedPart::Slip => point.slip[0].abs().max(point.slip[1].abs()),
            _ => 0.0,
        };
        self.advance(point).abs() * point.advance.turning() * size
    }

    fn reads(&self, part: ChangedPart, i: usize) -> bool {
        let components = if part.strains() { self.dim } else { 1 };
        self.nodes.as_ref().is_none_or(|nodes| nodes.binary_search(&((i / components) as u32)).is_ok())
    }
}

/// Part of a change that strains the body which is told from its rigid motion.
const RIGID: f64 = 1e-3;

/// The scale of displacements for differences of stresses, by their size and the largest difference between nodes: with
/// steps of 2^−10 of it the fourth order and the round-off of the displacements are about the same.
pub(super) fn strain_scale(size: f64, spread: f64) -> f64 {
    let size = if size > 0.0 { size } else { 1.0 };
    if spread > 0.0 { (spread * (0.1 * size / spread).powf(0.2).max(1.0)).min(size.max(spread)) } else { size }
}

/// The largest difference of a component at two nodes that are read.
pub(super) fn spread(values: &[f64], components: usize, reads: impl Fn(usize) -> bool) -> f64 {
    let of = |c: usize| {
        let read = values.iter().enumerate().filter(|(i, _)| i % components == c && reads(*i)).map(|(_, value)| *value);
        let [low, high] =
            read.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
        (high - low).max(0.0)
    };
    (0..components).map(of).fold(0.0, f64::max)
}

fn largest(values: &[f64], reads: impl Fn(usize) -> bool) -> f64 {
    values.iter().enumerate().filter(|(i, _)| reads(*i)).fold(0.0, |most, (_, value)| most.max(value.abs()))
}
