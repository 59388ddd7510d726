//! The steps that a run with automatic ones made.

use super::pace::Pace;
use super::phase::DEEPEST;

/// The steps that a run with automatic ones made, to make them again: with other data, too.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MadeSteps {
    /// The places of the ends of steps per phase, in 2^−33 of it; empty for phases with equal steps.
    ends: Vec<Vec<u64>>,
}

impl MadeSteps {
    /// Notes the step from one place to another. A chosen step is two halves, which stand, but for one of which nothing
    /// is judged.
    pub fn note(&mut self, from: &Pace, to: &Pace) {
        let phase = from.ends.len();
        self.ends.resize(self.ends.len().max(phase + 1), Vec::new());
        if to.chosen.made == from.chosen.made {
            return;
        }
        let end = if to.ends.len() > phase { 1 << DEEPEST } else { to.at };
        let halves = (from.at + end, 2 * end);
        let is_whole = to.chosen.unjudged > from.chosen.unjudged;
        let ends = &mut self.ends[phase];
        ends.extend(Some(halves.0).filter(|_| !is_whole));
        ends.push(halves.1);
    }

    /// The places of a phase with chosen steps.
    #[must_use]
    pub fn of_phase(&self, phase: usize) -> Option<&[u64]> {
        self.ends.get(phase).map(Vec::as_slice).filter(|ends| !ends.is_empty())
    }
}
