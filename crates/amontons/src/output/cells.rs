//! Values in the cells computed from a state: strains, stresses, heat fluxes, and the norm of V.

use std::ops::Range;

use rayon::prelude::*;

use super::fit::{Fit, exponents};
use crate::arrays::all_at_once;
use crate::element::{Element, ShapeTable};
use crate::forms::{StrainPoints, is_mean};
use crate::linalg::max_abs;
use crate::material::{Branch, Material, Prony, TensorLaw, material_arrays};
use crate::mesh::{Block, CellMap, Mesh};
use crate::problem::Problem;
use crate::quadrature::{self, QuadratureRule};
use crate::state::State;
use crate::tensor::{Point, Sym, safe_scale};

/// Strain, stress and heat flux of a body at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointValues {
    /// ε(u), with the mean dilatation of the cell if the problem uses it. Zero in directions that the body lacks; in a
    /// body of revolution 33 is the hoop strain.
    pub strain: Sym,
    /// Total stress σ of (2.1), Pa, with σ₃₃ in plane strain; in a body of revolution 33 is the hoop stress.
    pub stress: Sym,
    /// q = −𝓚∇θ of (2.2), W/m².
    pub heat_flux: Point,
}

impl PointValues {
    /// Adds `weight` times other values.
    pub(super) fn add(&mut self, weight: f64, other: &PointValues) {
        self.strain += weight * other.strain;
        self.stress += weight * other.stress;
        for (sum, q) in self.heat_flux.iter_mut().zip(other.heat_flux) {
            *sum += weight * q;
        }
    }
}

/// Points of the cells of every block at which a body is evaluated.
#[derive(Debug)]
pub(super) struct Tables {
    pub points: Vec<ShapeTable>,
    /// Per block, quadrature points of the mean dilatation, or `None` if the dilatation is evaluated at each point.
    means: Vec<Option<ShapeTable>>,
    /// Per block and point, weights of the stored strains of springs: those of a linear function fitted to the points
    /// of the cell. Empty if no strains are stored.
    fits: Vec<Vec<Vec<f64>>>,
}

impl Tables {
    /// Tables of the points that `rule` gives for the element of each block.
    pub fn new(problem: &Problem, rule: impl Fn(&Element) -> QuadratureRule) -> Tables {
        let mesh = &problem.mesh;
        let points = mesh.blocks.iter().map(|block| ShapeTable::of_rule(block.element, rule(block.element))).collect();
        let has_fits = problem.varying_branches() > 0;
        let fits = mesh.blocks.iter().filter(|_| has_fits).map(|block| {
            let kept = quadrature::rule(block.element.shape, mesh.gradient_products(block.element)).points;
            let linear = exponents(mesh.dim, 1);
            let (fit, _) = Fit::new(&linear, &block.element.centre(), &kept);
            rule(block.element).points.iter().map(|x| fit.weights(x)).collect()
        });
        let dilatation = problem.dilatation();
        let mean = |block: &Block| {
            let table = || ShapeTable::new(block.element, strain_degree(mesh, block.element));
            is_mean(&dilatation, block.region).then(table)
        };
        Tables { fits: fits.collect(), points, means: mesh.blocks.iter().map(mean).collect() }
    }
}

/// Degree of the rule for products of strains.
fn strain_degree(mesh: &Mesh, element: &Element) -> usize {
    2 * if mesh.axisymmetric { element.gradient_degree.max(element.degree) } else { element.gradient_degree }
}

/// Evaluates a state in the cells of one block.
pub(super) struct Evaluator<'a> {
    problem: &'a Problem,
    state: &'a State,
    material: Option<&'a Material>,
    /// True if the cells move as one rigid body: then their computed strain is round-off.
    is_rigid: bool,
    /// 𝓖 of each branch of the material that relaxes, with its state.
    branches: Vec<(&'a Branch, &'a [f64])>,
    /// Nodes of the cells of the block, and the number of nodes per cell.
    nodes: (&'a [u32], usize),
    /// Points at which strains of springs are stored, the number of the first one of the block, and their weights per
    /// point of the table.
    kept: StrainPoints<'a>,
    first: usize,
    fits: &'a [Vec<f64>],
    map: CellMap<'a>,
    /// Quadrature points of the mean dilatation, with their weights.
    mean: Option<(CellMap<'a>, &'a [f64])>,
}

impl<'a> Evaluator<'a> {
    /// An evaluator for the cells of block number `block` of the mesh.
    pub fn new(problem: &'a Problem, state: &'a State, tables: &'a Tables, block: usize) -> Evaluator<'a> {
        let mesh = &problem.mesh;
        let material = problem.material_of(mesh.blocks[block].region);
        // Stored strains are read, not computed.
        let kept = StrainPoints { mesh, dilatation: &[] };
        let points_of =
            |block: &Block| block.len() * tables.fits.first().map_or(0, |_| kept.table(block.element).len());
        Evaluator {
            problem,
            state,
            material,
            is_rigid: problem.rigid.iter().any(|part| part.is_region(mesh, mesh.blocks[block].region)),
            branches: material.map_or_else(Vec::new, |material| branches(problem, material, state)),
            nodes: (&mesh.blocks[block].nodes, mesh.blocks[block].element.nodes.len()),
            kept,
            first: mesh.blocks[..block].iter().map(points_of).sum(),
            fits: tables.fits.get(block).map_or(&[], Vec::as_slice),
            map: CellMap::new(mesh, &tables.points[block]),
            mean: tables
                .means
                .get(block)
                .and_then(Option::as_ref)
                .map(|table| (CellMap::new(mesh, table), &table.weights[..])),
        }
    }

    /// Strain, stress σ = 𝓔ε(u) + 𝓥ε(w) + Σ 𝓖e − θ𝓜 and heat flux at point `q` of the table in a cell of the block; e
    /// is the strain of a relaxing branch.
    pub fn at(&mut self, number: usize, q: usize) -> PointValues {
        let (nodes, n) = self.nodes;
        let cell = &nodes[number * n..(number + 1) * n];
        self.map.at(cell, q);
        let (mut theta, mut gradient) = (0.0, [0.0; 3]);
        for ((&node, value), g) in cell.iter().zip(self.map.values()).zip(&self.map.gradients) {
            let at_node = self.state.theta[node as usize];
            theta += value * at_node;
            for (sum, g) in gradient.iter_mut().zip(g) {
                *sum += at_node * g;
            }
        }
        let (strain, rate) = (self.strain(cell, self.state.deformation()), self.strain(cell, &self.state.w));
        let Some(material) = self.material else { return PointValues { strain, ..PointValues::default() } };
        let mut stress = material.stress(&self.map.position, &strain, &rate, theta);
        stress += self.thermal_stress_beyond_mean(cell, material, theta);
        for b in 0..self.branches.len() {
            let (branch, state) = self.branches[b];
            let strain = if branch.time_varies() { self.fitted(number, q, state) } else { self.strain(cell, state) };
            stress += branch.value(&self.map.position, &strain);
        }
        PointValues {
            strain,
            stress,
            heat_flux: material
                .conductivity
                .at_temperature(&self.map.position, theta)
                .apply(&gradient)
                .map(|q| 0.0 - q),
        }
    }

    /// The strain of a spring at point `q`, from the strains stored at the points of the cell.
    fn fitted(&self, number: usize, q: usize, state: &[f64]) -> Sym {
        let weights = &self.fits[q];
        let first = self.first + number * weights.len();
        let kept = weights.iter().enumerate().map(|(i, weight)| *weight * self.kept.kept(state, first + i));
        kept.fold(Sym::ZERO, |sum, term| sum + term)
    }

    /// The strain of a field as the forms evaluate it.
    fn strain(&mut self, cell: &[u32], v: &[f64]) -> Sym {
        if self.is_rigid {
            return Sym::ZERO;
        }
        let mesh = &self.problem.mesh;
        let mut strain = strain(mesh, &self.map, cell, v);
        let d = mesh.tensor_dim();
        if let Some(mean) = self.mean_of(cell, |map| Sym::identity(d).dot(&self::strain(mesh, map, cell, v))) {
            strain += (mean - strain.trace()) / d as f64 * Sym::identity(d);
        }
        strain
    }

    /// Deviation of the pressure of θ𝓜 at the point from its mean over the cell. With the mean dilatation in the forms
    /// it does no work; otherwise zero.
    fn thermal_stress_beyond_mean(&mut self, cell: &[u32], material: &Material, theta: f64) -> Sym {
        if self.mean.is_none() {
            return Sym::ZERO;
        }
        let all = &self.state.theta;
        let thermal = |map: &CellMap, theta: f64| theta * material.expansion.at_temperature(&map.position, theta);
        let at = |map: &CellMap| -> f64 {
            cell.iter().zip(map.values()).map(|(&node, value)| value * all[node as usize]).sum()
        };
        let here = thermal(&self.map, theta);
        let d = self.problem.mesh.tensor_dim();
        // σ₃₃ in plane strain goes with the others.
        let (within, across) = (Sym::identity(d), Sym::identity(3) - Sym::identity(d.max(2)));
        let mut beyond = |part: &Sym| {
            self.mean_of(cell, |map| part.dot(&thermal(map, at(map)))).map_or(0.0, |mean| part.dot(&here) - mean)
        };
        beyond(&within) / d as f64 * within + beyond(&across) * across
    }

    /// The mean of a function over a cell, or `None` if the cell does not use the mean dilatation.
    fn mean_of(&mut self, cell: &[u32], value: impl Fn(&CellMap) -> f64) -> Option<f64> {
        let (map, weights) = self.mean.as_mut()?;
        let (mut sum, mut volume) = (0.0, 0.0);
        for (q, weight) in weights.iter().enumerate() {
            map.at(cell, q);
            sum += weight * map.measure * value(map);
            volume += weight * map.measure;
        }
        Some(sum / volume)
    }
}

/// The branches of a material with their states, which are stored in the order of [`crate::discretization`]: by
/// relaxation time, then branches whose time varies.
fn branches<'a>(problem: &Problem, material: &'a Material, state: &'a State) -> Vec<(&'a Branch, &'a [f64])> {
    let (times, mut varying) = (problem.relaxation_times(), 0);
    let mut number = |branch: &Branch| {
        if branch.time_varies() {
            varying += 1;
            return Some(times.len() + varying - 1);
        }
        times.iter().position(|time| time.to_bits() == branch.time.to_bits())
    };
    let all = material.prony.as_ref().map_or(&[][..], Prony::branches).iter();
    all.filter_map(|branch| Some((branch, &state.branches.get(number(branch)?)?[..]))).collect()
}

/// Cells whose values are computed in one go.
const TOGETHER: usize = 1024;

/// Values at the points of the tables: cell by cell, block by block.
pub(super) fn all_values<T: Send>(
    problem: &Problem,
    state: &State,
    tables: &Tables,
    value: impl Fn(PointValues) -> T + Sync,
) -> Vec<T> {
    let of_cells = |block: usize, cells: Range<usize>| {
        let (mut evaluator, count) = (Evaluator::new(problem, state, tables, block), tables.points[block].len());
        let mut values = Vec::with_capacity(cells.len() * count);
        for cell in cells {
            values.extend((0..count).map(|q| value(evaluator.at(cell, q))));
        }
        values
    };
    let blocks = || problem.mesh.blocks.iter().enumerate();
    let arrays = material_arrays(&problem.materials);
    if !arrays.is_empty() {
        // Laws on arrays get the points of all cells at once, on one thread.
        return all_at_once(&arrays, || blocks().flat_map(|(b, block)| of_cells(b, 0..block.len())).collect());
    }
    let some = |(b, block): (usize, &Block)| {
        let count = block.len();
        (0..count).step_by(TOGETHER).map(move |first| (b, first..(first + TOGETHER).min(count)))
    };
    let parts: Vec<(usize, Range<usize>)> = blocks().flat_map(some).collect();
    parts.into_par_iter().flat_map_iter(|(b, cells)| of_cells(b, cells)).collect()
}

/// Values at the centre of every cell, block by block.
#[must_use]
pub fn cell_values(problem: &Problem, state: &State) -> Vec<PointValues> {
    let tables = Tables::new(problem, |element| QuadratureRule { points: vec![element.centre()], weights: vec![1.0] });
    all_values(problem, state, &tables, |values| values)
}

/// ‖ε(v)‖_{L²} of a vector field, node-major: the norm of V.
#[must_use]
pub fn strain_norm(mesh: &Mesh, v: &[f64]) -> f64 {
    let mut sum = 0.0;
    let scale = safe_scale(max_abs(v));
    for block in &mesh.blocks {
        let table = ShapeTable::new(block.element, strain_degree(mesh, block.element));
        let mut map = CellMap::new(mesh, &table);
        for cell in block.cells() {
            for (q, weight) in table.weights.iter().enumerate() {
                map.at(cell, q);
                let strain = scale * strain(mesh, &map, cell, v);
                sum += weight * map.measure * strain.dot(&strain);
            }
        }
    }
    sum.sqrt() / scale
}

/// The largest magnitude of a principal value of ε(v) over the quadrature points of strains, and its position.
#[must_use]
pub fn largest_strain(mesh: &Mesh, v: &[f64]) -> (f64, Point) {
    let mut worst = (0.0, [0.0; 3]);
    for block in &mesh.blocks {
        let table = ShapeTable::new(block.element, strain_degree(mesh, block.element));
        let mut map = CellMap::new(mesh, &table);
        for cell in block.cells() {
            for q in 0..table.len() {
                map.at(cell, q);
                let strain = strain(mesh, &map, cell, v);
                // The norm bounds the principal values, and is cheaper.
                if strain.norm() <= worst.0 {
                    continue;
                }
                let largest =
                    strain.eigenvalues(mesh.tensor_dim()).into_iter().fold(0.0, |max: f64, e| max.max(e.abs()));
                if largest > worst.0 || strain.norm().is_nan() {
                    worst = (if strain.norm().is_nan() { f64::NAN } else { largest }, map.position);
                }
            }
        }
    }
    worst
}

/// ε(v) = ½(∇v + ∇vᵀ) at the point of a map.
fn strain(mesh: &Mesh, map: &CellMap, cell: &[u32], v: &[f64]) -> Sym {
    let (dim, mut gradient, mut radial) = (mesh.dim, [[0.0; 3]; 3], 0.0);
    for ((&node, g), value) in cell.iter().zip(&map.gradients).zip(map.values()) {
        for i in 0..dim {
            for j in 0..dim {
                gradient[i][j] += v[node as usize * dim + i] * g[j];
            }
        }
        radial += value * v[node as usize * dim];
    }
    mesh.strain(&gradient, radial / map.position[0])
}
