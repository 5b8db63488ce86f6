//! The catalogue agrees with the robot descriptions that it comes from.

use super::*;
use crate::common::numbers;
use crate::urdf::plain::{joints_turned, path, pose_and_jacobian};
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
        let before: f64 = q.iter().zip(&m[i]).map(|(q, m)| q * m).sum();
        assert!(m[i][i + 1..].iter().all(|v| *v == 0.0));
        q.push((angle - offset[i] - before) / m[i][i]);
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

/// Some descriptions round quarter turns to five or six digits.
fn snapped(angle: f64) -> f64 {
    let quarter = (angle / FRAC_PI_2).round() * FRAC_PI_2;
    if (angle - quarter).abs() < 2e-5 { quarter } else { angle }
}

#[test]
#[ignore = "needs STIFFARM_REFERENCE_DATA"]
fn poses_are_those_of_the_descriptions() {
    for (entry, name, data) in described() {
        let robot = entry.robot().unwrap();
        let urdf = folder().join("urdf").join(format!("{name}.urdf"));
        let joints = joints_turned(&std::fs::read_to_string(urdf).unwrap(), snapped);
        let text = |key: &str| data[key].as_str().unwrap();
        let (base, tip) = (text("base_frame"), text("flange_frame"));
        let names = data["joint_names"].as_array().unwrap().iter();
        let names: Vec<String> = names.map(|n| n.as_str().unwrap().to_string()).collect();
        let mut moved: Vec<&String> =
            path(&joints, base, tip).into_iter().filter(|j| j.kind != "fixed").map(|j| &j.name).collect();
        moved.sort_by_key(|name| names.iter().position(|n| n == *name));
        assert!(moved.into_iter().eq(&names), "{name}");
        let mut dice = Dice::new(8);
        let mut worst = 0.0_f64;
        for _ in 0..20 {
            let urdf: Vec<f64> = (0..robot.joint_count()).map(|_| dice.between(-3.0, 3.0)).collect();
            let named = names.iter().cloned().zip(urdf.iter().copied()).collect();
            let (expected, _) = pose_and_jacobian(&joints, base, tip, &named, &names);
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
            let limits = robot.joints()[j].limits;
            for (limit, end) in limits.iter().zip(&ends) {
                assert!((limit - end).abs() < 1e-10, "{name}: joint {}", j + 1);
            }
        }
        let speeds = numbers(&data["joint_velocity_deg_s"]);
        let has_speeds = speeds.iter().all(|v| *v > 0.0);
        assert_eq!(entry.speeds_deg_s, if has_speeds { &speeds[..] } else { &[] }, "{name}");
    }
}
