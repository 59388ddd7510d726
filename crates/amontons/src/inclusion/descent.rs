//! Starting point of a step whose iteration did not converge, which is the solution if there is no friction: the
//! minimum of a convex energy.
//!
//! With pressures that do not fall and q = ρ w_τ in place of friction,
//!
//! ```text
//!     F(w) = S (w − ŵ) − r + Σ ω Nᵀ (p ν + ρ w_τ)
//! ```
//!
//! is the gradient of a convex energy. Newton's direction d goes down it, whatever the contact pattern, and along d the
//! rate of the energy, F·d, rises: where it changes its sign is found by bisection. Where nothing holds the body, as
//! when all points are open, a small multiple of the diagonal of S gives a direction, as long as it may be, and the
//! search along it ends where the body touches.

use super::mechanical::Mechanical;
use super::newton::Right;
use super::normal::Response;
use super::point::{Laws, Multiplier};
use super::{Failure, ITERATIONS, STIFF};
use crate::contact::GraphKind;
use crate::linalg::{Condensed, SolveError, Tangent, dot, max_abs};

/// Share of the diagonal of S that holds a body that nothing holds.
const HOLD: f64 = 1.0 / STIFF;
/// Residual relative to the largest term at which the minimum is found well enough to start from: which points are open
/// is then known. Pressures of a very stiff layer, as functions of the penetration, do not have as many digits: there
/// it ends where the residual no longer falls by half.
const FOUND: f64 = 1e-6;
/// Shares of λ in series with the layers, in turn.
const SOFTENED: [f64; 4] = [1.0, 1e-2, 1e-4, STIFFEST];
/// The last of them, with which a graph stays.
const STIFFEST: f64 = 1e-6;
/// Residual at which the minimum with softer layers is found, and from which on a residual that stalls is all that can
/// be reached.
const NEAR: f64 = 1e-2;
/// Iterations in which the residual has not fallen by half after which it stalls.
const STALLED: usize = 3;
/// Shares of the rate of the energy at the start of a search between which it ends: still falling by half, and as good
/// as not rising.
const ENOUGH: [f64; 2] = [-0.5, 1e-3];
/// Residual of the linear systems, where they are solved by an iteration.
const ACCURACY: f64 = 1e-3;
/// Evaluations in a search; the first 60 decades and more of step lengths go in tenths.
const SEARCH: usize = 100;

impl Mechanical<'_> {
    /// True if no pressure decreases with the penetration.
    pub(super) fn rises(&self) -> bool {
        let points = self.step.boundary.points.iter().enumerate();
        points
            .into_iter()
            .all(|(i, p)| self.contact(i).normal.least_slope(&p.x, f64::NEG_INFINITY, f64::INFINITY) >= 0.0)
    }

    /// The minimum of the energy, or what is reached of it, and the Newton iterations. Layers are taken as softer than
    /// they are at first: then few points open and close in each iteration, however stiff the layers are.
    pub(super) fn descend(&self, condensed: &mut dyn Condensed, right: &Right) -> Result<(Vec<f64>, usize), Failure> {
        let mut reached = (right.guess.to_vec(), 0);
        for soft in SOFTENED.map(Some).into_iter().filter(|soft| self.is_softer(*soft)).chain([None]) {
            reached = self.descend_from(condensed, right, reached, soft)?;
        }
        Ok(if reached.0.iter().all(|w| w.is_finite()) { reached } else { (right.guess.to_vec(), reached.1) })
    }

    /// True if a layer in series makes one of the layers much softer.
    fn is_softer(&self, soft: Option<f64>) -> bool {
        (0..self.interface.len()).any(|i| match (soft, self.response[i]) {
            (Some(share), Response::Multiplier { lambda }) => {
                let law = &self.contact(i).normal;
                let stiffness = law.lipschitz().zip(law.lipschitz_in_rate()).map(|(c, d)| c + d / self.step.rule.span);
                stiffness.is_none_or(|c| c * lambda * share > 1.0)
            }
            _ => false,
        })
    }

    /// The same minimisation for layers with λ times the share `soft` in series.
    fn descend_from(
        &self,
        condensed: &mut dyn Condensed,
        right: &Right,
        (mut w, before): (Vec<f64>, usize),
        soft: Option<f64>,
    ) -> Result<(Vec<f64>, usize), Failure> {
        let mut now = self.gradient(condensed, right, &w, soft)?;
        let (mut least, mut stalled) = (f64::INFINITY, 0);
        let enough = if soft.is_some() { NEAR } else { FOUND };
        for iteration in before..before + ITERATIONS {
            let left = max_abs(&now.f);
            stalled = if left < 0.5 * least { 0 } else { stalled + 1 };
            least = left.min(least);
            let is_found = left <= enough * now.scale || (left <= NEAR * now.scale && stalled >= STALLED);
            if is_found || right.is_round_off(condensed, &w, [left, now.scale])? {
                return Ok((w, iteration));
            }
            let Some(step) = self.downhill(condensed, &now)? else { return Ok((w, iteration)) };
            let start = dot(&now.f, &step);
            match self.search(condensed, right, [&w, &step], start, soft)? {
                Searched::Found(next, there) => (w, now) = (next, *there),
                Searched::Lost => return Ok((w, iteration)),
                Searched::Escapes => return Err(Failure::Driven(self.moved(&step))),
            }
        }
        Ok((w, before + ITERATIONS))
    }

    /// Newton's direction, or `None` if it does not lead down. A direction that does not is the round-off of the matrix
    /// of an unsupported body in which no pivot was exactly zero.
    fn downhill(&self, condensed: &mut dyn Condensed, now: &Gradient) -> Result<Option<Vec<f64>>, SolveError> {
        let mut curvature = self.curvature(now);
        let against = || now.f.iter().map(|f| -f).collect::<Vec<f64>>();
        let leads_down = |step: &[f64]| dot(&now.f, step) < 0.0;
        let mut step = against();
        match condensed.solve(&curvature, &mut step, ACCURACY) {
            Ok(()) if leads_down(&step) => return Ok(Some(step)),
            Ok(()) | Err(SolveError::Singular { .. } | SolveError::NotConverged { .. }) => {}
            Err(error) => return Err(error),
        }
        curvature.add_diagonal(condensed.scale().iter().map(|scale| HOLD * scale));
        step = against();
        match condensed.solve(&curvature, &mut step, ACCURACY) {
            // An inexact solution is tolerated: the direction is checked for descent below.
            Ok(()) | Err(SolveError::Singular { .. } | SolveError::NotConverged { .. }) => {}
            Err(error) => return Err(error),
        }
        Ok(leads_down(&step).then_some(step))
    }

    /// The point on a direction where the energy has fallen far enough. Where it still falls when the parts of the body
    /// are far beyond each other, it falls for ever.
    fn search(
        &self,
        condensed: &dyn Condensed,
        right: &Right,
        [w, step]: [&[f64]; 2],
        start: f64,
        soft: Option<f64>,
    ) -> Result<Searched, SolveError> {
        let (mut low, mut high, mut alpha) = (0.0, f64::INFINITY, 1.0);
        let far = self.far() / max_abs(step);
        for _ in 0..SEARCH {
            let there: Vec<f64> = w.iter().zip(step).map(|(w, step)| w + alpha * step).collect();
            let gradient = self.gradient(condensed, right, &there, soft)?;
            let share = dot(&gradient.f, step) / start.abs();
            if (ENOUGH[0]..=ENOUGH[1]).contains(&share) {
                return Ok(Searched::Found(there, Box::new(gradient)));
            }
            if share < 0.0 {
                low = alpha;
                if low > far {
                    return Ok(Searched::Escapes);
                }
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
        Ok(Searched::Lost)
    }

    fn gradient(
        &self,
        condensed: &dyn Condensed,
        right: &Right,
        w: &[f64],
        soft: Option<f64>,
    ) -> Result<Gradient, SolveError> {
        let free = Multiplier::default();
        let laws = self.at_points(|i| self.laws_with(i, w, &free, self.in_energy(i, soft)));
        let increment: Vec<f64> = w.iter().zip(right.guess).map(|(w, guess)| w - guess).collect();
        let mut f = right.product(condensed, increment)?;
        right.springs.iter().for_each(|spring| spring.add(spring.motion(w), &mut f));
        let mut scale = max_abs(&f).max(max_abs(right.r));
        f.iter_mut().zip(right.r).for_each(|(f, r)| *f -= r);
        let mut forces = vec![0.0; w.len()];
        for (i, laws) in laws.iter().enumerate() {
            let [q1, q2] = laws.friction.slip.map(|slip| self.drag(i) * slip);
            self.interface.scatter(i, &[laws.normal.pressed, q1, q2], &mut forces);
        }
        scale = scale.max(max_abs(&forces));
        f.iter_mut().zip(&forces).for_each(|(f, force)| *f += force);
        Ok(Gradient { f, scale, laws })
    }

    /// Form of the pressure in the energy: the function itself, or a function with a layer in series. A graph always
    /// has a layer, which makes it smooth.
    fn in_energy(&self, i: usize, soft: Option<f64>) -> Response {
        match (soft, self.response[i]) {
            (None, Response::Multiplier { .. }) if self.contact(i).normal.graph() == GraphKind::Function => {
                Response::Function
            }
            (soft, Response::Multiplier { lambda }) => {
                Response::Multiplier { lambda: lambda * soft.unwrap_or(STIFFEST) }
            }
            (_, response) => response,
        }
    }

    /// The multipliers that go with the minimum of the energy.
    pub(super) fn at_minimum(&self, w: &[f64], sticks: &[bool]) -> Vec<Multiplier> {
        let of = |i: usize| {
            let free = Multiplier { sticks: sticks[i], ..Multiplier::default() };
            Multiplier { p: self.laws_with(i, w, &free, self.in_energy(i, None)).normal.pressed, ..free }
        };
        self.at_points(of)
    }

    /// ρ where there is friction, else zero.
    fn drag(&self, i: usize) -> f64 {
        if self.contact(i).friction.is_frictionless() { 0.0 } else { self.rho[i] }
    }

    fn curvature(&self, now: &Gradient) -> Tangent {
        let mut curvature = Tangent::new();
        for (i, laws) in now.laws.iter().enumerate() {
            let mut tangent = [[0.0; 3]; 3];
            tangent[0][0] = laws.normal.slope;
            for a in 1..self.step.dim {
                tangent[a][a] = self.drag(i);
            }
            self.interface.add_tangent(i, &tangent, &mut curvature);
        }
        let resists = |i: usize| {
            let firm = |is: bool| f64::from(u8::from(is));
            let [normal, drag] = [firm(now.laws[i].normal.slope > 0.0), firm(self.drag(i) > 0.0)];
            [[normal, 0.0, 0.0], [0.0, drag, 0.0], [0.0, 0.0, drag]]
        };
        self.hold(&mut curvature, resists);
        curvature
    }
}

/// Result of a search.
enum Searched {
    Found(Vec<f64>, Box<Gradient>),
    Lost,
    /// The energy falls for ever: the body leaves what could hold it.
    Escapes,
}

/// F at a velocity, its largest term, and the contact points.
struct Gradient {
    f: Vec<f64>,
    scale: f64,
    laws: Vec<Laws>,
}
