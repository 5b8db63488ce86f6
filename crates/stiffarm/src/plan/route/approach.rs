//! The side from which a posture is reached.
//!
//! A joint stands on one side of its lost motion: its last turn leaves the arm a little behind the motor, so a joint
//! that was turned down stands on the upper side. A load that turns the joint up then finds it there, and nothing of
//! the lost motion is in the displacement; on the other side all of it is. So each joint is turned beyond the posture
//! to the side to which the load turns it, and back.

use super::moves::Moves;
use super::rounding::nearest;
use super::search::VIA_STEP_DEG;
use crate::error::Result;
use crate::model::cell::Cell;

/// How a stop is approached.
pub(super) struct Approach {
    /// Last via postures of the move, controller angles \[rad\].
    pub via: Vec<Vec<f64>>,
    /// Joints whose last turn leaves them on the side of the load, counted from 0.
    pub joints: Vec<usize>,
}

/// The end of the move from `from` to the stop `to`: `turn` \[rad\] beyond it in as many joints as find room
/// for it. Straight to there where that is free, else over the stop itself.
pub(super) fn approach(cell: &Cell, ways: &mut Moves<'_>, from: &[f64], to: &[f64], turn: f64) -> Result<Approach> {
    let robot = &cell.setup.robot;
    let standing = robot.serial_angles(to);
    let sides = cell.sides_of_load(to)?;
    let mut beyond = standing.clone();
    let mut approach = Approach { via: Vec::new(), joints: Vec::new() };
    ways.begin(to, to)?;
    for (joint, side) in sides.into_iter().enumerate() {
        let Some(side) = side.filter(|side| *side != 0.0) else {
            continue;
        };
        let mut tried = beyond.clone();
        tried[joint] += side * turn;
        let Some(q) = robot.controller_angles(&tried) else {
            continue;
        };
        // Typed like every other posture.
        let q = nearest(q.as_slice(), VIA_STEP_DEG);
        let mut limits = robot.joints().iter().zip(&q);
        let is_within = limits.all(|(joint, q)| (joint.limits[0]..=joint.limits[1]).contains(q));
        if is_within && ways.is_clear(&q)? && ways.is_free(&q, to)? {
            beyond = tried;
            approach.via = vec![q];
            approach.joints.push(joint);
        }
    }
    if let Some(beyond) = approach.via.first().cloned() {
        ways.begin(from, to)?;
        if !ways.is_free(from, &beyond)? {
            approach.via.insert(0, to.to_vec());
        }
    }
    Ok(approach)
}
