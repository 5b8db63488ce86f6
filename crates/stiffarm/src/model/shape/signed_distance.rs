//! Signed distance of a point from a convex solid, with its gradient.

use super::Solid;
use nalgebra::Vector3;

impl Solid {
    /// How far `point` is outside the solid \[m\], minus its depth below the surface inside,
    /// and the unit direction in which that grows. Both in the solid's frame. Where
    /// several directions are as good, one of them.
    pub fn signed_distance(&self, point: &Vector3<f64>) -> (f64, Vector3<f64>) {
        match self {
            Solid::Capsule(capsule) => {
                let along = capsule.b - capsule.a;
                let length = along.norm_squared();
                let t = match length > 0.0 {
                    true => ((point - capsule.a).dot(&along) / length).clamp(0.0, 1.0),
                    false => 0.0,
                };
                let across = point - capsule.a - along * t;
                let distance = across.norm();
                let direction = match distance > 0.0 {
                    true => across / distance,
                    false => any_across(&along),
                };
                (distance - capsule.radius, direction)
            }
            Solid::Block { pose, half } => {
                let local = pose.inverse_transform_point(&(*point).into()).coords;
                let beyond = local.abs() - half;
                let outside = beyond.sup(&Vector3::zeros());
                let distance = outside.norm();
                let (value, direction) = if distance > 0.0 {
                    (distance, outside.component_mul(&signs(&local)) / distance)
                } else {
                    let face = beyond.imax();
                    (beyond[face], Vector3::ith(face, sign(local[face])))
                };
                (value, pose.rotation * direction)
            }
            Solid::Cylinder {
                pose,
                half_length,
                radius,
            } => {
                let local = pose.inverse_transform_point(&(*point).into()).coords;
                let across = local.x.hypot(local.y);
                let outward = match across > 0.0 {
                    true => Vector3::new(local.x / across, local.y / across, 0.0),
                    false => Vector3::x(),
                };
                let up = Vector3::z() * sign(local.z);
                let (side, end) = (across - radius, local.z.abs() - half_length);
                let (value, direction) = if side > 0.0 && end > 0.0 {
                    let distance = side.hypot(end);
                    (distance, (outward * side + up * end) / distance)
                } else if side > end {
                    (side, outward)
                } else {
                    (end, up)
                };
                (value, pose.rotation * direction)
            }
            Solid::HalfSpace { point: on, normal } => {
                (normal.dot(&(point - on)), normal.into_inner())
            }
        }
    }
}

fn sign(value: f64) -> f64 {
    if value < 0.0 { -1.0 } else { 1.0 }
}

fn signs(v: &Vector3<f64>) -> Vector3<f64> {
    v.map(sign)
}

/// A unit vector across `along`.
pub(super) fn any_across(along: &Vector3<f64>) -> Vector3<f64> {
    let other = Vector3::ith(along.iamin(), 1.0);
    along
        .cross(&other)
        .try_normalize(f64::MIN_POSITIVE)
        .unwrap_or_else(Vector3::z)
}
