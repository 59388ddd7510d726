//! The levels of smoothed aggregation and their V-cycle, in single precision, which suffices for a preconditioner and
//! halves the memory traffic.

use faer::{Mat, Side};
use rayon::prelude::*;

use super::aggregate::{aggregates, centers, strong};
use super::blocks::{BlockRowMatrix, add_product};
use super::prolongation::{ProlongationSmoother, tentative};
use crate::linalg::error::SolveError;
use crate::linalg::lu::{Lu, Square};
use crate::linalg::stop::StopFlag;
use crate::linalg::vectors::{BLOCK, dot, max_abs};
use crate::tensor::Point;

/// Number of unknowns below which a level is solved with a dense factor, and largest number of levels.
const COARSEST: usize = 600;
const LEVELS: usize = 12;
/// Degree of the smoothing polynomial, and the fraction of the largest eigenvalue above which it damps.
const DEGREE: usize = 2;
const DAMPED: f64 = 0.1;
/// Number of products for estimating the largest eigenvalue of D⁻¹A, and the scale by which the estimate is enlarged.
const LANCZOS: usize = 12;
const SAFETY: f64 = 1.05;
/// Relative shift of the diagonal of the coarsest matrix: a body that only contact holds has motions without energy.
const SHIFT: f64 = 1e-7;

/// A level: the matrix A with its smoother, and the transfer to the next coarser level.
#[derive(Debug)]
struct Level {
    /// A plus the contribution of contact.
    matrix: BlockRowMatrix<f32>,
    /// Contribution of contact where A has no blocks: between nodes of different bodies.
    beside: CouplingBlocks,
    /// Inverse diagonal blocks.
    diagonal: Vec<f32>,
    /// Largest eigenvalue of D⁻¹A.
    largest: f32,
    /// Prolongation P and restriction Pᵀ, or `None` on the coarsest level.
    transfer: Option<[BlockRowMatrix<f32>; 2]>,
}

/// A few blocks, each with its row and column.
#[derive(Debug, Default)]
struct CouplingBlocks {
    at: Vec<[u32; 2]>,
    values: Vec<f32>,
}

/// The hierarchy of levels.
#[derive(Debug)]
pub(super) struct Hierarchy {
    levels: Vec<Level>,
    /// Factor of the coarsest matrix, and that matrix without contact divided by the scale. `None` if nodes are coupled
    /// so weakly that there is no coarser level: then the smoother alone solves.
    coarsest: Option<(Lu, Mat<f64>)>,
    /// Blocks that contact has changed, with their earlier values.
    changed: Vec<Changed>,
    /// Scale by which the matrix is divided, so that it is in the range of single precision.
    scale: f64,
}

/// A diagonal or off-diagonal block that contact has changed.
#[derive(Debug)]
struct Changed {
    level: usize,
    /// Row and column of the block.
    at: [usize; 2],
    /// The block before the change, and its inverse before if it is on the diagonal.
    block: Vec<f32>,
    inverse: Option<Vec<f32>>,
}

/// Input of a hierarchy.
pub(super) struct HierarchyPlan<'a> {
    /// Matrix, with unit blocks at degrees of freedom that are left out.
    pub matrix: &'a BlockRowMatrix<f64>,
    /// Point per node, or nothing.
    pub points: &'a [Point],
    /// Zero-energy modes: a block of `size` × m per node.
    pub modes: &'a [f64],
    pub count: usize,
    /// Degrees of freedom that take part.
    pub takes_part: &'a [bool],
    pub stop: &'a StopFlag,
}

impl Hierarchy {
    /// Builds the levels.
    pub fn new(plan: &HierarchyPlan) -> Result<Hierarchy, SolveError> {
        let size = plan.matrix.shape[0];
        let diagonal = |i: usize| plan.matrix.row(i).find(|(j, _)| *j == i).map_or(0.0, |(_, block)| block[0].abs());
        let scale = (0..plan.matrix.len()).map(diagonal).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let mut takes_part: Vec<bool> =
            plan.takes_part.chunks_exact(size).map(|node| node.iter().any(|t| *t)).collect();
        let mut masked: Option<Vec<bool>> = Some(plan.takes_part.to_vec());
        let (mut matrix, mut modes) = (std::borrow::Cow::Borrowed(plan.matrix), plan.modes.to_vec());
        let mut points = plan.points.to_vec();
        let mut levels = Vec::new();
        loop {
            plan.stop.go_on()?;
            let level_size = matrix.shape[0];
            let diagonal = inverse_diagonal(&matrix);
            let largest = SAFETY * largest_eigenvalue(&matrix, &diagonal);
            let single = |transfer| Level {
                matrix: matrix.single(scale),
                beside: CouplingBlocks::default(),
                // Entries beyond single precision are left to the iteration.
                diagonal: diagonal
                    .iter()
                    .map(|d| (d * scale) as f32)
                    .map(|d| if d.is_finite() { d } else { 0.0 })
                    .collect(),
                largest: largest as f32,
                transfer,
            };
            if matrix.len() * level_size <= COARSEST || levels.len() + 1 == LEVELS {
                levels.push(single(None));
                break;
            }
            let strong = strong(&matrix, &points);
            let (of, count) = aggregates(&strong, &takes_part);
            if 2 * count > matrix.len() {
                levels.push(single(None));
                break;
            }
            let (tentative, coarse_modes) = tentative(&of, count, &modes, [level_size, plan.count]);
            let smoother = ProlongationSmoother { matrix: &matrix, strong: &strong, diagonal: &diagonal, largest };
            let smoothed = smoother.smoothed(&tentative, masked.take().as_deref());
            drop(strong);
            let restriction = smoothed.transposed();
            let coarse = with_unit_blocks(restriction.around(&matrix, &smoothed));
            // In double precision each is dropped as soon as it can be: this is where a run has the most in memory.
            let prolongation = smoothed.into_single();
            levels.push(single(Some([prolongation, restriction.into_single()])));
            (matrix, modes) = (std::borrow::Cow::Owned(coarse), coarse_modes);
            points = centers(&of, count, &points);
            takes_part = vec![true; count];
        }
        let is_small = matrix.len() * matrix.shape[0] <= COARSEST;
        let coarsest =
            is_small.then(|| dense(&matrix, scale)).map(|dense| (Lu::new(Square::of(dense.as_ref())), dense));
        Ok(Hierarchy { coarsest, levels, changed: Vec::new(), scale })
    }

    /// Adds the forces of contact to K, in place of those added before: a symmetric matrix with few rows. On the
    /// coarser levels it is PᵀJP with the P of K alone.
    pub fn add(&mut self, contact: &BlockRowMatrix<f64>) {
        for Changed { level, at: [i, j], block, inverse } in self.changed.drain(..).rev() {
            let level = &mut self.levels[level];
            if let Some(values) = level.matrix.block_mut(i, j) {
                values.copy_from_slice(&block);
            }
            if let Some(inverse) = inverse {
                level.diagonal[i * inverse.len()..][..inverse.len()].copy_from_slice(&inverse);
            }
        }
        let couples = (0..contact.len()).any(|i| contact.row(i).any(|(j, _)| j != i));
        let mut added = contact.single(self.scale);
        for l in 0..self.levels.len() {
            let next = self.levels[l].transfer.as_ref().map(|[p, r]| r.times(&added.times(p)));
            self.patch(l, &added, couples);
            match next {
                Some(next) => added = next,
                None => self.solve_with(&added),
            }
        }
    }

    /// Adds a matrix to that of a level. If contact couples nodes, the smoother replaces the blocks of a row by one on
    /// the diagonal that is no less: D⁻¹A then has no larger eigenvalues than without contact, and the polynomial
    /// damps.
    fn patch(&mut self, l: usize, added: &BlockRowMatrix<f32>, couples: bool) {
        let level = &mut self.levels[l];
        let n = level.matrix.shape[0];
        level.beside = CouplingBlocks::default();
        for i in 0..added.len() {
            let others = added.row(i).filter(|(j, _)| couples && *j != i);
            let beyond: f64 = others.map(|(_, block)| size(block, n)).sum();
            for (j, block) in added.row(i) {
                let Some(values) = level.matrix.block_mut(i, j) else {
                    level.beside.at.push([i as u32, j as u32]);
                    level.beside.values.extend(block);
                    continue;
                };
                let before = values.to_vec();
                values.iter_mut().zip(block).for_each(|(value, added)| *value += added);
                let inverse = (i == j).then(|| {
                    let mut whole: Vec<f64> = values.iter().map(|v| f64::from(*v)).collect();
                    (0..n).for_each(|c| whole[c * n + c] += beyond);
                    let mut inverse = vec![0.0; n * n];
                    invert(&whole, &mut inverse, n);
                    let place = &mut level.diagonal[i * n * n..][..n * n];
                    let before = place.to_vec();
                    place.iter_mut().zip(&inverse).for_each(|(place, inverse)| *place = *inverse as f32);
                    before
                });
                self.changed.push(Changed { level: l, at: [i, j], block: before, inverse });
            }
        }
    }

    /// Factorizes the coarsest matrix plus the contribution of contact.
    fn solve_with(&mut self, added: &BlockRowMatrix<f32>) {
        let Some((factor, dense)) = &mut self.coarsest else { return };
        let (mut matrix, n) = (Square::of(dense.as_ref()), added.shape[0]);
        for i in 0..added.len() {
            for (j, block) in added.row(i) {
                for (k, value) in block.iter().enumerate() {
                    matrix.add(i * n + k / n, j * n + k % n, f64::from(*value));
                }
            }
        }
        *factor = Lu::new(matrix);
    }

    /// One V-cycle for A x = b from x = 0: a symmetric operator.
    pub fn cycle(&self, b: &[f64]) -> Vec<f64> {
        // Scaled into the range of single precision, for any units of b.
        let size = max_abs(b);
        if size == 0.0 || !size.is_finite() {
            return vec![0.0; b.len()];
        }
        let right: Vec<f32> = b.par_iter().with_min_len(BLOCK).map(|b| (b / size) as f32).collect();
        let factor = size / self.scale;
        self.level(0, &right).par_iter().with_min_len(BLOCK).map(|x| f64::from(*x) * factor).collect()
    }

    fn level(&self, l: usize, b: &[f32]) -> Vec<f32> {
        let level = &self.levels[l];
        let mut x = vec![0.0; b.len()];
        let Some([prolongation, restriction]) = &level.transfer else { return self.solved(level, b, x) };
        let mut work = WorkVectors::new(b.len());
        level.smooth(b, &mut x, &mut work, true);
        let rest = level.rest(b, &x, &mut work);
        let mut coarse = vec![0.0; restriction.len() * restriction.shape[0]];
        restriction.apply(rest, &mut coarse, false);
        let correction = self.level(l + 1, &coarse);
        prolongation.apply(&correction, &mut x, true);
        level.smooth(b, &mut x, &mut work, false);
        x
    }

    /// Solves on the coarsest level by its factor, or else by the smoother, applied twice so that the operator is
    /// symmetric.
    fn solved(&self, level: &Level, b: &[f32], mut x: Vec<f32>) -> Vec<f32> {
        let Some((factor, _)) = &self.coarsest else {
            let mut work = WorkVectors::new(b.len());
            level.smooth(b, &mut x, &mut work, true);
            level.smooth(b, &mut x, &mut work, false);
            return x;
        };
        let mut solved: Vec<f64> = b.iter().map(|b| f64::from(*b)).collect();
        factor.solve(&mut solved);
        solved.into_iter().map(|x| x as f32).collect()
    }
}

impl CouplingBlocks {
    /// Adds A x to y, with blocks of size n.
    fn add(&self, n: usize, x: &[f32], y: &mut [f32]) {
        match n {
            1 => self.add_sized::<1>(x, y),
            2 => self.add_sized::<2>(x, y),
            3 => self.add_sized::<3>(x, y),
            6 => self.add_sized::<6>(x, y),
            _ => {
                for (&[i, j], block) in self.at.iter().zip(self.values.chunks_exact(n * n)) {
                    let (x, y) = (&x[j as usize * n..][..n], &mut y[i as usize * n..][..n]);
                    add_product(block, x, y, [n, n, 1]);
                }
            }
        }
    }

    /// The same, with the size known at compile time.
    fn add_sized<const N: usize>(&self, x: &[f32], y: &mut [f32]) {
        let ((x, _), (y, _)) = (x.as_chunks::<N>(), y.as_chunks_mut::<N>());
        for (&[i, j], block) in self.at.iter().zip(self.values.chunks_exact(N * N)) {
            let (x, y) = (&x[j as usize], &mut y[i as usize]);
            for (y, row) in y.iter_mut().zip(block.as_chunks::<N>().0) {
                *y += (0..N).map(|c| row[c] * x[c]).sum::<f32>();
            }
        }
    }
}

/// Work vectors of a level: A x or the residual, and the last step of the smoother.
struct WorkVectors {
    product: Vec<f32>,
    step: Vec<f32>,
}

impl WorkVectors {
    fn new(length: usize) -> WorkVectors {
        WorkVectors { product: vec![0.0; length], step: vec![0.0; length] }
    }
}

/// Nodes per task.
const NODES: usize = 1024;

impl Level {
    /// A x.
    fn multiply(&self, x: &[f32], product: &mut [f32]) {
        self.matrix.apply(x, product, false);
        self.beside.add(self.matrix.shape[0], x, product);
    }

    /// b − A x.
    fn rest<'w>(&self, b: &[f32], x: &[f32], work: &'w mut WorkVectors) -> &'w [f32] {
        self.multiply(x, &mut work.product);
        work.product.par_iter_mut().with_min_len(NODES).zip(b).for_each(|(rest, b)| *rest = b - *rest);
        &work.product
    }

    /// Chebyshev smoother: a polynomial in D⁻¹A that damps errors with eigenvalues between [`DAMPED`] of the largest
    /// and the largest (Adams, Brezina, Hu, Tuminaro, J. Comput. Phys. 188 (2003) 593). `from_zero` is true if x is
    /// zero and the work vectors are new.
    fn smooth(&self, b: &[f32], x: &mut [f32], work: &mut WorkVectors, from_zero: bool) {
        let (high, low) = (self.largest, DAMPED as f32 * self.largest);
        let (center, radius) = (0.5 * (high + low), 0.5 * (high - low));
        let sigma = center / radius;
        let (mut rho, mut factors) = (sigma.recip(), [0.0, center.recip()]);
        for k in 0..DEGREE {
            if k > 0 || !from_zero {
                self.multiply(x, &mut work.product);
            }
            match self.matrix.shape[0] {
                1 => self.advance::<1>(b, x, work, factors),
                2 => self.advance::<2>(b, x, work, factors),
                3 => self.advance::<3>(b, x, work, factors),
                6 => self.advance::<6>(b, x, work, factors),
                _ => self.advance::<0>(b, x, work, factors),
            }
            let next = (2.0 * sigma - rho).recip();
            (factors, rho) = ([rho * next, 2.0 * next / radius], next);
        }
    }

    /// Adds the next step of the smoother to x: `carried` times the step before plus `taken` times D⁻¹(b − A x). `N` is
    /// the number of unknowns per node, or 0 if it is not known at compile time.
    fn advance<const N: usize>(&self, b: &[f32], x: &mut [f32], work: &mut WorkVectors, [carried, taken]: [f32; 2]) {
        let size = self.matrix.shape[0];
        let blocks = self.diagonal.par_chunks(NODES * size * size).zip(b.par_chunks(NODES * size));
        let vectors = work.step.par_chunks_mut(NODES * size).zip(work.product.par_chunks(NODES * size));
        vectors.zip(x.par_chunks_mut(NODES * size)).zip(blocks).for_each(|(((step, product), x), (blocks, b))| {
            let n = if N == 0 { size } else { N };
            for at in (0..step.len()).step_by(n) {
                let block = &blocks[at * n..][..n * n];
                let (b, product) = (&b[at..at + n], &product[at..at + n]);
                for (a, row) in block.chunks_exact(n).enumerate() {
                    let scaled = (0..n).map(|c| row[c] * (b[c] - product[c])).sum::<f32>();
                    step[at + a] = carried * step[at + a] + taken * scaled;
                    x[at + a] += step[at + a];
                }
            }
        });
    }
}

/// Bound on the norm of a block: the mean, √(a b), of its largest absolute row sum and column sum.
fn size(block: &[f32], n: usize) -> f64 {
    let sum = |k: usize, stride: usize, from: usize| {
        (0..n).map(|c| f64::from(block[k * from + c * stride].abs())).sum::<f64>()
    };
    let largest = |stride, from| (0..n).map(|k| sum(k, stride, from)).fold(0.0, f64::max);
    (largest(1, n) * largest(n, 1)).sqrt()
}

/// Gives modes that an aggregate lacks, whose diagonal entries are zero, the mean of the diagonal of the block, or 1.
fn with_unit_blocks(mut matrix: BlockRowMatrix<f64>) -> BlockRowMatrix<f64> {
    let n = matrix.shape[0];
    for i in 0..matrix.len() {
        let at = (matrix.start[i] as usize..matrix.start[i + 1] as usize).find(|&k| matrix.columns[k] as usize == i);
        let Some(at) = at else { continue };
        let block = &mut matrix.values[at * n * n..][..n * n];
        let mean = (0..n).map(|c| block[c * n + c]).sum::<f64>() / n as f64;
        for c in 0..n {
            if block[c * n + c] <= 0.0 {
                block[c * n + c] = if mean > 0.0 { mean } else { 1.0 };
            }
        }
    }
    matrix
}

/// Inverse diagonal blocks.
fn inverse_diagonal(matrix: &BlockRowMatrix<f64>) -> Vec<f64> {
    let n = matrix.shape[0];
    let mut inverse = vec![0.0; matrix.len() * n * n];
    inverse.par_chunks_mut(n * n).enumerate().for_each(|(i, out)| {
        if let Some((_, block)) = matrix.row(i).find(|(j, _)| *j == i) {
            invert(block, out, n);
        }
    });
    inverse
}

/// Inverts a symmetric positive definite block by its Cholesky factor, or the diagonal alone if it has no such factor.
fn invert(block: &[f64], out: &mut [f64], n: usize) {
    let mut l = block.to_vec();
    for j in 0..n {
        for k in 0..j {
            for i in j..n {
                l[i * n + j] -= l[i * n + k] * l[j * n + k];
            }
        }
        if l[j * n + j] <= 1e-12 * block[j * n + j] || l[j * n + j].is_nan() {
            for c in 0..n {
                out[c * n + c] = if block[c * n + c] > 0.0 { block[c * n + c].recip() } else { 0.0 };
            }
            return;
        }
        let root = l[j * n + j].sqrt();
        for i in j..n {
            l[i * n + j] /= root;
        }
    }
    for c in 0..n {
        let mut x = vec![0.0; n];
        x[c] = 1.0;
        for i in 0..n {
            let sum: f64 = (0..i).map(|k| l[i * n + k] * x[k]).sum();
            x[i] = (x[i] - sum) / l[i * n + i];
        }
        for i in (0..n).rev() {
            let sum: f64 = (i + 1..n).map(|k| l[k * n + i] * x[k]).sum();
            x[i] = (x[i] - sum) / l[i * n + i];
        }
        for i in 0..n {
            out[i * n + c] = x[i];
        }
    }
}

/// Estimates the largest eigenvalue of D⁻¹A by conjugate gradients: that of the tridiagonal matrix of their
/// coefficients (Lanczos), from a fixed start.
fn largest_eigenvalue(matrix: &BlockRowMatrix<f64>, diagonal: &[f64]) -> f64 {
    let n = matrix.shape[0];
    let scaled = |r: &[f64]| -> Vec<f64> {
        (0..r.len()).map(|k| (0..n).map(|b| diagonal[k * n + b] * r[k / n * n + b]).sum()).collect()
    };
    let mut rest: Vec<f64> =
        (1..=matrix.len() * n).map(|i| (i as f64 * 0.618_033_988_749_894_9).fract() - 0.5).collect();
    let mut direction = scaled(&rest);
    let mut image = vec![0.0; rest.len()];
    let (mut merit, mut coefficients) = (dot(&rest, &direction), Vec::new());
    for _ in 0..LANCZOS.min(rest.len()) {
        matrix.apply(&direction, &mut image, false);
        let energy = dot(&direction, &image);
        if merit <= 0.0 || energy <= 0.0 || energy.is_nan() {
            break;
        }
        let alpha = merit / energy;
        rest.iter_mut().zip(&image).for_each(|(r, image)| *r -= alpha * image);
        let next = scaled(&rest);
        let new = dot(&rest, &next);
        coefficients.push((alpha, new / merit));
        direction.iter_mut().zip(&next).for_each(|(d, next)| *d = next + new / merit * *d);
        merit = new;
    }
    let size = coefficients.len();
    let entry = |i: usize, j: usize| match i.abs_diff(j) {
        0 => coefficients[i].0.recip() + if i > 0 { coefficients[i - 1].1 / coefficients[i - 1].0 } else { 0.0 },
        1 => coefficients[i.min(j)].1.max(0.0).sqrt() / coefficients[i.min(j)].0,
        _ => 0.0,
    };
    let eigenvalues = Mat::from_fn(size, size, entry).self_adjoint_eigenvalues(Side::Lower);
    eigenvalues.ok().and_then(|values| values.last().copied()).filter(|v| *v > 0.0).unwrap_or(1.0)
}

/// The coarsest matrix divided by the scale, dense, with a shifted diagonal.
fn dense(matrix: &BlockRowMatrix<f64>, scale: f64) -> Mat<f64> {
    let n = matrix.shape[0];
    let mut dense = Mat::zeros(matrix.len() * n, matrix.len() * n);
    for i in 0..matrix.len() {
        for (j, block) in matrix.row(i) {
            for a in 0..n {
                for b in 0..n {
                    dense[(i * n + a, j * n + b)] = block[a * n + b] / scale;
                }
            }
        }
    }
    for i in 0..matrix.len() * n {
        let shift = SHIFT * dense[(i, i)];
        dense[(i, i)] += if shift > 0.0 { shift } else { 1.0 };
    }
    dense
}
