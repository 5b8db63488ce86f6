//! What is asked of a plan.

use super::kinds::{ANGLE_STEP_DEG, POSTURES, SEED, check_count, check_repeats};
use crate::error::{Code, Error, Result};
use crate::model::posture::Posture;
use crate::plan::index::Index;
use crate::plan::select::{Accept, LoadDesign};
use std::time::Duration;

/// Iterations of a local search unless their number is given.
const MAX_ITERATIONS: u64 = 2000;

/// What is asked of a plan: by global search, from an initial group, or beside given postures.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PlanRequest {
    /// The index to improve.
    pub index: Index,
    /// Number of postures to select; beside given ones the number of new ones. An initial group says it itself.
    pub postures: usize,
    /// Time beside the robot, by the cell's [`MeasuringTime`](crate::model::cell::MeasuringTime), which says the number of
    /// postures instead, and under the index `prediction` which of the cell's loads each is measured under; not with
    /// `initial`, `given` or `load`.
    pub measuring_time: Option<Duration>,
    /// Whether the index `prediction` may choose postures within 15° of each other in every joint, as the others may.
    pub repeats: bool,
    /// An initial group to improve locally, as in the paper, instead of a global search; not with
    /// `given`, `rounds`, `time_limit`, `load` or `prices`.
    pub initial: Option<Vec<Posture>>,
    /// Postures measured or planned already: they stay as they are and count too; not with `load` or `sensitivity`.
    pub given: Vec<Posture>,
    /// Iterations of the optimiser from the initial group.
    pub max_iterations: u64,
    /// Rounds of the global search; without rounds and time limit it ends when nothing improves any more.
    pub rounds: Option<u64>,
    /// Time after which no further round is begun.
    pub time_limit: Option<Duration>,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Steps that the angles of new postures are rounded to \[deg\]; `None` leaves them as they are.
    pub angle_step_deg: Option<f64>,
    /// What of the load is chosen together with the postures; nothing by default.
    pub load: LoadDesign,
    /// A constraint of the caller's own on the postures that are chosen, beside the cell's limits; not with `initial`.
    /// The plan then keeps the angles that it accepted: no equivalents by other turns of the joints.
    pub accept: Option<Accept>,
    /// Whether to bound how good any plan could be; there is no bound for a plan from an initial group.
    pub certificate: bool,
    /// Whether to examine if wrong assumptions would change the plan.
    pub sensitivity: bool,
    /// Whether to say what each kind of limit costs.
    pub prices: bool,
}

impl Default for PlanRequest {
    fn default() -> Self {
        PlanRequest {
            index: Index::Prediction,
            postures: POSTURES,
            measuring_time: None,
            repeats: false,
            initial: None,
            given: Vec::new(),
            max_iterations: MAX_ITERATIONS,
            rounds: None,
            time_limit: None,
            seed: SEED,
            angle_step_deg: Some(ANGLE_STEP_DEG),
            load: LoadDesign::default(),
            accept: None,
            certificate: true,
            sensitivity: false,
            prices: false,
        }
    }
}

impl PlanRequest {
    /// Refuses what would be asked for in vain.
    pub(super) fn check(&self) -> Result<()> {
        let conflict = |key: &str, message: &str| {
            Err(Error::new(Code::Conflict, message.to_string()).key(key.to_string()))
        };
        if self.initial.is_none() {
            check_count(self.postures)?;
            check_repeats(self.repeats, self.index)?;
        }
        let beside = self.initial.is_some() || !self.given.is_empty() || !self.load.is_empty();
        if self.measuring_time.is_some() && beside {
            let message = "A time for measuring is that of a whole plan under known loads.";
            return conflict("measuring_time", message);
        }
        if self.initial.is_some() {
            if self.repeats {
                let message = "An initial group may hold a posture twice in any case.";
                return conflict("repeats", message);
            }
            if !self.given.is_empty() {
                let message = "An initial group is improved alone, without given postures.";
                return conflict("given", message);
            }
            if self.rounds.is_some() {
                return conflict("rounds", "A search from an initial group has no rounds.");
            }
            if self.time_limit.is_some() {
                let message = "A search from an initial group has no time limit.";
                return conflict("time_limit", message);
            }
            if !self.load.is_empty() {
                let message = "From an initial group no load is chosen.";
                return conflict("load", message);
            }
            if self.accept.is_some() {
                let message = "From an initial group there is no search among other postures.";
                return conflict("accept", message);
            }
            if self.prices {
                let message = "From an initial group the limits have no prices.";
                return conflict("prices", message);
            }
        } else if !self.given.is_empty() && self.sensitivity {
            let message =
                "The sensitivity is that of a whole plan, not of postures beside given ones.";
            return conflict("sensitivity", message);
        }
        Ok(())
    }
}
