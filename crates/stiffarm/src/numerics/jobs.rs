//! Independent jobs on all cores, with results that do not depend on them.

use crate::error::{Code, Error, Result};
use crate::numerics::control::Control;

/// Maps `jobs` on all cores, results in the order of the jobs.
pub(crate) fn in_order<J: Sync, T: Send>(
    jobs: &[J],
    run: impl Fn((usize, &J)) -> Result<T> + Sync + Send,
) -> Result<Vec<T>> {
    // The first error by order, whichever thread met one first.
    #[cfg(feature = "parallel")]
    let results: Vec<Result<T>> = {
        use rayon::prelude::*;
        jobs.par_iter().enumerate().map(run).collect()
    };
    #[cfg(not(feature = "parallel"))]
    let results: Vec<Result<T>> = jobs.iter().enumerate().map(run).collect();
    results.into_iter().collect()
}

/// Jobs between two looks at progress and Ctrl-C.
const PORTION: usize = 2048;

/// The same with progress, which can be stopped.
///
/// # Errors
/// The first error by order; stopped.
pub(crate) fn in_order_watched<J: Sync, T: Send>(
    jobs: &[J],
    what: &str,
    control: Control<'_>,
    run: impl Fn((usize, &J)) -> Result<T> + Sync + Send,
) -> Result<Vec<T>> {
    let mut out = Vec::with_capacity(jobs.len());
    for portion in jobs.chunks(PORTION) {
        if control.stopped() {
            return Err(Error::new(Code::Interrupted, "Interrupted."));
        }
        let start = out.len();
        out.extend(in_order(portion, |(i, job)| run((start + i, job)))?);
        control.report(what, out.len(), jobs.len());
    }
    Ok(out)
}
