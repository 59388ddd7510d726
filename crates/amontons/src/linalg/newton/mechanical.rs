//! The mechanical step on Γ_C.

use super::point::{Frame, Kinematics, Local, Multiplier, PointDerivative, PointState, PointTangent};
use super::{ITERATIONS, NotConverged, SHORTEST_STEP, Solved, TOLERANCE};
use crate::contact::{Contact, ContactBoundary, ContactPoint, GraphKind, PointOnBoundary, Status};
use crate::linalg::condensed::{Condensed, Entry};
use crate::linalg::lu::is_positive_definite;
use crate::linalg::sparse::max_abs;
use crate::tensor::{Point, dot, length};

/// Full steps taken without regard to the residual, the first step included.
const LEAPS: usize = 8;
/// Iterations after which proximal steps have failed too.
const APPROACH: usize = 20 * ITERATIONS;
/// State of the contact points that a step starts from and ends with.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Multipliers {
    /// Pressure p at each contact point in Pa, where the normal law is no function; else zero.
    pub p: Vec<f64>,
    /// q = −σ_τ at each contact point, Pa.
    pub q: Vec<Point>,
    /// Whether the point sticks: a bound that drops when slip starts is the static one there.
    pub sticks: Vec<bool>,
}

impl Multipliers {
    /// Without forces; `sticks` says which points are at rest against the foundation.
    #[must_use]
    pub fn free(sticks: Vec<bool>) -> Multipliers {
        Multipliers { p: vec![0.0; sticks.len()], q: vec![[0.0; 3]; sticks.len()], sticks }
    }

    /// The multipliers a part α of the way to others, on the branches of those.
    #[must_use]
    pub fn towards(&self, other: &Multipliers, alpha: f64) -> Multipliers {
        let part = |a: f64, b: f64| a + alpha * (b - a);
        Multipliers {
            p: self.p.iter().zip(&other.p).map(|(a, b)| part(*a, *b)).collect(),
            q: self.q.iter().zip(&other.q).map(|(a, b)| std::array::from_fn(|c| part(a[c], b[c]))).collect(),
            sticks: other.sticks.clone(),
        }
    }

    pub(super) fn at(&self, i: usize) -> Multiplier {
        Multiplier { p: self.p[i], q: self.q[i], sticks: self.sticks[i] }
    }
}

/// What is known of a mechanical step on Γ_C before it is solved.
pub struct MechanicalStep<'a> {
    /// The laws of each side.
    pub contacts: &'a [Contact],
    /// The contact points.
    pub boundary: &'a ContactBoundary,
    /// Unknown of (contact node, component), none where prescribed.
    pub unknown: &'a [Option<u32>],
    /// Dimension d.
    pub dim: usize,
    /// Time step k in s.
    pub k: f64,
    /// u_{n−1} at the contact nodes, node-major.
    pub u_old: &'a [f64],
    /// Velocities at the contact nodes, those that are prescribed filled in.
    pub w_prescribed: &'a [f64],
    /// The foundation at each contact point.
    pub frames: &'a [Frame],
    /// Temperature of the body at the contact points that the step is made with, K.
    pub temperature: &'a [f64],
}

impl MechanicalStep<'_> {
    /// Velocity at a contact point.
    fn velocity(&self, point: &PointOnBoundary, w: &[f64]) -> Point {
        let mut v = [0.0; 3];
        for &(node, value) in &point.nodes {
            for c in 0..self.dim {
                let i = node * self.dim + c;
                v[c] += value * self.unknown[i].map_or(self.w_prescribed[i], |u| w[u as usize]);
            }
        }
        v
    }

    /// Whether the pressure is a function of the penetration at a point.
    fn is_function(&self, point: &PointOnBoundary) -> bool {
        self.contacts[point.side].normal.graph() == GraphKind::Function
    }

    /// Whether the bound of a point drops when slip starts: then the iteration stays on the branch that it starts on, because what its
    /// iterates overshoot would let a point go that can stick.
    fn drops(&self, i: usize) -> bool {
        self.contacts[self.boundary.points[i].side].friction.drops_from_rest()
    }

    /// The branches of an iterate, but where bounds drop as they were.
    fn branches(&self, locals: &[Local], before: &[bool]) -> Vec<bool> {
        locals.iter().zip(before).enumerate().map(|(i, (local, before))| if self.drops(i) { *before } else { local.sticks }).collect()
    }

    pub(super) fn local(&self, i: usize, w: &[f64], multiplier: &Multiplier, rho: f64) -> Local {
        let (point, frame) = (&self.boundary.points[i], &self.frames[i]);
        let v = self.velocity(point, w);
        let nu = &frame.normal;
        let w_nu = dot(&v, nu);
        let slip: Point = std::array::from_fn(|c| v[c] - w_nu * nu[c] - frame.velocity[c]);
        let mut u_nu = 0.0;
        for &(node, value) in &point.nodes {
            for c in 0..self.dim {
                u_nu += value * self.u_old[node * self.dim + c] * nu[c];
            }
        }
        let penetration = u_nu + self.k * w_nu - frame.gap;
        let rate = w_nu - frame.gap_rate;
        // That of r₊, so that the pressure does not jump where the gap closes within the step.
        let rate = if penetration <= 0.0 { 0.0 } else { rate.min(penetration / self.k) };
        let at = Kinematics { normal: *nu, penetration, rate, slip, temperature: self.temperature[i] };
        Local::new(&self.contacts[point.side], point, self.k, &at, multiplier, rho)
    }

    /// The states of the contact points, the multipliers as they are.
    #[must_use]
    pub fn states(&self, w: &[f64], multipliers: &Multipliers) -> Vec<PointState> {
        (0..self.boundary.points.len())
            .map(|i| {
                let mut state = self.local(i, w, &multipliers.at(i), 0.0).state;
                if state.bound > 0.0 {
                    // At the bound to round-off, and moving: slip.
                    let point = &self.boundary.points[i];
                    let q = self.contacts[point.side].friction.cone(&point.x, &state.normal).map_or(state.q, |cone| cone.inverse(&state.q));
                    let at_bound = length(&q) >= state.bound * (1.0 - 1e-9);
                    state.status = if at_bound { Status::Slip } else { Status::Stick };
                }
                state
            })
            .collect()
    }

    /// Adds Σ ω Nᵀ (p ν + q) to a vector over the contact unknowns.
    fn add_forces(&self, locals: &[Local], out: &mut [f64]) {
        for (point, local) in self.boundary.points.iter().zip(locals) {
            for &(node, value) in &point.nodes {
                for c in 0..self.dim {
                    if let Some(u) = self.unknown[node * self.dim + c] {
                        out[u as usize] += point.weight * value * (local.state.pressure * local.state.normal[c] + local.state.q[c]);
                    }
                }
            }
        }
    }

    /// ρ of each point: the diagonal of S over the weight of its nodes. Absolute values of the shape functions weigh and average: those of quadratic
    /// facets take either sign, and at the vertices of a triangle they integrate to zero, so that ∫ N would leave the sign of ρ to round-off.
    fn rho(&self, condensed: &Condensed) -> Vec<f64> {
        let mut weight = vec![0.0; self.boundary.nodes.len()];
        for point in &self.boundary.points {
            for &(node, value) in &point.nodes {
                weight[node] += point.weight * value.abs();
            }
        }
        let of_node = |node: usize| {
            let diagonal: Vec<f64> =
                (0..self.dim).filter_map(|c| self.unknown[node * self.dim + c]).map(|u| condensed.operator()[(u as usize, u as usize)]).collect();
            diagonal.iter().sum::<f64>() / (diagonal.len().max(1) as f64 * weight[node])
        };
        let of_point = |point: &PointOnBoundary| {
            let [sum, share] = point.nodes.iter().fold([0.0; 2], |[sum, share], &(node, value)| [sum + value.abs() * of_node(node), share + value.abs()]);
            sum / share
        };
        self.boundary.points.iter().map(of_point).collect()
    }

    /// Solves the step: `guess` and `multipliers` are where the iteration starts, `r` the reduced
    /// right-hand side for the increment of the velocity over the guess.
    ///
    /// # Errors
    /// When the iteration does not end; the multipliers are then as they were.
    pub fn solve(&self, condensed: &mut Condensed, r: &[f64], guess: &[f64], multipliers: &mut Multipliers) -> Result<Solved, NotConverged> {
        let rho = self.rho(condensed);
        let mut start = Iterate { w: guess.to_vec(), multipliers: multipliers.clone() };
        let mut iterations = 0;
        let mut let_go = vec![false; rho.len()];
        loop {
            let held = start.multipliers.sticks.clone();
            let right = Right { r, guess, rho: rho.clone(), proximal: None };
            let (mut end, done) = self.on_branches(condensed, right, start)?;
            iterations += done;
            let sticks: Vec<bool> = rho.iter().enumerate().map(|(i, &rho)| self.local(i, &end.w, &end.multipliers.at(i), rho).sticks).collect();
            // A point is held at most once in a step, at first or when its slip has turned round through rest, and let go at most once, when it slips
            // under its static bound.
            let mut branches = sticks.clone();
            let mut changed = false;
            for i in (0..sticks.len()).filter(|&i| self.drops(i)) {
                branches[i] = held[i];
                if held[i] && !sticks[i] {
                    (branches[i], let_go[i], changed) = (false, true, true);
                } else if !held[i] && !sticks[i] && !let_go[i] && dot(&end.multipliers.q[i], &multipliers.q[i]) < 0.0 {
                    (branches[i], changed) = (true, true);
                }
            }
            if !changed {
                end.multipliers.sticks = sticks;
                *multipliers = end.multipliers;
                return Ok(Solved { x: end.w, iterations });
            }
            end.multipliers.sticks = branches;
            start = end;
        }
    }

    /// Solves the step with the bounds that drop when slip starts on the branches of `start`.
    fn on_branches(&self, condensed: &mut Condensed, right: Right, start: Iterate) -> Result<(Iterate, usize), NotConverged> {
        if self.is_convex() {
            let (w, before) = self.descend(condensed, &right);
            let start = Iterate { w, ..start };
            return match self.iterate(condensed, &right, start.clone()) {
                Ok((end, after)) => Ok((end, before + after)),
                Err(failed) => self.approach(condensed, right, start, before + failed.iterations),
            };
        }
        let held = start.multipliers.sticks.clone();
        match self.iterate(condensed, &right, start) {
            Ok(done) => Ok(done),
            Err(failed) => self.begin_again(condensed, right, failed, &held),
        }
    }

    /// Starts again where the body rests without friction, and if that fails too, approaches the solution.
    fn begin_again(&self, condensed: &mut Condensed, right: Right, mut failed: NotConverged, sticks: &[bool]) -> Result<(Iterate, usize), NotConverged> {
        let mut start = Iterate { w: right.guess.to_vec(), multipliers: Multipliers::free(sticks.to_vec()) };
        if self.rises() {
            let (w, before) = self.descend(condensed, &right);
            failed.iterations += before;
            start.w = w;
            match self.iterate(condensed, &right, start.clone()) {
                Ok((end, done)) => return Ok((end, failed.iterations + done)),
                Err(why) => failed.iterations += why.iterations,
            }
        }
        self.approach(condensed, right, start, failed.iterations)
    }

    /// Approaches the solution by proximal steps: with β diag(S) (w − anchor) added, the step has one
    /// solution when β is large; the anchor follows it, and β falls as the steps succeed.
    fn approach(&self, condensed: &mut Condensed, mut right: Right, mut reached: Iterate, mut iterations: usize) -> Result<(Iterate, usize), NotConverged> {
        let mut beta = 1.0;
        while iterations < APPROACH {
            right.proximal = Some((beta, reached.w.clone()));
            match self.iterate(condensed, &right, reached.clone()) {
                Ok((next, done)) => {
                    iterations += done;
                    reached = next;
                    beta *= 0.25;
                    right.proximal = None;
                    match self.iterate(condensed, &right, reached.clone()) {
                        Ok((end, done)) => return Ok((end, iterations + done)),
                        Err(why) => iterations += why.iterations,
                    }
                }
                Err(why) => {
                    iterations += why.iterations;
                    beta *= 16.0;
                }
            }
        }
        right.proximal = None;
        Err(self.evaluate(condensed, &right, reached).failure(iterations))
    }

    /// Newton's method from an iterate: after a first full step, each is shortened until the
    /// residual decreases. At a kink where no shorter step helps, a full one leaves it, some times.
    fn iterate(&self, condensed: &mut Condensed, right: &Right, start: Iterate) -> Result<(Iterate, usize), NotConverged> {
        let mut now = self.evaluate(condensed, right, start);
        let mut leaps = 1;
        let mut leap = true;
        for iteration in 0..ITERATIONS {
            if now.converged() {
                return Ok((self.settled(now), iteration));
            }
            if iteration == 0 {
                now.hold();
            }
            let (mut entries, mut step) = self.linearise(right, &now);
            if let Some((beta, _)) = right.proximal {
                entries.extend((0..step.len()).map(|i| (i as u32, i as u32, beta * condensed.operator()[(i, i)])));
            }
            if !condensed.solve(&entries, &mut step) {
                // Nothing holds the body at this iterate, as where all points are open; a proximal step does.
                return Err(now.failure(iteration + 1));
            }
            let after = self.multipliers_after(right, &now, &step);
            let mut alpha = 1.0;
            loop {
                let w = now.at.w.iter().zip(&step).map(|(w, step)| w + alpha * step).collect();
                let multipliers = now.at.multipliers.towards(&after, alpha);
                let trial = self.evaluate(condensed, right, Iterate { w, multipliers });
                if trial.converged() || trial.merit < now.merit * (1.0 - 1e-4 * alpha) || (leap && trial.merit.is_finite()) {
                    now = trial;
                    leap = false;
                    break;
                }
                alpha *= 0.5;
                if alpha < SHORTEST_STEP {
                    if right.is_round_off(condensed, &now.at.w, now.residual) {
                        return Ok((self.settled(now), iteration));
                    }
                    if leaps == LEAPS {
                        return Err(now.failure(iteration + 1));
                    }
                    leaps += 1;
                    leap = true;
                    alpha = 1.0;
                }
            }
        }
        Err(now.failure(ITERATIONS))
    }

    fn evaluate(&self, condensed: &Condensed, right: &Right, at: Iterate) -> Evaluation {
        let Iterate { w, multipliers } = &at;
        let locals: Vec<Local> = (0..right.rho.len()).map(|i| self.local(i, w, &multipliers.at(i), right.rho[i])).collect();
        let increment: Vec<f64> = w.iter().zip(right.guess).map(|(w, guess)| w - guess).collect();
        let inner = condensed.apply(&increment);
        let mut forces = vec![0.0; w.len()];
        self.add_forces(&locals, &mut forces);
        let scale = max_abs(&inner).max(max_abs(&forces)).max(max_abs(right.r));
        let mut rest: Vec<f64> = (0..w.len()).map(|i| right.r[i] - inner[i]).collect();
        if let Some((beta, anchor)) = &right.proximal {
            for (i, rest) in rest.iter_mut().enumerate() {
                *rest -= beta * condensed.operator()[(i, i)] * (w[i] - anchor[i]);
            }
        }
        let mut errors: Vec<f64> = (0..w.len()).map(|i| forces[i] - rest[i]).collect();
        for (point, local) in self.boundary.points.iter().zip(&locals) {
            errors.extend((0..3).map(|c| point.weight * (local.state.q[c] - local.projected[c])));
        }
        for (point, local) in self.boundary.points.iter().zip(&locals) {
            if !self.is_function(point) {
                errors.push(point.weight * (local.state.pressure - local.pressed));
            }
        }
        let merit = errors.iter().map(|e| e * e).sum();
        let residual = max_abs(&errors);
        let tight = TOLERANCE * scale;
        let tolerance = if residual > tight { tight.max(self.round_off(condensed, right, w, &locals, residual)) } else { tight };
        Evaluation { at, locals, rest, merit, residual, scale, tolerance }
    }

    /// What the round-off of the terms makes of the residual: w − guess and the penetration u_ν + k w_ν − g are differences of larger numbers.
    fn round_off(&self, condensed: &Condensed, right: &Right, w: &[f64], locals: &[Local], residual: f64) -> f64 {
        let sizes: Vec<f64> = w.iter().zip(right.guess).map(|(w, guess)| w.abs() + guess.abs()).collect();
        // A residual beyond the bound is no round-off, whatever the product, which costs as much as S (w − guess).
        let mut floor = if residual > f64::EPSILON * condensed.magnitude_bound(&sizes) { 0.0 } else { f64::EPSILON * condensed.magnitude(&sizes) };
        for (i, (point, local)) in self.boundary.points.iter().zip(locals).enumerate() {
            let frame = &self.frames[i];
            let mut size = frame.gap.abs();
            for &(node, value) in &point.nodes {
                for c in 0..self.dim {
                    size += (value * frame.normal[c]).abs() * self.u_old[node * self.dim + c].abs();
                }
            }
            size += self.k * dot(&self.velocity(point, w), &frame.normal).abs();
            floor = floor.max(f64::EPSILON * point.weight * local.p_slope.abs() / self.k * size);
            // So is the slip of a point that sticks; to one that slips it is a direction.
            if local.sticks {
                floor = floor.max(f64::EPSILON * point.weight * right.rho[i] * length(&frame.velocity));
            }
        }
        floor
    }

    /// The derivatives at a solution: the entries of that of the contact forces in the velocity, and all of them at each point.
    pub fn tangent(&self, condensed: &Condensed, w: &[f64], multipliers: &Multipliers) -> (Vec<Entry>, Vec<PointDerivative>) {
        let rho = self.rho(condensed);
        let points: Vec<PointDerivative> =
            rho.iter().enumerate().map(|(i, &rho)| self.local(i, w, &multipliers.at(i), rho).derivative(rho, self.dim)).collect();
        (self.boundary.points.iter().zip(&points).flat_map(|(point, derivative)| self.entries(point, &derivative.force)).collect(), points)
    }

    /// What the laws make of a state at each point: the pressure on the graph along ν and q + ρ w_τ projected onto the cone, in Pa. At a solution
    /// that is the force p ν + q.
    #[must_use]
    pub fn forces(&self, condensed: &Condensed, w: &[f64], multipliers: &Multipliers) -> Vec<Point> {
        let of = |(i, &rho): (usize, &f64)| {
            let local = self.local(i, w, &multipliers.at(i), rho);
            std::array::from_fn(|c| local.pressed * local.state.normal[c] + local.projected[c])
        };
        self.rho(condensed).iter().enumerate().map(of).collect()
    }

    /// Whether the falls of the laws leave the step one solution between two velocities: S with the least slopes that the laws have between
    /// them is positive definite. Where no law falls that is taken for granted, and so is what friction takes by following the pressure. Of
    /// friction, the fall with the slip speed counts, and not the drop from rest, after which a point that sticks goes on sticking as long as
    /// it can. Proof: `book/src/theory.md`.
    #[must_use]
    pub fn is_unique(&self, condensed: &Condensed, [from, to]: [&[f64]; 2], multipliers: [&Multipliers; 2]) -> bool {
        let slopes: Vec<[f64; 2]> = (0..self.boundary.points.len())
            .map(|i| {
                let point = &self.boundary.points[i];
                let contact = &self.contacts[point.side];
                let (before, after) = (self.local(i, from, &multipliers[1].at(i), 0.0).state, self.local(i, to, &multipliers[1].at(i), 0.0).state);
                let frame = &self.frames[i];
                // Penetration at t_{n−1}: that of `from` is what the step would lead to without a change of velocity.
                let start = before.penetration - self.k * (dot(&self.velocity(point, from), &frame.normal) - frame.gap_rate);
                let normal = self.k * contact.normal.least_slope(&point.x, start.min(after.penetration), start.max(after.penetration));
                // The largest load in between: a fall with the slip speed grows with it.
                let pressure = match contact.normal.graph() {
                    GraphKind::Function => after.pressure.max(contact.normal.pressure(&point.x, start, 0.0, 0.0).value).max(0.0),
                    GraphKind::Multivalued => after.pressure.max(0.0),
                    GraphKind::Bilateral => after.pressure.abs(),
                };
                let seen = ContactPoint { x: point.x, penetration: after.penetration, pressure, temperature: self.temperature[i], ..ContactPoint::default() };
                // The slip of a point that sticks is round-off, or the change of v_F that it follows.
                let [before, after] = [(&before, multipliers[0]), (&after, multipliers[1])].map(|(state, m)| if m.sticks[i] { [0.0; 3] } else { state.slip });
                [normal, contact.friction.least_slope(&seen, slowest(&before, &after), length(&before).max(length(&after)))]
            })
            .collect();
        if slopes.iter().flatten().all(|slope| *slope >= 0.0) {
            return true;
        }
        if slopes.iter().flatten().any(|slope| !slope.is_finite()) {
            return false;
        }
        let mut matrix = condensed.operator().clone();
        for ((point, frame), [normal, tangential]) in self.boundary.points.iter().zip(self.frames).zip(&slopes) {
            let tangent: PointTangent = std::array::from_fn(|c| {
                std::array::from_fn(|e| {
                    let along = frame.normal[c] * frame.normal[e];
                    normal * along + tangential * (f64::from(u8::from(c == e)) - along)
                })
            });
            for (row, col, value) in self.entries(point, &tangent) {
                matrix[(row as usize, col as usize)] += value;
            }
        }
        is_positive_definite(matrix)
    }

    /// The entries of ω Nᵀ · N for one point.
    pub(super) fn entries(&self, point: &PointOnBoundary, tangent: &PointTangent) -> Vec<Entry> {
        let mut entries = Vec::with_capacity(point.nodes.len().pow(2) * self.dim.pow(2));
        for &(na, va) in &point.nodes {
            for c in 0..self.dim {
                let Some(row) = self.unknown[na * self.dim + c] else { continue };
                for &(nb, vb) in &point.nodes {
                    for e in 0..self.dim {
                        if let (Some(col), true) = (self.unknown[nb * self.dim + e], tangent[c][e] != 0.0) {
                            entries.push((row, col, point.weight * va * vb * tangent[c][e]));
                        }
                    }
                }
            }
        }
        entries
    }

    /// The entries of J and the right-hand side of the Newton step, (S + J) δw = b.
    fn linearise(&self, right: &Right, now: &Evaluation) -> (Vec<Entry>, Vec<f64>) {
        let mut entries = Vec::new();
        let mut b = now.rest.clone();
        for (i, point) in self.boundary.points.iter().enumerate() {
            let (force, tangent) = now.locals[i].linear(right.rho[i], self.dim);
            for &(node, value) in &point.nodes {
                for c in 0..self.dim {
                    if let Some(row) = self.unknown[node * self.dim + c] {
                        b[row as usize] -= point.weight * value * force[c];
                    }
                }
            }
            entries.extend(self.entries(point, &tangent));
        }
        (entries, b)
    }

    /// The multipliers of the linearised laws after the step δw.
    fn multipliers_after(&self, right: &Right, now: &Evaluation, step: &[f64]) -> Multipliers {
        let mut after = Multipliers::free(self.branches(&now.locals, &now.at.multipliers.sticks));
        for (i, point) in self.boundary.points.iter().enumerate() {
            let (force, tangent) = now.locals[i].linear(right.rho[i], self.dim);
            let mut moved = [0.0; 3];
            for &(node, value) in &point.nodes {
                for c in 0..self.dim {
                    moved[c] += value * self.unknown[node * self.dim + c].map_or(0.0, |u| step[u as usize]);
                }
            }
            let f: Point = std::array::from_fn(|c| force[c] + dot(&tangent[c], &moved));
            let nu = &self.frames[i].normal;
            let normal = dot(&f, nu);
            after.q[i] = std::array::from_fn(|c| f[c] - normal * nu[c]);
            if !self.is_function(point) {
                after.p[i] = normal;
            }
        }
        after
    }

    /// An iterate that has converged: pressures on the graph itself, and the branches that were found.
    fn settled(&self, end: Evaluation) -> Iterate {
        let Evaluation { mut at, locals, .. } = end;
        at.multipliers.sticks = self.branches(&locals, &at.multipliers.sticks);
        at.multipliers.p = self.boundary.points.iter().zip(&locals).map(|(point, local)| if self.is_function(point) { 0.0 } else { local.pressed }).collect();
        at
    }
}

/// Least length of the vectors between two: where slip turns round it stops in between.
fn slowest(from: &Point, to: &Point) -> f64 {
    let change: Point = std::array::from_fn(|c| to[c] - from[c]);
    let squared = dot(&change, &change);
    let part = if squared > 0.0 { (-dot(from, &change) / squared).clamp(0.0, 1.0) } else { 0.0 };
    length(&std::array::from_fn(|c| from[c] + part * change[c]))
}

/// S (w − guess) + Σ ω Nᵀ (p ν + q) = r: the increment is solved for, so that the round-off of the
/// sweeps is relative to the change within a step and not to the velocity.
pub(super) struct Right<'a> {
    pub r: &'a [f64],
    pub guess: &'a [f64],
    /// ρ of each contact point.
    pub rho: Vec<f64>,
    /// β and the anchor of a proximal step of [`MechanicalStep::approach`].
    proximal: Option<(f64, Vec<f64>)>,
}

impl Right<'_> {
    /// Whether a residual is no more than the round-off of S (w − guess): a sum of n terms has √n/2 last bits of theirs, and never less than one.
    pub fn is_round_off(&self, condensed: &Condensed, w: &[f64], residual: f64) -> bool {
        let sizes: Vec<f64> = w.iter().zip(self.guess).map(|(w, guess)| w.abs() + guess.abs()).collect();
        let bits = f64::EPSILON * (0.5 * (w.len() as f64).sqrt()).max(1.0);
        residual <= bits * condensed.magnitude_bound(&sizes) && residual <= bits * condensed.magnitude(&sizes)
    }
}

/// Contact velocities and multipliers.
#[derive(Clone)]
struct Iterate {
    w: Vec<f64>,
    multipliers: Multipliers,
}

struct Evaluation {
    at: Iterate,
    locals: Vec<Local>,
    /// r − S (w − guess).
    rest: Vec<f64>,
    merit: f64,
    residual: f64,
    scale: f64,
    tolerance: f64,
}

impl Evaluation {
    fn failure(&self, iterations: usize) -> NotConverged {
        let mut pattern = [0; 3];
        for local in &self.locals {
            pattern[local.state.status as usize] += 1;
        }
        NotConverged { iterations, residual: self.residual / self.scale, pattern }
    }

    /// Takes points that stuck as sticking: where the foundation has changed its velocity the iterate slips by the change, which says
    /// nothing of the solution.
    fn hold(&mut self) {
        for (local, sticks) in self.locals.iter_mut().zip(&self.at.multipliers.sticks) {
            if *sticks && local.state.bound > 0.0 {
                local.state.status = Status::Stick;
                local.sticks = true;
            }
        }
    }

    fn converged(&self) -> bool {
        self.residual <= self.tolerance
    }
}
