//! Logs of the load along a path.

use stiffarm::model::path::PathPoint;
use stiffarm::model::process::{ForceAxes, Process, SpindlePower, TipLoad};
use stiffarm::nalgebra::Vector3;
use stiffarm::{Cell, Result};
use stiffarm_files::builtin;
use stiffarm_files::table::{read_log, read_path};

/// The log `name` put on the points of a path.
pub fn read(file: &[u8], name: &str, cell: &Cell) -> Result<Vec<PathPoint>> {
    let mut cell = cell.clone();
    let axes = ForceAxes::Base;
    let (force, moment) = (Vector3::new(-200.0, 40.0, 0.0), Vector3::zeros());
    let (loaded, idle) = (900.0, 100.0);
    cell.work.process = Some(Process::Constant(TipLoad { force, moment, axes }, Some(SpindlePower { loaded, idle })));
    let (cell, axes) = (&cell, Some(axes));
    let log = read_log(file, name, cell, axes)?;
    let text = builtin::path_text("contour").unwrap_or_default();
    let mut points = read_path(text.as_bytes(), "contour", cell, axes)?.points;
    for point in &mut points {
        (point.load, point.feed) = (None, Some(0.02));
    }
    log.put_on(cell, &mut points)?;
    Ok(points)
}
