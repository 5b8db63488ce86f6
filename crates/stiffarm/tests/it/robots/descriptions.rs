//! The catalogue against the robot descriptions that it comes from.

use super::*;
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;
use std::path::PathBuf;

pub(super) fn folder() -> PathBuf {
    common::reference_folder().join("robots")
}

pub(super) fn described() -> Vec<(&'static CatalogueEntry, String, Value)> {
    let text = std::fs::read_to_string(folder().join("robots_catalogue.json")).unwrap();
    let Value::Object(robots) = serde_json::from_str(&text).unwrap() else {
        panic!("an object");
    };
    assert_eq!(robots.len(), 40);
    let entry = |name: &str| find_in_catalogue(&name.replace('_', "-")).unwrap();
    robots.into_iter().map(|(n, v)| (entry(&n), n, v)).collect()
}

pub(super) fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|v| v.as_f64().unwrap()).collect()
}

fn rows(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().unwrap().iter().map(numbers).collect()
}

/// The pendant's angles of the description's, q_urdf = M q + offset, M without
/// an inverse at hand: solved from the first joint on, as M is lower triangular.
pub(super) fn pendant(robot: &Value, urdf: &[f64]) -> Vec<f64> {
    let m = rows(&robot["pendant_to_urdf"]["M"]);
    let offset = numbers(&robot["pendant_to_urdf"]["offset_rad"]);
    let mut q: Vec<f64> = Vec::new();
    for (i, angle) in urdf.iter().enumerate() {
        let known: f64 = q.iter().zip(&m[i]).map(|(q, m)| q * m).sum();
        assert!(m[i][i + 1..].iter().all(|v| *v == 0.0));
        q.push((angle - offset[i] - known) / m[i][i]);
    }
    q
}

fn error(robot: &Robot, q: &[f64], expected: &Matrix4<f64>) -> f64 {
    let flange = Frames::new(robot, q).flange().to_homogeneous();
    (flange - expected).amax()
}

#[test]
#[ignore = "needs STIFFARM_REFERENCE_DATA"]
fn poses_are_those_of_the_samples() {
    for (entry, name, data) in described() {
        let robot = entry.robot().unwrap();
        let mut worst = 0.0_f64;
        for sample in data["fk_samples"].as_array().unwrap() {
            let expected = rows(&sample["flange"]).concat();
            let expected = Matrix4::from_row_slice(&expected);
            let q = pendant(&data, &numbers(&sample["q_urdf_rad"]));
            worst = worst.max(error(&robot, &q, &expected));
        }
        assert!(worst < 1e-9, "{name}: {worst:e}");
    }
}

/// One joint of a description.
struct UrdfJoint {
    name: String,
    parent: String,
    child: String,
    origin: Isometry3<f64>,
    axis: Vector3<f64>,
    is_fixed: bool,
}

/// The value of an attribute in the first tag `<tag …>` of `text`.
fn attribute<'t>(text: &'t str, tag: &str, name: &str) -> Option<&'t str> {
    let start = format!("<{tag}");
    let tag = text.split(start.as_str()).nth(1)?.split('>').next()?;
    let start = format!(" {name}=\"");
    tag.split(start.as_str()).nth(1)?.split('"').next()
}

fn three(text: Option<&str>, default: [f64; 3]) -> [f64; 3] {
    let Some(text) = text else { return default };
    let values: Vec<f64> = text
        .split_whitespace()
        .map(|w| w.parse().unwrap())
        .collect();
    values.try_into().unwrap()
}

fn joints(urdf: &str) -> Vec<UrdfJoint> {
    let parts = urdf.split("<joint ").skip(1);
    parts
        .map(|part| part.split("</joint>").next().unwrap())
        .map(|part| {
            let own = |name: &str| {
                let head = part.split('>').next().unwrap();
                let start = format!("{name}=\"");
                head.split(start.as_str())
                    .nth(1)
                    .unwrap()
                    .split('"')
                    .next()
                    .unwrap()
                    .to_string()
            };
            // Some descriptions round quarter turns to five or six digits.
            let snapped = |angle: f64| {
                let quarter = (angle / FRAC_PI_2).round() * FRAC_PI_2;
                if (angle - quarter).abs() < 2e-5 {
                    quarter
                } else {
                    angle
                }
            };
            let [x, y, z] = three(attribute(part, "origin", "xyz"), [0.0; 3]);
            let rpy = three(attribute(part, "origin", "rpy"), [0.0; 3]).map(snapped);
            let about = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
            // Fixed axes: roll about x first, yaw about z last.
            let rotation = about(Vector3::z_axis(), rpy[2])
                * about(Vector3::y_axis(), rpy[1])
                * about(Vector3::x_axis(), rpy[0]);
            UrdfJoint {
                name: own("name"),
                parent: attribute(part, "parent", "link").unwrap().to_string(),
                child: attribute(part, "child", "link").unwrap().to_string(),
                origin: Isometry3::from_parts(Translation3::new(x, y, z), rotation),
                axis: Vector3::from(three(attribute(part, "axis", "xyz"), [1.0, 0.0, 0.0])),
                is_fixed: own("type") == "fixed",
            }
        })
        .collect()
}

/// The flange in the base by walking the description's tree from the flange down.
fn urdf_pose(joints: &[UrdfJoint], data: &Value, q: &[f64]) -> Matrix4<f64> {
    let text = |key: &str| data[key].as_str().unwrap();
    let names: Vec<&str> = data["joint_names"]
        .as_array()
        .unwrap()
        .iter()
        .map(|n| n.as_str().unwrap())
        .collect();
    let mut pose = Isometry3::identity();
    let mut link = text("flange_frame");
    let mut moved = 0;
    while link != text("base_frame") {
        let joint = joints.iter().find(|j| j.child == link).unwrap();
        if !joint.is_fixed {
            let at = names.iter().position(|n| *n == joint.name).unwrap();
            let axis = nalgebra::Unit::new_normalize(joint.axis);
            pose = UnitQuaternion::from_axis_angle(&axis, q[at]) * pose;
            moved += 1;
        }
        pose = joint.origin * pose;
        link = &joint.parent;
    }
    assert_eq!(moved, q.len());
    pose.to_homogeneous()
}

#[test]
#[ignore = "needs STIFFARM_REFERENCE_DATA"]
fn poses_are_those_of_the_descriptions() {
    for (entry, name, data) in described() {
        let robot = entry.robot().unwrap();
        let urdf = folder().join("urdf").join(format!("{name}.urdf"));
        let joints = joints(&std::fs::read_to_string(urdf).unwrap());
        let mut dice = Dice::new(8);
        let mut worst = 0.0_f64;
        for _ in 0..20 {
            let urdf: Vec<f64> = (0..robot.joint_count())
                .map(|_| dice.between(-3.0, 3.0))
                .collect();
            let expected = urdf_pose(&joints, &data, &urdf);
            worst = worst.max(error(&robot, &pendant(&data, &urdf), &expected));
        }
        assert!(worst < 1e-9, "{name}: {worst:e}");
    }
}

#[test]
#[ignore = "needs STIFFARM_REFERENCE_DATA"]
fn limits_and_speeds_are_those_of_the_descriptions() {
    for (entry, name, data) in described() {
        let robot = entry.robot().unwrap();
        let zero = vec![0.0; robot.joint_count()];
        for (j, limit) in rows(&data["joint_limits_deg"]).iter().enumerate() {
            // One joint at its limit, the pendant's others at zero.
            let mut ends: Vec<f64> = limit
                .iter()
                .map(|end| {
                    let m = &rows(&data["pendant_to_urdf"]["M"])[j];
                    let offset = numbers(&data["pendant_to_urdf"]["offset_rad"])[j];
                    let rest: f64 = zero.iter().zip(m).map(|(q, m)| q * m).sum();
                    (deg_to_rad(*end) - offset - rest) / m[j]
                })
                .collect();
            ends.sort_by(f64::total_cmp);
            let own = robot.joints()[j].limits;
            for (own, end) in own.iter().zip(&ends) {
                assert!((own - end).abs() < 1e-10, "{name}: joint {}", j + 1);
            }
        }
        let speeds = numbers(&data["joint_velocity_deg_s"]);
        let known = speeds.iter().all(|v| *v > 0.0);
        assert_eq!(
            entry.speeds_deg_s,
            if known { &speeds[..] } else { &[] },
            "{name}"
        );
    }
}
