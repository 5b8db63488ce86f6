//! Places and frames as arrays of numbers.

use stiffarm::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

/// A place or a direction, base axes unless said otherwise.
pub type Triple = [f64; 3];
/// Position \[m\] and rotation as a quaternion x, y, z, w.
pub type Pose = [f64; 7];

/// The numbers of a frame.
pub(super) fn pose(at: &Isometry3<f64>) -> Pose {
    let ([x, y, z], [i, j, k, w]) = (at.translation.vector.into(), at.rotation.coords.into());
    [x, y, z, i, j, k, w]
}

/// The frame of such numbers.
pub(super) fn isometry([x, y, z, i, j, k, w]: &Pose) -> Isometry3<f64> {
    let turn = UnitQuaternion::new_normalize(Quaternion::new(*w, *i, *j, *k));
    Isometry3::from_parts(Translation3::new(*x, *y, *z), turn)
}
