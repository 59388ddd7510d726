//! The processes that execute a command together, if there are several: all make the same computations, and the first
//! one alone writes files.

use std::fmt::Debug;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use amontons::case::Source;
use amontons::linalg::Backend;
use amontons::output::{OutputError, RunStart, Sink, Snapshot, Summary};

/// Several processes that execute the same command. All calls but that of [`Processes::is_first`] are made by all of
/// them, in the same order.
pub trait Processes: Debug + Send + Sync {
    /// True for the process that writes files.
    fn is_first(&self) -> bool;
    /// The backend with which they solve together.
    fn backend(self: Arc<Self>) -> Arc<dyn Backend>;
    /// A flag that is set in all processes at the same place of the program once any of them is asked to end.
    fn agreed(&self, asked: &Arc<AtomicBool>) -> Arc<AtomicBool>;
    /// The value that the first process passes.
    fn share(&self, of_first: u8) -> u8;
}

/// The processes of a command; by default this one alone.
#[derive(Clone, Debug, Default)]
pub struct Team(Option<Arc<dyn Processes>>);

impl Team {
    /// Several processes.
    #[must_use]
    pub fn of(processes: Arc<dyn Processes>) -> Team {
        Team(Some(processes))
    }

    /// True if this process writes files.
    pub fn is_first(&self) -> bool {
        self.0.as_ref().is_none_or(|processes| processes.is_first())
    }

    /// A case whose systems all processes solve together.
    pub fn source(&self, source: Source) -> Source {
        match &self.0 {
            Some(processes) => source.solved_by(Arc::clone(processes).backend()),
            None => source,
        }
    }

    /// The flag that ends a run, from the flag that this process is asked to end by.
    pub fn interrupt(&self, asked: &Arc<AtomicBool>) -> Arc<AtomicBool> {
        self.0.as_ref().map_or_else(|| Arc::clone(asked), |processes| processes.agreed(asked))
    }

    /// The exit code that the first process passes, or that of this one alone.
    pub fn share(&self, of_first: u8) -> u8 {
        self.0.as_ref().map_or(of_first, |processes| processes.share(of_first))
    }

    /// True if several processes execute the command.
    pub fn is_several(&self) -> bool {
        self.0.is_some()
    }

    /// Waits for all processes, so that what the first one writes afterwards is not read by the others before.
    pub fn wait(&self) {
        self.0.iter().for_each(|processes| {
            processes.share(0);
        });
    }
}

/// A sink of the first process, whose failure ends the run in all of them.
pub struct OfFirst<'a> {
    pub team: &'a Team,
    /// The sink; `None` in the others.
    pub sink: Option<&'a mut dyn Sink>,
}

impl OfFirst<'_> {
    fn all(&mut self, of: impl FnOnce(&mut dyn Sink) -> Result<(), OutputError>) -> Result<(), OutputError> {
        let made = match &mut self.sink {
            Some(sink) => of(&mut **sink),
            None => Ok(()),
        };
        let Some(processes) = &self.team.0 else { return made };
        let has_failed = processes.share(u8::from(made.is_err())) != 0;
        match made {
            Ok(()) if has_failed => Err(OutputError::Elsewhere),
            made => made,
        }
    }
}

impl Sink for OfFirst<'_> {
    fn start(&mut self, start: &RunStart) -> Result<(), OutputError> {
        self.all(|sink| sink.start(start))
    }
    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        self.all(|sink| sink.step(now))
    }
    fn last(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        self.all(|sink| sink.last(last))
    }
    fn interrupted(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        self.all(|sink| sink.interrupted(last))
    }
    fn finish(&mut self, summary: &Summary) -> Result<(), OutputError> {
        self.all(|sink| sink.finish(summary))
    }
}
