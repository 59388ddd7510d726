//! The heat step on Γ_C.

use super::point::PointState;
use super::{ITERATIONS, NotConverged, Solved, TOLERANCE};
use crate::contact::{Contact, ContactBoundary, ContactPoint, Flux, PointOnBoundary};
use crate::linalg::condensed::{Condensed, Entry};
use crate::linalg::sparse::max_abs;
use crate::tensor::{dot, length};

/// What is known of a heat step on Γ_C before it is solved.
pub struct HeatStep<'a> {
    /// The laws of each side.
    pub contacts: &'a [Contact],
    /// The contact points.
    pub boundary: &'a ContactBoundary,
    /// Unknown of each contact node, none where prescribed.
    pub unknown: &'a [Option<u32>],
    /// Temperatures at the contact nodes, those that are prescribed filled in, K.
    pub theta_prescribed: &'a [f64],
    /// θ_F(t_n) at the contact points where it is prescribed, K.
    pub foundation: &'a [f64],
    /// What each side's foundation with a heat capacity starts from; none where θ_F is prescribed.
    pub lumped: &'a [Option<Lumped>],
    /// States of the contact points at u_n.
    pub states: &'a [PointState],
}

/// A foundation with a heat capacity in a step: C/k (θ_F − θ_F,n−1) + H (θ_F − θ_∞) is what it receives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lumped {
    /// C/k in W/K.
    pub storage: f64,
    /// θ_F at t_{n−1}, K.
    pub before: f64,
    /// H in W/K.
    pub exchange: f64,
    /// θ_∞(t_n) in K.
    pub surroundings: f64,
}

/// The contact points at given temperatures of the body.
#[derive(Clone, Debug, Default)]
pub struct Exchange {
    /// Temperature of the body at each point, K.
    pub temperature: Vec<f64>,
    /// Heat flux q·ν at each point.
    pub flux: Vec<Flux>,
    /// θ_F of each foundation with a heat capacity; none where it is prescribed.
    pub foundation: Vec<Option<f64>>,
}

/// Most iterations for θ_F; every third halves the interval.
const FOUNDATION: usize = 200;

impl HeatStep<'_> {
    /// Temperature of the body at a contact point.
    fn temperature(&self, point: &PointOnBoundary, theta: &[f64]) -> f64 {
        point.nodes.iter().map(|&(node, value)| value * self.unknown[node].map_or(self.theta_prescribed[node], |u| theta[u as usize])).sum()
    }

    /// What the laws see at a point.
    fn at(&self, i: usize, temperature: f64, foundation: f64) -> ContactPoint {
        let state = &self.states[i];
        ContactPoint {
            x: self.boundary.points[i].x,
            penetration: state.penetration,
            pressure: state.pressure,
            slip_speed: length(&state.slip),
            friction_power: dot(&state.q, &state.slip),
            temperature,
            foundation_temperature: foundation,
        }
    }

    /// The temperatures of the body, the heat fluxes and the foundations.
    #[must_use]
    pub fn exchange(&self, theta: &[f64]) -> Exchange {
        let points = &self.boundary.points;
        let temperature: Vec<f64> = points.iter().map(|point| self.temperature(point, theta)).collect();
        let foundation: Vec<Option<f64>> =
            self.lumped.iter().enumerate().map(|(side, lumped)| lumped.map(|lumped| self.foundation_temperature(side, &lumped, &temperature))).collect();
        let flux = points.iter().enumerate().map(|(i, point)| {
            let theta_f = foundation.get(point.side).copied().flatten().unwrap_or(self.foundation[i]);
            self.contacts[point.side].heat.flux(&self.at(i, temperature[i], theta_f))
        });
        Exchange { flux: flux.collect(), temperature, foundation }
    }

    /// θ_F at which a foundation stores and gives off what it receives: the heat that leaves the body and what friction makes beside it.
    /// The balance increases with θ_F, by C/k + H at the least, so Newton's method is kept between values of either sign.
    fn foundation_temperature(&self, side: usize, lumped: &Lumped, temperature: &[f64]) -> f64 {
        let balance = |theta_f: f64| -> [f64; 2] {
            let (mut rest, mut slope) =
                (lumped.storage * (theta_f - lumped.before) + lumped.exchange * (theta_f - lumped.surroundings), lumped.storage + lumped.exchange);
            for (i, point) in self.boundary.points.iter().enumerate().filter(|(_, point)| point.side == side) {
                let at = self.at(i, temperature[i], theta_f);
                let flux = self.contacts[side].heat.flux(&at);
                rest -= point.weight * (flux.value + at.friction_power);
                slope -= point.weight * flux.by_foundation;
            }
            [rest, slope]
        };
        let [rest, slope] = balance(lumped.before);
        if rest == 0.0 {
            return lumped.before;
        }
        // The slope is C/k + H or more, so the root is no further away than this.
        let reach = -rest / (lumped.storage + lumped.exchange);
        let (mut low, mut high) = if reach > 0.0 { (lumped.before, lumped.before + reach) } else { (lumped.before + reach, lumped.before) };
        let mut theta_f = lumped.before - rest / slope;
        for iteration in 0..FOUNDATION {
            let [rest, slope] = balance(theta_f);
            let newton = theta_f - rest / slope;
            if rest == 0.0 || (newton - theta_f).abs() <= f64::EPSILON * theta_f.abs() || !rest.is_finite() {
                return if rest.is_finite() { theta_f } else { f64::NAN };
            }
            if rest > 0.0 {
                high = theta_f;
            } else {
                low = theta_f;
            }
            let next = if newton > low && newton < high && iteration % 3 < 2 { newton } else { 0.5 * (low + high) };
            if next.to_bits() == theta_f.to_bits() {
                break;
            }
            theta_f = next;
        }
        theta_f
    }

    /// Solves the step: `guess` is where the iteration starts, `r` the reduced right-hand side for
    /// the increment of the temperature over the guess.
    ///
    /// # Errors
    /// When the iteration does not end.
    pub fn solve(&self, condensed: &mut Condensed, r: &[f64], guess: &[f64]) -> Result<Solved, NotConverged> {
        let mut now = self.evaluate(condensed, r, guess, guess.to_vec());
        for iteration in 0..ITERATIONS {
            if now.residual <= now.tolerance {
                return Ok(Solved { x: now.theta, iterations: iteration });
            }
            let entries = self.tangent(&now.exchange);
            let mut step: Vec<f64> = now.errors.iter().map(|e| -e).collect();
            if !condensed.solve(&entries, &mut step) {
                return Err(NotConverged { iterations: iteration + 1, residual: now.residual / now.scale, pattern: [0; 3] });
            }
            let mut alpha = 1.0;
            loop {
                let trial = self.evaluate(condensed, r, guess, now.theta.iter().zip(&step).map(|(t, s)| t + alpha * s).collect());
                if trial.residual <= trial.tolerance || trial.merit < now.merit * (1.0 - 1e-4 * alpha) {
                    now = trial;
                    break;
                }
                alpha *= 0.5;
                if alpha < 1e-6 {
                    return Err(NotConverged { iterations: iteration + 1, residual: now.residual / now.scale, pattern: [0; 3] });
                }
            }
        }
        Err(NotConverged { iterations: ITERATIONS, residual: now.residual / now.scale, pattern: [0; 3] })
    }

    /// The derivative of Σ ω Nᵀ q·ν in θ. A foundation with a heat capacity follows all of its contact points: with c = Σ ω Nᵀ ∂(q·ν)/∂θ_F and
    /// r = Σ ω N ∂(q·ν)/∂θ, it adds c rᵀ over the slope of its balance.
    #[must_use]
    pub fn tangent(&self, exchange: &Exchange) -> Vec<Entry> {
        let mut entries = Vec::new();
        for (point, flux) in self.boundary.points.iter().zip(&exchange.flux) {
            for &(na, va) in &point.nodes {
                for &(nb, vb) in &point.nodes {
                    if let (Some(row), Some(col), true) = (self.unknown[na], self.unknown[nb], flux.by_temperature != 0.0) {
                        entries.push((row, col, point.weight * va * vb * flux.by_temperature));
                    }
                }
            }
        }
        for (side, lumped) in self.lumped.iter().enumerate() {
            let Some(lumped) = lumped else { continue };
            let mut slope = lumped.storage + lumped.exchange;
            let (mut by_foundation, mut by_body): (Vec<(u32, f64)>, Vec<(u32, f64)>) = Default::default();
            for (point, flux) in self.boundary.points.iter().zip(&exchange.flux).filter(|(point, _)| point.side == side) {
                slope -= point.weight * flux.by_foundation;
                for &(node, value) in &point.nodes {
                    if let (Some(unknown), true) = (self.unknown[node], flux.by_foundation != 0.0 || flux.by_temperature != 0.0) {
                        by_foundation.push((unknown, point.weight * value * flux.by_foundation));
                        by_body.push((unknown, point.weight * value * flux.by_temperature));
                    }
                }
            }
            for &(row, c) in &by_foundation {
                entries.extend(by_body.iter().map(|&(col, r)| (row, col, c * r / slope)));
            }
        }
        entries
    }

    fn evaluate(&self, condensed: &Condensed, r: &[f64], guess: &[f64], theta: Vec<f64>) -> HeatEvaluation {
        let exchange = self.exchange(&theta);
        let increment: Vec<f64> = theta.iter().zip(guess).map(|(theta, guess)| theta - guess).collect();
        let inner = condensed.apply(&increment);
        let mut heat = vec![0.0; theta.len()];
        for (point, flux) in self.boundary.points.iter().zip(&exchange.flux) {
            for &(node, value) in &point.nodes {
                if let Some(u) = self.unknown[node] {
                    heat[u as usize] += point.weight * value * flux.value;
                }
            }
        }
        let scale = max_abs(&inner).max(max_abs(&heat)).max(max_abs(r));
        let errors: Vec<f64> = (0..theta.len()).map(|i| inner[i] + heat[i] - r[i]).collect();
        // θ − guess and θ − θ_F are differences of larger numbers.
        let sizes: Vec<f64> = theta.iter().zip(guess).map(|(theta, guess)| theta.abs() + guess.abs()).collect();
        let residual = max_abs(&errors);
        // A residual beyond the bound is no round-off, whatever the product.
        let mut floor = if residual > f64::EPSILON * condensed.magnitude_bound(&sizes) { 0.0 } else { f64::EPSILON * condensed.magnitude(&sizes) };
        for (i, (point, flux)) in self.boundary.points.iter().zip(&exchange.flux).enumerate() {
            let theta_f = exchange.foundation.get(point.side).copied().flatten().unwrap_or(self.foundation[i]);
            floor = floor.max(f64::EPSILON * point.weight * flux.by_temperature * (exchange.temperature[i].abs() + theta_f.abs()));
        }
        let merit = errors.iter().map(|e| e * e).sum();
        HeatEvaluation { residual, errors, merit, scale, tolerance: (TOLERANCE * scale).max(floor), theta, exchange }
    }
}

struct HeatEvaluation {
    theta: Vec<f64>,
    exchange: Exchange,
    errors: Vec<f64>,
    merit: f64,
    residual: f64,
    scale: f64,
    tolerance: f64,
}
