//! Factorizations of a system whose contact unknowns are last: what one gives, and who makes one.
//!
//! With the unknowns ordered (I, C), interior before contact, the condensed operator is
//! S = K_CC − K_CI K_II⁻¹ K_IC. The forward sweep over the interior columns reduces the right-hand side to Γ_C; with
//! the contact unknowns found there, the backward sweep expands them to the body.

use std::fmt::Debug;
use std::sync::Arc;

use faer::Mat;

use super::ordering::nested_dissection;
use super::sparse::BlockMatrix;
use crate::tensor::Point;

/// Why a system could not be factorized.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FactorError {
    /// A pivot was not positive: the matrix is not positive definite.
    #[error(
        "the matrix is not positive definite: pivot {pivot} of {size} is not positive; a body that no side holds needs inertia: a larger density or shorter steps"
    )]
    NotPositive {
        /// Number of the pivot in elimination order.
        pivot: usize,
        /// Size of the matrix.
        size: usize,
    },
    /// The factor does not fit.
    #[error("the factor of {size} unknowns does not fit into memory")]
    Memory {
        /// Size of the matrix.
        size: usize,
    },
}

/// The unknowns of a system in elimination order: interior, then contact.
#[derive(Clone, Debug)]
pub struct Unknowns {
    /// Degree of freedom at each position.
    pub dofs: Vec<u32>,
    /// How many positions are interior.
    pub interior: usize,
}

impl Unknowns {
    /// Orders the degrees of freedom that are `free` (node-major, `components` a node), those of
    /// the nodes `contact` last.
    #[must_use]
    pub fn new(matrix: &BlockMatrix, points: &[Point], components: usize, free: &[bool], contact: &[u32]) -> Unknowns {
        let keep: Vec<bool> = free.chunks_exact(components).map(|node| node.iter().any(|&f| f)).collect();
        let ordering = nested_dissection(matrix.graph(), points, &keep, contact);
        let (mut dofs, mut interior) = (Vec::new(), 0);
        for (k, &node) in ordering.order.iter().enumerate() {
            dofs.extend((0..components as u32).map(|c| node * components as u32 + c).filter(|&d| free[d as usize]));
            if k < ordering.interior {
                interior = dofs.len();
            }
        }
        Unknowns { dofs, interior }
    }

    /// Number of unknowns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.dofs.len()
    }

    /// Whether there is nothing to solve for.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.dofs.is_empty()
    }

    /// Degrees of freedom of the contact unknowns.
    #[must_use]
    pub fn contact(&self) -> &[u32] {
        &self.dofs[self.interior..]
    }

    /// The first contact unknown of each contact node, counted from the first of all, with `components` degrees of
    /// freedom a node.
    #[must_use]
    pub fn contact_nodes(&self, components: usize) -> Vec<usize> {
        let node = |dof: u32| dof as usize / components.max(1);
        let contact = self.contact();
        (0..contact.len()).filter(|&i| i == 0 || node(contact[i]) != node(contact[i - 1])).collect()
    }

    /// The entries of a vector over all degrees of freedom, in elimination order.
    #[must_use]
    pub fn gather(&self, full: &[f64]) -> Vec<f64> {
        self.dofs.iter().map(|&d| full[d as usize]).collect()
    }

    /// Adds a vector in elimination order to its degrees of freedom.
    pub fn add(&self, x: &[f64], full: &mut [f64]) {
        for (&d, &value) in self.dofs.iter().zip(x) {
            full[d as usize] += value;
        }
    }
}

/// A way to factorize symmetric positive definite systems.
pub trait Backend: Debug + Send + Sync {
    /// Factorizes the rows and columns of `matrix` that `unknowns` names.
    ///
    /// # Errors
    /// When the matrix is not positive definite or does not fit into memory.
    fn factorize(&self, matrix: &BlockMatrix, unknowns: &Unknowns) -> Result<Box<dyn Factor>, FactorError>;
}

/// A factorized system, vectors in elimination order.
pub trait Factor: Debug + Send + Sync {
    /// Eliminates the interior: on return the contact entries hold the reduced right-hand side
    /// r_C − K_CI K_II⁻¹ r_I, the interior ones what [`Factor::backward`] needs.
    fn forward(&self, r: &mut [f64]);
    /// Expands: takes the contact entries as solved and returns the interior ones.
    fn backward(&self, x: &mut [f64]);
    /// The condensed operator S = K_CC − K_CI K_II⁻¹ K_IC, shared: on a large Γ_C a copy is as large as the factor.
    fn condensed(&self) -> Arc<Mat<f64>>;
    /// Numbers that the factor stores; a sweep reads them once.
    fn stored(&self) -> usize;
}

/// Upper triangle in elimination order by compressed columns.
pub(super) struct UpperColumns {
    pub start: Vec<u32>,
    pub rows: Vec<u32>,
    pub values: Vec<f64>,
}

pub(super) fn upper_columns(matrix: &BlockMatrix, unknowns: &Unknowns) -> UpperColumns {
    let (components, _) = matrix.block_shape();
    let mut position = vec![u32::MAX; matrix.graph().len() * components];
    for (k, &dof) in unknowns.dofs.iter().enumerate() {
        position[dof as usize] = k as u32;
    }
    let mut upper = UpperColumns { start: vec![0], rows: Vec::new(), values: Vec::new() };
    let mut column: Vec<(u32, f64)> = Vec::new();
    for (k, &dof) in unknowns.dofs.iter().enumerate() {
        let (i, r) = (dof as usize / components, dof as usize % components);
        column.clear();
        // The matrix is symmetric: its row is its column.
        for (j, block) in matrix.row(i) {
            for c in 0..components {
                let p = position[j * components + c];
                if p as usize <= k {
                    column.push((p, block[r * components + c]));
                }
            }
        }
        column.sort_unstable_by_key(|&(p, _)| p);
        upper.rows.extend(column.iter().map(|&(p, _)| p));
        upper.values.extend(column.iter().map(|&(_, v)| v));
        upper.start.push(upper.rows.len() as u32);
    }
    upper
}
