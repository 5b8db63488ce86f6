//! Numbers as a page needs them: short, so that many postures stay a small file.

use stiffarm::nalgebra::{Isometry3, Vector3};
use stiffarm::units::{rounded, significant};

/// A place or a direction, base axes unless said otherwise.
pub type Triple = [f64; 3];

/// A length to 1e-6 \[m\].
pub(super) fn length(value: f64) -> f64 {
    rounded(value, 6)
}

/// A place to 1e-6 \[m\].
pub(super) fn place(at: &Vector3<f64>) -> [f64; 3] {
    [at.x, at.y, at.z].map(length)
}

/// A number to 6 significant digits.
pub(super) fn digits(value: f64) -> f64 {
    significant(value, 6)
}

/// Each component to 6 significant digits.
pub(super) fn vector(v: &Vector3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z].map(digits)
}

/// A share or a component of a unit vector to 1e-7.
pub(super) fn share(value: f64) -> f64 {
    rounded(value, 7)
}

/// Position \[m\] and quaternion x, y, z, w.
pub(super) fn pose(at: &Isometry3<f64>) -> [f64; 7] {
    let [x, y, z] = place(&at.translation.vector);
    let q = at.rotation.coords;
    [x, y, z, share(q.x), share(q.y), share(q.z), share(q.w)]
}
