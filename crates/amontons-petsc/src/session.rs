//! The processes of a run: what they agree on, what the first one tells the others, and how they end together.

use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use amontons::linalg::{Backend, SolveError};
use amontons_cli::Processes;

use crate::Petsc;
use crate::sys::{self, Failure};

/// Exit code after a failure of PETSc or MPI, or of one process alone.
const FAILED: u8 = 3;
/// How long another process waits for the first one to say what has failed everywhere.
const PATIENCE: Duration = Duration::from_millis(500);

/// The collective calls, for the check that all processes make the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Sets up a matrix.
    Matrix = 1,
    /// Multiplies by a matrix.
    Product,
    /// Solves a system.
    Solve,
    /// Judges whether a matrix is definite.
    Definite,
    /// Goes on with an iteration.
    Iteration,
    /// Learns how something ended in the first process.
    Share,
    /// Has ended its command.
    End,
}

/// The processes that solve together. One program has one session.
#[derive(Debug)]
pub struct Session {
    rank: usize,
    size: usize,
    /// Flags by which processes ask for an end, and those that are set in all processes at the same place of the
    /// program.
    asked: Mutex<Vec<Arc<AtomicBool>>>,
    agreed: Mutex<Vec<Arc<AtomicBool>>>,
    /// Exit code of this process, or that of a failure as long as it has not ended.
    code: AtomicU8,
    /// Held during a collective call of the backend: the C part is used by one thread at a time.
    calls: Mutex<()>,
}

impl Session {
    /// Starts MPI and PETSc. All processes but the first are silent from here on.
    ///
    /// # Errors
    /// When MPI or PETSc cannot be started.
    pub fn start() -> Result<Arc<Session>, Failure> {
        let (rank, size) = sys::start()?;
        if rank > 0 {
            sys::mute();
        }
        let (asked, agreed, calls) = (Mutex::default(), Mutex::default(), Mutex::default());
        Ok(Arc::new(Session { rank, size, asked, agreed, code: AtomicU8::new(FAILED), calls }))
    }

    /// Number of this process, from 0.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Number of processes.
    #[must_use]
    pub fn size(&self) -> usize {
        self.size
    }

    /// Holds the C part for a call of this thread.
    pub(crate) fn hold(&self) -> MutexGuard<'_, ()> {
        self.calls.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Agrees that all processes make the same call with the same data, and whether they are asked to end.
    ///
    /// # Errors
    /// [`SolveError::Interrupted`] if one of them is.
    pub(crate) fn agree(&self, step: Step, data: u64) -> Result<(), SolveError> {
        if self.meets(step, data)? { Err(SolveError::Interrupted) } else { Ok(()) }
    }

    /// The same; true if one of the processes is asked to end.
    fn meets(&self, step: Step, data: u64) -> Result<bool, SolveError> {
        let is_asked = lock(&self.asked).iter().any(|flag| flag.load(Ordering::Relaxed));
        let code = step as u64;
        let mut values = [code, !code, data, !data, u64::from(is_asked)];
        self.given(sys::largest(&mut values))?;
        let [most, least, same, too, asked] = values;
        if most != !least {
            if most == Step::End as u64 {
                self.end_alone(step);
            }
            self.fail("the processes do not make the same calls: do they have the same program and files?", FAILED);
        }
        if same != !too && step != Step::End {
            self.fail(
                "the processes have different numbers: do they have the same program, files and processors?",
                FAILED,
            );
        }
        if asked > 0 {
            lock(&self.agreed).iter().for_each(|flag| flag.store(true, Ordering::Relaxed));
        }
        Ok(asked > 0)
    }

    /// The result of a call of PETSc or MPI. A failure ends all processes, if there are several: it may be that of one.
    pub(crate) fn given<T>(&self, result: Result<T, Failure>) -> Result<T, SolveError> {
        result.map_err(|Failure(message)| {
            if self.size > 1 {
                self.fail(&SolveError::Library { message: message.clone() }.to_string(), FAILED);
            }
            SolveError::Library { message }
        })
    }

    /// Ends all processes with one message, which may be empty.
    pub fn fail(&self, message: &str, code: u8) -> ! {
        if self.rank > 0 {
            // What fails everywhere is said by the first process.
            std::thread::sleep(PATIENCE);
        }
        sys::say(&format!("Error: {message}\n"));
        sys::abort(code)
    }

    /// Ends all processes because one has ended alone, with its message.
    fn end_alone(&self, step: Step) -> ! {
        if step != Step::End {
            // The one that has ended says why; that one alone knows its exit code.
            std::thread::sleep(4 * PATIENCE);
        } else if self.rank > 0 {
            sys::unmute();
        }
        sys::abort(self.code.load(Ordering::Relaxed).max(1))
    }

    /// Lets a panic of this process end the others, with its message first.
    pub fn end_together(self: &Arc<Session>) {
        let session = Arc::clone(self);
        std::panic::set_hook(Box::new(move |panic| {
            sys::say(&format!("Error: process {} failed: {panic}\n", session.rank));
            sys::abort(101);
        }));
    }

    /// Meets the other processes at the end of the command, and returns the largest of their exit codes.
    pub fn end(&self, code: u8) -> u8 {
        self.code.store(code, Ordering::Relaxed);
        let met = self.meets(Step::End, 0);
        let mut values = [u64::from(code)];
        let same = met.is_ok() && sys::largest(&mut values).is_ok();
        let _ = sys::finish();
        if same { values[0] as u8 } else { code }
    }
}

impl Processes for Session {
    fn is_first(&self) -> bool {
        self.rank == 0
    }

    fn backend(self: Arc<Self>) -> Arc<dyn Backend> {
        Arc::new(Petsc::new(&self))
    }

    fn agreed(&self, asked: &Arc<AtomicBool>) -> Arc<AtomicBool> {
        let flag = Arc::new(AtomicBool::new(false));
        lock(&self.asked).push(Arc::clone(asked));
        lock(&self.agreed).push(Arc::clone(&flag));
        flag
    }

    fn share(&self, of_first: u8) -> u8 {
        let mut bytes = [of_first];
        // A failure ends all processes.
        let shared = self.meets(Step::Share, 0).and_then(|_| self.given(sys::share(&mut bytes)));
        if shared.is_ok() { bytes[0] } else { FAILED }
    }
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A number for the bits of some vectors: different bits have different numbers, but for chance.
pub(crate) fn mark(vectors: &[&[f64]]) -> u64 {
    let mix = |mark: u64, value: &f64| (mark ^ value.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    vectors.iter().flat_map(|vector| vector.iter()).fold(0x2545_f491_4f6c_dd1d, mix)
}
