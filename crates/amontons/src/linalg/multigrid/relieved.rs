//! The factor that replaces an iteration: it solves the same systems on all unknowns, and keeps those of Γ_C.

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

/// A system with a factor, numbered by degree of freedom.
#[derive(Debug)]
pub(super) struct Relieved {
    system: System,
    /// Kept unknown per degree of freedom, or `None` if it is not kept.
    kept: Vec<Option<u32>>,
}

impl Relieved {
    /// Factorizes the matrix of an iteration, along the directions of its unknowns.
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

    /// Solves (K + J) x = r, with J and the bases of its nodes by degree of freedom, and r and x in the axes of space.
    ///
    /// # Errors
    /// When the system is singular.
    pub fn solve(&mut self, tangent: &Tangent, turns: &[Turn], r: &[f64]) -> Result<Vec<f64>, SolveError> {
        let tangent = self.turned(tangent, turns);
        self.system.linearised(&tangent, r)
    }

    /// True if K + J is positive definite.
    ///
    /// # Errors
    /// When definiteness cannot be determined.
    pub fn is_positive_definite(&mut self, tangent: &Tangent, turns: &[Turn]) -> Result<bool, SolveError> {
        let tangent = self.turned(tangent, turns);
        self.system.condensed_mut().is_positive_definite(&tangent)
    }

    /// Sets the bases of the nodes, and renumbers the unknowns of J from degrees of freedom to kept unknowns.
    fn turned(&mut self, tangent: &Tangent, turns: &[Turn]) -> Tangent {
        let kept = |dof: u32| self.kept.get(dof as usize).copied().flatten().unwrap_or_default();
        let turns: Vec<Turn> = turns.iter().map(|turn| Turn { unknowns: turn.unknowns.map(kept), ..*turn }).collect();
        let tangent = tangent.renamed(kept);
        self.system.condensed_mut().turn(&turns);
        tangent
    }
}
