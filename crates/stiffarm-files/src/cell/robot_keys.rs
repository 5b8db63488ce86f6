//! `[robot]` of a robot that is in no catalogue, as text.

use super::example::comment;
use super::lists::{degrees, quoted, rows};
use nalgebra::{DMatrix, Isometry3, UnitQuaternion};
use sobol_burley::sample;
use std::collections::BTreeSet;
use std::f64::consts::PI;
use stiffarm::error::Result;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::robot::{Controller, DhConvention, DhRobot, LinkCapsule, Robot};
use stiffarm::units::{m_to_mm, rad_to_deg, rad_to_shortest_deg, roll_pitch_yaw, rounded};

/// Decimals of angles \[deg\] and lengths \[mm\] of rows and frames: far below 1e-9 m at
/// the flange, and above the rounding of the kinematics.
const DEG_DECIMALS: i32 = 11;
const MM_DECIMALS: i32 = 10;
/// Ends and radii of capsules are whole multiples of 1/100 mm.
const CAPSULE_STEPS: f64 = 1e2;
/// Cosine of the pitch below which roll and yaw are one.
const LOCKED: f64 = 1e-12;
/// Postures from which the reach is taken.
const SAMPLES: u32 = 256;

/// Largest distance of the flange from axis 1 among postures spread over the limits \[m\].
pub(super) fn reach(robot: &Robot) -> f64 {
    let distance = |i: u32| {
        let joints = (0..).zip(robot.joints());
        let q: Vec<f64> = joints
            .map(|(j, joint)| {
                let [low, high] = joint.limits.map(|limit| limit.clamp(-PI, PI));
                low + (high - low) * f64::from(sample(i, j % 256, 0))
            })
            .collect();
        let frames = Frames::new(robot, &q);
        let out = frames.flange().translation.vector - frames.origins()[0];
        out.cross(&frames.axes()[0]).norm()
    };
    (0..SAMPLES).map(distance).fold(0.1, f64::max)
}

/// The keys that say which robot it is, each on lines of its own.
///
/// # Errors
/// As [`DhRobot::robot`].
pub(super) fn keys(robot: &DhRobot) -> Result<String> {
    let names: Vec<String> = robot.joint_names.iter().map(|name| quoted(name)).collect();
    let (key, form) = match robot.convention {
        DhConvention::Modified => (
            "dh_modified",
            "# Modified (Craig) Denavit-Hartenberg rows [alpha_deg, a_mm, d_mm, offset_deg]:\n\
             # RotX(alpha) TransX(a) RotZ(theta) TransZ(d), theta = offset + q.\n",
        ),
        DhConvention::Standard => (
            "dh_standard",
            "# Standard Denavit-Hartenberg rows [alpha_deg, a_mm, d_mm, offset_deg]:\n\
             # RotZ(theta) TransZ(d) TransX(a) RotX(alpha), theta = offset + q.\n",
        ),
    };
    let mut out = format!("name = {}\njoint_names = [{}]\n{form}{key} = [\n", quoted(&robot.name), names.join(", "));
    for row in &robot.rows {
        let numbers = [deg(row.alpha), mm(row.a), mm(row.d), deg(row.offset)];
        out += &format!("    {},\n", degrees(&numbers));
    }
    out += "]\n";
    let tilts: Vec<f64> = robot.tilts.iter().map(|tilt| deg(*tilt)).collect();
    if tilts.iter().any(|tilt| *tilt != 0.0) {
        out += "# Turn of each axis about y of its frame, between TransX(a) and RotZ(theta), for axes\n\
                # that are nearly parallel to the one before.\n";
        out += &format!("tilts_deg = {}\n", degrees(&tilts));
    }
    out += &pose(&robot.base, "base", "Frame 0 of the rows in the base frame");
    out += &pose(&robot.flange, "flange", "The flange in the last frame of the rows");
    if robot.coupling != DMatrix::identity(robot.rows.len(), robot.rows.len()) {
        out += "# C of theta = offset + C q.\n";
        out += &theta_from_q(&robot.coupling);
    }
    out += &controller(robot)?;
    match &robot.limits {
        Some(limits) => {
            let limits: Vec<[f64; 2]> = limits.iter().map(|limits| limits.map(rad_to_shortest_deg)).collect();
            let limits = rows(&limits);
            out += &format!("# The machine's limits of the controller angles.\nlimits_deg = [\n{limits}]\n");
        }
        None => {
            out += "# The machine's limits of the controller angles, [low, high] per joint: EDIT\n# limits_deg = \
                [[-180, 180]]\n"
        }
    }
    Ok(out)
}

fn theta_from_q(coupling: &DMatrix<f64>) -> String {
    let rows = coupling.row_iter().map(|row| {
        let row: Vec<f64> = row.iter().copied().collect();
        format!("    {},\n", degrees(&row))
    });
    format!("theta_from_q = [\n{}]\n", rows.collect::<String>())
}

/// What is to be found out at the pendant before anything goes to a controller, with the keys for it.
fn controller(robot: &DhRobot) -> Result<String> {
    let name = robot.maker.unwrap_or(Controller::Other).as_str();
    let coupling = robot.suspected_coupling()?;
    let said = match coupling {
        None => {
            "Whose pendant shows the angles q of this cell. Without this key nothing goes to a controller (export, \
                 pose --convention, route --equivalents). Compare a posture with the pendant first (stiffarm pose)."
                .to_string()
        }
        Some(_) => format!(
            "Whose pendant shows the angles q of this cell. Without this key nothing goes to a controller (export, \
             pose --convention, route --equivalents). CHECK FIRST: {}. At the pendant move joint 2 alone by some 10 \
             degrees and look at the forearm. If it keeps its angle to the floor while the reading of joint 3 stays, \
             the pendant couples joint 3 to joint 2, and theta_from_q below is needed too (instead of one that stands \
             above); the limits of joint 3 then hold at joint 2 = 0. If the forearm turns along with the upper arm, it \
             is not.",
            match robot.maker {
                Some(maker) if maker.couples_joint_3() =>
                    format!("pendants of {} count joint 3 otherwise than robot descriptions do", maker.title()),
                Some(Controller::Abb) =>
                    "pendants of ABB arms with a parallelogram (IRB 2400, IRB 4400) count joint 3 \
                     otherwise than robot descriptions do"
                        .to_string(),
                _ => "joint 3 counts against joint 2, as in descriptions of arms whose pendants couple the two"
                    .to_string(),
            }
        ),
    };
    let mut out = comment(&said) + &format!("# controller = \"{name}\"\n");
    let lines = coupling.iter().map(theta_from_q).collect::<String>();
    out.extend(lines.lines().map(|line| format!("# {line}\n")));
    Ok(out)
}

/// `[route]` with the joint speeds, where they are known.
pub(super) fn route(robot: &DhRobot) -> String {
    let speeds = robot.speeds.iter().map(|speeds| {
        let speeds: Vec<f64> = speeds.iter().map(|v| rad_to_shortest_deg(*v)).collect();
        format!(
            "\n[route]\n# Largest joint speeds, for the order of postures and the time.\njoint_speeds_deg_s = {}\n",
            degrees(&speeds)
        )
    });
    speeds.collect()
}

/// `[[robot.shape]]` of the capsules around the links, with what they are.
pub(super) fn shapes(robot: &Robot, capsules: &[LinkCapsule]) -> String {
    if capsules.is_empty() {
        return String::new();
    }
    let count = |n: usize, one: &str| match n {
        1 => format!("1 {one}"),
        n => format!("{n} {one}s"),
    };
    let links: BTreeSet<usize> = capsules.iter().map(|link_capsule| link_capsule.link).collect();
    let mut out = format!(
        "\n# Shapes of the links: {} around {}, in the frames that the rows end in (link 0: base\n\
         # frame). Conservative: they contain all collision geometry and reach further. Hoses and cables\n\
         # are in none. Where two links seem to touch and do not, name them in clearance.ignore.\n",
        count(capsules.len(), "capsule"),
        count(links.len(), "link"),
    );
    for link_capsule in capsules {
        let frame = robot.row_frame(link_capsule.link).inverse();
        let capsule = link_capsule.capsule.placed(&frame);
        let exact = [capsule.a, capsule.b].map(|p| p.map(m_to_mm));
        let ends = exact.map(|p| p.map(|v| (v * CAPSULE_STEPS).round() / CAPSULE_STEPS + 0.0));
        let moved = (ends[0] - exact[0]).norm().max((ends[1] - exact[1]).norm());
        // A radius on the grid that lost some bits on its way stays what it was.
        let radius = (m_to_mm(capsule.radius) + moved) * CAPSULE_STEPS - 1e-6;
        let [from, to] = ends.map(|p| degrees(&[p.x, p.y, p.z]));
        out += &format!(
            "\n[[robot.shape]]\nlink = {}\nfrom_mm = {from}\nto_mm = {to}\nradius_mm = {}\n",
            link_capsule.link,
            radius.ceil() / CAPSULE_STEPS
        );
    }
    out
}

/// The keys of a pose, none for one that changes nothing.
fn pose(pose: &Isometry3<f64>, name: &str, what: &str) -> String {
    let xyz: [f64; 3] = pose.translation.vector.map(mm).into();
    let rpy = turns(&pose.rotation).map(deg);
    let mut out = String::new();
    for (key, numbers) in [("xyz_mm", xyz), ("rpy_deg", rpy)] {
        if numbers != [0.0; 3] {
            out += &format!("{name}_{key} = {}\n", degrees(&numbers));
        }
    }
    if out.is_empty() { out } else { format!("# {what}; turns about fixed x, then y, then z.\n{out}") }
}

/// Roll, pitch, yaw \[rad\]; where only the sum or difference of roll and yaw is determined,
/// no roll.
fn turns(rotation: &UnitQuaternion<f64>) -> [f64; 3] {
    let [roll, pitch, yaw] = roll_pitch_yaw(rotation);
    if pitch.cos() > LOCKED {
        return [roll, pitch, yaw];
    }
    let r = rotation.to_rotation_matrix();
    [0.0, pitch, (-r[(0, 1)]).atan2(r[(1, 1)])]
}

/// Degrees of a turn, rounded; never −0, and 180 for −180.
fn deg(rad: f64) -> f64 {
    match rounded(rad_to_deg(rad), DEG_DECIMALS) {
        -180.0 => 180.0,
        degrees => degrees,
    }
}

/// Millimetres, rounded; never −0.
fn mm(m: f64) -> f64 {
    rounded(m_to_mm(m), MM_DECIMALS)
}
