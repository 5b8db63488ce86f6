//! What the catalogue holds of a robot.

use super::shapes::{CapsuleRow, from_row};
use super::{Controller, DhConvention, DhRow, Robot};
use crate::error::Result;
use crate::units::{deg_to_rad, mm_to_m};
use nalgebra::{DMatrix, Isometry3, Translation3, UnitQuaternion};
use serde::{Deserialize, Deserializer};

/// A published set of joint stiffness values.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct JointStiffness {
    /// One value per joint \[N·m/rad\].
    #[serde(deserialize_with = "list")]
    pub values: &'static [f64],
    /// Where the values come from.
    #[serde(deserialize_with = "text")]
    pub source: &'static str,
    /// True when we have the source itself at hand.
    pub verified: bool,
}

/// What a doubt about a robot is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DoubtAbout {
    /// The machine's limits; limits of one's own settle it.
    Limits,
    /// How the pendant's angles become those of the mechanism; a coupling C of
    /// one's own settles it.
    Angles,
    /// Lengths and axes.
    Geometry,
    /// The axes of the flange.
    Flange,
    /// How the source was read; of no consequence to who uses the robot.
    Source,
}

impl DoubtAbout {
    /// Name for tables and JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            DoubtAbout::Limits => "limits",
            DoubtAbout::Angles => "angles",
            DoubtAbout::Geometry => "geometry",
            DoubtAbout::Flange => "flange",
            DoubtAbout::Source => "source",
        }
    }
}

/// Something to distrust about a robot of the catalogue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub struct Doubt {
    /// What it is about.
    pub about: DoubtAbout,
    /// The sentence.
    #[serde(deserialize_with = "text")]
    pub sentence: &'static str,
}

/// A robot of the catalogue.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CatalogueEntry {
    /// Short name for `[robot] catalogue = "…"`.
    #[serde(deserialize_with = "text")]
    pub key: &'static str,
    /// The maker.
    #[serde(deserialize_with = "text")]
    pub brand: &'static str,
    /// Full name.
    #[serde(deserialize_with = "text")]
    pub name: &'static str,
    /// Payload \[kg\] and its source, where known.
    #[serde(deserialize_with = "sourced")]
    pub payload: Option<(f64, &'static str)>,
    /// Reach \[m\] and its source, where known.
    #[serde(deserialize_with = "sourced")]
    pub reach: Option<(f64, &'static str)>,
    /// Source of the kinematics: a sentence, or a repository.
    #[serde(deserialize_with = "text")]
    pub source: &'static str,
    /// The file in that repository; empty without one.
    #[serde(deserialize_with = "text")]
    pub file: &'static str,
    /// The commit of that file; empty without one.
    #[serde(deserialize_with = "text")]
    pub commit: &'static str,
    /// Licence of that file; empty where the source is a sentence.
    #[serde(deserialize_with = "text")]
    pub licence: &'static str,
    /// How the pendant's angles are known.
    #[serde(deserialize_with = "text")]
    pub pendant: &'static str,
    /// What to distrust.
    #[serde(deserialize_with = "list")]
    pub doubts: &'static [Doubt],
    /// Published joint stiffness, best first.
    #[serde(deserialize_with = "list")]
    pub stiffness: &'static [JointStiffness],
    /// Convention of the rows.
    #[serde(skip)]
    pub convention: DhConvention,
    /// α \[deg\], a, d \[mm\], offset \[deg\] per row.
    #[serde(deserialize_with = "list")]
    pub(super) rows: &'static [[f64; 4]],
    /// Entries of C that are not zero as (serial joint, controller joint, factor).
    #[serde(deserialize_with = "list")]
    pub(super) coupling: &'static [(usize, usize, f64)],
    /// Controller limits \[deg\]; empty where unknown (±360° is used).
    #[serde(deserialize_with = "list")]
    pub(super) limits_deg: &'static [[f64; 2]],
    /// Largest joint speeds \[deg/s\]; empty where unknown.
    #[serde(deserialize_with = "list")]
    pub speeds_deg_s: &'static [f64],
    /// Frame 0 of the rows in the robot's base frame (as the two below: x, y,
    /// z \[mm\], turns about fixed x, then y, then z \[deg\]).
    pub(super) base: [f64; 6],
    /// The flange in the last frame of the rows.
    pub(super) flange: [f64; 6],
    /// The controller's base frame in the robot's.
    pub(super) controller_base: [f64; 6],
    /// Capsules around the links.
    #[serde(deserialize_with = "list")]
    pub(super) capsules: &'static [CapsuleRow],
    /// Pairs of links whose capsules overlap though the links do not collide.
    #[serde(deserialize_with = "list")]
    pub(super) ignored_pairs: &'static [(usize, usize)],
    /// What the capsules leave out or make too large; empty where nothing is known.
    #[serde(deserialize_with = "text")]
    pub capsules_remark: &'static str,
}

// The catalogue is read once and stays until the program ends.

fn text<'de, D: Deserializer<'de>>(reader: D) -> std::result::Result<&'static str, D::Error> {
    Ok(String::deserialize(reader)?.leak())
}

fn list<'de, D: Deserializer<'de>, T: Deserialize<'de>>(reader: D) -> std::result::Result<&'static [T], D::Error> {
    Ok(Vec::deserialize(reader)?.leak())
}

/// A number and its source.
fn sourced<'de, D: Deserializer<'de>>(reader: D) -> std::result::Result<Option<(f64, &'static str)>, D::Error> {
    let (number, source) = <(f64, String)>::deserialize(reader)?;
    Ok(Some((number, source.leak())))
}

/// Six numbers of an entry as a pose \[m\].
fn pose(numbers: [f64; 6]) -> Isometry3<f64> {
    let [x, y, z] = [numbers[0], numbers[1], numbers[2]].map(mm_to_m);
    let [roll, pitch, yaw] = [numbers[3], numbers[4], numbers[5]].map(deg_to_rad);
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Isometry3::from_parts(Translation3::new(x, y, z), rotation)
}

impl CatalogueEntry {
    /// The robot's chain, with its doubts, its controller's base frame and the capsules around its links.
    ///
    /// # Errors
    /// None for the entries of the catalogue; the type is that of any robot.
    pub fn robot(&self) -> Result<Robot> {
        let base = pose(self.base);
        let rows = self.dh_rows();
        let n = rows.len();
        let mut coupling = DMatrix::zeros(n, n);
        for &(i, j, factor) in self.coupling {
            coupling[(i, j)] = factor;
        }
        let robot = Robot::from_dh(self.name, self.convention, &rows, base)?
            .with_flange(&pose(self.flange))
            .with_coupling(coupling)?;
        let robot = match self.limits_deg {
            [] => robot,
            limits => {
                let limits: Vec<[f64; 2]> = limits.iter().map(|l| l.map(deg_to_rad)).collect();
                robot.with_limits(&limits)?
            }
        };
        let capsules = self.capsules.iter().map(|capsule| from_row(capsule, &robot.row_frame(capsule.0)));
        let capsules = capsules.collect();
        Ok(robot
            .with_link_capsules(capsules, self.ignored_pairs.to_vec())?
            .with_controller(Controller::of_brand(self.brand))
            .with_controller_base(&pose(self.controller_base))
            .with_doubts(self.doubts))
    }

    /// The Denavit–Hartenberg rows.
    pub fn dh_rows(&self) -> Vec<DhRow> {
        let row = |r: &[f64; 4]| DhRow {
            alpha: deg_to_rad(r[0]),
            a: mm_to_m(r[1]),
            d: mm_to_m(r[2]),
            offset: deg_to_rad(r[3]),
        };
        self.rows.iter().map(row).collect()
    }

    /// Frame 0 of the rows in the robot's base frame \[m\].
    pub fn base(&self) -> Isometry3<f64> {
        pose(self.base)
    }

    /// The flange in the last frame of the rows \[m\].
    pub fn flange(&self) -> Isometry3<f64> {
        pose(self.flange)
    }

    /// Whether limits of the controller angles are known.
    pub fn has_limits(&self) -> bool {
        !self.limits_deg.is_empty()
    }

    /// Payload \[kg\], where known.
    pub fn payload_kg(&self) -> Option<f64> {
        self.payload.map(|(kg, _)| kg)
    }

    /// Reach \[m\], where known.
    pub fn reach_m(&self) -> Option<f64> {
        self.reach.map(|(m, _)| m)
    }
}
