//! Runs with chosen steps: derivatives are those of a run with the steps that were chosen, which do not change with the
//! data. A chosen step counts as its two halves.

use super::error::GradientError;
use super::parameter::Parameter;
use crate::discretization::Discretization;
use crate::problem::{Fault, Problem};
use crate::step::{March, Scheme};
use crate::time::MadeSteps;

/// The steps that a run of the problem chooses; `None` if it chooses none. `go_on` is asked before each of them.
pub(crate) fn made_steps(problem: &Problem, go_on: &dyn Fn() -> bool) -> Result<Option<MadeSteps>, GradientError> {
    if !problem.timeline.is_automatic() {
        return Ok(None);
    }
    let first = problem.in_phase(0);
    let mut march = March::on(&first, &std::sync::Arc::new(Discretization::new(&first)), &first.backend)?;
    let (mut state, mut made) = (march.initial()?, MadeSteps::default());
    while !state.is_last(&problem.timeline) {
        if !go_on() {
            return Err(GradientError::Interrupted);
        }
        let (next, _) = march.step(&state)?;
        made.note(&state.pace, &next.pace);
        state = next;
    }
    Ok(Some(made))
}

/// The problem with steps that a run has chosen.
pub(crate) fn with_steps(problem: &Problem, made: &MadeSteps) -> Problem {
    problem.with_timeline(problem.timeline.with_made(made))
}

impl Parameter<'_> {
    /// The parameter of a problem with the steps that its run has chosen.
    pub(super) fn with_steps<'a>(&'a self, of: &'a Problem, made: &'a MadeSteps) -> Parameter<'a> {
        let problem = move |value: f64| {
            let problem = (self.problem)(value)?;
            let accuracies = |of: &Problem| -> Vec<Option<u64>> {
                of.timeline.phases().map(|phase| phase.steps.accuracy().map(f64::to_bits)).collect()
            };
            if accuracies(&problem) != accuracies(of) {
                let found = "a key that changes how steps are chosen";
                let fault = Fault::new(self.name.clone(), found, "a key of the steps that were chosen");
                return Err(fault.hint("leave it out of the parameters"));
            }
            Ok(with_steps(&problem, made))
        };
        Parameter { name: self.name.clone(), value: self.value, problem: Box::new(problem) }
    }
}
