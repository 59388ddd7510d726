//! The way back to an earlier state of the same run.

use super::{HALVINGS, March};
use crate::equation::SetupError;
use crate::equation::systems::Systems;
use crate::linalg::{Account, System};
use crate::step::{Kept, Scheme};

impl March {
    /// Goes back to the systems of an earlier state of this run: see [`Scheme::go_back`].
    ///
    /// Factors of tangents on Γ_C are found by the tangent and stay. Matrices are factorized again only if they were
    /// refactorized at another temperature since.
    pub(super) fn back_to(&mut self, kept: &Kept) -> Result<(), SetupError> {
        let failed = |(part, source)| SetupError::Factor { part, source };
        self.products = None;
        let accounts: Vec<Account> = self.all().map(|system| system.condensed().account()).collect();
        // A factor has replaced an iteration since.
        if accounts.iter().zip(&kept.accounts).any(|(now, then)| now.is_left != then.is_left) {
            let at_start = (self.problem.timeline.longest(), &*self.start);
            let made = Systems::factorize(&self.problem, &self.discrete, at_start, &self.backend).map_err(failed)?;
            self.discard_halved(0);
            let before = std::mem::replace(&mut self.systems, made);
            self.give_up(&before);
            return self.recall(kept);
        }
        self.discard_halved(kept.halvings);
        self.halve(kept.halvings.min(HALVINGS)).map_err(failed)?;
        let mut temperatures = kept.temperatures.iter();
        for systems in std::iter::once(&mut self.systems).chain(&mut self.halved) {
            systems.go_back(&self.discrete, &self.start, &mut temperatures).map_err(failed)?;
        }
        for (system, account) in
            std::iter::once(&mut self.systems).chain(&mut self.halved).flat_map(Systems::all_mut).zip(&kept.accounts)
        {
            system.condensed_mut().go_on_from(*account);
        }
        Ok(())
    }

    fn all(&self) -> impl Iterator<Item = &System> {
        std::iter::once(&self.systems).chain(&self.halved).flat_map(Systems::all)
    }

    /// Discards the systems of halved steps but the first `count`.
    pub(super) fn discard_halved(&mut self, count: usize) {
        for systems in self.halved.split_off(count.min(self.halved.len())) {
            self.give_up(&systems);
        }
    }

    /// Counts the factorizations of discarded systems.
    fn give_up(&mut self, systems: &Systems) {
        let [matrices, contacts] = systems.factorizations();
        self.given_up = [self.given_up[0] + matrices, self.given_up[1] + contacts];
    }
}
