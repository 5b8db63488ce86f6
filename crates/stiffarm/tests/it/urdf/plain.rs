//! A second reading of a URDF, joint by joint with 4 × 4 matrices, that shares
//! nothing with the library.

use nalgebra::{Matrix3, Matrix4, Matrix6xX, Vector3, Vector6};
use std::collections::BTreeMap;

/// A joint of a URDF.
pub struct PlainJoint {
    pub name: String,
    pub kind: String,
    pub parent: String,
    pub child: String,
    pub origin: Matrix4<f64>,
    pub axis: Vector3<f64>,
    /// Joint that it follows, multiplier, offset.
    pub mimic: Option<(String, f64, f64)>,
}

/// The value of an attribute in the first tag `<tag …>` of `text`.
fn attribute<'t>(text: &'t str, tag: &str, name: &str) -> Option<&'t str> {
    let start = format!("<{tag} ");
    let tag = text.split(start.as_str()).nth(1)?.split('>').next()?;
    let start = format!("{name}=\"");
    let mut parts = tag.split(start.as_str());
    parts.next();
    parts.next()?.split('"').next()
}

fn three(text: Option<&str>, default: [f64; 3]) -> [f64; 3] {
    let Some(text) = text else { return default };
    let values: Vec<f64> = text.split_whitespace().map(|w| w.parse().unwrap()).collect();
    values.try_into().unwrap()
}

/// Rotation about a unit vector (Rodrigues).
fn about(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let k = axis.cross_matrix();
    Matrix3::identity() + k * angle.sin() + k * k * (1.0 - angle.cos())
}

fn matrix(rotation: Matrix3<f64>, translation: [f64; 3]) -> Matrix4<f64> {
    let mut m = Matrix4::identity();
    m.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation);
    m.fixed_view_mut::<3, 1>(0, 3).copy_from(&Vector3::from(translation));
    m
}

/// x, y, z and roll, pitch, yaw as a matrix.
pub fn pose(xyz: [f64; 3], rpy: [f64; 3]) -> Matrix4<f64> {
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let rotation = about(&z, rpy[2]) * about(&y, rpy[1]) * about(&x, rpy[0]);
    matrix(rotation, xyz)
}

/// The joints of a URDF.
pub fn joints(urdf: &str) -> Vec<PlainJoint> {
    joints_turned(urdf, |angle| angle)
}

/// The joints of a URDF, each roll, pitch and yaw through `turned`.
pub fn joints_turned(urdf: &str, turned: impl Fn(f64) -> f64) -> Vec<PlainJoint> {
    let parts = urdf.split("<joint ").skip(1);
    let parts = parts.map(|part| part.split("</joint>").next().unwrap());
    parts
        .map(|part| {
            let head = format!("<joint {part}");
            let of_joint = |name: &str| attribute(&head, "joint", name).unwrap().to_string();
            let number =
                |name: &str, default: f64| attribute(part, "mimic", name).map_or(default, |v| v.parse().unwrap());
            let axis = Vector3::from(three(attribute(part, "axis", "xyz"), [1.0, 0.0, 0.0]));
            PlainJoint {
                name: of_joint("name"),
                kind: of_joint("type"),
                parent: attribute(part, "parent", "link").unwrap().to_string(),
                child: attribute(part, "child", "link").unwrap().to_string(),
                origin: pose(
                    three(attribute(part, "origin", "xyz"), [0.0; 3]),
                    three(attribute(part, "origin", "rpy"), [0.0; 3]).map(&turned),
                ),
                axis: axis / axis.norm().max(1e-300),
                mimic: attribute(part, "mimic", "joint")
                    .map(|joint| (joint.to_string(), number("multiplier", 1.0), number("offset", 0.0))),
            }
        })
        .collect()
}

/// The joints from `base` down to `tip`.
pub fn path<'j>(joints: &'j [PlainJoint], base: &str, tip: &str) -> Vec<&'j PlainJoint> {
    let mut path: Vec<&PlainJoint> = Vec::new();
    let mut link = tip;
    while link != base {
        let joint = joints.iter().find(|j| j.child == link).unwrap();
        path.push(joint);
        link = &joint.parent;
    }
    path.reverse();
    path
}

/// Angle of a joint, and its change with each named joint's.
fn angle(joints: &[PlainJoint], joint: &PlainJoint, q: &BTreeMap<String, f64>) -> (f64, String, f64) {
    match &joint.mimic {
        None => (q.get(&joint.name).copied().unwrap_or(0.0), joint.name.clone(), 1.0),
        Some((other, multiplier, offset)) => {
            let other = joints.iter().find(|j| j.name == *other).unwrap();
            let (value, name, factor) = angle(joints, other, q);
            (multiplier * value + offset, name, multiplier * factor)
        }
    }
}

/// The tip in the base frame at the named angles, and its Jacobian with respect to `names`:
/// linear velocity of the tip's origin, then angular velocity, base axes.
pub fn pose_and_jacobian(
    joints: &[PlainJoint],
    base: &str,
    tip: &str,
    q: &BTreeMap<String, f64>,
    names: &[String],
) -> (Matrix4<f64>, Matrix6xX<f64>) {
    let mut at = Matrix4::identity();
    let mut turns = Vec::new();
    for joint in path(joints, base, tip) {
        at *= joint.origin;
        if joint.kind == "fixed" {
            continue;
        }
        let (angle, name, factor) = angle(joints, joint, q);
        let axis = at.fixed_view::<3, 3>(0, 0) * joint.axis;
        let origin: Vector3<f64> = at.fixed_view::<3, 1>(0, 3).into();
        turns.push((name, factor, axis, origin));
        at *= matrix(about(&joint.axis, angle), [0.0; 3]);
    }
    let point: Vector3<f64> = at.fixed_view::<3, 1>(0, 3).into();
    let mut jacobian = Matrix6xX::zeros(names.len());
    for (name, factor, axis, origin) in turns {
        let Some(j) = names.iter().position(|n| *n == name) else {
            continue;
        };
        let linear = axis.cross(&(point - origin));
        let column = Vector6::new(linear.x, linear.y, linear.z, axis.x, axis.y, axis.z);
        let mut entry = jacobian.column_mut(j);
        entry += column * factor;
    }
    (at, jacobian)
}
