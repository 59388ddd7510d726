//! The sweeps over a factor: subtrees of the elimination tree side by side, panels of dense columns in turn.
//!
//! The loops are compiled for the vector instructions of the machine; every sum has the same order on all machines and
//! with any number of threads.
#![allow(clippy::inline_always, reason = "a loop is compiled for the vector instructions of the function it is in")]

use std::hint::black_box;

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

/// Numbers of a panel up to which its lines of memory are asked for one after the other before it is worked with: its
/// columns by themselves are too short for a processor to read ahead. They fit into the second cache.
const AHEAD: usize = 1 << 15;
/// Numbers of a line of memory.
const LINE: usize = 8;

/// A dense panel of the factor: columns `first..first + columns` of a task's vector, with the
/// positions of the rows below them in that vector.
#[derive(Debug)]
pub(super) struct Panel {
    pub first: usize,
    pub columns: usize,
    pub below: Runs,
    /// Where its values begin: columns from the diagonal down, one after the other.
    pub values: usize,
    /// Rows of the first column.
    pub leading: usize,
}

/// Positions in a vector as runs: first position and length of each.
#[derive(Debug, Default)]
pub(super) struct Runs(Vec<[u32; 2]>);

impl FromIterator<u32> for Runs {
    fn from_iter<I: IntoIterator<Item = u32>>(positions: I) -> Runs {
        let mut runs: Vec<[u32; 2]> = Vec::new();
        for position in positions {
            match runs.last_mut() {
                Some([first, length]) if *first + *length == position => *length += 1,
                _ => runs.push([position, 1]),
            }
        }
        Runs(runs)
    }
}

impl Runs {
    /// Appends the entries of a vector at the positions.
    #[inline(always)]
    fn gather(&self, vector: &[f64], out: &mut Vec<f64>) {
        for &[first, length] in &self.0 {
            out.extend_from_slice(&vector[first as usize..(first + length) as usize]);
        }
    }

    /// Adds values to the entries of a vector at the positions.
    #[inline(always)]
    fn add(&self, values: &[f64], vector: &mut [f64]) {
        let mut values = values;
        for &[first, length] in &self.0 {
            let (now, rest) = values.split_at(length as usize);
            for (entry, value) in vector[first as usize..(first + length) as usize].iter_mut().zip(now) {
                *entry += value;
            }
            values = rest;
        }
    }
}

/// A subtree of the elimination tree. Its vector is (own columns, ancestors that it touches).
#[derive(Debug, Default)]
pub(super) struct Task {
    pub children: Vec<Task>,
    /// Columns of the whole subtree that precede the own ones are the children's.
    pub begin: usize,
    pub own: std::ops::Range<usize>,
    pub panels: Vec<Panel>,
    /// Positions in the parent's vector of the ancestors touched.
    pub ancestors: Vec<u32>,
    /// How many ancestors are touched.
    pub touched: usize,
}

impl Task {
    /// Solves L y = r on the columns of the subtree; returns what is added to the ancestors.
    pub fn forward(&self, values: &[f64], x: &mut [f64]) -> Vec<f64> {
        let (mut inner, own) = x.split_at_mut(self.own.start - self.begin);
        let mut slices = Vec::with_capacity(self.children.len());
        for child in &self.children {
            let (slice, rest) = inner.split_at_mut(child.own.end - child.begin);
            slices.push((child, slice));
            inner = rest;
        }
        let updates: Vec<Vec<f64>> =
            slices.into_par_iter().map(|(child, slice)| child.forward(values, slice)).collect();
        let width = self.own.len();
        let mut vector = vec![0.0; width + self.touched];
        vector[..width].copy_from_slice(own);
        for (child, update) in self.children.iter().zip(&updates) {
            for (&at, &value) in child.ancestors.iter().zip(update) {
                vector[at as usize] += value;
            }
        }
        Arch::new().dispatch(Sweep { panels: &self.panels, values, vector: &mut vector, is_forward: true });
        own.copy_from_slice(&vector[..width]);
        vector.split_off(width)
    }

    /// Solves Lᵀ x = y on the columns of the subtree with the ancestors known.
    pub fn backward(&self, values: &[f64], x: &mut [f64], ancestors: &[f64]) {
        let (mut inner, own) = x.split_at_mut(self.own.start - self.begin);
        let width = self.own.len();
        let mut vector = Vec::with_capacity(width + ancestors.len());
        vector.extend_from_slice(own);
        vector.extend_from_slice(ancestors);
        Arch::new().dispatch(Sweep { panels: &self.panels, values, vector: &mut vector, is_forward: false });
        own.copy_from_slice(&vector[..width]);
        let mut slices = Vec::with_capacity(self.children.len());
        for child in &self.children {
            let (slice, rest) = inner.split_at_mut(child.own.end - child.begin);
            slices.push((child, slice));
            inner = rest;
        }
        let vector = &vector;
        slices.into_par_iter().for_each(|(child, slice)| {
            let known: Vec<f64> = child.ancestors.iter().map(|&at| vector[at as usize]).collect();
            child.backward(values, slice, &known);
        });
    }
}

/// A sweep over some panels in turn.
struct Sweep<'a> {
    panels: &'a [Panel],
    values: &'a [f64],
    vector: &'a mut [f64],
    is_forward: bool,
}

impl NullaryFnOnce for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Sweep { panels, values, vector, is_forward } = self;
        let mut dense = Vec::new();
        if is_forward {
            for panel in panels {
                panel.forward(panel.values(values, true), vector, &mut dense);
            }
        } else {
            for panel in panels.iter().rev() {
                panel.backward(panel.values(values, false), vector, &mut dense);
            }
        }
    }
}

impl Panel {
    /// Where column j begins among the values of the panel.
    #[inline(always)]
    fn start(&self, j: usize) -> usize {
        j * self.leading - j * j.saturating_sub(1) / 2
    }

    /// The values of the panel, read ahead in the order in which the sweep goes through memory.
    #[inline(always)]
    fn values<'a>(&self, values: &'a [f64], is_forward: bool) -> &'a [f64] {
        let values = &values[self.values..self.values + self.start(self.columns)];
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

    #[inline(always)]
    fn forward(&self, values: &[f64], vector: &mut [f64], dense: &mut Vec<f64>) {
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
                    s -= c[b][a - b] * z[b];
                }
                z[a] = s / c[a][0];
            }
            dense[j..j + 4].copy_from_slice(&z);
            let tail = &mut dense[j + 4..];
            let m = tail.len();
            let (c0, c1, c2, c3) = (&c[0][4..][..m], &c[1][3..][..m], &c[2][2..][..m], &c[3][1..][..m]);
            for i in 0..m {
                tail[i] -= (c0[i] * z[0] + c1[i] * z[1]) + (c2[i] * z[2] + c3[i] * z[3]);
            }
            j += 4;
        }
        while j < n {
            let c = self.column(values, j);
            let z = dense[j] / c[0];
            dense[j] = z;
            for (d, c) in dense[j + 1..].iter_mut().zip(&c[1..]) {
                *d -= c * z;
            }
            j += 1;
        }
        vector[self.first..self.first + n].copy_from_slice(&dense[..n]);
        self.below.add(&dense[n..], vector);
    }

    #[inline(always)]
    fn backward(&self, values: &[f64], vector: &mut [f64], dense: &mut Vec<f64>) {
        let n = self.columns;
        dense.clear();
        dense.extend_from_slice(&vector[self.first..self.first + n]);
        self.below.gather(vector, dense);
        let mut j = n;
        // The odd columns come last here as they did in the forward sweep.
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
                    s -= c[a][b - a] * dense[j + b];
                }
                dense[j + a] = s / c[a][0];
            }
        }
        vector[self.first..self.first + n].copy_from_slice(&dense[..n]);
    }
}

/// A dot product in four lanes.
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

/// Four dot products with one vector, in four lanes each: sixteen sums that stay in registers.
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
    // As one value: the compiler would work on the same lane of all four otherwise, which is slower.
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
