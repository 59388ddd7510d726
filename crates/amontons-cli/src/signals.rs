//! Signals: a run ends in order if the system asks for it, and limits of the system become errors with a message.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Exit code after a second signal, and after a signal without a handler.
#[cfg(not(unix))]
const KILLED: i32 = 130;

#[cfg(unix)]
mod system {
    use std::io;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};
    use signal_hook::flag;
    use signal_hook::iterator::Signals;

    /// Exit code after a second Ctrl-C or SIGTERM, and after running out of memory.
    const KILLED: i32 = 130;
    const NO_MEMORY: i32 = 4;

    /// Signals that end a run in order, and their names in messages.
    const ENDING: [(i32, &str); 6] = [
        (SIGINT, "Ctrl-C"),
        (SIGTERM, "SIGTERM"),
        (SIGHUP, "SIGHUP"),
        (SIGXCPU, "SIGXCPU, the limit of the CPU time"),
        (SIGUSR1, "SIGUSR1"),
        (SIGUSR2, "SIGUSR2"),
    ];

    pub fn prepare() -> io::Result<()> {
        // With a handler, a file that exceeds its size limit is an error of the write.
        flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)))?;
        // If memory runs out, the runtime prints a message and aborts: the program then has this exit code.
        flag::register_conditional_shutdown(SIGABRT, NO_MEMORY, Arc::new(AtomicBool::new(true)))?;
        Ok(())
    }

    pub fn interrupts(flag: &Arc<AtomicBool>, tell: impl Fn(&str) + Send + 'static) -> io::Result<()> {
        // The handler itself sets it, so that a second signal is answered while the first is still being reported.
        let asked = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            flag::register_conditional_shutdown(signal, KILLED, Arc::clone(&asked))?;
            flag::register(signal, Arc::clone(&asked))?;
        }
        let mut signals = Signals::new(ENDING.map(|(signal, _)| signal))?;
        let set = Arc::clone(flag);
        let telling = std::thread::Builder::new().spawn(move || {
            let first = signals.forever().next();
            // The message comes before the effect.
            if let Some((_, name)) = ENDING.iter().find(|(signal, _)| Some(*signal) == first) {
                tell(name);
            }
            set.store(true, Ordering::Relaxed);
        });
        if telling.is_err() {
            // Without a thread nothing is reported; the run ends all the same.
            for (signal, _) in ENDING {
                flag::register(signal, Arc::clone(flag))?;
            }
        }
        Ok(())
    }
}

/// Prepares the program for limits on files and memory.
pub fn prepare() {
    #[cfg(unix)]
    // Without a handler these limits end the program at once.
    let _ = system::prepare();
}

/// Sets a flag when the system or the user asks the program to end, and reports it by `tell`. A second Ctrl-C ends it
/// at once.
pub fn interrupts(flag: &Arc<AtomicBool>, tell: impl Fn(&str) + Send + 'static) {
    // Without a handler the program ends at once; checkpoints are written nevertheless.
    #[cfg(unix)]
    let _ = system::interrupts(flag, tell);
    #[cfg(not(unix))]
    {
        use std::sync::atomic::Ordering;
        let set = Arc::clone(flag);
        let _ = ctrlc::set_handler(move || {
            if set.swap(true, Ordering::Relaxed) {
                std::process::exit(KILLED);
            }
            tell("Ctrl-C");
        });
    }
}
