//! The preconditioner of K + J: a V-cycle with K and the contact stiffness, capped where it holds a degree of freedom
//! firmly, between two local solutions where contact acts.
//!
//! The cycle works in the axes of space, so that its levels need not be rebuilt when normals turn.

use std::collections::BTreeMap;

use super::blocks::{BlockRowBuilder, BlockRowMatrix};
use super::hierarchy::{Hierarchy, HierarchyPlan};
use super::local::ContactBlocks;
use super::masked::{AXES, MaskedMatrix, bases, block_of, blocks, cut, in_basis};
use crate::linalg::error::SolveError;
use crate::linalg::stop::StopFlag;
use crate::linalg::tangent::{Entry, Tangent};
use crate::linalg::turn::Turn;
use crate::tensor::Point;

/// Cap on the stiffness of contact in the cycle, relative to that of K at the degree of freedom: anything stiffer holds
/// it.
const FIRM: f64 = 100.0;
/// Stiffness in the cycle of rigid motions without stiffness, as a fraction of that of their body: negligible beside
/// contact, but not beside the round-off of single precision.
const SOFT: f64 = 1e-6;
/// The preconditioner.
#[derive(Debug)]
pub(super) struct Preconditioner {
    hierarchy: Hierarchy,
    /// Local solver where contact acts, or `None` if it touches nothing.
    local: Option<ContactBlocks>,
}

impl Preconditioner {
    /// Builds the preconditioner for K alone.
    pub fn new(body: &MaskedMatrix, stop: &StopFlag) -> Result<Preconditioner, SolveError> {
        let (components, _) = body.matrix.block_shape();
        let (modes, count) = modes(body, components);
        let matrix = restricted(body);
        let points = if body.points.len() == matrix.len() { body.points } else { &[] };
        let plan = HierarchyPlan { matrix: &matrix, points, modes: &modes, count, takes_part: body.free, stop };
        let hierarchy = Hierarchy::new(&plan)?;
        Ok(Preconditioner { hierarchy, local: None })
    }

    /// Adds the tangent of contact, numbered by degree of freedom in the bases of `turns`, in place of the one before.
    ///
    /// # Errors
    /// When contact couples nodes and K + J is singular on them.
    pub fn add(&mut self, body: &MaskedMatrix, tangent: &Tangent, turns: &[Turn]) -> Result<(), SolveError> {
        let (n, _) = body.matrix.block_shape();
        let bases = bases(turns, n);
        let is_untouched = tangent.is_empty() && turns.is_empty();
        let before = self.local.take();
        self.local = if is_untouched { None } else { Some(ContactBlocks::new(body, tangent, turns, before.as_ref())?) };
        self.hierarchy.add(&summed(body, &softened(body, tangent, &bases)));
        Ok(())
    }

    /// Local solver where contact acts, or `None` if it touches nothing.
    pub fn local(&self) -> Option<&ContactBlocks> {
        self.local.as_ref()
    }

    /// Approximate solution of (K + J) x = r over all degrees of freedom; r is zero at prescribed ones.
    pub fn apply(&self, body: &MaskedMatrix, r: Vec<f64>) -> Vec<f64> {
        let cycle = |r: &[f64]| self.hierarchy.cycle(r);
        match &self.local {
            Some(local) => local.around(body, r, cycle),
            None => cycle(&r),
        }
    }
}

/// A block of J at a node, or between two: row, column, and its entries.
pub(super) type Joint = (u32, u32, [f64; 9]);

/// Contribution of contact to the levels, in the axes of space: J, with its forces at a node capped at [`FIRM`].
pub(super) fn softened(body: &MaskedMatrix, tangent: &Tangent, bases: &BTreeMap<usize, [Point; 3]>) -> Vec<Joint> {
    let (n, _) = body.matrix.block_shape();
    let mut joints: Vec<Joint> = Vec::new();
    let mut alone: Vec<Entry> = Vec::new();
    for point in tangent.points() {
        let is_alone = point
            .iter()
            .all(|(i, j, _)| point.first().is_none_or(|e| [*i, *j].map(|u| u / n as u32) == [e.0 / n as u32; 2]));
        if point.iter().any(|(i, j, _)| [*i, *j].iter().any(|u| moves_rigidly(body, u / n as u32))) {
            // Forces on a rigid motion are not capped: no neighbouring stiffness would be too soft beside them.
            joints.extend(point.iter().filter_map(|entry| single(body, entry)));
        } else if is_alone {
            alone.extend(point);
        } else {
            softened_point(body, &point, &mut joints);
        }
    }
    for (node, block) in blocks(&alone, n) {
        let basis = bases.get(&node).copied().unwrap_or(AXES);
        let cut = in_basis(&cut(&block, firm(body, node), n), [&basis; 2], n, false);
        joints.push((node as u32, node as u32, padded(&cut)));
    }
    joints.sort_by_key(|(i, j, _)| (*i, *j));
    joints
}

/// J as it is, in the axes of space, a block per pair of nodes.
pub(super) fn joined(body: &MaskedMatrix, tangent: &Tangent, at: &BTreeMap<usize, [Point; 3]>) -> Vec<Joint> {
    let (n, _) = body.matrix.block_shape();
    let size = n as u32;
    let mut summed: BTreeMap<(u32, u32), Vec<f64>> = BTreeMap::new();
    for (i, j, value) in tangent.entries() {
        let block = summed.entry((i / size, j / size)).or_insert_with(|| vec![0.0; n * n]);
        block[(i % size * size + j % size) as usize] += value;
    }
    let basis = |node: u32| at.get(&(node as usize)).unwrap_or(&AXES);
    let straight =
        |((i, j), block): ((u32, u32), Vec<f64>)| (i, j, padded(&in_basis(&block, [basis(i), basis(j)], n, false)));
    summed.into_iter().map(straight).collect()
}

/// The matrix of sorted blocks.
fn summed(body: &MaskedMatrix, joints: &[Joint]) -> BlockRowMatrix<f64> {
    let (n, _) = body.matrix.block_shape();
    let rows = body.free.len() / n;
    BlockRowMatrix::from_rows(rows, rows, [n, n], |range| {
        let mut made = BlockRowBuilder::default();
        for i in range {
            let from = joints.partition_point(|(row, ..)| (*row as usize) < i);
            let to = from + joints[from..].partition_point(|(row, ..)| *row as usize == i);
            for same in joints[from..to].chunk_by(|a, b| a.1 == b.1) {
                made.columns.extend(same.first().map(|(_, j, _)| *j));
                made.values.extend((0..n * n).map(|k| same.iter().map(|(.., block)| block[k]).sum::<f64>()));
            }
            made.ends.push(made.columns.len() as u32);
        }
        made
    })
}

/// True if motions of a rigid body stand in the place of a node.
fn moves_rigidly(body: &MaskedMatrix, node: u32) -> bool {
    body.rigid.iter().any(|part| part.slots().contains(&node))
}

/// One entry of J as a block, or `None` if one of its degrees of freedom is prescribed.
fn single(body: &MaskedMatrix, &(i, j, value): &Entry) -> Option<Joint> {
    let (n, _) = body.matrix.block_shape();
    let size = n as u32;
    if ![i, j].iter().all(|dof| body.free.get(*dof as usize).is_some_and(|free| *free)) {
        return None;
    }
    let mut block = [0.0; 9];
    *block.get_mut((i % size * size + j % size) as usize)? = value;
    Some((i / size, j / size, block))
}

/// Adds the blocks of a point that sees several nodes, in the axes of space. The blocks of J are multiples of one
/// block, so that all are capped alike: a motion of all nodes without resistance stays without resistance.
fn softened_point(body: &MaskedMatrix, point: &[Entry], joints: &mut Vec<Joint>) {
    let (n, _) = body.matrix.block_shape();
    let size = n as u32;
    let mut nodes: Vec<u32> = point.iter().flat_map(|(i, j, _)| [i / size, j / size]).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let place = |node: u32| nodes.binary_search(&node).unwrap_or(0);
    let mut blocks = vec![[0.0; 9]; nodes.len() * nodes.len()];
    for &(i, j, value) in point {
        let block = &mut blocks[place(i / size) * nodes.len() + place(j / size)];
        block[(i % size * size + j % size) as usize] += value;
    }
    let of_node = |k: usize| &blocks[k * nodes.len() + k];
    let product = |a: &[f64; 9], b: &[f64; 9]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let norm = |k: usize| product(of_node(k), of_node(k)).sqrt();
    let Some(first) = (0..nodes.len()).max_by(|&a, &b| norm(a).total_cmp(&norm(b))).filter(|&k| norm(k) > 0.0) else {
        return;
    };
    let (one, whole) = (of_node(first), norm(first));
    let bound = |(k, node): (usize, &u32)| firm(body, *node as usize) * whole / norm(k);
    let least = nodes.iter().enumerate().map(bound).filter(|bound| !bound.is_nan()).fold(f64::INFINITY, f64::min);
    let soft = padded(&cut(&one[..n * n], least, n));
    for (a, &i) in nodes.iter().enumerate() {
        for (b, &j) in nodes.iter().enumerate() {
            let of = |a: usize, b: usize| product(&blocks[a * nodes.len() + b], one) / (whole * whole);
            let share = 0.5 * (of(a, b) + of(b, a));
            let is_free = |k: usize| body.free[i as usize * n + k / n] && body.free[j as usize * n + k % n];
            joints.push((i, j, std::array::from_fn(|k| if k < n * n && is_free(k) { share * soft[k] } else { 0.0 })));
        }
    }
}

/// Contact stiffness above which contact holds a node.
fn firm(body: &MaskedMatrix, node: usize) -> f64 {
    let (n, _) = body.matrix.block_shape();
    let own = block_of(body.matrix, node, n);
    FIRM * (0..n).map(|c| own[c * n + c]).fold(0.0, f64::max)
}

/// Pads a block of at most nine entries with zeros.
fn padded(block: &[f64]) -> [f64; 9] {
    std::array::from_fn(|k| block.get(k).copied().unwrap_or(0.0))
}

/// The matrix restricted to the unknowns, with its diagonal alone at the other degrees of freedom.
fn restricted(body: &MaskedMatrix) -> BlockRowMatrix<f64> {
    let (n, _) = body.matrix.block_shape();
    let nodes = body.free.len() / n;
    let (mut start, mut columns) = (Vec::with_capacity(nodes + 1), Vec::new());
    start.push(0);
    for i in 0..nodes {
        columns.extend(body.matrix.graph().row(i).iter().filter(|&&j| has_unknowns(body, i, j as usize)));
        start.push(columns.len() as u32);
    }
    BlockRowMatrix::filled([n, n], nodes, (start, columns), |rows, values| {
        let blocks = rows.flat_map(|i| body.matrix.row(i).map(move |(j, block)| (i, j, block)));
        let standing = blocks.filter(|(i, j, _)| has_unknowns(body, *i, *j));
        for ((i, j, block), out) in standing.zip(values.chunks_exact_mut(n * n)) {
            fill_level_block(body, [i, j], block, out);
        }
    })
}

/// True if a block of the matrix restricted to the unknowns is on the diagonal, or both of its nodes have unknowns.
pub(super) fn has_unknowns(body: &MaskedMatrix, i: usize, j: usize) -> bool {
    let (n, _) = body.matrix.block_shape();
    let any = |node: usize| body.free[node * n..node * n + n].contains(&true);
    i == j || (any(i) && any(j))
}

/// Fills a block of the matrix restricted to the unknowns.
pub(super) fn fill_level_block(body: &MaskedMatrix, [i, j]: [usize; 2], block: &[f64], out: &mut [f64]) {
    let (n, _) = body.matrix.block_shape();
    let soft = |dof: usize| {
        let known = body.stiffless.iter().find(|(motion, _)| *motion as usize == dof);
        known.map_or(0.0, |(_, value)| SOFT * value)
    };
    for (k, (out, value)) in out.iter_mut().zip(block).enumerate() {
        let alone = f64::from(u8::from(i == j && k / n == k % n));
        let soft = if alone > 0.0 { soft(i * n + k % n) } else { 0.0 };
        let is_kept = body.free[i * n + k / n] && body.free[j * n + k % n];
        *out = if is_kept { *value + soft } else { alone * value.abs().max(f64::MIN_POSITIVE) };
    }
}

/// Modes of nearly zero energy, a block of n × m per node, and m: translations and rotations of a body in the plane or
/// in space; constants otherwise. Modes are zero at prescribed degrees of freedom.
pub(super) fn modes(body: &MaskedMatrix, n: usize) -> (Vec<f64>, usize) {
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
        if let Ok(at) = body.frames.binary_search_by_key(&(i as u32), |frame| frame.node) {
            let (axes, old) = (&body.frames[at].axes, block.to_vec());
            for (at, value) in block.iter_mut().enumerate() {
                *value = (0..n).map(|d| axes[at / m][d] * old[d * m + at % m]).sum();
            }
        }
    }
    // The part of a motion of the whole body in the motions of a rigid part of it.
    for part in body.rigid {
        for k in 0..m {
            let mut values: Vec<f64> = modes.iter().skip(k).step_by(m).copied().collect();
            part.enter(&mut values);
            for &node in &part.nodes {
                for dof in node as usize * n..(node as usize + 1) * n {
                    modes[dof * m + k] = values[dof];
                }
            }
        }
    }
    for (block, _) in modes.chunks_exact_mut(m).zip(body.free).filter(|(_, free)| !**free) {
        block.fill(0.0);
    }
    (modes, m)
}
