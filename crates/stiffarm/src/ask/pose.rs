//! Poses as pendants show them, and the postures of a pose, as `pose` gives them.

#[cfg(feature = "clap")]
use crate::ask::values::{Choice, choice};
use crate::error::{Code, Result};
use crate::findings::Finding;
use crate::model::cell::Cell;
use crate::model::inverse::InverseKinematics;
use crate::model::kinematics::Frames;
use crate::model::pose::{Configuration, Convention, NamedPose, held_postures, kuka_status, kuka_turn};
use crate::model::posture::Posture;
use crate::model::robot::Controller;
use crate::plan::check::robot_doubts;
use crate::units::{m_to_mm, rad_to_shortest_deg};
use nalgebra::{Isometry3, Point3};
use serde::Serialize;

/// Heights that differ by less are the same \[m\].
const SAME_HEIGHT: f64 = 1e-4;

/// Frames that poses are given in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum PoseFrame {
    /// The base frame of the robot's controller, as the pendant counts
    #[default]
    Controller,
    /// The cell's base frame
    Cell,
}

/// What a pose is of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum PosePoint {
    /// The flange
    #[default]
    Flange,
    /// The tip of \[work\], else the first measuring point in the flange's axes
    Tip,
}

/// Options of the result.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// How orientations are written.
    pub convention: &'static str,
    /// The numbers of an orientation in this convention, with their units.
    pub orientation_columns: &'static [&'static str],
    /// Frame of the poses.
    pub frame: PoseFrame,
    /// What the poses that are read and written are of.
    pub point: PosePoint,
}

/// A pose.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Pose {
    /// x, y, z.
    pub position_mm: [f64; 3],
    /// The numbers that `orientation_columns` names.
    pub orientation: Vec<f64>,
}

/// A posture beside its configuration.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NamedPosture {
    /// Its name.
    pub name: String,
    /// Controller angles.
    pub q_deg: Vec<f64>,
    /// Shoulder, elbow and wrist; `null` for arms without a spherical wrist.
    pub configuration: Option<Configuration>,
    /// KUKA's Status; `null` for other robots.
    pub kuka_status: Option<u8>,
    /// KUKA's Turn; `null` for other robots.
    pub kuka_turn: Option<u8>,
}

/// A posture with its poses.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PosturePose {
    /// The posture.
    #[serde(flatten)]
    pub posture: NamedPosture,
    /// Pose of the flange.
    pub flange: Pose,
    /// Pose of the tool's tip.
    pub tip: Pose,
}

/// Poses of postures.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Poses {
    /// The postures, in the order given.
    pub postures: Vec<PosturePose>,
    /// What to distrust about the robot of the catalogue.
    pub findings: Vec<Finding>,
}

/// A posture of a pose.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BranchPosture {
    /// The posture.
    #[serde(flatten)]
    pub posture: NamedPosture,
    /// Postures with the same number differ by full turns alone.
    pub branch: usize,
    /// Whether the posture is singular: where angles are free, it stands for all of them.
    pub is_singular: bool,
}

/// Postures of one pose.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PoseSolution {
    /// Its name.
    pub name: String,
    /// All its postures within the machine's limits, full turns included.
    pub postures: Vec<BranchPosture>,
}

/// Postures of poses.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PoseSolutions {
    /// `closed form` gives every posture, `numeric` those that a search finds.
    pub method: &'static str,
    /// The poses, in the order given.
    pub poses: Vec<PoseSolution>,
    /// Poses without a posture, and what to distrust about the robot of the catalogue.
    pub findings: Vec<Finding>,
}

/// How poses are meant, as it is asked.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct PoseOptions {
    /// How orientations are written [default: as the controller that the cell names does, else matrix]
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME", value_parser = choice(CONVENTION)))]
    pub convention: Option<Convention>,
    /// Frame that poses are given in
    #[cfg_attr(feature = "clap", arg(long, value_name = "FRAME", default_value = "controller", value_parser = choice(FRAME)))]
    pub frame: PoseFrame,
    /// Point whose poses are read and written
    #[cfg_attr(feature = "clap", arg(long, value_name = "POINT", default_value = "flange", value_parser = choice(POINT)))]
    pub point: PosePoint,
}

/// How the poses of a cell are meant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseKind {
    /// How orientations are written.
    pub convention: Convention,
    /// Frame of the poses.
    pub frame: PoseFrame,
    /// What poses that are read or written are of.
    pub point: PosePoint,
}

impl PoseOptions {
    /// How the poses of this cell are meant; without a convention by that of the robot's controller, else by matrices.
    ///
    /// # Errors
    /// A maker's convention, where nothing says that the cell's angles are a controller's.
    pub fn of(&self, cell: &Cell) -> Result<PoseKind> {
        let robot = &cell.setup.robot;
        if self.convention.is_some_and(|convention| convention != Convention::Matrix) {
            robot.known_controller()?;
        }
        Ok(PoseKind {
            convention: self.convention.unwrap_or_else(|| Convention::of(robot.controller())),
            frame: self.frame,
            point: self.point,
        })
    }
}

impl PoseKind {
    /// The options as the result holds them.
    pub fn options(&self) -> Options {
        Options {
            convention: self.convention.as_str(),
            orientation_columns: self.convention.columns(),
            frame: self.frame,
            point: self.point,
        }
    }

    /// The frame of the poses in the cell's base frame \[m\].
    pub fn frame_in(&self, cell: &Cell) -> Isometry3<f64> {
        match self.frame {
            PoseFrame::Controller => *cell.setup.robot.controller_base(),
            PoseFrame::Cell => Isometry3::identity(),
        }
    }

    /// How high above the frame of the poses axis 2 lies \[m\], where the robot's pendant counts heights from there and
    /// the poses do not: so with a robot of one's own, which cannot say it.
    pub fn height_left_out(&self, cell: &Cell) -> Option<f64> {
        let robot = &cell.setup.robot;
        let counts = robot.controller().is_some_and(Controller::counts_from_axis_2);
        if self.frame == PoseFrame::Cell || !counts {
            return None;
        }
        let frames = Frames::new(robot, &vec![0.0; robot.joint_count()]);
        let axis = frames.origins().get(1)?;
        let from_frame = self.frame_in(cell).inverse_transform_point(&Point3::from(*axis));
        Some(from_frame.z).filter(|height| height.abs() > SAME_HEIGHT)
    }

    /// What to distrust about the poses.
    fn doubts(&self, cell: &Cell) -> Vec<Finding> {
        let mut findings = robot_doubts(&cell.setup.robot);
        let maker = cell.setup.robot.controller().map(Controller::title);
        if let Some((height, maker)) = self.height_left_out(cell).zip(maker) {
            let sentence = format!(
                "Pendants of {maker} count z from the height of axis 2, {:.0} mm above the frame of these poses, which \
                 is the cell's: z on the pendant is smaller by that.",
                m_to_mm(height)
            );
            findings.push(Finding::caution("pendant-height", "robot.controller", sentence));
        }
        findings
    }

    fn pose(&self, pose: &Isometry3<f64>) -> Pose {
        let p = pose.translation.vector.map(m_to_mm);
        Pose { position_mm: [p.x, p.y, p.z], orientation: self.convention.shown(&pose.rotation) }
    }

    fn flanges(&self, cell: &Cell, postures: &[Posture]) -> Vec<Isometry3<f64>> {
        let to_frame = self.frame_in(cell).inverse();
        let robot = &cell.setup.robot;
        postures.iter().map(|p| to_frame * Frames::new(robot, &p.q).flange()).collect()
    }

    /// Poses of flange and tip at postures of the cell's robot.
    pub fn poses_of(&self, cell: &Cell, postures: &[Posture]) -> Poses {
        let tip = cell.work.tip(&cell.setup.tool);
        let flanges = self.flanges(cell, postures);
        let listed = postures.iter().zip(&flanges).map(|(posture, flange)| PosturePose {
            posture: describe(cell, posture.name.clone(), &posture.q),
            flange: self.pose(flange),
            tip: self.pose(&(flange * tip)),
        });
        Poses { postures: listed.collect(), findings: self.doubts(cell) }
    }

    /// The poses as a table of them is written: of the point that is asked for.
    pub fn named_poses(&self, cell: &Cell, postures: &[Posture]) -> Vec<NamedPose> {
        let tip = cell.work.tip(&cell.setup.tool);
        let flanges = self.flanges(cell, postures);
        let named = postures.iter().zip(&flanges);
        named
            .map(|(posture, flange)| NamedPose {
                name: posture.name.clone(),
                pose: match self.point {
                    PosePoint::Flange => *flange,
                    PosePoint::Tip => flange * tip,
                },
            })
            .collect()
    }

    /// All postures that hold the poses, full turns included; also as a list. A pose that the
    /// arm does not hold has none, and a finding.
    ///
    /// # Errors
    /// As [`held_postures`], for other reasons than that the pose is out of reach or limits.
    pub fn postures_of(&self, cell: &Cell, poses: &[NamedPose]) -> Result<(PoseSolutions, Vec<Posture>)> {
        let robot = &cell.setup.robot;
        let frame = self.frame_in(cell);
        let from_tip = cell.work.tip(&cell.setup.tool).inverse();
        let inverse = InverseKinematics::new(robot);
        let mut result = PoseSolutions {
            method: inverse.method().as_str(),
            poses: Vec::with_capacity(poses.len()),
            findings: self.doubts(cell),
        };
        let mut all = Vec::new();
        for named in poses {
            let flange = match self.point {
                PosePoint::Flange => frame * named.pose,
                PosePoint::Tip => frame * named.pose * from_tip,
            };
            let held = match held_postures(&inverse, &flange) {
                Ok(held) => held,
                Err(e) if [Code::Unreachable, Code::OutsideLimits].contains(&e.code()) => {
                    result.findings.push(Finding::serious(
                        "pose-without-posture",
                        format!("pose {}", named.name),
                        e.message(),
                    ));
                    Vec::new()
                }
                Err(e) => return Err(e),
            };
            let mut postures = Vec::new();
            for (i, held) in held.iter().enumerate() {
                for (k, q) in held.turns.iter().enumerate() {
                    let name = match k {
                        0 => format!("{}-{}", named.name, i + 1),
                        _ => format!("{}-{}.{}", named.name, i + 1, k + 1),
                    };
                    postures.push(BranchPosture {
                        posture: describe(cell, name.clone(), q),
                        branch: i + 1,
                        is_singular: held.is_singular,
                    });
                    all.push(Posture { name, q: q.clone() });
                }
            }
            result.poses.push(PoseSolution { name: named.name.clone(), postures });
        }
        Ok((result, all))
    }
}

/// A posture beside its configuration.
fn describe(cell: &Cell, name: String, q: &[f64]) -> NamedPosture {
    let robot = &cell.setup.robot;
    let is_kuka = robot.controller() == Some(Controller::Kuka);
    NamedPosture {
        name,
        q_deg: q.iter().map(|q| rad_to_shortest_deg(*q)).collect(),
        configuration: Configuration::of(robot, q),
        kuka_status: is_kuka.then(|| kuka_status(robot, q)).flatten(),
        kuka_turn: is_kuka.then(|| kuka_turn(q)),
    }
}

/// Conventions of orientations.
#[cfg(feature = "clap")]
const CONVENTION: &[Choice<Convention>] = &[
    ("kuka", "A, B, C: turns about z, then y', then x'' (deg)", Convention::Kuka),
    ("abb", "Quaternion q1 to q4, the scalar first", Convention::Abb),
    ("fanuc", "W, P, R: turns about fixed x, then y, then z (deg)", Convention::Fanuc),
    ("comau", "A, E, R: turns about z, then y', then z'' (deg)", Convention::Comau),
    ("yaskawa", "Rx, Ry, Rz: turns about fixed x, then y, then z (deg)", Convention::Yaskawa),
    ("staubli", "Rx, Ry, Rz: turns about x, then y', then z'' (deg)", Convention::Staubli),
    ("ur", "Rotation vector (rad)", Convention::Ur),
    ("matrix", "Rotation matrix", Convention::Matrix),
];

/// Frames that poses are given in.
#[cfg(feature = "clap")]
const FRAME: &[Choice<PoseFrame>] = &[
    ("controller", "The base frame of the robot's controller, as the pendant counts", PoseFrame::Controller),
    ("cell", "The cell's base frame", PoseFrame::Cell),
];

/// What a pose is of.
#[cfg(feature = "clap")]
const POINT: &[Choice<PosePoint>] = &[
    ("flange", "The flange", PosePoint::Flange),
    ("tip", "The tip of [work], else the first measuring point in the flange's axes", PosePoint::Tip),
];
