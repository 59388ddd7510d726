//! A panel of dense columns of a factor, with its part of the forward and backward sweeps.
#![allow(clippy::inline_always, reason = "a loop is compiled for the vector instructions of the function it is in")]

use std::hint::black_box;
use std::ops::Range;

/// Largest number of entries of a panel whose cache lines are read in sequence before the sweep uses them: single
/// columns are too short for the processor to prefetch. They fit into the second-level cache.
const AHEAD: usize = 1 << 15;
/// Numbers per cache line.
const LINE: usize = 8;

/// A dense panel of the factor: columns `first..first + columns` of a vector, with the positions of the rows below them
/// in that vector.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    pub first: usize,
    pub columns: usize,
    /// Range of the rows below in the list of rows of all panels on that vector.
    pub below: Range<usize>,
    /// Start of its values: columns from the diagonal down, one after the other.
    pub values: usize,
    /// Length of the first column.
    pub leading: usize,
}

/// A range of consecutive positions.
#[derive(Clone, Copy, Debug)]
pub(super) struct PositionRange {
    first: u32,
    length: u32,
}

impl PositionRange {
    #[inline(always)]
    fn range(self) -> Range<usize> {
        self.first as usize..(self.first + self.length) as usize
    }

    /// Appends positions to a list and returns their range in it.
    pub fn append(positions: impl IntoIterator<Item = u32>, list: &mut Vec<PositionRange>) -> Range<usize> {
        let begin = list.len();
        for position in positions {
            match list[begin..].last_mut() {
                Some(run) if run.first + run.length == position => run.length += 1,
                _ => list.push(PositionRange { first: position, length: 1 }),
            }
        }
        begin..list.len()
    }
}

/// Σ c_i x_i, in four independent partial sums.
#[inline(always)]
fn dot(c: &[f64], x: &[f64]) -> f64 {
    let ((quads, rest), (x, x_rest)) = (c.as_chunks::<4>(), x.as_chunks::<4>());
    let mut lanes = [0.0; 4];
    for (c, x) in quads.iter().zip(x) {
        lanes = add_product(lanes, *c, *x);
    }
    let tail: f64 = rest.iter().zip(x_rest).map(|(c, x)| c * x).sum();
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]) + tail
}

/// Σ c_i x_i for four columns c, in four sums each: sixteen sums that stay in registers.
#[inline(always)]
fn dot4(c: [&[f64]; 4], x: &[f64]) -> [f64; 4] {
    let (quads, rest) = x.as_chunks::<4>();
    let m = quads.len();
    let (c0, c1) = (&c[0].as_chunks::<4>().0[..m], &c[1].as_chunks::<4>().0[..m]);
    let (c2, c3) = (&c[2].as_chunks::<4>().0[..m], &c[3].as_chunks::<4>().0[..m]);
    let (mut s0, mut s1, mut s2, mut s3) = ([0.0; 4], [0.0; 4], [0.0; 4], [0.0; 4]);
    for i in 0..m {
        s0 = add_product(s0, c0[i], quads[i]);
        s1 = add_product(s1, c1[i], quads[i]);
        s2 = add_product(s2, c2[i], quads[i]);
        s3 = add_product(s3, c3[i], quads[i]);
    }
    let mut sums = [0.0; 4];
    // Passed as one value: the compiler would otherwise work on the same lane of all four, which is slower.
    for (a, lanes) in black_box([s0, s1, s2, s3]).iter().enumerate() {
        sums[a] = (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
        for (c, x) in c[a][4 * m..].iter().zip(rest) {
            sums[a] += c * x;
        }
    }
    sums
}

#[inline(always)]
fn add_product(sum: [f64; 4], a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [sum[0] + a[0] * b[0], sum[1] + a[1] * b[1], sum[2] + a[2] * b[2], sum[3] + a[3] * b[3]]
}

impl Panel {
    /// Start of column j among the values of the panel.
    #[inline(always)]
    fn start(&self, j: usize) -> usize {
        j * self.leading - j * j.saturating_sub(1) / 2
    }

    /// The values of the panel.
    #[inline(always)]
    pub fn values<'a>(&self, values: &'a [f64]) -> &'a [f64] {
        &values[self.values..self.values + self.start(self.columns)]
    }

    /// The values of the panel, prefetched in the order in which the sweep reads them.
    #[inline(always)]
    pub fn values_ahead<'a>(&self, values: &'a [f64], is_forward: bool) -> &'a [f64] {
        let values = self.values(values);
        if values.len() <= AHEAD {
            let lines = values.chunks(LINE);
            let read = |seen: u64, line: &[f64]| seen | line[0].to_bits();
            black_box(if is_forward { lines.fold(0, read) } else { lines.rev().fold(0, read) });
        }
        values
    }

    /// Column j from its diagonal down.
    #[inline(always)]
    fn column<'a>(&self, values: &'a [f64], j: usize) -> &'a [f64] {
        let from = self.start(j);
        &values[from..from + self.leading - j]
    }

    /// Four columns from column j on.
    #[inline(always)]
    fn columns<'a>(&self, values: &'a [f64], j: usize) -> [&'a [f64]; 4] {
        [self.column(values, j), self.column(values, j + 1), self.column(values, j + 2), self.column(values, j + 3)]
    }

    /// Solves L y = r on the columns, and adds their contribution to the rows below.
    #[inline(always)]
    pub fn forward(&self, values: &[f64], rows: &[PositionRange], vector: &mut [f64], dense: &mut Vec<f64>) {
        let n = self.columns;
        dense.clear();
        dense.extend_from_slice(&vector[self.first..self.first + n]);
        dense.resize(self.leading, 0.0);
        let mut j = 0;
        while j + 4 <= n {
            let c = self.columns(values, j);
            let mut z = [0.0; 4];
            for a in 0..4 {
                let mut s = dense[j + a];
                for b in 0..a {
                    s -= z[b] * c[b][a - b];
                }
                z[a] = s / c[a][0];
            }
            dense[j..j + 4].copy_from_slice(&z);
            let tail = &mut dense[j + 4..];
            let m = tail.len();
            let (c0, c1, c2, c3) = (&c[0][4..][..m], &c[1][3..][..m], &c[2][2..][..m], &c[3][1..][..m]);
            for i in 0..m {
                tail[i] -= (z[0] * c0[i] + z[1] * c1[i]) + (z[2] * c2[i] + z[3] * c3[i]);
            }
            j += 4;
        }
        while j < n {
            let c = self.column(values, j);
            let z = dense[j] / c[0];
            dense[j] = z;
            for (d, c) in dense[j + 1..].iter_mut().zip(&c[1..]) {
                *d -= z * *c;
            }
            j += 1;
        }
        vector[self.first..self.first + n].copy_from_slice(&dense[..n]);
        let mut changes = &dense[n..];
        for rows in &rows[self.below.clone()] {
            let (now, rest) = changes.split_at(rows.range().len());
            for (entry, change) in vector[rows.range()].iter_mut().zip(now) {
                *entry += *change;
            }
            changes = rest;
        }
    }

    /// Solves Lᵀ x = y on the columns with the rows below known.
    #[inline(always)]
    pub fn backward(&self, values: &[f64], rows: &[PositionRange], vector: &mut [f64], dense: &mut Vec<f64>) {
        let n = self.columns;
        dense.clear();
        dense.extend_from_slice(&vector[self.first..self.first + n]);
        for rows in &rows[self.below.clone()] {
            dense.extend_from_slice(&vector[rows.range()]);
        }
        let mut j = n;
        // The last columns, which fill no group of four, are solved one by one, as in the forward sweep.
        while !j.is_multiple_of(4) {
            j -= 1;
            let c = self.column(values, j);
            dense[j] = (dense[j] - dot(&c[1..], &dense[j + 1..])) / c[0];
        }
        while j >= 4 {
            j -= 4;
            let c = self.columns(values, j);
            let sums = dot4([&c[0][4..], &c[1][3..], &c[2][2..], &c[3][1..]], &dense[j + 4..]);
            for a in (0..4).rev() {
                let mut s = dense[j + a] - sums[a];
                for b in a + 1..4 {
                    s -= dense[j + b] * c[a][b - a];
                }
                dense[j + a] = s / c[a][0];
            }
        }
        vector[self.first..self.first + n].copy_from_slice(&dense[..n]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of two panels stay apart even if they are consecutive.
    #[test]
    fn the_rows_of_panels_stay_apart() {
        let mut list = Vec::new();
        let places = [&[1, 2, 3, 7][..], &[8, 9], &[], &[10, 12]]
            .map(|rows| PositionRange::append(rows.iter().copied(), &mut list));
        assert_eq!(places, [0..2, 2..3, 3..3, 3..5]);
        let rows = places
            .map(|place| list[place].iter().flat_map(|run| run.first..run.first + run.length).collect::<Vec<u32>>());
        assert_eq!(rows, [vec![1, 2, 3, 7], vec![8, 9], vec![], vec![10, 12]]);
    }
}
