//! Work in Rust while Python waits: without the lock of the interpreter, and with its signals answered.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Time between two checks for signals.
const PATIENCE: Duration = Duration::from_millis(50);

/// A task for the Python thread. The work waits until it is dropped.
pub type Errand = Box<dyn FnOnce(Python<'_>) -> PyResult<()> + Send>;

/// Sender of tasks from the work to the Python thread.
#[derive(Clone)]
pub struct Desk(Sender<(Errand, Sender<()>)>);

impl Desk {
    /// Sends a task to the Python thread and waits until it is done.
    pub fn send(&self, errand: Errand) {
        let (done, wait) = channel();
        if self.0.send((errand, done)).is_ok() {
            // The other end is dropped if the task is not done.
            let _ = wait.recv();
        }
    }
}

/// Does the work on a separate thread. Meanwhile this thread runs tasks and answers signals. An exception of either
/// sets the flag, which ends the work, and is returned with the result of the work.
pub fn attend<T: Send>(
    py: Python<'_>,
    flag: &AtomicBool,
    work: impl FnOnce(&Desk) -> T + Send,
) -> PyResult<(T, Option<PyErr>)> {
    py.detach(|| {
        let (sender, receiver) = channel();
        thread::scope(|scope| {
            let worker = scope.spawn(move || work(&Desk(sender)));
            let raised = serve(&receiver, flag);
            worker.join().map(|made| (made, raised))
        })
    })
    .map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        PyRuntimeError::new_err(format!("a defect of amontons: {}", text.unwrap_or("the work ended early")))
    })
}

/// Runs tasks until the work is over.
fn serve(receiver: &Receiver<(Errand, Sender<()>)>, flag: &AtomicBool) -> Option<PyErr> {
    let mut raised = None;
    loop {
        let done = match receiver.recv_timeout(PATIENCE) {
            Ok((errand, _done)) if raised.is_none() => {
                Python::attach(|py| errand(py).and_then(|()| py.check_signals()))
            }
            Ok(_) => Ok(()),
            Err(RecvTimeoutError::Timeout) => Python::attach(|py| py.check_signals()),
            Err(RecvTimeoutError::Disconnected) => return raised,
        };
        if let Err(error) = done {
            raised.get_or_insert(error);
            flag.store(true, Ordering::Relaxed);
        }
    }
}
