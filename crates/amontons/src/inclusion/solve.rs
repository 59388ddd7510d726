//! Solution of the mechanical step on Γ_C: Newton's method, and the alternatives if it does not converge.

use super::friction::Slip;
use super::mechanical::{Mechanical, MechanicalStep};
use super::multipliers::Multipliers;
use super::newton::{Effort, Evaluation, Iterate, Outcome, Right, iterate};
use super::normal::Response;
use super::point::Multiplier;
use super::settle::{Mechanics, Settled};
use super::{Failure, ITERATIONS, NotConverged, Solved};
use crate::contact::{Contact, PointOnBoundary};
use crate::linalg::{Condensed, max_abs};
use crate::tensor::Point;

/// Newton's method from where a step starts, from the end of the path, by proximal steps, and on a smooth step of the
/// path.
const FIRST: Effort = Effort { leaps: 4, is_free: false, iterations: 14, enough: 0.0 };
const SECOND: Effort = Effort { leaps: 8, is_free: false, iterations: 60, enough: 0.0 };
const NEAR: Effort = Effort { leaps: 8, is_free: false, iterations: ITERATIONS, enough: 0.0 };
const SMOOTH: Effort = Effort { leaps: 0, is_free: true, iterations: 12, enough: 1e-3 };
/// Reduction of the creep speed of smooth friction in each step of the path, its reduction over the whole path below
/// which friction counts as exact, and its further reduction per step until the step is accepted.
const SHARPER: f64 = 1e-3;
const SHARP: f64 = 1e-12;
const SHARPEST: f64 = 0.1;
/// Iterations after which proximal steps have failed too.
const APPROACH: usize = 20 * ITERATIONS;
/// Further iterations allowed if a body slides under a load that friction does not bear and the step is then halved.
const FEW: usize = ITERATIONS;

impl Mechanical<'_> {
    /// Solves the step: `guess` and `multipliers` are where the iteration starts, `r` the reduced right-hand side for
    /// the increment of the velocity over the guess.
    ///
    /// # Errors
    /// If the iteration does not converge, or a linear system is not solved. The multipliers are then unchanged.
    pub fn solve(
        &mut self,
        condensed: &mut dyn Condensed,
        r: &[f64],
        guess: &[f64],
        multipliers: &mut Multipliers,
    ) -> Result<Solved, Failure> {
        condensed.turn(&self.interface.turns);
        let [r, guess] = [r, guess].map(|v| self.interface.turned(v));
        self.find_motions(condensed);
        let start = Iterate { x: guess.clone(), multipliers: self.predicted(&guess, self.local(multipliers)) };
        let Settled { end, iterations, loose, held } = self.solve_held(condensed, [&r, &guess], start)?;
        *multipliers = self.global(&end.multipliers);
        self.step.share(multipliers);
        Ok(Solved { x: self.interface.back(&end.x), iterations, loose, held })
    }
}

impl MechanicalStep<'_> {
    /// Gives the points at a node and at one that follows it the same tractions, turned: they have the same unknowns,
    /// and only the sum of their forces is determined where the foundation is rigid or they stick.
    fn share(&self, multipliers: &mut Multipliers) {
        if self.space.links.is_empty() {
            return;
        }
        let alone = |point: &PointOnBoundary| match point.nodes.as_slice() {
            [(node, _)] => Some((self.boundary.nodes[*node], point.contact)),
            _ => None,
        };
        let points = self.boundary.points.iter().enumerate();
        let mut of_node: Vec<((u32, usize), usize)> =
            points.filter_map(|(i, point)| Some((alone(point)?, i))).collect();
        of_node.sort_unstable();
        let at = |node: u32, contact: usize| {
            let place = of_node.binary_search_by_key(&(node, contact), |(place, _)| *place).ok()?;
            Some(of_node.get(place)?.1)
        };
        for link in &self.space.links {
            for contact in 0..self.contacts.len() {
                let [Some(own), Some(followed)] = [link.node, link.to].map(|node| at(node, contact)) else {
                    continue;
                };
                let weights = [own, followed].map(|i| self.boundary.points[i].weight);
                let mean =
                    |own: f64, followed: f64| (weights[0] * own + weights[1] * followed) / (weights[0] + weights[1]);
                let p = mean(multipliers.p[own], multipliers.p[followed]);
                let (q_own, q) = (link.back(&multipliers.q[own]), multipliers.q[followed]);
                let q: Point = std::array::from_fn(|c| mean(q_own[c], q[c]));
                (multipliers.p[own], multipliers.p[followed]) = (p, p);
                (multipliers.q[own], multipliers.q[followed]) = (link.turned(&q), q);
            }
        }
    }
}

impl Mechanical<'_> {
    /// Starting pressures of functions: J(r + λ p) of the guess, which is G(r) for a soft law and p for a stiff one.
    fn predicted(&self, guess: &[f64], mut multipliers: Vec<Multiplier>) -> Vec<Multiplier> {
        let pressures = self.at_points(|i| {
            let is_found = self.contact(i).normal.graph() == crate::contact::GraphKind::Function
                && self.response[i] != Response::Function;
            is_found.then(|| self.laws_at(i, guess, &multipliers[i]).normal.pressed)
        });
        for (multiplier, p) in multipliers.iter_mut().zip(pressures) {
            multiplier.p = p.unwrap_or(multiplier.p);
        }
        multipliers
    }

    /// Solves the step, with bounds that drop when slip starts on the right branches.
    pub(super) fn solve_branches(
        &self,
        condensed: &mut dyn Condensed,
        right: &Right,
        mut start: Mechanics,
    ) -> Result<(Mechanics, usize), Failure> {
        let before = start.multipliers.clone();
        let mut iterations = 0;
        let mut let_go = vec![false; self.rho.len()];
        loop {
            let held: Vec<bool> = start.multipliers.iter().map(|m| m.sticks).collect();
            let (mut end, done) = self.on_branches(condensed, right, start)?;
            iterations += done;
            let sticks = self.at_points(|i| self.laws_at(i, &end.x, &end.multipliers[i]).sticks);
            // A point is held at most once in a step, at first or when its slip has turned round through rest, and let
            // go at most once, when it slips under its static bound.
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

    /// Solves the step with the bounds that drop when slip starts on the branches of `start`: by Newton's method; where
    /// that does not end and parts are loose, from the step in which soft springs hold them; and where that does not
    /// end either, by proximal steps.
    fn on_branches(
        &self,
        condensed: &mut dyn Condensed,
        right: &Right,
        start: Mechanics,
    ) -> Result<(Mechanics, usize), Failure> {
        let mut made = self.by_newton(condensed, right, start.clone())?;
        if made.failure.is_some()
            && let Some((soft, springs)) = self.softly_held()
        {
            let softly = soft.by_newton(condensed, &Right { springs: &springs, ..right.clone() }, start)?;
            let mut iterations = made.iterations + softly.iterations;
            if softly.failure.is_none() {
                let last = iterate(self, condensed, right, softly.end, &SECOND)?;
                iterations += last.iterations;
                if last.failure.is_none() {
                    made = last;
                }
            }
            made.iterations = iterations;
        }
        let iterations = made.iterations;
        match made.failure {
            None => Ok((made.end, iterations)),
            Some(why) => self.approach(condensed, right, made.end, NotConverged { iterations, ..why }),
        }
    }

    /// Newton's method: from an iterate; where that does not end, from the body at rest if it is nearly a solution;
    /// then from the step without friction, whose pattern of contact is near where much closes at once; then from the
    /// end of a path of steps with smooth friction.
    fn by_newton(
        &self,
        condensed: &mut dyn Condensed,
        right: &Right,
        start: Mechanics,
    ) -> Result<Outcome<Vec<Multiplier>>, Failure> {
        let held: Vec<bool> = start.multipliers.iter().map(|m| m.sticks).collect();
        let at_rest = self.at_rest(right, &start.multipliers);
        let mut made = iterate(self, condensed, right, start, &FIRST)?;
        let mut iterations = made.iterations;
        if made.failure.is_some() {
            let rest = Evaluation::new(self, condensed, right, at_rest.clone())?;
            if rest.residual <= SMOOTH.enough * rest.scale {
                made = iterate(self, condensed, right, at_rest, &FIRST)?;
                iterations += made.iterations;
            }
        }
        if made.failure.is_some() {
            let (minimum, before) = self.without_friction(condensed, right, &held)?;
            iterations += before;
            if self.rises() && self.has_unique_multipliers() {
                made = iterate(self, condensed, right, minimum.clone(), &FIRST)?;
                iterations += made.iterations;
            }
            if made.failure.is_some() {
                let (start, before) = self.path(condensed, right, minimum, &held)?;
                made = iterate(self, condensed, right, start, &SECOND)?;
                iterations += before + made.iterations;
            }
        }
        Ok(Outcome { iterations, ..made })
    }

    /// The body at rest under the tractions of the step before: the solution where what has moved the body stands still
    /// from now on, as after a press-in, and near it where motion turns round. From the velocity of the step before it
    /// is far where most points are at their bound. Points whose bound drops stay on the branch they are on.
    fn at_rest(&self, right: &Right, before: &[Multiplier]) -> Mechanics {
        let of = |(i, m): (usize, &Multiplier)| Multiplier { sticks: m.sticks || !self.drops(i), ..*m };
        Iterate { x: vec![0.0; right.guess.len()], multipliers: before.iter().enumerate().map(of).collect() }
    }

    /// True if there are no more points than nodes. Gauss points may hold a body more often than it has unknowns: their
    /// multipliers are then those that the path ends at.
    fn has_unique_multipliers(&self) -> bool {
        self.interface.len() <= self.step.boundary.nodes.len()
    }

    /// The step without friction, or with it as a drag, where pressures do not fall; else the guess.
    fn without_friction(
        &self,
        condensed: &mut dyn Condensed,
        right: &Right,
        held: &[bool],
    ) -> Result<(Mechanics, usize), Failure> {
        let (x, iterations) = if self.rises() { self.descend(condensed, right)? } else { (right.guess.to_vec(), 0) };
        Ok((Iterate { multipliers: self.at_minimum(&x, held), x }, iterations))
    }

    /// A path that leads to the solution: from the step without friction on with smooth friction, ever sharper. Where
    /// the step has one solution, so has each of these (book, Theorem 2), and smooth steps are what Newton's method is
    /// made for.
    fn path(
        &self,
        condensed: &mut dyn Condensed,
        right: &Right,
        mut now: Mechanics,
        held: &[bool],
    ) -> Result<(Mechanics, usize), Failure> {
        let mut iterations = 0;
        let slips = |i: &usize| !self.contact(*i).friction.never_slips();
        let fastest = (0..self.interface.len()).filter(slips).map(|i| self.slip_speed(i, &now.x)).fold(0.0, f64::max);
        let is_smooth = |contact: &Contact| contact.friction.is_frictionless() || contact.friction.never_slips();
        if fastest == 0.0 || self.step.contacts.iter().all(is_smooth) {
            return Ok((now, iterations));
        }
        // Below it slip is the round-off of the velocities.
        let least = (f64::EPSILON * max_abs(&now.x)).max(f64::MIN_POSITIVE);
        let mut speed = fastest;
        loop {
            let made = iterate(&self.with(Slip::Smooth { speed }), condensed, right, now, &SMOOTH)?;
            (now, iterations) = (made.end, iterations + made.iterations);
            let is_sharp = speed <= SHARP * fastest;
            if is_sharp || speed <= least {
                // A point sticks if it moves no faster than the creep of smooth friction.
                for (i, multiplier) in now.multipliers.iter_mut().enumerate() {
                    multiplier.sticks =
                        if self.drops(i) { held[i] } else { self.slip_speed(i, &now.x) < speed / SHARPER };
                }
                if speed <= least || Evaluation::new(self, condensed, right, now.clone())?.converged() {
                    break;
                }
            }
            speed = (if is_sharp { SHARPEST } else { SHARPER } * speed).max(least);
        }
        Ok((now, iterations))
    }

    /// Approaches the solution by proximal steps: with β diag(S) (w − anchor) added, the step has one solution when β
    /// is large; the anchor follows it, and β falls as the steps succeed. Beyond 1/ε_machine it holds the step where it
    /// is.
    fn approach(
        &self,
        condensed: &mut dyn Condensed,
        right: &Right,
        mut reached: Mechanics,
        mut why: NotConverged,
    ) -> Result<(Mechanics, usize), Failure> {
        let mut beta = 1.0;
        let is_short = self.step.may_be_halved || !self.slipping(condensed, right, &reached)?.is_empty();
        let most = if is_short { why.iterations + FEW } else { APPROACH };
        while why.iterations < most && beta * f64::EPSILON < 1.0 {
            let before = why.iterations;
            let near = Right { proximal: Some((beta, reached.x.clone())), ..right.clone() };
            let made = iterate(self, condensed, &near, reached.clone(), &NEAR)?;
            if made.failure.is_some() {
                (beta, why.iterations) = (16.0 * beta, before + made.iterations);
                continue;
            }
            (reached, beta) = (made.end, 0.25 * beta);
            let iterations = before + made.iterations;
            let made = iterate(self, condensed, right, reached.clone(), &NEAR)?;
            match made.failure {
                None => return Ok((made.end, iterations + made.iterations)),
                Some(failure) => why = NotConverged { iterations: iterations + made.iterations, ..failure },
            }
        }
        let slipping = self.slipping(condensed, right, &reached)?;
        Err(if slipping.is_empty() { why.into() } else { Failure::Driven(slipping) })
    }
}
