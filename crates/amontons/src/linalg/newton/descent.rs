//! Where a step starts whose iteration did not end, and the solution itself where there is no friction: the minimum of a convex energy.
//!
//! With pressures that do not fall and q = ρ w_τ in place of friction,
//!
//! ```text
//!     F(w) = S (w − guess) − r + Σ ω Nᵀ (p ν + ρ w_τ)
//! ```
//!
//! is the gradient of a convex energy. Newton's direction d goes down it, whatever the contact pattern, and along d the rate of the energy, F·d, rises: where it
//! changes its sign is found by bisection. Where nothing holds the body, as when all points are open, a small multiple of the diagonal of S
//! gives a direction, as long as it may be, and the search along it ends where the body touches.

use super::mechanical::{MechanicalStep, Multipliers, Right};
use super::point::Local;
use super::{ITERATIONS, TOLERANCE};
use crate::contact::GraphKind;
use crate::linalg::condensed::{Condensed, Entry};
use crate::linalg::sparse::max_abs;
use crate::tensor::Point;

/// Share of the diagonal of S that holds a body that nothing holds.
const HOLD: f64 = 1.0 / (1 << 27) as f64;
/// Shares of the rate of the energy at the start of a search between which it ends: still falling by half, and as good as not rising.
const ENOUGH: [f64; 2] = [-0.5, 1e-3];
/// Evaluations in a search; the first 60 decades and more of step lengths go in tenths.
const SEARCH: usize = 100;

impl MechanicalStep<'_> {
    /// Whether no pressure falls with the penetration.
    pub(super) fn rises(&self) -> bool {
        self.boundary.points.iter().all(|p| self.contacts[p.side].normal.least_slope(&p.x, f64::NEG_INFINITY, f64::INFINITY) >= 0.0)
    }

    /// Whether the minimum of the energy is the solution: pressures are functions that do not fall, without friction or wear.
    pub(super) fn is_convex(&self) -> bool {
        let is_plain = |c: &crate::contact::Contact| c.normal.graph() == GraphKind::Function && c.friction.is_frictionless() && c.wear.is_none();
        self.contacts.iter().all(is_plain) && self.rises()
    }

    /// The minimum of the energy, or what is reached of it, and the Newton iterations.
    pub(super) fn descend(&self, condensed: &mut Condensed, right: &Right) -> (Vec<f64>, usize) {
        let mut w = right.guess.to_vec();
        let mut now = self.gradient(condensed, right, &w);
        for iteration in 0..ITERATIONS {
            let left = max_abs(&now.f);
            if left <= TOLERANCE * now.scale || right.is_round_off(condensed, &w, left) {
                return (w, iteration);
            }
            let Some(step) = self.downhill(condensed, right, &now) else { return (w, iteration) };
            let start = product(&now.f, &step);
            let Some((next, there)) = self.search(condensed, right, [&w, &step], start) else { return (w, iteration) };
            (w, now) = (next, there);
        }
        (w, ITERATIONS)
    }

    /// Newton's direction; none where there is none that leads down.
    fn downhill(&self, condensed: &mut Condensed, right: &Right, now: &Gradient) -> Option<Vec<f64>> {
        let mut entries = self.curvature(right, now);
        let mut step: Vec<f64> = now.f.iter().map(|f| -f).collect();
        if !condensed.solve(&entries, &mut step) {
            entries.extend((0..step.len()).map(|i| (i as u32, i as u32, HOLD * condensed.operator()[(i, i)])));
            step = now.f.iter().map(|f| -f).collect();
            condensed.solve(&entries, &mut step);
        }
        (product(&now.f, &step) < 0.0).then_some(step)
    }

    /// The point on a direction where the energy has fallen far enough.
    fn search(&self, condensed: &Condensed, right: &Right, [w, step]: [&[f64]; 2], start: f64) -> Option<(Vec<f64>, Gradient)> {
        let (mut low, mut high, mut alpha) = (0.0, f64::INFINITY, 1.0);
        for _ in 0..SEARCH {
            let there: Vec<f64> = w.iter().zip(step).map(|(w, step)| w + alpha * step).collect();
            let gradient = self.gradient(condensed, right, &there);
            let share = product(&gradient.f, step) / start.abs();
            if (ENOUGH[0]..=ENOUGH[1]).contains(&share) {
                return Some((there, gradient));
            }
            if share < 0.0 {
                low = alpha;
            } else {
                high = alpha;
            }
            alpha = match (low > 0.0, high.is_finite()) {
                (_, false) => 10.0 * low,
                (false, true) => 0.1 * high,
                (true, true) if high > 4.0 * low => (low * high).sqrt(),
                (true, true) => 0.5 * (low + high),
            };
        }
        None
    }

    fn gradient(&self, condensed: &Condensed, right: &Right, w: &[f64]) -> Gradient {
        let free = Multipliers::free(vec![false; right.rho.len()]);
        let locals: Vec<Local> = (0..right.rho.len()).map(|i| self.local(i, w, &free.at(i), right.rho[i])).collect();
        let increment: Vec<f64> = w.iter().zip(right.guess).map(|(w, guess)| w - guess).collect();
        let mut f = condensed.apply(&increment);
        let mut scale = max_abs(&f).max(max_abs(right.r));
        f.iter_mut().zip(right.r).for_each(|(f, r)| *f -= r);
        let mut forces = vec![0.0; w.len()];
        for (i, (point, local)) in self.boundary.points.iter().zip(&locals).enumerate() {
            let drag = self.drag(right, i);
            let force: Point = std::array::from_fn(|c| local.pressed * local.state.normal[c] + drag * local.state.slip[c]);
            for &(node, value) in &point.nodes {
                for (c, force) in force.iter().enumerate().take(self.dim) {
                    if let Some(u) = self.unknown[node * self.dim + c] {
                        forces[u as usize] += point.weight * value * force;
                    }
                }
            }
        }
        scale = scale.max(max_abs(&forces));
        f.iter_mut().zip(&forces).for_each(|(f, force)| *f += force);
        Gradient { f, scale, locals }
    }

    /// ρ where there is friction, else zero.
    fn drag(&self, right: &Right, i: usize) -> f64 {
        if self.contacts[self.boundary.points[i].side].friction.is_frictionless() { 0.0 } else { right.rho[i] }
    }

    fn curvature(&self, right: &Right, now: &Gradient) -> Vec<Entry> {
        let of = |i: usize| {
            let (local, drag) = (&now.locals[i], self.drag(right, i));
            let nu = &local.state.normal;
            let unit = |c: usize, e: usize| f64::from(u8::from(c == e));
            std::array::from_fn(|c| std::array::from_fn(|e| (local.p_slope - drag) * nu[c] * nu[e] + drag * unit(c, e)))
        };
        self.boundary.points.iter().enumerate().flat_map(|(i, point)| self.entries(point, &of(i))).collect()
    }
}

/// F at a velocity, its largest term, and the contact points.
struct Gradient {
    f: Vec<f64>,
    scale: f64,
    locals: Vec<Local>,
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
