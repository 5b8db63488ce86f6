//! Tasks, process and workpiece that can hardly be meant.

use super::FARTHEST_IN_CELL;
use crate::findings::Finding;
use crate::model::cell::Cell;
use crate::model::implausible;
use crate::units::m_to_mm;

/// A workpiece nearer to the base's origin than this is there by a slip of the unit,
/// unless it is the origin \[m\].
const NEAREST_WORKPIECE: f64 = 5e-3;

/// Looks at everything that the cell says of the robot at work.
pub(super) fn check(cell: &Cell, findings: &mut Vec<Finding>) {
    for (t, task) in cell.tasks.iter().enumerate() {
        let key = format!("task[{}].force_n", t + 1);
        let implausible_load = implausible::load(&cell.setup.robot, [(key.as_str(), &task.wrench)]);
        findings.extend(implausible_load);
    }
    findings.extend(implausible::process(cell));
    findings.extend(cell.work.shown_tool_axis());
    let distance = cell.work.workpiece.translation.vector.norm();
    let sentence = if distance > 0.0 && distance < NEAREST_WORKPIECE {
        format!(
            "The workpiece lies {:.3} mm from the base's origin, inside the robot: is it in metres? The unit is mm.",
            m_to_mm(distance)
        )
    } else if distance > FARTHEST_IN_CELL {
        format!("The workpiece lies {distance:.0} m from the robot's base: is it in mm?")
    } else {
        return;
    };
    findings.push(Finding::serious("implausible-place", "work.workpiece_mm", sentence));
}
