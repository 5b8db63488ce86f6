//! What a plan for predictions is made for.

use crate::error::{Code, Error, Result};
use crate::model::cell::{Cell, Task};
use crate::model::load::{Axes, Load, Wrench};
use crate::model::observation::{PostureTerms, Setup};
use crate::plan::random::{StartKind, random_group};
use nalgebra::Vector3;

/// Postures that stand for the work of a cell without tasks.
const WORK_POSTURES: usize = 20;
/// Seed and stream of their draw.
const STATED_DRAW: (u64, u64) = (1, 0x5747);

/// Where deflections of the tip are to be predicted, and under which load: at the cell's tasks if it has any, and
/// anywhere, which few tasks say nothing of: at random postures inside its limits, always the same, under forces as
/// large as its load's along each axis at the first measuring point, which together stand for all directions (under the
/// load as it is where that has no force, and where all of them turn a joint that it never turns).
///
/// # Errors
/// No tasks where the load comes with measurements; no posture inside the limits.
pub(crate) fn work_of(cell: &Cell) -> Result<Vec<Vec<(Setup, PostureTerms)>>> {
    let mut work = vec![loaded_at(cell, &cell.tasks)?];
    if cell.setup.load != Load::Measured {
        work.push(anywhere(cell)?);
    }
    work.retain(|kind| !kind.is_empty());
    if work.is_empty() {
        return Err(Error::new(
            Code::MissingKey,
            "The load comes with the measurements, and the cell has no tasks: there is no deflection to predict.",
        )
        .key("task")
        .hint("add [[task]] with q_deg and force_n, once per posture of your work, or choose from --candidates"));
    }
    Ok(work)
}

/// Set-up and terms of tasks, but of those that turn a joint which the cell's loads never turn: of it nothing is known.
pub(super) fn loaded_at(cell: &Cell, tasks: &[Task]) -> Result<Vec<(Setup, PostureTerms)>> {
    let robot = &cell.setup.robot;
    let mut out = Vec::new();
    for task in tasks {
        let setup = task.setup(robot);
        let terms = PostureTerms::new(&setup, &task.q, None)?;
        if robot.left_out_but_turned(terms.torque()).is_none() {
            out.push((setup, terms));
        }
    }
    Ok(out)
}

fn anywhere(cell: &Cell) -> Result<Vec<(Setup, PostureTerms)>> {
    let cases = cell.setup.cases();
    let (seed, stream) = STATED_DRAW;
    let (mut all_directions, mut as_it_is) = (Vec::new(), Vec::new());
    for q in random_group(cell, StartKind::Uniform, WORK_POSTURES, seed, stream)? {
        let loaded: Vec<PostureTerms> =
            cases.iter().map(|setup| PostureTerms::new(setup, &q, None)).collect::<Result<_>>()?;
        let sizes = loaded.iter().map(|terms| terms.wrench().force.norm());
        let size = sizes.fold(0.0, f64::max);
        as_it_is.extend(cases.iter().cloned().zip(loaded));
        let each = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| Task {
            name: String::new(),
            q: q.clone(),
            wrench: Wrench::force(axis * size),
            axes: Axes::Base,
            tip: cell.setup.tool.tcp(),
        });
        if size > 0.0 {
            all_directions.extend(loaded_at(cell, &each)?);
        }
    }
    Ok(if all_directions.is_empty() { as_it_is } else { all_directions })
}
