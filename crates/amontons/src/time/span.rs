//! A phase in its run: its times, and the lengths of its steps.

use super::instant::Instant;
use super::phase::{DEEPEST, Steps, TimePhase};

/// A phase in its run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PhaseSpan {
    pub phase: TimePhase,
    /// Time at its start, s, and number of steps before.
    pub start: f64,
    pub first: usize,
    /// Length of its steps, s.
    pub k: f64,
}

/// Number of places of a phase at which a step that was made may end.
const PLACES: u64 = 1 << (DEEPEST + 1);

/// The place of the end of a step of a phase; 0 of the one before the first.
fn place(ends: &[u64], made: usize) -> u64 {
    made.checked_sub(1).and_then(|last| ends.get(last)).copied().unwrap_or(if made == 0 { 0 } else { PLACES })
}

impl PhaseSpan {
    pub fn time(&self, n: usize) -> f64 {
        let made = n.saturating_sub(self.first);
        let share = match &self.phase.steps {
            Steps::Made(ends) => place(ends, made) as f64 / PLACES as f64,
            Steps::Equal(_) | Steps::Automatic { .. } => made as f64 / self.steps() as f64,
        };
        // The end is hit to the last bit.
        if n == self.last() { self.phase.end } else { self.start + self.length() * share }
    }

    pub fn length(&self) -> f64 {
        self.phase.end - self.start
    }

    pub fn steps(&self) -> usize {
        self.phase.steps.nominal()
    }

    /// The number of the last step.
    pub fn last(&self) -> usize {
        self.first + self.steps()
    }

    pub fn is_automatic(&self) -> bool {
        self.phase.steps.accuracy().is_some()
    }

    pub fn is_equal(&self) -> bool {
        matches!(self.phase.steps, Steps::Equal(_))
    }

    /// Time at a place of an automatic phase, s; the end to the last bit.
    pub fn time_at(&self, at: u64) -> f64 {
        if at >= 1 << DEEPEST {
            self.phase.end
        } else {
            self.start + self.length() * (at as f64 / (1u64 << DEEPEST) as f64)
        }
    }

    /// Time at the end over the number of steps, whose round-off is that of the step length.
    pub fn mean(&self) -> f64 {
        self.phase.end / self.steps() as f64
    }

    /// Length of step n, s.
    pub fn k_of(&self, n: usize) -> f64 {
        let Steps::Made(ends) = &self.phase.steps else { return self.k };
        let made = n.saturating_sub(self.first).max(1);
        self.length() * ((place(ends, made) - place(ends, made - 1)) as f64 / PLACES as f64)
    }

    /// The lengths of all steps, s; of equal ones that of one of them.
    pub fn lengths(&self) -> Vec<f64> {
        let last = if matches!(self.phase.steps, Steps::Made(_)) { self.last() } else { self.first + 1 };
        (self.first + 1..=last).map(|n| self.k_of(n)).collect()
    }

    pub fn instant(&self, n: usize, phase: usize) -> Instant {
        Instant { n, t: self.time(n), k: self.k_of(n), phase, analysis: self.phase.analysis }
    }
}
