//! Postures that measure the same about the joint axes: other turns of the joints, and the wrist the other way round.

use super::planned_route::RouteOptions;
use super::rounding::nearest;
use crate::error::Result;
use crate::model::cell::{Cell, PostureMargins};
use crate::model::inverse::{InverseKinematics, Method};
use crate::model::kinematics::Frames;
use crate::numerics::order::sort_by_number;

/// Difference of two joint axes that is rounding (m, of the direction).
const SAME_AXIS: f64 = 1e-8;
/// Difference of two angles that is rounding \[rad\].
const SAME_ANGLE: f64 = 1e-7;

/// Finds the equivalents of postures.
pub(super) struct Equivalents<'a> {
    cell: &'a Cell,
    margins: PostureMargins<'a>,
    inverse: InverseKinematics,
    step_deg: Option<f64>,
    keep_wrist: bool,
    most: usize,
}

impl<'a> Equivalents<'a> {
    /// Of a plan whose angles are whole steps, or any; of each posture the `most` of the smallest angles.
    pub fn new(cell: &'a Cell, options: &RouteOptions, most: usize) -> Result<Self> {
        Ok(Equivalents {
            cell,
            margins: cell.posture_margins()?,
            inverse: InverseKinematics::new(&cell.setup.robot),
            step_deg: options.step_deg,
            keep_wrist: options.keep_wrist || cell.setup.robot.mixes_springs(),
            most,
        })
    }

    /// `q` \[rad\] and the postures that have every link's axis and the tool where `q` has them, so that
    /// their observation matrix is the same, and that meet bounds and limits of the cell: those of the
    /// smallest angles first.
    pub fn of(&mut self, q: &[f64]) -> Result<Vec<Vec<f64>>> {
        let robot = &self.cell.setup.robot;
        let frames = Frames::new(robot, q);
        let mut branches = vec![q.to_vec()];
        if self.inverse.method() == Method::ClosedForm
            && let Ok(all) = self.inverse.branches(frames.flange())
        {
            branches.extend(all.into_iter().filter(|b| !b.singular).map(|b| b.q));
        }
        let mut equivalents = vec![q.to_vec()];
        for branch in &branches {
            if !self.has_the_same_axes(&frames, branch) {
                continue;
            }
            for turned in self.inverse.turns_within_limits(branch) {
                let turned = match self.step_deg {
                    Some(step) => nearest(&turned, step),
                    None => turned,
                };
                let apart = |a: &f64, b: &f64| (a - b).abs() > SAME_ANGLE;
                let is_new = |other: &Vec<f64>| other.iter().zip(&turned).any(|(a, b)| apart(a, b));
                if equivalents.iter().all(is_new)
                    && self.cell.outside_bounds(&turned).next().is_none()
                    && self.has_the_same_axes(&frames, &turned)
                    && self.margins.are_met(&turned)?
                {
                    equivalents.push(turned);
                }
            }
        }
        let size = |q: &Vec<f64>| q.iter().map(|angle| angle * angle).sum::<f64>();
        sort_by_number(&mut equivalents, size);
        equivalents.truncate(self.most);
        Ok(equivalents)
    }

    /// Whether flange and joint axes are where they are in `frames`. An axis that points the other way
    /// leaves a column of Ψ as it is, because the column holds the axis twice; where springs mix axes, and beyond the
    /// axes, it does not.
    fn has_the_same_axes(&self, frames: &Frames, q: &[f64]) -> bool {
        let robot = &self.cell.setup.robot;
        let other = Frames::new(robot, q);
        let flange = frames.flange().inverse() * other.flange();
        if flange.translation.vector.norm() > SAME_AXIS || flange.rotation.angle() > SAME_AXIS {
            return false;
        }
        let at = frames.flange().translation.vector;
        (0..frames.joint_count()).all(|j| {
            let (a, b) = (frames.axes()[j], other.axes()[j]);
            let (moved, moves) = (frames.column(j, &at), other.column(j, &at));
            let same = |sign: f64| (a - b * sign).norm() < SAME_AXIS && (moved - moves * sign).norm() < SAME_AXIS;
            same(1.0) || (!self.keep_wrist && same(-1.0))
        })
    }
}
