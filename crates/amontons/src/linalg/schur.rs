//! The Schur complement S on Γ_C as a dense matrix, and the solution of systems (S + J) x = b: with the factors of the
//! last few J, or for a large Γ_C by an iteration.

use std::collections::VecDeque;
use std::sync::Arc;

use faer::Mat;
use rayon::prelude::*;
use sha2::{Digest, Sha256};

use super::condensed::{Condensed, TangentKey};
use super::error::SolveError;
use super::krylov::gmres;
use super::lu::{Cholesky, Lu, SparseLu, Square};
use super::numeric::{Ended, has_factor};
use super::stop::StopFlag;
use super::tangent::{Spring, Tangent};
use super::turn::{Turn, turn};
use super::vectors::max_abs;

/// Number of stored factors: steps alternate between a few contact patterns at the most.
const KEPT: usize = 8;

/// Number of unknowns on Γ_C from which on a factor of S + J, whose work grows with their third power, costs more than
/// an iteration.
const LARGE: usize = 2000;
/// Entries of J per unknown up to which J couples neighbours only; a foundation whose temperature follows all of its
/// points couples every unknown with every other.
const NEIGHBOURS: usize = 1500;
/// Residual of the iteration relative to b, and its largest number of products with S. Newton's method corrects the
/// remaining residual.
const TOLERANCE: f64 = 1e-13;
const PRODUCTS: usize = 400;
/// Number of GMRES runs, each on the residual of the one before, and the relative residual asked of each: asking for
/// all digits in one run would iterate on the round-off of the residuals.
const PASSES: usize = 3;
const PASS: f64 = 1e-7;

/// Round-off of S x relative to b above which the residual of a solution is checked, and the largest residual, relative
/// to b, that is accepted then.
const SUSPICIOUS: f64 = 1e-8;
const LEFT: f64 = 1e-2;
/// Largest error of an entry of S, a difference of larger numbers, in units of the round-off of the largest entry.
const NOISE: f64 = 256.0;

/// The condensed operator S with the factors of S + J for the last few J.
///
/// With piecewise linear laws J has the same bits whenever the same points are open, stuck and slipping, so a step with
/// an unchanged contact pattern costs no factorization. The key is J itself: no law has to declare that it is piecewise
/// linear.
///
/// On a large Γ_C the systems are solved by GMRES with the nodal diagonal blocks of S + J as preconditioner. S acts
/// like a derivative of first order along Γ_C, so its condition number is that of 1/h, and J couples the unknowns of a
/// node (with Gauss quadrature, of a facet): a few dozen products, whatever the contact pattern.
#[derive(Debug)]
pub(super) struct Schur {
    /// S in the axes of space, and in the bases of the turned nodes, if there are any.
    straight: Arc<Mat<f64>>,
    turned: Option<Mat<f64>>,
    turns: Vec<Turn>,
    /// Largest entry of S.
    largest: f64,
    /// Scale per unknown: the mean of the diagonal of S over its node, the same in every basis.
    scale: Vec<f64>,
    /// First unknown per node.
    nodes: Vec<usize>,
    is_large: bool,
    kept: VecDeque<KeptTangent>,
    factorizations: usize,
    stop: StopFlag,
}

/// One of the last few tangents J.
#[derive(Debug)]
enum KeptTangent {
    /// Stored with the factor of S + J.
    Factor(Tangent, Factors),
    /// Known by its key alone: the run that this one continues had the factor.
    Known(TangentKey),
}

/// The factors of S + J.
#[derive(Debug)]
enum Factors {
    /// L of a positive definite matrix: J is symmetric for heat, and if no point slips.
    Cholesky(Cholesky),
    Lu(Lu),
}

impl Factors {
    fn solve(&self, b: &mut [f64]) {
        match self {
            Factors::Cholesky(factor) => factor.solve(b),
            Factors::Lu(factor) => factor.solve(b),
        }
    }
}

impl KeptTangent {
    fn is(&self, tangent: &Tangent, turns: &[Turn]) -> bool {
        match self {
            KeptTangent::Factor(kept, _) => kept.is_same(tangent),
            KeptTangent::Known(key) => *key == tangent_key(tangent, turns),
        }
    }
}

/// Identifier of J in the bases of its nodes.
fn tangent_key(tangent: &Tangent, turns: &[Turn]) -> TangentKey {
    let mut hash = Sha256::new();
    for turn in turns {
        turn.unknowns.iter().for_each(|unknown| hash.update(unknown.to_le_bytes()));
        turn.basis.iter().flatten().for_each(|component| hash.update(component.to_bits().to_le_bytes()));
    }
    hash.update((turns.len() as u64).to_le_bytes());
    tangent.bits().for_each(|bits| hash.update(bits.to_le_bytes()));
    hash.finalize().into()
}

/// Fraction of the stiffness of a body below which the stiffness of a rigid motion counts as zero.
pub(super) const STIFFLESS: f64 = 1e-8;

impl Schur {
    /// Creates the solver for the condensed operator `s`, the unknowns of a node together; `nodes` has the first
    /// unknown per node.
    pub fn new(s: Arc<Mat<f64>>, nodes: Vec<usize>, stop: StopFlag) -> Schur {
        let scale = scale(&s, &nodes);
        let (is_large, largest) = (s.nrows() >= LARGE, s.norm_max());
        Schur {
            is_large,
            largest,
            scale,
            straight: s,
            turned: None,
            turns: Vec::new(),
            nodes,
            kept: VecDeque::new(),
            factorizations: 0,
            stop,
        }
    }

    /// Replaces the scales of some kept unknowns, given by number, where their own scale is round-off compared with the
    /// new one.
    #[must_use]
    pub fn with_scale(mut self, of: &[(usize, f64)]) -> Schur {
        for &(unknown, value) in of {
            if let Some(own) = self.scale.get_mut(unknown).filter(|own| own.abs() < STIFFLESS * value) {
                *own = value;
            }
        }
        self
    }

    /// S in the current bases of the nodes.
    fn s(&self) -> &Mat<f64> {
        self.turned.as_ref().filter(|_| !self.turns.is_empty()).unwrap_or(&self.straight)
    }

    /// S + J.
    fn with(&self, tangent: &Tangent) -> Square {
        let mut matrix = Square::of(self.s().as_ref());
        for (i, j, value) in tangent.entries() {
            matrix.add(i as usize, j as usize, value);
        }
        for Spring { stiffness, vector } in tangent.springs() {
            for (i, a) in vector {
                for (j, b) in vector {
                    matrix.add(*i as usize, *j as usize, stiffness * a * b);
                }
            }
        }
        matrix
    }

    /// Factorizes S + J.
    fn factorized(&self, tangent: &Tangent) -> Factors {
        let of_symmetric = tangent.is_symmetric().then(|| Cholesky::new(self.with(tangent))).flatten();
        of_symmetric.map_or_else(|| Factors::Lu(Lu::new(self.with(tangent))), Factors::Cholesky)
    }

    /// Sums `term` over the columns, in an order that does not depend on the number of threads.
    fn product(&self, x: &[f64], term: impl Fn(f64, f64) -> f64 + Sync) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        // S is symmetric and stored by columns: blocks of rows in parallel, all columns in sequence.
        let rows = if self.is_large { 512 } else { x.len().max(1) };
        let s = self.s();
        y.par_chunks_mut(rows).enumerate().for_each(|(part, y)| {
            for (j, &x) in x.iter().enumerate() {
                let column = s.col(j).subrows(part * rows, y.len());
                for (y, s) in y.iter_mut().zip(column.iter()) {
                    *y += term(*s, x);
                }
            }
        });
        y
    }

    fn solve_unchecked(&mut self, tangent: &Tangent, b: &mut [f64]) -> Result<(), SolveError> {
        self.stop.go_on()?;
        // S alone is solved repeatedly by eigenvalue problems; S + J changes with the contact pattern.
        if self.is_large && !tangent.is_empty() {
            b.copy_from_slice(&self.iterate(tangent, b)?);
            return Ok(());
        }
        let found = self.kept.iter().position(|kept| kept.is(tangent, &self.turns));
        let kept = match found.and_then(|found| self.kept.remove(found)) {
            Some(factor @ KeptTangent::Factor(..)) => factor,
            known => {
                self.factorizations += usize::from(known.is_none());
                KeptTangent::Factor(tangent.clone(), self.factorized(tangent))
            }
        };
        if let KeptTangent::Factor(_, factor) = &kept {
            factor.solve(b);
        }
        self.kept.truncate(KEPT - 1);
        self.kept.push_front(kept);
        Ok(())
    }

    /// Solves (S + J) x = b by GMRES, preconditioned from the right.
    fn iterate(&self, tangent: &Tangent, b: &[f64]) -> Result<Vec<f64>, SolveError> {
        let near = self.near(tangent)?;
        let mut x = vec![0.0; b.len()];
        let mut rest = b.to_vec();
        for _ in 0..PASSES {
            let before = max_abs(&rest);
            let wanted = (TOLERANCE * max_abs(b) / before).max(PASS);
            let product = |y: &[f64]| self.stop.go_on().map(|()| self.sum(tangent, &near.solve(y)));
            let solved = gmres(product, &rest, wanted, PRODUCTS)?;
            x.iter_mut().zip(near.solve(&solved.x)).for_each(|(x, change)| *x += change);
            rest.iter_mut().zip(b).zip(self.sum(tangent, &x)).for_each(|((rest, b), sum)| *rest = b - sum);
            if max_abs(&rest) <= TOLERANCE * max_abs(b) || max_abs(&rest) > 0.1 * before {
                break;
            }
        }
        Ok(x)
    }

    /// (S + J) x.
    fn sum(&self, tangent: &Tangent, x: &[f64]) -> Vec<f64> {
        let mut y = self.product(x, |s, x| s * x);
        tangent.add_product(1.0, x, &mut y);
        y
    }

    /// The factorized preconditioner: the nodal diagonal blocks of S, plus J.
    fn near(&self, tangent: &Tangent) -> Result<Near, SolveError> {
        let end = |node: usize| self.nodes.get(node + 1).copied().unwrap_or(self.s().nrows());
        let blocks = self.nodes.iter().enumerate().map(|(node, &first)| (first, end(node) - first));
        let node_of = |i: u32| self.nodes.partition_point(|&first| first <= i as usize).saturating_sub(1);
        let couples = || tangent.entries().any(|(i, j, _)| node_of(i) != node_of(j));
        if tangent.entries().count() <= NEIGHBOURS * self.s().nrows() && couples() {
            let of_block =
                |(first, size): (usize, usize)| (0..size * size).map(move |k| (first + k / size, first + k % size));
            let own = blocks.flat_map(of_block).map(|(i, j)| (i as u32, j as u32, self.s()[(i, j)]));
            let sum = own.chain(tangent.entries());
            return Ok(Near::Coupled(Box::new(SparseLu::new(self.s().nrows(), sum, None)?)));
        }
        let own = |(first, size)| (first, Square::of(self.s().submatrix(first, first, size, size)));
        let mut blocks: Vec<(usize, Square)> = blocks.map(own).collect();
        for (i, j, value) in tangent.entries() {
            if let Some((first, block)) = blocks.get_mut(node_of(i)) {
                block.add(i as usize - *first, j as usize - *first, value);
            }
        }
        Ok(Near::Nodes(blocks.into_iter().map(|(first, block)| (first, Lu::new(block))).collect()))
    }
}

impl Condensed for Schur {
    fn scale(&self) -> &[f64] {
        &self.scale
    }

    fn apply(&self, x: &[f64]) -> Result<Vec<f64>, SolveError> {
        Ok(self.product(x, |s, x| s * x))
    }

    fn magnitude(&self, x: &[f64]) -> Result<f64, SolveError> {
        Ok(max_abs(&self.product(x, |s, x| (s * x).abs())))
    }

    fn magnitude_bound(&self, x: &[f64]) -> f64 {
        // Doubled for the round-off of either sum.
        2.0 * self.largest * x.iter().map(|x| x.abs()).sum::<f64>()
    }

    fn solve(&mut self, tangent: &Tangent, b: &mut [f64], _enough: f64) -> Result<(), SolveError> {
        let right = b.to_vec();
        self.solve_unchecked(tangent, b)?;
        // Unless the terms of the sums S x are many times as large as b, the remaining residual is round-off.
        let round_off = f64::EPSILON * self.largest * max_abs(b);
        let suspicious = round_off > SUSPICIOUS * max_abs(&right);
        if NOISE * round_off > max_abs(&right) {
            // A small system with a pivot of round-off size leaves no residual but is singular all the same.
            return Err(SolveError::Singular { size: b.len() });
        }
        if !suspicious && !max_abs(b).is_nan() {
            return Ok(());
        }
        let left: Vec<f64> = self.sum(tangent, b).iter().zip(&right).map(|(sum, b)| sum - b).collect();
        if max_abs(&left) <= LEFT * max_abs(&right) { Ok(()) } else { Err(SolveError::Singular { size: b.len() }) }
    }

    fn is_positive_definite(&mut self, tangent: &Tangent) -> Result<bool, SolveError> {
        match has_factor(self.with(tangent).as_ref(), 0.0, &self.stop) {
            Ok(()) => Ok(true),
            Err(Ended::NotPositive(_)) => Ok(false),
            Err(Ended::Stopped(error)) => Err(error),
        }
    }

    fn turn(&mut self, turns: &[Turn]) {
        if self.turns != turns {
            self.turns = turns.to_vec();
            if !turns.is_empty() {
                let mut s = self.turned.take().unwrap_or_else(|| Mat::zeros(self.len(), self.len()));
                s.copy_from(&*self.straight);
                turn(&mut s, turns);
                self.turned = Some(s);
            }
            self.kept.retain(|kept| matches!(kept, KeptTangent::Known(_)));
        }
    }

    fn turns(&self) -> &[Turn] {
        &self.turns
    }

    fn dense(&self) -> Option<&Mat<f64>> {
        Some(self.s())
    }

    fn factorizations(&self) -> usize {
        self.factorizations
    }

    fn kept(&self) -> Vec<TangentKey> {
        let key = |kept: &KeptTangent| match kept {
            KeptTangent::Factor(tangent, _) => tangent_key(tangent, &self.turns),
            KeptTangent::Known(key) => *key,
        };
        self.kept.iter().map(key).collect()
    }

    fn recall(&mut self, kept: &[TangentKey]) {
        self.kept = kept.iter().take(KEPT).map(|key| KeptTangent::Known(*key)).collect();
    }
}

/// Scale per unknown: the mean of the diagonal over the unknowns of its node.
fn scale(s: &Mat<f64>, nodes: &[usize]) -> Vec<f64> {
    let mut scale = Vec::with_capacity(s.nrows());
    for (node, &first) in nodes.iter().enumerate() {
        let end = nodes.get(node + 1).copied().unwrap_or(s.nrows());
        let mean = (first..end).map(|i| s[(i, i)]).sum::<f64>() / (end - first).max(1) as f64;
        scale.resize(end, mean);
    }
    scale
}

/// The stiff part of S + J: J, and the entries of S between unknowns of one node.
#[derive(Debug)]
enum Near {
    /// One block per node.
    Nodes(Vec<(usize, Lu)>),
    /// One matrix, if contact couples nodes as that of a pair does.
    Coupled(Box<SparseLu>),
}

impl Near {
    /// Solves with this part alone.
    fn solve(&self, y: &[f64]) -> Vec<f64> {
        match self {
            Near::Nodes(blocks) => {
                let mut x = y.to_vec();
                for (first, lu) in blocks {
                    lu.solve(&mut x[*first..first + lu.size()]);
                }
                x
            }
            Near::Coupled(factors) => factors.solve(y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::tangent::Share;

    /// The matrix is like S of first order: the eigenvalues of sin(π k i) are k. With stiff entries at some nodes and a
    /// nonsymmetric coupling, as pressed and sliding points make them, the iteration agrees with the factor.
    #[test]
    fn the_iteration_agrees_with_the_factor() {
        let (nodes, dim) = (60, 3);
        let n = nodes * dim;
        let mode =
            |k: usize, i: usize| (std::f64::consts::PI * (k as f64 + 0.5) * (i as f64 + 0.5) / nodes as f64).cos();
        let s = Mat::from_fn(n, n, |i, j| {
            let scalar: f64 = (0..nodes).map(|k| (k as f64 + 1.0) * mode(k, i / dim) * mode(k, j / dim)).sum();
            scalar * if i % dim == j % dim { 2.0 } else { 0.3 }
        });
        let mut tangent = Tangent::new();
        for node in (0..nodes as u32).filter(|node| node % 3 > 0) {
            let at = |c: u32| node * dim as u32 + c;
            let stiff = if node % 3 == 1 { 1e12 } else { 0.0 };
            let row = [(at(0), [1.0, 0.0, 0.0]), (at(1), [0.0, 1.0, 0.0]), (at(2), [0.0, 0.0, 1.0])];
            tangent.add(1.0, &row, &[[stiff, 4e4, 0.0], [0.0, 1e5, 0.0], [0.0, 0.0, stiff]]);
        }
        let first: Vec<usize> = (0..nodes).map(|node| node * dim).collect();
        let b: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let (mut factor, mut iteration) = (
            Schur::new(Arc::new(s.clone()), first.clone(), StopFlag::default()),
            Schur::new(Arc::new(s), first, StopFlag::default()),
        );
        iteration.is_large = true;
        let (mut x, mut y) = (b.clone(), b.clone());
        assert_eq!(factor.solve(&tangent, &mut x, 0.0), Ok(()));
        assert_eq!(iteration.solve(&tangent, &mut y, 0.0), Ok(()));
        let rest: Vec<f64> = iteration.sum(&tangent, &y).iter().zip(&b).map(|(s, b)| s - b).collect();
        assert!(max_abs(&rest) < 1e-11, "{:e}", max_abs(&rest));
        let difference: Vec<f64> = x.iter().zip(&y).map(|(x, y)| x - y).collect();
        assert!(max_abs(&difference) < 1e-10 * max_abs(&x), "{:e}", max_abs(&difference));
        // A node held to three others, as at a point of a pair.
        let mut joined = Tangent::new();
        for node in (0..nodes as u32 / 2).filter(|node| node % 4 > 0) {
            let others = &[(node, 1.0), (59 - node, -0.5), (58 - node, -0.3), (57 - node, -0.2)];
            let along = |c: usize, on: f64| std::array::from_fn(|a| if a == c { on } else { 0.0 });
            let of = |&(i, on): &(u32, f64)| (0..dim).map(move |c| (i * dim as u32 + c as u32, along(c, on)));
            let row: Vec<Share> = others.iter().flat_map(of).collect();
            joined.add(1.0, &row, &[[1e12, 0.0, 0.0], [0.0, 1e12, 0.0], [0.0, 0.0, 1e12]]);
        }
        let (mut x, mut y) = (b.clone(), b.clone());
        assert_eq!(factor.solve(&joined, &mut x, 0.0), Ok(()));
        assert_eq!(iteration.solve(&joined, &mut y, 0.0), Ok(()));
        let difference: Vec<f64> = x.iter().zip(&y).map(|(x, y)| x - y).collect();
        assert!(max_abs(&difference) < 1e-7 * max_abs(&x), "{:e}", max_abs(&difference));
        // Points that pull make S + J indefinite, so that L Lᵀ does not exist.
        let mut pulling = Tangent::new();
        pulling.add_diagonal((0..n).map(|i| if i % 7 == 0 { -1e5 } else { 0.0 }));
        assert!(pulling.is_symmetric() && factor.is_positive_definite(&pulling) == Ok(false));
        let mut x = b.clone();
        assert_eq!(factor.solve(&pulling, &mut x, 0.0), Ok(()));
        let rest: Vec<f64> = factor.sum(&pulling, &x).iter().zip(&b).map(|(s, b)| s - b).collect();
        assert!(max_abs(&rest) < 1e-11, "{:e}", max_abs(&rest));
        let (small, large) = (factor.apply(&b), iteration.apply(&b));
        assert_eq!(small, large, "products in parts have the bits of those in one");
        assert!(factor.magnitude(&b).is_ok_and(|size| size <= factor.magnitude_bound(&b)));
    }
}
