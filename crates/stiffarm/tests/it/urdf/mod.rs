//! Robots from URDF files, against a second reading of them.

mod capsules;
mod doubts;
mod faults;
mod generated;
pub mod plain;
mod reader;
mod reference;
mod shapes;

use crate::common::random::Dice;
use nalgebra::{Isometry3, Matrix4};
use plain::{joints, pose_and_jacobian};
use std::collections::BTreeMap;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::robot::{DhRobot, Robot};
use stiffarm_files::cell::{parse_cell, template_of};
use stiffarm_files::urdf::{UrdfOptions, UrdfRobot, read_urdf};

fn options(base: &str, tip: &str) -> UrdfOptions {
    UrdfOptions { base: Some(base.to_string()), tip: Some(tip.to_string()) }
}

/// Worst differences over some postures: poses, Jacobians, and poses of the robot in the
/// written cell.
struct Differences {
    pose: f64,
    jacobian: f64,
    cell: f64,
}

/// `None` for axes of a chain by chance that lie on one line, which no arm has: a cell file refuses them.
fn cell_robot(robot: &DhRobot) -> Option<Robot> {
    let text = template_of(robot, "A robot.").unwrap();
    match parse_cell(&text, "cell.toml") {
        Ok(cell) => Some(cell.setup.robot),
        Err(e) if e.message().contains("lie on one line") => None,
        Err(e) => panic!("{e}\n{text}"),
    }
}

fn differences(text: &str, read: &UrdfRobot, dice: &mut Dice, postures: usize) -> Differences {
    let plain = joints(text);
    let robot = read.robot.robot().unwrap();
    let in_cell = cell_robot(&read.robot);
    let names = &read.robot.joint_names;
    let mut worst = Differences { pose: 0.0, jacobian: 0.0, cell: 0.0 };
    for _ in 0..postures {
        let q: Vec<f64> = names.iter().map(|_| dice.between(-3.0, 3.0)).collect();
        let named: BTreeMap<String, f64> = names.iter().cloned().zip(q.iter().copied()).collect();
        let (pose, jacobian) = pose_and_jacobian(&plain, &read.base_link, &read.tip_link, &named, names);
        let frames = Frames::new(&robot, &q);
        let flange = frames.flange().to_homogeneous();
        worst.pose = worst.pose.max((flange - pose).amax());
        let tip = frames.flange().translation.vector;
        let ours = frames.jacobian(&tip) * robot.coupling();
        worst.jacobian = worst.jacobian.max((ours - jacobian).amax());
        if let Some(in_cell) = &in_cell {
            let flange = Frames::new(in_cell, &q).flange().to_homogeneous();
            worst.cell = worst.cell.max((flange - pose).amax());
        }
    }
    worst
}

fn to_matrix(pose: &Isometry3<f64>) -> Matrix4<f64> {
    pose.to_homogeneous()
}
