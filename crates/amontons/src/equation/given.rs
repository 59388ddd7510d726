//! Data of the contact points in a mechanical half-step.

use std::borrow::Cow;

use super::foundation::frames;
use super::system::{HalfStep, Step};
use crate::inclusion::{Chosen, Drive, Frame, Mechanical, MechanicalStep, Multipliers, Onset, PointState};
use crate::linalg::{SolveError, System};
use crate::state::Rigid;

/// Largest prescribed motion, relative to the displacement of its node, that counts as round-off.
const NO_MOTION: f64 = 16.0 * f64::EPSILON;

/// Data on Γ_C that are known before the half-step is solved.
#[derive(Clone, Default)]
pub(crate) struct Given {
    u_bar: Vec<f64>,
    w_prescribed: Vec<f64>,
    /// The foundation at the contact points.
    pub frames: Vec<Frame>,
    /// How the points start into a step of the ϑ-scheme.
    onsets: Vec<Onset>,
    /// The temperature used by the half-step, at the contact points on the side `on`.
    pub temperature: Vec<f64>,
    /// Resultants of the loads along the rigid motions that are resisted by contact only.
    pub loads: Vec<[f64; 2]>,
    /// δ of each contact, m: the length by which a section is drawn together or an obstacle has moved. It includes the
    /// growth in this step, as in `frames`.
    pub advance: Vec<f64>,
}

impl Given {
    /// The data with the prescribed values in `w`, without a temperature.
    pub fn new(step: &Step, w: &[f64]) -> Given {
        let Step { problem, discrete, boundary, old, bar, .. } = *step;
        let frames = frames(problem, boundary, &old.u, (&step.worn(), [&old.surface.advance; 2]), step.interval());
        Given {
            u_bar: boundary.restricted(discrete.mesh.dim, bar.u),
            w_prescribed: step.on_contact(&Given::prescribed(step, w)),
            onsets: step.onsets(&frames),
            frames,
            temperature: Vec::new(),
            loads: Vec::new(),
            advance: old.surface.advance.clone(),
        }
    }

    /// These data with another temperature of the contact points.
    pub fn at(self, temperature: Vec<f64>) -> Given {
        Given { temperature, ..self }
    }

    /// These data with δ of each driven contact increased by `lengths`.
    pub fn advanced(&self, step: &Step, drives: &[Drive], lengths: &[f64]) -> Given {
        let mut given = self.clone();
        given.advance(step, drives, lengths);
        given
    }

    /// Increases δ of each driven contact by `lengths`.
    pub fn advance(&mut self, step: &Step, drives: &[Drive], lengths: &[f64]) {
        if drives.is_empty() {
            return;
        }
        for (drive, length) in drives.iter().zip(lengths) {
            self.advance.get_mut(drive.contact).into_iter().for_each(|advance| *advance += length);
        }
        let advance = self.advance.clone();
        self.lead(step, [&step.old.surface.advance, &advance]);
    }

    /// Sets δ of each contact at the start and at the end of the step.
    pub fn lead(&mut self, step: &Step, advance: [&[f64]; 2]) {
        let Step { problem, boundary, old, .. } = *step;
        self.frames = frames(problem, boundary, &old.u, (&step.worn(), advance), step.interval());
        self.advance = advance[1].to_vec();
    }

    /// These data relative to bodies that move with rigid velocities W; `v` holds the velocities minus W.
    pub fn relative(&self, step: &Step, rigid: &[Rigid], v: &[f64]) -> Given {
        let Step { discrete, boundary, .. } = *step;
        Given {
            u_bar: boundary.restricted(discrete.mesh.dim, step.deformation_before()),
            w_prescribed: step.on_contact(&Given::prescribed(step, v)),
            frames: step.seen_from(&self.frames, rigid),
            onsets: self.onsets.clone(),
            temperature: self.temperature.clone(),
            loads: self.loads.clone(),
            advance: self.advance.clone(),
        }
    }

    /// The velocities in the directions of the degrees of freedom. A prescribed velocity that is the round-off of the
    /// displacements whose difference it is counts as no motion, so that no point slips along it.
    fn prescribed<'v>(step: &Step, w: &'v [f64]) -> Cow<'v, [f64]> {
        let (space, gamma) = (&step.discrete.v, step.rule.gamma);
        let mut directed = space.in_frames(w);
        for frame in &space.frames {
            let dofs = frame.node as usize * space.components..(frame.node as usize + 1) * space.components;
            let size = dofs.clone().fold(0.0, |size: f64, i| size.max(w[i].abs()).max((step.bar.u[i] / gamma).abs()));
            for i in dofs.filter(|&i| !space.free[i] && directed[i].abs() <= NO_MOTION * size).collect::<Vec<_>>() {
                directed.to_mut()[i] = 0.0;
            }
        }
        directed
    }

    /// Puts velocities of the size at which foundations come closer or move away at the nodes of their contact points,
    /// and the displacements γ times as large.
    pub fn put_foundations(&self, step: &Step, [velocities, displacements]: [&mut [f64]; 2]) {
        let dim = step.discrete.mesh.dim;
        for (point, frame) in step.boundary.points.iter().zip(&self.frames) {
            let rate = frame.gap_rate.abs();
            for (node, ..) in point.entries() {
                let first = step.boundary.nodes[node] as usize * dim;
                let ends = [(&mut *velocities, rate), (&mut *displacements, step.rule.gamma * rate)];
                for (values, size) in ends {
                    let at_node = values.iter_mut().skip(first).take(dim);
                    at_node.for_each(|value| *value = value.abs().max(size));
                }
            }
        }
    }

    /// The term of (4.1) on Γ_C, or `None` without contact.
    pub fn term<'a>(&'a self, step: &Step<'a>, system: &System, unknown: &'a [Option<u32>]) -> Option<Mechanical<'a>> {
        Some(Mechanical::new(self.on_boundary(step, unknown)?, Some(system.condensed())))
    }

    /// The term with what the iteration of another step chose, or `None` without contact.
    pub fn frozen<'a>(
        &'a self,
        step: &Step<'a>,
        unknown: &'a [Option<u32>],
        chosen: &Chosen,
    ) -> Option<Mechanical<'a>> {
        Some(Mechanical::new(self.on_boundary(step, unknown)?, None).frozen(chosen))
    }

    /// The data on Γ_C, or `None` without contact or mechanics.
    fn on_boundary<'a>(&'a self, step: &Step<'a>, unknown: &'a [Option<u32>]) -> Option<MechanicalStep<'a>> {
        if step.problem.contacts.is_empty() || !step.problem.physics.has_mechanics() {
            return None;
        }
        Some(MechanicalStep {
            contacts: step.contacts,
            boundary: step.boundary,
            unknown,
            space: &step.discrete.v,
            dim: step.discrete.mesh.dim,
            rule: step.rule,
            u_bar: &self.u_bar,
            w_prescribed: &self.w_prescribed,
            frames: &self.frames,
            onsets: &self.onsets,
            temperature: &self.temperature,
            is_repeated: step.apart.is_some(),
            may_be_halved: step.may_be_halved,
            pulse: step.pulse,
            loose: step.loose,
            loads: &self.loads,
        })
    }

    /// True if softening laws allow only one solution between two velocities.
    pub fn is_unique(
        &self,
        step: &Step,
        half: &mut HalfStep,
        ends: [&[f64]; 2],
        multipliers: &Multipliers,
    ) -> Result<bool, SolveError> {
        let [from, to] = ends.map(|w| half.system.kept_of(w));
        let HalfStep { system, on_contact, .. } = half;
        self.on_boundary(step, on_contact).map_or(Ok(true), |on_boundary| {
            let term = Mechanical::new(on_boundary, None);
            term.is_unique(system.condensed_mut(), [&from, &to], [&step.old.multipliers, multipliers])
        })
    }

    /// The states of the contact points.
    pub fn states(&self, step: &Step, half: &HalfStep, w: &[f64], multipliers: &Multipliers) -> Vec<PointState> {
        let term = self.term(step, &half.system, &half.on_contact);
        term.map_or_else(Vec::new, |term| term.point_states(&half.system.kept_of(w), multipliers))
    }
}
