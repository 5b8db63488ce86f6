//! How many postures: the best value of an index against their number.
//!
//! One certificate for a curve. The bound for n postures is that for one
//! divided by √n, whatever the plan, so `--curve` certifies its largest group
//! only; a test holds two sizes against each other.

use super::global::{GlobalOptions, select};
use super::selection::Selection;
use crate::error::{Code, Result};
use crate::model::cell::Cell;
use crate::numerics::control::Control;
use crate::plan::index::Index;
use serde::{Deserialize, Serialize};

/// The best group of one size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ErrorAtCount {
    /// Number of postures.
    pub postures: usize,
    /// The index of the best group found; `None` where so few postures cannot
    /// determine every joint.
    pub value: Option<f64>,
    /// RMS over joints of the relative standard error of k_j of that group
    /// (fraction); `None` without a prior.
    pub expected_error: Option<f64>,
    /// Rounds of the search that were completed.
    pub rounds: Option<u64>,
    /// Evaluations of the index.
    pub evaluations: u64,
}

/// Selects the best group of each size in `sizes`. Ends early, with the sizes
/// done so far, when it is stopped.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
/// use stiffarm::plan::index::Index;
/// use stiffarm::plan::select::{GlobalOptions, error_by_count};
///
/// let cell = builtin::cell("comau")?;
/// let mut options = GlobalOptions::default();
/// options.rounds = Some(1);
/// let points = error_by_count(&cell, Index::D, 2..5, &options, Control::default())?;
/// assert!(points[2].value < points[0].value);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// As [`select`], except where too few postures are the reason.
pub fn error_by_count(
    cell: &Cell,
    index: Index,
    sizes: impl IntoIterator<Item = usize>,
    options: &GlobalOptions,
    control: Control<'_>,
) -> Result<Vec<ErrorAtCount>> {
    let sizes: Vec<usize> = sizes.into_iter().collect();
    let mut points = Vec::with_capacity(sizes.len());
    for (done, postures) in sizes.iter().enumerate() {
        if control.stopped() {
            break;
        }
        match error_at_count(cell, index, *postures, options, control.quiet()) {
            Ok((point, _)) => points.push(point),
            Err(error) if error.code() == Code::Interrupted => break,
            Err(error) => return Err(error),
        }
        control.report("sizes", done + 1, sizes.len());
    }
    Ok(points)
}

/// One size, with the selection where there is one.
///
/// # Errors
/// As [`error_by_count`], and a stop before there was a group.
pub(crate) fn error_at_count(
    cell: &Cell,
    index: Index,
    postures: usize,
    options: &GlobalOptions,
    control: Control<'_>,
) -> Result<(ErrorAtCount, Option<Selection>)> {
    let selection = match select(cell, index, postures, options, control) {
        Ok(selection) => Some(selection),
        Err(error) if error.code() == Code::NotIdentifiable => None,
        Err(error) => return Err(error),
    };
    let at = selection.as_ref();
    let point = ErrorAtCount {
        postures,
        value: at.map(|s| s.value),
        expected_error: at.and_then(|s| s.evaluation.indices.expected_error),
        rounds: at.and_then(|s| s.rounds),
        evaluations: at.map_or(0, |s| s.evaluations),
    };
    Ok((point, selection))
}
