//! What is to be known about the postures of a path, in sentences.

use super::{PosturePathSummary, Search};
use crate::error::Result;
use crate::findings::{Finding, length, more, percent};
use crate::model::dexterity::condition_number;
use crate::model::kinematics::Frames;
use crate::model::path::{PathPoint, feed_axes};
use crate::numerics::control::Control;
use crate::numerics::jobs::in_blocks;

/// k(J_N), Eq. (21) at a length of 1 m, above which a posture is called singular:
/// the wrist is within about a degree of straight then.
const NEARLY_SINGULAR: f64 = 60.0;
/// Points named in a sentence about several.
const MOST_NAMED: usize = 5;

/// That some loads in path axes have those of another point.
fn borrowed_feed(search: &Search<'_>, q: &[Vec<f64>], control: Control<'_>) -> Result<Option<Finding>> {
    let process = search.options.process.as_ref();
    let is_along = |point: &PathPoint| point.is_loaded_along(process);
    if !search.points.iter().any(is_along) {
        return Ok(None);
    }
    let feeds = feed_axes(&search.arm.tip_poses(q, control.quiet())?);
    let pairs = search.points.iter().zip(&feeds);
    let mut borrowed = pairs.filter(|(point, feed)| feed.is_none() && is_along(point));
    let Some((first, _)) = borrowed.next() else {
        return Ok(None);
    };
    let more = more(borrowed.count());
    let sentence = format!(
        "At point {}{more} the path does not move across the tool axis, as in a plunge: the load there has the \
         path axes of the next move.",
        first.name
    );
    Ok(Some(Finding::note("feed-of-the-next", "path", sentence)))
}

/// All of them, for the postures `q`.
pub(super) fn findings(
    search: &Search<'_>,
    q: &[Vec<f64>],
    summary: &PosturePathSummary,
    control: Control<'_>,
) -> Result<Vec<Finding>> {
    let mut out: Vec<Finding> = borrowed_feed(search, q, control)?.into_iter().collect();
    let robot = search.arm.robot();
    let is_singular = in_blocks(q, "singular postures", control.quiet(), |_, block| {
        let mut frames = Frames::zero(robot.joint_count());
        let is_singular = |q: &Vec<f64>| {
            frames.update(robot, q);
            let tip = frames.point(&search.arm.tip().translation.vector);
            condition_number(&frames, &tip, 1.0).is_none_or(|k| k > NEARLY_SINGULAR)
        };
        Ok(block.iter().map(is_singular).collect())
    })?;
    let points = is_singular.into_iter().enumerate();
    let singular = points.filter(|(_, is_singular)| *is_singular);
    let singular: Vec<String> = singular.map(|(i, _)| search.place(i)).collect();
    if !singular.is_empty() {
        let shown = singular[..singular.len().min(MOST_NAMED)].join(", ");
        let more = more(singular.len().saturating_sub(MOST_NAMED));
        let (postures, are) = match singular.len() {
            1 => ("posture at point", "is"),
            _ => ("postures at points", "are"),
        };
        out.push(Finding::caution(
            "singular-posture",
            "path",
            format!(
                "The {postures} {shown}{more} {are} singular or nearly so: in one direction the tool hardly moves, \
                 whatever the joints do, and a controller may stop there."
            ),
        ));
    }
    if let Some(unturned_rms_m) = summary.given_rms_m {
        let gain = 1.0 - summary.deflection_rms_m / unturned_rms_m;
        let sentence = if unturned_rms_m > 0.0 && gain > 0.0 {
            format!(
                "Turning about the tool axis lowers the RMS deflection by {}, from {} to {}.",
                percent(gain),
                length(unturned_rms_m),
                length(summary.deflection_rms_m)
            )
        } else {
            "Turning about the tool axis does not lower the deflection.".to_string()
        };
        out.push(Finding::note("free-turn", "path", sentence));
    }
    Ok(out)
}
