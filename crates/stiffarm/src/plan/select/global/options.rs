//! Budgets of a global selection.

use crate::plan::index::Index;
use crate::plan::select::accept::Accept;
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
    /// A constraint of the caller's own on the postures that are chosen; `None` for none.
    pub accept: Option<Accept>,
    /// Whether the index `prediction` may choose a posture within 15° in every joint of another, a given one included;
    /// the others may in any case.
    pub repeats: bool,
}

impl GlobalOptions {
    /// Whether no two postures of a plan by `index` may be alike.
    pub(crate) fn apart(&self, index: Index) -> bool {
        index == Index::Prediction && !self.repeats
    }
}

impl Default for GlobalOptions {
    fn default() -> Self {
        GlobalOptions {
            seed: 1,
            rounds: None,
            time_limit: None,
            given: Vec::new(),
            load: LoadDesign::default(),
            accept: None,
            repeats: false,
        }
    }
}

/// Chains; a number that divides well among the cores of a workshop computer.
const CHAINS: usize = 16;

/// Chains of searches, local searches of each and round, and how many rounds to go on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Schedule {
    pub chains: usize,
    pub tries: usize,
    pub rounds: u64,
    pub patience: u64,
}

impl Schedule {
    /// For groups of `count` postures; where the cell has shapes, beams or torques a search costs ten
    /// times as much, and ends sooner.
    pub fn new(index: Index, count: usize, has_scene: bool) -> Self {
        // One evaluation takes a hundred times as long as that of the other indices, and an exchange among candidates
        // comes near the best.
        if index == Index::Prediction {
            return Schedule {
                chains: if count > 16 { 2 } else { 4 },
                tries: 1,
                rounds: match count {
                    0..=8 => 6,
                    9..=16 => 2,
                    _ => 1,
                },
                patience: 3,
            };
        }
        // Many local minima take more rounds, and large groups longer rounds.
        let (tries, rounds, patience) = match (index.has_many_local_minima(), count > 12) {
            (true, false) => (6, 64, 24),
            (true, true) => (1, 24, 8),
            (false, false) => (3, 40, 8),
            (false, true) => (1, 20, 8),
        };
        if has_scene {
            Schedule { chains: CHAINS, tries, rounds: rounds / 4, patience: patience / 2 }
        } else {
            Schedule { chains: CHAINS, tries, rounds, patience }
        }
    }
}
