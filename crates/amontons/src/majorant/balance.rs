//! Linear tractions on the facets of the mesh that balance each cell.
//!
//! With the linear function φ of a vertex and the moments b_F = ∫_F t φ of the tractions on the facets at it, the cells
//! E at the vertex are in balance if Σ_F ± b_F = ∫_E σ∇φ − ∫_E f φ. The sum over the cells is the discrete equation of
//! the vertex, so that there are solutions; the nearest one to the means of σν is taken.
//!
//! Source: P. Ladevèze, J.-P. Pelle, *Mastering Calculations in Linear and Nonlinear Mechanics* (2005), chapter 2.

use rayon::prelude::*;

use super::Refused;
use super::dense::{Semidefinite, product};
use super::discrete::CellStress;
use super::skeleton::Skeleton;
use crate::tensor::{Point, length};

/// What is known of the traction on a facet.
#[derive(Clone, Debug)]
pub(super) struct FacetGiven {
    /// Projection onto the directions in which the traction is unknown, rows.
    pub free: [Point; 3],
    /// Moments of the known traction per vertex, N.
    pub moments: Vec<Point>,
    /// The sizes of their summands, which may cancel, N.
    pub size: f64,
}

impl FacetGiven {
    /// A facet inside the body.
    pub fn inner(vertices: usize) -> FacetGiven {
        let free = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
        FacetGiven { free, moments: vec![[0.0; 3]; vertices], size: 0.0 }
    }

    /// A facet of the boundary without a traction.
    pub fn outer(vertices: usize) -> FacetGiven {
        FacetGiven { free: [[0.0; 3]; 3], moments: vec![[0.0; 3]; vertices], size: 0.0 }
    }

    /// Adds a force to the moment of a vertex.
    pub fn add(&mut self, vertex: usize, weight: f64, traction: &Point) {
        self.size += length(traction) * weight.abs();
        for (moment, traction) in self.moments[vertex].iter_mut().zip(traction) {
            *moment += weight * traction;
        }
    }

    /// Leaves the traction along a direction unknown.
    pub fn release(&mut self, direction: &Point) {
        let along = self.project(direction);
        let rest: Point = std::array::from_fn(|c| direction[c] - along[c]);
        let size = length(&rest);
        if size < 1e-6 {
            return;
        }
        let unit = rest.map(|c| c / size);
        for i in 0..3 {
            for j in 0..3 {
                self.free[i][j] += unit[i] * unit[j];
            }
        }
    }

    pub fn project(&self, v: &Point) -> Point {
        self.free.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
    }

    /// True if all directions are known, or none.
    pub fn is_whole(&self, dim: usize) -> bool {
        self.is_known() || self.kept(dim).is_empty()
    }

    /// True if no direction is unknown.
    pub fn is_known(&self) -> bool {
        self.free.iter().flatten().all(|x| x.abs() < 0.5 * f64::EPSILON)
    }

    /// Rows whose products with a traction are its known components.
    pub fn kept(&self, dim: usize) -> Vec<Point> {
        let row = |i: usize| -> Point { std::array::from_fn(|j| f64::from(u8::from(i == j)) - self.free[i][j]) };
        (0..dim).map(row).filter(|row| length(row) > 1e-6).collect()
    }

    /// The known part of a moment, and the projection of the free part.
    fn known(&self, vertex: usize) -> Point {
        let given = &self.moments[vertex];
        let free = self.project(given);
        std::array::from_fn(|c| given[c] - free[c])
    }
}

/// Sums that a cell enters into the balance with.
#[derive(Clone, Debug)]
pub(super) struct CellForces {
    /// ∫ σ∇φ − ∫ f φ per vertex, N.
    pub rest: [Point; 8],
    /// ∫ f φ per vertex, N.
    pub load: [Point; 8],
    /// Volume times size of the compliance, m³/Pa.
    pub softness: f64,
    /// Volume, m³.
    pub volume: f64,
}

impl CellForces {
    /// The load per volume, whose moments are those of a constant, N/m³.
    pub fn load_density(&self) -> Point {
        let sum = self.load.iter().fold([0.0; 3], |sum: Point, f| std::array::from_fn(|c| sum[c] + f[c]));
        sum.map(|c| c / self.volume)
    }
}

/// The moments of the tractions, by facet and vertex.
pub(super) type FacetMoments = Vec<[Point; 4]>;

/// Largest part of the forces of a star that may be left unbalanced, relative to the largest force of the body: more
/// than round-off is a force on a point or an edge.
const LEFT: f64 = 1e-8;

/// Moments of σν on the facets: the mean of both cells, weighted by their compliance over their height, and the weight.
pub(super) fn means(skeleton: &Skeleton, forces: &[CellForces], stresses: &[CellStress]) -> (FacetMoments, Vec<f64>) {
    let of_facet = |facet: usize| {
        let known = &skeleton.facets[facet];
        let (mut sum, mut weight, mut area) = ([[0.0; 3]; 4], 0.0, 1.0);
        for &(cell, local) in &known.cells {
            area = stresses[cell].areas[local];
            let softness = forces[cell].softness / area;
            weight += softness;
            let sign = known.sign(cell);
            for (sum, moment) in sum.iter_mut().zip(&stresses[cell].moments[local]) {
                (0..3).for_each(|c| sum[c] += sign * softness * moment[c]);
            }
        }
        // ∫ t² is about |b|²/|F|, and costs compliance times height.
        (sum.map(|sum| sum.map(|c| c / weight)), weight / area)
    };
    (0..skeleton.facets.len()).into_par_iter().map(of_facet).unzip()
}

/// The moments of tractions that balance all cells.
///
/// # Errors
/// If a star has no balance: a force acts on a point or an edge.
pub(super) fn balanced(
    skeleton: &Skeleton,
    dim: usize,
    given: &[FacetGiven],
    forces: &[CellForces],
    (means, weights): (&FacetMoments, &[f64]),
) -> Result<FacetMoments, Refused> {
    let largest = forces.iter().flat_map(|cell| cell.rest.iter().chain(&cell.load)).map(length).fold(0.0, f64::max);
    let largest = given.iter().map(|facet| facet.size).fold(largest, f64::max);
    let problem = StarProblem { skeleton, dim, given, forces, means, weights, largest };
    let stars: Vec<Result<Vec<(usize, usize, Point)>, Refused>> =
        (0..skeleton.stars.len()).into_par_iter().map(|vertex| problem.solve(vertex)).collect();
    let mut moments: FacetMoments = vec![[[0.0; 3]; 4]; skeleton.facets.len()];
    for star in stars {
        for (facet, place, moment) in star? {
            moments[facet][place] = moment;
        }
    }
    Ok(moments)
}

struct StarProblem<'a> {
    skeleton: &'a Skeleton,
    dim: usize,
    given: &'a [FacetGiven],
    forces: &'a [CellForces],
    means: &'a FacetMoments,
    weights: &'a [f64],
    largest: f64,
}

/// A facet of a star: its place of the vertex, and its cells in the star with signs.
struct StarFacet {
    facet: usize,
    place: usize,
    cells: [(usize, f64); 2],
    count: usize,
}

impl StarFacet {
    fn cells(&self) -> &[(usize, f64)] {
        &self.cells[..self.count]
    }
}

impl StarProblem<'_> {
    /// The facets of a star.
    fn facets(&self, vertex: u32, star: &[(usize, usize)]) -> Vec<StarFacet> {
        let mut sides: Vec<(usize, usize, usize)> = Vec::with_capacity(star.len() * self.dim);
        for (row, (cell, _)) in star.iter().enumerate() {
            for &facet in &self.skeleton.cells[*cell].facets {
                if let Some(place) = self.skeleton.facets[facet].place(vertex) {
                    sides.push((facet, row, place));
                }
            }
        }
        sides.sort_unstable();
        let of_facet = |sides: &[(usize, usize, usize)]| {
            let (facet, _, place) = sides[0];
            let side = |(_, row, _): &(usize, usize, usize)| (*row, self.skeleton.facets[facet].sign(star[*row].0));
            let cells = [side(&sides[0]), side(&sides[sides.len() - 1])];
            StarFacet { facet, place, cells, count: sides.len().min(2) }
        };
        sides.chunk_by(|a, b| a.0 == b.0).map(of_facet).collect()
    }

    /// Moments of the facets of a vertex: facet, place of the vertex, moment.
    fn solve(&self, vertex: usize) -> Result<Vec<(usize, usize, Point)>, Refused> {
        let (star, d) = (&self.skeleton.stars[vertex], self.dim);
        let facets = self.facets(vertex as u32, star);
        let first = |of: &StarFacet| -> Point {
            let given = &self.given[of.facet];
            let (known, free) = (given.known(of.place), given.project(&self.means[of.facet][of.place]));
            std::array::from_fn(|c| known[c] + free[c])
        };
        let mut moments: Vec<(usize, usize, Point)> = facets.iter().map(|of| (of.facet, of.place, first(of))).collect();
        let mut right: Vec<f64> =
            star.iter().flat_map(|&(cell, local)| self.forces[cell].rest[local].into_iter().take(d)).collect();
        for (of, (_, _, moment)) in facets.iter().zip(&moments) {
            for &(a, sign) in of.cells() {
                (0..d).for_each(|c| right[a * d + c] -= sign * moment[c]);
            }
        }
        // Components are apart if each traction is known or unknown as a whole.
        let is_apart = facets.iter().all(|of| self.given[of.facet].is_whole(d));
        let multipliers = if is_apart {
            self.by_component(star.len(), &facets, &right)?
        } else {
            let matrix = self.matrix(star.len(), &facets, d);
            self.tested((&matrix, &Semidefinite::new(&matrix)), &right)?
        };
        for (of, (_, _, moment)) in facets.iter().zip(&mut moments) {
            let mut sum = [0.0; 3];
            for &(a, sign) in of.cells() {
                (0..d).for_each(|c| sum[c] += sign * multipliers[a * d + c] / self.weights[of.facet]);
            }
            let change = self.given[of.facet].project(&sum);
            (0..3).for_each(|c| moment[c] += change[c]);
        }
        Ok(moments)
    }

    /// The matrix of the multipliers of the cells, for the first components.
    fn matrix(&self, cells: usize, facets: &[StarFacet], d: usize) -> Vec<Vec<f64>> {
        let mut matrix = vec![vec![0.0; cells * d]; cells * d];
        for of in facets {
            let free = &self.given[of.facet].free;
            for &(a, sign) in of.cells() {
                for &(b, other) in of.cells() {
                    for i in 0..d {
                        for j in 0..d {
                            matrix[a * d + i][b * d + j] += sign * other * free[i][j] / self.weights[of.facet];
                        }
                    }
                }
            }
        }
        matrix
    }

    /// The multipliers of a star, one component after the other.
    fn by_component(&self, cells: usize, facets: &[StarFacet], right: &[f64]) -> Result<Vec<f64>, Refused> {
        let d = self.dim;
        let matrix = self.matrix(cells, facets, 1);
        let factor = Semidefinite::new(&matrix);
        let mut all = vec![0.0; right.len()];
        for c in 0..d {
            let own: Vec<f64> = right.iter().skip(c).step_by(d).copied().collect();
            let solution = self.tested((&matrix, &factor), &own)?;
            all.iter_mut().skip(c).step_by(d).zip(solution).for_each(|(all, x)| *all = x);
        }
        Ok(all)
    }

    /// A solution of the equations of a star.
    fn tested(&self, (matrix, factor): (&[Vec<f64>], &Semidefinite), right: &[f64]) -> Result<Vec<f64>, Refused> {
        let multipliers = factor.solve(right);
        let off = |(row, right): (&Vec<f64>, &f64)| (right - product(row, &multipliers)).abs();
        let left = matrix.iter().zip(right).map(off).fold(0.0, f64::max);
        if left > LEFT * self.largest {
            return Err(Refused::new(
                "a force acts on a point or an edge, where no stress of finite energy balances it",
            ));
        }
        Ok(multipliers)
    }
}
