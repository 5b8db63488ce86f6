//! Tool, load and limits of a template: those of a robot of 3 m reach, scaled.

use nalgebra::{Isometry3, Rotation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;
use stiffarm::model::robot::{DoubtAbout, Robot};
use stiffarm::units::{STANDARD_GRAVITY, m_to_mm, rounded};

/// Reach that the example was made for, and the one from which on it fits as it is \[m\].
const EXAMPLE_REACH: f64 = 3.0;
const LARGE_REACH: f64 = 2.4;
/// The rope's force of the example \[N\].
const FORCE: f64 = 500.0;
/// Joint stiffness of a robot that the example fits as it is \[N·m/rad\].
const PRIOR: [f64; 6] = [950e3, 3000e3, 900e3, 250e3, 200e3, 150e3];
/// Share of the payload's weight that the rope may pull with.
const PAYLOAD_SHARE: f64 = 0.5;
/// Columns that a comment takes.
const COLUMNS: usize = 88;

/// How the example's lengths and forces become those of a robot.
pub(super) struct Example {
    lengths: f64,
    forces: f64,
    /// From axes with z out of the flange to the flange's.
    turn: UnitQuaternion<f64>,
}

impl Example {
    /// For a robot of this reach \[m\] and payload \[kg\], where known.
    pub(super) fn new(reach: Option<f64>, payload: Option<f64>, robot: &Robot) -> Self {
        let lengths = match reach {
            Some(reach) if reach < LARGE_REACH => reach / EXAMPLE_REACH,
            _ => 1.0,
        };
        let forces = match payload {
            Some(kg) => (PAYLOAD_SHARE * kg * STANDARD_GRAVITY / FORCE).min(1.0),
            None => lengths * lengths,
        };
        let flange_turn = robot.flange().rotation.inverse();
        // The flange lies where the last axis leads out of the wrist.
        let flange_turn = if robot.flange().translation.z < -1e-3 {
            flange_turn * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI)
        } else {
            flange_turn
        };
        // A turn about z changes nothing that an example needs.
        let is_outward = (flange_turn * Vector3::z()).z > 0.999;
        let turn = if is_outward { UnitQuaternion::identity() } else { flange_turn };
        Example { lengths, forces, turn }
    }

    /// A point in flange axes, z out of the flange in the example \[mm\].
    pub(super) fn point(&self, xyz: [i32; 3]) -> String {
        let scaled = Vector3::from(xyz).map(|v| stepped(f64::from(v) * self.lengths, 5.0));
        let turned = Rotation3::from(self.turn) * scaled;
        let [x, y, z] = [turned.x, turned.y, turned.z].map(|v| rounded(v, 0));
        format!("[{x}, {y}, {z}]")
    }

    /// A length in the cell \[mm\].
    pub(super) fn length(&self, mm: i32) -> f64 {
        stepped(f64::from(mm) * self.lengths, 10.0)
    }

    /// A force \[N\].
    pub(super) fn force(&self, n: i32) -> f64 {
        let force = f64::from(n) * self.forces;
        stepped(force, if force.abs() < 50.0 { 1.0 } else { 10.0 })
    }

    /// The flange's axis that points out of it.
    pub(super) fn outward(&self) -> &'static str {
        let z = self.turn * Vector3::z();
        match z.iamax() {
            0 if z.x > 0.0 => "x",
            0 => "-x",
            1 if z.y > 0.0 => "y",
            1 => "-y",
            _ if z.z > 0.0 => "z",
            _ => "-z",
        }
    }

    /// Joint stiffness of a robot of 165 kg payload, scaled as the torque that bends a
    /// robot of this size by the same angle, two digits, one per joint \[N·m/rad\].
    pub(super) fn prior(&self, joints: usize) -> Vec<f64> {
        let last = PRIOR[PRIOR.len() - 1];
        let all = PRIOR.into_iter().chain(std::iter::repeat(last));
        let scaled = |k: f64| {
            let scaled = k * self.forces * self.lengths;
            let digit = 10f64.powf(scaled.log10().floor() - 1.0);
            (scaled / digit).round() * digit
        };
        all.take(joints).map(scaled).collect()
    }

    /// Says that the numbers were scaled, where they were.
    pub(super) fn sentence(&self) -> &'static str {
        if self.lengths < 1.0 || self.forces < 1.0 {
            "# Tool, load and limits are an example for a large robot, scaled to this one's\n\
                 # reach and payload.\n"
        } else {
            ""
        }
    }
}

/// Rounded to a multiple of `step`, never −0.
fn stepped(value: f64, step: f64) -> f64 {
    (value / step).round() * step + 0.0
}

/// Says where the pendant's base frame is not the robot's, as a comment.
pub(super) fn pendant(robot: &Robot) -> String {
    let base = robot.controller_base();
    if *base == Isometry3::identity() {
        return String::new();
    }
    let [x, y, z] = base.translation.vector.map(|v| rounded(m_to_mm(v), 1)).into();
    let turn = match base.rotation.scaled_axis() {
        turn if turn.norm() == 0.0 => String::new(),
        turn => {
            let axis = ["x", "y", "z"][turn.iamax()];
            let degrees = turn.amax().to_degrees().round();
            format!(", turned by {degrees} degrees about {axis}")
        }
    };
    comment(&format!(
        "The pendant shows poses in another base frame: its origin at [{x}, {y}, {z}] mm here{turn}. \
         `stiffarm pose` shows both."
    ))
}

/// What to distrust about the robot, as comments.
pub(super) fn doubts(robot: &Robot) -> String {
    let said = robot.doubts().iter();
    said.filter(|doubt| doubt.about != DoubtAbout::Source)
        .map(|doubt| comment(&format!("Doubt: {}", doubt.sentence)))
        .collect()
}

/// A sentence as comment lines.
pub(super) fn comment(sentence: &str) -> String {
    let mut out = String::new();
    let mut line = "#".to_string();
    for word in sentence.split(' ') {
        if line.chars().count() + 1 + word.chars().count() > COLUMNS {
            out += &line;
            out.push('\n');
            line = "#".to_string();
        }
        line += &format!(" {word}");
    }
    out + &line + "\n"
}
