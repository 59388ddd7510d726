//! The preconditioner of K + J: a V-cycle with K and the forces of contact, cut off where they hold a degree of freedom
//! firmly; what they hold is solved after it, degree by degree.
//!
//! The cycle is that of the axes of space, so that it need not be made anew when normals turn.

use std::collections::BTreeMap;

use super::blocks::{Blocks, Rows};
use super::hierarchy::{Hierarchy, Plan};
use super::surface::{Surface, couples};
use crate::linalg::condensed::Entry;
use crate::linalg::error::SolveError;
use crate::linalg::sparse::BlockMatrix;
use crate::linalg::stop::Stop;
use crate::linalg::turn::Turn;
use crate::tensor::Point;

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
    turns: Vec<Turn>,
    held: Vec<Held>,
    /// Entries from what is held onto the others: degree of freedom, number of what is held, value.
    onto: Vec<Entry>,
    /// In place of both where contact couples nodes.
    surface: Option<Surface>,
}

/// A degree of freedom that contact holds.
#[derive(Clone, Copy, Debug)]
struct Held {
    dof: u32,
    /// Its vector in the axes of space.
    vector: Point,
    /// The entry of K + J on the diagonal.
    diagonal: f64,
}

impl Preconditioner {
    /// For K alone.
    pub fn new(body: &Body, stop: &Stop) -> Result<Preconditioner, SolveError> {
        let (components, _) = body.matrix.block_shape();
        let (modes, count) = modes(body, components);
        let matrix = restricted(body);
        let hierarchy = Hierarchy::new(&Plan { matrix: &matrix, modes: &modes, count, takes_part: body.free, stop })?;
        Ok(Preconditioner { hierarchy, turns: Vec::new(), held: Vec::new(), onto: Vec::new(), surface: None })
    }

    /// Takes up the entries of contact, which are by degree of freedom in the bases of `turns`.
    ///
    /// # Errors
    /// When contact couples nodes and K + J is singular on them.
    pub fn add(&mut self, body: &Body, entries: &[Entry], turns: &[Turn]) -> Result<(), SolveError> {
        let (n, _) = body.matrix.block_shape();
        self.turns = turns.to_vec();
        let bases: BTreeMap<usize, [Point; 3]> =
            turns.iter().map(|turn| (turn.unknowns[0] as usize / n, turn.basis)).collect();
        (self.held, self.onto, self.surface) = (Vec::new(), Vec::new(), None);
        if couples(entries, n) {
            self.surface = Some(Surface::new(body, entries, &bases)?);
            self.hierarchy.add(&coupled(body, entries, &bases));
        } else {
            self.add_nodal(body, entries, &bases);
        }
        Ok(())
    }

    /// The same of contact at nodes.
    fn add_nodal(&mut self, body: &Body, entries: &[Entry], bases: &BTreeMap<usize, [Point; 3]>) {
        let (n, _) = body.matrix.block_shape();
        let mut nodes: Vec<usize> = entries.iter().flat_map(|(i, j, _)| [*i as usize / n, *j as usize / n]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut blocks = vec![0.0; nodes.len() * n * n];
        for &(i, j, value) in entries.iter().filter(|(i, j, _)| *i as usize / n == *j as usize / n) {
            if let Ok(at) = nodes.binary_search(&(i as usize / n)) {
                blocks[(at * n + i as usize % n) * n + j as usize % n] += value;
            }
        }
        for (&node, block) in nodes.iter().zip(blocks.chunks_exact_mut(n * n)) {
            let basis = bases.get(&node).copied().unwrap_or(AXES);
            let own = in_basis(&block_of(body.matrix, node, n), [&basis; 2], n, true);
            let firm = FIRM * (0..n).map(|c| own[c * n + c]).fold(0.0, f64::max);
            for c in (0..n).filter(|c| block[c * n + c] > firm) {
                let diagonal = own[c * n + c] + block[c * n + c];
                self.held.push(Held { dof: (node * n + c) as u32, vector: basis[c], diagonal });
            }
            cut(block, firm, n);
            block.copy_from_slice(&in_basis(block, [&basis; 2], n, false));
        }
        for &(i, j, value) in entries.iter().filter(|(i, j, _)| i != j) {
            let number = |dof: u32| self.held.binary_search_by_key(&dof, |held| held.dof);
            if let (Ok(at), Err(_)) = (number(j), number(i)) {
                self.onto.push((i, at as u32, value));
            }
        }
        let rows = body.free.len() / n;
        self.hierarchy.add(&Blocks::from_rows(rows, rows, [n, n], |range| {
            let mut made = Rows::default();
            let mut at = nodes.partition_point(|node| *node < range.start);
            for i in range {
                if nodes.get(at) == Some(&i) {
                    made.columns.push(i as u32);
                    made.values.extend(&blocks[at * n * n..][..n * n]);
                    at += 1;
                }
                made.ends.push(made.columns.len() as u32);
            }
            made
        }));
    }

    /// An approximate solution of (K + J) x = r over all degrees of freedom; r is zero where they are prescribed.
    pub fn apply(&self, matrix: &BlockMatrix, r: &[f64]) -> Vec<f64> {
        let (n, _) = matrix.block_shape();
        if let Some(surface) = &self.surface {
            return surface.apply(|x| matrix.apply(x), |r| self.hierarchy.cycle(r), &self.turns, r);
        }
        let mut rest = r.to_vec();
        for &(i, at, value) in &self.onto {
            let held = &self.held[at as usize];
            rest[i as usize] -= value * r[held.dof as usize] / held.diagonal;
        }
        for held in &self.held {
            rest[held.dof as usize] = 0.0;
        }
        for turn in &self.turns {
            turn.back(&mut rest);
        }
        let mut x = self.hierarchy.cycle(&rest);
        if self.held.is_empty() && self.turns.is_empty() {
            return x;
        }
        // What is held, solved with the others: K x along its vector is what they load it with.
        for turn in &self.turns {
            turn.forward(&mut x);
        }
        for held in &self.held {
            x[held.dof as usize] = 0.0;
        }
        let mut straight = x.clone();
        for turn in &self.turns {
            turn.back(&mut straight);
        }
        for held in &self.held {
            let mut load = r[held.dof as usize];
            for (j, block) in matrix.row(held.dof as usize / n) {
                for c in 0..n {
                    let row: f64 = (0..n).map(|b| block[c * n + b] * straight[j * n + b]).sum();
                    load -= held.vector[c] * row;
                }
            }
            x[held.dof as usize] = load / held.diagonal;
        }
        x
    }
}

/// The block of a node on the diagonal.
fn block_of(matrix: &BlockMatrix, node: usize, n: usize) -> Vec<f64> {
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

/// The symmetric part of a block of contact, with what is beyond `firm` cut off: rows and columns are scaled. What
/// friction adds beside the diagonal is left to the iteration where it would make the block indefinite.
fn cut(block: &mut [f64], firm: f64, n: usize) {
    let scale: Vec<f64> = (0..n).map(|c| (firm / block[c * n + c].max(firm)).sqrt()).collect();
    let of = |a: usize, b: usize| 0.5 * (block[a * n + b] + block[b * n + a]) * scale[a] * scale[b];
    let cut: Vec<f64> = (0..n * n).map(|k| of(k / n, k % n)).collect();
    let dominates = (0..n).all(|a| cut[a * n + a] >= (0..n).filter(|b| *b != a).map(|b| cut[a * n + b].abs()).sum());
    for a in 0..n {
        for b in 0..n {
            block[a * n + b] = match (dominates, a == b) {
                (true, _) => cut[a * n + b],
                (false, true) => cut[a * n + b].max(0.0),
                (false, false) => 0.0,
            };
        }
    }
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
