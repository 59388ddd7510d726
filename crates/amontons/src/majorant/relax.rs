//! Tractions between the cells with a smaller complementary energy.
//!
//! All tractions with which each cell stays in balance are admissible. Conjugate gradients lower the energy among them,
//! preconditioned by the sum of the exact solutions on patches: the facets at a vertex of a plane body, or at an edge
//! in space. The result does not depend on the order of patches.

use rayon::prelude::*;

use super::Refused;
use super::balance::{CellForces, FacetGiven, FacetMoments};
use super::energy::CellEnergy;
use super::modes::{FacetModes, MOST, cross};
use super::patches::{Patches, split};
use super::skeleton::Skeleton;
use crate::mesh::Mesh;
use crate::tensor::{Point, dot, length};

/// Components of the tractions of a hexahedron, which has most.
const LARGEST: usize = 6 * MOST;
/// Iterations: more change the bound by few percent.
const ITERATIONS: usize = 4;
/// Part of the energy that an iteration has to lower for another one to follow: half of it is that of the bound.
const WORTH: f64 = 0.02;
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

impl<'a> TractionDescent<'a> {
    /// Sets the components of a cell, outward.
    fn gather(&self, cell: usize, y: &[f64], own: &mut [f64]) {
        let (stride, facets) = (self.skeleton.stride, &self.skeleton.cells[cell].facets);
        let k = own.len() / facets.len();
        for (&facet, own) in facets.iter().zip(own.chunks_exact_mut(k)) {
            let sign = self.skeleton.facets[facet].sign(cell);
            own.iter_mut().zip(&y[facet * stride..]).for_each(|(own, y)| *own = sign * y);
        }
    }

    /// Σ of vectors of the cells, by facet.
    fn summed(&self, cells: &[&mut [f64]]) -> Vec<f64> {
        let stride = self.skeleton.stride;
        let mut sum = vec![0.0; stride * self.skeleton.facets.len()];
        sum.par_chunks_exact_mut(stride).zip(&self.skeleton.facets).for_each(|(sum, of)| {
            for &(cell, local) in &of.cells {
                let sign = of.sign(cell);
                let k = cells[cell].len() / self.skeleton.cells[cell].facets.len();
                sum.iter_mut().zip(&cells[cell][local * k..][..k]).for_each(|(sum, x)| *sum += sign * x);
            }
        });
        sum
    }

    /// Σ of what a function sets of the components of the cells, and what it returns per cell. `work` is kept between
    /// calls.
    fn by_cell(
        &self,
        y: &[f64],
        work: &mut Vec<f64>,
        of: impl Fn(&CellEnergy<'a>, &mut [f64], &mut [f64]) -> f64 + Sync,
    ) -> (Vec<f64>, Vec<f64>) {
        work.resize(self.energies.iter().map(CellEnergy::len).sum(), 0.0);
        let lengths = || self.energies.iter().map(CellEnergy::len);
        let of_cell = |(cell, (energy, image)): (usize, (&CellEnergy<'a>, &mut [f64]))| {
            let mut own = [0.0; LARGEST];
            let own = &mut own[..energy.len()];
            self.gather(cell, y, own);
            of(energy, own, image)
        };
        let values = self.energies.par_iter().zip(split(work, lengths())).enumerate().map(of_cell).collect();
        (self.summed(&split(work, lengths())), values)
    }

    /// The slope, and the energy of each cell.
    fn slopes(&self, y: &[f64], work: &mut Vec<f64>) -> (Vec<f64>, Vec<f64>) {
        self.by_cell(y, work, CellEnergy::slope)
    }

    fn image(&self, y: &[f64], work: &mut Vec<f64>) -> Vec<f64> {
        let times = |energy: &CellEnergy, own: &mut [f64], image: &mut [f64]| {
            energy.times(own, image);
            0.0
        };
        self.by_cell(y, work, times).0
    }

    /// The energies of the cells after a few iterations from moments in balance.
    ///
    /// # Errors
    /// If round-off leaves a cell out of balance.
    pub fn least(&self, first: &FacetMoments, forces: &[CellForces]) -> Result<Vec<f64>, Refused> {
        let stride = self.skeleton.stride;
        let modes = self.skeleton.modes.iter().zip(first);
        let mut y: Vec<f64> = modes.flat_map(|(modes, own)| modes.of_moments(own).into_iter().take(stride)).collect();
        let (mut by_cell, mut by_patch) = (Vec::new(), Vec::new());
        let (mut rest, cells) = self.slopes(&y, &mut by_cell);
        let mut energy: f64 = cells.iter().sum();
        for x in &mut rest {
            *x = 0.0 - *x;
        }
        let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let (mut direction, mut before) = (vec![0.0; y.len()], 0.0);
        for iteration in 0..if self.patches.is_empty() { 0 } else { ITERATIONS } {
            let step = self.patches.preconditioned(&rest, &mut by_patch);
            let now = product(&rest, &step);
            let beta = if iteration == 0 { 0.0 } else { now / before };
            direction.iter_mut().zip(&step).for_each(|(d, s)| *d = s + beta * *d);
            let image = self.image(&direction, &mut by_cell);
            let curvature = product(&direction, &image);
            if now.is_nan() || now <= 0.0 || curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let length = now / curvature;
            y.iter_mut().zip(&direction).for_each(|(y, d)| *y += length * d);
            rest.iter_mut().zip(&image).for_each(|(r, d)| *r -= length * d);
            before = now;
            energy -= 0.5 * length * now;
            if 0.5 * length * now < WORTH * energy {
                break;
            }
        }
        self.check(&y, forces)?;
        Ok(self.slopes(&y, &mut by_cell).1)
    }

    /// Checks the balance of all cells, and that known components have been kept.
    fn check(&self, y: &[f64], forces: &[CellForces]) -> Result<(), Refused> {
        let (d, stride) = (self.mesh.dim, self.skeleton.stride);
        let largest = y.iter().fold(0.0, |m: f64, y| m.max(y.abs()));
        let largest = forces.iter().flat_map(|cell| &cell.load).map(length).fold(largest, f64::max);
        let largest = self.given.iter().map(|facet| facet.size).fold(largest, f64::max);
        // Round-off has the size of the stresses, which need not have forces: those of one cell may cancel.
        let largest = self.energies.iter().map(CellEnergy::size).fold(largest, f64::max);
        let all = || self.skeleton.modes.par_iter().zip(y.par_chunks_exact(stride));
        let moments: FacetMoments = all().map(|(modes, y)| modes.moments(y)).collect();
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
        let is_changed = |((given, moments), (modes, y)): ((&FacetGiven, &[Point; 4]), (&FacetModes, &[f64]))| {
            let kept = given.kept(d);
            // The known tractions have no part without moments.
            let has_part = |part: Point| kept.iter().any(|row| dot(row, &part).abs() > UNBALANCED * largest);
            modes.further(y).skip(1).any(has_part)
                || given.moments.iter().zip(moments).any(|(known, own)| {
                    let off = |row: &Point| (dot(row, known) - dot(row, own)).abs();
                    kept.iter().map(off).any(|off| off.is_nan() || off > UNBALANCED * largest)
                })
        };
        if self.given.par_iter().zip(&moments).zip(all()).any(is_changed) {
            return Err(Refused::new("round-off: the tractions on a side are not those that act there"));
        }
        Ok(())
    }
}
