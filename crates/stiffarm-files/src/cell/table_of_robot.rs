//! `[robot]` of a robot that is in no catalogue, as values: every number to the last digit.

use nalgebra::{DMatrix, Isometry3};
use serde::Serialize;
use stiffarm::error::Result;
use stiffarm::model::robot::{DhConvention, DhRobot, DhRow};
use stiffarm::units::{m_to_mm, rad_to_shortest_deg, roll_pitch_yaw};

/// The keys of `[robot]` that say which robot it is, as a cell file has them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobotTable {
    name: String,
    joint_names: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    dh_modified: Option<Vec<[f64; 4]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    dh_standard: Option<Vec<[f64; 4]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tilts_deg: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limits_deg: Option<Vec<[f64; 2]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    theta_from_q: Option<Vec<Vec<f64>>>,
    base_xyz_mm: [f64; 3],
    base_rpy_deg: [f64; 3],
    flange_xyz_mm: [f64; 3],
    flange_rpy_deg: [f64; 3],
}

/// The table of a robot. [`template_of`](super::template_of) writes the same for people, rounded.
///
/// # Errors
/// What [`DhRobot::robot`] refuses.
pub fn robot_table(robot: &DhRobot) -> Result<RobotTable> {
    robot.robot()?;
    let row = |row: &DhRow| {
        let DhRow { alpha, a, d, offset, .. } = *row;
        [rad_to_shortest_deg(alpha), m_to_mm(a), m_to_mm(d), rad_to_shortest_deg(offset)]
    };
    let rows: Vec<[f64; 4]> = robot.rows.iter().map(row).collect();
    let (modified, standard) = match robot.convention {
        DhConvention::Modified => (Some(rows), None),
        DhConvention::Standard => (None, Some(rows)),
    };
    let degrees = |angles: &[f64]| angles.iter().copied().map(rad_to_shortest_deg).collect();
    let has_tilts = robot.tilts.iter().any(|tilt| *tilt != 0.0);
    let n = robot.rows.len();
    let is_coupled = robot.coupling != DMatrix::identity(n, n);
    let coupling = robot.coupling.row_iter();
    Ok(RobotTable {
        name: robot.name.clone(),
        joint_names: robot.joint_names.clone(),
        dh_modified: modified,
        dh_standard: standard,
        tilts_deg: has_tilts.then(|| degrees(&robot.tilts)),
        limits_deg: robot.limits.as_ref().map(|limits| {
            let joint = |limits: &[f64; 2]| limits.map(rad_to_shortest_deg);
            limits.iter().map(joint).collect()
        }),
        theta_from_q: is_coupled.then(|| coupling.map(|row| row.iter().copied().collect()).collect()),
        base_xyz_mm: millimetres(&robot.base),
        base_rpy_deg: turns(&robot.base),
        flange_xyz_mm: millimetres(&robot.flange),
        flange_rpy_deg: turns(&robot.flange),
    })
}

fn millimetres(pose: &Isometry3<f64>) -> [f64; 3] {
    pose.translation.vector.map(m_to_mm).into()
}

fn turns(pose: &Isometry3<f64>) -> [f64; 3] {
    roll_pitch_yaw(&pose.rotation).map(rad_to_shortest_deg)
}
