//! How the mechanical step on Γ_C is solved: Newton's method, and what is done where it does not end.

use super::mechanical::{Mechanical, MechanicalStep, Multipliers};
use super::newton::{Evaluation, Iterate, Right, iterate};
use super::normal::Response;
use super::point::Multiplier;
use super::{APPROACH, LEAPS, NotConverged, Solved};
use crate::linalg::Condensed;

/// An iterate of the mechanical step.
type Mechanics = Iterate<Vec<Multiplier>>;

impl MechanicalStep<'_> {
    /// Solves the step: `guess` and `multipliers` are where the iteration starts, `r` the reduced right-hand side for the increment of the
    /// velocity over the guess.
    ///
    /// # Errors
    /// When the iteration does not end; the multipliers are then as they were.
    pub fn solve(&self, condensed: &mut Condensed, r: &[f64], guess: &[f64], multipliers: &mut Multipliers) -> Result<Solved, NotConverged> {
        let term = Mechanical::new(self, Some(condensed));
        condensed.turn(&term.interface.turns);
        let [r, guess] = [r, guess].map(|v| term.interface.turned(v));
        let right = Right { r: &r, guess: &guess, proximal: None };
        let start = Iterate { x: guess.clone(), multipliers: term.predicted(&guess, term.local(multipliers)) };
        let (end, iterations) = term.solve(condensed, &right, start)?;
        *multipliers = term.global(&end.multipliers);
        Ok(Solved { x: term.interface.back(&end.x), iterations })
    }
}

impl Mechanical<'_> {
    /// Where the pressures of functions start: at J(r + λ p) of the guess, which is G(r) for a soft law and p for a stiff one.
    fn predicted(&self, guess: &[f64], mut multipliers: Vec<Multiplier>) -> Vec<Multiplier> {
        for (i, multiplier) in multipliers.iter_mut().enumerate() {
            if self.contact(i).normal.graph() == crate::contact::GraphKind::Function && self.response[i] != Response::Function {
                multiplier.p = self.laws_at(i, guess, multiplier).normal.pressed;
            }
        }
        multipliers
    }

    /// Solves the step, with bounds that drop when slip starts on the right branches.
    fn solve(&self, condensed: &mut Condensed, right: &Right, mut start: Mechanics) -> Result<(Mechanics, usize), NotConverged> {
        let before = start.multipliers.clone();
        let mut iterations = 0;
        let mut let_go = vec![false; self.rho.len()];
        loop {
            let held: Vec<bool> = start.multipliers.iter().map(|m| m.sticks).collect();
            let (mut end, done) = self.on_branches(condensed, right, start)?;
            iterations += done;
            let sticks: Vec<bool> = end.multipliers.iter().enumerate().map(|(i, m)| self.laws_at(i, &end.x, m).sticks).collect();
            // A point is held at most once in a step, at first or when its slip has turned round through rest, and let go at most once, when it
            // slips under its static bound.
            let mut branches = sticks.clone();
            let mut changed = false;
            for i in (0..sticks.len()).filter(|&i| self.drops(i)) {
                branches[i] = held[i];
                let [now, then] = [end.multipliers[i].q, before[i].q];
                if held[i] && !sticks[i] {
                    (branches[i], let_go[i], changed) = (false, true, true);
                } else if !held[i] && !sticks[i] && !let_go[i] && now[0] * then[0] + now[1] * then[1] < 0.0 {
                    (branches[i], changed) = (true, true);
                }
            }
            let branches = if changed { branches } else { sticks };
            end.multipliers.iter_mut().zip(branches).for_each(|(multiplier, sticks)| multiplier.sticks = sticks);
            if !changed {
                return Ok((end, iterations));
            }
            start = end;
        }
    }

    /// Solves the step with the bounds that drop when slip starts on the branches of `start`.
    fn on_branches(&self, condensed: &mut Condensed, right: &Right, start: Mechanics) -> Result<(Mechanics, usize), NotConverged> {
        if self.is_convex() {
            let (x, before) = self.descend(condensed, right);
            let sticks: Vec<bool> = start.multipliers.iter().map(|m| m.sticks).collect();
            let start = Iterate { multipliers: self.at_minimum(&x, &sticks), x };
            return match iterate(self, condensed, right, start.clone(), LEAPS) {
                Ok((end, after)) => Ok((end, before + after)),
                Err(failed) => self.approach(condensed, right, start, before + failed.iterations),
            };
        }
        let held: Vec<bool> = start.multipliers.iter().map(|m| m.sticks).collect();
        match iterate(self, condensed, right, start, LEAPS) {
            Ok(done) => Ok(done),
            Err(failed) => self.begin_again(condensed, right, failed, &held),
        }
    }

    /// Starts again where the body rests without friction, and if that fails too, approaches the solution.
    fn begin_again(&self, condensed: &mut Condensed, right: &Right, failed: NotConverged, sticks: &[bool]) -> Result<(Mechanics, usize), NotConverged> {
        let mut start = Iterate { x: right.guess.to_vec(), multipliers: self.at_minimum(right.guess, sticks) };
        let mut iterations = failed.iterations;
        if self.rises() {
            let (x, before) = self.descend(condensed, right);
            iterations += before;
            start = Iterate { multipliers: self.at_minimum(&x, sticks), x };
            match iterate(self, condensed, right, start.clone(), LEAPS) {
                Ok((end, done)) => return Ok((end, iterations + done)),
                Err(why) => iterations += why.iterations,
            }
        }
        self.approach(condensed, right, start, iterations)
    }

    /// Approaches the solution by proximal steps: with β diag(S) (w − anchor) added, the step has one solution when β is large; the anchor
    /// follows it, and β falls as the steps succeed.
    fn approach(&self, condensed: &mut Condensed, right: &Right, mut reached: Mechanics, mut iterations: usize) -> Result<(Mechanics, usize), NotConverged> {
        let mut beta = 1.0;
        while iterations < APPROACH {
            let near = Right { proximal: Some((beta, reached.x.clone())), ..right.clone() };
            match iterate(self, condensed, &near, reached.clone(), LEAPS) {
                Ok((next, done)) => {
                    iterations += done;
                    reached = next;
                    beta *= 0.25;
                    match iterate(self, condensed, right, reached.clone(), LEAPS) {
                        Ok((end, done)) => return Ok((end, iterations + done)),
                        Err(why) => iterations += why.iterations,
                    }
                }
                Err(why) => {
                    iterations += why.iterations;
                    beta *= 16.0;
                }
            }
        }
        Err(Evaluation::new(self, condensed, right, reached).failure(self, iterations))
    }
}
