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
                let t = if length > 0.0 { ((point - capsule.a).dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
                let across = point - capsule.a - along * t;
                let distance = across.norm();
                let direction = if distance > 0.0 { across / distance } else { any_across(&along) };
                (distance - capsule.radius, direction)
            }
            Solid::Block { pose, half } => {
                let local = pose.inverse_transform_point(&(*point).into()).coords;
                let (value, direction) = of_block(half, &local);
                (value, pose.rotation * direction)
            }
            Solid::Cylinder { pose, half_length, radius } => {
                let local = pose.inverse_transform_point(&(*point).into()).coords;
                let (value, direction) = of_cylinder(*half_length, *radius, &local);
                (value, pose.rotation * direction)
            }
            Solid::HalfSpace { point: on, normal } => (normal.dot(&(point - on)), normal.into_inner()),
        }
    }
}

/// Of a box with its centre and axes at the origin.
pub(super) fn of_block(half: &Vector3<f64>, point: &Vector3<f64>) -> (f64, Vector3<f64>) {
    let beyond = point.abs() - half;
    let outside = beyond.sup(&Vector3::zeros());
    let distance = outside.norm();
    if distance > 0.0 {
        (distance, outside.component_mul(&point.map(sign)) / distance)
    } else {
        let face = beyond.imax();
        (beyond[face], Vector3::ith(face, sign(point[face])))
    }
}

/// Of a cylinder about the z axis with its centre at the origin.
pub(super) fn of_cylinder(half_length: f64, radius: f64, point: &Vector3<f64>) -> (f64, Vector3<f64>) {
    let across = (point.x * point.x + point.y * point.y).sqrt();
    let outward = if across > 0.0 { Vector3::new(point.x / across, point.y / across, 0.0) } else { Vector3::x() };
    let up = Vector3::z() * sign(point.z);
    let (side, end) = (across - radius, point.z.abs() - half_length);
    if side > 0.0 && end > 0.0 {
        let distance = (side * side + end * end).sqrt();
        (distance, (outward * side + up * end) / distance)
    } else if side > end {
        (side, outward)
    } else {
        (end, up)
    }
}

fn sign(value: f64) -> f64 {
    if value < 0.0 { -1.0 } else { 1.0 }
}

/// A unit vector across `along`.
pub(super) fn any_across(along: &Vector3<f64>) -> Vector3<f64> {
    let other = Vector3::ith(along.iamin(), 1.0);
    along.cross(&other).try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector3::z)
}
