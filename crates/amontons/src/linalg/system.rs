//! A matrix with its factor and its condensed operator: the one object with which schemes and the certificate solve.

use std::sync::Arc;

use super::condensed::{Condensed, EXACT};
use super::error::SolveError;
use super::estimate::Choice;
use super::factor::{Backend, Factor};
use super::sparse::BlockMatrix;
use super::tangent::Tangent;
use super::unknowns::{Layout, Unknowns};
use super::vectors::zeros;

/// A system K x = r, factorized by a backend, with its condensed operator.
#[derive(Debug)]
pub struct System {
    backend: Arc<dyn Backend>,
    unknowns: Unknowns,
    factor: Box<dyn Factor>,
    condensed: Box<dyn Condensed>,
    /// Number of factorizations of K, and of S + J before the last factorization of K.
    factorizations: (usize, usize),
    /// Number of Krylov iterations before the last factorization of K.
    iterations: usize,
}

impl System {
    /// Factorizes a matrix on the unknowns of the layout.
    ///
    /// # Errors
    /// When the matrix is not positive definite or does not fit into memory.
    pub fn new(backend: &Arc<dyn Backend>, matrix: &Arc<BlockMatrix>, layout: &Layout) -> Result<System, SolveError> {
        let matrix = layout.matrix(matrix);
        let unknowns = backend.order(&matrix, layout);
        let factor = backend.factorize(&matrix, &unknowns)?;
        let condensed = factor.condensed();
        Ok(System { backend: Arc::clone(backend), unknowns, factor, condensed, factorizations: (1, 0), iterations: 0 })
    }

    /// Factorizes another matrix with the same unknowns.
    ///
    /// # Errors
    /// Those of [`System::new`]; the system is then unchanged.
    pub fn replace(&mut self, matrix: &Arc<BlockMatrix>) -> Result<(), SolveError> {
        self.factor = self.backend.factorize(&self.unknowns.matrix(matrix), &self.unknowns)?;
        self.factorizations = (self.factorizations.0 + 1, self.factorizations.1 + self.condensed.factorizations());
        self.iterations += self.condensed.iterations();
        let account = self.condensed.account();
        self.condensed = self.factor.condensed();
        self.condensed.go_on_from(account);
        Ok(())
    }

    /// True if several processes work on each system together: see [`Backend::is_collective`].
    #[must_use]
    pub fn is_collective(&self) -> bool {
        self.backend.is_collective()
    }

    /// The unknowns in elimination order.
    #[must_use]
    pub fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    /// The condensed operator S on the kept unknowns: x·Sx is the least energy of all vectors with these entries.
    #[must_use]
    pub fn condensed(&self) -> &dyn Condensed {
        self.condensed.as_ref()
    }

    /// The condensed operator, mutable, to solve with.
    pub fn condensed_mut(&mut self) -> &mut dyn Condensed {
        self.condensed.as_mut()
    }

    /// Number of factorizations of K and of S + J so far.
    #[must_use]
    pub fn factorizations(&self) -> (usize, usize) {
        (self.factorizations.0, self.factorizations.1 + self.condensed.factorizations())
    }

    /// Number of Krylov iterations so far.
    #[must_use]
    pub fn iterations(&self) -> usize {
        self.iterations + self.condensed.iterations()
    }

    /// Name of the solver: `direct` or `iterative`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.factor.name()
    }

    /// Choice of the solver with its reason, or `None` if the backend did not choose.
    #[must_use]
    pub fn choice(&self) -> Option<&Choice> {
        self.unknowns.choice.as_deref()
    }

    /// Why systems are solved as they are, in words, if neither the case nor the program has chosen.
    #[must_use]
    pub fn reason(&self) -> Option<String> {
        self.backend.reason()
    }

    /// Number of stored entries of the factor; a sweep reads them once.
    #[must_use]
    pub fn stored(&self) -> usize {
        self.factor.stored()
    }

    /// Forward sweep: a right-hand side over all degrees of freedom, in elimination order and reduced to the kept
    /// unknowns.
    ///
    /// # Errors
    /// When the sweep fails.
    pub fn reduce(&self, right: &[f64]) -> Result<Vec<f64>, SolveError> {
        let mut x = self.unknowns.gather(right);
        self.factor.forward(&mut x)?;
        Ok(x)
    }

    /// Solves the problem on the kept unknowns. `solve` finds them from the reduced right-hand side in `x`, which is
    /// replaced by their increments over `values`.
    ///
    /// # Errors
    /// Those of `solve`.
    pub fn settle<T, E>(
        &mut self,
        x: &mut [f64],
        values: &[f64],
        solve: impl FnOnce(&mut dyn Condensed, &[f64]) -> Result<(Vec<f64>, T), E>,
    ) -> Result<T, E> {
        let (_, kept) = x.split_at_mut(self.unknowns.interior);
        let (solved, result) = solve(self.condensed.as_mut(), kept)?;
        for (x, (solved, value)) in kept.iter_mut().zip(solved.iter().zip(self.kept_of(values))) {
            *x = solved - value;
        }
        Ok(result)
    }

    /// Backward sweep: `values` plus the increment that the right-hand side causes.
    ///
    /// # Errors
    /// When the sweep fails.
    pub fn expand(&self, mut x: Vec<f64>, values: &[f64]) -> Result<Vec<f64>, SolveError> {
        self.factor.backward(&mut x)?;
        Ok(self.unknowns.sum(&x, values))
    }

    /// Solves the system with the tangent of a contact term added, for all degrees of freedom.
    ///
    /// # Errors
    /// When the system with the tangent is singular, or cannot be solved.
    pub fn linearised(&mut self, tangent: &Tangent, right: &[f64]) -> Result<Vec<f64>, SolveError> {
        self.linearised_again(tangent, right, |_| None)
    }

    /// The same for right-hand sides on the kept unknowns that follow from solutions: `again` has each change of the
    /// kept unknowns, over all degrees of freedom, and returns the next right-hand side. Others are solved for once.
    ///
    /// # Errors
    /// Those of [`System::linearised`].
    pub fn linearised_again(
        &mut self,
        tangent: &Tangent,
        right: &[f64],
        mut again: impl FnMut(&[f64]) -> Option<Vec<f64>>,
    ) -> Result<Vec<f64>, SolveError> {
        let interior = self.unknowns.interior;
        let mut x = self.reduce(right)?;
        if x.len() > interior {
            self.solve_turned(tangent, &mut x[interior..])?;
            let mut change = zeros(interior);
            change.extend_from_slice(&x[interior..]);
            while let Some(more) = again(&self.unknowns.sum(&change, &zeros(right.len()))) {
                let mut kept = self.unknowns.gather(&more).split_off(interior);
                self.solve_turned(tangent, &mut kept)?;
                x[interior..].iter_mut().zip(&kept).for_each(|(x, more)| *x += more);
                change[interior..].copy_from_slice(&kept);
            }
        }
        self.factor.backward(&mut x)?;
        let mut values = zeros(right.len());
        self.unknowns.add(&x, &mut values);
        Ok(values)
    }

    /// Solves the system on the kept unknowns in place, with a tangent in the bases of the contact points.
    fn solve_turned(&mut self, tangent: &Tangent, kept: &mut [f64]) -> Result<(), SolveError> {
        let turns = self.condensed.turns().to_vec();
        for turn in &turns {
            turn.forward(kept);
        }
        self.condensed.solve(tangent, kept, EXACT)?;
        for turn in &turns {
            turn.back(kept);
        }
        Ok(())
    }

    /// Solves S x = r in place on the kept unknowns, until the residual is at most `enough` times that of zero.
    ///
    /// # Errors
    /// When S is singular, or the system cannot be solved.
    pub fn solve_condensed(&mut self, r: &mut [f64], enough: f64) -> Result<(), SolveError> {
        if self.condensed.is_empty() { Ok(()) } else { self.condensed.solve(&Tangent::new(), r, enough) }
    }

    /// True if systems are solved with a factor.
    #[must_use]
    pub fn is_direct(&self) -> bool {
        self.factor.name() == "direct"
    }

    /// Extends kept entries to the vector of least energy, in elimination order.
    ///
    /// # Errors
    /// When the sweep fails.
    pub fn extend(&self, kept: &[f64]) -> Result<Vec<f64>, SolveError> {
        let mut x = Vec::with_capacity(self.unknowns.interior + kept.len());
        x.resize(self.unknowns.interior, 0.0);
        x.extend_from_slice(kept);
        self.factor.backward(&mut x)?;
        Ok(x)
    }

    /// Solves K x = r in place, in elimination order.
    ///
    /// # Errors
    /// When K is singular, or the system cannot be solved.
    pub fn solve(&mut self, r: &mut [f64]) -> Result<(), SolveError> {
        self.solve_to(r, EXACT)
    }

    /// Solves K x = r in place until the residual is at most `enough` times that of zero.
    ///
    /// # Errors
    /// Those of [`System::solve`].
    pub fn solve_to(&mut self, r: &mut [f64], enough: f64) -> Result<(), SolveError> {
        let interior = self.unknowns.interior;
        self.factor.forward(r)?;
        self.solve_condensed(&mut r[interior..], enough)?;
        self.factor.backward(r)
    }

    /// The kept unknowns of a vector over all degrees of freedom.
    #[must_use]
    pub fn kept_of(&self, values: &[f64]) -> Vec<f64> {
        self.unknowns.kept_of(values)
    }
}
