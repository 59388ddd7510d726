//! The transposed systems of a step.

use super::factors::{Corrections, Factored, StepFactors, solvable};
use super::instance::{ProblemInstance, SolvedStep, data, global, heat_step};
use super::points::LinearPoint;
use crate::contact::Flux;
use crate::equation::foundation::temperatures;
use crate::equation::system::{HalfStep, Step};
use crate::inclusion::{Exchange, HeatStep, Local, LocalTangent};
use crate::linalg::{BlockMatrix, SolveError, Tangent, zeros};
use crate::space::Space;
use crate::tensor::{Point, dot};

/// What is added to ∂(defect)/∂(force), which is singular where a point sticks or lies on a rigid foundation. Residuals
/// of the equations themselves are solved for again, so the solution does not depend on it.
const PROXIMAL: f64 = 1.0 / (1u64 << 24) as f64;
/// The solution of a transposed mechanical half-step.
pub(super) struct Transposed {
    /// Per degree of freedom; zero where the velocity is prescribed.
    pub y: Vec<f64>,
    /// Per contact point and equation, of the equations times ω.
    pub points: Vec<Local>,
    /// Per degree of freedom, of a prescribed velocity; zero elsewhere.
    pub prescribed: Vec<f64>,
}

impl Transposed {
    /// The solution of a problem without mechanics.
    fn none(degrees: usize) -> Transposed {
        Transposed { y: zeros(degrees), points: Vec::new(), prescribed: zeros(degrees) }
    }
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
        let Some(Factored { half, matrix, .. }) = &mut self.mechanics else { return Ok(Transposed::none(right.len())) };
        base.step(of.n, of.old, |step| {
            let space = &step.discrete.v;
            let given = data(step, of.at);
            let inverses: Vec<LocalTangent> = points.iter().map(|point| inverse(&near(&point.by_force()))).collect();
            let slope = |(point, inverse): (&LinearPoint, &LocalTangent)| {
                product(inverse, &point.by_velocity()).map(|row| row.map(|entry| 0.0 - entry))
            };
            let slopes: Vec<LocalTangent> = points.iter().zip(&inverses).map(slope).map(|t| transposed(&t)).collect();
            let term = given.frozen(step, of.unknown, of.chosen);
            let condensed = half.system.condensed_mut();
            let tangent = term.map_or_else(Tangent::new, |term| term.sum_of_slopes(condensed, &slopes));
            let mut found =
                Transposed { y: zeros(right.len()), points: vec![[0.0; 3]; points.len()], prescribed: Vec::new() };
            let mut left = (right.to_vec(), force.to_vec());
            let mut progress = Corrections::default();
            while progress.go_on() {
                let back = |((point, inverse), r): ((&LinearPoint, &LocalTangent), &Local)| {
                    times(&transposed(&point.by_velocity()), &times(&transposed(inverse), r))
                };
                let reacting: Vec<Local> = points.iter().zip(&inverses).zip(&left.1).map(back).collect();
                let pushed = on_degrees(step, points, &reacting);
                let mut rest: Vec<f64> = left.0.iter().zip(&pushed).map(|(rest, pushed)| rest - pushed).collect();
                solvable(space, &mut rest);
                let more = half.system.linearised(&tangent, &rest)?;
                for (i, (point, inverse)) in points.iter().zip(&inverses).enumerate() {
                    let seen = jump(step, i, point, &more);
                    let left = std::array::from_fn(|a| left.1[i][a] - seen[a]);
                    let change = times(&transposed(inverse), &left);
                    (0..3).for_each(|a| found.points[i][a] += change[a]);
                }
                found.y.iter_mut().zip(&more).for_each(|(y, more)| *y += more);
                left = remaining(step, matrix, points, &found, (right, force));
                progress.add(&more, &found.y);
            }
            found.prescribed = held_forces(space, left.0);
            Ok(found)
        })
    }

    /// Jᵀ of the heat half-step: y with y = 0 where θ is prescribed, and the multipliers of prescribed temperatures.
    pub fn heat(
        &mut self,
        base: &ProblemInstance,
        of: &SolvedStep,
        flux: &[Flux],
        right: &[f64],
    ) -> Result<[Vec<f64>; 2], SolveError> {
        let Some(factored) = &mut self.heat else { return Ok([Vec::new(), Vec::new()]) };
        base.step(of.n, of.old, |step| {
            let tangent = heat_tangent(step, &mut factored.half, of, flux).transposed();
            let is_symmetric = factored.is_symmetric;
            let apply = |matrix: &BlockMatrix, y: &[f64]| -> Vec<f64> {
                let product = if is_symmetric { matrix.apply(y) } else { matrix.apply_transposed(y) };
                product.iter().zip(exchanged(step, flux, y)).map(|(a, b)| a + b).collect()
            };
            let [y, left] = factored.solved(&step.discrete.q, &tangent, (zeros(right.len()), right), apply)?;
            Ok([y, held_forces(&step.discrete.q, left)])
        })
    }
}

/// What is left of the transposed equations.
fn remaining(
    step: &Step,
    matrix: &BlockMatrix,
    points: &[LinearPoint],
    found: &Transposed,
    (right, force): (&[f64], &[Local]),
) -> (Vec<f64>, Vec<Local>) {
    let reacting: Vec<Local> =
        points.iter().zip(&found.points).map(|(point, mu)| times(&transposed(&point.by_velocity()), mu)).collect();
    let (product, pushed) = (matrix.apply(&found.y), on_degrees(step, points, &reacting));
    let rest = (0..right.len()).map(|i| right[i] - product[i] - pushed[i]).collect();
    let of_point = |(i, point): (usize, &LinearPoint)| {
        // A point without weight faces nothing and exerts nothing.
        if step.boundary.points.get(i).is_none_or(|point| point.weight == 0.0) {
            return [0.0; 3];
        }
        let (seen, reacting) =
            (jump(step, i, point, &found.y), times(&transposed(&point.by_force()), &found.points[i]));
        std::array::from_fn(|a| force[i][a] - seen[a] - reacting[a])
    };
    (rest, points.iter().enumerate().map(of_point).collect())
}

/// Σ ω Nᵀ of vectors in the bases of the points.
pub(super) fn on_degrees(step: &Step, points: &[LinearPoint], of: &[Local]) -> Vec<f64> {
    let mut sum = zeros(step.discrete.v.free.len());
    let vectors = points.iter().zip(of).map(|(point, v)| global(&point.basis, v));
    step.boundary.scatter(step.discrete.v.components, vectors, &mut sum);
    sum
}

/// N y at a point in its basis.
pub(super) fn jump(step: &Step, i: usize, point: &LinearPoint, y: &[f64]) -> Local {
    let Some(on) = step.boundary.points.get(i) else { return [0.0; 3] };
    let v = step.boundary.vector_at(on, step.discrete.mesh.dim, y);
    point.basis.map(|axis| dot(&axis, &v))
}

/// The components of forces along prescribed degrees of freedom; zero along the others.
fn held_forces(space: &Space, mut forces: Vec<f64>) -> Vec<f64> {
    space.gather(&mut forces);
    space.nodal(&space.prescribed_of(&forces))
}

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

/// Adds weights of temperatures of the sides of each point to the nodes.
pub(super) fn onto_sides(step: &Step, of: impl Iterator<Item = [f64; 2]>, sum: &mut [f64]) {
    for (point, sides) in step.boundary.points.iter().zip(of) {
        for (i, &(node, value)) in point.nodes.iter().enumerate() {
            sum[step.boundary.nodes[node] as usize] += value * sides[usize::from(i >= point.own)];
        }
    }
}

/// The transposed derivative of Σ ω Nᵀ q·ν in θ times y.
fn exchanged(step: &Step, flux: &[Flux], y: &[f64]) -> Vec<f64> {
    let seen = sides_of(step, y);
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

pub(super) fn near(g: &LocalTangent) -> LocalTangent {
    std::array::from_fn(|a| std::array::from_fn(|b| g[a][b] + if a == b { PROXIMAL } else { 0.0 }))
}

fn transposed(g: &LocalTangent) -> LocalTangent {
    std::array::from_fn(|a| std::array::from_fn(|b| g[b][a]))
}

pub(super) fn times(g: &LocalTangent, v: &Local) -> Local {
    g.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

pub(super) fn product(g: &LocalTangent, h: &LocalTangent) -> LocalTangent {
    std::array::from_fn(|a| std::array::from_fn(|b| (0..3).map(|c| g[a][c] * h[c][b]).sum()))
}

/// The inverse, by Cramer's rule.
pub(super) fn inverse(g: &LocalTangent) -> LocalTangent {
    let cofactor = |a: usize, b: usize| {
        let [a1, a2, b1, b2] = [(a + 1) % 3, (a + 2) % 3, (b + 1) % 3, (b + 2) % 3];
        g[a1][b1] * g[a2][b2] - g[a1][b2] * g[a2][b1]
    };
    let determinant: f64 = (0..3).map(|b| g[0][b] * cofactor(0, b)).sum();
    std::array::from_fn(|a| std::array::from_fn(|b| cofactor(b, a) / determinant))
}

/// The derivative of the heat that contact takes in the temperatures of a step, and the system made ready for it.
pub(super) fn heat_tangent(step: &Step, half: &mut HalfStep, of: &SolvedStep, flux: &[Flux]) -> Tangent {
    half.system.condensed_mut().turn(&[]);
    if step.contacts.is_empty() {
        return Tangent::new();
    }
    let (foundation, lumped) = (temperatures(step), vec![None; step.contacts.len()]);
    let prescribed = step.boundary.restricted(1, &of.at.theta);
    let exchange = Exchange { flux: flux.to_vec(), ..Exchange::default() };
    let (on_boundary, unknown) = (heat_step(step, &foundation, of.states), &half.on_contact);
    HeatStep { theta_prescribed: &prescribed, lumped: &lumped, unknown, ..on_boundary }.tangent(&exchange)
}
