//! `[[task]]`: machining postures with their loads.

use super::load::axes;
use super::raw::RawTask;
use super::robot::angles;
use super::source::Source;
use super::value::{HasSpan, Spanned};
use nalgebra::Vector3;
use stiffarm::error::{Code, Result};
use stiffarm::model::cell::Task;
use stiffarm::model::load::{Axes, Wrench};
use stiffarm::model::robot::Robot;
use stiffarm::model::tool::Tool;

/// The tasks of `robot`, whose tips are the tool's TCP unless they say otherwise.
pub(super) fn tasks(
    source: &Source<'_>,
    raw: Option<&Spanned<Vec<Spanned<RawTask>>>>,
    robot: &Robot,
    tool: &Tool,
) -> Result<Vec<Task>> {
    let mut tasks: Vec<Task> = Vec::new();
    for (i, entry) in raw.into_iter().flat_map(Spanned::get).enumerate() {
        let task = task(source, entry, i + 1, &tasks, robot, tool)?;
        tasks.push(task);
    }
    Ok(tasks)
}

/// Task `number`, counted from 1; `before` are those above it.
fn task(
    source: &Source<'_>,
    entry: &Spanned<RawTask>,
    number: usize,
    before: &[Task],
    robot: &Robot,
    tool: &Tool,
) -> Result<Task> {
    let raw = entry.get();
    let mut others = before.iter().map(|task| task.name.as_str());
    let name = match &raw.name {
        Some(name) => source.unique_name(name, others)?,
        None => {
            let name = format!("task {number}");
            if others.any(|other| other == name) {
                let message = format!("This task has no name, and \"{name}\" is taken.");
                let key = source.path_in(entry, "name");
                let error = source.error_at(Code::Duplicate, &key, entry.span(), message);
                return Err(error.hint("give this task a name of its own"));
            }
            name
        }
    };
    let hint = "give the controller angles: q_deg = [q1, q2, …] in degrees";
    let q = angles(source, source.required(entry, &raw.q_deg, "q_deg", hint)?, robot)?;
    let hint = "give the force on the robot at the tip: force_n = [x, y, z] in newtons";
    let raw_force = source.required(entry, &raw.force_n, "force_n", hint)?;
    let force = source.vector(raw_force)?;
    let moment = source.optional(&raw.moment_nm, Source::vector)?.unwrap_or_default();
    if force == Vector3::zeros() && moment == Vector3::zeros() {
        let message = "Force and moment are zero: this task bends nothing.";
        let error = source.error(Code::InvalidValue, raw_force, message);
        return Err(error.hint("give the process force, or remove the task"));
    }
    let axes = source.optional(&raw.axes, axes)?.unwrap_or(Axes::Base);
    let tip = source.optional(&raw.tip_mm, Source::vector)?;
    Ok(Task { name, q, wrench: Wrench { force, moment }, axes, tip: tip.unwrap_or_else(|| tool.tcp()) })
}
