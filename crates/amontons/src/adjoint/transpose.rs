//! The transposed systems of a step.

use super::bordered::{Bordered, BorderedPoint, BorderedRight, IDENTITY, transposed};
use super::exerted::heat_step;
use super::factors::StepFactors;
use super::instance::{ProblemInstance, SolvedStep};
use super::lumped::{both_sides, multipliers};
use super::points::LinearPoint;
use crate::contact::Flux;
use crate::equation::foundation::temperatures;
use crate::equation::heat::lumped;
use crate::equation::system::{HalfStep, Step};
use crate::inclusion::{Exchange, HeatStep, Local};
use crate::linalg::{BlockMatrix, SolveError, Tangent, zeros};
use crate::space::Space;
use crate::tensor::Point;

/// The solution of a transposed mechanical half-step.
pub(super) struct Transposed {
    /// Per degree of freedom; zero where the velocity is prescribed.
    pub y: Vec<f64>,
    /// Per contact point and equation, of the equations times ω.
    pub points: Vec<Local>,
    /// Per degree of freedom, of a prescribed velocity; zero elsewhere.
    pub prescribed: Vec<f64>,
}

impl StepFactors {
    /// Jᵀ of the mechanical half-step: solves
    ///
    /// K y + Σ ω Nᵀ G_vᵀ μ = `right`,  N y + G_fᵀ μ = `force` at each point, with y = 0 where w is prescribed,
    ///
    /// G_v and G_f the derivatives of the defects in velocity and force.
    pub fn mechanics(
        &mut self,
        base: &ProblemInstance,
        of: &SolvedStep,
        points: &[LinearPoint],
        (right, force): (&[f64], &[Local]),
    ) -> Result<Transposed, SolveError> {
        let block = |point: &LinearPoint| BorderedPoint {
            onto: transposed(&point.by_velocity()),
            seen: IDENTITY,
            own: transposed(&point.by_force()),
        };
        let blocks: Vec<BorderedPoint> = points.iter().map(block).collect();
        let right = BorderedRight { body: right, points: force, held: None };
        let Bordered { x, forces, left } = self.bordered(base, of, points, (&blocks, &right))?;
        Ok(Transposed { y: x, points: forces, prescribed: held_forces(&base.discrete.v, left) })
    }

    /// Jᵀ of the heat half-step: y with y = 0 where θ is prescribed, and the multipliers of prescribed temperatures.
    /// `foundation` are the weights of the temperatures of foundations.
    pub fn heat(
        &mut self,
        base: &ProblemInstance,
        of: &SolvedStep,
        (right, foundation): (&[f64], &[f64]),
    ) -> Result<[Vec<f64>; 2], SolveError> {
        let Some(factored) = &mut self.heat else { return Ok([Vec::new(), Vec::new()]) };
        let flux = of.flux;
        base.step(of.n, of.old, |step| {
            let tangent = heat_tangent(step, &mut factored.half, of).transposed();
            let is_symmetric = factored.is_symmetric;
            let apply = |matrix: &BlockMatrix, y: &[f64]| -> Vec<f64> {
                let product = if is_symmetric { matrix.apply(y) } else { matrix.apply_transposed(y) };
                let eta = multipliers(step, flux, &[], y);
                product.iter().zip(exchanged(step, flux, y, &eta)).map(|(a, b)| a + b).collect()
            };
            let none = zeros(right.len());
            let known = exchanged(step, flux, &none, &multipliers(step, flux, foundation, &none));
            let right: Vec<f64> = right.iter().zip(&known).map(|(right, known)| right - known).collect();
            let [y, left] = factored.solved(&step.discrete.q, &tangent, (none, &right), apply)?;
            Ok([y, held_forces(&step.discrete.q, left)])
        })
    }
}

/// The components of forces along prescribed degrees of freedom; zero along the others.
fn held_forces(space: &Space, mut forces: Vec<f64>) -> Vec<f64> {
    space.gather(&mut forces);
    space.nodal(&space.prescribed_of(&forces))
}

/// Adds weights of temperatures of the sides of each point to the nodes.
pub(super) fn onto_sides(step: &Step, of: impl Iterator<Item = [f64; 2]>, sum: &mut [f64]) {
    for (point, sides) in step.boundary.points.iter().zip(of) {
        for (i, &(node, value)) in point.nodes.iter().enumerate() {
            sum[step.boundary.nodes[node] as usize] += value * sides[usize::from(i >= point.own)];
        }
    }
}

/// The transposed derivative of Σ ω Nᵀ q·ν in θ times y, and of the balances of foundations times their multipliers.
fn exchanged(step: &Step, flux: &[Flux], y: &[f64], eta: &[f64]) -> Vec<f64> {
    let seen = both_sides(step, y, eta);
    let of = step.boundary.points.iter().zip(flux.iter().zip(&seen)).map(|(point, (flux, [own, other]))| {
        let sum = point.weight * (own + other);
        // The shares of the other side are negative in the jump.
        [sum * flux.by_temperature, 0.0 - sum * flux.by_foundation]
    });
    let mut all = zeros(y.len());
    onto_sides(step, of, &mut all);
    all
}

/// A vector of each point in the axes of space on the degrees of freedom, without the weights of the points.
pub(super) fn unweighted(step: &Step, vectors: impl Iterator<Item = Point>) -> Vec<f64> {
    let mut sum = zeros(step.discrete.v.free.len());
    let by_weight = step.boundary.points.iter().zip(vectors);
    let of = by_weight.map(|(point, v)| if point.weight == 0.0 { [0.0; 3] } else { v.map(|v| v / point.weight) });
    step.boundary.scatter(step.discrete.v.components, of, &mut sum);
    sum
}

/// The derivative of the heat that contact takes in the temperatures of a step, and the system made ready for it.
pub(super) fn heat_tangent(step: &Step, half: &mut HalfStep, of: &SolvedStep) -> Tangent {
    half.system.condensed_mut().turn(&[]);
    if step.contacts.is_empty() {
        return Tangent::new();
    }
    let (foundation, lumped) = (temperatures(step), lumped(step));
    let prescribed = step.boundary.restricted(1, &of.at.theta);
    let exchange = Exchange { flux: of.flux.to_vec(), ..Exchange::default() };
    let (on_boundary, unknown) = (heat_step(step, &foundation, of.states), &half.on_contact);
    HeatStep { theta_prescribed: &prescribed, lumped: &lumped, unknown, ..on_boundary }.tangent(&exchange)
}
