//! Tractions between the cells with a smaller complementary energy.
//!
//! All moments with which each cell stays in balance are admissible. Conjugate gradients lower the energy among them,
//! preconditioned by the sum of the exact solutions on patches: the facets at a vertex of a plane body, or at an edge
//! in space. The result does not depend on the order of patches.

use std::collections::{BTreeMap, HashMap};

use rayon::prelude::*;

use super::Refused;
use super::balance::{CellForces, FacetGiven, FacetMoments};
use super::dense::Constrained;
use super::energy::CellEnergy;
use super::skeleton::Skeleton;
use crate::mesh::Mesh;
use crate::tensor::{Point, length};

/// Iterations: more change the bound by few percent.
const ITERATIONS: usize = 4;
/// What may be missing to the balance of a cell, relative to the largest force of the body.
const UNBALANCED: f64 = 1e-7;

/// The cells and facets with all moments in one vector: by facet, vertex and component.
pub(super) struct TractionDescent<'a> {
    pub mesh: &'a Mesh,
    pub skeleton: &'a Skeleton,
    pub given: &'a [FacetGiven],
    pub energies: &'a [CellEnergy],
}

impl TractionDescent<'_> {
    fn per_facet(&self) -> usize {
        self.mesh.dim * self.mesh.dim
    }

    /// Places of the moments of a cell in the vector, with signs, in the order of its energy.
    fn places(&self, cell: usize) -> Vec<(usize, f64)> {
        let (d, element) = (self.mesh.dim, self.skeleton.tables(cell).element);
        let nodes = self.skeleton.nodes(self.mesh, cell);
        let mut places = Vec::new();
        for (local, &facet) in self.skeleton.cells[cell].facets.iter().enumerate() {
            let of = &self.skeleton.facets[facet];
            let sign = of.sign(cell);
            for &node in &element.facets[local].nodes[..d.max(1)] {
                let place = of.place(nodes[node]).unwrap_or(0);
                places.extend((0..d).map(|c| (facet * self.per_facet() + place * d + c, sign)));
            }
        }
        places
    }

    fn of_cell(&self, cell: usize, x: &[f64]) -> Vec<f64> {
        self.places(cell).into_iter().map(|(place, sign)| sign * x[place]).collect()
    }

    /// Σ of a vector per cell.
    fn gathered(&self, of: impl Fn(&CellEnergy, &[f64]) -> Vec<f64> + Sync, x: &[f64]) -> Vec<f64> {
        let cells: Vec<Vec<f64>> = (0..self.energies.len())
            .into_par_iter()
            .map(|cell| of(&self.energies[cell], &self.of_cell(cell, x)))
            .collect();
        let mut sum = vec![0.0; x.len()];
        for (cell, values) in cells.iter().enumerate() {
            for ((place, sign), value) in self.places(cell).into_iter().zip(values) {
                sum[place] += sign * value;
            }
        }
        sum
    }

    /// The energies of the cells after a few iterations from moments in balance.
    ///
    /// # Errors
    /// If round-off leaves a cell out of balance.
    pub fn least(&self, first: &FacetMoments, forces: &[CellForces]) -> Result<Vec<f64>, Refused> {
        let mut x: Vec<f64> =
            first.iter().flatten().flat_map(|moment| moment[..self.mesh.dim].iter().copied()).collect();
        let patches = self.patches();
        let problems: Vec<FacetPatch> = patches.into_par_iter().map(|facets| self.patch(&facets)).collect();
        let mut rest: Vec<f64> = self.gathered(CellEnergy::slope, &x).iter().map(|x| 0.0 - x).collect();
        let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let (mut direction, mut before) = (vec![0.0; x.len()], 0.0);
        for iteration in 0..if problems.is_empty() { 0 } else { ITERATIONS } {
            let step = preconditioned(&problems, &rest);
            let now = product(&rest, &step);
            let beta = if iteration == 0 { 0.0 } else { now / before };
            direction.iter_mut().zip(&step).for_each(|(d, s)| *d = s + beta * *d);
            let image = self.gathered(CellEnergy::times, &direction);
            let curvature = product(&direction, &image);
            if now.is_nan() || now <= 0.0 || curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let length = now / curvature;
            x.iter_mut().zip(&direction).for_each(|(x, d)| *x += length * d);
            rest.iter_mut().zip(&image).for_each(|(r, d)| *r -= length * d);
            before = now;
        }
        self.check(&x, forces)?;
        Ok((0..self.energies.len())
            .into_par_iter()
            .map(|cell| self.energies[cell].value(&self.of_cell(cell, &x)))
            .collect())
    }

    /// The facets whose tractions are not known, by vertex or edge.
    fn patches(&self) -> Vec<Vec<usize>> {
        let d = self.mesh.dim;
        if d < 2 {
            return Vec::new();
        }
        let mut patches: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        for (facet, of) in self.skeleton.facets.iter().enumerate() {
            if self.given[facet].is_known() {
                continue;
            }
            for (i, &a) in of.vertices.iter().enumerate() {
                if d == 2 {
                    patches.entry([a, a]).or_default().push(facet);
                }
                for &b in of.vertices.iter().skip(i + 1).filter(|_| d == 3) {
                    patches.entry([a, b]).or_default().push(facet);
                }
            }
        }
        patches.into_values().collect()
    }

    fn patch(&self, facets: &[usize]) -> FacetPatch {
        let (d, per) = (self.mesh.dim, self.per_facet());
        let slots: HashMap<usize, usize> = facets.iter().enumerate().map(|(slot, &facet)| (facet, slot)).collect();
        let local = |place: usize| slots.get(&(place / per)).map(|slot| slot * per + place % per);
        let size = facets.len() * per;
        let mut gram = vec![vec![0.0; size]; size];
        let mut rows = Vec::new();
        let mut cells: Vec<usize> =
            facets.iter().flat_map(|&facet| self.skeleton.facets[facet].cells.iter().map(|of| of.0)).collect();
        cells.sort_unstable();
        cells.dedup();
        for cell in cells {
            let places: Vec<(usize, usize, f64)> = self
                .places(cell)
                .into_iter()
                .enumerate()
                .filter_map(|(own, (place, sign))| Some((own, local(place)?, sign)))
                .collect();
            for &(i, a, sign) in &places {
                for &(j, b, other) in &places {
                    gram[a][b] += sign * other * self.energies[cell].gram(i, j);
                }
            }
            for row in self.resultants(cell) {
                let mut of_patch = vec![0.0; size];
                for &(own, at, sign) in &places {
                    of_patch[at] = sign * row[own];
                }
                rows.push(of_patch);
            }
        }
        // Known components keep their values.
        for (slot, &facet) in facets.iter().enumerate() {
            for row in self.given[facet].kept(d) {
                for vertex in 0..d {
                    let mut of_patch = vec![0.0; size];
                    (0..d).for_each(|c| of_patch[slot * per + vertex * d + c] = row[c]);
                    rows.push(of_patch);
                }
            }
        }
        let places = facets.iter().flat_map(|&facet| facet * per..(facet + 1) * per).collect();
        FacetPatch { places, problem: Constrained::new(gram, &rows) }
    }

    /// Forces and moments about the first vertex of a cell for its moments, in the order of its energy.
    fn resultants(&self, cell: usize) -> Vec<Vec<f64>> {
        let (d, element) = (self.mesh.dim, self.skeleton.tables(cell).element);
        let nodes = self.skeleton.nodes(self.mesh, cell);
        let at = |node: u32| self.mesh.points[node as usize];
        let origin = at(nodes[0]);
        let arms = element.facets.iter().flat_map(|facet| &facet.nodes[..d.max(1)]).map(|&node| {
            let x = at(nodes[node]);
            std::array::from_fn(|c| x[c] - origin[c])
        });
        let arms: Vec<Point> = arms.collect();
        let pairs: &[(usize, usize)] = [&[][..], &[(0, 1)], &[(0, 1), (1, 2), (2, 0)]][d - 1];
        let forces = (0..d).map(|c| {
            let unit = |(_, k): (usize, usize)| f64::from(u8::from(k == c));
            (0..arms.len()).flat_map(|v| (0..d).map(move |k| (v, k))).map(unit).collect()
        });
        let moments = pairs.iter().map(|&(i, j)| {
            let turn = |(v, k): (usize, usize)| {
                let arm: &Point = &arms[v];
                if k == j {
                    arm[i]
                } else if k == i {
                    0.0 - arm[j]
                } else {
                    0.0
                }
            };
            (0..arms.len()).flat_map(|v| (0..d).map(move |k| (v, k))).map(turn).collect()
        });
        forces.chain(moments).collect()
    }

    /// Checks the balance of all cells.
    fn check(&self, x: &[f64], forces: &[CellForces]) -> Result<(), Refused> {
        let largest = x.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let largest = forces.iter().flat_map(|cell| &cell.load).map(length).fold(largest, f64::max);
        let largest = self.given.iter().map(|facet| facet.size).fold(largest, f64::max);
        // Round-off has the size of the stresses, which need not have forces: those of one cell may cancel.
        let largest = self.energies.iter().map(CellEnergy::size_of_moments).fold(largest, f64::max);
        let d = self.mesh.dim;
        let is_wrong = |cell: usize| {
            let (b, nodes) = (self.of_cell(cell, x), self.skeleton.nodes(self.mesh, cell));
            let at = |node: u32| self.mesh.points[node as usize];
            let origin = at(nodes[0]);
            let (mut size, mut sums) = (0.0f64, Vec::new());
            for row in self.resultants(cell) {
                sums.push(row.iter().zip(&b).map(|(a, b)| a * b).sum::<f64>());
            }
            for (load, &node) in forces[cell].load.iter().zip(nodes) {
                let arm: Point = std::array::from_fn(|c| at(node)[c] - origin[c]);
                size = size.max(length(&arm));
                (0..d).for_each(|c| sums[c] += load[c]);
                let turn = |i: usize, j: usize| arm[i] * load[j] - arm[j] * load[i];
                for (sum, (i, j)) in sums.iter_mut().skip(d).zip([(0, 1), (1, 2), (2, 0)]) {
                    *sum += turn(i, j);
                }
            }
            let limit = |k: usize| UNBALANCED * largest * if k < d { 1.0 } else { size };
            sums.iter().enumerate().any(|(k, sum)| sum.is_nan() || sum.abs() > limit(k))
        };
        if (0..self.energies.len()).into_par_iter().any(is_wrong) {
            return Err(Refused::new("round-off: the tractions of a cell are not in balance"));
        }
        Ok(())
    }
}

/// The problem of least energy in the moments of some facets.
struct FacetPatch {
    places: Vec<usize>,
    problem: Constrained,
}

/// The sum of the solutions of the patches.
fn preconditioned(patches: &[FacetPatch], rest: &[f64]) -> Vec<f64> {
    let solutions: Vec<Vec<f64>> = patches
        .par_iter()
        .map(|patch| {
            let linear: Vec<f64> = patch.places.iter().map(|&place| 0.0 - rest[place]).collect();
            patch.problem.homogeneous(&linear)
        })
        .collect();
    let mut sum = vec![0.0; rest.len()];
    for (patch, solution) in patches.iter().zip(&solutions) {
        patch.places.iter().zip(solution).for_each(|(&place, value)| sum[place] += value);
    }
    sum
}
