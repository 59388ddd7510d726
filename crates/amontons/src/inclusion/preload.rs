//! Sections that are tightened: how far their sides are drawn together, so that they bear a given tension.
//!
//! A bolt is cut at a section and tied there, with both sides drawn together by one length δ at all points:
//!
//! ```text
//!     r = u_ν − g − δ = 0,   q sticks,        T(δ) = −Σ ω p = F while it is tightened, δ = const. after that.
//! ```
//!
//! T does not fall as δ grows. The unknown δ, one for each section that is tightened in the step, are found by
//! Broyden's method from differences over about the length that the bolt alone would need; with a contact that does not
//! change it is exact after one step. Where T stays as it is, because gaps close first, the length is doubled.

use faer::Mat;
use faer::linalg::solvers::Solve;

use super::mechanical::{Mechanical, MechanicalStep, Multipliers};
use super::{Failure, Frame, Solved};
use crate::linalg::Condensed;
use crate::list::List;

/// Relative error of a tension that is as small as the round-off of a step, and one that is accepted where the
/// round-off is larger.
const ROUND_OFF: f64 = 1e-13;
const ACCEPTED: f64 = 1e-9;
/// Least share of its force by which the tension of a section is changed for a difference: far above the round-off.
const SHARE: f64 = 1e-3;
/// Share of the stiffness of a section below which nothing resists its closing yet.
const RESISTS: f64 = 1e-9;
/// Most doublings of a length, halvings of a step, and steps.
const DOUBLINGS: usize = 60;
const HALVINGS: usize = 8;
const STEPS: usize = 60;

/// A section that is tightened in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// The number of its contact.
    pub contact: usize,
    /// F at the end of the step, N per unit of thickness in two dimensions.
    pub force: f64,
}

/// What a try has found.
struct Tried {
    /// By how much each section is drawn together in the step, m.
    drawn: Vec<f64>,
    /// T of each, and Σ ω |p|, N.
    tension: Vec<f64>,
    size: Vec<f64>,
    solved: Solved,
    multipliers: Multipliers,
}

impl MechanicalStep<'_> {
    /// Solves the step as [`MechanicalStep::solve`] does, with sections that are tightened: also by how much each is
    /// drawn together beyond what the frames say, m.
    ///
    /// # Errors
    /// As there, and where no length makes a section bear its force.
    pub fn solve_tightened(
        &self,
        condensed: &mut dyn Condensed,
        [r, guess]: [&[f64]; 2],
        multipliers: &mut Multipliers,
        sections: &[Section],
    ) -> Result<(Solved, Vec<f64>), Failure> {
        if sections.is_empty() {
            return Ok((self.solve(condensed, r, guess, multipliers)?, Vec::new()));
        }
        let stiffness = self.stiffness(condensed, sections);
        let mut tries = Tries { step: self, condensed, right: [r, guess], sections, iterations: 0 };
        let first = tries.at(vec![0.0; sections.len()], multipliers)?;
        let last = tries.end(first, &stiffness)?;
        *multipliers = last.multipliers;
        Ok((Solved { iterations: tries.iterations, ..last.solved }, last.drawn))
    }

    /// The stiffness of the material beside each section, N/m: not less than that of the bolt.
    fn stiffness(&self, condensed: &dyn Condensed, sections: &[Section]) -> Vec<f64> {
        let term = Mechanical::new(self, Some(condensed));
        let of = |section: &Section| {
            let points = self.boundary.points.iter().zip(&term.rho);
            let own = points.filter(|(point, _)| point.contact == section.contact);
            own.map(|(point, rho)| point.weight * rho / self.rule.gamma).sum()
        };
        sections.iter().map(of).collect()
    }
}

/// A step that is solved for several lengths.
struct Tries<'a> {
    step: &'a MechanicalStep<'a>,
    condensed: &'a mut dyn Condensed,
    /// The right-hand side and the guess.
    right: [&'a [f64]; 2],
    sections: &'a [Section],
    /// Newton iterations.
    iterations: usize,
}

impl Tries<'_> {
    /// The step with sections drawn together by these lengths.
    fn at(&mut self, drawn: Vec<f64>, from: &Multipliers) -> Result<Tried, Failure> {
        let MechanicalStep { boundary, frames, rule, .. } = *self.step;
        let of = |contact: usize| self.sections.iter().zip(&drawn).find(|(section, _)| section.contact == contact);
        let moved = |(point, frame): (&crate::contact::PointOnBoundary, &Frame)| {
            frame.drawn(of(point.contact).map_or(0.0, |(_, drawn)| *drawn), rule.gamma)
        };
        let frames: List<Frame> = boundary.points.iter().zip(frames).map(moved).collect();
        let step = MechanicalStep { frames: &frames, ..*self.step };
        let mut multipliers = from.clone();
        let [r, guess] = self.right;
        let solved = step.solve(self.condensed, r, guess, &mut multipliers)?;
        self.iterations += solved.iterations;
        let forces = |section: &Section| {
            let points = boundary.points.iter().zip(&multipliers.p);
            let own = points.filter(|(point, _)| point.contact == section.contact);
            own.fold([0.0; 2], |[sum, size], (point, p)| [sum - point.weight * p, size + (point.weight * p).abs()])
        };
        let forces: Vec<[f64; 2]> = self.sections.iter().map(forces).collect();
        let (tension, size) = forces.iter().map(|[sum, size]| (*sum, *size)).unzip();
        Ok(Tried { drawn, tension, size, solved, multipliers })
    }

    /// What each section lacks.
    fn lacks(&self, at: &Tried) -> Vec<f64> {
        self.sections.iter().zip(&at.tension).map(|(section, tension)| section.force - tension).collect()
    }

    /// The largest of what sections lack, relative to what they bear.
    fn error(&self, at: &Tried) -> f64 {
        let sizes = self.sections.iter().zip(&at.size).map(|(section, size)| section.force.abs().max(*size));
        let shares = self.lacks(at).into_iter().zip(sizes);
        shares.map(|(lack, size)| if lack == 0.0 { 0.0 } else { lack.abs() / size }).fold(0.0, f64::max)
    }

    /// The lengths at which all sections bear their forces.
    fn end(&mut self, mut now: Tried, stiffness: &[f64]) -> Result<Tried, Failure> {
        let mut slopes = Mat::<f64>::zeros(0, 0);
        for _ in 0..STEPS {
            let error = self.error(&now);
            if error <= ROUND_OFF {
                return Ok(now);
            }
            if slopes.nrows() == 0 {
                (now, slopes) = self.slopes(now, stiffness)?;
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
                // Differences over other lengths, from where it is now.
                slopes = Mat::zeros(0, 0);
                continue;
            };
            now = next;
        }
        let error = self.error(&now);
        if error <= ACCEPTED { Ok(now) } else { Err(self.untightened(&now)) }
    }

    /// A part of the way along a change of the lengths at which less is lacking, the slopes corrected by what each try
    /// tells; none where there is no such part.
    fn nearer(&mut self, now: &Tried, towards: &[f64], slopes: &mut Mat<f64>) -> Result<Option<Tried>, Failure> {
        let error = self.error(now);
        let mut alpha = 1.0;
        for _ in 0..HALVINGS {
            let change: Vec<f64> = towards.iter().map(|change| alpha * change).collect();
            let drawn = now.drawn.iter().zip(&change).map(|(drawn, change)| drawn + change).collect();
            match self.at(drawn, &now.multipliers) {
                Ok(next) => {
                    correct(slopes, &change, [&now.tension, &next.tension]);
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

    /// The change of all tensions with each length, by differences, and the best of the tries.
    fn slopes(&mut self, now: Tried, stiffness: &[f64]) -> Result<(Tried, Mat<f64>), Failure> {
        let n = now.drawn.len();
        let (mut slopes, mut best) = (Mat::<f64>::zeros(n, n), None::<Tried>);
        for j in 0..n {
            let (lack, size) = (self.lacks(&now)[j], self.sections[j].force.abs().max(now.size[j]));
            let mut change = lack.abs().max(SHARE * size).copysign(lack) / stiffness[j];
            for doubling in 0..=DOUBLINGS {
                let mut drawn = now.drawn.clone();
                drawn[j] += change;
                let tried = self.at(drawn, &now.multipliers)?;
                let slope = (tried.tension[j] - now.tension[j]) / change;
                if slope > RESISTS * stiffness[j] {
                    (0..n).for_each(|i| slopes[(i, j)] = (tried.tension[i] - now.tension[i]) / change);
                    if self.error(&tried) < best.as_ref().map_or(self.error(&now), |best| self.error(best)) {
                        best = Some(tried);
                    }
                    break;
                }
                if doubling == DOUBLINGS || !change.is_finite() {
                    return Err(self.untightened(&tried));
                }
                change *= 2.0;
            }
        }
        Ok((best.unwrap_or(now), slopes))
    }

    /// The section that lacks the most.
    fn untightened(&self, at: &Tried) -> Failure {
        let lacks = self.lacks(at);
        let worst = (0..lacks.len()).max_by(|&i, &j| lacks[i].abs().total_cmp(&lacks[j].abs())).unwrap_or(0);
        let (Some(section), Some(reached)) = (self.sections.get(worst), at.tension.get(worst)) else {
            return Failure::Driven(Vec::new());
        };
        Failure::Untightened { section: *section, reached: *reached }
    }
}

/// Broyden's correction of the slopes by what a change of the lengths has made of the tensions.
fn correct(slopes: &mut Mat<f64>, change: &[f64], [before, after]: [&[f64]; 2]) {
    let square: f64 = change.iter().map(|c| c * c).sum();
    for i in 0..change.len() {
        let expected: f64 = change.iter().enumerate().map(|(j, c)| slopes[(i, j)] * c).sum();
        let rest = after[i] - before[i] - expected;
        change.iter().enumerate().for_each(|(j, c)| slopes[(i, j)] += rest * c / square);
    }
}
