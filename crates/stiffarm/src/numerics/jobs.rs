//! Independent jobs on all cores, with results that do not depend on them.

use crate::error::{Code, Result};
use crate::numerics::control::Control;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Maps `jobs` on all cores, results in the order of the jobs.
pub fn in_order<J: Sync, T: Send>(jobs: &[J], run: impl Fn((usize, &J)) -> Result<T> + Sync + Send) -> Result<Vec<T>> {
    let results: Vec<_> = jobs.iter().map(|_| Mutex::new(None)).collect();
    on_all_cores(jobs.len(), &|i| {
        let result = run((i, &jobs[i]));
        *results[i].lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
    });
    // The first error by order, whichever thread met one first.
    let results = results.into_iter().map(Mutex::into_inner);
    results.filter_map(|result| result.unwrap_or_else(PoisonError::into_inner)).collect()
}

/// Runs `jobs`, each handed over whole, on all cores; one alone where it is, for waking a thread takes longer than a
/// small job.
///
/// # Errors
/// The first error by order.
pub fn each<J: Send>(jobs: Vec<J>, run: impl Fn(J) -> Result<()> + Sync + Send) -> Result<()> {
    if jobs.len() < 2 {
        return jobs.into_iter().try_for_each(run);
    }
    let jobs: Vec<_> = jobs.into_iter().map(|job| Mutex::new(Some(job))).collect();
    let take = |job: &Mutex<Option<J>>| job.lock().unwrap_or_else(PoisonError::into_inner).take();
    in_order(&jobs, |(_, job)| take(job).map_or(Ok(()), &run)).map(drop)
}

/// One function for all kinds of jobs: compiled anew for each, what distributes them was a twentieth of the library.
fn on_all_cores(count: usize, run: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(run);
}

/// Jobs whose results are held twice for a moment, and jobs between two reports.
const PORTION: usize = 2048;
const REPORTED: usize = 64;
/// Small jobs that are done one after the other in the same memory.
const BLOCK: usize = 64;

/// The same with progress, which can be stopped between any two jobs.
///
/// # Errors
/// The first error by order; stopped.
pub fn in_order_watched<J: Sync, T: Send>(
    jobs: &[J],
    what: &str,
    control: Control<'_>,
    run: impl Fn((usize, &J)) -> Result<T> + Sync + Send,
) -> Result<Vec<T>> {
    watched(jobs, what, control, |job| {
        control.check()?;
        run(job)
    })
}

/// The same, with what was done before it was stopped: `None` for the rest. What
/// was done lies spread over the jobs.
///
/// # Errors
/// The first error of what was done.
pub fn as_far_as<J: Sync, T: Send>(
    jobs: &[J],
    what: &str,
    control: Control<'_>,
    run: impl Fn((usize, &J)) -> Result<T> + Sync + Send,
) -> Result<Vec<Option<T>>> {
    let order = spread(jobs.len());
    let outcomes = watched(&order, what, control, |(_, &i)| {
        if control.stopped() {
            return Ok(None);
        }
        match run((i, &jobs[i])) {
            // Stopped in the middle of the job.
            Err(error) if error.code() == Code::Interrupted => Ok(None),
            outcome => outcome.map(Some),
        }
    })?;
    let mut out: Vec<Option<T>> = jobs.iter().map(|_| None).collect();
    for (i, result) in order.into_iter().zip(outcomes) {
        out[i] = result;
    }
    Ok(out)
}

/// The numbers below `count`: the first, then those halfway between, again and again.
pub fn spread(count: usize) -> Vec<usize> {
    let mut step = count.next_power_of_two();
    let mut order: Vec<usize> = (0..count).step_by(step).collect();
    while step > 1 {
        order.extend((step / 2..count).step_by(step));
        step /= 2;
    }
    order
}

fn watched<J: Sync, T: Send>(
    jobs: &[J],
    what: &str,
    control: Control<'_>,
    run: impl Fn((usize, &J)) -> Result<T> + Sync + Send,
) -> Result<Vec<T>> {
    let mut out = Vec::with_capacity(jobs.len());
    each_portion(jobs, what, control, run, |result| out.push(result))?;
    Ok(out)
}

/// [`in_order_watched`] whose results are handed to `take`, in the order of the
/// jobs, so that they need not all be kept.
///
/// # Errors
/// As [`in_order_watched`].
pub fn each_in_order<J: Sync, T: Send>(
    jobs: &[J],
    what: &str,
    control: Control<'_>,
    run: impl Fn((usize, &J)) -> Result<T> + Sync + Send,
    take: impl FnMut(T),
) -> Result<()> {
    let watched = |job: (usize, &J)| {
        control.check()?;
        run(job)
    };
    each_portion(jobs, what, control, watched, take)
}

/// [`in_order_watched`] for jobs that are smaller than what it takes to distribute them: `run` has the number of the
/// first job of a block and the block, and gives as many results.
///
/// # Errors
/// As [`in_order_watched`].
pub fn in_blocks<J: Sync, T: Send>(
    jobs: &[J],
    what: &str,
    control: Control<'_>,
    run: impl Fn(usize, &[J]) -> Result<Vec<T>> + Sync + Send,
) -> Result<Vec<T>> {
    let mut out = Vec::with_capacity(jobs.len());
    each_block(jobs, what, control, run, |part| out.extend(part))?;
    Ok(out)
}

/// The same whose results are handed to `take`, block by block in their order.
///
/// # Errors
/// As [`in_order_watched`].
pub fn each_block<J: Sync, T: Send>(
    jobs: &[J],
    what: &str,
    control: Control<'_>,
    run: impl Fn(usize, &[J]) -> Result<T> + Sync + Send,
    take: impl FnMut(T),
) -> Result<()> {
    let blocks: Vec<&[J]> = jobs.chunks(BLOCK).collect();
    each_in_order(&blocks, what, control, |(b, block)| run(b * BLOCK, block), take)
}

fn each_portion<J: Sync, T: Send>(
    jobs: &[J],
    what: &str,
    control: Control<'_>,
    run: impl Fn((usize, &J)) -> Result<T> + Sync + Send,
    mut take: impl FnMut(T),
) -> Result<()> {
    let done = AtomicUsize::new(0);
    let mut start = 0;
    for portion in jobs.chunks(PORTION) {
        let results = in_order(portion, |(i, job)| {
            let result = run((start + i, job))?;
            let so_far = done.fetch_add(1, Ordering::Relaxed) + 1;
            if so_far.is_multiple_of(REPORTED) || so_far == jobs.len() {
                control.report(what, so_far, jobs.len());
            }
            Ok(result)
        })?;
        results.into_iter().for_each(&mut take);
        start += portion.len();
    }
    Ok(())
}
