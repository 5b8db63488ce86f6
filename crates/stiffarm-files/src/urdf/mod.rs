//! Robots from URDF files.
//!
//! The chain from a base link to a tip link becomes modified Denavit–Hartenberg
//! rows ([`rows_of_axes`]): joint axes may point anywhere, fixed joints are folded in,
//! and what hangs beside the chain is left alone, whatever its joints. Numbers are
//! taken as they stand: a quarter turn written as 1.5708 rad is not made exact. Limits are, as far as their
//! digits allow: 3.14159 rad is 180°.
//!
//! Only the text is read: no program is started, no package is looked up.
//!
//! ```
//! use stiffarm_files::urdf::{UrdfOptions, read_urdf};
//!
//! let text = r#"<robot name="two">
//!   <link name="base"/><link name="arm"/><link name="hand"/>
//!   <joint name="swivel" type="continuous">
//!     <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
//!   </joint>
//!   <joint name="elbow" type="revolute">
//!     <parent link="arm"/><child link="hand"/>
//!     <origin xyz="0.3 0 0.5"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="0" velocity="0"/>
//!   </joint>
//! </robot>"#;
//! let read = read_urdf(text, "two.urdf", &UrdfOptions::default())?;
//! assert_eq!(read.robot.robot()?.joint_count(), 2);
//! assert_eq!((read.base_link.as_str(), read.tip_link.as_str()), ("base", "hand"));
//! # Ok::<(), stiffarm::Error>(())
//! ```

mod angles;
mod capsules;
mod chain;
mod limits;
mod mesh;
mod robot;
mod shapes;
mod source;
mod tips;
mod tree;
mod xml;

pub use mesh::MeshFolders;
pub use robot::CollisionGeometry;
pub use shapes::CollisionShape;
pub use tips::doubted_axes;

use super::check_name;
use robot::{Joint, JointKind, Robot};
use source::Source;
use stiffarm::error::{Code, Result};
use stiffarm::findings::Finding;
use stiffarm::model::robot::{Controller, DhConvention, DhRobot, rows_of_axes};
use tree::Tree;

/// Which chain of a URDF is the robot.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct UrdfOptions {
    /// The link whose frame is the base frame; without it the root of the tree.
    pub base: Option<String>,
    /// The link whose frame is the flange; without it the only end of the tree that
    /// a joint moves and that is no gripper's, else `tool0`, else `flange`.
    pub tip: Option<String>,
}

/// A robot of a URDF.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfRobot {
    /// The robot as rows; its angles are those of the URDF.
    pub robot: DhRobot,
    /// The link whose frame is the base frame.
    pub base_link: String,
    /// The link whose frame is the flange.
    pub tip_link: String,
    /// Collision geometry of the chain's links and of what is fixed to them.
    pub shapes: Vec<CollisionShape>,
    /// Links with collision geometry that move otherwise: fingers, levers, balancers.
    pub left_out: Vec<String>,
    /// What the file says and the robot does not (limits of joints without end), and what is doubtful in it: limits in
    /// degrees, a gripper behind the arm.
    pub findings: Vec<Finding>,
}

/// Reads a robot from the text of a URDF; `file_name` is for messages.
///
/// A mimic joint of the chain is possible where it follows a joint off the chain, or
/// where it shares its axis with the joint next to it (θ = offset + C q then has two
/// entries in a row of C). Joints without end have limits of ±2π.
///
/// # Errors
/// No XML or no URDF, commands of xacro, unknown links, several possible ends, joints
/// between base and tip that do not turn about one axis, limits the wrong way round, mimic
/// joints that no square C can say: with place and hint.
pub fn read_urdf(text: &str, file_name: &str, options: &UrdfOptions) -> Result<UrdfRobot> {
    let source = Source::new(text, file_name)?;
    let robot = Robot::new(&source)?;
    let tree = Tree::new(&source, &robot)?;
    let base = tree.base(options.base.as_deref())?;
    let tip = tips::tip(&tree, options.tip.as_deref(), base)?;
    let path = tree.chain(base, tip)?;
    let mut chain = chain::chain(&tree, base, &path).map_err(|error| {
        let hint = tips::before_gripper(&tree, &path).filter(|_| error.code() == Code::Unsupported);
        error.hint_if(hint)
    })?;
    chain.findings.extend(tips::doubted(&tree, &path));
    let rows = rows_of_axes(&chain.axes, &chain.tip);
    let (shapes, left_out) = shapes::shapes(&tree, &chain, &rows)?;
    let mut joint_names = Vec::with_capacity(chain.drives.len());
    for drive in &chain.drives {
        check_name(&drive.name).map_err(|e| source.error_at("joint", &drive.name, e.code(), e.message()))?;
        joint_names.push(drive.name.clone());
    }
    let name = match check_name(&robot.name) {
        Ok(()) => robot.name.clone(),
        Err(_) => "robot".to_string(),
    };
    let has_ends = |drive: &&Joint| drive.kind != JointKind::Continuous;
    let drives_have_ends = chain.drives.iter().any(has_ends);
    let dh = DhRobot {
        name,
        convention: DhConvention::Modified,
        rows: rows.rows,
        tilts: rows.tilts,
        joint_names,
        // Joints without end say nothing of the machine.
        limits: drives_have_ends.then_some(chain.limits),
        coupling: chain.coupling,
        base: rows.base,
        flange: rows.flange,
        speeds: limits::speeds(&chain.drives),
        maker: Controller::named_in(text).or_else(|| Controller::named_in(file_name)),
    };
    Ok(UrdfRobot {
        robot: dh,
        base_link: base.to_string(),
        tip_link: tip.to_string(),
        shapes,
        left_out,
        findings: chain.findings,
    })
}
