//! A constraint of the caller's own on single postures.

use std::fmt;
use std::sync::Arc;

type Check = dyn Fn(&[f64]) -> bool + Send + Sync;

/// Says of controller angles \[rad\] whether a posture may be chosen: what the limits of a cell cannot say.
///
/// It is asked about candidates, at the end of each local search and about the plan as it is driven, not at every step:
/// a search does not know where it is near to a boundary of such a constraint and only turns back behind it. What can
/// be said as a limit of the cell is better said there. The answer must depend on the angles alone, or the same seed
/// gives other plans.
#[derive(Clone)]
pub struct Accept(Arc<Check>);

impl Accept {
    /// A constraint by a function that is true for postures that may be chosen.
    pub fn new(check: impl Fn(&[f64]) -> bool + Send + Sync + 'static) -> Self {
        Accept(Arc::new(check))
    }

    /// True where the posture `q` \[rad\] may be chosen.
    pub fn accepts(&self, q: &[f64]) -> bool {
        (self.0)(q)
    }

    /// True where all postures of `joints` angles each may be chosen.
    pub(crate) fn accepts_all(&self, angles: &[f64], joints: usize) -> bool {
        angles.chunks_exact(joints).all(|q| self.accepts(q))
    }
}

impl fmt::Debug for Accept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Accept")
    }
}

impl PartialEq for Accept {
    /// The same function, not one that says the same.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}
