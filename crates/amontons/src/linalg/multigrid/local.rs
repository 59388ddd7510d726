//! Local solver for K + J on the degrees of freedom that contact touches, applied before and after the multigrid cycle.
//!
//! If contact holds a point, J is 2²⁷ times as stiff as K, and the residual and the right-hand side are as large there:
//! they would hide all others. A residual is therefore measured by the displacement that it means, L r on what contact
//! touches, times the stiffness of K. L is (K + J)⁻¹ there if contact couples nodes, and otherwise node by node with
//! the block of K plus half of the norms of its off-diagonal blocks: K is at most twice these blocks, so that no
//! solution overshoots so far that the preconditioner would be indefinite. The residual that an iteration leaves there
//! is solved once more at its end, so that the contact forces, which are computed from J x, are as accurate as x.

use std::collections::BTreeMap;

use faer::Mat;

use super::masked::{AXES, MaskedMatrix, bases, block_of, blocks, cut, in_basis};
use super::surface::{ContactFactor, couples};
use crate::linalg::error::SolveError;
use crate::linalg::lu::{Cholesky, Lu, Square};
use crate::linalg::tangent::{Entry, Tangent};
use crate::linalg::turn::Turn;
use crate::linalg::vectors::add_combination;
use crate::tensor::Point;

/// The nodes that contact touches, with J in the bases of the turns. Vectors over them, with the degrees of freedom of
/// the nodes one after the other, are small beside those of the body, which are read and written at these nodes only.
#[derive(Debug)]
pub struct ContactBlocks {
    solver: LocalFactor,
    /// Nodes on which the local system is solved and nodes with turned unknowns, with their degrees of freedom; and J
    /// and the turns, both numbered by place among these.
    nodes: Vec<u32>,
    dofs: Vec<u32>,
    tangent: Tangent,
    turns: Vec<Turn>,
}

#[derive(Debug)]
enum LocalFactor {
    /// One factor per node.
    Nodes(Vec<NodeFactor>),
    /// One factor for all nodes, if contact couples nodes.
    Surface(Box<ContactFactor>),
}

/// Block of L⁻¹ of a node over its degrees of freedom, and its inverse; `first` is the first degree of freedom.
#[derive(Debug)]
struct NodeFactor {
    first: u32,
    block: Vec<f64>,
    inverse: Vec<f64>,
}

impl ContactBlocks {
    /// Builds the solver for the tangent of contact, which has at least one entry; `before` is that of an earlier one.
    ///
    /// # Errors
    /// When contact couples nodes and K + J is singular on them.
    pub(super) fn new(
        body: &MaskedMatrix,
        tangent: &Tangent,
        turns: &[Turn],
        before: Option<&ContactBlocks>,
    ) -> Result<ContactBlocks, SolveError> {
        let (n, _) = body.matrix.block_shape();
        let bases = bases(turns, n);
        let entries: Vec<Entry> = tangent.entries().collect();
        let is_coupled = couples(&entries, n);
        let mut nodes = if is_coupled { joined(body, &entries) } else { seen(&entries, n) };
        let mut solver = if is_coupled {
            let before = before.and_then(|before| before.solver.surface());
            LocalFactor::Surface(Box::new(ContactFactor::new(body, &nodes, &entries, &bases, before)?))
        } else {
            let of = |(node, block): (usize, Vec<f64>)| node_of(body, node, bases.get(&node), &block);
            LocalFactor::Nodes(blocks(&entries, n).into_iter().filter_map(of).collect())
        };
        nodes.extend(bases.keys().map(|&node| node as u32));
        nodes.sort_unstable();
        nodes.dedup();
        let size = n as u32;
        let dofs: Vec<u32> = nodes.iter().flat_map(|&node| node * size..(node + 1) * size).collect();
        let place = |dof: u32| dofs.binary_search(&dof).ok().map(|place| place as u32);
        let place_here = |dof: u32| place(dof).unwrap_or_default();
        solver.rename(place_here);
        // Contact elsewhere couples no nodes, so that it does not affect these.
        let tangent = tangent.within(place);
        let turns = turns.iter().map(|turn| Turn { unknowns: turn.unknowns.map(place_here), ..*turn }).collect();
        Ok(ContactBlocks { solver, nodes, dofs, tangent, turns })
    }

    /// L r, by degree of freedom.
    pub(super) fn solution(&self, r: impl Fn(u32) -> f64) -> Vec<(u32, f64)> {
        self.by_degree(self.solver.solution(|place| r(self.dofs[place as usize])))
    }

    /// L⁻¹ x, by degree of freedom.
    pub(super) fn load(&self, x: impl Fn(u32) -> f64) -> Vec<(u32, f64)> {
        self.by_degree(self.load_at(|place: u32| x(self.dofs[place as usize])))
    }

    /// L⁻¹ x, by place.
    fn load_at(&self, x: impl Fn(u32) -> f64) -> Vec<(u32, f64)> {
        match &self.solver {
            LocalFactor::Surface(surface) => surface.load(x),
            LocalFactor::Nodes(nodes) => products(nodes, |node| &node.block, x),
        }
    }

    /// Renumbers values from places to degrees of freedom.
    fn by_degree(&self, mut values: Vec<(u32, f64)>) -> Vec<(u32, f64)> {
        for (place, _) in &mut values {
            *place = self.dofs[*place as usize];
        }
        values
    }

    /// Approximate solution of (K + J) x = r by `cycle`, which works in the axes of space, between two local solutions
    /// where contact acts: a symmetric operator if J is symmetric.
    pub(super) fn around(&self, body: &MaskedMatrix, mut r: Vec<f64>, cycle: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
        let own = self.taken(&r);
        let before = self.solved(&own);
        self.put(&self.straight(self.without_forces(&own, &before)), &mut r);
        self.take_off(body, &self.straight(before.clone()), &mut r);
        let mut x = cycle(&r);
        let mut here = self.turned(self.taken(&x));
        add_combination(&mut here, &[1.0], &[before]);
        self.put(&self.straight(here.clone()), &mut x);
        let mut rest = self.without_forces(&own, &here);
        add_combination(&mut rest, &[-1.0], &[self.turned(self.product(body, &x))]);
        add_combination(&mut here, &[1.0], &[self.solved(&rest)]);
        self.put(&here, &mut x);
        x
    }

    /// Degrees of freedom of the local vectors, ascending.
    #[must_use]
    pub fn dofs(&self) -> &[u32] {
        &self.dofs
    }

    /// Weighs a local residual: the displacement L r that it means, times the stiffness of K per degree of freedom,
    /// which `scale` gives. Local vectors have an entry per degree of freedom of [`ContactBlocks::dofs`].
    pub fn weigh(&self, r: &mut [f64], scale: impl Fn(u32) -> f64) {
        for (place, x) in self.solver.solution(|place| r[place as usize]) {
            r[place as usize] = scale(self.dofs[place as usize]) * x;
        }
    }

    /// Inverse of [`ContactBlocks::weigh`].
    pub fn unweigh(&self, weighed: &mut [f64], scale: impl Fn(u32) -> f64) {
        for (place, load) in self.load_at(|place| weighed[place as usize] / scale(self.dofs[place as usize])) {
            weighed[place as usize] = load;
        }
    }

    /// Reads the local entries of a vector of the body.
    fn taken(&self, of_body: &[f64]) -> Vec<f64> {
        self.dofs.iter().map(|&dof| of_body[dof as usize]).collect()
    }

    /// Writes the local entries of a vector of the body.
    fn put(&self, here: &[f64], of_body: &mut [f64]) {
        self.dofs.iter().zip(here).for_each(|(&dof, here)| of_body[dof as usize] = *here);
    }

    /// Transforms a local vector into the bases of the turns; [`ContactBlocks::straight`] transforms it back.
    #[must_use]
    pub fn turned(&self, mut x: Vec<f64>) -> Vec<f64> {
        self.turns.iter().for_each(|turn| turn.forward(&mut x));
        x
    }

    /// Transforms a local vector from the bases of the turns into the axes of space.
    #[must_use]
    pub fn straight(&self, mut x: Vec<f64>) -> Vec<f64> {
        self.turns.iter().for_each(|turn| turn.back(&mut x));
        x
    }

    /// Local solution L r.
    #[must_use]
    pub fn solved(&self, r: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; r.len()];
        for (place, value) in self.solver.solution(|place| r[place as usize]) {
            x[place as usize] = value;
        }
        x
    }

    /// Residual r − J x.
    #[must_use]
    pub fn without_forces(&self, r: &[f64], x: &[f64]) -> Vec<f64> {
        let mut rest = r.to_vec();
        self.tangent.add_product(-1.0, x, &mut rest);
        rest
    }

    /// Subtracts K x from r, with x zero outside the local nodes: K is symmetric, so that its local rows suffice.
    fn take_off(&self, body: &MaskedMatrix, x: &[f64], r: &mut [f64]) {
        let (n, _) = body.matrix.block_shape();
        for (&node, x) in self.nodes.iter().zip(x.chunks_exact(n)) {
            for (j, block) in body.matrix.row(node as usize) {
                for a in (0..n).filter(|&a| body.free[j * n + a]) {
                    r[j * n + a] -= (0..n).map(|b| block[b * n + a] * x[b]).sum::<f64>();
                }
            }
        }
    }

    /// Local entries of K x.
    fn product(&self, body: &MaskedMatrix, x: &[f64]) -> Vec<f64> {
        let (n, _) = body.matrix.block_shape();
        let mut product = vec![0.0; self.dofs.len()];
        for (&node, product) in self.nodes.iter().zip(product.chunks_exact_mut(n)) {
            for (j, block) in body.matrix.row(node as usize) {
                for (product, row) in product.iter_mut().zip(block.chunks_exact(n)) {
                    *product += row.iter().zip(&x[j * n..]).map(|(entry, x)| entry * x).sum::<f64>();
                }
            }
        }
        product
    }
}

impl LocalFactor {
    /// The factor for all nodes, if there is one.
    fn surface(&self) -> Option<&ContactFactor> {
        match self {
            LocalFactor::Surface(surface) => Some(surface),
            LocalFactor::Nodes(_) => None,
        }
    }

    /// Renumbers the degrees of freedom; those of a node stay consecutive.
    fn rename(&mut self, name: impl Fn(u32) -> u32) {
        match self {
            LocalFactor::Surface(surface) => {
                for dof in &mut surface.dofs {
                    *dof = name(*dof);
                }
            }
            LocalFactor::Nodes(nodes) => {
                for node in nodes {
                    node.first = name(node.first);
                }
            }
        }
    }

    /// Local solution L r, by place.
    fn solution(&self, r: impl Fn(u32) -> f64) -> Vec<(u32, f64)> {
        match self {
            LocalFactor::Surface(surface) => surface.solution(r),
            LocalFactor::Nodes(nodes) => products(nodes, |node| &node.inverse, r),
        }
    }
}

/// Nodes that have entries, ascending.
fn seen(entries: &[Entry], n: usize) -> Vec<u32> {
    let mut nodes: Vec<u32> = entries.iter().flat_map(|(i, j, _)| [*i / n as u32, *j / n as u32]).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// Nodes coupled by contact, and those on which it acts alone and at least as stiffly as the body. A term on all nodes,
/// as that of a step of the proximal method, is left to the cycle.
fn joined(body: &MaskedMatrix, entries: &[Entry]) -> Vec<u32> {
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

/// Products of one matrix per node with the node's part of a vector.
fn products(nodes: &[NodeFactor], matrix: impl Fn(&NodeFactor) -> &[f64], x: impl Fn(u32) -> f64) -> Vec<(u32, f64)> {
    let mut products = Vec::with_capacity(3 * nodes.len());
    for node in nodes {
        let n = matrix(node).len().isqrt();
        for (at, row) in (node.first..).zip(matrix(node).chunks_exact(n)) {
            products.push((at, (node.first..).zip(row).map(|(at, entry)| entry * x(at)).sum()));
        }
    }
    products
}

/// Factor of a node with its block of J, or `None` if K + J is singular there.
fn node_of(body: &MaskedMatrix, node: usize, basis: Option<&[Point; 3]>, block: &[f64]) -> Option<NodeFactor> {
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
    if is_symmetric && Cholesky::new(Square::of(sum.as_ref())).is_none() {
        // Conjugate gradients must detect an indefinite K + J; the preconditioner must not hide it.
        sum = sum_with(&cut(block, f64::INFINITY, n));
    }
    let factors = Lu::new(Square::of(sum.as_ref()));
    let mut inverse = vec![0.0; n * n];
    for c in (0..n).filter(|&c| free(c)) {
        let mut x: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == c))).collect();
        factors.solve(&mut x);
        (0..n).filter(|&a| free(a)).for_each(|a| inverse[a * n + c] = x[a]);
    }
    let block = (0..n * n).map(|k| sum[(k / n, k % n)]).collect();
    inverse.iter().all(|entry| entry.is_finite()).then_some(NodeFactor { first: (node * n) as u32, block, inverse })
}
