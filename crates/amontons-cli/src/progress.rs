//! The progress bar of a run.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use amontons::output::{OutputError, RunStart, Sink, Snapshot, Summary};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// How long a run takes before it gets a bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// A bar on standard error for runs that take longer than a moment.
pub struct Progress {
    begin: Instant,
    first: u64,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// A bar, if standard error is a terminal.
    pub fn on_terminal() -> Option<Progress> {
        std::io::stderr().is_terminal().then(|| Progress { begin: Instant::now(), first: 0, bar: None })
    }
}

impl Sink for Progress {
    fn start(&mut self, start: &RunStart) -> Result<(), OutputError> {
        self.first = start.from.state.step as u64;
        Ok(())
    }

    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        if self.bar.is_none() && self.begin.elapsed() > PATIENCE {
            let bar = ProgressBar::with_draw_target(Some(now.problem.steps as u64), ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("step {pos}/{len} [{bar:40}] {elapsed} gone, {eta} left") {
                bar.set_style(style);
            }
            self.bar = Some(bar.with_elapsed(self.begin.elapsed()));
        }
        if let Some(bar) = &self.bar {
            bar.set_position(now.state.step as u64);
        }
        Ok(())
    }

    fn last(&mut self, _last: &Snapshot) -> Result<(), OutputError> {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        Ok(())
    }

    fn finish(&mut self, _summary: &Summary) -> Result<(), OutputError> {
        Ok(())
    }
}
