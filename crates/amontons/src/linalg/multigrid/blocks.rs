//! Sparse matrices of rectangular blocks, and their products with vectors.

#![allow(clippy::inline_always, reason = "a loop is compiled for the vector instructions of the function it is in")]

use std::ops::Range;

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::linalg::pages::PagedNumbers;

/// Block rows per task: large enough to pay for a task, the same for any number of threads.
pub(super) const CHUNK: usize = 1024;

/// Type of the matrix entries: single or double precision.
pub(super) trait Real:
    bytemuck::Pod
    + Default
    + Send
    + Sync
    + std::ops::Add<Output = Self>
    + std::ops::Mul<Output = Self>
    + std::ops::AddAssign
    + 'static
{
}

impl Real for f32 {}
impl Real for f64 {}

/// A matrix of R × C blocks in compressed block rows.
#[derive(Clone, Debug)]
pub(super) struct BlockRowMatrix<T: Real> {
    /// Number of rows and columns per block.
    pub shape: [usize; 2],
    /// Number of block columns.
    pub width: usize,
    pub start: Vec<u32>,
    pub columns: Vec<u32>,
    /// Blocks by rows.
    pub values: PagedNumbers<T>,
}

/// Block pattern: the start of each row, with the end of the last, and the columns of the blocks.
#[derive(Clone, Copy)]
pub(super) struct BlockPattern<'a> {
    pub start: &'a [u32],
    pub columns: &'a [u32],
}

impl<'a> BlockPattern<'a> {
    /// Number of block rows.
    pub fn len(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// Columns of the blocks of a row.
    pub fn row(&self, i: usize) -> &'a [u32] {
        &self.columns[self.start[i] as usize..self.start[i + 1] as usize]
    }
}

/// Splits values into parts of `rows` rows: their numbers and their blocks of `size` entries. `start` has the first
/// block of each row.
pub(super) fn parted<'v, T>(
    mut values: &'v mut [T],
    start: &[u32],
    size: usize,
    rows: usize,
) -> Vec<(Range<usize>, &'v mut [T])> {
    let count = start.len().saturating_sub(1);
    let part = |first: usize| {
        let last = (first + rows).min(count);
        let (own, others) = std::mem::take(&mut values).split_at_mut((start[last] - start[first]) as usize * size);
        values = others;
        (first..last, own)
    };
    (0..count).step_by(rows).map(part).collect()
}

impl<T: Real> BlockRowMatrix<T> {
    /// Number of block rows.
    pub fn len(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// Blocks of a block row, with their block columns.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, &[T])> {
        let (from, to) = (self.start[i] as usize, self.start[i + 1] as usize);
        let size = self.shape[0] * self.shape[1];
        let columns = self.columns[from..to].iter().map(|&j| j as usize);
        columns.zip(self.values[from * size..to * size].chunks_exact(size.max(1)))
    }

    /// Assembles a matrix from rows that `make` builds, a chunk of rows at a time.
    pub fn from_rows<F>(rows: usize, width: usize, shape: [usize; 2], make: F) -> BlockRowMatrix<T>
    where
        F: Fn(Range<usize>) -> BlockRowBuilder<T> + Sync,
    {
        let chunks: Vec<BlockRowBuilder<T>> =
            (0..rows.div_ceil(CHUNK)).into_par_iter().map(|c| make(c * CHUNK..((c + 1) * CHUNK).min(rows))).collect();
        let (mut start, mut columns) = (Vec::with_capacity(rows + 1), Vec::new());
        start.push(0u32);
        columns.reserve_exact(chunks.iter().map(|c| c.columns.len()).sum());
        let count = chunks.iter().map(|c| c.values.len()).sum();
        let values = PagedNumbers::of(count, |values| {
            let mut rest = values;
            for chunk in chunks {
                let before = columns.len() as u32;
                start.extend(chunk.ends.iter().map(|end| before + end));
                columns.extend(chunk.columns);
                let (own, others) = rest.split_at_mut(chunk.values.len());
                own.copy_from_slice(&chunk.values);
                rest = others;
            }
        });
        BlockRowMatrix { shape, width, start, columns, values }
    }

    /// The transposed matrix.
    pub fn transposed(&self) -> BlockRowMatrix<T> {
        let [r, c] = self.shape;
        let mut start = vec![0u32; self.width + 1];
        for &j in &self.columns {
            start[j as usize + 1] += 1;
        }
        for j in 0..self.width {
            start[j + 1] += start[j];
        }
        let mut filled = start.clone();
        let mut columns = vec![0u32; self.columns.len()];
        let values = PagedNumbers::of(self.values.len(), |values| {
            for i in 0..self.len() {
                for (j, block) in self.row(i) {
                    let slot = filled[j] as usize;
                    filled[j] += 1;
                    columns[slot] = i as u32;
                    let out = &mut values[slot * r * c..][..r * c];
                    for a in 0..r {
                        for b in 0..c {
                            out[b * r + a] = block[a * c + b];
                        }
                    }
                }
            }
        });
        BlockRowMatrix { shape: [c, r], width: self.len(), start, columns, values }
    }

    /// Creates a matrix with this block pattern, initially zero. `fill` gets some rows and writes their blocks in
    /// place.
    pub fn filled<F>(
        shape: [usize; 2],
        width: usize,
        (start, columns): (Vec<u32>, Vec<u32>),
        fill: F,
    ) -> BlockRowMatrix<T>
    where
        F: Fn(Range<usize>, &mut [T]) + Sync,
    {
        let size = shape[0] * shape[1];
        let values = PagedNumbers::of(columns.len() * size, |values| {
            let parts = parted(values, &start, size, CHUNK);
            parts.into_par_iter().for_each(|(rows, values)| fill(rows, values));
        });
        BlockRowMatrix { shape, width, start, columns, values }
    }

    /// Pattern of the blocks.
    pub fn places(&self) -> BlockPattern<'_> {
        BlockPattern { start: &self.start, columns: &self.columns }
    }

    /// Computes y = A x, or y += A x if `adds`.
    pub fn apply(&self, x: &[T], y: &mut [T], adds: bool) {
        let [r, c] = self.shape;
        let row = |i: usize| {
            let (from, to) = (self.start[i] as usize, self.start[i + 1] as usize);
            (&self.columns[from..to], &self.values[from * r * c..to * r * c])
        };
        multiply(self.shape, row, x, y, adds);
    }
}

/// Computes y = A x, or y += A x if `adds`, for a matrix of blocks of this shape; a row is given by the columns of its
/// blocks and the blocks one after the other.
pub(super) fn multiply<'a, T: Real>(
    shape: [usize; 2],
    row: impl Fn(usize) -> (&'a [u32], &'a [T]) + Sync,
    x: &[T],
    y: &mut [T],
    adds: bool,
) {
    match shape {
        [1, 1] => product::<T, 1, 1>(row, x, y, adds),
        [2, 2] => product::<T, 2, 2>(row, x, y, adds),
        [3, 3] => product::<T, 3, 3>(row, x, y, adds),
        [6, 6] => product::<T, 6, 6>(row, x, y, adds),
        [2, 3] => product::<T, 2, 3>(row, x, y, adds),
        [3, 2] => product::<T, 3, 2>(row, x, y, adds),
        [3, 6] => product::<T, 3, 6>(row, x, y, adds),
        [6, 3] => product::<T, 6, 3>(row, x, y, adds),
        [r, c] => {
            for (i, out) in y.chunks_exact_mut(r.max(1)).enumerate() {
                if !adds {
                    out.fill(T::default());
                }
                let (columns, blocks) = row(i);
                for (&j, block) in columns.iter().zip(blocks.chunks_exact((r * c).max(1))) {
                    add_product(block, &x[j as usize * c..][..c], out, [r, c, 1]);
                }
            }
        }
    }
}

/// Computes y = A x, or y += A x if `adds`, with the block shape known at compile time.
fn product<'a, T: Real, const R: usize, const C: usize>(
    row: impl Fn(usize) -> (&'a [u32], &'a [T]) + Sync,
    x: &[T],
    y: &mut [T],
    adds: bool,
) {
    let ((x, _), (y, _)) = (x.as_chunks::<C>(), y.as_chunks_mut::<R>());
    y.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, y)| {
        Arch::new().dispatch(SomeRows { row: &row, first: chunk * CHUNK, x, y, adds });
    });
}

/// Rows of a product, beginning at row `first`.
struct SomeRows<'p, T, F, const R: usize, const C: usize> {
    row: &'p F,
    first: usize,
    x: &'p [[T; C]],
    y: &'p mut [[T; R]],
    adds: bool,
}

impl<'a, T: Real, F, const R: usize, const C: usize> NullaryFnOnce for SomeRows<'_, T, F, R, C>
where
    F: Fn(usize) -> (&'a [u32], &'a [T]),
{
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let SomeRows { row, first, x, y, adds } = self;
        for (k, y) in y.iter_mut().enumerate() {
            let (columns, blocks) = row(first + k);
            // One sum per entry of the block, so that the sums are independent.
            let mut sums = [[T::default(); C]; R];
            for (&j, block) in columns.iter().zip(blocks.chunks_exact(R * C)) {
                let x = &x[j as usize];
                for a in 0..R {
                    for b in 0..C {
                        sums[a][b] += block[a * C + b] * x[b];
                    }
                }
            }
            let before = if adds { *y } else { [T::default(); R] };
            for a in 0..R {
                y[a] = sums[a].iter().fold(before[a], |sum, part| sum + *part);
            }
        }
    }
}

impl BlockRowMatrix<f32> {
    /// Mutable block at (i, j), or `None` if the matrix has none there.
    pub fn block_mut(&mut self, i: usize, j: usize) -> Option<&mut [f32]> {
        let (from, to, size) = (self.start[i] as usize, self.start[i + 1] as usize, self.shape[0] * self.shape[1]);
        let at = self.columns[from..to].iter().position(|&column| column as usize == j)?;
        Some(&mut self.values[(from + at) * size..][..size])
    }
}

impl BlockRowMatrix<f64> {
    /// The matrix divided by `scale`, in single precision.
    pub fn single(&self, scale: f64) -> BlockRowMatrix<f32> {
        let (start, columns) = (self.start.clone(), self.columns.clone());
        BlockRowMatrix { shape: self.shape, width: self.width, start, columns, values: self.divided(scale) }
    }

    /// The matrix in single precision, in its place.
    pub fn into_single(self) -> BlockRowMatrix<f32> {
        let values = self.divided(1.0);
        let BlockRowMatrix { shape, width, start, columns, .. } = self;
        BlockRowMatrix { shape, width, start, columns, values }
    }

    fn divided(&self, scale: f64) -> PagedNumbers<f32> {
        PagedNumbers::of(self.values.len(), |single| {
            single.par_iter_mut().zip(&self.values[..]).for_each(|(single, value)| *single = (value / scale) as f32);
        })
    }
}

/// Adds A B to `out`, for blocks of r × m and m × c. The block sizes of bodies in the plane and in space are known to
/// the loops at compile time.
#[inline(always)]
pub(super) fn add_product<T: Real>(a: &[T], b: &[T], out: &mut [T], sizes: [usize; 3]) {
    match sizes {
        [_, 2, 3] => add_sized::<T, 2, 3>(a, b, out),
        [_, 3, 3] => add_sized::<T, 3, 3>(a, b, out),
        [_, 3, 6] => add_sized::<T, 3, 6>(a, b, out),
        [_, 6, 6] => add_sized::<T, 6, 6>(a, b, out),
        [r, m, c] => add_loops(a, b, out, [r, m, c]),
    }
}

#[inline(always)]
fn add_sized<T: Real, const M: usize, const C: usize>(a: &[T], b: &[T], out: &mut [T]) {
    let ((a, _), (b, _), (out, _)) = (a.as_chunks::<M>(), b.as_chunks::<C>(), out.as_chunks_mut::<C>());
    let b: &[[T; C]] = &b[..M];
    for (a, out) in a.iter().zip(out) {
        for k in 0..M {
            for j in 0..C {
                out[j] += a[k] * b[k][j];
            }
        }
    }
}

#[inline(always)]
fn add_loops<T: Real>(a: &[T], b: &[T], out: &mut [T], [r, m, c]: [usize; 3]) {
    for i in 0..r {
        for k in 0..m {
            let factor = a[i * m + k];
            for j in 0..c {
                out[i * c + j] += factor * b[k * c + j];
            }
        }
    }
}

/// Builder of some block rows.
#[derive(Clone, Debug)]
pub(super) struct BlockRowBuilder<T> {
    /// End of each row among the columns.
    pub ends: Vec<u32>,
    pub columns: Vec<u32>,
    pub values: Vec<T>,
}

impl<T> Default for BlockRowBuilder<T> {
    fn default() -> BlockRowBuilder<T> {
        BlockRowBuilder { ends: Vec::new(), columns: Vec::new(), values: Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::product::FINE;
    use super::*;

    fn sample(rows: usize, width: usize, shape: [usize; 2]) -> BlockRowMatrix<f64> {
        BlockRowMatrix::from_rows(rows, width, shape, |range| {
            let mut made = BlockRowBuilder::default();
            for i in range {
                for j in (0..width).filter(|j| (i * 5 + j * 3) % 4 == 0) {
                    made.columns.push(j as u32);
                    made.values.extend((0..shape[0] * shape[1]).map(|k| ((i * 7 + j * 11 + k * 3) % 13) as f64 - 6.0));
                }
                made.ends.push(made.columns.len() as u32);
            }
            made
        })
    }

    /// Products of whole numbers are exact: (A B) x = A (B x), and x·(A y) = (Aᵀ x)·y, for every block shape, with few
    /// rows and with those of several tasks.
    #[test]
    fn products_and_transposes() {
        let shapes = [[1, 1, 1], [2, 2, 3], [3, 3, 6], [6, 3, 6], [6, 6, 6], [3, 2, 2], [2, 3, 3], [4, 5, 2]];
        for ([r, m, c], rows) in shapes.into_iter().flat_map(|shape| [(shape, 9), (shape, 2 * CHUNK + 5)]) {
            let (a, b) = (sample(rows, 7, [r, m]), sample(7, 8, [m, c]));
            let x: Vec<f64> = (0..8 * c).map(|i| ((i * 5) % 7) as f64).collect();
            let (mut bx, mut abx, mut both) = (vec![0.0; 7 * m], vec![1.0; rows * r], vec![1.0; rows * r]);
            b.apply(&x, &mut bx, false);
            a.apply(&bx, &mut abx, true);
            let product = a.times(&b);
            product.apply(&x, &mut both, true);
            let wrong = abx.iter().zip(&both).position(|(one, other)| (one - other).abs() > 0.0);
            assert_eq!(wrong, None, "{r} {m} {c}, {rows} rows");
            for i in 0..rows {
                let columns: std::collections::HashSet<usize> = product.row(i).map(|(j, _)| j).collect();
                assert_eq!(columns.len(), product.row(i).count(), "a column stands twice in row {i}");
            }
            let y: Vec<f64> = (0..rows * r).map(|i| ((i * 3) % 5) as f64).collect();
            let (mut ay, mut aty) = (vec![0.0; rows * r], vec![0.0; 7 * m]);
            a.apply(&bx, &mut ay, false);
            a.transposed().apply(&y, &mut aty, false);
            let dot = |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(p, q)| p * q).sum::<f64>();
            assert_eq!(dot(&ay, &y).to_bits(), dot(&bx, &aty).to_bits(), "{r} {m} {c}");
        }
    }

    /// Pᵀ A P equals two products one after the other, to the bit, with few rows and with those of several parts of A
    /// P; A couples neighbours.
    #[test]
    fn a_coarse_matrix_is_that_of_two_products() {
        for (rows, [r, m]) in [(9, [3, 6]), (2 * CHUNK + 5, [3, 3]), (2 * FINE + 5, [1, 1]), (FINE + 1, [2, 3])] {
            let matrix = BlockRowMatrix::from_rows(rows, rows, [r, r], |range| {
                let mut made = BlockRowBuilder::default();
                for i in range {
                    for j in i.saturating_sub(2)..(i + 3).min(rows) {
                        made.columns.push(j as u32);
                        made.values.extend((0..r * r).map(|k| ((i * 3 + j * 7 + k * 5) % 11) as f64 - 5.0));
                    }
                    made.ends.push(made.columns.len() as u32);
                }
                made
            });
            let prolongation = sample(rows, 7, [r, m]);
            let restriction = prolongation.transposed();
            let around = restriction.around(&matrix, &prolongation);
            let apart = restriction.times(&matrix.times(&prolongation));
            assert_eq!((around.shape, &around.start, &around.columns), (apart.shape, &apart.start, &apart.columns));
            let wrong =
                around.values.iter().zip(&apart.values[..]).position(|(one, other)| one.to_bits() != other.to_bits());
            assert_eq!(wrong, None, "{rows} rows");
        }
    }
}
