//! Long work that Ctrl-C ends.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{channel, RecvTimeoutError};
use std::time::Duration;

use pyo3::prelude::*;

/// Time from one look for signals to the next.
const LOOK: Duration = Duration::from_millis(50);

/// Work on another thread, while this one looks for signals; what a signal's handler raises sets `stop`, for which the work looks.
pub fn with_signals<T: Send>(
    py: Python<'_>,
    stop: &AtomicBool,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let (done, raised) = py.detach(|| {
        let (say, waiting) = channel();
        std::thread::scope(|scope| {
            let work = scope.spawn(move || {
                let done = work();
                // Nobody waits any more only where this thread's parent has panicked.
                let _ = say.send(());
                done
            });
            let mut raised = None;
            while matches!(waiting.recv_timeout(LOOK), Err(RecvTimeoutError::Timeout)) {
                if let Err(error) = Python::attach(|py| py.check_signals()) {
                    stop.store(true, Ordering::Relaxed);
                    raised.get_or_insert(error);
                }
            }
            (work.join(), raised)
        })
    });
    // The work may have ended just before it was to be stopped.
    stop.store(false, Ordering::Relaxed);
    match raised {
        Some(error) => Err(error),
        None => Ok(done.unwrap_or_else(|panic| std::panic::resume_unwind(panic))),
    }
}
