//! Numbers as a page needs them: short, so that many postures stay a small file.

use stiffarm::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

/// A place or a direction, base axes unless said otherwise.
pub type Triple = [f64; 3];

/// Position \[m\] and rotation as a quaternion x, y, z, w.
pub type Pose = [f64; 7];

/// A length to 1e-6 \[m\].
pub(super) fn length(value: f64) -> f64 {
    // Adding zero turns −0 into 0.
    (value * 1e6).round() / 1e6 + 0.0
}

/// A place to 1e-6 \[m\].
pub(super) fn place(at: &Vector3<f64>) -> [f64; 3] {
    [at.x, at.y, at.z].map(length)
}

/// A number to 6 significant digits.
pub(super) fn digits(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value + 0.0;
    }
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Each component to 6 significant digits.
pub(super) fn vector(v: &Vector3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z].map(digits)
}

/// A share or a component of a unit vector to 1e-7.
pub(super) fn share(value: f64) -> f64 {
    (value * 1e7).round() / 1e7 + 0.0
}

/// A frame to the same.
pub(super) fn pose(at: &Isometry3<f64>) -> Pose {
    let [x, y, z] = place(&at.translation.vector);
    let q = at.rotation.coords;
    [x, y, z, share(q.x), share(q.y), share(q.z), share(q.w)]
}

/// The frame of such numbers.
pub(super) fn isometry([x, y, z, i, j, k, w]: &Pose) -> Isometry3<f64> {
    let turn = UnitQuaternion::new_normalize(Quaternion::new(*w, *i, *j, *k));
    Isometry3::from_parts(Translation3::new(*x, *y, *z), turn)
}
