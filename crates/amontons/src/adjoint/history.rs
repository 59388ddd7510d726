//! The states of a run, for the sweep from its end to its start.

use std::borrow::Cow;

use super::error::GradientError;
use super::instance::{PhaseStart, PhasedInstance};
use crate::contact::Flux;
use crate::inclusion::PointState;
use crate::problem::Fault;
use crate::state::{State, StepReport};
use crate::step::{March, Scheme};

/// A state with the contact points and their heat fluxes in the step that led to it.
#[derive(Clone)]
pub(super) struct KeptStep {
    pub state: State,
    pub states: Vec<PointState>,
    pub flux: Vec<Flux>,
}

/// The states of a run. If they do not fit into the memory that is granted, every m-th one is kept, m about the root of
/// the number of steps, and those between two of them are made again.
pub(super) struct RunHistory {
    march: March,
    every: usize,
    /// The states 0, m, 2m, ….
    kept: Vec<KeptStep>,
    /// The states from `first` on, up to the next kept one.
    segment: Vec<KeptStep>,
    first: usize,
    /// Report of the last step.
    pub report: StepReport,
    pub steps: usize,
}

impl RunHistory {
    /// Makes the run; `granted` is the memory for its states in bytes, and `go_on` is asked before each step.
    pub fn new(base: &PhasedInstance, granted: usize, go_on: &dyn Fn() -> bool) -> Result<RunHistory, GradientError> {
        let (problem, discrete) = (&base.first.problem, &base.first.discrete);
        let mut march = March::on(problem, discrete, &problem.backend)?;
        let steps = problem.timeline.steps();
        let start = march.initial()?;
        let numbers = 2 * start.u.len() + start.theta.len() + 32 * discrete.boundary.points.len();
        let every = if numbers * size_of::<f64>() * steps <= granted { 1 } else { steps.isqrt().max(1) };
        let mut kept = vec![KeptStep { state: start, states: Vec::new(), flux: Vec::new() }];
        let mut now = kept.last().map(|kept| kept.state.clone());
        let mut last = None;
        while let Some(state) = now.take().filter(|state| !state.is_last(&problem.timeline)) {
            if !go_on() {
                return Err(GradientError::Interrupted);
            }
            let (state, report) = made(&mut march, &state)?;
            if state.step % every == 0 {
                kept.push(KeptStep::of(&state, &report));
            }
            (now, last) = (Some(state), Some(report));
        }
        let Some(report) = last else {
            let fault = Fault::new("time.steps", "no step", "a positive number of steps");
            return Err(GradientError::refused(fault));
        };
        Ok(RunHistory { march, every, kept, segment: Vec::new(), first: steps + 1, report, steps })
    }

    /// The states n − 1 and n.
    pub fn around(&mut self, n: usize) -> Result<[&KeptStep; 2], GradientError> {
        if self.every == 1 {
            return self.kept.get(n - 1).zip(self.kept.get(n)).map(|(a, b)| [a, b]).ok_or(GradientError::Interrupted);
        }
        let first = (n - 1) / self.every * self.every;
        if first != self.first {
            let start = self.kept.get(first / self.every).cloned().ok_or(GradientError::Interrupted)?;
            self.segment = vec![start];
            while self.first != first && self.segment.len() <= self.every.min(self.steps - first) {
                let Some(from) = self.segment.last() else { break };
                let (state, report) = made(&mut self.march, &from.state)?;
                self.segment.push(KeptStep::of(&state, &report));
            }
            self.first = first;
        }
        let at = n - first;
        self.segment.get(at - 1).zip(self.segment.get(at)).map(|(a, b)| [a, b]).ok_or(GradientError::Interrupted)
    }
}

impl KeptStep {
    pub fn of(state: &State, report: &StepReport) -> KeptStep {
        KeptStep { state: state.clone(), states: report.contact.states.clone(), flux: report.contact.flux.clone() }
    }
}

/// Steps from one that was made anew by backward Euler because it hit a rigid foundation.
const SETTLING: u32 = 2;

/// The state from which a step was made: at rest where a phase begins so, and without the one before it, if the step
/// started anew.
pub(super) fn started<'a>(old: &'a State, new: &State, start: PhaseStart) -> Cow<'a, State> {
    let has_other_length = old.earlier.as_ref().is_some_and(|earlier| earlier.k.to_bits() != start.k.to_bits());
    let is_anew = start.rests || start.changes || has_other_length || new.settling == SETTLING;
    if !is_anew {
        return Cow::Borrowed(old);
    }
    let mut state = State { earlier: None, ..old.clone() };
    if start.rests {
        state.w.fill(0.0);
    }
    Cow::Owned(state)
}

/// Makes a step, as a whole and with all motions determined.
pub(super) fn made(march: &mut March, state: &State) -> Result<(State, StepReport), GradientError> {
    let (state, report) = march.step(state)?;
    let place = format!("step {}", state.step);
    let fault = if report.parts > 1 {
        Some(
            Fault::new(place, "a step that was made in halves", "whole steps")
                .hint("use more steps, or a smaller accuracy"),
        )
    } else if !state.released.is_empty() {
        Some(Fault::new(place, "supports that give up their forces in a phase", "supports that end at once"))
    } else if !state.carried.rigid.is_empty() {
        Some(Fault::new(place, "a body that has moved far", "displacements of the size of the deformation"))
    } else if let Some(motion) = report.loose.first() {
        let expected = "motions that supports, contact or inertia determine";
        Some(Fault::new(place, motion.clone(), expected).hint("add a support or a density"))
    } else {
        None
    };
    fault.map_or(Ok((state, report)), |fault| Err(GradientError::refused(fault)))
}
