//! Steps whose length follows from an estimate of their error.

use std::sync::Arc;

use super::march::March;
use crate::equation::{StepError, tried};
use crate::state::{State, StepReport};
use crate::time::{Analysis, Budget, GAUGED, HALVINGS, Instant, Pace, StepErrors, Timeline};

/// A step in its length and in halves.
struct Tried {
    /// The step as a whole.
    whole: State,
    /// The step as a whole from the state of the coarse run; `None` if that is the same.
    coarse: Option<State>,
    /// The state at the middle of the halves.
    middle: State,
    /// The state at their end, and the report.
    end: State,
    report: StepReport,
}

impl March {
    /// Makes the next step of an automatic phase.
    ///
    /// Two runs go side by side: the steps of this one are two halves, those of the coarse one are whole. Their
    /// difference is the error. A whole step from the state of this run parts it in what the step adds and what is left
    /// of the error before. If the step adds more than the budget of the phase allows, or the equations are not solved,
    /// it is made anew with a shorter length.
    pub(super) fn choose(&mut self, old: &State, accuracy: f64) -> Result<(State, StepReport), StepError> {
        let mut pace = old.pace.clone();
        let analysis = self.problem.timeline.next(old.step, &pace, pace.level).analysis;
        pace.budget = pace.budget.at(self.norms_of(old, analysis));
        if pace.at == 0 {
            pace.level = Timeline::first_level(accuracy);
            pace.budget = self.expected(old, &pace)?;
        }
        let (mut level, mut failures, mut rejected) = (pace.level, 0, 0);
        let mut whole: Option<State> = None;
        loop {
            let now = self.problem.timeline.next(old.step, &pace, level);
            let Some(made) = tried(self.whole_and_halves(old, &now, whole.take()))? else {
                rejected += 1;
                failures += 1;
                if failures > HALVINGS || level + 1 >= Pace::LEVELS {
                    return self.unjudged(old, &pace);
                }
                level += 1;
                continue;
            };
            let errors = self.errors(&made, &now);
            if pace.at == 0 {
                pace.budget = pace.budget.expecting(self.norms_of(&made.end, analysis));
            }
            let places = |level: u32| [pace.share(), 1.0 / (1u64 << level) as f64];
            let ratio = pace.budget.ratio(&errors, accuracy, self.order(&now), places(level));
            if ratio <= 1.0 || level + 1 >= Pace::LEVELS {
                pace = pace.noted(now.k, rejected);
                return Ok(self.accepted(made, (&now, level), pace, (&errors, accuracy)));
            }
            rejected += 1;
            let shorter = shorter_by(ratio, self.order(&now)).min(Pace::LEVELS - 1 - level);
            // The first half is the next step as a whole.
            whole = (shorter == 1).then_some(made.middle);
            level += shorter;
        }
    }

    /// The step as a whole, if it is not known, in both runs, and in halves.
    fn whole_and_halves(&mut self, old: &State, now: &Instant, known: Option<State>) -> Result<Tried, StepError> {
        let whole = match known {
            Some(whole) => whole,
            None => self.entire(old, now)?,
        };
        let coarse = old.coarse.as_ref().map(|coarse| self.entire(coarse, now)).transpose()?;
        let (middle, first) = self.half(old, now, old.t + 0.5 * (now.t - old.t))?;
        let (end, second) = self.half(&middle, now, now.t)?;
        Ok(Tried { whole, coarse, middle, end, report: second.after(&first) })
    }

    fn entire(&mut self, old: &State, now: &Instant) -> Result<State, StepError> {
        // Products are known by their time alone, and two runs have the same times.
        self.products = None;
        let (mut state, _) = self.attempt(old, now, now.t, 0)?;
        self.products = None;
        state.earlier = self.before([old, &state], now, now.k);
        Ok(state)
    }

    fn half(&mut self, old: &State, now: &Instant, t: f64) -> Result<(State, StepReport), StepError> {
        let (mut state, report) = self.advance(old, now, t, 1)?;
        state.earlier = self.before([old, &state], now, 0.5 * now.k);
        Ok((state, report))
    }

    /// A step whose equations are not solved with any length is made as one of equal steps is, which names the failure
    /// or finds a way around it. Nothing is known of its error.
    fn unjudged(&mut self, old: &State, pace: &Pace) -> Result<(State, StepReport), StepError> {
        let now = self.problem.timeline.next(old.step, pace, pace.level);
        let (mut state, report) = self.advance(old, &now, now.t, 0)?;
        state.earlier = self.before([old, &state], &now, now.k);
        let mut judged = pace.clone().noted(now.k, HALVINGS as usize);
        judged.budget.error = [0.0; GAUGED];
        judged.chosen.unjudged += 1;
        state.pace = self.problem.timeline.after(&judged, &now, pace.level);
        Ok((state, report))
    }

    /// The state at the end of an accepted step, with the place and level for the next one: twice the length if its
    /// error is then expected to be allowed.
    fn accepted(
        &self,
        made: Tried,
        (now, level): (&Instant, u32),
        mut pace: Pace,
        (errors, accuracy): (&StepErrors, f64),
    ) -> (State, StepReport) {
        let Tried { whole, coarse, mut end, report, .. } = made;
        let before = pace.budget.error;
        pace.budget = pace.budget.at(self.norms_of(&end, now.analysis)).after(errors);
        let mut next = self.problem.timeline.after(&pace, now, level);
        if next.may_grow(level) {
            let (order, share) = (self.order(now), 1.0 / (1u64 << (level - 1)) as f64);
            let errors = errors.of_twice_the_length(before, order);
            let expected = next.budget.ratio(&errors, accuracy, order, [next.share(), share]);
            next.level = if expected <= 1.0 { level - 1 } else { level };
        }
        if !self.problem.timeline.is_between(end.step, &next) {
            end.coarse = Some(Arc::new(coarse.unwrap_or(whole)));
        }
        end.pace = next;
        (end, report)
    }

    /// The budget at the start of a phase, with the norms to which the solution comes in two steps over all of the
    /// phase. A solution that begins with zero has no norm yet that its errors could be compared with.
    fn expected(&mut self, old: &State, pace: &Pace) -> Result<Budget, StepError> {
        let mut budget = pace.budget;
        for level in 0..=pace.level {
            let now = self.problem.timeline.next(old.step, pace, level);
            let middle = old.t + 0.5 * (now.t - old.t);
            let Some((first, _)) = tried(self.attempt(old, &now, middle, 1))? else { continue };
            budget = budget.expecting(self.norms_of(&first, now.analysis));
            let Some((second, _)) = tried(self.attempt(&first, &now, now.t, 1))? else { continue };
            budget = budget.expecting(self.norms_of(&second, now.analysis));
            break;
        }
        self.products = None;
        Ok(budget)
    }

    /// Order of the scheme in the step.
    fn order(&self, now: &Instant) -> i32 {
        let rule = self.problem.rule(now.analysis, now.k);
        if rule.is_backward_euler() { 1 } else { 2 }
    }

    /// The errors of a step, by the differences of the two runs. For a scheme of first order these are the errors of
    /// this run, and for one of second order three times those; but where contact opens and closes its order is 1, so
    /// that half of them lies between.
    ///
    /// Velocities at the end of steps whose equations hold at their middle may change their sign in each step, as those
    /// of points that are held do. There u alone is judged: it has the errors of the velocities before.
    fn errors(&self, made: &Tried, now: &Instant) -> StepErrors {
        let of_w = if self.problem.rule(now.analysis, now.k).is_at_end() { 1.0 } else { 0.0 };
        let order = f64::from(self.order(now));
        let Tried { whole, coarse, end, .. } = made;
        let minus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) / order).collect::<Vec<f64>>();
        let difference = |a: &State, b: &State| {
            let w = minus(&a.w, &b.w).iter().map(|w| of_w * w).collect::<Vec<f64>>();
            self.norms([&minus(&a.u, &b.u), &w, &minus(&a.theta, &b.theta)], now.analysis)
        };
        let own = difference(whole, end);
        let Some(coarse) = coarse else { return StepErrors { own, left: [0.0; GAUGED], all: own } };
        StepErrors { own, left: difference(coarse, whole), all: difference(coarse, end) }
    }

    fn norms_of(&self, state: &State, analysis: Analysis) -> [f64; GAUGED] {
        self.norms([&state.u, &state.w, &state.theta], analysis)
    }

    /// Norms of a solution: the root of twice the energy of u and w, with inertia only where it acts, ‖u‖_H, which sees
    /// the motion of a body that nothing holds, and ‖θ‖_{L²}.
    fn norms(&self, [u, w, theta]: [&[f64]; 3], analysis: Analysis) -> [f64; GAUGED] {
        let (discrete, physics) = (&self.discrete, self.problem.physics);
        let mut norms = [0.0; GAUGED];
        if physics.has_mechanics() {
            let elastic = self.elastic.get_or_init(|| discrete.elastic_form());
            let (rho, inertia) = discrete.inertia();
            let kinetic = if analysis == Analysis::Dynamic { rho.sqrt() * discrete.norm(inertia, w) } else { 0.0 };
            norms[0] = kinetic.hypot(discrete.norm(elastic, u));
            norms[1] = discrete.norm(&discrete.mass, u);
        }
        if physics.has_heat() {
            norms[2] = discrete.norm(&discrete.mass, theta);
        }
        norms
    }
}

/// Number of halvings after which a step whose error is so many times what it may be is expected to be good enough.
fn shorter_by(ratio: f64, order: i32) -> u32 {
    let halvings = ratio.log2() / f64::from(order + 1);
    (halvings.floor() as u32).max(1)
}
