//! Long work: without the interpreter's lock, with its signals, telling how far it is.

use numpy::PyArray1;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use stiffarm::plan::select::Accept;
use stiffarm::{Code, Control, Error, Result, Watch};

use crate::cores::on_cores;
use crate::error::Raised;

/// How long Python's signals and the progress wait.
const TICK: Duration = Duration::from_millis(50);

/// What was told last: what is done, how much, of how much.
type Step = (String, usize, usize);

/// Between the work and the thread of the interpreter.
#[derive(Default)]
struct Shared {
    stop: AtomicBool,
    latest: Mutex<Option<Step>>,
    /// What a function of the caller raised.
    failure: Mutex<Option<PyErr>>,
}

impl Shared {
    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn report(&self, what: &str, done: usize, of: usize) {
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        *latest = Some((what.to_string(), done, of));
    }

    fn fail(&self, error: PyErr) {
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        failure.get_or_insert(error);
        self.stop.store(true, Ordering::Relaxed);
    }

    fn take(&self) -> Option<Step> {
        self.latest.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// What the work is given to be watched and stopped.
pub struct Watched(Arc<Shared>);

impl Watched {
    /// For a value whose later questions can take long.
    pub fn shared(&self) -> Watch {
        let (stop, report) = (Arc::clone(&self.0), Arc::clone(&self.0));
        Watch::new(move || stop.stopped(), move |what, done, of| report.report(what, done, of))
    }

    /// A function of the caller that says of angles \[rad\] whether they may be chosen; what it raises stops the work.
    pub fn accept(&self, function: Py<PyAny>) -> Accept {
        let shared = Arc::clone(&self.0);
        Accept::new(move |q| {
            if shared.stopped() {
                return false;
            }
            let said = Python::attach(|py| {
                let angles = PyArray1::from_slice(py, q);
                function.bind(py).call1((angles,))?.is_truthy()
            });
            said.unwrap_or_else(|error| {
                shared.fail(error);
                false
            })
        })
    }

    /// Runs `work` with what it borrows.
    pub fn with<T>(&self, work: impl FnOnce(Control<'_>) -> T) -> T {
        let stop = || self.0.stopped();
        let report = |what: &str, done: usize, of: usize| self.0.report(what, done, of);
        work(Control { stop: Some(&stop), progress: Some(&report) })
    }
}

/// The result of `work`, done in a thread of its own, and whether Ctrl-C stopped it. `progress`
/// is called as `progress(what, done, of)` in the caller's thread, some twenty times a second at most.
///
/// # Errors
/// What the work fails with; `KeyboardInterrupt` where it was stopped without a result; what
/// `progress` raises.
pub fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watched) -> Result<T> + Send,
) -> PyResult<(T, bool)> {
    let shared = Arc::new(Shared::default());
    let mut interrupted = false;
    let result = std::thread::scope(|scope| {
        let (done, finished) = sync_channel::<()>(1);
        let worker = {
            let watched = Watched(Arc::clone(&shared));
            scope.spawn(move || {
                let result = on_cores(|| work(&watched));
                drop(done);
                result
            })
        };
        // The channel is only waited on: it closes when the work ends, also by a panic.
        let finished = Mutex::new(finished);
        let wait = || {
            let finished = finished.lock().unwrap_or_else(PoisonError::into_inner);
            finished.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout)
        };
        while py.detach(wait) {
            if py.check_signals().is_err() {
                interrupted = true;
                shared.stop.store(true, Ordering::Relaxed);
            }
            if let (Some(progress), Some(latest)) = (progress, shared.take())
                && !shared.stopped()
                && let Err(error) = progress.call1(latest)
            {
                shared.fail(error);
            }
        }
        worker.join()
    });
    let mut failure = shared.failure.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(error) = failure.take() {
        return Err(error);
    }
    let fault = |_| Error::new(Code::Internal, "A fault of the library itself stopped this call.");
    let result = result.map_err(fault).raised(py)?.raised(py)?;
    Ok((result, interrupted))
}
