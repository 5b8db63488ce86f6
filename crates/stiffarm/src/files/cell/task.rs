//! `[[task]]`: machining postures with their loads.

use super::load::axes;
use super::raw::{At, RawTask};
use super::robot::angles;
use super::source::Source;
use crate::error::{Code, Result};
use crate::model::cell::Task;
use crate::model::load::{Axes, Wrench};
use crate::model::robot::Robot;
use crate::model::tool::Tool;
use crate::units::mm_to_m;
use nalgebra::Vector3;

/// The tasks of `robot`, whose tips are the tool's TCP unless they say otherwise.
pub(super) fn tasks(
    source: &Source<'_>,
    raw: Option<&At<Vec<At<RawTask>>>>,
    robot: &Robot,
    tool: &Tool,
) -> Result<Vec<Task>> {
    let mut tasks: Vec<Task> = Vec::new();
    for (i, entry) in raw.into_iter().flat_map(At::get).enumerate() {
        let task = task(source, entry, i + 1, &tasks, robot, tool)?;
        tasks.push(task);
    }
    Ok(tasks)
}

/// Task `number`, counted from 1; `before` are those above it.
fn task(
    source: &Source<'_>,
    entry: &At<RawTask>,
    number: usize,
    before: &[Task],
    robot: &Robot,
    tool: &Tool,
) -> Result<Task> {
    let table = format!("task[{number}]");
    let (raw, at) = (entry.get(), Some(entry.span()));
    let mut others = before.iter().map(|task| task.name.as_str());
    let key = format!("{table}.name");
    let name = match &raw.name {
        Some(name) => source.unique_name(name, &key, others)?,
        None => {
            let name = format!("task {number}");
            if others.any(|other| other == name) {
                let message = format!("This task has no name, and \"{name}\" is taken.");
                let error = source.error(Code::Duplicate, &key, entry.span(), message);
                return Err(error.hint("give this task a name of its own"));
            }
            name
        }
    };
    let key = format!("{table}.q_deg");
    let hint = "give the controller angles: q_deg = [q1, q2, …] in degrees";
    let q = source.required(&raw.q_deg, &key, at.clone(), hint)?;
    let q = angles(source, q, &key, robot)?;
    let key = format!("{table}.force_n");
    let hint = "give the force on the robot at the tip: force_n = [x, y, z] in newtons";
    let given = source.required(&raw.force_n, &key, at, hint)?;
    let force = source.vector(given, &key)?;
    let moment = match &raw.moment_nm {
        Some(moment) => source.vector(moment, &format!("{table}.moment_nm"))?,
        None => Vector3::zeros(),
    };
    if force == Vector3::zeros() && moment == Vector3::zeros() {
        let message = "Force and moment are zero: this task bends nothing.";
        let error = source.error(Code::InvalidValue, &key, given.span(), message);
        return Err(error.hint("give the process force, or remove the task"));
    }
    let axes = match &raw.axes {
        Some(given) => axes(source, given, &format!("{table}.axes"))?,
        None => Axes::Base,
    };
    let tip = match &raw.tip_mm {
        Some(tip) => source.vector(tip, &format!("{table}.tip_mm"))?.map(mm_to_m),
        None => tool.tcp(),
    };
    Ok(Task {
        name,
        q,
        wrench: Wrench { force, moment },
        axes,
        tip,
    })
}
