//! One factorization K = L Lᵀ, contact unknowns last, and the two sweeps of a step.
//!
//! The trailing block of the factor is the condensed operator for free: S = L_CC L_CCᵀ. Together the two sweeps read
//! the factor twice, which is the bound on the time of a step.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Mat, Par, Side};
use rayon::prelude::*;

use super::condensed::Condensed;
use super::dense::gram;
use super::error::SolveError;
use super::factor::{Backend, Factor, UpperColumns, upper_columns};
use super::schur::Schur;
use super::sparse::BlockMatrix;
use super::unknowns::Unknowns;

/// The sparse supernodal Cholesky factorization of `faer` with sweeps of our own.
#[derive(Debug, Clone, Copy, Default)]
pub struct Supernodal;

impl Backend for Supernodal {
    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError> {
        Ok(Box::new(SupernodalFactor::held(matrix, unknowns)?))
    }
}

/// Supernodes of up to so many columns are merged while the share of zeros stays below. The sweeps are
/// bound by memory traffic, so fewer zeros than a factorization alone would take.
const RELAX: &[(usize, f64)] = &[(4, 0.5), (16, 0.15)];

/// Share of its diagonal entry below which a pivot of Γ_C is none: a motion that contact alone can hold.
const VANISHING: f64 = 1e-13;

/// A dense panel of the factor: columns `first..first + columns` of a task's vector, with the
/// positions of the rows below them in that vector.
#[derive(Debug)]
struct Panel {
    first: usize,
    columns: usize,
    below: Vec<u32>,
    /// Offset of the column-major values; the leading dimension is `columns + below.len()`.
    values: usize,
    leading: usize,
}

/// A subtree of the elimination tree. Its vector is (own columns, ancestors that it touches).
#[derive(Debug, Default)]
struct Task {
    children: Vec<Task>,
    /// Columns of the whole subtree that precede the own ones are the children's.
    begin: usize,
    own: std::ops::Range<usize>,
    panels: Vec<Panel>,
    /// Positions in the parent's vector of the ancestors touched.
    ancestors: Vec<u32>,
    /// How many ancestors are touched.
    touched: usize,
}

#[derive(Debug)]
struct SupernodalFactor {
    values: Vec<f64>,
    root: Task,
    size: usize,
    interior: usize,
    condensed: Arc<Mat<f64>>,
    /// First unknown of each contact node.
    nodes: Vec<usize>,
}

impl SupernodalFactor {
    /// The factor; of a body that only contact holds, that of K with a multiple of the identity added at the contact
    /// unknowns. These are last, so the multiple is in S as it is, and is taken off again: S is singular then, S + J
    /// with the contact forces is not.
    fn held(matrix: &BlockMatrix, unknowns: &Unknowns) -> Result<SupernodalFactor, SolveError> {
        let free = match SupernodalFactor::new(matrix, unknowns, 0.0) {
            Err(error @ SolveError::NotPositive { .. }) if unknowns.interior < unknowns.len() => error,
            done => return done,
        };
        let (components, _) = matrix.block_shape();
        let diagonal = unknowns.kept().iter().map(|&dof| {
            matrix.get(
                dof as usize / components,
                dof as usize % components,
                dof as usize / components,
                dof as usize % components,
            )
        });
        let shift = diagonal.sum::<f64>() / (unknowns.len() - unknowns.interior) as f64;
        let mut factor = SupernodalFactor::new(matrix, unknowns, shift).map_err(|_| free)?;
        let condensed = Arc::make_mut(&mut factor.condensed);
        for i in 0..condensed.nrows() {
            condensed[(i, i)] -= shift;
        }
        Ok(factor)
    }

    /// The factor of K with `shift` times the identity added at the contact unknowns.
    fn new(matrix: &BlockMatrix, unknowns: &Unknowns, shift: f64) -> Result<SupernodalFactor, SolveError> {
        let size = unknowns.len();
        if size == 0 {
            return Ok(SupernodalFactor {
                values: Vec::new(),
                root: Task::default(),
                size,
                interior: 0,
                condensed: Arc::new(Mat::new()),
                nodes: Vec::new(),
            });
        }
        let memory = || SolveError::Memory { size };
        let mut upper = upper_columns(matrix, unknowns);
        if shift > 0.0 {
            for column in unknowns.interior..size {
                // The diagonal is the last entry of a column.
                upper.values[upper.start[column + 1] as usize - 1] += shift;
            }
        }
        let symbolic = symbolic(&upper, size)?;
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &upper.start, None, &upper.rows);
        let mut values = Vec::new();
        values.try_reserve_exact(symbolic.len_val()).map_err(|_| memory())?;
        values.resize(symbolic.len_val(), 0.0);
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, faer::Spec::default());
        let mut buffer = MemBuffer::try_new(scratch).map_err(|_| memory())?;
        symbolic
            .factorize_numeric_llt(
                &mut values,
                SparseColMatRef::new(pattern, &upper.values),
                Side::Upper,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut buffer),
                faer::Spec::default(),
            )
            .map_err(|LltError::NonPositivePivot { index }| SolveError::NotPositive { pivot: index, size })?;
        let SymbolicCholeskyRaw::Supernodal(symbolic) = symbolic.raw() else { return Err(memory()) };
        let tree = Tree::new(symbolic, unknowns.interior);
        let root = tree.root(size);
        let l = tree.trailing(&values, size);
        // A pivot that is round-off of its diagonal entry is as good as none.
        let vanishes = |i: &usize| {
            let at = unknowns.interior + i;
            l[(*i, *i)].powi(2) <= VANISHING * upper.values[upper.start[at + 1] as usize - 1]
        };
        if let Some(index) = (0..l.nrows()).find(vanishes).filter(|_| shift == 0.0) {
            return Err(SolveError::NotPositive { pivot: unknowns.interior + index, size });
        }
        let nodes = unknowns.kept_nodes(matrix.block_shape().0);
        Ok(SupernodalFactor { values, root, size, interior: unknowns.interior, condensed: Arc::new(gram(&l)), nodes })
    }
}

/// The pattern of the factor.
fn symbolic(upper: &UpperColumns, size: usize) -> Result<SymbolicCholesky<u32>, SolveError> {
    let pattern = SymbolicSparseColMatRef::new_checked(size, size, &upper.start, None, &upper.rows);
    let params = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        supernodal_params: SymbolicSupernodalParams { relax: Some(RELAX) },
        ..CholeskySymbolicParams::default()
    };
    factorize_symbolic_cholesky(pattern, Side::Upper, SymmetricOrdering::Identity, params)
        .map_err(|_| SolveError::Memory { size })
}

/// What a factor of [`Supernodal`] stores and costs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fill {
    /// Size of the matrix.
    pub size: usize,
    /// Numbers that the factor stores.
    pub stored: usize,
    /// Operations of the factorization, additions and multiplications.
    pub flops: f64,
}

/// Counts the fill of the factor of a matrix with this pattern, without its values.
///
/// A supernode of n columns with m rows below them costs n³/3 for its own factor, m n² for the rows below, and m² n for
/// what it takes from the columns to come.
///
/// # Errors
/// When the pattern does not fit into memory.
pub fn fill(matrix: &BlockMatrix, unknowns: &Unknowns) -> Result<Fill, SolveError> {
    let size = unknowns.len();
    if size == 0 {
        return Ok(Fill::default());
    }
    let symbolic = symbolic(&upper_columns(matrix, unknowns), size)?;
    let SymbolicCholeskyRaw::Supernodal(supernodes) = symbolic.raw() else { return Err(SolveError::Memory { size }) };
    let flops = (0..supernodes.n_supernodes()).map(|s| {
        let view = supernodes.supernode(s);
        let (n, m) = ((supernodes.supernode_end()[s] as usize - view.start()) as f64, view.pattern().len() as f64);
        n * n * n / 3.0 + m * n * n + m * m * n
    });
    Ok(Fill { size, stored: symbolic.len_val(), flops: flops.sum() })
}

impl Factor for SupernodalFactor {
    fn forward(&self, r: &mut [f64]) -> Result<(), SolveError> {
        let (interior, contact) = r.split_at_mut(self.interior);
        let update = self.root.forward(&self.values, interior);
        for (r, u) in contact.iter_mut().zip(&update) {
            *r += u;
        }
        Ok(())
    }
    fn backward(&self, x: &mut [f64]) -> Result<(), SolveError> {
        let (interior, contact) = x.split_at_mut(self.interior);
        self.root.backward(&self.values, interior, contact);
        Ok(())
    }
    fn condensed(&self) -> Box<dyn Condensed> {
        Box::new(Schur::new(Arc::clone(&self.condensed), self.nodes.clone()))
    }
    fn stored(&self) -> usize {
        debug_assert!(self.size >= self.interior);
        self.values.len()
    }
}

/// The supernodes of a factor, for cutting them into tasks.
struct Tree<'a> {
    symbolic: &'a faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky<u32>,
    interior: usize,
    /// Supernodes that have interior columns.
    count: usize,
    children: Vec<Vec<usize>>,
    roots: Vec<usize>,
    /// First supernode of the subtree of each.
    first: Vec<usize>,
    /// Numbers stored in the subtree of each.
    work: Vec<usize>,
}

impl<'a> Tree<'a> {
    fn new(
        symbolic: &'a faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky<u32>,
        interior: usize,
    ) -> Tree<'a> {
        let begin = symbolic.supernode_begin();
        let count = (0..symbolic.n_supernodes()).take_while(|&s| (begin[s] as usize) < interior).count();
        let mut owner = vec![u32::MAX; interior];
        for s in 0..count {
            for column in begin[s] as usize..(symbolic.supernode_end()[s] as usize).min(interior) {
                owner[column] = s as u32;
            }
        }
        let mut tree = Tree {
            symbolic,
            interior,
            count,
            children: vec![Vec::new(); count],
            roots: Vec::new(),
            first: (0..count).collect(),
            work: vec![0; count],
        };
        for s in 0..count {
            let view = symbolic.supernode(s);
            let columns = symbolic.supernode_end()[s] as usize - view.start();
            tree.work[s] += columns * (columns + view.pattern().len());
            let parent = view.pattern().first().and_then(|&row| owner.get(row as usize));
            match parent {
                Some(&p) => {
                    let p = p as usize;
                    tree.children[p].push(s);
                    tree.work[p] += tree.work[s];
                    tree.first[p] = tree.first[p].min(tree.first[s]);
                }
                None => tree.roots.push(s),
            }
        }
        tree
    }

    /// The interior as one task whose ancestors are all contact unknowns.
    fn root(&self, size: usize) -> Task {
        let contact: Vec<u32> = (self.interior as u32..size as u32).collect();
        let groups = self.tasks(&self.roots);
        self.task(groups, self.interior..self.interior, 0..0, &contact)
    }

    /// Numbers below which a subtree is one task. A fixed share, whatever the number of threads: the
    /// order of summation, hence every bit of the result, must not depend on it.
    fn grain(&self) -> usize {
        (self.roots.iter().map(|&r| self.work[r]).sum::<usize>() / 16).max(1 << 14)
    }

    /// Sibling subtrees as first and last supernode; neighbours that are small are joined.
    fn tasks(&self, siblings: &[usize]) -> Vec<(usize, usize)> {
        let mut groups: Vec<(usize, usize)> = Vec::new();
        let (mut joined, grain) = (0, self.grain());
        for &s in siblings {
            let small = self.work[s] <= grain;
            if small && joined > 0 && joined + self.work[s] <= grain {
                if let Some(last) = groups.last_mut() {
                    last.1 = s;
                }
                joined += self.work[s];
            } else {
                groups.push((self.first[s], s));
                joined = if small { self.work[s] } else { 0 };
            }
        }
        groups
    }

    fn task(
        &self,
        groups: Vec<(usize, usize)>,
        own: std::ops::Range<usize>,
        panels: std::ops::Range<usize>,
        ancestors: &[u32],
    ) -> Task {
        // Where a row of the matrix stands in the vector of this task.
        let local = |row: u32| {
            if (row as usize) < own.end {
                row - own.start as u32
            } else {
                (own.len() + ancestors.partition_point(|&a| a < row)) as u32
            }
        };
        let begin = self.symbolic.supernode_begin();
        let end = self.symbolic.supernode_end();
        let children: Vec<Task> = groups
            .into_iter()
            .map(|(first, last)| {
                let whole = begin[first] as usize..(end[last] as usize).min(self.interior);
                let mut touched: Vec<u32> = Vec::new();
                for s in first..=last {
                    let straddling = (self.interior as u32).max(begin[s])..end[s].max(self.interior as u32);
                    touched.extend(straddling);
                    touched.extend(
                        self.symbolic.supernode(s).pattern().iter().copied().filter(|&r| r as usize >= whole.end),
                    );
                }
                touched.sort_unstable();
                touched.dedup();
                let single = self.first[last] == first;
                let mut task = if single && self.work[last] > self.grain() && !self.children[last].is_empty() {
                    self.task(
                        self.tasks(&self.children[last]),
                        begin[last] as usize..whole.end,
                        last..last + 1,
                        &touched,
                    )
                } else {
                    self.task(Vec::new(), whole, first..last + 1, &touched)
                };
                task.ancestors = touched.into_iter().map(&local).collect();
                task
            })
            .collect();
        let panels = panels
            .filter(|&s| s < self.count)
            .map(|s| {
                let view = self.symbolic.supernode(s);
                let (first, last) = (view.start(), end[s] as usize);
                let columns = last.min(self.interior) - first;
                let below =
                    ((first + columns) as u32..last as u32).chain(view.pattern().iter().copied()).map(&local).collect();
                Panel {
                    first: first - own.start,
                    columns,
                    below,
                    values: self.symbolic.col_ptr_for_val()[s] as usize,
                    leading: last - first + view.pattern().len(),
                }
            })
            .collect();
        let start = children.iter().map(|c| c.begin).min().unwrap_or(own.start);
        Task { children, begin: start, own, panels, ancestors: Vec::new(), touched: ancestors.len() }
    }

    /// The trailing columns L_CC, of which S = L_CC L_CCᵀ.
    fn trailing(&self, values: &[f64], size: usize) -> Mat<f64> {
        let n = size - self.interior;
        let mut l = Mat::<f64>::zeros(n, n);
        for s in 0..self.symbolic.n_supernodes() {
            let view = self.symbolic.supernode(s);
            let (first, last) = (view.start(), self.symbolic.supernode_end()[s] as usize);
            let rows: Vec<usize> = (first..last).chain(view.pattern().iter().map(|&r| r as usize)).collect();
            let offset = self.symbolic.col_ptr_for_val()[s] as usize;
            for column in first.max(self.interior)..last {
                for (k, &row) in rows.iter().enumerate().skip(column - first) {
                    l[(row - self.interior, column - self.interior)] =
                        values[offset + (column - first) * rows.len() + k];
                }
            }
        }
        l
    }
}

impl Task {
    /// Solves L y = r on the columns of the subtree; returns what is added to the ancestors.
    fn forward(&self, values: &[f64], x: &mut [f64]) -> Vec<f64> {
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
        let mut dense = Vec::new();
        for panel in &self.panels {
            panel.forward(values, &mut vector, &mut dense);
        }
        own.copy_from_slice(&vector[..width]);
        vector.split_off(width)
    }

    /// Solves Lᵀ x = y on the columns of the subtree with the ancestors known.
    fn backward(&self, values: &[f64], x: &mut [f64], ancestors: &[f64]) {
        let (mut inner, own) = x.split_at_mut(self.own.start - self.begin);
        let width = self.own.len();
        let mut vector = Vec::with_capacity(width + ancestors.len());
        vector.extend_from_slice(own);
        vector.extend_from_slice(ancestors);
        let mut dense = Vec::new();
        for panel in self.panels.iter().rev() {
            panel.backward(values, &mut vector, &mut dense);
        }
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

impl Panel {
    fn forward(&self, values: &[f64], vector: &mut [f64], dense: &mut Vec<f64>) {
        let (n, ld) = (self.columns, self.leading);
        dense.clear();
        dense.extend_from_slice(&vector[self.first..self.first + n]);
        dense.resize(ld, 0.0);
        let column = |j: usize| &values[self.values + j * ld..self.values + (j + 1) * ld];
        let mut j = 0;
        while j + 4 <= n {
            let c = [column(j), column(j + 1), column(j + 2), column(j + 3)];
            let mut z = [0.0; 4];
            for a in 0..4 {
                let mut s = dense[j + a];
                for b in 0..a {
                    s -= c[b][j + a] * z[b];
                }
                z[a] = s / c[a][j + a];
            }
            dense[j..j + 4].copy_from_slice(&z);
            let tail = &mut dense[j + 4..];
            let c = c.map(|c| &c[j + 4..]);
            let m = tail.len();
            let (c0, c1, c2, c3) = (&c[0][..m], &c[1][..m], &c[2][..m], &c[3][..m]);
            for i in 0..m {
                tail[i] -= (c0[i] * z[0] + c1[i] * z[1]) + (c2[i] * z[2] + c3[i] * z[3]);
            }
            j += 4;
        }
        while j < n {
            let c = column(j);
            let z = dense[j] / c[j];
            dense[j] = z;
            for (d, c) in dense[j + 1..].iter_mut().zip(&c[j + 1..]) {
                *d -= c * z;
            }
            j += 1;
        }
        vector[self.first..self.first + n].copy_from_slice(&dense[..n]);
        for (&at, d) in self.below.iter().zip(&dense[n..]) {
            vector[at as usize] += d;
        }
    }

    fn backward(&self, values: &[f64], vector: &mut [f64], dense: &mut Vec<f64>) {
        let (n, ld) = (self.columns, self.leading);
        dense.clear();
        dense.extend_from_slice(&vector[self.first..self.first + n]);
        dense.extend(self.below.iter().map(|&at| vector[at as usize]));
        let column = |j: usize| &values[self.values + j * ld..self.values + (j + 1) * ld];
        let mut j = n;
        // The odd columns come last here as they did in the forward sweep.
        while j % 4 != 0 {
            j -= 1;
            let c = column(j);
            let s: f64 = c[j + 1..].iter().zip(&dense[j + 1..]).map(|(c, d)| c * d).sum();
            dense[j] = (dense[j] - s) / c[j];
        }
        while j >= 4 {
            j -= 4;
            let c = [column(j), column(j + 1), column(j + 2), column(j + 3)];
            let tail = &dense[j + 4..];
            let sums = dot4(c.map(|c| &c[j + 4..]), tail);
            for a in (0..4).rev() {
                let mut s = dense[j + a] - sums[a];
                for b in a + 1..4 {
                    s -= c[a][j + b] * dense[j + b];
                }
                dense[j + a] = s / c[a][j + a];
            }
        }
        vector[self.first..self.first + n].copy_from_slice(&dense[..n]);
    }
}

/// Four dot products with one vector, in two lanes each: eight sums that stay in registers.
fn dot4(c: [&[f64]; 4], x: &[f64]) -> [f64; 4] {
    let (pairs, rest) = x.as_chunks::<2>();
    let m = pairs.len();
    let [c0, c1, c2, c3] = c.map(|c| &c.as_chunks::<2>().0[..m]);
    let (mut s0, mut s1, mut s2, mut s3) = ([0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]);
    for i in 0..m {
        let x = pairs[i];
        for l in 0..2 {
            s0[l] += c0[i][l] * x[l];
            s1[l] += c1[i][l] * x[l];
            s2[l] += c2[i][l] * x[l];
            s3[l] += c3[i][l] * x[l];
        }
    }
    let lanes = [s0, s1, s2, s3];
    std::array::from_fn(|a| {
        let tail: f64 = c[a][2 * m..].iter().zip(rest).map(|(c, x)| c * x).sum();
        lanes[a][0] + lanes[a][1] + tail
    })
}
