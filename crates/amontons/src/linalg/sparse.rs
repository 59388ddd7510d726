//! Block-sparse matrices on the graph of the nodes.
//!
//! The products are compiled for the vector instructions of the machine; every sum has the same order on all machines
//! and with any number of threads.
#![allow(clippy::inline_always, reason = "a loop is compiled for the vector instructions of the function it is in")]

use std::sync::Arc;

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::graph::{Graph, bodies, leaders};
use super::pages::PagedNumbers;
use super::repeats;
use super::vectors::{max_abs, zeros};
use crate::mesh::Link;
use crate::space::{NodeFrame, RigidNodes};
use crate::tensor::Point;

/// A matrix of R × C blocks, one per pair of nodes that share a cell; the entry of components (r, c) of the nodes (i,
/// j) is in row `i R + r` and column `j C + c`.
#[derive(Clone, Debug)]
pub struct BlockMatrix {
    graph: Arc<Graph>,
    rows: usize,
    cols: usize,
    /// Shared with copies until one of them changes.
    values: Arc<PagedNumbers>,
    /// Values that products read in place of `values`, if rows repeat.
    repeated: Option<Arc<Repeated>>,
    /// True if A x = 0 for every x that is the same at all nodes.
    of_differences: bool,
}

/// Row values per node, with repeated rows stored once, and the start of each row.
#[derive(Clone, Debug)]
struct Repeated {
    start: Vec<u32>,
    values: Vec<f64>,
}

/// Number of nodes per task: large enough to pay for a task.
pub(super) const CHUNK: usize = 2048;

impl BlockMatrix {
    /// True if another matrix has the same entries at the same places, to the bit.
    #[must_use]
    pub fn is_same(&self, other: &BlockMatrix) -> bool {
        let shape = |of: &BlockMatrix| (of.rows, of.cols, of.values.len(), of.of_differences);
        shape(self) == shape(other)
            && (Arc::ptr_eq(&self.graph, &other.graph) || self.graph == other.graph)
            && (Arc::ptr_eq(&self.values, &other.values)
                || self.values.iter().zip(other.values.iter()).all(|(a, b)| a.to_bits() == b.to_bits()))
    }

    /// The zero matrix of `rows` × `cols` blocks.
    #[must_use]
    pub fn zero(graph: &Arc<Graph>, rows: usize, cols: usize) -> BlockMatrix {
        BlockMatrix {
            graph: Arc::clone(graph),
            rows,
            cols,
            values: Arc::new(PagedNumbers::of(graph.columns.len() * rows * cols, |_| {})),
            repeated: None,
            of_differences: false,
        }
    }

    /// Declares that the form depends on differences of x only (x enters by its gradient). Products are then summed as
    /// Σ A_ij (x_j − x_i), whose round-off is that of the differences, 1/h times smaller.
    #[must_use]
    pub fn of_differences(mut self) -> BlockMatrix {
        self.of_differences = true;
        self
    }

    /// Prepares for many products: repeated rows are read from one place, which is then in the caches. A later change
    /// of the matrix undoes this.
    #[must_use]
    pub fn repeated(mut self) -> BlockMatrix {
        let rows = repeats::rows(self.graph.len(), |i| self.row_values(i));
        self.repeated = rows.map(|(start, values)| Arc::new(Repeated { start, values }));
        self
    }

    /// True if products are summed over differences.
    #[must_use]
    pub fn is_of_differences(&self) -> bool {
        self.of_differences
    }

    /// Number of rows and columns per block.
    #[must_use]
    pub fn block_shape(&self) -> (usize, usize) {
        (self.rows, self.cols)
    }

    /// The graph of the nodes.
    #[must_use]
    pub fn graph(&self) -> &Arc<Graph> {
        &self.graph
    }

    /// Adds the matrix of a cell, row-major over (node, component), to the blocks of its nodes.
    pub fn add(&mut self, nodes: &[u32], cell: &[f64]) {
        self.repeated = None;
        let (width, values) = (nodes.len() * self.cols, Arc::make_mut(&mut self.values));
        for (a, &i) in nodes.iter().enumerate() {
            for (b, &j) in nodes.iter().enumerate() {
                let Some(slot) = self.graph.slot(i as usize, j) else { continue };
                let block = &mut values[slot * self.rows * self.cols..][..self.rows * self.cols];
                for r in 0..self.rows {
                    for c in 0..self.cols {
                        block[r * self.cols + c] += cell[(a * self.rows + r) * width + b * self.cols + c];
                    }
                }
            }
        }
    }

    /// Adds a multiple of values, by column, to the row of node `i` of a form on scalars.
    pub(super) fn add_to_row(&mut self, i: usize, factor: f64, row: impl Iterator<Item = (u32, f64)>) {
        self.repeated = None;
        let values = Arc::make_mut(&mut self.values);
        for (j, value) in row {
            if let Some(slot) = self.graph.slot(i, j) {
                values[slot] += factor * value;
            }
        }
    }

    /// Multiplies the values of the row of node `i` of a form on scalars, by column.
    pub fn scale_row(&mut self, i: usize, factor: impl Fn(u32) -> f64) {
        self.repeated = None;
        let (values, first) = (Arc::make_mut(&mut self.values), self.graph.start[i]);
        for (k, &j) in self.graph.row(i).iter().enumerate() {
            values[first + k] *= factor(j);
        }
    }

    /// Adds the matrices of many cells of `n` nodes each, one after the other, by blocks: block (i, j) of a cell is its
    /// number i n + j. Each thread takes some rows: an entry is summed in the order of the cells, whatever the number
    /// of threads.
    pub fn add_cells(&mut self, nodes: &[u32], n: usize, cells: &[f64]) {
        self.repeated = None;
        let (size, graph) = (self.rows * self.cols, &*self.graph);
        let add = |first: usize, last: usize, values: &mut [f64]| {
            let from = graph.start[first];
            for (nodes, cell) in nodes.chunks_exact(n).zip(cells.chunks_exact(n * n * size)) {
                for (&i, row) in nodes.iter().zip(cell.chunks_exact(n * size)) {
                    if !(first..last).contains(&(i as usize)) {
                        continue;
                    }
                    for (&j, block) in nodes.iter().zip(row.chunks_exact(size)) {
                        let Some(slot) = graph.slot(i as usize, j) else { continue };
                        for (out, value) in values[(slot - from) * size..][..size].iter_mut().zip(block) {
                            *out += value;
                        }
                    }
                }
            }
        };
        let (Some(&least), Some(&most)) = (nodes.iter().min(), nodes.iter().max()) else { return };
        let (mut first, end, parts) = (least as usize, most as usize + 1, rayon::current_num_threads());
        let (from, to) = (graph.start[first], graph.start[end]);
        let mut rest = &mut Arc::make_mut(&mut self.values)[from * size..to * size];
        rayon::scope(|scope| {
            for part in 1..=parts {
                // Rows are divided so that every part has about as many entries.
                let last = if part == parts {
                    end
                } else {
                    graph.start.partition_point(|&s| s < from + (to - from) / parts * part).clamp(first, end)
                };
                let (own, others) =
                    std::mem::take(&mut rest).split_at_mut((graph.start[last] - graph.start[first]) * size);
                rest = others;
                scope.spawn(move |_| add(first, last, own));
                first = last;
            }
        });
    }

    /// A multiple of the matrix.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> BlockMatrix {
        let mut scaled = BlockMatrix { repeated: None, ..self.clone() };
        Arc::make_mut(&mut scaled.values).iter_mut().for_each(|value| *value *= factor);
        scaled
    }

    /// The largest magnitude of an entry.
    #[must_use]
    pub fn largest(&self) -> f64 {
        max_abs(&self.values)
    }

    /// Adds `factor` times a matrix on the same graph: of the same block shape, or of 1 × 1 blocks,
    /// which then act on each component.
    pub fn add_scaled(&mut self, factor: f64, other: &BlockMatrix) {
        if factor == 0.0 {
            return;
        }
        (self.repeated, self.of_differences) = (None, self.of_differences && other.of_differences);
        let size = self.rows * self.cols;
        if other.rows * other.cols == size {
            for (a, b) in Arc::make_mut(&mut self.values).iter_mut().zip(other.values.iter()) {
                *a += factor * b;
            }
        } else {
            for (block, b) in Arc::make_mut(&mut self.values).chunks_exact_mut(size).zip(other.values.iter()) {
                for r in 0..self.rows {
                    block[r * self.cols + r] += factor * b;
                }
            }
        }
    }

    /// The matrix Q A Qᵀ of the components along the directions of the nodes, the rows of Q; A itself without
    /// directions.
    #[must_use]
    pub fn in_frames(self: &Arc<BlockMatrix>, frames: &[NodeFrame]) -> Arc<BlockMatrix> {
        if frames.is_empty() {
            return Arc::clone(self);
        }
        let (mut turned, n) =
            (BlockMatrix { repeated: None, of_differences: false, ..BlockMatrix::clone(self) }, self.rows);
        let values = Arc::make_mut(&mut turned.values);
        for NodeFrame { node, axes } in frames {
            let own = self.graph.start[*node as usize];
            for (k, &j) in self.graph.row(*node as usize).iter().enumerate() {
                let block = &mut values[(own + k) * n * n..][..n * n];
                let old = block.to_vec();
                for (at, value) in block.iter_mut().enumerate() {
                    *value = (0..n).map(|d| axes[at / n][d] * old[d * n + at % n]).sum();
                }
                let Some(other) = self.graph.slot(j as usize, *node) else { continue };
                let block = &mut values[other * n * n..][..n * n];
                let old = block.to_vec();
                for (at, value) in block.iter_mut().enumerate() {
                    *value = (0..n).map(|d| axes[at % n][d] * old[at / n * n + d]).sum();
                }
            }
        }
        Arc::new(turned)
    }

    /// The matrix Tᵀ A T, in which T gives following nodes the components of the nodes that they follow; A itself
    /// without such nodes. The row of a following node has its diagonal block alone.
    #[must_use]
    pub fn linked(self: &Arc<BlockMatrix>, links: &[Link]) -> Arc<BlockMatrix> {
        if links.is_empty() {
            return Arc::clone(self);
        }
        let leaders = leaders(self.graph.len(), links);
        let mut joined = BlockMatrix::zero(&Arc::new(self.graph.linked(links)), self.rows, self.cols);
        let (size, values) = (self.rows * self.cols, Arc::make_mut(&mut joined.values));
        for (i, &to) in leaders.iter().enumerate() {
            for (j, block) in self.row(i) {
                if let Some(slot) = joined.graph.slot(to as usize, leaders[j]) {
                    values[slot * size..][..size].iter_mut().zip(block).for_each(|(sum, value)| *sum += value);
                }
                if i == j
                    && to as usize != i
                    && let Some(slot) = joined.graph.slot(i, i as u32)
                {
                    values[slot * size..][..size].copy_from_slice(block);
                }
            }
        }
        Arc::new(joined)
    }

    /// The matrix Tᵀ A T, in which T maps the motions of rigid bodies to the values at their nodes; A itself without
    /// such bodies. The motions take the place of the first nodes, and the rows of the others have their diagonal
    /// blocks alone; a place without a motion has its own entry on the diagonal.
    #[must_use]
    pub fn rigid(self: &Arc<BlockMatrix>, rigid: &[RigidNodes]) -> Arc<BlockMatrix> {
        if rigid.is_empty() {
            return Arc::clone(self);
        }
        let n = self.rows;
        let body_of = bodies(self.graph.len(), rigid);
        let mut joined = BlockMatrix::zero(&Arc::new(self.graph.rigid(rigid)), n, n);
        // Per node: its own degrees of freedom with the unit vectors, or those of its body with the motions.
        let of_node = |node: usize| -> Vec<(usize, Point)> {
            let body = body_of[node].map(|body| &rigid[body as usize]);
            match body.and_then(|body| Some((body, body.position(node as u32)?))) {
                Some((body, position)) => {
                    body.at(position).enumerate().map(|(j, motion)| (body.dof(j), motion)).collect()
                }
                None => (0..n).map(|c| (node * n + c, std::array::from_fn(|d| f64::from(u8::from(c == d))))).collect(),
            }
        };
        let values = Arc::make_mut(&mut joined.values);
        for i in 0..self.graph.len() {
            let is_slot = |body: u32| rigid[body as usize].slots().contains(&(i as u32));
            let rows = of_node(i);
            for (j, block) in self.row(i) {
                if body_of[i].is_none() && body_of[j].is_none() {
                    if let Some(slot) = joined.graph.slot(i, j as u32) {
                        values[slot * n * n..][..n * n].copy_from_slice(block);
                    }
                    continue;
                }
                if i == j
                    && body_of[i].is_some_and(|body| !is_slot(body))
                    && let Some(slot) = joined.graph.slot(i, i as u32)
                {
                    values[slot * n * n..][..n * n].copy_from_slice(block);
                }
                let columns = of_node(j);
                for (row, left) in &rows {
                    let along: Vec<f64> = (0..n).map(|c| (0..n).map(|r| left[r] * block[r * n + c]).sum()).collect();
                    for (column, right) in &columns {
                        let Some(slot) = joined.graph.slot(row / n, (column / n) as u32) else { continue };
                        values[slot * n * n + row % n * n + column % n] +=
                            along.iter().zip(right).map(|(a, b)| a * b).sum::<f64>();
                    }
                }
            }
        }
        for body in rigid {
            for (node, c) in (body.motions.len()..body.slots().len() * n).map(|j| (body.slots()[j / n] as usize, j % n))
            {
                if let Some(slot) = joined.graph.slot(node, node as u32) {
                    values[(slot * n + c) * n + c] = self.get(node, c, node, c);
                }
            }
        }
        Arc::new(joined)
    }

    /// Entry of components (r, c) of the nodes (i, j); zero if they share no cell.
    #[must_use]
    pub fn get(&self, i: usize, r: usize, j: usize, c: usize) -> f64 {
        self.graph.slot(i, j as u32).map_or(0.0, |slot| self.values[(slot * self.rows + r) * self.cols + c])
    }

    /// The blocks of the row of node `i`: neighbour and row-major block.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, &[f64])> {
        let blocks = self.row_values(i).chunks_exact((self.rows * self.cols).max(1));
        self.graph.row(i).iter().map(|&j| j as usize).zip(blocks)
    }

    /// The blocks of the row of node `i`, one after the other.
    fn row_values(&self, i: usize) -> &[f64] {
        let size = self.rows * self.cols;
        &self.values[self.graph.start[i] * size..self.graph.start[i + 1] * size]
    }

    /// The blocks of the row of node `i` as products read them, one after the other.
    #[inline(always)]
    pub(super) fn row_read(&self, i: usize) -> &[f64] {
        let size = (self.graph.start[i + 1] - self.graph.start[i]) * self.rows * self.cols;
        match &self.repeated {
            Some(repeated) => &repeated.values[repeated.start[i] as usize..][..size],
            None => &self.values[self.graph.start[i] * self.rows * self.cols..][..size],
        }
    }

    /// y ← A x. Every row is summed in the order of its columns, whatever the number of threads.
    ///
    /// A matrix of 1 × 1 blocks acts on each of the `components` of `x` per node.
    #[must_use]
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        let components = if self.rows * self.cols == 1 { x.len() / self.graph.len().max(1) } else { 1 };
        let mut y = zeros(self.graph.len() * self.rows * components);
        let width = self.rows * components;
        y.par_chunks_mut((CHUNK * width).max(1)).enumerate().for_each(|(chunk, y)| {
            Arch::new().dispatch(SparseProductRows { matrix: self, first: chunk * CHUNK, components, x, y });
        });
        y
    }

    /// Aᵀ x, for blocks that are not 1 × 1 acting on vectors. The sum is taken in the order of the rows.
    #[must_use]
    pub fn apply_transposed(&self, x: &[f64]) -> Vec<f64> {
        let (rows, cols) = (self.rows, self.cols);
        let mut y = zeros(self.graph.len() * cols);
        for (i, x) in x.chunks_exact(rows.max(1)).enumerate() {
            for (j, block) in self.row(i) {
                for (x, block) in x.iter().zip(block.chunks_exact(cols.max(1))) {
                    let at = y[j * cols..(j + 1) * cols].iter_mut();
                    at.zip(block).for_each(|(y, entry)| *y += entry * x);
                }
            }
        }
        y
    }

    /// Product rows for blocks of any shape; `x` has `components` values per column of a block.
    fn rows_of_any(&self, first: usize, components: usize, x: &[f64], y: &mut [f64]) {
        let (rows, cols) = (self.rows, self.cols);
        for (k, y) in y.chunks_exact_mut((rows * components).max(1)).enumerate() {
            let origin = if self.of_differences { first + k } else { usize::MAX };
            let at = |node: usize, c: usize| {
                x.get(node.wrapping_mul(cols * components).wrapping_add(c)).copied().unwrap_or(0.0)
            };
            for (j, block) in self.row(first + k) {
                for (r, c) in (0..rows).flat_map(|r| (0..cols).map(move |c| (r, c))) {
                    for part in 0..components {
                        let c_of = c * components + part;
                        let value = at(j, c_of) - if origin == usize::MAX { 0.0 } else { at(origin, c_of) };
                        y[r * components + part] += block[r * cols + c] * value;
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn rows_of<const R: usize, const C: usize>(&self, first: usize, x: &[f64], y: &mut [f64]) {
        let (x, _) = x.as_chunks::<C>();
        let (y, _) = y.as_chunks_mut::<R>();
        for (k, y) in y.iter_mut().enumerate() {
            let blocks = self.row_read(first + k).chunks_exact(R * C);
            let origin = if self.of_differences { x[first + k] } else { [0.0; C] };
            // One sum per entry of the block, so that the sums are independent.
            let mut sums = [[0.0; C]; R];
            for (&j, block) in self.graph.row(first + k).iter().zip(blocks) {
                let x = &x[j as usize];
                for r in 0..R {
                    for c in 0..C {
                        sums[r][c] += block[r * C + c] * (x[c] - origin[c]);
                    }
                }
            }
            *y = sums.map(|sums| sums.iter().sum());
        }
    }

    #[inline(always)]
    fn diagonal_rows_of<const C: usize>(&self, first: usize, x: &[f64], y: &mut [f64]) {
        let (x, _) = x.as_chunks::<C>();
        let (y, _) = y.as_chunks_mut::<C>();
        for (k, y) in y.iter_mut().enumerate() {
            let mut sum = [0.0; C];
            for (&j, value) in self.graph.row(first + k).iter().zip(self.row_read(first + k)) {
                for c in 0..C {
                    sum[c] += value * x[j as usize][c];
                }
            }
            *y = sum;
        }
    }

    /// Round-off in A x from the last bits of x: the largest sum of ε |A| |x| in a row. If large terms cancel, as in a
    /// body that has moved far, A x is no more accurate than this.
    #[must_use]
    pub fn round_off(&self, x: &[f64]) -> f64 {
        f64::EPSILON * max_abs(&self.magnitude(x))
    }

    /// |A| |x|: the magnitudes of the summands of A x.
    #[must_use]
    pub fn magnitude(&self, x: &[f64]) -> Vec<f64> {
        let components = if self.rows * self.cols == 1 { x.len() / self.graph.len().max(1) } else { 1 };
        let at = |node: usize, c: usize| x.get(node * self.cols * components + c).map_or(0.0, |x| x.abs());
        let width = self.rows * components;
        let mut sizes = zeros(self.graph.len() * width);
        sizes.par_chunks_mut((CHUNK * width).max(1)).enumerate().for_each(|(chunk, sizes)| {
            for (k, sizes) in sizes.chunks_exact_mut(width.max(1)).enumerate() {
                for (at_row, size) in sizes.iter_mut().enumerate() {
                    let (r, part) = (at_row / components, at_row % components);
                    let term = |(j, block): (usize, &[f64])| {
                        let terms =
                            (0..self.cols).map(|c| block[r * self.cols + c].abs() * at(j, c * components + part));
                        terms.sum::<f64>()
                    };
                    *size = self.row(chunk * CHUNK + k).map(term).sum();
                }
            }
        });
        sizes
    }

    /// Largest absolute difference to the transpose of `other`, relative to the largest entry.
    #[must_use]
    pub fn asymmetry(&self, other: &BlockMatrix) -> f64 {
        let largest = self.values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let mut difference: f64 = 0.0;
        for i in 0..self.graph.len() {
            for (j, block) in self.row(i) {
                for r in 0..self.rows {
                    for c in 0..self.cols {
                        difference = difference.max((block[r * self.cols + c] - other.get(j, c, i, r)).abs());
                    }
                }
            }
        }
        if largest > 0.0 { difference / largest } else { 0.0 }
    }
}

/// Some rows of a product, beginning at the row of node `first`.
struct SparseProductRows<'a> {
    matrix: &'a BlockMatrix,
    first: usize,
    components: usize,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl NullaryFnOnce for SparseProductRows<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let SparseProductRows { matrix, first, components, x, y } = self;
        match (matrix.rows, matrix.cols, components) {
            (1, 1, 1) => matrix.rows_of::<1, 1>(first, x, y),
            (1, 1, 2) => matrix.diagonal_rows_of::<2>(first, x, y),
            (1, 1, 3) => matrix.diagonal_rows_of::<3>(first, x, y),
            (2, 2, _) => matrix.rows_of::<2, 2>(first, x, y),
            (2, 1, _) => matrix.rows_of::<2, 1>(first, x, y),
            (1, 2, _) => matrix.rows_of::<1, 2>(first, x, y),
            (3, 3, _) => matrix.rows_of::<3, 3>(first, x, y),
            (3, 1, _) => matrix.rows_of::<3, 1>(first, x, y),
            (1, 3, _) => matrix.rows_of::<1, 3>(first, x, y),
            _ => matrix.rows_of_any(first, components, x, y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Block, Diagonal, Mesh, MeshError};

    #[test]
    fn products_agree_with_entries() -> Result<(), MeshError> {
        let mesh = Mesh::rectangle([1.0, 1.0], [3, 2], Diagonal::Left)?;
        let graph = Arc::new(Graph::of_mesh(&mesh));
        for (rows, cols) in [(1, 1), (2, 2), (2, 1), (1, 2), (3, 3), (4, 4), (2, 3)] {
            let mut a = BlockMatrix::zero(&graph, rows, cols);
            for (s, block) in mesh.blocks.iter().enumerate() {
                for (k, cell) in block.cells().enumerate() {
                    let values: Vec<f64> =
                        (0..9 * rows * cols).map(|v| ((v * 7 + k * 3 + s) % 11) as f64 - 4.0).collect();
                    a.add(cell, &values);
                }
            }
            let x: Vec<f64> = (0..graph.len() * cols).map(|i| (i as f64).sin()).collect();
            let y = a.apply(&x);
            for i in 0..graph.len() {
                for r in 0..rows {
                    let sum: f64 = (0..graph.len())
                        .flat_map(|j| (0..cols).map(move |c| (j, c)))
                        .map(|(j, c)| a.get(i, r, j, c) * x[j * cols + c])
                        .sum();
                    assert!((sum - y[i * rows + r]).abs() < 1e-12);
                }
            }
        }
        Ok(())
    }

    /// On an even mesh the rows of all interior nodes are the same, and a changed matrix is read without repetition.
    #[test]
    fn rows_that_repeat_are_read_from_one_place() -> Result<(), MeshError> {
        let even = |n: usize| Mesh::rectangle([1.0, 1.0], [n, n], Diagonal::Left);
        let filled = |mesh: &Mesh, blocks: usize| {
            let mut matrix = BlockMatrix::zero(&Arc::new(Graph::of_mesh(mesh)), blocks, blocks);
            for cell in mesh.blocks.iter().flat_map(Block::cells) {
                let values: Vec<f64> = (0..9 * blocks * blocks).map(|v| (v as f64 + 0.5).sin()).collect();
                matrix.add(cell, &values);
            }
            matrix
        };
        for blocks in [1, 2, 4] {
            let (mesh, small) = (even(16)?, even(3)?);
            let matrix = filled(&mesh, blocks);
            let mut repeated = matrix.clone().repeated();
            let different = repeated.repeated.as_ref().map(|rows| rows.values.len() / (blocks * blocks));
            // Three columns of each kind of node: corners, sides, interior.
            assert!(different.is_some_and(|blocks| blocks <= 9 * 7), "{different:?}");
            let x: Vec<f64> = (0..mesh.points.len() * blocks).map(|i| (i as f64).sin()).collect();
            assert_eq!(repeated.apply(&x), matrix.apply(&x));
            repeated.add_scaled(1.0, &matrix);
            assert_eq!(repeated.apply(&x), matrix.apply(&x).iter().map(|y| 2.0 * y).collect::<Vec<_>>());
            assert!(filled(&small, blocks).repeated().repeated.is_none());
        }
        Ok(())
    }
}
