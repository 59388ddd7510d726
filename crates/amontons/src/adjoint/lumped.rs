//! Foundations with a heat capacity, linearised.
//!
//! With Q the heat flux at a contact point and s = C/δ + H − Σ ω ∂Q/∂θ_F the slope of the balance of a foundation, the
//! changes of θ_F follow those of the temperatures of the body, and are eliminated:
//!
//! ```text
//!     s dθ_F = r + Σ ω ∂Q/∂θ dθ,     and transposed     s η = λ − Σ ω ∂Q/∂θ_F N y.
//! ```

use crate::contact::{Contact, Flux};
use crate::equation::heat::lumped;
use crate::equation::system::Step;
use crate::linalg::zeros;

/// By point, Σ N y over the nodes of the side that bears it and over the others.
pub(super) fn sides_of(step: &Step, y: &[f64]) -> Vec<[f64; 2]> {
    let nodes = &step.boundary.nodes;
    let sum = |of: &[(usize, f64)]| -> f64 { of.iter().map(|&(node, value)| value * y[nodes[node] as usize]).sum() };
    step.boundary
        .points
        .iter()
        .map(|point| {
            let (own, other) = point.nodes.split_at(point.own);
            [sum(own), sum(other)]
        })
        .collect()
}

/// s of each contact; `None` where θ_F is prescribed.
fn slopes(step: &Step, flux: &[Flux]) -> Vec<Option<f64>> {
    let mut all: Vec<Option<f64>> =
        lumped(step).iter().map(|of| of.as_ref().map(|of| of.storage + of.exchange)).collect();
    for (point, flux) in step.boundary.points.iter().zip(flux) {
        if let Some(Some(slope)) = all.get_mut(point.contact) {
            *slope -= point.weight * flux.by_foundation;
        }
    }
    all
}

/// Of each foundation with a heat capacity `right` plus `factor` times what its points sum up, over the slope of its
/// balance; zero of the others.
fn balanced(step: &Step, flux: &[Flux], right: &[f64], (factor, at): (f64, &dyn Fn(usize) -> f64)) -> Vec<f64> {
    let slopes = slopes(step, flux);
    let mut all = zeros(slopes.len());
    all.iter_mut().zip(right).for_each(|(all, right)| *all += right);
    for (i, point) in step.boundary.points.iter().enumerate() {
        if let Some(sum) = all.get_mut(point.contact) {
            *sum += factor * point.weight * at(i);
        }
    }
    all.iter().zip(slopes).map(|(sum, slope)| slope.map_or(0.0, |slope| sum / slope)).collect()
}

/// η of each foundation, by the weights λ of θ_F at the time of the equations and the multipliers of (4.2).
pub(super) fn multipliers(step: &Step, flux: &[Flux], weights: &[f64], y: &[f64]) -> Vec<f64> {
    let seen = sides_of(step, y);
    balanced(step, flux, weights, (-1.0, &|i| flux[i].by_foundation * seen[i][0]))
}

/// The change of each θ_F, by the right-hand sides of their balances and the changes of temperatures.
pub(super) fn warmed(step: &Step, flux: &[Flux], right: &[f64], theta: &[f64]) -> Vec<f64> {
    let seen = sides_of(step, theta);
    balanced(step, flux, right, (1.0, &|i| flux[i].by_temperature * seen[i][0]))
}

/// By point, Σ N y over the side that bears it, and over what it faces: the other side, or a foundation with a heat
/// capacity, whose values have the opposite sign in the jump.
pub(super) fn both_sides(step: &Step, y: &[f64], foundation: &[f64]) -> Vec<[f64; 2]> {
    let mut all = sides_of(step, y);
    for (point, [_, other]) in step.boundary.points.iter().zip(&mut all) {
        *other -= foundation.get(point.contact).copied().unwrap_or(0.0);
    }
    all
}

/// True if what friction generates at the points of a contact and does not enter the side that bears them enters what
/// it faces.
pub(super) fn takes_friction(contact: &Contact) -> bool {
    contact.rubs() || contact.foundation_heat.is_some()
}
