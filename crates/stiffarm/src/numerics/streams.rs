//! Random numbers by stream: each run and each random group has its own, so
//! that neither threads nor the number of runs change anything.
//!
//! Randomness by stream. Run r of group g at level l draws from its own ChaCha
//! stream, so threads and the number of runs change nothing.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Marks the streams of random initial groups, which no run shares.
const GROUPS: u64 = 1 << 63;
/// Marks those of the chains of a global selection, and of its candidates.
const CHAINS: u64 = 3 << 61;
const CANDIDATES: u64 = 7 << 61;
/// Marks those of the starts in a list of candidates, and of the splits of measured ones.
const LISTS: u64 = 9 << 60;
/// Marks those of simulated experiments.
const EXPERIMENTS: u64 = 1 << 62;
/// Marks those of the experiments whose intervals are counted, and of the
/// resamples of a bootstrap.
const COVERAGE: u64 = 1 << 61;
const RESAMPLES: u64 = 5 << 61;

/// Point `i` of those spread evenly over `bounds`, by a Sobol sequence.
pub(crate) fn spread(bounds: &[[f64; 2]], i: u32) -> Vec<f64> {
    let all = (0..).zip(bounds);
    let share = |j: u32| f64::from(sobol_burley::sample(i, j % 256, j / 256));
    all.map(|(j, b)| b[0] + (b[1] - b[0]) * share(j)).collect()
}

/// A random point of `bounds`.
pub(crate) fn uniform(bounds: &[[f64; 2]], rng: &mut ChaCha8Rng) -> Vec<f64> {
    let all = bounds.iter();
    all.map(|b| b[0] + (b[1] - b[0]) * rng.random::<f64>()).collect()
}

/// The random numbers of one run of a simulation. Groups below 2¹⁷, levels
/// below 2¹⁰ and runs below 2³⁴ never share a stream.
pub fn run_rng(seed: u64, group: usize, level: usize, run: usize) -> ChaCha8Rng {
    stream(seed, ((group as u64) << 44) | ((level as u64) << 34) | run as u64)
}

/// The random numbers of one random initial group.
pub fn group_rng(seed: u64, group: u64) -> ChaCha8Rng {
    stream(seed, GROUPS | group)
}

/// The random numbers of one chain in one round of a global selection.
pub(crate) fn chain_rng(seed: u64, round: u64, chain: usize) -> ChaCha8Rng {
    stream(seed, CHAINS | (round << 8) | chain as u64)
}

/// The random numbers of the candidate postures of a global selection.
pub(crate) fn candidate_rng(seed: u64) -> ChaCha8Rng {
    stream(seed, CANDIDATES)
}

/// The random numbers of one start in a list of candidates.
pub(crate) fn list_rng(seed: u64, start: u64) -> ChaCha8Rng {
    stream(seed, LISTS | start)
}

/// The random numbers of one part of the search for a route.
pub fn route_rng(seed: u64, part: u64) -> ChaCha8Rng {
    stream(seed, LISTS | (1 << 58) | part)
}

/// The random numbers of one split of an experiment.
pub(crate) fn split_rng(seed: u64, split: u64) -> ChaCha8Rng {
    stream(seed, LISTS | (1 << 59) | split)
}

/// The random numbers of one simulated experiment.
pub(crate) fn experiment_rng(seed: u64, experiment: u64) -> ChaCha8Rng {
    stream(seed, EXPERIMENTS | (experiment & (EXPERIMENTS / 2 - 1)))
}

/// The random numbers of one experiment whose intervals are counted.
pub(crate) fn coverage_rng(seed: u64, experiment: usize) -> ChaCha8Rng {
    stream(seed, COVERAGE | experiment as u64)
}

/// The random numbers of one resample of a bootstrap.
pub(crate) fn resample_rng(seed: u64, resample: usize) -> ChaCha8Rng {
    stream(seed, RESAMPLES | resample as u64)
}

fn stream(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(stream);
    rng
}
