//! Descriptions of real arms move as other software has them.

use super::*;
use crate::common::{numbers, reference_folder};
use serde_json::Value;
use std::path::PathBuf;

#[test]
#[ignore = "needs STIFFARM_REFERENCE_DATA"]
fn poses_and_jacobians_are_those_of_the_descriptions() {
    let text = std::fs::read_to_string(reference_folder().join("robots/robots_catalogue.json")).unwrap();
    let robots: Value = serde_json::from_str(&text).unwrap();
    let robots = robots.as_object().unwrap();
    assert_eq!(robots.len(), 40);
    let mut dice = Dice::new(31);
    for (name, data) in robots {
        let file = reference_folder().join(format!("robots/urdf/{name}.urdf"));
        let text = std::fs::read_to_string(file).unwrap();
        let field = |key: &str| data[key].as_str().unwrap();
        let ends = options(field("base_frame"), field("flange_frame"));
        let read = read_urdf(&text, name, &ends).unwrap_or_else(|e| panic!("{name}: {e}"));
        let worst = differences(&text, &read, &mut dice, 20);
        println!("{name}: {:.1e} {:.1e} {:.1e}", worst.pose, worst.jacobian, worst.cell);
        assert!(worst.pose < 1e-12, "{name}: {:e}", worst.pose);
        assert!(worst.jacobian < 1e-12, "{name}: {:e}", worst.jacobian);
        assert!(worst.cell < 1e-9, "{name}: {:e}", worst.cell);
        let names: Vec<&str> = data["joint_names"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
        assert_eq!(read.robot.joint_names, names, "{name}");
        let stated = data["joint_limits_deg"].as_array().unwrap();
        let endless = |joint: &str| read.findings.iter().any(|f| f.subject == joint);
        let Some(limits) = read.robot.limits.as_ref() else {
            assert!(names.iter().all(|joint| endless(joint)), "{name} has no limits");
            continue;
        };
        for ((ours, stated), joint) in limits.iter().zip(stated).zip(names) {
            for (end, limit) in ours.iter().zip(numbers(stated)) {
                let limit = if endless(joint) { 360.0 * limit.signum() } else { limit };
                let end = end.to_degrees();
                // Rounded to what the digits of the radians mean.
                assert!((end - limit).abs() < 6e-3, "{name}: {end} {limit}");
            }
        }
    }
}

#[test]
#[ignore = "needs STIFFARM_REFERENCE_DATA"]
fn base_and_tip_are_found() {
    let mut refused = Vec::new();
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(reference_folder().join("robots/urdf")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    for file in files {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&file).unwrap();
        match read_urdf(&text, &name, &UrdfOptions::default()) {
            Ok(read) => {
                assert!(["base_link", "world"].contains(&read.base_link.as_str()), "{name}: {}", read.base_link);
                assert!(["tool0", "ee_link"].contains(&read.tip_link.as_str()), "{name}: {}", read.tip_link);
                assert!(!read.shapes.is_empty(), "{name}");
            }
            Err(_) => refused.push(name),
        }
    }
    // Its ends are the two fingers.
    assert_eq!(refused, ["panda"]);
}

#[test]
#[ignore = "needs STIFFARM_REFERENCE_DATA"]
fn poses_and_jacobians_are_those_of_pinocchio() {
    for (name, base) in [("ur10", "base_link"), ("panda", "panda_link0")] {
        let folder = reference_folder().join("pinocchio");
        let text = std::fs::read_to_string(folder.join(format!("{name}.urdf"))).unwrap();
        let data = std::fs::read_to_string(folder.join(format!("{name}.json"))).unwrap();
        let data: Value = serde_json::from_str(&data).unwrap();
        let ends = options(base, data["frame"].as_str().unwrap());
        let read = read_urdf(&text, name, &ends).unwrap();
        let robot = read.robot.robot().unwrap();
        let mut worst = 0.0_f64;
        for sample in data["samples"].as_array().unwrap() {
            let q = numbers(&sample["q"]);
            let q = &q[..robot.joint_count()];
            let frames = Frames::new(&robot, q);
            let rows = |key: &str| -> Vec<Vec<f64>> { sample[key].as_array().unwrap().iter().map(numbers).collect() };
            let pose = Matrix4::from_row_slice(&rows("T").concat());
            worst = worst.max((to_matrix(frames.flange()) - pose).amax());
            let jacobian = frames.jacobian(&frames.flange().translation.vector);
            for (i, row) in rows("J").iter().enumerate() {
                for j in 0..robot.joint_count() {
                    worst = worst.max((jacobian[(i, j)] - row[j]).abs());
                }
            }
        }
        println!("{name}: {worst:e}");
        assert!(worst < 1e-12, "{name}: {worst:e}");
    }
}
