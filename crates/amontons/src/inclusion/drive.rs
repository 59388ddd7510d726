//! Lengths that are solved for with a step: sections of bolts drawn together, and obstacles pressed in.
//!
//! The opposite side of a contact moves by one length δ, the same at all points, along a direction d: the other side of
//! a section along ν, where the section is a tie, or an obstacle along the line on which it is guided. The driving
//! force F balances the contact forces and the inertia of its mass:
//!
//! ```text
//!     T(δ) = m δ̈ − Σ ω (p ν + q)·d = F
//! ```
//!
//! T does not fall as δ grows. The unknown δ, one for each contact that is driven in the step, are found by Broyden's
//! method from differences over about the length that the material beside the contact alone would need; with a contact
//! that does not change it is exact after one step. Where T stays as it is, because gaps close first, the length grows
//! until T does: by what closes the least gap, which passes nothing by, then by twice as much from try to try. Between
//! a length that is too small and one that is too large the next one is where a line through both has F.

use faer::Mat;
use faer::linalg::solvers::Solve;

use super::mechanical::{Mechanical, MechanicalStep};
use super::multipliers::Multipliers;
use super::{Failure, Frame, Solved};
use crate::linalg::Condensed;
use crate::tensor::{Point, dot};

/// Relative error of a force that is as small as the round-off of a step, and one that is accepted where the round-off
/// is larger.
const ROUND_OFF: f64 = 1e-13;
const ACCEPTED: f64 = 1e-9;
/// Least share of its force by which T is changed for a difference: far above the round-off.
const SHARE: f64 = 1e-3;
/// Share of the stiffness beside a contact below which nothing resists its length yet.
const RESISTS: f64 = 1e-9;
/// Most tries until T responds to a length, halvings of a step, and steps.
const TRIES: usize = 120;
const HALVINGS: usize = 8;
const STEPS: usize = 60;

/// A contact that is driven by a force in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// The number of the contact.
    pub contact: usize,
    /// d, a unit vector; none for ν, of a section that is tightened.
    pub direction: Option<Point>,
    /// F at the end of the step, N per unit of thickness in two dimensions.
    pub force: f64,
    /// m δ̈ where δ does not grow in the step beyond where it is, N, and by how much it grows with δ, N/m.
    pub inertia: [f64; 2],
}

impl Drive {
    /// d at a point with this normal.
    fn along(&self, normal: &Point) -> Point {
        self.direction.unwrap_or(*normal)
    }
}

/// The contacts that are driven in a step.
pub struct Drives<'a> {
    /// Each of them.
    pub all: &'a [Drive],
    /// The foundation at the contact points with each δ grown by these lengths.
    pub frames: &'a (dyn Fn(&[f64]) -> Vec<Frame> + Sync),
}

/// Result of a try.
struct Tried {
    /// Growth of each δ in the step, m.
    lengths: Vec<f64>,
    /// T of each, and the sum of the sizes of its terms, N.
    borne: Vec<f64>,
    size: Vec<f64>,
    /// The least gap at a point of each, m; not positive where one is closed.
    gap: Vec<f64>,
    solved: Solved,
    multipliers: Multipliers,
}

impl Mechanical<'_> {
    /// Solves the step as [`Mechanical::solve`] does, with contacts that are driven: also by how much each δ grows
    /// beyond what the frames say, m.
    ///
    /// # Errors
    /// As there, and where no length makes a contact bear its force.
    pub fn solve_driven(
        &mut self,
        condensed: &mut dyn Condensed,
        [r, guess]: [&[f64]; 2],
        multipliers: &mut Multipliers,
        drives: &Drives,
    ) -> Result<(Solved, Vec<f64>), Failure> {
        if drives.all.is_empty() {
            return Ok((self.solve(condensed, r, guess, multipliers)?, Vec::new()));
        }
        let stiffness = self.stiffness(drives.all);
        let mut tries = Tries { step: self.step, condensed, right: [r, guess], drives, stiffness, iterations: 0 };
        let first = tries.at(vec![0.0; drives.all.len()], multipliers)?;
        let last = tries.end(first)?;
        *multipliers = last.multipliers;
        Ok((Solved { iterations: tries.iterations, ..last.solved }, last.lengths))
    }

    /// The stiffness of the material beside each contact, N/m, and of what it accelerates: not less than T grows with
    /// its length.
    fn stiffness(&self, drives: &[Drive]) -> Vec<f64> {
        let MechanicalStep { boundary, rule, .. } = self.step;
        let of = |drive: &Drive| {
            let points = boundary.points.iter().zip(&self.rho);
            let own = points.filter(|(point, _)| point.contact == drive.contact);
            drive.inertia[1] + own.map(|(point, rho)| point.weight * rho / rule.span).sum::<f64>()
        };
        drives.iter().map(of).collect()
    }
}

/// A step that is solved for several lengths.
struct Tries<'a> {
    step: MechanicalStep<'a>,
    condensed: &'a mut dyn Condensed,
    /// The right-hand side and the guess.
    right: [&'a [f64]; 2],
    drives: &'a Drives<'a>,
    stiffness: Vec<f64>,
    /// Newton iterations.
    iterations: usize,
}

impl Tries<'_> {
    /// The step with each δ grown by these lengths.
    fn at(&mut self, lengths: Vec<f64>, from: &Multipliers) -> Result<Tried, Failure> {
        let frames = (self.drives.frames)(&lengths);
        let mut term = Mechanical::new(MechanicalStep { frames: &frames, ..self.step }, Some(self.condensed));
        let mut multipliers = from.clone();
        let [r, guess] = self.right;
        let solved = term.solve(self.condensed, r, guess, &mut multipliers)?;
        self.iterations += solved.iterations;
        let w: Vec<f64> = guess.iter().zip(&solved.x).map(|(value, change)| value + change).collect();
        let states = term.point_states(&w, &multipliers);
        let n = lengths.len();
        let mut tried = Tried {
            lengths,
            borne: Vec::with_capacity(n),
            size: Vec::with_capacity(n),
            gap: Vec::with_capacity(n),
            solved,
            multipliers,
        };
        for (drive, length) in self.drives.all.iter().zip(&tried.lengths) {
            let own = self.step.boundary.points.iter().zip(&states).filter(|(point, _)| point.contact == drive.contact);
            let [rest, rate] = drive.inertia;
            let (mut borne, mut size, mut gap) =
                (rest + rate * length, rest.abs() + (rate * length).abs(), f64::INFINITY);
            for (point, state) in own {
                let along = drive.along(&state.normal);
                let force = point.weight * (state.pressure * dot(&state.normal, &along) + dot(&state.q, &along));
                (borne, size, gap) = (borne - force, size + force.abs(), gap.min(-state.penetration));
            }
            tried.borne.push(borne);
            tried.size.push(size);
            tried.gap.push(gap);
        }
        Ok(tried)
    }

    /// Missing force of each drive: prescribed force minus borne force, N.
    fn lacks(&self, at: &Tried) -> Vec<f64> {
        self.drives.all.iter().zip(&at.borne).map(|(drive, borne)| drive.force - borne).collect()
    }

    /// Missing force of drive j: prescribed force minus borne force, N.
    fn lack(&self, at: &Tried, j: usize) -> f64 {
        self.drives.all[j].force - at.borne[j]
    }

    /// The size of what acts on one.
    fn size(&self, at: &Tried, j: usize) -> f64 {
        self.drives.all[j].force.abs().max(at.size[j])
    }

    /// The largest of what is lacking, relative to what acts.
    fn error(&self, at: &Tried) -> f64 {
        let share = |(j, lack): (usize, f64)| if lack == 0.0 { 0.0 } else { lack.abs() / self.size(at, j) };
        self.lacks(at).into_iter().enumerate().map(share).fold(0.0, f64::max)
    }

    /// The lengths at which all bear their forces.
    fn end(&mut self, mut now: Tried) -> Result<Tried, Failure> {
        let mut slopes = Mat::<f64>::zeros(0, 0);
        for _ in 0..STEPS {
            let error = self.error(&now);
            if error <= ROUND_OFF {
                return Ok(now);
            }
            if slopes.nrows() == 0 {
                (now, slopes) = self.slopes(now)?;
                continue;
            }
            let lacks = self.lacks(&now);
            let right = Mat::from_fn(lacks.len(), 1, |i, _| lacks[i]);
            let towards = slopes.partial_piv_lu().solve(&right);
            let towards: Vec<f64> = (0..lacks.len()).map(|i| towards[(i, 0)]).collect();
            if !towards.iter().all(|change| change.is_finite()) {
                break;
            }
            let Some(next) = self.nearer(&now, &towards, &mut slopes)? else {
                if error <= ACCEPTED {
                    return Ok(now);
                }
                // Differences over other lengths, from where the worst one lacks less.
                let worst = self.worst(&now);
                now = self.alone(&now, worst)?;
                slopes = Mat::zeros(0, 0);
                continue;
            };
            now = next;
        }
        let error = self.error(&now);
        if error <= ACCEPTED { Ok(now) } else { Err(self.unborne(&now)) }
    }

    /// A fraction of the way along a change of the lengths that reduces the missing force, or `None` if there is none.
    /// Each try corrects the slopes.
    fn nearer(&mut self, now: &Tried, towards: &[f64], slopes: &mut Mat<f64>) -> Result<Option<Tried>, Failure> {
        let error = self.error(now);
        let mut alpha = 1.0;
        for _ in 0..HALVINGS {
            let change: Vec<f64> = towards.iter().map(|change| alpha * change).collect();
            let lengths = now.lengths.iter().zip(&change).map(|(length, change)| length + change).collect();
            match self.at(lengths, &now.multipliers) {
                Ok(next) => {
                    correct(slopes, &change, [&now.borne, &next.borne]);
                    if self.error(&next) < error {
                        return Ok(Some(next));
                    }
                }
                Err(failure @ Failure::Linear(_)) => return Err(failure),
                Err(_) => {}
            }
            alpha *= 0.5;
        }
        Ok(None)
    }

    /// The change of each T with each length, by differences, and the best of the tries. Where a length changes its own
    /// T no more than round-off would, gaps are closed first.
    fn slopes(&mut self, mut now: Tried) -> Result<(Tried, Mat<f64>), Failure> {
        let n = now.lengths.len();
        let mut slopes = Mat::<f64>::zeros(n, n);
        let (mut best, mut j) = (None::<Tried>, 0);
        while j < n {
            let change = self.first_change(&now, j);
            if change == 0.0 {
                // Nothing is asked of it, and it bears nothing: it stays where it is.
                slopes[(j, j)] = self.stiffness[j];
                j += 1;
                continue;
            }
            let tried = self.at(grown(&now.lengths, j, change), &now.multipliers)?;
            (0..n).for_each(|i| slopes[(i, j)] = (tried.borne[i] - now.borne[i]) / change);
            if slopes[(j, j)] > RESISTS * self.stiffness[j] {
                if self.error(&tried) < best.as_ref().map_or(self.error(&now), |best| self.error(best)) {
                    best = Some(tried);
                }
                j += 1;
            } else if self.lack(&now, j).abs() <= ACCEPTED * self.size(&now, j) {
                // It bears its force over a range of lengths, and stays where it is.
                (0..n).for_each(|i| slopes[(i, j)] = if i == j { self.stiffness[j] } else { 0.0 });
                j += 1;
            } else {
                now = self.alone(&now, j)?;
                (slopes, best, j) = (Mat::zeros(n, n), None, 0);
            }
        }
        Ok((best.unwrap_or(now), slopes))
    }

    /// The change of a length with which the material beside its contact alone would bear what is lacking.
    fn first_change(&self, now: &Tried, j: usize) -> f64 {
        let lack = self.lack(now, j);
        lack.abs().max(SHARE * self.size(now, j)).copysign(lack) / self.stiffness[j]
    }

    /// A try at which one lacks at most half as much, found by its own length alone: between one at which it lacks more
    /// and one at which it bears too much.
    fn alone(&mut self, now: &Tried, j: usize) -> Result<Tried, Failure> {
        let before = self.lack(now, j);
        let mut change = self.first_change(now, j);
        // The largest change that is known to be too small and the least that is too large, with what is lacking there.
        let (mut small, mut large) = ((0.0, before), None::<(f64, f64)>);
        // Further penetration that is tried if no gap is left to close.
        let (mut press, mut more, mut last) = (change, change, None);
        for _ in 0..TRIES {
            match self.at(grown(&now.lengths, j, change), &now.multipliers) {
                Ok(tried) => {
                    let lack = self.lack(&tried, j);
                    if lack.abs() <= 0.5 * before.abs() {
                        return Ok(tried);
                    }
                    if lack * before > 0.0 {
                        small = (change, lack);
                        let closes = if tried.gap[j].is_finite() { tried.gap[j] } else { 0.0 };
                        if closes > press.abs() {
                            more = closes.copysign(press);
                        } else {
                            (more, press) = (press, 2.0 * press);
                        }
                    } else {
                        large = Some((change, lack));
                    }
                    last = Some(tried);
                }
                // It is pressed in by far too much.
                Err(Failure::NotConverged(_)) if small.0 != 0.0 => large = Some((change, f64::NAN)),
                Err(failure) => return Err(failure),
            }
            let next = large.map_or(small.0 + more, |large| between(small, large));
            if next.to_bits() == change.to_bits() || !next.is_finite() {
                break;
            }
            change = next;
        }
        Err(self.unborne(last.as_ref().unwrap_or(now)))
    }

    /// The one that lacks the largest share.
    fn worst(&self, at: &Tried) -> usize {
        let share = |j: usize| if self.lack(at, j) == 0.0 { 0.0 } else { self.lack(at, j).abs() / self.size(at, j) };
        (0..at.lengths.len()).max_by(|&i, &j| share(i).total_cmp(&share(j))).unwrap_or(0)
    }

    /// No length makes the worst one bear its force.
    fn unborne(&self, at: &Tried) -> Failure {
        let worst = self.worst(at);
        Failure::Unborne { drive: self.drives.all[worst], reached: at.borne[worst] }
    }
}

/// A change between one that is too small and one that is too large, with what is lacking there: where a line through
/// both is zero, away from both ends; the middle where it is not known.
fn between((small, lacks): (f64, f64), (large, exceeds): (f64, f64)) -> f64 {
    let share = lacks / (lacks - exceeds);
    let share = if share.is_finite() { share.clamp(0.1, 0.9) } else { 0.5 };
    small + share * (large - small)
}

/// Lengths of which one has grown.
fn grown(lengths: &[f64], j: usize, change: f64) -> Vec<f64> {
    lengths.iter().enumerate().map(|(i, length)| if i == j { length + change } else { *length }).collect()
}

/// Broyden's correction of the slopes by what a change of the lengths has made of the forces.
fn correct(slopes: &mut Mat<f64>, change: &[f64], [before, after]: [&[f64]; 2]) {
    let square: f64 = change.iter().map(|c| c * c).sum();
    for i in 0..change.len() {
        let expected: f64 = change.iter().enumerate().map(|(j, c)| slopes[(i, j)] * c).sum();
        let rest = after[i] - before[i] - expected;
        change.iter().enumerate().for_each(|(j, c)| slopes[(i, j)] += rest * c / square);
    }
}
