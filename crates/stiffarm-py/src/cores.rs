//! Work on all cores, also in a process that was forked: there the threads of the process before are gone, and whoever
//! waits for them waits for ever.

use crate::error::Raised;
use pyo3::prelude::*;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use stiffarm::{Code, Error};

/// The process that loaded the module.
static HOME: OnceLock<u32> = OnceLock::new();

/// Threads asked for; 0 for one per core.
static THREADS: AtomicUsize = AtomicUsize::new(0);

/// Remembers the process whose threads are there.
pub fn begin() {
    HOME.get_or_init(std::process::id);
}

fn is_forked() -> bool {
    HOME.get().is_some_and(|home| *home != std::process::id())
}

/// Runs `work` where its parallel parts find threads.
pub fn on_cores<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    if !is_forked() {
        return work();
    }
    let threads = THREADS.load(Ordering::Relaxed);
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(work),
        // Without new threads there is nothing better than to try.
        Err(_) => work(),
    }
}

/// Limits the work to so many threads; before the first call that uses several.
#[pyfunction]
pub fn set_threads(py: Python<'_>, threads: usize) -> PyResult<()> {
    if !is_forked() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build_global()
            .map_err(|_| {
                Error::new(Code::Conflict, "The threads of this process are chosen already.")
                    .hint("set them before the first call, or by the environment variable RAYON_NUM_THREADS")
            })
            .raised(py)?;
    }
    THREADS.store(threads, Ordering::Relaxed);
    Ok(())
}
