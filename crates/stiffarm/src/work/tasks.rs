//! The tasks of a cell as loaded postures.

use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::kinematics::Frames;
use crate::model::load::Axes;
use crate::model::path::LoadedPosture;
use nalgebra::Isometry3;

/// The tasks of the cell with their tip.
///
/// # Errors
/// A cell without tasks, or with tasks of several tips.
pub fn tasks(cell: &Cell) -> Result<(Isometry3<f64>, Vec<LoadedPosture>)> {
    let tasks = cell.require_tasks().map_err(|e| {
        let hint = "give a path, or add [[task]] to the cell";
        Error::new(e.code(), "No path is given, and the cell has no tasks.").key("task").hint(hint)
    })?;
    if let Some(other) = tasks.iter().find(|task| task.tip != tasks[0].tip) {
        let message = format!("The tasks \"{}\" and \"{}\" have different tips.", tasks[0].name, other.name);
        return Err(Error::new(Code::Unsupported, message)
            .key("task")
            .hint("give each as a path of its own, with tip_mm in [work]"));
    }
    let mut tip = cell.work.tip(&cell.setup.tool);
    tip.translation = tasks[0].tip.into();
    let robot = &cell.setup.robot;
    let postures = tasks.iter().map(|task| {
        let frames = Frames::new(robot, &task.q);
        let turn = |v| match task.axes {
            Axes::Base => v,
            Axes::Tool => frames.direction(&v),
        };
        LoadedPosture {
            name: task.name.as_str().into(),
            line: None,
            feature: None,
            q: task.q.clone(),
            wrench: task.wrench.map(|v| turn(*v)),
        }
    });
    Ok((tip, postures.collect()))
}
