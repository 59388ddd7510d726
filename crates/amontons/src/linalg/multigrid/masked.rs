//! A matrix with the flags of its unknown degrees of freedom, and the blocks of its nodes.

use std::collections::BTreeMap;

use crate::linalg::sparse::BlockMatrix;
use crate::linalg::tangent::Entry;
use crate::linalg::turn::Turn;
use crate::space::{NodeFrame, RigidNodes};
use crate::tensor::{Point, Sym};

/// Basis of a node that is not turned.
pub(super) const AXES: [Point; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A matrix on all degrees of freedom, with the flags of the unknown ones.
pub(super) struct MaskedMatrix<'a> {
    pub matrix: &'a BlockMatrix,
    pub points: &'a [Point],
    pub free: &'a [bool],
    /// Directions of the unknowns of nodes where they are not the axes.
    pub frames: &'a [NodeFrame],
    /// Nodes that move as rigid bodies.
    pub rigid: &'a [RigidNodes],
    /// Rigid motions without stiffness, by degree of freedom, with the stiffness of their bodies.
    pub stiffless: &'a [(u32, f64)],
}

/// Bases of the turned nodes.
pub(super) fn bases(turns: &[Turn], n: usize) -> BTreeMap<usize, [Point; 3]> {
    turns.iter().map(|turn| (turn.unknowns[0] as usize / n, turn.basis)).collect()
}

/// Block of J per node.
pub(super) fn blocks(entries: &[Entry], n: usize) -> BTreeMap<usize, Vec<f64>> {
    let mut blocks: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for &(i, j, value) in entries.iter().filter(|(i, j, _)| *i as usize / n == *j as usize / n) {
        let block = blocks.entry(i as usize / n).or_insert_with(|| vec![0.0; n * n]);
        block[i as usize % n * n + j as usize % n] += value;
    }
    blocks
}

/// Diagonal block of a node.
pub(super) fn block_of(matrix: &BlockMatrix, node: usize, n: usize) -> Vec<f64> {
    matrix.row(node).find(|(j, _)| *j == node).map_or_else(|| vec![0.0; n * n], |(_, block)| block.to_vec())
}

/// B A Cᵀ if `into`, otherwise Bᵀ A C; the rows of B and C are the vectors of two bases.
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

/// Symmetric part of a contact block with its principal values clamped to zero … `firm`: this caps the stiffness and
/// removes what friction makes indefinite.
pub(super) fn cut(block: &[f64], firm: f64, n: usize) -> Vec<f64> {
    let entry = |i: usize, j: usize| if i < n && j < n { block[i * n + j] } else { 0.0 };
    let axes = Sym::from_fn(3, |i, j| 0.5 * (entry(i, j) + entry(j, i))).principal_axes();
    let part = |i: usize, j: usize| axes.iter().map(|(value, v)| value.clamp(0.0, firm) * v[i] * v[j]).sum();
    (0..n * n).map(|k| part(k / n, k % n)).collect()
}
