//! A matrix of which all unknowns are kept, with what an iteration needs of it: flags and scales of its unknowns, its
//! rows and modes for the levels of a multigrid method, and the contribution of contact.
//!
//! [`super::Multigrid`] solves with it, and so does a solver outside this library that distributes its rows.

use std::sync::Arc;

use rayon::prelude::*;

use super::local::ContactBlocks;
use super::masked::{MaskedMatrix, bases};
use super::precondition::{fill_level_block, has_unknowns, joined, modes, softened};
use crate::linalg::error::SolveError;
use crate::linalg::schur::STIFFLESS;
use crate::linalg::sparse::BlockMatrix;
use crate::linalg::tangent::Tangent;
use crate::linalg::turn::Turn;
use crate::linalg::unknowns::Unknowns;
use crate::linalg::vectors::BLOCK;

/// A matrix with its unknowns, all of which are kept.
#[derive(Debug)]
pub struct KeptMatrix {
    matrix: Arc<BlockMatrix>,
    unknowns: Unknowns,
    /// Per degree of freedom: true if it is unknown, and the number of the unknown.
    free: Vec<bool>,
    positions: Vec<Option<u32>>,
    scale: Vec<f64>,
    /// Motions of rigid bodies without stiffness, by degree of freedom, with the stiffness of their bodies.
    stiffless: Vec<(u32, f64)>,
}

/// The contribution of contact to a preconditioner.
#[derive(Debug, Default)]
pub struct ContactParts {
    /// Local solver where contact acts, or `None` if it touches nothing.
    pub local: Option<ContactBlocks>,
    /// Contribution to the levels, in the axes of space: row and column of a block, and its entries, of which the first
    /// n × n are used, row by row.
    pub joints: Vec<(u32, u32, [f64; 9])>,
}

impl KeptMatrix {
    /// Keeps all unknowns of a matrix.
    ///
    /// # Errors
    /// [`SolveError::NotPositive`] if a diagonal entry is not positive. Rigid motions, which contact alone may hold,
    /// have a stiffness of round-off size.
    pub fn checked(matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<KeptMatrix, SolveError> {
        let (n, _) = matrix.block_shape();
        let rigid: Vec<usize> = unknowns.rigid_stiffness(matrix).into_iter().map(|(unknown, _)| unknown).collect();
        let own = unknowns.dofs.iter().enumerate().filter(|(unknown, _)| !rigid.contains(unknown));
        for (pivot, &dof) in own {
            let (node, c) = (dof as usize / n, dof as usize % n);
            let diagonal = matrix.get(node, c, node, c);
            if diagonal <= 0.0 || diagonal.is_nan() {
                return Err(SolveError::NotPositive { pivot, size: unknowns.len() });
            }
        }
        Ok(KeptMatrix::new(matrix, unknowns))
    }

    /// The same without the check.
    pub(super) fn new(matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> KeptMatrix {
        let (n, _) = matrix.block_shape();
        let mut free = vec![false; matrix.graph().len() * n];
        for &dof in &unknowns.dofs {
            free[dof as usize] = true;
        }
        let diagonal = |dof: usize| matrix.get(dof / n, dof % n, dof / n, dof % n);
        let mean = |dof: &u32| {
            let node = *dof as usize / n;
            let own: Vec<f64> = (node * n..node * n + n).filter(|&d| free[d]).map(diagonal).collect();
            own.iter().sum::<f64>() / own.len().max(1) as f64
        };
        let mut scale: Vec<f64> = unknowns.dofs.iter().map(mean).collect();
        let mut stiffless = Vec::new();
        for (unknown, value) in unknowns.rigid_stiffness(matrix) {
            if let Some(own) = scale.get_mut(unknown).filter(|own| own.abs() < STIFFLESS * value) {
                *own = value;
                stiffless.extend(unknowns.dofs.get(unknown).map(|dof| (*dof, value)));
            }
        }
        let positions = unknowns.positions(free.len());
        let (matrix, unknowns) = (Arc::clone(matrix), unknowns.clone());
        KeptMatrix { matrix, unknowns, free, positions, scale, stiffless }
    }

    /// The matrix, along the directions of its degrees of freedom.
    #[must_use]
    pub fn matrix(&self) -> &Arc<BlockMatrix> {
        &self.matrix
    }

    /// The unknowns.
    #[must_use]
    pub fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    /// Per degree of freedom: true if it is unknown.
    #[must_use]
    pub fn free(&self) -> &[bool] {
        &self.free
    }

    /// Number of the unknown per degree of freedom, or `None` if it is prescribed. Following nodes have the numbers of
    /// the nodes that they follow.
    #[must_use]
    pub fn positions(&self) -> &[Option<u32>] {
        &self.positions
    }

    /// Scale per unknown: the mean of the diagonal over its node, the same in every basis.
    #[must_use]
    pub fn scale(&self) -> &[f64] {
        &self.scale
    }

    /// Extends a vector with an entry per unknown to all degrees of freedom, with zeros.
    #[must_use]
    pub fn spread(&self, x: &[f64]) -> Vec<f64> {
        let of_unknown = |position: &Option<u32>| position.map_or(0.0, |at| x[at as usize]);
        self.positions.par_iter().with_min_len(BLOCK).map(of_unknown).collect()
    }

    /// A tangent with its unknowns numbered by degree of freedom.
    #[must_use]
    pub fn by_degree(&self, tangent: &Tangent) -> Tangent {
        tangent.renamed(|unknown| self.unknowns.dofs.get(unknown as usize).copied().unwrap_or_default())
    }

    /// Bases with their unknowns numbered by degree of freedom.
    #[must_use]
    pub fn turns_by_degree(&self, turns: &[Turn]) -> Vec<Turn> {
        let dof = |unknown: u32| self.unknowns.dofs.get(unknown as usize).copied().unwrap_or_default();
        turns.iter().map(|turn| Turn { unknowns: turn.unknowns.map(dof), ..*turn }).collect()
    }

    /// Row of a node of the mesh for products or for levels: passes the column and the block of each node that has an
    /// unknown in common, row by row. Prescribed degrees of freedom have their diagonal alone; in rows for levels,
    /// rigid motions without stiffness have a little.
    pub fn level_row(&self, node: usize, is_for_levels: bool, mut take: impl FnMut(usize, &[f64])) {
        let (n, _) = self.matrix.block_shape();
        let masked = MaskedMatrix { stiffless: if is_for_levels { &self.stiffless } else { &[] }, ..self.masked() };
        let mut out = [0.0; 9];
        for (j, block) in self.matrix.row(node).filter(|(j, _)| has_unknowns(&masked, node, *j)) {
            fill_level_block(&masked, [node, j], block, &mut out[..n * n]);
            take(j, &out[..n * n]);
        }
    }

    /// Modes of nearly zero energy, a block of n × m per node, and m: the rigid motions of the body.
    #[must_use]
    pub fn modes(&self) -> (Vec<f64>, usize) {
        modes(&self.masked(), self.matrix.block_shape().0)
    }

    /// The contribution of a tangent to a preconditioner, in the bases of `turns`, which are numbered by degree of
    /// freedom. For levels it is capped where contact holds a node; a factor can take it as it is. `before` is the
    /// local solver of an earlier tangent.
    ///
    /// # Errors
    /// When contact couples nodes and K + J is singular on them.
    pub fn contact(
        &self,
        (tangent, turns): (&Tangent, &[Turn]),
        is_capped: bool,
        before: Option<&ContactBlocks>,
    ) -> Result<ContactParts, SolveError> {
        let (n, _) = self.matrix.block_shape();
        if tangent.is_empty() && turns.is_empty() {
            return Ok(ContactParts::default());
        }
        let (masked, by_degree) = (self.masked(), self.spread_springs(tangent));
        let bases = bases(turns, n);
        let joints =
            if is_capped { softened(&masked, &by_degree, &bases) } else { joined(&masked, &by_degree, &bases) };
        Ok(ContactParts { local: Some(ContactBlocks::new(&masked, &by_degree, turns, before)?), joints })
    }

    /// The tangent by degree of freedom, with stiffness on the diagonal in place of springs.
    pub(super) fn spread_springs(&self, tangent: &Tangent) -> Tangent {
        self.by_degree(&tangent.spread(&self.scale))
    }

    /// The matrix with the data of its degrees of freedom.
    pub(super) fn masked(&self) -> MaskedMatrix<'_> {
        let Unknowns { points, frames, rigid, .. } = &self.unknowns;
        MaskedMatrix {
            matrix: &self.matrix,
            points,
            free: &self.free,
            frames: &frames.0,
            rigid,
            stiffless: &self.stiffless,
        }
    }
}
