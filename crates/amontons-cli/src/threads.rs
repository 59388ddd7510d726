//! The threads of a command.

use amontons::run::{RunError, most_threads};

use crate::status::CommandFailure;

/// Stack of a thread.
const STACK: usize = 8 << 20;

/// Executes the work of a command in a pool with this many threads, by default one per core.
pub fn within<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> Result<T, CommandFailure> + Send,
) -> Result<T, CommandFailure> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let most = most_threads();
    if let Some(threads) = threads.filter(|threads| *threads > most) {
        return Err(CommandFailure::Usage(format!(
            "--threads {threads}: expected at most {most} on this machine with {cores} cores"
        )));
    }
    let mut pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).stack_size(STACK);
    if threads == Some(1) {
        // No additional thread is started.
        pool = pool.use_current_thread();
    }
    let pool = pool.build().map_err(|error| CommandFailure::Run {
        error: RunError::Threads { threads: threads.unwrap_or(cores), message: error.to_string() },
        hint: None,
    })?;
    pool.install(work)
}
