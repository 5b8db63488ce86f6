//! `stiffarm pose`: poses as pendants show them, and the postures of a pose.

mod table;

use crate::args::{PoseArgs, PoseFrame, PosePoint};
use crate::files::{Target, only_target, write_all};
use crate::output::Exit;
use crate::session::Session;
use nalgebra::Isometry3;
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::files::source::{NamedCell, Source};
use stiffarm::files::table::{NamedPose, read_poses, write_poses, write_postures};
use stiffarm::findings::{Finding, Severity};
use stiffarm::model::cell::Cell;
use stiffarm::model::inverse::InverseKinematics;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::pose::{Configuration, Convention, held_postures, kuka_status, kuka_turn};
use stiffarm::model::posture::Posture;
use stiffarm::plan::check::robot_doubts;
use stiffarm::units::{m_to_mm, rad_to_shortest_deg};
use stiffarm::{Code, Error, Result};

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// How orientations are written.
    pub convention: &'static str,
    /// The numbers of an orientation in this convention, with their units.
    pub orientation_columns: &'static [&'static str],
    /// Frame of the poses.
    pub frame: PoseFrame,
    /// What the poses of `--from` and `--output` are of.
    pub point: PosePoint,
}

/// A pose.
#[derive(Serialize, JsonSchema)]
pub struct Pose {
    /// x, y, z.
    pub position_mm: [f64; 3],
    /// The numbers that `orientation_columns` names.
    pub orientation: Vec<f64>,
}

/// A posture beside its configuration.
#[derive(Serialize, JsonSchema)]
pub struct Described {
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
#[derive(Serialize, JsonSchema)]
pub struct PosturePose {
    /// The posture.
    #[serde(flatten)]
    pub posture: Described,
    /// Pose of the flange.
    pub flange: Pose,
    /// Pose of the tool's tip.
    pub tip: Pose,
}

/// Poses of postures.
#[derive(Serialize, JsonSchema)]
pub struct Poses {
    /// The postures, in the order given.
    pub postures: Vec<PosturePose>,
    /// What to distrust about the robot of the catalogue.
    pub findings: Vec<Finding>,
}

/// A posture of a pose.
#[derive(Serialize, JsonSchema)]
pub struct FoundPosture {
    /// The posture.
    #[serde(flatten)]
    pub posture: Described,
    /// Postures with the same number differ by full turns alone.
    pub branch: usize,
    /// Whether the posture is singular: where angles are free, it stands for all of them.
    pub is_singular: bool,
}

/// Postures of one pose.
#[derive(Serialize, JsonSchema)]
pub struct FoundPose {
    /// Its name.
    pub name: String,
    /// All its postures within the machine's limits, full turns included.
    pub postures: Vec<FoundPosture>,
}

/// Postures of poses.
#[derive(Serialize, JsonSchema)]
pub struct Found {
    /// `closed form` gives every posture, `numeric` those that a search finds.
    pub method: &'static str,
    /// The poses, in the order given.
    pub poses: Vec<FoundPose>,
    /// Poses without a posture, and what to distrust about the robot of the catalogue.
    pub findings: Vec<Finding>,
}

/// What both ways need.
struct Job<'a> {
    session: &'a Session,
    args: &'a PoseArgs,
    named: NamedCell,
    convention: Convention,
}

/// Poses of postures, or postures of poses.
pub fn run(session: &Session, args: &PoseArgs) -> Result<Exit> {
    let named = session.read_cell(&args.cell)?;
    let convention = match args.convention {
        Some(choice) => choice.into(),
        None => Convention::of_brand(named.cell.setup.robot.brand()),
    };
    let job = Job {
        session,
        args,
        named,
        convention,
    };
    match (&args.from, &args.postures) {
        (Some(from), _) => job.postures_of(from),
        (None, Some(postures)) => job.poses_of(postures),
        (None, None) => Err(Error::new(
            Code::Usage,
            "Neither postures nor poses are given.",
        )),
    }
}

impl Job<'_> {
    fn cell(&self) -> &Cell {
        &self.named.cell
    }

    /// The frame of the poses in the cell's base frame \[m\].
    fn frame(&self) -> Isometry3<f64> {
        match self.args.frame {
            PoseFrame::Controller => *self.cell().setup.robot.controller_base(),
            PoseFrame::Cell => Isometry3::identity(),
        }
    }

    /// The tool's tip in flange axes \[m\].
    fn tip(&self) -> Isometry3<f64> {
        self.cell().work.tip(&self.cell().setup.tool)
    }

    fn options(&self) -> Options {
        Options {
            convention: self.convention.as_str(),
            orientation_columns: self.convention.columns(),
            frame: self.args.frame,
            point: self.args.point,
        }
    }

    fn pose(&self, pose: &Isometry3<f64>) -> Pose {
        let p = pose.translation.vector.map(m_to_mm);
        Pose {
            position_mm: [p.x, p.y, p.z],
            orientation: self.convention.shown(&pose.rotation),
        }
    }

    fn describe(&self, name: String, q: &[f64]) -> Described {
        let robot = &self.cell().setup.robot;
        let is_kuka = robot.brand() == Some("KUKA");
        Described {
            name,
            q_deg: q.iter().map(|q| rad_to_shortest_deg(*q)).collect(),
            configuration: Configuration::of(robot, q),
            kuka_status: is_kuka.then(|| kuka_status(robot, q)).flatten(),
            kuka_turn: is_kuka.then(|| kuka_turn(q)),
        }
    }

    fn poses_of(&self, from: &str) -> Result<Exit> {
        let (session, robot) = (self.session, &self.cell().setup.robot);
        let postures = session.read_postures("postures", from, robot)?;
        let target = only_target(session, self.args.output.as_deref(), self.args.force)?;
        let to_frame = self.frame().inverse();
        let flanges: Vec<Isometry3<f64>> = postures
            .iter()
            .map(|p| to_frame * Frames::new(robot, &p.q).flange())
            .collect();
        let tip = self.tip();
        let listed = postures
            .iter()
            .zip(&flanges)
            .map(|(posture, flange)| PosturePose {
                posture: self.describe(posture.name.clone(), &posture.q),
                flange: self.pose(flange),
                tip: self.pose(&(flange * tip)),
            });
        let result = Poses {
            postures: listed.collect(),
            findings: robot_doubts(robot),
        };
        let written = postures
            .iter()
            .zip(&flanges)
            .map(|(posture, flange)| NamedPose {
                name: posture.name.clone(),
                pose: match self.args.point {
                    PosePoint::Flange => *flange,
                    PosePoint::Tip => flange * tip,
                },
            });
        let written: Vec<NamedPose> = written.collect();
        let text = || write_poses(&written, self.convention);
        self.finish(target, text, &result, || self.table_of_poses(&result))?;
        Ok(Exit::Done)
    }

    fn postures_of(&self, from: &str) -> Result<Exit> {
        let (session, robot) = (self.session, &self.cell().setup.robot);
        let (file, bytes) = session.read("poses", from)?;
        let poses = read_poses(&bytes, &file, self.convention)?;
        let target = only_target(session, self.args.output.as_deref(), self.args.force)?;
        let (frame, from_tip) = (self.frame(), self.tip().inverse());
        let inverse = InverseKinematics::new(robot);
        let mut result = Found {
            method: inverse.method().as_str(),
            poses: Vec::with_capacity(poses.len()),
            findings: robot_doubts(robot),
        };
        let mut all = Vec::new();
        for named in &poses {
            let flange = match self.args.point {
                PosePoint::Flange => frame * named.pose,
                PosePoint::Tip => frame * named.pose * from_tip,
            };
            let held = match held_postures(&inverse, &flange) {
                Ok(held) => held,
                Err(e) if [Code::Unreachable, Code::OutsideLimits].contains(&e.code()) => {
                    result.findings.push(Finding::new(
                        "pose-without-posture",
                        Severity::Serious,
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
                    postures.push(FoundPosture {
                        posture: self.describe(name.clone(), q),
                        branch: i + 1,
                        is_singular: held.is_singular,
                    });
                    all.push(Posture { name, q: q.clone() });
                }
            }
            result.poses.push(FoundPose {
                name: named.name.clone(),
                postures,
            });
        }
        let exit = Exit::finding(result.poses.iter().any(|pose| pose.postures.is_empty()));
        let text = || write_postures(&all);
        self.finish(target, text, &result, || self.table_of_postures(&result))?;
        Ok(exit)
    }

    /// Writes the file that was asked for, and shows the result.
    fn finish<R: Serialize>(
        &self,
        target: Option<Target>,
        text: impl FnOnce() -> String,
        result: &R,
        table: impl FnOnce() -> String,
    ) -> Result<()> {
        let envelope = self.session.envelope("pose", None, self.options(), result);
        let is_stdout = target.as_ref().is_some_and(Target::is_stdout);
        if let Some(target) = target {
            write_all(self.session, &[(target, text())])?;
        }
        if is_stdout {
            self.session.remark(&table());
            return Ok(());
        }
        self.session.show(&envelope, table)
    }
}
