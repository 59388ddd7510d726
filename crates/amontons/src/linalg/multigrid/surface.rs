//! Solver for contact that couples the nodes of a facet, as at Gauss points: K + J on the degrees of freedom that it
//! touches, solved as a whole.
//!
//! If fewer points of a facet act than it has nodes, J is stiff at every node but has motions without force, which no
//! solution node by node can represent.

use std::collections::BTreeMap;

use super::masked::{AXES, MaskedMatrix, in_basis};
use crate::linalg::error::SolveError;
use crate::linalg::lu::SparseLu;
use crate::linalg::tangent::Entry;
use crate::tensor::Point;

/// True if entries couple different nodes of `n` degrees of freedom each.
pub(super) fn couples(entries: &[Entry], n: usize) -> bool {
    entries.iter().any(|&(i, j, _)| i as usize / n != j as usize / n)
}

/// The degrees of freedom that contact touches, with the LU factors of K + J on them.
#[derive(Debug)]
pub(super) struct ContactFactor {
    pub dofs: Vec<u32>,
    matrix: SparseLu,
}

impl ContactFactor {
    /// Factorizes K + J on some nodes, with the entries of J by degree of freedom in the bases of the nodes; `before`
    /// is a factor of an earlier J.
    ///
    /// # Errors
    /// When K + J is singular there.
    pub fn new(
        body: &MaskedMatrix,
        nodes: &[u32],
        entries: &[Entry],
        bases: &BTreeMap<usize, [Point; 3]>,
        before: Option<&ContactFactor>,
    ) -> Result<ContactFactor, SolveError> {
        let (n, _) = body.matrix.block_shape();
        let nodes: Vec<usize> = nodes.iter().map(|node| *node as usize).collect();
        let free = |dof: &usize| body.free[*dof];
        let dofs: Vec<u32> = nodes.iter().flat_map(|i| i * n..i * n + n).filter(free).map(|dof| dof as u32).collect();
        let place = |dof: usize| dofs.binary_search(&(dof as u32)).ok();
        let basis = |node: usize| bases.get(&node).copied().unwrap_or(AXES);
        let mut sum: Vec<Entry> = Vec::new();
        for &i in &nodes {
            for (j, block) in body.matrix.row(i).filter(|(j, _)| nodes.binary_search(j).is_ok()) {
                let block = in_basis(block, [&basis(i), &basis(j)], n, true);
                for (k, value) in block.iter().enumerate() {
                    if let (Some(row), Some(column)) = (place(i * n + k / n), place(j * n + k % n)) {
                        sum.push((row as u32, column as u32, *value));
                    }
                }
            }
        }
        for &(i, j, value) in entries {
            if let (Some(row), Some(column)) = (place(i as usize), place(j as usize)) {
                sum.push((row as u32, column as u32, value));
            }
        }
        let matrix = SparseLu::new(dofs.len(), sum.into_iter(), before.map(|before| &before.matrix))?;
        Ok(ContactFactor { dofs, matrix })
    }

    /// (K + J)⁻¹ r on the surface, by degree of freedom.
    pub fn solution(&self, r: impl Fn(u32) -> f64) -> Vec<(u32, f64)> {
        self.on_surface(r, |r| self.matrix.solve(r))
    }

    /// (K + J) x on the surface, by degree of freedom.
    pub fn load(&self, x: impl Fn(u32) -> f64) -> Vec<(u32, f64)> {
        self.on_surface(x, |x| self.matrix.apply(x))
    }

    fn on_surface(&self, x: impl Fn(u32) -> f64, operator: impl Fn(&[f64]) -> Vec<f64>) -> Vec<(u32, f64)> {
        let own: Vec<f64> = self.dofs.iter().map(|&dof| x(dof)).collect();
        self.dofs.iter().copied().zip(operator(&own)).collect()
    }
}
