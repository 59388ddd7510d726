//! Results kept in memory.

use super::{OutputError, RunStart, Sink, Snapshot, Summary};
use crate::state::{State, StepReport};

/// Keeps the requested states and reports, and in any case the summary and the last state.
#[derive(Debug, Default)]
pub struct Memory {
    every: usize,
    with_reports: bool,
    /// The requested states, including the first and the last, by ascending step.
    pub states: Vec<State>,
    /// The requested reports, one per step.
    pub reports: Vec<StepReport>,
    /// The summary after the end of the run.
    pub summary: Option<Summary>,
}

impl Memory {
    /// A sink that keeps the last state and the summary.
    #[must_use]
    pub fn new() -> Memory {
        Memory::default()
    }

    /// Keeps the state of every `n`-th step, including the start; 0 for the last only.
    #[must_use]
    pub fn states_every(mut self, n: usize) -> Memory {
        self.every = n;
        self
    }

    /// Keeps the report of every step.
    #[must_use]
    pub fn reports(mut self) -> Memory {
        self.with_reports = true;
        self
    }

    fn wants(&self, step: usize) -> bool {
        self.every > 0 && step.is_multiple_of(self.every)
    }
}

impl Sink for Memory {
    fn start(&mut self, start: &RunStart) -> Result<(), OutputError> {
        if self.wants(start.from.state.step) {
            self.states.push(start.from.state.clone());
        }
        Ok(())
    }

    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        if self.wants(now.state.step) {
            self.states.push(now.state.clone());
        }
        if let Some(report) = now.report.filter(|_| self.with_reports) {
            self.reports.push(report.clone());
        }
        Ok(())
    }

    fn last(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        if self.states.last().is_none_or(|state| state.step != last.state.step) {
            self.states.push(last.state.clone());
        }
        Ok(())
    }

    fn finish(&mut self, summary: &Summary) -> Result<(), OutputError> {
        self.summary = Some(summary.clone());
        Ok(())
    }
}
