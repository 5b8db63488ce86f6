//! Independent jobs on all cores, with results that do not depend on them.

use crate::error::Result;

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
