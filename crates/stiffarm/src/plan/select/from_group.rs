//! Local selection from an initial group.

use super::repair::repair;
use super::search::{SHARPNESS, Search};
use super::selection::{Selection, check_bounds, limits_of, no_result, smallest_length};
use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::observation::check_angles;
use crate::numerics::control::Control;
use crate::numerics::optimise::Options;
use crate::plan::index::{Index, evaluate, evaluate_for};

/// Selects postures from an initial group under `index`, Section III.B: the
/// index is minimised over all controller angles at once, within the bounds
/// and the limits of the cell, by a local method.
///
/// `initial` holds controller angles \[rad\]; its length is the number of
/// postures. Angles outside the bounds are moved onto them first.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
/// use stiffarm::plan::index::Index;
/// use stiffarm::plan::select::{LocalOptions, select_from};
///
/// let cell = builtin::cell("comau")?;
/// let initial = builtin::postures("comau-group1", &cell.setup.robot)?;
/// let mut options = LocalOptions::default();
/// options.max_iterations = 50;
/// let plan = select_from(&cell, Index::D, &initial, options, Control::default())?;
/// assert!(Some(plan.value) < plan.start_value);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// An empty group, a cell without what the index needs, postures that cannot
/// determine all joints, or limits that the search could not meet.
pub fn select_from<Q: AsRef<[f64]>>(
    cell: &Cell,
    index: Index,
    initial: &[Q],
    options: Options,
    control: Control<'_>,
) -> Result<Selection> {
    let setup = &cell.setup;
    let n = setup.robot.joint_count();
    let count = initial.len();
    if count == 0 {
        return Err(Error::new(Code::TooFewData, "The initial group has no postures."));
    }
    for q in initial {
        check_angles(&setup.robot, q.as_ref())?;
    }
    check_bounds(cell)?;
    let mut start: Vec<f64> = initial.iter().flat_map(|q| q.as_ref().iter().copied()).collect();
    for (x, b) in start.iter_mut().zip(cell.bounds.iter().cycle()) {
        *x = x.clamp(b[0], b[1]);
    }
    let start_group: Vec<&[f64]> = start.chunks_exact(n).collect();
    let start_evaluation = evaluate_for(cell, "start", &start_group, Some(index))?;
    let search = || Search::new::<Vec<f64>>(cell, index, count, &[]);
    let mut solution = search()?.run(start.clone(), SHARPNESS, options, control)?;
    if !solution.merit.is_finite() && !control.stopped() {
        // From far outside a search may end where the limits are violated least: posture by posture
        // there is often a way in.
        let inside = repair(cell, &start)?;
        if inside.len() == start.len() {
            solution = search()?.run(inside, SHARPNESS, options, control)?.after(solution);
        }
    }
    if !solution.merit.is_finite() {
        return Err(no_result(cell, index, &start_evaluation, solution.termination));
    }
    let group: Vec<Vec<f64>> = solution.x[..n * count].chunks_exact(n).map(<[f64]>::to_vec).collect();
    let evaluation = evaluate(cell, index.as_str(), &group)?;
    let value =
        evaluation.indices.get(index).ok_or_else(|| no_result(cell, index, &evaluation, solution.termination))?;
    let limits = limits_of(cell, &group)?;
    Ok(Selection {
        index,
        value,
        start_value: start_evaluation.indices.get(index),
        evaluation,
        given: 0,
        termination: solution.termination,
        rounds: None,
        improvements: Vec::new(),
        starts: 1,
        evaluations: solution.evaluations,
        iterations: solution.iterations,
        stationarity: solution.stationarity,
        smallest_margin_m: smallest_length(&limits),
        limits,
        load: None,
        group,
    })
}
