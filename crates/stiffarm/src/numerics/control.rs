//! How a caller watches and stops long work, and why a search ended.

use crate::error::{Code, Error, Result};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// Why a search ended. Not an error: the best result so far comes with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Termination {
    /// A local minimum to the tolerance asked for.
    Converged,
    /// No better point could be found along the search directions, without
    /// the optimality conditions being met to the tolerance.
    Stalled,
    /// The budget of iterations is used up.
    IterationLimit,
    /// The time allowed is over.
    TimeLimit,
    /// The user stopped it.
    Interrupted,
    /// No point that satisfies the cell's limits was found.
    Infeasible,
}

impl Termination {
    /// Words for a table.
    pub fn describe(self) -> &'static str {
        match self {
            Termination::Converged => "converged",
            Termination::Stalled => "stalled",
            Termination::IterationLimit => "iteration limit",
            Termination::TimeLimit => "time limit",
            Termination::Interrupted => "interrupted",
            Termination::Infeasible => "limits not met",
        }
    }
}

/// Asked whether to stop.
pub type Stop<'a> = &'a (dyn Fn() -> bool + Sync);
/// Told what is being done, how much is done, of how much.
pub type Report<'a> = &'a (dyn Fn(&str, usize, usize) + Sync);

/// How a caller watches and stops long work.
#[derive(Clone, Copy, Default)]
pub struct Control<'a> {
    /// Asked now and then; `true` stops with the best result so far.
    pub stop: Option<Stop<'a>>,
    /// Told about finished steps: what, done, of how many.
    pub progress: Option<Report<'a>>,
}

impl<'a> Control<'a> {
    /// The same without progress: for a part of work whose own steps would mislead.
    #[must_use]
    pub fn quiet(self) -> Control<'a> {
        Control { progress: None, ..self }
    }

    /// True when the work should stop.
    pub fn stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop())
    }

    /// Goes on, unless the work should stop.
    ///
    /// # Errors
    /// [`Code::Interrupted`] once it should.
    pub fn check(&self) -> Result<()> {
        if self.stopped() { Err(Error::new(Code::Interrupted, "Interrupted.")) } else { Ok(()) }
    }

    /// Reports progress.
    pub fn report(&self, what: &str, done: usize, of: usize) {
        if let Some(progress) = self.progress {
            progress(what, done, of);
        }
    }
}

type SharedStop = Arc<dyn Fn() -> bool + Send + Sync>;
type SharedReport = Arc<dyn Fn(&str, usize, usize) + Send + Sync>;

/// What a [`Control`] borrows, kept: for a value whose later questions can take
/// long, such as a fit.
#[derive(Clone, Default)]
pub struct Watch {
    stop: Option<SharedStop>,
    progress: Option<SharedReport>,
}

impl Watch {
    /// Asks `stop` now and then, and tells `progress` about finished steps: what,
    /// done, of how many.
    pub fn new(
        stop: impl Fn() -> bool + Send + Sync + 'static,
        progress: impl Fn(&str, usize, usize) + Send + Sync + 'static,
    ) -> Self {
        Watch { stop: Some(Arc::new(stop)), progress: Some(Arc::new(progress)) }
    }

    /// The same for a function that borrows it.
    pub fn control(&self) -> Control<'_> {
        Control {
            stop: self.stop.as_deref().map(|stop| stop as Stop<'_>),
            progress: self.progress.as_deref().map(|report| report as Report<'_>),
        }
    }
}

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut out = f.debug_struct("Watch");
        out.field("stop", &self.stop.is_some());
        out.field("progress", &self.progress.is_some()).finish()
    }
}
