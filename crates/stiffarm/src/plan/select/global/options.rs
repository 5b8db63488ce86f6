//! Budgets of a global selection.

use crate::plan::index::Index;
use crate::plan::select::load_design::LoadDesign;
use std::time::Duration;

/// What a global selection may use and how long it may go on.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct GlobalOptions {
    /// Seed of the random numbers.
    pub seed: u64,
    /// Rounds of the search; `None` goes on until several rounds brought
    /// nothing, or a largest number of them that depends on index and postures.
    pub rounds: Option<u64>,
    /// Ends after the round in which this time is over. Results then depend on
    /// the machine; the rounds completed reproduce them.
    pub time_limit: Option<Duration>,
    /// Postures that are measured already, or will be in any case: controller
    /// angles \[rad\]. They stay as they are; the index counts them too.
    pub given: Vec<Vec<f64>>,
    /// Load parameters to choose together with the postures.
    pub load: LoadDesign,
}

impl Default for GlobalOptions {
    fn default() -> Self {
        GlobalOptions {
            seed: 1,
            rounds: None,
            time_limit: None,
            given: Vec::new(),
            load: LoadDesign::default(),
        }
    }
}

/// How a search stands after a round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundReport {
    /// Rounds completed.
    pub rounds: u64,
    /// Evaluations of the index with its gradient so far.
    pub evaluations: u64,
    /// Best value of the index so far, before the final polish.
    pub value: Option<f64>,
}

/// Local searches of each chain and round, and how many rounds to go on.
pub(super) struct Schedule {
    pub tries: usize,
    pub rounds: u64,
    pub patience: u64,
}

impl Schedule {
    pub fn new(index: Index, count: usize) -> Self {
        // Indices with kinks have many local minima, the others few.
        let rugged = !matches!(
            index,
            Index::ExpectedError | Index::D | Index::O1 | Index::Task | Index::O5
        );
        let (rounds, patience) = match rugged {
            true => (48, 16),
            false => (40, 8),
        };
        let large = count > 12;
        Schedule {
            tries: match (rugged, large) {
                (true, false) => 6,
                (false, false) => 3,
                (_, true) => 1,
            },
            rounds: if large { rounds / 2 } else { rounds },
            patience: if large { patience.min(8) } else { patience },
        }
    }
}
