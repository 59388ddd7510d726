//! One factorization K = L Lᵀ of the interior, contact unknowns last, and the two sweeps of a step.
//!
//! The trailing block after the elimination is the condensed operator, at no further cost. Together the two sweeps read
//! the factor twice, which bounds the time per step from below.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
use faer::{Mat, Side};

use super::condensed::Condensed;
use super::error::SolveError;
use super::factor::{Backend, Factor, LowerTriangle};
use super::numeric::{Supernodes, has_factor};
use super::pages::PagedNumbers;
use super::panel::{Panel, PositionRange};
use super::repeats::{ROUND_OFF, Repeats};
use super::schur::Schur;
use super::sparse::BlockMatrix;
use super::stop::StopFlag;
use super::sweeps::Task;
use super::unknowns::Unknowns;
use crate::machine;

/// A sparse supernodal Cholesky factorization on the pattern that `faer` finds.
#[derive(Debug, Clone, Copy, Default)]
pub struct Supernodal;

impl Backend for Supernodal {
    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError> {
        Interruptible::default().factorize(matrix, unknowns)
    }

    fn interruptible(&self, flag: &Arc<AtomicBool>) -> Option<Arc<dyn Backend>> {
        Some(Arc::new(Interruptible(StopFlag::when(flag))))
    }
}

/// The supernodal backend, interruptible by a flag.
#[derive(Debug, Clone, Default)]
pub(super) struct Interruptible(pub StopFlag);

impl Backend for Interruptible {
    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError> {
        Ok(Box::new(SupernodalFactor::new(matrix, unknowns, &self.0)?))
    }

    fn interruptible(&self, flag: &Arc<AtomicBool>) -> Option<Arc<dyn Backend>> {
        Supernodal.interruptible(flag)
    }
}

/// Merging of supernodes: those of up to this many columns are merged while the fraction of zeros stays below the
/// second number. The sweeps are bound by memory traffic, so fewer zeros are allowed than would suit a factorization
/// alone.
const RELAX: &[(usize, f64)] = &[(4, 0.5), (16, 0.15)];

/// Bytes per number.
const NUMBER: f64 = 8.0;

#[derive(Debug)]
struct SupernodalFactor {
    values: PagedNumbers,
    root: Task,
    size: usize,
    interior: usize,
    condensed: Arc<Mat<f64>>,
    /// First unknown per contact node.
    nodes: Vec<usize>,
    /// Stiffness of kept unknowns where S has none: the diagonal of K, and of a rigid motion the mean over its body.
    stiffness: Vec<(usize, f64)>,
    stop: StopFlag,
}

impl SupernodalFactor {
    /// Factorizes the interior and forms S. If contact alone holds the body, S is singular, but S + J with the contact
    /// forces is not. S may be indefinite as long as adding the mean of the diagonal of K on Γ_C, or a larger rigid
    /// stiffness, makes it positive definite.
    fn new(matrix: &BlockMatrix, unknowns: &Unknowns, stop: &StopFlag) -> Result<SupernodalFactor, SolveError> {
        let (size, interior) = (unknowns.len(), unknowns.interior);
        if size == 0 {
            return Ok(SupernodalFactor {
                values: PagedNumbers::zeros(0).ok_or(SolveError::Memory { size })?,
                root: Task::default(),
                size,
                interior,
                condensed: Arc::new(Mat::new()),
                nodes: Vec::new(),
                stiffness: Vec::new(),
                stop: stop.clone(),
            });
        }
        let too_large = || SolveError::Memory { size };
        let lower = LowerTriangle::new(matrix, unknowns);
        let (start, rows) = lower.transposed_pattern();
        let symbolic = symbolic(size, &start, &rows)?;
        // The system may promise memory that it does not have; writing to it would end the program.
        let bytes = NUMBER * symbolic.len_val() as f64;
        if machine::physical_memory().is_some_and(|memory| bytes > memory.bytes) {
            return Err(too_large());
        }
        let mut values = PagedNumbers::zeros(symbolic.len_val()).ok_or_else(too_large)?;
        let SymbolicCholeskyRaw::Supernodal(symbolic) = symbolic.raw() else { return Err(too_large()) };
        let supernodes = Supernodes::new(symbolic, interior);
        supernodes.factorize(&lower, &mut values, stop)?;
        let s = supernodes.condensed(&values);
        let diagonal: Vec<f64> =
            (interior..size).map(|j| lower.column(j).next().map_or(0.0, |(_, value)| value)).collect();
        let shift = diagonal.iter().sum::<f64>() / (size - interior).max(1) as f64;
        let nodes = unknowns.kept_nodes(matrix.block_shape().0);
        let rigid = unknowns.rigid_stiffness(matrix).into_iter();
        let rigid: Vec<(usize, f64)> =
            rigid.filter_map(|(at, value)| Some((at.checked_sub(interior)?, value))).collect();
        let shift = rigid.iter().fold(shift, |shift, (_, value)| shift.max(*value));
        let stiffness = [of_nodes(&diagonal, &nodes), rigid].concat();
        has_factor(s.as_ref(), shift, stop).map_err(|error| error.of(interior, size))?;
        let mut root = SupernodeTree::new(symbolic, &supernodes, interior).root(size);
        let stored = compact(&mut root, &mut values);
        let values = values.first(stored);
        let (condensed, stop) = (Arc::new(s), stop.clone());
        Ok(SupernodalFactor { values, root, size, interior, condensed, nodes, stiffness, stop })
    }
}

/// Compacts the panels in the order of their places, without the part above the diagonal, the columns of Γ_C and
/// repeated panels, so that a sweep reads memory in order. Returns the number of stored values.
fn compact(root: &mut Task, values: &mut [f64]) -> usize {
    fn panels<'a>(task: &'a mut Task, all: &mut Vec<&'a mut Panel>) {
        task.children.iter_mut().for_each(|child| panels(child, all));
        all.extend(&mut task.panels);
    }
    let mut all = Vec::new();
    panels(root, &mut all);
    all.sort_unstable_by_key(|panel| panel.values);
    let (mut end, mut repeats) = (0, Repeats::new(ROUND_OFF));
    for panel in all {
        let (from, mut to, leading) = (panel.values, end, panel.leading);
        for j in 0..panel.columns {
            let diagonal = from + j * leading + j;
            values.copy_within(diagonal..diagonal + leading - j, to);
            to += leading - j;
        }
        let lengths = (0..panel.columns).map(|j| leading - j);
        panel.values = repeats.place((panel.columns, leading), &values[..to], end, &lengths);
        if panel.values == end {
            end = to;
        }
    }
    end
}

/// Symbolic factorization: the pattern of the factor.
pub(super) fn symbolic(size: usize, start: &[u32], rows: &[u32]) -> Result<SymbolicCholesky<u32>, SolveError> {
    let pattern = SymbolicSparseColMatRef::new_checked(size, size, start, None, rows);
    let params = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        supernodal_params: SymbolicSupernodalParams { relax: Some(RELAX) },
        ..CholeskySymbolicParams::default()
    };
    factorize_symbolic_cholesky(pattern, Side::Upper, SymmetricOrdering::Identity, params)
        .map_err(|_| SolveError::Memory { size })
}

impl Factor for SupernodalFactor {
    fn forward(&self, r: &mut [f64]) -> Result<(), SolveError> {
        let (interior, contact) = r.split_at_mut(self.interior);
        self.root.forward(&self.values, interior, contact);
        Ok(())
    }
    fn backward(&self, x: &mut [f64]) -> Result<(), SolveError> {
        let (interior, contact) = x.split_at_mut(self.interior);
        self.root.backward(&self.values, interior, contact);
        Ok(())
    }
    fn condensed(&self) -> Box<dyn Condensed> {
        let made = Schur::new(Arc::clone(&self.condensed), self.nodes.clone(), self.stop.clone());
        Box::new(made.with_scale(&self.stiffness))
    }
    fn stored(&self) -> usize {
        debug_assert!(self.size >= self.interior);
        self.values.len()
    }
}

/// The mean of the diagonal of K over each contact node, for its unknowns. It counts where a body that nothing but
/// contact holds touches with one node alone, whose S is the round-off of that diagonal.
fn of_nodes(diagonal: &[f64], nodes: &[usize]) -> Vec<(usize, f64)> {
    let ends = nodes.iter().skip(1).copied().chain([diagonal.len()]);
    let of = |(first, end): (&usize, usize)| {
        let own = diagonal.get(*first..end).unwrap_or_default();
        let mean = own.iter().sum::<f64>() / own.len().max(1) as f64;
        (*first..end).map(move |i| (i, mean))
    };
    nodes.iter().zip(ends).flat_map(of).collect()
}

/// Tree of the supernodes of a factor, for cutting it into tasks.
struct SupernodeTree<'a> {
    supernodes: &'a Supernodes<'a>,
    symbolic: &'a faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky<u32>,
    interior: usize,
    /// Number of supernodes with interior columns.
    count: usize,
    children: Vec<Vec<usize>>,
    roots: Vec<usize>,
    /// First supernode of the subtree, per supernode.
    first: Vec<usize>,
    /// Number of stored entries of the subtree, per supernode.
    work: Vec<usize>,
}

impl<'a> SupernodeTree<'a> {
    fn new(
        symbolic: &'a faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky<u32>,
        supernodes: &'a Supernodes<'a>,
        interior: usize,
    ) -> SupernodeTree<'a> {
        let begin = symbolic.supernode_begin();
        let count = (0..symbolic.n_supernodes()).take_while(|&s| (begin[s] as usize) < interior).count();
        let mut owner = vec![u32::MAX; interior];
        for s in 0..count {
            for column in begin[s] as usize..(symbolic.supernode_end()[s] as usize).min(interior) {
                owner[column] = s as u32;
            }
        }
        let mut tree = SupernodeTree {
            supernodes,
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
        let root = self.task(groups, self.interior..self.interior, 0..0, &contact);
        Task { ancestors: (0..contact.len() as u32).collect(), ..root }
    }

    /// Number of stored entries below which a subtree is one task. It is a fixed fraction, whatever the number of
    /// threads: the order of summation, hence every bit of the result, must not depend on it.
    fn grain(&self) -> usize {
        (self.roots.iter().map(|&r| self.work[r]).sum::<usize>() / 16).max(1 << 14)
    }

    /// Groups sibling subtrees into tasks, each given by its first and last supernode; small neighbours are joined.
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
        // Position of a row of the matrix in the vector of this task.
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
        let mut rows = Vec::new();
        let panels = panels
            .filter(|&s| s < self.count)
            .map(|s| {
                let view = self.symbolic.supernode(s);
                let (first, last) = (view.start(), end[s] as usize);
                let columns = last.min(self.interior) - first;
                let below = ((first + columns) as u32..last as u32).chain(view.pattern().iter().copied());
                Panel {
                    first: first - own.start,
                    columns,
                    below: PositionRange::append(below.map(&local), &mut rows),
                    values: self.supernodes.offset(s),
                    leading: last - first + view.pattern().len(),
                }
            })
            .collect();
        let start = children.iter().map(|c| c.begin).min().unwrap_or(own.start);
        Task { children, begin: start, own, panels, rows, ..Task::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Graph, Layout, System};
    use crate::mesh::{Block, Diagonal, Elements, Mesh, MeshError};

    /// Solves a diffusion with storage on an even mesh of 64 × 64 squares, the matrix of each cell times a factor.
    /// Returns the error of the solution and the number of stored entries.
    fn solved(factor: impl Fn(usize) -> f64) -> Result<(f64, usize), MeshError> {
        let mesh = Mesh::rectangle([1.0, 1.0], [64, 64], Diagonal::Left)?;
        let mut matrix = BlockMatrix::zero(&Arc::new(Graph::of_mesh(&mesh)), 1, 1);
        for (k, cell) in mesh.blocks.iter().flat_map(Block::cells).enumerate() {
            let value = |v: usize| factor(k) * if v.is_multiple_of(4) { 2.0 } else { -0.7 };
            matrix.add(cell, &(0..9).map(value).collect::<Vec<_>>());
        }
        let (free, contact) = (vec![true; mesh.points.len()], mesh.facets["bottom"].node_list());
        let layout = Layout {
            points: &mesh.points,
            components: 1,
            free: &free,
            frames: &[],
            links: &[],
            rigid: &[],
            contact: &contact,
        };
        let backend: Arc<dyn Backend> = Arc::new(Supernodal);
        let mut system = System::new(&backend, &Arc::new(matrix.clone()), &layout).expect("a factor");
        let expected: Vec<f64> = (0..free.len()).map(|i| (i as f64).sin()).collect();
        let mut x = system.unknowns().gather(&matrix.apply(&expected));
        system.solve(&mut x).expect("a solution");
        let mut found = vec![0.0; free.len()];
        system.unknowns().put(&x, &mut found);
        let error = found.iter().zip(&expected).fold(0.0f64, |most, (x, y)| most.max((x - y).abs()));
        Ok((error, system.stored()))
    }

    /// The mesh with its nodes renumbered in no order, and the nodes of a side.
    fn renumbered(mesh: &Mesh, side: &[u32]) -> (Mesh, Vec<u32>) {
        let n = mesh.points.len();
        // A step that shares no factor with n goes through all nodes.
        let step =
            (n / 3..n).find(|&step| (2..=step).all(|d| !(step.is_multiple_of(d) && n.is_multiple_of(d)))).unwrap_or(1);
        let number = |node: u32| ((node as usize * step + 7) % n) as u32;
        let mut other = mesh.clone();
        for (node, point) in mesh.points.iter().enumerate() {
            other.points[number(node as u32) as usize] = *point;
        }
        other.blocks.iter_mut().flat_map(|block| &mut block.nodes).for_each(|node| *node = number(*node));
        (other, side.iter().map(|&node| number(node)).collect())
    }

    /// Asserts that the sweeps find a known solution, for `components` unknowns per node and the matrix of cell k times
    /// `scale(k)`.
    fn solves(mesh: &Mesh, contact: &[u32], components: usize, scale: &dyn Fn(usize) -> f64) {
        let mut matrix = BlockMatrix::zero(&Arc::new(Graph::of_mesh(mesh)), components, components);
        for (k, cell) in mesh.blocks.iter().flat_map(Block::cells).enumerate() {
            let size = cell.len() * components;
            // Symmetric, and positive definite by its diagonal.
            let entry =
                |i: usize, j: usize| if i == j { size as f64 } else { -((1 + (i + 1) * (j + 1) % 5) as f64) / 5.0 };
            let values: Vec<f64> = (0..size * size).map(|v| scale(k) * entry(v / size, v % size)).collect();
            matrix.add(cell, &values);
        }
        let free: Vec<bool> = mesh.points.iter().flat_map(|[_, y, _]| vec![*y < 0.999; components]).collect();
        let layout =
            Layout { points: &mesh.points, components, free: &free, frames: &[], links: &[], rigid: &[], contact };
        let unknowns = Unknowns::new(&matrix, &layout);
        let factor = SupernodalFactor::new(&matrix, &unknowns, &StopFlag::default()).expect("a factor");
        let mut expected: Vec<f64> = (0..free.len()).map(|i| (i as f64).sin()).collect();
        expected.iter_mut().zip(&free).filter(|(_, free)| !**free).for_each(|(value, _)| *value = 0.0);
        let mut x = unknowns.gather(&matrix.apply(&expected));
        factor.forward(&mut x).expect("a sweep");
        let known = unknowns.gather(&expected);
        x[factor.interior..].copy_from_slice(&known[factor.interior..]);
        factor.backward(&mut x).expect("a sweep");
        let error = x.iter().zip(&known).fold(0.0f64, |most, (x, known)| most.max((x - known).abs()));
        assert!(error < 1e-13, "{components} per node: {error:e}");
    }

    /// The cases: both diagonals, nodes in no order, one to three unknowns per node, in the plane and in space, one
    /// cell unlike the others, two materials in no order, and no cell like another.
    #[test]
    fn the_sweeps_find_a_known_solution() -> Result<(), MeshError> {
        let alike = |_: usize| 1.0;
        let one_other = |k: usize| if k == 2000 { 1.5 } else { 1.0 };
        let mixed = |k: usize| if (k as f64 * 0.7).sin() > 0.3 { 1e4 } else { 1.0 };
        let uneven = |k: usize| 1.0 + 0.1 * (k as f64).sin();
        for diagonal in [Diagonal::Left, Diagonal::Right] {
            let mesh = Mesh::rectangle([1.0, 1.0], [64, 64], diagonal)?;
            let side = mesh.facets["bottom"].node_list();
            let (other, other_side) = renumbered(&mesh, &side);
            for (mesh, side) in [(&mesh, &side), (&other, &other_side)] {
                for scale in [&alike as &dyn Fn(usize) -> f64, &one_other, &mixed, &uneven] {
                    (1..3).for_each(|components| solves(mesh, side, components, scale));
                }
            }
        }
        let mesh = Mesh::box_([1.0; 3], [16; 3], Elements::P1)?;
        let side = mesh.facets.values().next().expect("a side").node_list();
        for scale in [&alike as &dyn Fn(usize) -> f64, &mixed] {
            solves(&mesh, &side, 3, scale);
        }
        Ok(())
    }

    /// Repeated panels are stored once, and a cell that differs by more than round-off is distinguished.
    #[test]
    fn what_repeats_is_stored_once() -> Result<(), MeshError> {
        let (error, all) = solved(|k| 1.0 + 0.1 * (k as f64).sin())?;
        assert!(error < 2e-13, "{error:e}");
        let mut before = 0;
        for more in [0.0, 1e-12, 1e-10, 1e-3, 1.0] {
            let (error, stored) = solved(|k| if k == 64 * 64 { 1.0 + more } else { 1.0 })?;
            assert!(error < 2e-13, "one cell larger by {more:e}: {error:e}");
            assert!((before..all * 2 / 3).contains(&stored), "{stored} of {all}, {before} before");
            before = stored;
        }
        Ok(())
    }
}
