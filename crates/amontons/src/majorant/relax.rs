//! Tractions between the cells with a smaller complementary energy.
//!
//! All tractions with which each cell stays in balance are admissible. Conjugate gradients lower the energy among them,
//! preconditioned by the sum of the exact solutions on patches: the facets at a vertex of a plane body, or at an edge
//! in space. The result does not depend on the order of patches.

use rayon::prelude::*;

use super::Refused;
use super::balance::{CellForces, FacetGiven, FacetMoments};
use super::energy::CellEnergy;
use super::modes::cross;
use super::patches::Patches;
use super::skeleton::Skeleton;
use crate::mesh::Mesh;
use crate::tensor::{Point, dot, length};

/// Iterations: more change the bound by few percent.
const ITERATIONS: usize = 4;
/// What may be missing to the balance of a cell, relative to the largest force of the body.
const UNBALANCED: f64 = 1e-7;

/// The cells and facets with the components of all tractions in one vector, by facet.
pub(super) struct TractionDescent<'a> {
    pub mesh: &'a Mesh,
    pub skeleton: &'a Skeleton,
    pub given: &'a [FacetGiven],
    pub energies: &'a [CellEnergy<'a>],
    pub patches: &'a Patches,
}

impl TractionDescent<'_> {
    fn per_facet(&self) -> usize {
        self.mesh.dim * self.mesh.dim
    }

    /// The components of a cell, outward.
    fn of_cell(&self, cell: usize, y: &[f64]) -> Vec<f64> {
        let k = self.per_facet();
        let mut own = Vec::with_capacity(k * self.skeleton.cells[cell].facets.len());
        for &facet in &self.skeleton.cells[cell].facets {
            let sign = self.skeleton.facets[facet].sign(cell);
            own.extend(y[facet * k..][..k].iter().map(|y| sign * y));
        }
        own
    }

    /// Σ of vectors of the cells.
    fn summed(&self, cells: &[Vec<f64>]) -> Vec<f64> {
        let k = self.per_facet();
        let mut sum = vec![0.0; k * self.skeleton.facets.len()];
        sum.par_chunks_exact_mut(k).zip(&self.skeleton.facets).for_each(|(sum, of)| {
            for &(cell, local) in &of.cells {
                let sign = of.sign(cell);
                sum.iter_mut().zip(&cells[cell][local * k..]).for_each(|(sum, x)| *sum += sign * x);
            }
        });
        sum
    }

    /// The energy of each cell, and the slope.
    fn slopes(&self, y: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let of_cell = |cell: usize| self.energies[cell].slope(self.of_cell(cell, y));
        let (slopes, energies): (Vec<Vec<f64>>, Vec<f64>) =
            (0..self.energies.len()).into_par_iter().map(of_cell).unzip();
        (self.summed(&slopes), energies)
    }

    fn image(&self, y: &[f64]) -> Vec<f64> {
        let of_cell = |cell: usize| self.energies[cell].times(&self.of_cell(cell, y));
        self.summed(&(0..self.energies.len()).into_par_iter().map(of_cell).collect::<Vec<_>>())
    }

    /// The energies of the cells after a few iterations from moments in balance.
    ///
    /// # Errors
    /// If round-off leaves a cell out of balance.
    pub fn least(&self, first: &FacetMoments, forces: &[CellForces]) -> Result<Vec<f64>, Refused> {
        let (d, k) = (self.mesh.dim, self.per_facet());
        let modes = self.skeleton.modes.iter().zip(first);
        let mut y: Vec<f64> = modes.flat_map(|(modes, own)| modes.of_moments(&own[..d]).into_iter().take(k)).collect();
        let (mut rest, _) = self.slopes(&y);
        rest.iter_mut().for_each(|x| *x = 0.0 - *x);
        let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let (mut direction, mut before) = (vec![0.0; y.len()], 0.0);
        for iteration in 0..if self.patches.is_empty() { 0 } else { ITERATIONS } {
            let step = self.patches.preconditioned(&rest);
            let now = product(&rest, &step);
            let beta = if iteration == 0 { 0.0 } else { now / before };
            direction.iter_mut().zip(&step).for_each(|(d, s)| *d = s + beta * *d);
            let image = self.image(&direction);
            let curvature = product(&direction, &image);
            if now.is_nan() || now <= 0.0 || curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let length = now / curvature;
            y.iter_mut().zip(&direction).for_each(|(y, d)| *y += length * d);
            rest.iter_mut().zip(&image).for_each(|(r, d)| *r -= length * d);
            before = now;
        }
        self.check(&y, forces)?;
        Ok(self.slopes(&y).1)
    }

    /// Checks the balance of all cells, and that known components have been kept.
    fn check(&self, y: &[f64], forces: &[CellForces]) -> Result<(), Refused> {
        let (d, k) = (self.mesh.dim, self.per_facet());
        let largest = y.iter().fold(0.0, |m: f64, y| m.max(y.abs()));
        let largest = forces.iter().flat_map(|cell| &cell.load).map(length).fold(largest, f64::max);
        let largest = self.given.iter().map(|facet| facet.size).fold(largest, f64::max);
        // Round-off has the size of the stresses, which need not have forces: those of one cell may cancel.
        let largest = self.energies.iter().map(CellEnergy::size).fold(largest, f64::max);
        let moments: FacetMoments =
            self.skeleton.modes.par_iter().zip(y.par_chunks_exact(k)).map(|(modes, y)| modes.moments(y)).collect();
        let is_wrong = |cell: usize| {
            let nodes = self.skeleton.nodes(self.mesh, cell);
            let at = |node: u32| &self.mesh.points[node as usize];
            let origin = at(nodes[0]);
            let (mut force, mut moment, mut size) = ([0.0; 3], [0.0; 3], 0.0f64);
            let mut add = |node: u32, sign: f64, own: &Point| {
                let arm: Point = std::array::from_fn(|c| at(node)[c] - origin[c]);
                let turn = cross(&arm, own);
                size = size.max(dot(&arm, &arm));
                (0..3).for_each(|c| (force[c], moment[c]) = (force[c] + sign * own[c], moment[c] + sign * turn[c]));
            };
            for &facet in &self.skeleton.cells[cell].facets {
                let of = &self.skeleton.facets[facet];
                of.vertices.iter().zip(&moments[facet]).for_each(|(&node, own)| add(node, of.sign(cell), own));
            }
            forces[cell].load.iter().zip(nodes).for_each(|(load, &node)| add(node, 1.0, load));
            let limit = UNBALANCED * largest;
            let is_off = |x: &f64, limit: f64| x.is_nan() || x.abs() > limit;
            force.iter().any(|x| is_off(x, limit)) || moment.iter().any(|x| is_off(x, limit * size.sqrt()))
        };
        if (0..self.energies.len()).into_par_iter().any(is_wrong) {
            return Err(Refused::new("round-off: the tractions of a cell are not in balance"));
        }
        let is_changed = |(given, moments): (&FacetGiven, &[Point; 3])| {
            let kept = given.kept(d);
            given.moments.iter().zip(moments).any(|(known, own)| {
                kept.iter().any(|row| !((dot(row, known) - dot(row, own)).abs() <= UNBALANCED * largest))
            })
        };
        if self.given.par_iter().zip(&moments).any(is_changed) {
            return Err(Refused::new("round-off: the tractions on a side are not those that act there"));
        }
        Ok(())
    }
}
