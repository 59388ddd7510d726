//! The processes that execute a command together, if there are several: all make the same computations, and the first
//! one alone writes files.

use std::fmt::Debug;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use amontons::case::Source;
use amontons::linalg::Backend;
use amontons::output::{OutputError, RunStart, Sink, Snapshot, Summary};

use crate::arguments::Command;
use crate::status::CommandFailure;

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

    /// What the first process makes; `None` in the others, which wait until it has succeeded.
    ///
    /// # Errors
    /// That of the first process, and [`CommandFailure::Elsewhere`] in the others.
    pub fn first<T, E: Into<CommandFailure>>(
        &self,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<Option<T>, CommandFailure> {
        let made = self.is_first().then(make).transpose().map_err(Into::into);
        let Some(processes) = &self.0 else { return made };
        let code = processes.share(made.as_ref().err().map_or(0, CommandFailure::code));
        match made {
            Ok(None) if code != 0 => Err(CommandFailure::Elsewhere(code)),
            made => made,
        }
    }

    /// Waits for all processes, so that what the first one writes afterwards is not read by the others before.
    pub fn wait(&self) {
        self.0.iter().for_each(|processes| {
            processes.share(0);
        });
    }

    /// Refuses commands that several processes cannot execute together.
    ///
    /// # Errors
    /// [`CommandFailure::Usage`] if the command is such.
    pub fn allows(&self, command: &Command) -> Result<(), CommandFailure> {
        let works = match command {
            Command::Run { each, .. } => each.is_empty(),
            Command::Resume { .. } | Command::Verify { .. } | Command::Gradient { .. } => true,
            _ => false,
        };
        if self.0.is_none() || works {
            return Ok(());
        }
        let known = "run without --each, resume, verify and gradient";
        Err(CommandFailure::Usage(format!("several processes execute {known}; use the program amontons for the rest")))
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
