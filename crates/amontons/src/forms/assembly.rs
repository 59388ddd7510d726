//! Assembly of cell matrices: quantities at a point of a cell, and sums over points and cells.

use std::sync::Arc;

use rayon::prelude::*;

use crate::element::{Element, ShapeTable};
use crate::field::InSpace;
use crate::linalg::{BlockMatrix, Graph};
use crate::material::Dilatation;
use crate::mesh::{Block, CellMap, Mesh};
use crate::tensor::{MANDEL, Sym, mandel_len, mandel_weight};

/// The entry for a region in a list by region; the last one also serves regions beyond the list.
pub(super) fn of_region<'a, T: ?Sized>(list: &[&'a T], region: usize) -> Option<&'a T> {
    list.get(region).or(list.last()).copied()
}

/// Quantities at a point of a cell, from which forms are computed.
pub(super) struct CellPoint<'a> {
    pub mesh: &'a Mesh,
    table: &'a ShapeTable,
    pub map: CellMap<'a>,
    pub nodes: &'a [u32],
    pub region: usize,
    /// Number of the cell's first point, and of the point, among those of all cells in their order.
    first: usize,
    pub point: usize,
    /// Number of basis fields N_j e_c: nodes times d.
    pub fields: usize,
    /// Components 11 · 22, 12 · 33 … of the strain of each basis field N_j e_c, in order (j, c), one row per component:
    /// `strains[m][j d + c]`. Empty for forms that do not use it.
    strains: Vec<f64>,
    /// Mean over the cell of the divergence of each basis field; empty unless used.
    mean: Vec<f64>,
    /// Buffer of one number per basis field.
    room: Vec<f64>,
}

/// True if a region uses the mean dilatation; `all` is a list by region whose last entry also serves regions beyond.
pub(crate) fn is_mean(all: &[Dilatation], region: usize) -> bool {
    all.get(region).or(all.last()) == Some(&Dilatation::Mean)
}

/// Number of leading Mandel components of a strain.
pub(super) fn strain_components(mesh: &Mesh) -> usize {
    if mesh.axisymmetric { 4 } else { mandel_len(mesh.dim) }
}

impl<'a> CellPoint<'a> {
    pub fn new(mesh: &'a Mesh, block: &Block, table: &'a ShapeTable, strains: Option<&[Dilatation]>) -> CellPoint<'a> {
        let (components, fields) = (strain_components(mesh), block.element.nodes.len() * mesh.dim);
        let has_mean = strains.is_some_and(|all| is_mean(all, block.region));
        CellPoint {
            mesh,
            table,
            map: CellMap::new(mesh, table),
            nodes: &[],
            region: block.region,
            first: 0,
            point: 0,
            fields,
            strains: if strains.is_some() { vec![0.0; components * fields] } else { Vec::new() },
            mean: if has_mean { vec![0.0; fields] } else { Vec::new() },
            room: vec![0.0; fields],
        }
    }

    /// Calls `form` with this cell and the weight at each of its points.
    pub fn integrate(&mut self, mut form: impl FnMut(&mut CellPoint<'a>, f64)) {
        if !self.mean.is_empty() {
            self.average();
        }
        for (q, weight) in self.table.weights.iter().enumerate() {
            self.map.at(self.nodes, q);
            self.point = self.first + q;
            if !self.strains.is_empty() {
                self.strain();
                if !self.mean.is_empty() {
                    self.replace_trace();
                }
            }
            let weight = weight * self.map.measure;
            form(self, weight);
        }
    }

    /// The value of a scalar field at the point.
    pub fn scalar(&self, field: &[f64]) -> f64 {
        self.nodes.iter().zip(self.map.values()).map(|(&node, value)| value * field[node as usize]).sum()
    }

    /// A datum at the point, at the temperature interpolated from the nodal values `theta`, if given.
    pub fn local<T, D: InSpace<T> + ?Sized>(&self, datum: &D, theta: &[f64]) -> T {
        if theta.is_empty() {
            datum.at(&self.map.position)
        } else {
            datum.at_temperature(&self.map.position, self.scalar(theta))
        }
    }

    /// Component `m` of the strains of all basis fields.
    pub fn strain_row(&self, m: usize) -> &[f64] {
        &self.strains[m * self.fields..(m + 1) * self.fields]
    }

    /// The work 𝓣:ε(φ_a) of a tensor on the strain of each basis field.
    pub fn work(&mut self, tensor: &Sym) -> &[f64] {
        self.room.fill(0.0);
        for (component, row) in tensor.0.iter().zip(self.strains.chunks_exact(self.fields)) {
            for (work, strain) in self.room.iter_mut().zip(row) {
                *work += component * strain;
            }
        }
        &self.room
    }

    fn strain(&mut self) {
        let (dim, fields) = (self.mesh.dim, self.fields);
        let values = self.map.values();
        for (m, &(i, j)) in MANDEL.iter().enumerate().take(mandel_len(dim)) {
            let row = &mut self.strains[m * fields..(m + 1) * fields];
            // ε_ij = (∂_j v_i + ∂_i v_j)/2, times the Mandel weight.
            let weight = mandel_weight(i, j) * 0.5;
            for (entries, g) in row.chunks_exact_mut(dim).zip(&self.map.gradients) {
                if i == j {
                    entries.fill(0.0);
                    entries[i] = g[i];
                } else {
                    entries[i] = weight * g[j];
                    entries[j] = weight * g[i];
                }
            }
        }
        if self.mesh.axisymmetric {
            // ε_θθ = u_r / r.
            let r = self.map.position[0];
            for (entries, value) in self.strains[3 * fields..].chunks_exact_mut(dim).zip(values) {
                entries.fill(0.0);
                entries[0] = value / r;
            }
        }
    }

    /// Mandel components of the diagonal of a tensor, which sum to its trace.
    fn trace_components(&self) -> &'static [usize] {
        const DIAGONAL: [usize; 3] = [0, 1, 3];
        &DIAGONAL[..self.mesh.tensor_dim()]
    }

    /// Mean divergence of each basis field.
    fn average(&mut self) {
        let mut volume = 0.0;
        self.mean.fill(0.0);
        for (q, weight) in self.table.weights.iter().enumerate() {
            self.map.at(self.nodes, q);
            self.strain();
            let weight = weight * self.map.measure;
            volume += weight;
            for &m in self.trace_components() {
                for (mean, strain) in self.mean.iter_mut().zip(&self.strains[m * self.fields..]) {
                    *mean += weight * strain;
                }
            }
        }
        self.mean.iter_mut().for_each(|mean| *mean /= volume);
    }

    fn replace_trace(&mut self) {
        let (fields, diagonal) = (self.fields, self.trace_components());
        for field in 0..fields {
            let trace: f64 = diagonal.iter().map(|&m| self.strains[m * fields + field]).sum();
            let change = (self.mean[field] - trace) / diagonal.len() as f64;
            for &m in diagonal {
                self.strains[m * fields + field] += change;
            }
        }
    }
}

/// Cell results buffered before they are added up; they stay in the cache.
const KEPT: usize = 1 << 16;
/// Cells per task.
const TASK: usize = 32;

/// Computes `size` numbers per cell in parallel and passes them on in the order of the cells, many cells at once.
pub(super) fn by_cells(
    mesh: &Mesh,
    degree: impl Fn(&Element) -> usize,
    strains: Option<&[Dilatation]>,
    size: impl Fn(&Element) -> usize,
    form: impl Fn(&mut CellPoint, &mut [f64]) + Sync,
    mut add: impl FnMut(&[u32], usize, &[f64]),
) {
    let mut points = 0;
    for block in &mesh.blocks {
        let table = ShapeTable::new(block.element, degree(block.element));
        let (n, size) = (block.element.nodes.len(), size(block.element));
        let together = (KEPT / size).max(TASK);
        let mut kept = vec![0.0; size * together.min(block.len())];
        for nodes in block.nodes.chunks(n * together) {
            let kept = &mut kept[..nodes.len() / n * size];
            kept.par_chunks_mut(TASK * size).zip(nodes.par_chunks(TASK * n)).enumerate().for_each_init(
                || CellPoint::new(mesh, block, &table, strains),
                |cell, (task, (kept, nodes))| {
                    kept.fill(0.0);
                    cell.first = points + task * TASK * table.len();
                    for (out, nodes) in kept.chunks_exact_mut(size).zip(nodes.chunks_exact(n)) {
                        cell.nodes = nodes;
                        form(cell, out);
                        cell.first += table.len();
                    }
                },
            );
            add(nodes, n, kept);
            points += nodes.len() / n * table.len();
        }
    }
}

/// The matrix that sums `form(cell, blocks of the cell)` over all cells; block (i, j) of a cell of n nodes is number i
/// n + j.
pub(super) fn assemble(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    shape: (usize, usize),
    degree: impl Fn(&Element) -> usize,
    strains: Option<&[Dilatation]>,
    form: impl Fn(&mut CellPoint, &mut [f64]) + Sync,
) -> BlockMatrix {
    let mut matrix = BlockMatrix::zero(graph, shape.0, shape.1);
    by_cells(
        mesh,
        degree,
        strains,
        |e| e.nodes.len() * e.nodes.len() * shape.0 * shape.1,
        form,
        |nodes, n, kept| matrix.add_cells(nodes, n, kept),
    );
    matrix
}
