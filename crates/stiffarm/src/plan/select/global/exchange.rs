//! Exchange over candidates: groups from a pool of postures, improved by
//! swapping one posture at a time for the best candidate (Fedorov 1972, after
//! Mitchell's variants), by information matrices alone.

use super::pool::Pool;
use crate::plan::index::Index;
use crate::plan::index::criterion::Criterion;
use crate::plan::index::inputs::Given;

/// Passes over all postures of a group.
const PASSES: usize = 4;
/// Relative improvement below which a swap is not worth it.
const LEAST: f64 = 1e-6;

/// What the postures of a group are chosen beside.
#[derive(Debug, Clone)]
pub(super) struct Base {
    /// Information of the given postures, packed; empty where the index has none.
    pub information: Vec<f64>,
    /// Largest ln k(J_N) of the given postures, −∞ without.
    pub log_dexterity: f64,
    /// True when the index counts the largest k(J_N).
    pub uses_dexterity: bool,
}

impl Base {
    /// What `given` brings to an index; `triangle` entries of information.
    pub fn new(index: Index, given: &Given, triangle: usize) -> Self {
        let size = if index.uses_observation() {
            triangle
        } else {
            0
        };
        let mut information = vec![0.0; size];
        given.add_information(&mut information);
        Base {
            information,
            log_dexterity: given.log_dexterity,
            uses_dexterity: index.uses_dexterity(),
        }
    }
}

/// Swaps postures of `chosen` (positions in the pool) for `candidates` as long
/// as that lowers the index.
pub(super) fn exchange(
    criterion: &mut Criterion,
    base: &Base,
    pool: &Pool,
    chosen: &mut [usize],
    candidates: &[usize],
) {
    let mut rest = base.information.clone();
    let mut total = rest.clone();
    for _ in 0..PASSES {
        let mut swapped = false;
        for p in 0..chosen.len() {
            let dexterity = sum_without(base, pool, chosen, p, &mut rest);
            let mut judge = |candidate: usize| {
                let mut value = 0.0;
                if !total.is_empty() {
                    let own = pool.information(candidate);
                    for ((total, rest), own) in total.iter_mut().zip(&rest).zip(own) {
                        *total = rest + own;
                    }
                    value = criterion.value(&total);
                }
                if base.uses_dexterity {
                    value += dexterity.max(pool.log_dexterity(candidate));
                }
                value
            };
            let mut best = (judge(chosen[p]), chosen[p]);
            for candidate in candidates {
                let value = judge(*candidate);
                if value < best.0 - LEAST {
                    best = (value, *candidate);
                }
            }
            swapped |= best.1 != chosen[p];
            chosen[p] = best.1;
        }
        if !swapped {
            break;
        }
    }
}

/// Sums the information of all postures but `without`; returns their largest ln k(J_N).
fn sum_without(base: &Base, pool: &Pool, chosen: &[usize], without: usize, sum: &mut [f64]) -> f64 {
    sum.copy_from_slice(&base.information);
    let mut dexterity = base.log_dexterity;
    for (p, at) in chosen.iter().enumerate() {
        if p == without {
            continue;
        }
        for (sum, v) in sum.iter_mut().zip(pool.information(*at)) {
            *sum += v;
        }
        dexterity = dexterity.max(pool.log_dexterity(*at));
    }
    dexterity
}
