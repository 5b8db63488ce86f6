//! Loads of a path in base axes.

use super::PathPoint;
use crate::error::{Error, Result};
use crate::model::load::Wrench;
use crate::model::process::{ForceAxes, ProcessLoad};
use nalgebra::{Isometry3, Matrix3, Rotation3, Vector3};

/// Points nearer than this count as one \[m\]; so does what is left of a feed
/// direction across the tool axis, relative to one.
const TOUCHING: f64 = 1e-9;

/// Feed axes at each tip pose, base axes: z the tool axis, x the feed direction
/// across it, y = z × x. The feed direction is that from the neighbour before to
/// the one behind; `None` where the path does not move across the tool axis.
pub fn feed_axes(poses: &[Isometry3<f64>]) -> Vec<Option<Rotation3<f64>>> {
    let at = |i: usize| poses[i].translation.vector;
    let away = |i: usize, j: usize| (at(j) - at(i)).norm() > TOUCHING;
    let count = poses.len();
    // The nearest points before and behind that are elsewhere, each in one pass.
    let mut before: Vec<Option<usize>> = vec![None; count];
    let mut behind: Vec<Option<usize>> = vec![None; count];
    for i in 1..count {
        before[i] = if away(i - 1, i) { Some(i - 1) } else { before[i - 1] };
        let i = count - 1 - i;
        behind[i] = if away(i + 1, i) { Some(i + 1) } else { behind[i + 1] };
    }
    (0..count)
        .map(|i| {
            let from = before[i].unwrap_or(i);
            let to = behind[i].unwrap_or(i);
            let axis = poses[i].rotation * Vector3::z();
            // Where the path turns back on itself, the way on counts.
            let feed = [at(to) - at(from), at(to) - at(i)].into_iter().find_map(|feed| feed.try_normalize(TOUCHING))?;
            let x = (feed - axis * axis.dot(&feed)).try_normalize(TOUCHING)?;
            let y = axis.cross(&x);
            Some(Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, axis])))
        })
        .collect()
}

/// Axes of a load in path axes: the feed axes, where there are none, as in a plunge, those of the next point that has
/// them, else of the one before.
pub fn load_axes(mut feeds: Vec<Option<Rotation3<f64>>>) -> Vec<Option<Rotation3<f64>>> {
    let mut next = None;
    for feed in feeds.iter_mut().rev() {
        *feed = feed.or(next);
        next = *feed;
    }
    let mut before = None;
    for feed in &mut feeds {
        *feed = feed.or(before);
        before = *feed;
    }
    feeds
}

/// Wrenches on the robot at the tips, base axes, one per point: the point's own
/// load, else `process`, else none. `poses` are the tip poses in the base frame,
/// `workpiece` the pose of the workpiece frame there.
///
/// # Errors
/// A load in the axes of the path where it nowhere moves across the tool axis, or one that follows from a feed
/// that is not known.
pub fn tip_wrenches(
    points: &[PathPoint],
    poses: &[Isometry3<f64>],
    process: Option<&ProcessLoad>,
    workpiece: &Isometry3<f64>,
) -> Result<Vec<Wrench>> {
    let are_needed = points.iter().any(|point| point.is_loaded_along(process));
    let feeds = if are_needed { load_axes(feed_axes(poses)) } else { Vec::new() };
    let all = points.iter().zip(poses).enumerate();
    all.map(|(i, (point, pose))| {
        let feed = feeds.get(i).and_then(Option::as_ref);
        tip_wrench(point, pose, feed, process, workpiece)
    })
    .collect()
}

/// The same of one point with its feed axes.
pub(crate) fn tip_wrench(
    point: &PathPoint,
    pose: &Isometry3<f64>,
    feed: Option<&Rotation3<f64>>,
    process: Option<&ProcessLoad>,
    workpiece: &Isometry3<f64>,
) -> Result<Wrench> {
    let Some(load) = point.load_by(process)? else {
        return Ok(Wrench::force(Vector3::zeros()));
    };
    let axes = match load.axes {
        ForceAxes::Base => Rotation3::identity(),
        ForceAxes::Tool => pose.rotation.to_rotation_matrix(),
        ForceAxes::Workpiece => workpiece.rotation.to_rotation_matrix(),
        ForceAxes::Path => *feed.ok_or_else(|| no_feed(point))?,
    };
    Ok(Wrench { force: axes * load.force, moment: axes * load.moment })
}

fn no_feed(point: &PathPoint) -> Error {
    let message = format!(
        "The load at point {} is given in the axes of the path, but there the path does not move across the tool axis.",
        point.name
    );
    let error = Error::invalid(message);
    point.at(error.hint("give that point's force in base, tool or workpiece axes"))
}
