//! K + J on the degrees of freedom that contact touches, solved before and after the cycle over the body.
//!
//! Where contact holds a point, J is 2²⁷ times as stiff as K, and so large are the residual and the right-hand side
//! there: beside them nothing else would count. A residual is therefore measured by the displacement that it means,
//! L r on what contact touches, times the stiffness of K. L is (K + J)⁻¹ there where contact couples nodes, and node
//! by node otherwise, with the block of K and half of what joins the node to others: K is at most twice these blocks,
//! so that no solution overshoots so far that the preconditioner would be indefinite. And what an iteration leaves
//! there is solved once more at its end, so that the forces of contact, which are made of J x, are as accurate as x.

use std::collections::BTreeMap;

use faer::Mat;

use super::precondition::{AXES, Body, block_of, cut, in_basis};
use super::surface::{Surface, couples};
use crate::linalg::error::SolveError;
use crate::linalg::lu::{Cholesky, Lu};
use crate::linalg::sparse::BlockMatrix;
use crate::linalg::tangent::{Entry, Tangent};
use crate::linalg::turn::Turn;
use crate::linalg::vectors::add_combination;
use crate::tensor::Point;

/// What contact touches, with J by degree of freedom in the bases of the turns.
#[derive(Debug)]
pub(super) struct Local {
    solver: Solver,
    tangent: Tangent,
    turns: Vec<Turn>,
    /// The nodes that contact touches, and these with their neighbours.
    nodes: Vec<u32>,
    reach: Vec<u32>,
    /// Whether a degree of freedom is unknown.
    free: Vec<bool>,
}

#[derive(Debug)]
enum Solver {
    /// Node by node.
    Nodes(Vec<Node>),
    /// All of it, where contact couples nodes.
    Surface(Box<Surface>),
}

/// The block of L⁻¹ of a node over its degrees of freedom that are unknown, and its inverse.
#[derive(Debug)]
struct Node {
    number: u32,
    block: Vec<f64>,
    inverse: Vec<f64>,
}

impl Local {
    /// For the tangent of contact, with some entries at least.
    ///
    /// # Errors
    /// When contact couples nodes and K + J is singular on them.
    pub fn new(body: &Body, tangent: &Tangent, turns: &[Turn]) -> Result<Local, SolveError> {
        let (n, _) = body.matrix.block_shape();
        let bases = bases(turns, n);
        let entries: Vec<Entry> = tangent.entries().collect();
        let is_coupled = couples(&entries, n);
        let nodes = if is_coupled { joined(body, &entries) } else { seen(&entries, n) };
        let solver = if is_coupled {
            Solver::Surface(Box::new(Surface::new(body, &nodes, &entries, &bases)?))
        } else {
            Solver::Nodes(
                blocks(&entries, n).into_iter().filter_map(|(i, b)| node_of(body, i, bases.get(&i), &b)).collect(),
            )
        };
        let neighbours = nodes.iter().flat_map(|&node| body.matrix.row(node as usize).map(|(j, _)| j as u32));
        let mut reach: Vec<u32> = neighbours.collect();
        reach.sort_unstable();
        reach.dedup();
        let (tangent, turns, free) = (tangent.clone(), turns.to_vec(), body.free.to_vec());
        Ok(Local { solver, tangent, turns, nodes, reach, free })
    }

    /// L r, by degree of freedom.
    pub fn solution(&self, r: &[f64]) -> Vec<(u32, f64)> {
        match &self.solver {
            Solver::Surface(surface) => surface.solution(r),
            Solver::Nodes(nodes) => products(nodes, |node| &node.inverse, r),
        }
    }

    /// L⁻¹ x, by degree of freedom.
    pub fn load(&self, x: &[f64]) -> Vec<(u32, f64)> {
        match &self.solver {
            Solver::Surface(surface) => surface.load(x),
            Solver::Nodes(nodes) => products(nodes, |node| &node.block, x),
        }
    }

    /// An approximate solution of (K + J) x = r by `cycle`, which is in the axes of space, between two solutions on
    /// what contact touches: a symmetric operator where J is symmetric.
    pub fn around(&self, matrix: &BlockMatrix, r: &[f64], cycle: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
        let mut x = vec![0.0; r.len()];
        self.add_solution(r, &mut x);
        let mut change = cycle(&self.rest(matrix, &self.reach, r, &x));
        self.turns.iter().for_each(|turn| turn.forward(&mut change));
        add_combination(&mut x, &[1.0], &[change]);
        let mut rest = self.rest(matrix, &self.nodes, r, &x);
        self.turns.iter().for_each(|turn| turn.forward(&mut rest));
        self.add_solution(&rest, &mut x);
        x
    }

    fn add_solution(&self, r: &[f64], x: &mut [f64]) {
        for (dof, solved) in self.solution(r) {
            x[dof as usize] += solved;
        }
    }

    /// r − (K + J) x in the axes of space, K x at some nodes only.
    fn rest(&self, matrix: &BlockMatrix, nodes: &[u32], r: &[f64], x: &[f64]) -> Vec<f64> {
        let (n, _) = matrix.block_shape();
        let (mut rest, mut straight) = (r.to_vec(), x.to_vec());
        self.tangent.add_product(-1.0, x, &mut rest);
        for turn in &self.turns {
            turn.back(&mut rest);
            turn.back(&mut straight);
        }
        for &node in nodes {
            for (j, block) in matrix.row(node as usize) {
                for (c, row) in block.chunks_exact(n).enumerate() {
                    let product: f64 = row.iter().zip(&straight[j * n..]).map(|(entry, x)| entry * x).sum();
                    rest[node as usize * n + c] -= product;
                }
            }
            for dof in (node as usize * n..).take(n).filter(|&dof| !self.free[dof]) {
                rest[dof] = 0.0;
            }
        }
        rest
    }
}

/// The nodes that have entries.
fn seen(entries: &[Entry], n: usize) -> Vec<u32> {
    let mut nodes: Vec<u32> = entries.iter().flat_map(|(i, j, _)| [*i / n as u32, *j / n as u32]).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// The nodes between which contact has forces, and those on which it acts alone and as stiffly as the body. What it
/// adds everywhere, as a step of the proximal method does, is left to the cycle.
fn joined(body: &Body, entries: &[Entry]) -> Vec<u32> {
    let n = body.matrix.block_shape().0 as u32;
    let (mut nodes, mut alone) = (Vec::new(), BTreeMap::new());
    for &(i, j, value) in entries {
        if i / n == j / n {
            *alone.entry((i / n, i % n, j % n)).or_insert(0.0) += value;
        } else {
            nodes.extend([i / n, j / n]);
        }
    }
    let is_stiff = |&(&(node, a, b), value): &(&(u32, u32, u32), &f64)| {
        let (node, a, b) = (node as usize, a as usize, b as usize);
        let own = |c| body.matrix.get(node, c, node, c);
        value.abs() >= (own(a) * own(b)).sqrt()
    };
    nodes.extend(alone.iter().filter(is_stiff).map(|((node, ..), _)| *node));
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// Products of a matrix of each node with the node's part of a vector.
fn products(nodes: &[Node], matrix: impl Fn(&Node) -> &[f64], x: &[f64]) -> Vec<(u32, f64)> {
    let mut products = Vec::new();
    for node in nodes {
        let n = matrix(node).len().isqrt();
        let own = &x[node.number as usize * n..][..n];
        for (a, row) in matrix(node).chunks_exact(n).enumerate() {
            products.push((node.number * n as u32 + a as u32, row.iter().zip(own).map(|(entry, x)| entry * x).sum()));
        }
    }
    products
}

/// The bases of nodes that are turned.
pub(super) fn bases(turns: &[Turn], n: usize) -> BTreeMap<usize, [Point; 3]> {
    turns.iter().map(|turn| (turn.unknowns[0] as usize / n, turn.basis)).collect()
}

/// The block of J of each node.
pub(super) fn blocks(entries: &[Entry], n: usize) -> BTreeMap<usize, Vec<f64>> {
    let mut blocks: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for &(i, j, value) in entries.iter().filter(|(i, j, _)| *i as usize / n == *j as usize / n) {
        let block = blocks.entry(i as usize / n).or_insert_with(|| vec![0.0; n * n]);
        block[i as usize % n * n + j as usize % n] += value;
    }
    blocks
}

/// A node with its block of J; none where K + J is singular.
fn node_of(body: &Body, node: usize, basis: Option<&[Point; 3]>, block: &[f64]) -> Option<Node> {
    let (n, _) = body.matrix.block_shape();
    let own = in_basis(&block_of(body.matrix, node, n), [basis.unwrap_or(&AXES); 2], n, true);
    let free = |c: usize| body.free[node * n + c];
    let others = body.matrix.row(node).filter(|(j, _)| *j != node);
    let beside: f64 = others.map(|(_, entries)| entries.iter().map(|e| e * e).sum::<f64>().sqrt()).sum();
    let sum_with = |block: &[f64]| {
        Mat::from_fn(n, n, |a, b| match (free(a) && free(b), a == b) {
            (true, same) => own[a * n + b] + block[a * n + b] + if same { 0.5 * beside } else { 0.0 },
            (false, same) => f64::from(u8::from(same)),
        })
    };
    let mut sum = sum_with(block);
    let is_symmetric = (0..n * n).all(|k| block[k].to_bits() == block[k % n * n + k / n].to_bits());
    if is_symmetric && Cholesky::new(sum.clone()).is_none() {
        // Conjugate gradients are to see what makes K + J indefinite, and the preconditioner not to hide it.
        sum = sum_with(&cut(block, f64::INFINITY, n));
    }
    let factors = Lu::new(sum.clone());
    let mut inverse = vec![0.0; n * n];
    for c in (0..n).filter(|&c| free(c)) {
        let mut x: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == c))).collect();
        factors.solve(&mut x);
        (0..n).filter(|&a| free(a)).for_each(|a| inverse[a * n + c] = x[a]);
    }
    let block = (0..n * n).map(|k| sum[(k / n, k % n)]).collect();
    inverse.iter().all(|entry| entry.is_finite()).then_some(Node { number: node as u32, block, inverse })
}
