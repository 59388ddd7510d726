//! Products of sparse block matrices, for building the levels.
//!
//! Every sum is taken in the order of the columns, whatever the number of threads.

#![allow(clippy::inline_always, reason = "a loop is compiled for the vector instructions of the function it is in")]

use std::ops::Range;

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::blocks::{BlockPattern, BlockRowMatrix, CHUNK, Real, add_product, parted};
use crate::linalg::pages::PagedNumbers;

/// Block rows of A P that are computed at once, and block rows of R A P per task to which they are added.
pub(super) const FINE: usize = 8192;
const COARSE: usize = 64;

impl<T: Real> BlockRowMatrix<T> {
    /// The product with another matrix.
    pub fn times(&self, other: &BlockRowMatrix<T>) -> BlockRowMatrix<T> {
        let (start, columns) = pattern(self.places(), other.places(), other.width);
        let (places, shape) = (BlockPattern { start: &start, columns: &columns }, [self.shape[0], other.shape[1]]);
        let values = PagedNumbers::of(columns.len() * shape[0] * shape[1], |values| {
            self.rows_of_product(other, places, 0..self.len(), values);
        });
        BlockRowMatrix { shape, width: other.width, start, columns, values }
    }

    /// Coarse matrix R A P, with R this matrix, whose columns ascend in each row. Some rows of A P are computed at a
    /// time: the whole of it would be the largest matrix of all.
    pub fn around(&self, matrix: &BlockRowMatrix<T>, prolongation: &BlockRowMatrix<T>) -> BlockRowMatrix<T> {
        let width = prolongation.width;
        let (middle, of_middle) = (pattern(matrix.places(), prolongation.places(), width), matrix.shape[0]);
        let middle = BlockPattern { start: &middle.0, columns: &middle.1 };
        let (start, columns) = pattern(self.places(), middle, width);
        let (places, shape) =
            (BlockPattern { start: &start, columns: &columns }, [self.shape[0], prolongation.shape[1]]);
        let values = PagedNumbers::of(columns.len() * shape[0] * shape[1], |values| {
            let mut next = self.start[..self.len()].to_vec();
            let parts = parted(values, &start, shape[0] * shape[1], COARSE);
            let mut parts: Vec<_> = parts.into_iter().zip(next.chunks_mut(COARSE)).collect();
            let mut made = Vec::new();
            for first in (0..matrix.len()).step_by(FINE) {
                let last = (first + FINE).min(matrix.len());
                let [from, to] = [first, last].map(|i| middle.start[i]);
                made.clear();
                made.resize((to - from) as usize * of_middle * shape[1], T::default());
                matrix.rows_of_product(prolongation, middle, first..last, &mut made);
                let right = RightFactor { places: middle, values: &made, first: from, shape: [of_middle, shape[1]] };
                let add = |slot_of: &mut Vec<u32>, ((rows, out), next): &mut ((Range<usize>, &mut [T]), &mut [u32])| {
                    let (rows, end) = (rows.clone(), last as u32);
                    Arch::new().dispatch(Product { left: self, right, places, rows, next, end, slot_of, out });
                };
                parts.par_iter_mut().for_each_init(|| vec![0; width], add);
            }
        });
        BlockRowMatrix { shape, width, start, columns, values }
    }

    /// Adds some rows of the product with another matrix to `out`; `places` is the pattern of the product.
    fn rows_of_product(&self, other: &BlockRowMatrix<T>, places: BlockPattern, rows: Range<usize>, out: &mut [T]) {
        let right = RightFactor { places: other.places(), values: &other.values, first: 0, shape: other.shape };
        let parts = parted(out, &places.start[rows.start..=rows.end], self.shape[0] * other.shape[1], CHUNK);
        parts.into_par_iter().for_each(|(part, out)| {
            let rows = rows.start + part.start..rows.start + part.end;
            let (next, slot_of) = (&mut self.start[rows.clone()].to_vec(), &mut vec![0; other.width]);
            let end = other.len() as u32;
            Arch::new().dispatch(Product { left: self, right, places, rows, next, end, slot_of, out });
        });
    }
}

/// Pattern of the product of two matrices: the start of each row, and the columns of its blocks.
fn pattern(left: BlockPattern, right: BlockPattern, width: usize) -> (Vec<u32>, Vec<u32>) {
    let of_chunk = |chunk: usize| {
        // The last row in which each column was seen, counted from one.
        let mut seen = vec![0u32; width];
        let (mut lengths, mut columns) = (Vec::with_capacity(CHUNK), Vec::new());
        for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(left.len()) {
            let before = columns.len();
            for &j in left.row(i).iter().flat_map(|&k| right.row(k as usize)) {
                if std::mem::replace(&mut seen[j as usize], i as u32 + 1) != i as u32 + 1 {
                    columns.push(j);
                }
            }
            lengths.push((columns.len() - before) as u32);
        }
        (lengths, columns)
    };
    let chunks: Vec<(Vec<u32>, Vec<u32>)> = (0..left.len().div_ceil(CHUNK)).into_par_iter().map(of_chunk).collect();
    let (mut start, mut columns, mut end) = (Vec::with_capacity(left.len() + 1), Vec::new(), 0);
    start.push(0);
    columns.reserve_exact(chunks.iter().map(|(_, columns)| columns.len()).sum());
    for (lengths, own) in chunks {
        columns.extend(own);
        start.extend(lengths.iter().map(|length| {
            end += length;
            end
        }));
    }
    (start, columns)
}

/// Second matrix of a product, or some rows of it: their values begin with the block `first`.
#[derive(Clone, Copy)]
struct RightFactor<'a, T> {
    places: BlockPattern<'a>,
    values: &'a [T],
    first: u32,
    shape: [usize; 2],
}

/// Some rows of a product.
struct Product<'a, T: Real> {
    left: &'a BlockRowMatrix<T>,
    right: RightFactor<'a, T>,
    /// Pattern of the product.
    places: BlockPattern<'a>,
    rows: Range<usize>,
    /// Next block per row of the first matrix; those in columns before `end` are multiplied.
    next: &'a mut [u32],
    end: u32,
    /// Place in the current row per column.
    slot_of: &'a mut [u32],
    out: &'a mut [T],
}

impl<T: Real> NullaryFnOnce for Product<'_, T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Product { left, right, places, rows, next, end, slot_of, out } = self;
        let sizes @ [r, m, c] = [left.shape[0], left.shape[1], right.shape[1]];
        let first = places.start[rows.start];
        for (i, next) in rows.zip(next) {
            let own = |at: u32| left.columns[at as usize];
            let to = left.start[i + 1];
            if *next == to || own(*next) >= end {
                continue;
            }
            for (slot, &j) in (places.start[i] - first..).zip(places.row(i)) {
                slot_of[j as usize] = slot;
            }
            while *next < to && own(*next) < end {
                let (a, k) = (&left.values[*next as usize * r * m..][..r * m], own(*next) as usize);
                let from = (right.places.start[k] - right.first) as usize * m * c;
                for (&j, b) in right.places.row(k).iter().zip(right.values[from..].chunks_exact(m * c)) {
                    add_product(a, b, &mut out[slot_of[j as usize] as usize * r * c..][..r * c], sizes);
                }
                *next += 1;
            }
        }
    }
}
