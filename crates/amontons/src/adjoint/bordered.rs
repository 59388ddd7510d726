//! The linearised mechanical half-step with the equations of its contact points.

use super::factors::{Factored, REPETITIONS, ROUNDED, StepFactors, solvable};
use super::instance::{ProblemInstance, SolvedStep, data, global};
use super::points::LinearPoint;
use crate::equation::system::Step;
use crate::inclusion::{Local, LocalTangent};
use crate::linalg::{BlockMatrix, SolveError, Tangent, max_abs, zeros};
use crate::tensor::dot;

/// What is added to the matrix of a force, which is singular where a point sticks or lies on a rigid foundation. What
/// it leaves of the equations is solved for again, so the solution does not depend on it.
const PROXIMAL: f64 = 1.0 / (1u64 << 24) as f64;

pub(super) const IDENTITY: LocalTangent = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A contact point with force f in a half-step with unknown x,
///
/// K x + Σ ω Nᵀ `onto` f = r,  `seen` N x + `own` f = d,
///
/// in the basis of the point. A point without weight has no force.
pub(super) struct BorderedPoint {
    pub onto: LocalTangent,
    pub seen: LocalTangent,
    pub own: LocalTangent,
}

/// The right-hand sides r per degree of freedom and d per contact point, and the prescribed values of x.
pub(super) struct BorderedRight<'a> {
    pub body: &'a [f64],
    pub points: &'a [Local],
    /// Zero where no value is prescribed; `None` if all values are zero.
    pub held: Option<&'a [f64]>,
}

/// The right-hand sides of a mechanical half-step.
pub(super) struct Pushed {
    /// Of (4.1) per degree of freedom.
    pub right: Vec<f64>,
    /// Of the equations of the contact points.
    pub defects: Vec<Local>,
    /// The prescribed velocities; zero where none is prescribed.
    pub held: Vec<f64>,
}

/// The unknowns of a half-step.
pub(super) struct Bordered {
    pub x: Vec<f64>,
    pub forces: Vec<Local>,
    /// What is left of the first equation: the forces at prescribed values, elsewhere round-off.
    pub left: Vec<f64>,
}

impl StepFactors {
    /// Solves the mechanical half-step with its contact points. Corrections of the equations of the points are made on
    /// Γ_C alone, so that the bodies are solved once.
    pub fn bordered(
        &mut self,
        base: &ProblemInstance,
        of: &SolvedStep,
        points: &[LinearPoint],
        (blocks, right): (&[BorderedPoint], &BorderedRight),
    ) -> Result<Bordered, SolveError> {
        let Some(Factored { half, matrix, largest, .. }) = &mut self.mechanics else {
            let none = zeros(right.body.len());
            return Ok(Bordered { x: none.clone(), forces: Vec::new(), left: none });
        };
        base.step(of.n, of.old, |step| {
            let given = data(step, of.at);
            let border = Border::new(step, points, blocks);
            let term = given.frozen(step, of.unknown, of.chosen);
            let condensed = half.system.condensed_mut();
            let tangent = term.map_or_else(Tangent::new, |term| term.sum_of_slopes(condensed, &border.slopes()));
            let space = &step.discrete.v;
            let mut x = right.held.map_or_else(|| zeros(right.body.len()), <[f64]>::to_vec);
            let (mut forces, mut left) = (vec![[0.0; 3]; points.len()], right.body.to_vec());
            if right.held.is_some() {
                left = border.left(matrix, (&x, &forces), right);
            }
            for _ in 0..REPETITIONS {
                let mut defects = border.defects((&x, &forces), right);
                let mut rest = border.pushed(&defects);
                rest.iter_mut().zip(&left).for_each(|(rest, left)| *rest += left);
                solvable(space, &mut rest);
                let mut repetition = 0;
                let more = half.system.linearised_again(&tangent, &rest, |change| {
                    let size = border.correct(change, &mut forces, &mut defects);
                    repetition += 1;
                    let is_met = defects.iter().all(|defect| max_abs(defect) <= ROUNDED * size);
                    (!is_met && repetition < REPETITIONS).then(|| {
                        let mut rest = border.pushed(&defects);
                        solvable(space, &mut rest);
                        rest
                    })
                })?;
                x.iter_mut().zip(&more).for_each(|(x, more)| *x += more);
                left = border.left(matrix, (&x, &forces), right);
                let mut unmet = left.clone();
                solvable(space, &mut unmet);
                if max_abs(&unmet) <= ROUNDED * *largest * max_abs(&x) {
                    break;
                }
            }
            Ok(Bordered { x, forces, left })
        })
    }
}

/// The contact points of a half-step.
struct Border<'a> {
    step: &'a Step<'a>,
    points: &'a [LinearPoint],
    blocks: &'a [BorderedPoint],
    /// (`own` + [`PROXIMAL`])⁻¹ by point.
    inverses: Vec<LocalTangent>,
}

impl<'a> Border<'a> {
    fn new(step: &'a Step<'a>, points: &'a [LinearPoint], blocks: &'a [BorderedPoint]) -> Border<'a> {
        Border { step, points, blocks, inverses: blocks.iter().map(|block| inverse(&near(&block.own))).collect() }
    }

    /// The derivatives of the forces that the points exert in N x.
    fn slopes(&self) -> Vec<LocalTangent> {
        let of = |(block, inverse): (&BorderedPoint, &LocalTangent)| {
            product(&product(&block.onto, inverse), &block.seen).map(|row| row.map(|entry| 0.0 - entry))
        };
        self.blocks.iter().zip(&self.inverses).map(of).collect()
    }

    /// Minus the forces on the degrees of freedom that follow from what is left of the equations of points.
    fn pushed(&self, defects: &[Local]) -> Vec<f64> {
        let of = |((block, inverse), defect): ((&BorderedPoint, &LocalTangent), &Local)| {
            times(&block.onto, &times(inverse, defect)).map(|force| 0.0 - force)
        };
        let all: Vec<Local> = self.blocks.iter().zip(&self.inverses).zip(defects).map(of).collect();
        on_degrees(self.step, self.points, &all)
    }

    /// Adds what follows from a change of x to the forces, and takes it from what is left of the equations of points;
    /// returns the size of the terms of these equations.
    fn correct(&self, change: &[f64], forces: &mut [Local], defects: &mut [Local]) -> f64 {
        let mut size = 0.0_f64;
        for (i, (block, inverse)) in self.blocks.iter().zip(&self.inverses).enumerate().filter(|(i, _)| self.bears(*i))
        {
            let seen = times(&block.seen, &jump(self.step, i, &self.points[i], change));
            let rest: Local = std::array::from_fn(|a| defects[i][a] - seen[a]);
            let more = times(inverse, &rest);
            let own = times(&block.own, &more);
            size = size.max(max_abs(&defects[i])).max(max_abs(&seen)).max(max_abs(&own));
            (0..3).for_each(|a| forces[i][a] += more[a]);
            defects[i] = std::array::from_fn(|a| rest[a] - own[a]);
        }
        size
    }

    /// What is left of the equations of the points.
    fn defects(&self, (x, forces): (&[f64], &[Local]), right: &BorderedRight) -> Vec<Local> {
        let of = |(i, block): (usize, &BorderedPoint)| -> Local {
            if !self.bears(i) {
                return [0.0; 3];
            }
            let seen = times(&block.seen, &jump(self.step, i, &self.points[i], x));
            let own = times(&block.own, &forces[i]);
            std::array::from_fn(|a| right.points[i][a] - seen[a] - own[a])
        };
        self.blocks.iter().enumerate().map(of).collect()
    }

    /// What is left of the equation of the bodies.
    fn left(&self, matrix: &BlockMatrix, (x, forces): (&[f64], &[Local]), right: &BorderedRight) -> Vec<f64> {
        let exerted: Vec<Local> =
            self.blocks.iter().zip(forces).map(|(block, force)| times(&block.onto, force)).collect();
        let (product, exerted) = (matrix.apply(x), on_degrees(self.step, self.points, &exerted));
        right.body.iter().zip(product.iter().zip(&exerted)).map(|(right, (a, b))| right - a - b).collect()
    }

    fn bears(&self, i: usize) -> bool {
        bears(self.step, i)
    }
}

/// True if a contact point faces something: it has a weight.
pub(super) fn bears(step: &Step, i: usize) -> bool {
    step.boundary.points.get(i).is_some_and(|point| point.weight != 0.0)
}

/// Σ ω Nᵀ of vectors in the bases of the points.
fn on_degrees(step: &Step, points: &[LinearPoint], of: &[Local]) -> Vec<f64> {
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

fn near(g: &LocalTangent) -> LocalTangent {
    std::array::from_fn(|a| std::array::from_fn(|b| g[a][b] + if a == b { PROXIMAL } else { 0.0 }))
}

/// The transposed matrix.
pub(super) fn transposed(g: &LocalTangent) -> LocalTangent {
    std::array::from_fn(|a| std::array::from_fn(|b| g[b][a]))
}

fn times(g: &LocalTangent, v: &Local) -> Local {
    g.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn product(g: &LocalTangent, h: &LocalTangent) -> LocalTangent {
    std::array::from_fn(|a| std::array::from_fn(|b| (0..3).map(|c| g[a][c] * h[c][b]).sum()))
}

/// The inverse, by Cramer's rule.
fn inverse(g: &LocalTangent) -> LocalTangent {
    let cofactor = |a: usize, b: usize| {
        let [a1, a2, b1, b2] = [(a + 1) % 3, (a + 2) % 3, (b + 1) % 3, (b + 2) % 3];
        g[a1][b1] * g[a2][b2] - g[a1][b2] * g[a2][b1]
    };
    let determinant: f64 = (0..3).map(|b| g[0][b] * cofactor(0, b)).sum();
    std::array::from_fn(|a| std::array::from_fn(|b| cofactor(b, a) / determinant))
}
