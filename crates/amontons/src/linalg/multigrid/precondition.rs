//! The preconditioner of K + J: a V-cycle with K and the forces of contact, cut off where they hold a degree of freedom
//! firmly, between two solutions on what contact touches.
//!
//! The cycle is that of the axes of space, so that it need not be made anew when normals turn.

use std::collections::BTreeMap;

use super::blocks::{Blocks, Rows};
use super::hierarchy::{Hierarchy, Plan};
use super::local::{Local, bases, blocks};
use super::surface::couples;
use crate::linalg::condensed::Entry;
use crate::linalg::error::SolveError;
use crate::linalg::sparse::BlockMatrix;
use crate::linalg::stop::Stop;
use crate::linalg::turn::Turn;
use crate::tensor::{Point, Sym};

/// How many times stiffer than K at a degree of freedom contact is in the cycle at the most: what is stiffer holds it.
const FIRM: f64 = 100.0;
/// The basis of a node that is not turned.
pub(super) const AXES: [Point; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A matrix on all degrees of freedom, and which of them are unknown.
pub(super) struct Body<'a> {
    pub matrix: &'a BlockMatrix,
    pub points: &'a [Point],
    pub free: &'a [bool],
}

/// The preconditioner.
#[derive(Debug)]
pub(super) struct Preconditioner {
    hierarchy: Hierarchy,
    /// What contact touches, if it touches something.
    local: Option<Local>,
}

impl Preconditioner {
    /// For K alone.
    pub fn new(body: &Body, stop: &Stop) -> Result<Preconditioner, SolveError> {
        let (components, _) = body.matrix.block_shape();
        let (modes, count) = modes(body, components);
        let matrix = restricted(body);
        let hierarchy = Hierarchy::new(&Plan { matrix: &matrix, modes: &modes, count, takes_part: body.free, stop })?;
        Ok(Preconditioner { hierarchy, local: None })
    }

    /// Takes up the entries of contact, which are by degree of freedom in the bases of `turns`.
    ///
    /// # Errors
    /// When contact couples nodes and K + J is singular on them.
    pub fn add(&mut self, body: &Body, entries: &[Entry], turns: &[Turn]) -> Result<(), SolveError> {
        let (n, _) = body.matrix.block_shape();
        let bases = bases(turns, n);
        let has_turns = !turns.is_empty();
        self.local = if entries.is_empty() && !has_turns { None } else { Some(Local::new(body, entries, turns)?) };
        let added = if couples(entries, n) { coupled(body, entries, &bases) } else { nodal(body, entries, &bases) };
        self.hierarchy.add(&added);
        Ok(())
    }

    /// What contact touches, if it touches something.
    pub fn local(&self) -> Option<&Local> {
        self.local.as_ref()
    }

    /// An approximate solution of (K + J) x = r over all degrees of freedom; r is zero where they are prescribed.
    pub fn apply(&self, matrix: &BlockMatrix, r: &[f64]) -> Vec<f64> {
        let cycle = |r: &[f64]| self.hierarchy.cycle(r);
        self.local.as_ref().map_or_else(|| cycle(r), |local| local.around(matrix, r, cycle))
    }
}

/// What contact at nodes adds to the levels.
fn nodal(body: &Body, entries: &[Entry], bases: &BTreeMap<usize, [Point; 3]>) -> Blocks<f64> {
    let (n, _) = body.matrix.block_shape();
    let cut: BTreeMap<usize, Vec<f64>> = blocks(entries, n)
        .into_iter()
        .map(|(node, block)| {
            let basis = bases.get(&node).copied().unwrap_or(AXES);
            let own = block_of(body.matrix, node, n);
            let firm = FIRM * (0..n).map(|c| own[c * n + c]).fold(0.0, f64::max);
            (node, in_basis(&cut(&block, firm, n), [&basis; 2], n, false))
        })
        .collect();
    let rows = body.free.len() / n;
    Blocks::from_rows(rows, rows, [n, n], |range| {
        let mut made = Rows::default();
        for i in range {
            if let Some(block) = cut.get(&i) {
                made.columns.push(i as u32);
                made.values.extend(block);
            }
            made.ends.push(made.columns.len() as u32);
        }
        made
    })
}

/// The block of a node on the diagonal.
pub(super) fn block_of(matrix: &BlockMatrix, node: usize, n: usize) -> Vec<f64> {
    matrix.row(node).find(|(j, _)| *j == node).map_or_else(|| vec![0.0; n * n], |(_, block)| block.to_vec())
}

/// B A Cᵀ, the rows of B and C the vectors of two bases, or Bᵀ A C.
pub(super) fn in_basis(block: &[f64], [left, right]: [&[Point; 3]; 2], n: usize, into: bool) -> Vec<f64> {
    let entry = |basis: &[Point; 3], a: usize, c: usize| if into { basis[a][c] } else { basis[c][a] };
    let mut out = vec![0.0; n * n];
    for a in 0..n {
        for b in 0..n {
            for c in 0..n {
                for d in 0..n {
                    out[a * n + b] += entry(left, a, c) * block[c * n + d] * entry(right, b, d);
                }
            }
        }
    }
    out
}

/// What contact that couples nodes adds to the levels: of every component in its basis the part of its own, cut off at
/// [`FIRM`] by scaling rows and columns, so that motions without force stay so.
fn coupled(body: &Body, entries: &[Entry], bases: &BTreeMap<usize, [Point; 3]>) -> Blocks<f64> {
    let (n, _) = body.matrix.block_shape();
    let basis = |node: usize| bases.get(&node).copied().unwrap_or(AXES);
    let mut blocks: BTreeMap<(usize, usize), Vec<f64>> = BTreeMap::new();
    for &(i, j, value) in entries.iter().filter(|(i, j, _)| *i as usize % n == *j as usize % n) {
        let (i, j) = (i as usize, j as usize);
        for (row, column) in [(i, j), (j, i)] {
            let block = blocks.entry((row / n, column / n)).or_insert_with(|| vec![0.0; n * n]);
            block[(row % n) * n + column % n] += 0.5 * value;
        }
    }
    let scale = |node: usize| -> Vec<f64> {
        let own = in_basis(&block_of(body.matrix, node, n), [&basis(node); 2], n, true);
        let firm = FIRM * (0..n).map(|c| own[c * n + c]).fold(0.0, f64::max);
        let diagonal = |c: usize| blocks.get(&(node, node)).map_or(0.0, |block| block[c * n + c]);
        (0..n).map(|c| (firm / diagonal(c).max(firm)).sqrt()).collect()
    };
    let scales: BTreeMap<usize, Vec<f64>> = blocks.keys().map(|&(i, _)| (i, scale(i))).collect();
    let rows = body.free.len() / n;
    Blocks::from_rows(rows, rows, [n, n], |range| {
        let mut made = Rows::default();
        for i in range {
            for (&(_, j), block) in blocks.range((i, 0)..(i + 1, 0)) {
                let (Some(left), Some(right)) = (scales.get(&i), scales.get(&j)) else { continue };
                let cut: Vec<f64> = block.iter().enumerate().map(|(k, v)| v * left[k / n] * right[k % n]).collect();
                made.columns.push(j as u32);
                made.values.extend(in_basis(&cut, [&basis(i), &basis(j)], n, false));
            }
            made.ends.push(made.columns.len() as u32);
        }
        made
    })
}

/// The symmetric part of a block of contact with its principal values from zero to `firm`: what is beyond is cut off,
/// and so is what friction makes indefinite.
pub(super) fn cut(block: &[f64], firm: f64, n: usize) -> Vec<f64> {
    let entry = |i: usize, j: usize| if i < n && j < n { block[i * n + j] } else { 0.0 };
    let axes = Sym::from_fn(3, |i, j| 0.5 * (entry(i, j) + entry(j, i))).principal_axes();
    let part = |i: usize, j: usize| axes.iter().map(|(value, v)| value.clamp(0.0, firm) * v[i] * v[j]).sum();
    (0..n * n).map(|k| part(k / n, k % n)).collect()
}

/// The matrix on the unknowns, with the diagonal alone at the other degrees of freedom.
fn restricted(body: &Body) -> Blocks<f64> {
    let (n, _) = body.matrix.block_shape();
    let nodes = body.free.len() / n;
    Blocks::from_rows(nodes, nodes, [n, n], |range| {
        let mut rows = Rows::default();
        for i in range {
            for (j, block) in body.matrix.row(i) {
                let kept = |k: usize| body.free[i * n + k / n] && body.free[j * n + k % n];
                if i != j && !(0..n * n).any(kept) {
                    continue;
                }
                rows.columns.push(j as u32);
                rows.values.extend(block.iter().enumerate().map(|(k, value)| {
                    let alone = i == j && k / n == k % n;
                    if kept(k) { *value } else { f64::from(u8::from(alone)) * value.abs().max(f64::MIN_POSITIVE) }
                }));
            }
            rows.ends.push(rows.columns.len() as u32);
        }
        rows
    })
}

/// Modes that cost next to no energy, a block of n × m per node, and m: translations and rotations of a body in the
/// plane or in space; constants otherwise. What prescribed values stop is none there.
fn modes(body: &Body, n: usize) -> (Vec<f64>, usize) {
    let nodes = body.free.len() / n;
    let m = if body.points.len() == nodes { [1, 1, 3, 6].get(n).copied().unwrap_or(n) } else { n };
    let mean: Point =
        std::array::from_fn(|c| body.points.iter().map(|p| p[c]).sum::<f64>() / body.points.len().max(1) as f64);
    let far = |p: &Point| (0..3).map(|c| (p[c] - mean[c]).abs()).fold(0.0, f64::max);
    let size = body.points.iter().map(far).fold(f64::MIN_POSITIVE, f64::max);
    let mut modes = vec![0.0; nodes * n * m];
    for (i, block) in modes.chunks_exact_mut(n * m).enumerate() {
        for c in 0..n {
            block[c * m + c] = 1.0;
        }
        if m > n {
            let [x, y, z]: Point = std::array::from_fn(|c| (body.points[i][c] - mean[c]) / size);
            (block[n], block[m + n]) = (-y, x);
            if n == 3 {
                (block[m + 4], block[2 * m + 4]) = (-z, y);
                (block[2 * m + 5], block[5]) = (-x, z);
            }
        }
        for c in (0..n).filter(|c| !body.free[i * n + c]) {
            block[c * m..][..m].fill(0.0);
        }
    }
    (modes, m)
}
