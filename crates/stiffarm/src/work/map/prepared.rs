//! A path made ready to be placed anywhere.

use super::options::about_tool_axis;
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::path::{PathPoint, PathTarget, tip_wrenches};
use crate::model::process::ForceAxes;
use crate::work::predict::LoadedArm;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Loads of a path.
#[derive(Debug, Clone, Copy)]
enum PlacedLoad {
    /// In base axes: the same wherever the workpiece is.
    Fixed(Wrench),
    /// Turns with the workpiece; in its axes.
    Turning(Wrench),
}

/// Tip poses relative to the workpiece, with their loads.
#[derive(Debug, Clone)]
pub(super) struct Prepared {
    poses: Vec<Isometry3<f64>>,
    loads: Vec<PlacedLoad>,
}

impl Prepared {
    /// The path of `points` as it lies on the workpiece of `cell`, its free turns
    /// about the tool axis (of points that give a direction only) turned by `turn`
    /// \[rad\] all along. Free turns follow the tool axis from point to point
    /// without turning about it.
    ///
    /// # Errors
    /// A load in the axes of the path where it does not move across the tool axis.
    pub(super) fn new(cell: &Cell, arm: &LoadedArm, points: &[PathPoint], turn: f64) -> Result<Self> {
        let poses = poses(arm, points, turn);
        let process = cell.work.process.as_ref().map(|p| p.load());
        let workpiece = &cell.work.workpiece;
        let wrenches = tip_wrenches(points, &poses, process.as_ref(), workpiece)?;
        let back = workpiece.inverse();
        let loads = points.iter().zip(wrenches).map(|(point, wrench)| {
            match point.load.or(process.map(|process| process.load)).map(|l| l.axes) {
                Some(ForceAxes::Base) | None => PlacedLoad::Fixed(wrench),
                Some(_) => PlacedLoad::Turning(wrench.map(|v| back.rotation * v)),
            }
        });
        Ok(Prepared { loads: loads.collect(), poses: poses.iter().map(|pose| back * pose).collect() })
    }

    /// Tip poses and wrenches with the workpiece at `workpiece`, base frame.
    pub(super) fn at(&self, workpiece: &Isometry3<f64>) -> (Vec<Isometry3<f64>>, Vec<Wrench>) {
        let wrench = |load: &PlacedLoad| match load {
            PlacedLoad::Fixed(wrench) => *wrench,
            PlacedLoad::Turning(wrench) => wrench.map(|v| workpiece.rotation * v),
        };
        (self.poses.iter().map(|pose| workpiece * pose).collect(), self.loads.iter().map(wrench).collect())
    }

    /// These points of it alone.
    pub(super) fn thinned(&self, indices: &[usize]) -> Self {
        Prepared {
            poses: indices.iter().map(|i| self.poses[*i]).collect(),
            loads: indices.iter().map(|i| self.loads[*i]).collect(),
        }
    }

    /// At most `most` of the points, evenly along the path, first and last among
    /// them; by number where the tip does not move.
    pub(super) fn evenly(&self, most: usize) -> Vec<usize> {
        let count = self.poses.len();
        if count <= most {
            return (0..count).collect();
        }
        let mut along = vec![0.0; count];
        for i in 1..count {
            let step = self.poses[i].translation.vector - self.poses[i - 1].translation.vector;
            along[i] = along[i - 1] + step.norm();
        }
        let length = along[count - 1];
        if length == 0.0 {
            (0..count).for_each(|i| along[i] = i as f64);
        }
        let length = along[count - 1];
        let mut indices: Vec<usize> = (0..most)
            .map(|k| {
                let goal = length * k as f64 / (most - 1) as f64;
                along.partition_point(|a| *a < goal).min(count - 1)
            })
            .collect();
        indices[most - 1] = count - 1;
        indices.dedup();
        indices
    }
}

/// Tip poses of `points`, base frame.
fn poses(arm: &LoadedArm, points: &[PathPoint], turn: f64) -> Vec<Isometry3<f64>> {
    let mut before: Option<UnitQuaternion<f64>> = None;
    points
        .iter()
        .map(|point| {
            let pose = match &point.target {
                PathTarget::Angles(q) => arm.tip_pose(q),
                PathTarget::Pose(pose) => *pose,
                PathTarget::Axis { position, axis } => {
                    let frame =
                        before.map_or_else(|| any_frame(axis) * about_tool_axis(turn), |before| carried(&before, axis));
                    Isometry3::from_parts(Translation3::from(*position), frame)
                }
            };
            before = Some(pose.rotation);
            pose
        })
        .collect()
}

/// A frame with z along `axis`.
fn any_frame(axis: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(&Vector3::z(), axis).unwrap_or_else(half_turn)
}

/// `frame` turned the shortest way so that its z is along `axis`.
fn carried(frame: &UnitQuaternion<f64>, axis: &Vector3<f64>) -> UnitQuaternion<f64> {
    let local = frame.inverse() * axis;
    frame * UnitQuaternion::rotation_between(&Vector3::z(), &local).unwrap_or_else(half_turn)
}

/// Where z turns round there is no shortest way.
fn half_turn() -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
}
