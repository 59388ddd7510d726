//! The mechanical step on Γ_C: normal contact, friction and wear.

use std::sync::{Arc, Mutex, PoisonError};

use super::STIFF;
use super::frame::{Frame, Onset, PointDerivative, PointState};
use super::friction::Slip;
use super::interface::{Interface, Local, LocalTangent, Row};
use super::loose::{Holds, Loose, resisting};
use super::multipliers::Multipliers;
use super::newton::Term;
use super::normal::Response;
use super::point::{Kinematics, Laws, Multiplier, Site, slowest, stiff_beside};
use crate::arrays::per_point;
use crate::contact::{
    Contact, ContactBoundary, ContactPoint, GraphKind, Impact, MeanPressure, NormalLaw, Status, arrays,
};
use crate::linalg::{Condensed, SolveError, Tangent, max_abs};
use crate::pulse::Pulse;
use crate::space::Space;
use crate::tensor::{Point, dot, given, length};
use crate::time::Rule;

/// 1 + λ G′ up to which a pressure is asked to be G(r) as sharply as the other residuals are small: p − G(r) is
/// 1 + λ G′ times the defect p − J. A defect of 1e-12 of the largest term is then one of 1e-9 in the pressure, which is
/// as sharp as (2.8) is asked to hold; for a stiffer law the multiplier is the more accurate pressure.
const SHARPEST: f64 = 1024.0;
/// Relative change of a pressure within the round-off of the penetration above which the law jumps there. Of a law
/// without a jump it is at most 1e-9 of the largest pressure, by the number above; a jump is of the order of one.
const JUMP: f64 = 1e-3;
/// Iterates whose states are kept, to name the points that do not settle where a step fails.
const SEEN: usize = 8;

/// Data of a mechanical step on Γ_C that are known before it is solved.
#[derive(Clone, Copy)]
pub struct MechanicalStep<'a> {
    /// The laws of each side.
    pub contacts: &'a [Contact],
    /// The contact points.
    pub boundary: &'a ContactBoundary,
    /// Unknown of (contact node, component), or `None` if it is prescribed.
    pub unknown: &'a [Option<u32>],
    /// The space of the velocities.
    pub space: &'a Space,
    /// Dimension d.
    pub dim: usize,
    /// The rule in time.
    pub rule: Rule,
    /// ū at the contact nodes, node-major.
    pub u_bar: &'a [f64],
    /// Velocities at the contact nodes, those that are prescribed filled in.
    pub w_prescribed: &'a [f64],
    /// The foundation at each contact point.
    pub frames: &'a [Frame],
    /// How the points start into a step with a law of impact; empty in others.
    pub onsets: &'a [Onset],
    /// Temperature at the contact points that the step is made with, of the side `on`, K.
    pub temperature: &'a [f64],
    /// True if the step is solved again for the remaining round-off.
    pub is_repeated: bool,
    /// True if the step is halved when the iteration does not converge; the iteration then ends sooner.
    pub may_be_halved: bool,
    /// Receives the progress of each iteration.
    pub pulse: &'a Pulse,
    /// The rigid motions of parts that nothing but contact holds.
    pub loose: &'a Arc<Loose>,
    /// Resultant of the loads along each of these motions, and its value if no loads cancelled.
    pub loads: &'a [[f64; 2]],
}

/// The mechanical term of a step.
pub struct Mechanical<'a> {
    pub(super) step: MechanicalStep<'a>,
    pub(super) interface: Interface,
    /// ρ of each point in Pa s/m, and how its pressure is found.
    pub(super) rho: Vec<f64>,
    pub(super) response: Vec<Response>,
    /// Treatment of friction at all points.
    pub(super) slip: Slip,
    /// Stiffness of a point that sticks, or lies on a rigid foundation, over ρ.
    stiff: f64,
    /// ū_ν − g at each point, m, and the size of the terms it is the difference of.
    opening: Vec<[f64; 2]>,
    /// v_F + b along the tangents at each point: the velocity relative to which the law of friction takes the slip.
    foundation: Vec<[f64; 2]>,
    /// States of the points at the last iterates that were evaluated, the last one last.
    seen: Mutex<[Vec<Status>; SEEN]>,
    /// Supports of rigid motions, or `None` if the parts are supported.
    pub(super) holds: Option<Holds>,
}

impl<'a> Mechanical<'a> {
    /// The term of a step. Without `condensed` multipliers are taken as they are.
    pub fn new(step: MechanicalStep<'a>, condensed: Option<&dyn Condensed>) -> Mechanical<'a> {
        let normals: Vec<Point> = step.frames.iter().map(|frame| frame.normal).collect();
        let share = step.rule.contact_share();
        let interface =
            Interface::of_vectors(step.boundary, step.unknown, step.w_prescribed, &normals, step.space).weighted(share);
        let mut rho = condensed.map_or_else(
            || vec![0.0; interface.len()],
            |c| interface.stiffness(step.boundary, Some(step.space), step.unknown, c.scale()),
        );
        for rho in &mut rho {
            *rho /= share;
        }
        let response = rho.iter().enumerate().map(|(i, &rho)| match step.has_multiplier(i) {
            false => Response::Function,
            true if rho > 0.0 => Response::Multiplier { lambda: step.rule.span / rho },
            true => Response::Given,
        });
        let response = response.collect();
        let opening =
            step.boundary.points.iter().zip(step.frames).map(|(point, frame)| step.opening(point, frame)).collect();
        let foundation = interface.rows.iter().zip(step.frames).enumerate();
        let foundation = foundation.map(|(i, (row, frame))| {
            let v = tail(row.local(&frame.velocity));
            let Some(onset) = step.onsets.get(i) else { return v };
            let b = tail(row.local(&onset.slip));
            [v[0] + b[0], v[1] + b[1]]
        });
        let foundation = foundation.collect();
        let stiff = if step.loose.is_empty() { STIFF } else { stiff_beside(&rho) };
        Mechanical {
            step,
            stiff,
            interface,
            rho,
            response,
            slip: Slip::Exact,
            opening,
            foundation,
            seen: Mutex::default(),
            holds: None,
        }
    }

    /// Something of the laws at each point, laws on arrays evaluated for all points at once.
    pub(super) fn at_points<T: Send + 'static>(&self, of: impl Fn(usize) -> T) -> Vec<T> {
        per_point(&arrays(self.step.contacts), self.interface.len(), of)
    }

    /// ū_ν − g at a point, m.
    pub(super) fn opening(&self, i: usize) -> f64 {
        self.opening.get(i).map_or(0.0, |[opening, _]| *opening)
    }

    pub(super) fn contact(&self, i: usize) -> &Contact {
        &self.step.contacts[self.interface.rows[i].contact]
    }

    fn kinematics(&self, i: usize, w: &[f64]) -> Kinematics {
        self.kinematics_of(i, self.interface.jump(i, w), [self.opening[i][0], self.step.temperature[i]])
    }

    /// The kinematics at a jump of the velocities, ū_ν − g in m and a temperature in K.
    pub(super) fn kinematics_of(&self, i: usize, jump: Local, [opening, temperature]: [f64; 2]) -> Kinematics {
        let ([w_nu, t1, t2], frame, span) = (jump, &self.step.frames[i], self.step.rule.span);
        // r = ū_ν + σ w_ν − g, at the end of the step.
        let penetration = opening + span * w_nu;
        let rate = w_nu - frame.gap_rate;
        // Rate of r₊ if r > 0, so that the pressure does not jump if the gap closes within the step.
        let rate = rate.min(penetration / span);
        let [v1, v2] = self.foundation[i];
        let [first, second] = self.held(i);
        let slip = [if first { 0.0 } else { t1 - v1 }, if second { 0.0 } else { t2 - v2 }];
        let start = opening + span * frame.gap_rate;
        Kinematics { penetration, rate, start, slip, temperature }
    }

    pub(super) fn laws_at(&self, i: usize, w: &[f64], multiplier: &Multiplier) -> Laws {
        self.laws_with(i, w, multiplier, self.response[i])
    }

    /// The laws at a point, its pressure found in a way of its own.
    pub(super) fn laws_with(&self, i: usize, w: &[f64], multiplier: &Multiplier, response: Response) -> Laws {
        self.laws_of(i, &self.kinematics(i, w), multiplier, response)
    }

    /// The laws at a point and its kinematics.
    pub(super) fn laws_of(&self, i: usize, at: &Kinematics, multiplier: &Multiplier, response: Response) -> Laws {
        let (contact, rule, frame, start) = (self.contact(i), self.step.rule, &self.step.frames[i], at.start);
        let law = contact.normal.as_ref();
        let mean = MeanPressure::of(law, start, &rule);
        let impact = Impact::new(law, start + rule.span * self.step.onset(i).approach);
        let normal: &dyn NormalLaw = match law.graph() {
            _ if rule.contact.is_none() => law,
            GraphKind::Function if rule.is_at_end() => law,
            GraphKind::Function => &mean,
            _ if rule.has_impacts() => &impact,
            _ => law,
        };
        let site = Site {
            contact,
            normal,
            start,
            row: &self.interface.rows[i],
            x: self.step.boundary.points[i].x,
            rule,
            response,
            rho: self.rho[i],
            // A point that never slips has no bound that could be smoothed.
            slip: if self.contact(i).friction.never_slips() { Slip::Exact } else { self.slip },
            stiff: self.stiff,
            in_space: self.step.dim == 3,
            slides_out: self.slides_out(i),
            held: self.held(i),
            opening: frame.opening,
            slip_share: rule.slip_share(),
        };
        Laws::new(&site, at, multiplier)
    }

    /// This term with another treatment of friction.
    pub(super) fn with(&self, slip: Slip) -> Mechanical<'a> {
        Mechanical {
            step: self.step,
            interface: self.interface.clone(),
            rho: self.rho.clone(),
            response: self.response.clone(),
            slip,
            stiff: self.stiff,
            opening: self.opening.clone(),
            foundation: self.foundation.clone(),
            seen: Mutex::default(),
            holds: self.holds.clone(),
        }
    }

    /// The same with other supports of the rigid motions.
    pub(super) fn with_holds(&self, holds: Holds) -> Mechanical<'a> {
        Mechanical { holds: Some(holds), ..self.with(self.slip) }
    }

    /// ‖w_τ − v_F‖ at a point, m/s.
    pub(super) fn slip_speed(&self, i: usize, w: &[f64]) -> f64 {
        let [s1, s2] = self.kinematics(i, w).slip;
        s1.hypot(s2)
    }

    /// The laws at a point of a solution: the pressure of a soft function is that at the penetration, so that (2.8)
    /// holds to the last bit; that of a stiff one, which the last bits of the penetration would change, of a graph and
    /// of a function at a jump is the multiplier.
    fn laws_found(&self, i: usize, w: &[f64], multiplier: &Multiplier) -> Laws {
        let given = self.laws_with(i, w, multiplier, Response::Given);
        let Response::Multiplier { lambda } = self.response[i] else { return self.laws_at(i, w, multiplier) };
        if self.contact(i).normal.graph() != GraphKind::Function {
            return given;
        }
        let found = self.laws_with(i, w, multiplier, Response::Function);
        let is_soft = lambda * found.normal.slope <= SHARPEST * self.step.rule.span;
        let p = found.normal.pressed;
        if is_soft && (p - multiplier.p).abs() <= JUMP * p.abs().max(multiplier.p.abs()) { found } else { given }
    }

    /// The multipliers by their components at each point. Out of the plane there is friction only while the foundation
    /// slides there.
    pub(super) fn local(&self, multipliers: &Multipliers) -> Vec<Multiplier> {
        let of = |(i, row): (usize, &Row)| {
            let mut q = tail(row.local(&multipliers.q[i]));
            if !self.slides_out(i) {
                q.iter_mut().skip(self.step.dim - 1).for_each(|q| *q = 0.0);
            }
            q.iter_mut().zip(self.held(i)).filter(|(_, held)| *held).for_each(|(q, _)| *q = 0.0);
            Multiplier { p: multipliers.p[i], q, sticks: multipliers.sticks[i] }
        };
        self.interface.rows.iter().enumerate().map(of).collect()
    }

    /// Along which tangents there is no friction, since both sides are held alike there. A tie in space holds them all
    /// the same; in the plane there is nothing to tie.
    pub(super) fn held(&self, i: usize) -> [bool; 2] {
        let in_space = self.step.dim == 3;
        match given(&self.step.boundary.points[i].held).count() {
            0 => [false; 2],
            _ if !in_space => [true, false],
            _ if self.contact(i).friction.never_slips() => [false; 2],
            1 => [false, true],
            _ => [true; 2],
        }
    }

    /// True if the foundation slides in a direction in which a plane body or a body of revolution does not move.
    pub(super) fn slides_out(&self, i: usize) -> bool {
        self.foundation[i].iter().skip(self.step.dim - 1).any(|v| *v != 0.0)
    }

    /// The multipliers as vectors.
    pub(super) fn global(&self, multipliers: &[Multiplier]) -> Multipliers {
        Multipliers {
            p: multipliers
                .iter()
                .zip(&self.response)
                .map(|(m, response)| if *response == Response::Function { 0.0 } else { m.p })
                .collect(),
            q: self.interface.rows.iter().zip(multipliers).map(|(row, m)| row.tangential(&m.q)).collect(),
            sticks: multipliers.iter().map(|m| m.sticks).collect(),
        }
    }

    /// True if the bound of a point drops when slip starts. The iteration then stays on the branch on which it starts,
    /// because overshooting iterates would release a point that can stick.
    pub(super) fn drops(&self, i: usize) -> bool {
        self.contact(i).friction.drops_from_rest()
    }
}

impl MechanicalStep<'_> {
    /// How a point starts into the step.
    fn onset(&self, i: usize) -> Onset {
        self.onsets.get(i).copied().unwrap_or_default()
    }

    /// True if the pressure of a point is a multiplier, as for all but softening laws, which have no resolvent.
    fn has_multiplier(&self, i: usize) -> bool {
        let point = &self.boundary.points[i];
        let law = &self.contacts[point.contact].normal;
        law.graph() != GraphKind::Function || law.least_slope(&point.x, f64::NEG_INFINITY, f64::INFINITY) >= 0.0
    }

    /// ū_ν − g and the size of the terms.
    fn opening(&self, point: &crate::contact::PointOnBoundary, frame: &Frame) -> [f64; 2] {
        let (mut sum, mut size) = (0.0, frame.gap.abs());
        for (node, value, turn) in point.entries() {
            let normal = turn.map_or(frame.normal, |turn| turn.back(&frame.normal));
            for c in 0..self.dim {
                let term = value * self.u_bar[node * self.dim + c] * normal[c];
                sum += term;
                size += term.abs();
            }
        }
        [sum - frame.gap, size]
    }
}

impl Mechanical<'_> {
    /// The states of the contact points at velocities on Γ_C, the multipliers as they are.
    pub fn point_states(&self, w: &[f64], multipliers: &Multipliers) -> Vec<PointState> {
        let (w, local) = (self.interface.turned(w), self.local(multipliers));
        let of = |i: usize| {
            let laws = self.laws_found(i, &w, &local[i]);
            let mut state = laws.state(&self.interface.rows[i]);
            if let Some(Onset { slip: b, .. }) = self.step.onsets.get(i) {
                state.slip = std::array::from_fn(|c| state.slip[c] + b[c]);
            }
            if state.bound > 0.0 {
                // At the bound to round-off, and moving: slip.
                let at_bound = laws.friction.size() >= state.bound * (1.0 - 1e-9);
                state.status = if at_bound { Status::Slip } else { Status::Stick };
            }
            state
        };
        self.at_points(of)
    }

    /// The derivatives at a solution: that of the contact forces in the velocity, in the basis that `condensed` has,
    /// and all of them at each point.
    pub fn tangent(
        &mut self,
        condensed: &mut dyn Condensed,
        w: &[f64],
        multipliers: &Multipliers,
    ) -> (Tangent, Vec<PointDerivative>) {
        condensed.turn(&self.interface.turns);
        self.find_motions(condensed);
        let (w, local, dim) = (self.interface.turned(w), self.local(multipliers), self.step.dim);
        let mut tangent = self.interface.empty_tangent();
        let laws = self.at_points(|i| self.laws_at(i, &w, &local[i]));
        let points = laws.iter().enumerate().map(|(i, laws)| {
            self.interface.add_tangent(i, &laws.linear(dim).1, &mut tangent);
            laws.derivative(&self.interface.rows[i], dim)
        });
        let points = points.collect();
        self.hold(&mut tangent, |i| resisting(&laws[i], dim));
        (tangent, points)
    }

    /// Contact tractions by the laws at each point: the pressure on the graph along ν, and q + ρ w_τ projected onto the
    /// cone, in Pa. At a solution this is p ν + q.
    pub fn tractions(&self, w: &[f64], multipliers: &Multipliers) -> Vec<Point> {
        let (w, local) = (self.interface.turned(w), self.local(multipliers));
        let of = |i: usize| {
            let [_, q1, q2] = self.laws_at(i, &w, &local[i]).projected();
            self.interface.rows[i].global(&[self.laws_found(i, &w, &local[i]).normal.pressed, q1, q2])
        };
        self.at_points(of)
    }

    /// True if the step with its friction bounds frozen has no other solution between two velocities: S with the least
    /// slopes of the laws between them, friction at the larger of the pressures of both ends, is positive definite. Of
    /// friction, velocity weakening counts, but not the drop from rest, after which a sticking point continues to stick
    /// as long as it can. The term is one without `condensed`. Proof: `book/src/theory.md`, section 3.5.
    ///
    /// # Errors
    /// If definiteness cannot be determined.
    pub fn is_unique(
        &self,
        condensed: &mut dyn Condensed,
        [from, to]: [&[f64]; 2],
        multipliers: [&Multipliers; 2],
    ) -> Result<bool, SolveError> {
        let [from, to] = [from, to].map(|w| self.interface.turned(w));
        let local = self.local(multipliers[1]);
        let slopes =
            self.at_points(|i| self.least_slopes(i, [&from, &to], &local[i], multipliers.map(|m| m.sticks[i])));
        if slopes.iter().flatten().all(|slope| *slope >= 0.0) {
            return Ok(true);
        }
        if slopes.iter().flatten().any(|slope| !slope.is_finite()) {
            return Ok(false);
        }
        condensed.turn(&self.interface.turns);
        let mut sum = self.interface.empty_tangent();
        for (i, [normal, tangential]) in slopes.into_iter().enumerate() {
            let mut tangent: LocalTangent = [[0.0; 3]; 3];
            tangent[0][0] = normal;
            for a in 1..self.step.dim {
                tangent[a][a] = tangential;
            }
            self.interface.add_tangent(i, &tangent, &mut sum);
        }
        match condensed.is_positive_definite(&sum) {
            // If the iterative solver does not converge, uniqueness is not known and is denied.
            Err(SolveError::NotConverged { .. }) => Ok(false),
            found => found,
        }
    }

    /// The least slopes of pressure and friction bound of a point between two velocities.
    fn least_slopes(&self, i: usize, [from, to]: [&[f64]; 2], multiplier: &Multiplier, sticks: [bool; 2]) -> [f64; 2] {
        let (point, frame, contact) = (&self.step.boundary.points[i], &self.step.frames[i], self.contact(i));
        let [before, after] = [from, to].map(|w| self.laws_at(i, w, multiplier));
        // Penetration at t_{n−1}: that of `from` is what the step would lead to without a change of velocity.
        let start = before.penetration - self.step.rule.span * (self.interface.jump(i, from)[0] - frame.gap_rate);
        let normal = self.step.rule.span
            * contact.normal.least_slope(&point.x, start.min(after.penetration), start.max(after.penetration));
        // The larger of the pressures of both ends: a fall with the slip speed grows with it.
        let at_end = after.normal.pressed;
        let pressure = match contact.normal.graph() {
            GraphKind::Function => at_end.max(contact.normal.pressure(&point.x, start, 0.0, 0.0).value).max(0.0),
            GraphKind::Multivalued => at_end.max(0.0),
            GraphKind::Bilateral => at_end.abs(),
        };
        let seen = ContactPoint {
            x: point.x,
            penetration: after.penetration,
            pressure,
            temperature: self.step.temperature[i],
            ..ContactPoint::default()
        };
        // The slip of a point that sticks is round-off, or the change of v_F that it follows.
        let slip = |laws: &Laws, sticks: bool| if sticks { [0.0; 2] } else { laws.friction.slip };
        let [before, after] = [slip(&before, sticks[0]), slip(&after, sticks[1])].map(|[a, b]| [a, b, 0.0]);
        [normal, contact.friction.least_slope(&seen, slowest(&before, &after), length(&before).max(length(&after)))]
    }
}

impl Term for Mechanical<'_> {
    type Multipliers = Vec<Multiplier>;
    type Laws = Vec<Laws>;

    fn laws(&self, x: &[f64], multipliers: &Vec<Multiplier>) -> Vec<Laws> {
        let laws = self.at_points(|i| self.laws_at(i, x, &multipliers[i]));
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        seen.rotate_left(1);
        seen[SEEN - 1] = laws.iter().map(|laws| laws.status).collect();
        laws
    }

    fn forces(&self, laws: &Vec<Laws>, out: &mut [f64]) {
        for (i, laws) in laws.iter().enumerate() {
            self.interface.scatter(i, &laws.force(), out);
        }
    }

    fn defects(&self, laws: &Vec<Laws>) -> Vec<f64> {
        let of = |(i, laws): (usize, &Laws)| {
            let (weight, force, projected) = (self.interface.rows[i].weight, laws.force(), laws.projected());
            [0, 1, 2].map(|a| weight * (force[a] - projected[a]))
        };
        laws.iter().enumerate().flat_map(of).collect()
    }

    fn round_off(&self, x: &[f64], laws: &Vec<Laws>) -> f64 {
        let mut sizes = vec![0.0; x.len()];
        let span = self.step.rule.span;
        for (i, laws) in laws.iter().enumerate() {
            let [w_nu, t1, t2] = self.interface.sizes(i, x);
            let size = self.opening[i][1] + span * w_nu;
            // The slip of a point that sticks is a difference of larger numbers; to one that slips it is a direction.
            let [v1, v2] = self.foundation[i];
            let [s1, s2] = if laws.sticks { [t1 + v1.abs(), t2 + v2.abs()].map(|v| self.rho[i] * v) } else { [0.0; 2] };
            self.interface.scatter_sizes(i, &[laws.normal.slope / span * size, s1, s2], &mut sizes);
        }
        max_abs(&sizes)
    }

    fn is_sharp(&self, x: &[f64], laws: &Vec<Laws>, tolerance: f64) -> bool {
        laws.iter().enumerate().all(|(i, laws)| {
            let (normal, weight) = (&laws.normal, self.interface.rows[i].weight);
            let size = self.opening[i][1] + self.step.rule.span * self.interface.sizes(i, x)[0];
            let round_off = 16.0 * f64::EPSILON * normal.stiffness() / self.step.rule.span * size;
            let error = (normal.pressed - normal.pressure).abs() / normal.yielding;
            normal.yielding * SHARPEST < 1.0 || weight * error <= tolerance.max(weight * round_off)
        })
    }

    fn linearise(&self, laws: &Vec<Laws>, right: &mut [f64]) -> Tangent {
        let mut tangent = self.interface.empty_tangent();
        for (i, laws) in laws.iter().enumerate() {
            let (force, slope) = laws.linear(self.step.dim);
            self.interface.scatter(i, &force.map(|f| -f), right);
            self.interface.add_tangent(i, &slope, &mut tangent);
        }
        self.hold(&mut tangent, |i| resisting(&laws[i], self.step.dim));
        tangent
    }

    fn after(&self, laws: &Vec<Laws>, before: &Vec<Multiplier>, step: &[f64]) -> Vec<Multiplier> {
        let of = |(i, (laws, before)): (usize, (&Laws, &Multiplier))| {
            let ((force, tangent), moved) = (laws.linear(self.step.dim), self.interface.change(i, step));
            let [p, q1, q2] = std::array::from_fn(|a| force[a] + dot(&tangent[a], &moved));
            Multiplier { p, q: [q1, q2], sticks: if self.drops(i) { before.sticks } else { laws.sticks } }
        };
        laws.iter().zip(before).enumerate().map(of).collect()
    }

    fn towards(from: &Vec<Multiplier>, to: &Vec<Multiplier>, alpha: f64) -> Vec<Multiplier> {
        let part = |a: f64, b: f64| a + alpha * (b - a);
        let of = |(a, b): (&Multiplier, &Multiplier)| Multiplier {
            p: part(a.p, b.p),
            q: std::array::from_fn(|c| part(a.q[c], b.q[c])),
            sticks: b.sticks,
        };
        from.iter().zip(to).map(of).collect()
    }

    /// Takes points that stuck as sticking: where the foundation has changed its velocity the iterate slips by the
    /// change, which says nothing of the solution.
    fn begin(&self, laws: &mut Vec<Laws>, multipliers: &Vec<Multiplier>) {
        for (i, (laws, multiplier)) in laws.iter_mut().zip(multipliers).enumerate() {
            if multiplier.sticks && !self.slides_out(i) {
                laws.hold();
            }
        }
    }

    /// Pressures on the graph itself, those of soft functions at the penetration that was found, and the branches that
    /// were found.
    fn settled(&self, x: &[f64], laws: &Vec<Laws>, mut multipliers: Vec<Multiplier>) -> Vec<Multiplier> {
        multipliers.iter_mut().zip(laws).for_each(|(multiplier, laws)| multiplier.p = laws.normal.pressed);
        let found = self.at_points(|i| self.laws_found(i, x, &multipliers[i]).normal.pressed);
        for (i, ((multiplier, laws), found)) in multipliers.iter_mut().zip(laws).zip(found).enumerate() {
            multiplier.p = found;
            if !self.drops(i) {
                multiplier.sticks = laws.sticks;
            }
        }
        multipliers
    }

    fn states(&self, laws: &Vec<Laws>) -> Vec<Status> {
        laws.iter().map(|laws| laws.status).collect()
    }

    fn unsettled(&self, laws: &Vec<Laws>, errors: &[f64]) -> Vec<(usize, Vec<Status>)> {
        let seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let states = |i: usize| {
            let last = laws.get(i).map(|laws| laws.status);
            let mut states: Vec<Status> = Vec::new();
            for status in seen.iter().filter_map(|all| all.get(i).copied()).chain(last) {
                if states.last() != Some(&status) {
                    states.push(status);
                }
            }
            states
        };
        let left = |(i, laws): (usize, &Laws)| {
            let (force, projected) = (laws.force(), laws.projected());
            let defects = (0..3).map(|a| self.interface.rows[i].weight * (force[a] - projected[a]));
            max_abs(&self.interface.change(i, errors).into_iter().chain(defects).collect::<Vec<_>>())
        };
        let left: Vec<f64> = laws.iter().enumerate().map(left).collect();
        let largest = max_abs(&left);
        let mut points: Vec<(usize, Vec<Status>)> = (0..left.len()).map(|i| (i, states(i))).collect();
        points.retain(|(i, states)| states.len() > 1 || (largest > 0.0 && left[*i] >= 0.5 * largest));
        points.sort_by(|(a, _), (b, _)| left[*b].total_cmp(&left[*a]));
        points
    }
}

/// The tangential components.
fn tail(v: [f64; 3]) -> [f64; 2] {
    [v[1], v[2]]
}
