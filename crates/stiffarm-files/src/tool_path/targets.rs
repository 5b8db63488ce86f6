//! Targets of points in the frame of a program.

use super::Form;
use nalgebra::{UnitQuaternion, Vector3};
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::path::{PathPoint, PathTarget};

/// Orientations nearer than this are the same \[rad\], positions \[m\]: what is left of products of rotations.
pub(super) const SAME_ORIENTATION: f64 = 1e-9;
pub(super) const SAME_POSITION: f64 = 1e-10;

/// Whether two points are the same but for rounding.
pub(super) fn is_same(form: &Form, a: &PathPoint, b: &PathPoint) -> bool {
    let (Ok((from, was)), Ok((to, is))) = (placed(form, a), placed(form, b)) else {
        return false;
    };
    let is_turned = match (&was, &is) {
        (TargetOrientation::Rotation(was), TargetOrientation::Rotation(is)) => was.angle_to(is) >= SAME_ORIENTATION,
        _ => was.axis().angle(&is.axis()) >= SAME_ORIENTATION,
    };
    (to - from).norm() < SAME_POSITION && !is_turned
}

/// The orientation of a target in the frame of the program.
pub(super) enum TargetOrientation {
    Axis(Vector3<f64>),
    Rotation(UnitQuaternion<f64>),
}

impl TargetOrientation {
    /// Direction from the spindle to the tip.
    pub fn axis(&self) -> Vector3<f64> {
        match self {
            TargetOrientation::Axis(axis) => *axis,
            TargetOrientation::Rotation(rotation) => rotation * Vector3::z(),
        }
    }

    pub fn rotation(&self) -> Result<UnitQuaternion<f64>> {
        match self {
            TargetOrientation::Rotation(rotation) => Ok(*rotation),
            TargetOrientation::Axis(_) => {
                let message = "The program holds whole orientations, the path tool axes only.";
                Err(Error::new(Code::Conflict, message))
            }
        }
    }
}

/// Position \[m\] and orientation of a target in the frame of the program.
pub(super) fn placed(form: &Form, point: &PathPoint) -> Result<(Vector3<f64>, TargetOrientation)> {
    let from_base = form.frame.inverse();
    let at = |p: &Vector3<f64>| from_base.rotation * p + from_base.translation.vector;
    match &point.target {
        PathTarget::Pose(pose) => {
            Ok((at(&pose.translation.vector), TargetOrientation::Rotation(from_base.rotation * pose.rotation)))
        }
        PathTarget::Axis { position, axis } => {
            Ok((at(position), TargetOrientation::Axis(from_base.rotation * axis.as_ref())))
        }
        PathTarget::Angles(_) => {
            let message = format!("Point {} is given as joint angles.", point.name);
            Err(Error::new(Code::Conflict, message))
        }
    }
}
