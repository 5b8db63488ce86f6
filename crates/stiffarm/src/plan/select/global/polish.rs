//! The end of a global selection: the best plan once more by the method of
//! [`select_from`](crate::plan::select::select_from), which takes maxima and limits
//! as constraints and so finds their corners exactly.

use super::plan::Plan;
use crate::error::Result;
use crate::model::cell::Cell;
use crate::numerics::control::Control;
use crate::numerics::optimise::{Minimum, Options};
use crate::plan::index::Index;
use crate::plan::select::search::{LAST, Search};

/// Variables beyond which its cost, which grows with their third power, is not
/// worth it.
const MOST_VARIABLES: usize = 72;
/// Iterations of each stage; a polish that needs more gains nothing.
const MAX_ITERATIONS: u64 = 400;

/// `plan`, or what became of it where that is better.
pub(super) fn polish<Q: AsRef<[f64]>>(
    cell: &Cell,
    index: Index,
    plan: Plan,
    joints: usize,
    fixed_postures: &[Q],
) -> Result<(Plan, Option<Minimum>)> {
    if plan.x.len() > MOST_VARIABLES {
        return Ok((plan, None));
    }
    let search = Search::new(cell, index, plan.x.len() / joints, fixed_postures)?;
    let options = Options { max_iterations: MAX_ITERATIONS, ..Options::default() };
    let solution = search.run(plan.x.clone(), LAST, options, Control::default())?;
    let better = solution.merit < plan.value;
    let polished = Plan { x: solution.x.clone(), value: solution.merit };
    Ok((if better { polished } else { plan }, Some(solution)))
}
