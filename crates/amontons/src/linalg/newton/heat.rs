//! The heat step on Γ_C.

use super::point::PointState;
use super::{ITERATIONS, NotConverged, Solved, TOLERANCE};
use crate::contact::{Contact, ContactBoundary, ContactPoint, Flux, PointOnBoundary};
use crate::linalg::condensed::{Condensed, Entry};
use crate::linalg::sparse::max_abs;
use crate::tensor::{dot, length};

/// What is known of a heat step on Γ_C before it is solved.
pub struct HeatStep<'a> {
    /// The laws.
    pub contact: &'a Contact,
    /// The contact points.
    pub boundary: &'a ContactBoundary,
    /// Unknown of each contact node, none where prescribed.
    pub unknown: &'a [Option<u32>],
    /// Temperatures at the contact nodes, those that are prescribed filled in, K.
    pub theta_prescribed: &'a [f64],
    /// θ_F(t_n) at the contact points, K.
    pub foundation: &'a [f64],
    /// States of the contact points at u_n.
    pub states: &'a [PointState],
}

impl HeatStep<'_> {
    /// Temperature of the body at a contact point.
    fn temperature(&self, point: &PointOnBoundary, theta: &[f64]) -> f64 {
        point.nodes.iter().map(|&(node, value)| value * self.unknown[node].map_or(self.theta_prescribed[node], |u| theta[u as usize])).sum()
    }

    /// Temperature of the body and heat flux q·ν at each contact point.
    #[must_use]
    pub fn fluxes(&self, theta: &[f64]) -> Vec<(f64, Flux)> {
        self.boundary
            .points
            .iter()
            .enumerate()
            .map(|(i, point)| {
                let temperature = self.temperature(point, theta);
                let state = &self.states[i];
                let at = ContactPoint {
                    x: point.x,
                    penetration: state.penetration,
                    pressure: state.pressure,
                    slip_speed: length(&state.slip),
                    friction_power: dot(&state.q, &state.slip),
                    temperature,
                    foundation_temperature: self.foundation[i],
                };
                (temperature, self.contact.heat.flux(&at))
            })
            .collect()
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
            let entries = self.tangent(now.fluxes.iter().map(|(_, flux)| flux));
            let mut step: Vec<f64> = now.errors.iter().map(|e| -e).collect();
            condensed.solve(&entries, &mut step);
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

    /// The derivative of Σ ω Nᵀ q·ν in θ, the slopes of the fluxes given.
    pub fn tangent<'f>(&self, fluxes: impl Iterator<Item = &'f Flux>) -> Vec<Entry> {
        let mut entries = Vec::new();
        for (point, flux) in self.boundary.points.iter().zip(fluxes) {
            for &(na, va) in &point.nodes {
                for &(nb, vb) in &point.nodes {
                    if let (Some(row), Some(col), true) = (self.unknown[na], self.unknown[nb], flux.by_temperature != 0.0) {
                        entries.push((row, col, point.weight * va * vb * flux.by_temperature));
                    }
                }
            }
        }
        entries
    }

    fn evaluate(&self, condensed: &Condensed, r: &[f64], guess: &[f64], theta: Vec<f64>) -> HeatEvaluation {
        let fluxes = self.fluxes(&theta);
        let increment: Vec<f64> = theta.iter().zip(guess).map(|(theta, guess)| theta - guess).collect();
        let inner = condensed.apply(&increment);
        let mut heat = vec![0.0; theta.len()];
        for (point, (_, flux)) in self.boundary.points.iter().zip(&fluxes) {
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
        let mut floor = f64::EPSILON * condensed.magnitude(&sizes);
        for (i, (point, (temperature, flux))) in self.boundary.points.iter().zip(&fluxes).enumerate() {
            floor = floor.max(f64::EPSILON * point.weight * flux.by_temperature * (temperature.abs() + self.foundation[i].abs()));
        }
        let merit = errors.iter().map(|e| e * e).sum();
        HeatEvaluation { residual: max_abs(&errors), errors, merit, scale, tolerance: (TOLERANCE * scale).max(floor), theta, fluxes }
    }
}

struct HeatEvaluation {
    theta: Vec<f64>,
    fluxes: Vec<(f64, Flux)>,
    errors: Vec<f64>,
    merit: f64,
    residual: f64,
    scale: f64,
    tolerance: f64,
}
