//! The factor that an iteration is left for: it solves the same systems, on all unknowns, and keeps those of Γ_C.

use std::sync::Arc;

use crate::linalg::error::SolveError;
use crate::linalg::factor::Backend;
use crate::linalg::relief::Relief;
use crate::linalg::sparse::BlockMatrix;
use crate::linalg::stop::StopFlag;
use crate::linalg::supernodal::Interruptible;
use crate::linalg::system::System;
use crate::linalg::tangent::Tangent;
use crate::linalg::turn::Turn;
use crate::linalg::unknowns::{Layout, Unknowns};

/// A system with a factor, by degree of freedom.
#[derive(Debug)]
pub(super) struct Relieved {
    system: System,
    /// The unknown of each degree of freedom among those that are kept.
    kept: Vec<Option<u32>>,
}

impl Relieved {
    /// Factorizes the matrix of an iteration, in the directions of its unknowns.
    ///
    /// # Errors
    /// When the matrix has no factor, or none that fits into memory.
    pub fn new(
        matrix: &Arc<BlockMatrix>,
        unknowns: &Unknowns,
        free: &[bool],
        relief: &Relief,
        stop: &StopFlag,
    ) -> Result<Relieved, SolveError> {
        let (components, _) = matrix.block_shape();
        let contact = &relief.contact;
        let layout =
            Layout { points: &unknowns.points, components, free, frames: &[], links: &[], rigid: &[], contact };
        let backend: Arc<dyn Backend> = Arc::new(Interruptible(stop.clone()));
        let system = System::new(&backend, matrix, &layout)?;
        let kept = system.unknowns().positions(free.len());
        Ok(Relieved { system, kept })
    }

    /// Solves (K + J) x = r, J and the bases of its nodes by degree of freedom, r and x in the axes of space.
    ///
    /// # Errors
    /// When the system is singular.
    pub fn solve(&mut self, tangent: &Tangent, turns: &[Turn], r: &[f64]) -> Result<Vec<f64>, SolveError> {
        let tangent = self.turned(tangent, turns);
        self.system.linearised(&tangent, r)
    }

    /// Whether K + J is positive definite.
    ///
    /// # Errors
    /// When that cannot be found out.
    pub fn is_positive_definite(&mut self, tangent: &Tangent, turns: &[Turn]) -> Result<bool, SolveError> {
        let tangent = self.turned(tangent, turns);
        self.system.condensed_mut().is_positive_definite(&tangent)
    }

    /// Takes up the bases of nodes, and names the unknowns of J as they are named here.
    fn turned(&mut self, tangent: &Tangent, turns: &[Turn]) -> Tangent {
        let kept = |dof: u32| self.kept.get(dof as usize).copied().flatten().unwrap_or_default();
        let turns: Vec<Turn> = turns.iter().map(|turn| Turn { unknowns: turn.unknowns.map(kept), ..*turn }).collect();
        let tangent = tangent.renamed(kept);
        self.system.condensed_mut().turn(&turns);
        tangent
    }
}
