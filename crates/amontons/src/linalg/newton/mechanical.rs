//! The mechanical step on Γ_C.

use super::{ITERATIONS, NotConverged, SHORTEST_STEP, Solved, TOLERANCE};
use crate::contact::{Bound, Contact, ContactBoundary, ContactPoint, PointOnBoundary, Status};
use crate::linalg::condensed::{Condensed, Entry};
use crate::linalg::sparse::max_abs;
use crate::tensor::{Point, dot, length};

/// Full steps taken without regard to the residual, the first step included.
const LEAPS: usize = 8;
/// Iterations after which proximal steps have failed too.
const APPROACH: usize = 20 * ITERATIONS;
/// Stiffness of a stuck point over ρ. The error of one iteration is of the order of its inverse and
/// vanishes with the iterations, because each starts from the multiplier of the one before.
const STICK: f64 = (1u64 << 27) as f64;

/// State of the contact points that a step starts from and ends with.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Multipliers {
    /// q = −σ_τ at each contact point, Pa.
    pub q: Vec<Point>,
}

/// What is known of a mechanical step on Γ_C before it is solved.
pub struct MechanicalStep<'a> {
    /// The laws.
    pub contact: &'a Contact,
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
    /// g(t_n) at the contact points, m.
    pub gap: &'a [f64],
}

/// State of one contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState {
    /// Penetration r = u_ν − g in m.
    pub penetration: f64,
    /// Pressure p in Pa.
    pub pressure: f64,
    /// Friction bound s in Pa.
    pub bound: f64,
    /// q = −σ_τ in Pa.
    pub q: Point,
    /// Slip velocity w_τ in m/s.
    pub slip: Point,
    /// Open, stick or slip.
    pub status: Status,
}

/// Derivative of the force p ν + q on the foundation in the velocity at a contact point, Pa s/m, rows the force.
pub type PointTangent = [[f64; 3]; 3];

/// A point with the state that its law sees and its linearisation.
struct Local {
    state: PointState,
    /// Slope of the pressure in w_ν: k dp/dr.
    p_slope: f64,
    /// Derivatives of s with respect to w_ν and ‖w_τ‖.
    s_normal: f64,
    s_speed: f64,
    /// z = q + ρ w_τ and its projection onto the disc of radius s.
    z: Point,
    projected: Point,
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

    fn local(&self, i: usize, w: &[f64], q: &Point, rho: f64) -> Local {
        let point = &self.boundary.points[i];
        let v = self.velocity(point, w);
        let nu = &point.normal;
        let w_nu = dot(&v, nu);
        let slip: Point = std::array::from_fn(|c| v[c] - w_nu * nu[c]);
        let mut u_nu = 0.0;
        for &(node, value) in &point.nodes {
            for c in 0..self.dim {
                u_nu += value * self.u_old[node * self.dim + c] * nu[c];
            }
        }
        let penetration = u_nu + self.k * w_nu - self.gap[i];
        let p = self.contact.normal.pressure(&point.x, penetration, 0.0);
        let slip_speed = length(&slip);
        let at = ContactPoint { x: point.x, penetration, pressure: p.value, slip_speed, ..ContactPoint::default() };
        let s = if p.value > 0.0 { self.contact.friction.bound(&at) } else { Bound::default() };
        let z: Point = std::array::from_fn(|c| q[c] + rho * slip[c]);
        let z_length = length(&z);
        let stick = z_length <= s.value;
        let projected = if stick { z } else { z.map(|c| c * (s.value / z_length)) };
        let status = match (p.value > 0.0, stick) {
            (false, _) => Status::Open,
            (true, true) if s.value > 0.0 => Status::Stick,
            _ => Status::Slip,
        };
        Local {
            state: PointState { penetration, pressure: p.value, bound: s.value, q: *q, slip, status },
            p_slope: self.k * p.slope,
            s_normal: self.k * (s.by_penetration + s.by_pressure * p.slope),
            s_speed: s.by_slip_speed,
            z,
            projected,
        }
    }

    /// The states of the contact points, the multipliers as they are.
    #[must_use]
    pub fn states(&self, w: &[f64], multipliers: &Multipliers) -> Vec<PointState> {
        (0..self.boundary.points.len())
            .map(|i| {
                let mut state = self.local(i, w, &multipliers.q[i], 0.0).state;
                if state.status != Status::Open {
                    // At the bound to round-off, and moving: slip.
                    let at_bound = length(&state.q) >= state.bound * (1.0 - 1e-9);
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
                        out[u as usize] += point.weight * value * (local.state.pressure * point.normal[c] + local.state.q[c]);
                    }
                }
            }
        }
    }

    /// ρ of each point: the diagonal of S over the weight of its nodes.
    fn rho(&self, condensed: &Condensed) -> Vec<f64> {
        let mut weight = vec![0.0; self.boundary.nodes.len()];
        for point in &self.boundary.points {
            for &(node, value) in &point.nodes {
                weight[node] += point.weight * value;
            }
        }
        let of_node = |node: usize| {
            let diagonal: Vec<f64> =
                (0..self.dim).filter_map(|c| self.unknown[node * self.dim + c]).map(|u| condensed.operator()[(u as usize, u as usize)]).collect();
            diagonal.iter().sum::<f64>() / (diagonal.len().max(1) as f64 * weight[node])
        };
        self.boundary.points.iter().map(|p| p.nodes.iter().map(|&(node, value)| value * of_node(node)).sum()).collect()
    }

    /// Solves the step: `guess` and `multipliers` are where the iteration starts, `r` the reduced
    /// right-hand side for the increment of the velocity over the guess.
    ///
    /// # Errors
    /// When the iteration does not end; the multipliers are then as they were.
    pub fn solve(&self, condensed: &mut Condensed, r: &[f64], guess: &[f64], multipliers: &mut Multipliers) -> Result<Solved, NotConverged> {
        let right = Right { r, guess, rho: self.rho(condensed), proximal: None };
        let start = Iterate { w: guess.to_vec(), q: multipliers.q.clone() };
        let (end, iterations) = match self.iterate(condensed, &right, start) {
            Ok(done) => done,
            Err(failed) => self.approach(condensed, right, &failed)?,
        };
        multipliers.q = end.q;
        Ok(Solved { x: end.w, iterations })
    }

    /// Approaches the solution by proximal steps: with β diag(S) (w − anchor) added, the step has one
    /// solution when β is large; the anchor follows it, and β falls as the steps succeed.
    fn approach(&self, condensed: &mut Condensed, mut right: Right, failed: &NotConverged) -> Result<(Iterate, usize), NotConverged> {
        let mut iterations = failed.iterations;
        let mut reached = Iterate { w: right.guess.to_vec(), q: vec![[0.0; 3]; self.boundary.points.len()] };
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
                return Ok((now.at, iteration));
            }
            let (mut entries, mut step) = self.linearise(right, &now);
            if let Some((beta, _)) = right.proximal {
                entries.extend((0..step.len()).map(|i| (i as u32, i as u32, beta * condensed.operator()[(i, i)])));
            }
            condensed.solve(&entries, &mut step);
            let q_new = self.multipliers_after(right, &now, &step);
            let mut alpha = 1.0;
            loop {
                let w = now.at.w.iter().zip(&step).map(|(w, step)| w + alpha * step).collect();
                let q = now.at.q.iter().zip(&q_new).map(|(a, b)| std::array::from_fn(|c| a[c] + alpha * (b[c] - a[c]))).collect();
                let trial = self.evaluate(condensed, right, Iterate { w, q });
                if trial.converged() || trial.merit < now.merit * (1.0 - 1e-4 * alpha) || (leap && trial.merit.is_finite()) {
                    now = trial;
                    leap = false;
                    break;
                }
                alpha *= 0.5;
                if alpha < SHORTEST_STEP {
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
        let Iterate { w, q } = &at;
        let locals: Vec<Local> = (0..q.len()).map(|i| self.local(i, w, &q[i], right.rho[i])).collect();
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
        let merit = errors.iter().map(|e| e * e).sum();
        let residual = max_abs(&errors);
        // w − guess and the penetration u_ν + k w_ν − g are differences of larger numbers.
        let sizes: Vec<f64> = w.iter().zip(right.guess).map(|(w, guess)| w.abs() + guess.abs()).collect();
        let mut floor = f64::EPSILON * condensed.magnitude(&sizes);
        for (i, (point, local)) in self.boundary.points.iter().zip(&locals).enumerate() {
            let mut size = self.gap[i].abs();
            for &(node, value) in &point.nodes {
                for c in 0..self.dim {
                    size += (value * point.normal[c]).abs() * self.u_old[node * self.dim + c].abs();
                }
            }
            size += self.k * dot(&self.velocity(point, w), &point.normal).abs();
            floor = floor.max(f64::EPSILON * point.weight * local.p_slope / self.k * size);
        }
        Evaluation { at, locals, rest, merit, residual, scale, tolerance: (TOLERANCE * scale).max(floor) }
    }

    /// The derivative of the contact forces in the velocity at a solution: its entries, and its value at each point.
    pub fn tangent(&self, condensed: &Condensed, w: &[f64], multipliers: &Multipliers) -> (Vec<Entry>, Vec<PointTangent>) {
        let rho = self.rho(condensed);
        let points = self.boundary.points.iter().enumerate();
        let tangents: Vec<PointTangent> = points.map(|(i, point)| self.local(i, w, &multipliers.q[i], rho[i]).linear(point, rho[i], self.dim).1).collect();
        (self.boundary.points.iter().zip(&tangents).flat_map(|(point, tangent)| self.entries(point, tangent)).collect(), tangents)
    }

    /// The entries of ω Nᵀ · N for one point.
    fn entries(&self, point: &PointOnBoundary, tangent: &PointTangent) -> Vec<Entry> {
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
            let (force, tangent) = now.locals[i].linear(point, right.rho[i], self.dim);
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
    fn multipliers_after(&self, right: &Right, now: &Evaluation, step: &[f64]) -> Vec<Point> {
        self.boundary
            .points
            .iter()
            .enumerate()
            .map(|(i, point)| {
                let local = &now.locals[i];
                let (force, tangent) = local.linear(point, right.rho[i], self.dim);
                let mut moved = [0.0; 3];
                for &(node, value) in &point.nodes {
                    for c in 0..self.dim {
                        moved[c] += value * self.unknown[node * self.dim + c].map_or(0.0, |u| step[u as usize]);
                    }
                }
                let f: Point = std::array::from_fn(|c| force[c] + dot(&tangent[c], &moved));
                let normal = dot(&f, &point.normal);
                std::array::from_fn(|c| f[c] - normal * point.normal[c])
            })
            .collect()
    }
}

impl Local {
    /// Force p ν + q on the foundation and its derivative in the velocity, laws linearised.
    fn linear(&self, point: &PointOnBoundary, rho: f64, dim: usize) -> (Point, PointTangent) {
        let nu = &point.normal;
        let state = &self.state;
        let mut force: Point = std::array::from_fn(|c| state.pressure * nu[c]);
        let mut tangent = [[0.0; 3]; 3];
        for c in 0..dim {
            for e in 0..dim {
                tangent[c][e] = self.p_slope * nu[c] * nu[e];
            }
        }
        match state.status {
            Status::Open => {}
            Status::Stick => {
                let stiffness = STICK * rho;
                for c in 0..dim {
                    force[c] += state.q[c] + stiffness * state.slip[c];
                    for e in 0..dim {
                        tangent[c][e] += stiffness * (f64::from(u8::from(c == e)) - nu[c] * nu[e]);
                    }
                }
            }
            Status::Slip if state.bound > 0.0 => {
                let z_length = length(&self.z);
                let n: Point = self.z.map(|c| c / z_length);
                let speed = length(&state.slip);
                // Across n the projection turns: δq = s/‖z‖ (δq + ρ δw) is solved for δq here.
                let turn = (state.bound * rho / (z_length - state.bound)).min(STICK * rho);
                let along = dot(&state.q, &n);
                for c in 0..dim {
                    let across = state.q[c] - along * n[c];
                    let lag = (self.projected[c] - state.q[c]) - (state.bound - along) * n[c];
                    force[c] += state.bound * n[c] + if dim > 2 { across + lag * z_length / (z_length - state.bound) } else { 0.0 };
                    for e in 0..dim {
                        let in_speed = if speed > 0.0 { self.s_speed * state.slip[e] / speed } else { 0.0 };
                        tangent[c][e] += n[c] * (self.s_normal * nu[e] + in_speed);
                        if dim > 2 {
                            tangent[c][e] += turn * (f64::from(u8::from(c == e)) - nu[c] * nu[e] - n[c] * n[e]);
                        }
                    }
                }
            }
            Status::Slip => {}
        }
        (force, tangent)
    }
}

/// S (w − guess) + Σ ω Nᵀ (p ν + q) = r: the increment is solved for, so that the round-off of the
/// sweeps is relative to the change within a step and not to the velocity.
struct Right<'a> {
    r: &'a [f64],
    guess: &'a [f64],
    /// ρ of each contact point.
    rho: Vec<f64>,
    /// β and the anchor of a proximal step of [`MechanicalStep::approach`].
    proximal: Option<(f64, Vec<f64>)>,
}

/// Contact velocities and multipliers.
#[derive(Clone)]
struct Iterate {
    w: Vec<f64>,
    q: Vec<Point>,
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

    fn converged(&self) -> bool {
        self.residual <= self.tolerance
    }
}
