//! The preconditioner of K + J: a V-cycle on the degrees of freedom that contact lets move, and the others after it.

use super::blocks::{Blocks, Rows};
use super::hierarchy::{Hierarchy, Plan};
use crate::linalg::condensed::Entry;
use crate::linalg::sparse::BlockMatrix;
use crate::linalg::turn::Turn;
use crate::tensor::Point;

/// Share of the diagonal of K above which an entry of contact holds a degree of freedom.
const HELD: f64 = 100.0;

/// A matrix on all degrees of freedom: where they are, which are unknown, and their bases.
pub(super) struct Body<'a> {
    pub matrix: &'a BlockMatrix,
    pub points: &'a [Point],
    /// Whether a degree of freedom is unknown.
    pub free: &'a [bool],
    /// Bases of nodes that are turned, by degree of freedom.
    pub turns: &'a [Turn],
}

/// The preconditioner.
#[derive(Debug)]
pub(super) struct Preconditioner {
    hierarchy: Hierarchy,
    /// Degrees of freedom that contact holds, in the order of the nodes.
    pub held: Vec<u32>,
    /// K at the nodes that have them: rows of held degrees of freedom, as column and value.
    rows: Vec<Vec<(u32, f64)>>,
    /// K + J among them, and J from them to others: row, column, value, by held degree of freedom.
    diagonal: Vec<f64>,
    onto: Vec<Entry>,
    components: usize,
}

/// Which degrees of freedom the entries hold.
pub(super) fn held(body: &Body, entries: &[Entry]) -> Vec<u32> {
    let (components, _) = body.matrix.block_shape();
    let mut sum = vec![0.0; body.free.len()];
    for &(i, j, value) in entries.iter().filter(|(i, j, _)| i == j) {
        sum[i as usize] += value * f64::from(u8::from(i == j));
    }
    let is_held = |dof: &usize| {
        let (node, c) = (dof / components, dof % components);
        sum[*dof] > HELD * body.matrix.get(node, c, node, c)
    };
    (0..sum.len()).filter(|&dof| sum[dof] > 0.0).filter(is_held).map(|dof| dof as u32).collect()
}

impl Preconditioner {
    /// For the entries of contact, which are by degree of freedom in the bases of their nodes.
    pub fn new(body: &Body, entries: &[Entry]) -> Preconditioner {
        let (components, _) = body.matrix.block_shape();
        let held = held(body, entries);
        let mut takes_part = body.free.to_vec();
        for &dof in &held {
            takes_part[dof as usize] = false;
        }
        let soft: Vec<Entry> =
            entries.iter().filter(|(i, j, _)| takes_part[*i as usize] && takes_part[*j as usize]).copied().collect();
        let whole = turned(body);
        let rows = held.iter().map(|&dof| row_of(&whole, dof, body.free)).collect();
        let mut diagonal: Vec<f64> = held.iter().map(|&dof| entry(&whole, dof, dof)).collect();
        let mut onto = Vec::new();
        for &(i, j, value) in entries {
            if let Ok(at) = held.binary_search(&j) {
                if i == j {
                    diagonal[at] += value;
                } else if takes_part[i as usize] {
                    onto.push((i, at as u32, value));
                }
            }
        }
        let (modes, count) = modes(body, components);
        let matrix = restricted(whole, &takes_part, &soft);
        let hierarchy = Hierarchy::new(&Plan { matrix: &matrix, modes: &modes, count, takes_part: &takes_part });
        Preconditioner { hierarchy, held, rows, diagonal, onto, components }
    }

    /// Unknowns of the levels.
    pub fn sizes(&self) -> Vec<usize> {
        self.hierarchy.sizes()
    }

    /// Numbers that are stored.
    pub fn stored(&self) -> usize {
        self.hierarchy.stored()
    }

    /// An approximate solution of (K + J) x = r over all degrees of freedom; r is zero where they are prescribed.
    pub fn apply(&self, r: &[f64]) -> Vec<f64> {
        debug_assert!(r.len().is_multiple_of(self.components));
        let mut rest = r.to_vec();
        for &(i, at, value) in &self.onto {
            rest[i as usize] -= value * r[self.held[at as usize] as usize] / self.diagonal[at as usize];
        }
        for &dof in &self.held {
            rest[dof as usize] = 0.0;
        }
        let mut x = self.hierarchy.cycle(&rest);
        for ((&dof, row), diagonal) in self.held.iter().zip(&self.rows).zip(&self.diagonal) {
            let moved: f64 = row.iter().map(|&(j, value)| value * x[j as usize]).sum();
            rest[dof as usize] = (r[dof as usize] - moved) / diagonal;
        }
        for &dof in &self.held {
            x[dof as usize] = rest[dof as usize];
        }
        x
    }
}

/// The matrix in the bases of the nodes.
fn turned(body: &Body) -> Blocks<f64> {
    let (n, _) = body.matrix.block_shape();
    let nodes = body.free.len() / n;
    let mut basis: Vec<Option<&Turn>> = vec![None; nodes];
    for turn in body.turns {
        basis[turn.unknowns[0] as usize / n] = Some(turn);
    }
    Blocks::from_rows(nodes, nodes, [n, n], |range| {
        let mut rows = Rows::default();
        for i in range {
            for (j, block) in body.matrix.row(i) {
                rows.columns.push(j as u32);
                if basis[i].is_none() && basis[j].is_none() {
                    rows.values.extend(block);
                } else {
                    rows.values.extend(in_bases(block, basis[i], basis[j], n));
                }
            }
            rows.ends.push(rows.columns.len() as u32);
        }
        rows
    })
}

/// B_i A B_jᵀ, the rows of B the vectors of a basis.
fn in_bases(block: &[f64], of_row: Option<&Turn>, of_column: Option<&Turn>, n: usize) -> Vec<f64> {
    let vector =
        |turn: Option<&Turn>, a: usize, c: usize| turn.map_or(f64::from(u8::from(a == c)), |turn| turn.basis[a][c]);
    let mut out = vec![0.0; n * n];
    for a in 0..n {
        for b in 0..n {
            for c in 0..n {
                for d in 0..n {
                    out[a * n + b] += vector(of_row, a, c) * block[c * n + d] * vector(of_column, b, d);
                }
            }
        }
    }
    out
}

/// The matrix on the degrees of freedom that take part, units on the diagonal for the others, with entries added.
fn restricted(mut matrix: Blocks<f64>, takes_part: &[bool], entries: &[Entry]) -> Blocks<f64> {
    let n = matrix.shape[0];
    let mut added = vec![Vec::new(); if entries.is_empty() { 0 } else { matrix.len() }];
    for &(i, j, value) in entries {
        // A node of its own: what joins nodes is left to the iteration.
        if i as usize / n == j as usize / n {
            added[i as usize / n].push((i as usize % n, j as usize % n, value));
        }
    }
    for i in 0..matrix.len() {
        for k in matrix.start[i] as usize..matrix.start[i + 1] as usize {
            let j = matrix.columns[k] as usize;
            let block = &mut matrix.values[k * n * n..][..n * n];
            for a in 0..n {
                for b in 0..n {
                    if !(takes_part[i * n + a] && takes_part[j * n + b]) {
                        let unit = i == j && a == b;
                        block[a * n + b] = if unit { block[a * n + b].abs().max(f64::MIN_POSITIVE) } else { 0.0 };
                    }
                }
            }
            if i == j {
                // The symmetric part: the cycle is symmetric.
                for &(a, b, value) in added.get(i).into_iter().flatten() {
                    block[a * n + b] += 0.5 * value;
                    block[b * n + a] += 0.5 * value;
                }
            }
        }
    }
    matrix
}

fn entry(matrix: &Blocks<f64>, i: u32, j: u32) -> f64 {
    let n = matrix.shape[0];
    let (row, column) = (i as usize / n, j as usize / n);
    matrix.row(row).find(|(c, _)| *c == column).map_or(0.0, |(_, block)| block[i as usize % n * n + j as usize % n])
}

/// The row of a degree of freedom, over the unknowns.
fn row_of(matrix: &Blocks<f64>, dof: u32, free: &[bool]) -> Vec<(u32, f64)> {
    let n = matrix.shape[0];
    let of = |(j, block): (usize, &[f64])| {
        let block = block[dof as usize % n * n..][..n].to_vec();
        block.into_iter().enumerate().map(move |(c, value)| ((j * n + c) as u32, value))
    };
    matrix.row(dof as usize / n).flat_map(of).filter(|(j, value)| free[*j as usize] && *value != 0.0).collect()
}

/// Modes that cost next to no energy, a block of n × m per node, and m: translations and rotations of a body in the
/// plane or in space, in the bases of the nodes; a constant otherwise.
fn modes(body: &Body, n: usize) -> (Vec<f64>, usize) {
    let nodes = body.free.len() / n;
    if n == 1 || body.points.len() != nodes {
        let mut constant = vec![0.0; nodes * n * n];
        for i in 0..nodes * n {
            constant[i * n + i % n] = 1.0;
        }
        return (constant, n);
    }
    let m = if n == 2 { 3 } else { 6 };
    let mean: Point =
        std::array::from_fn(|c| body.points.iter().map(|p| p[c]).sum::<f64>() / body.points.len().max(1) as f64);
    let size = body.points.iter().flat_map(|p| (0..3).map(move |c| (p[c] - mean[c]).abs())).fold(0.0, f64::max);
    let mut modes = vec![0.0; nodes * n * m];
    for (i, p) in body.points.iter().enumerate() {
        let [x, y, z]: Point = std::array::from_fn(|c| (p[c] - mean[c]) / size.max(f64::MIN_POSITIVE));
        let block = &mut modes[i * n * m..][..n * m];
        for c in 0..n {
            block[c * m + c] = 1.0;
        }
        if n == 2 {
            (block[2], block[m + 2]) = (-y, x);
        } else {
            (block[3], block[m + 3]) = (-y, x);
            (block[m + 4], block[2 * m + 4]) = (-z, y);
            (block[2 * m + 5], block[5]) = (-x, z);
        }
    }
    for turn in body.turns {
        let block = &mut modes[turn.unknowns[0] as usize / n * n * m..][..n * m];
        let straight = block.to_vec();
        for a in 0..n {
            for k in 0..m {
                block[a * m + k] = (0..n).map(|c| turn.basis[a][c] * straight[c * m + k]).sum();
            }
        }
    }
    // A mode that prescribed values stop is none there.
    for (dof, free) in body.free.iter().enumerate().filter(|(_, free)| !**free) {
        debug_assert!(!free);
        modes[dof * m..][..m].fill(0.0);
    }
    (modes, m)
}
