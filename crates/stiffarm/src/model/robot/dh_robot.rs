//! A robot as rows of its own, with all that goes with them.

use super::{Controller, DhConvention, DhRow, Robot};
use crate::error::Result;
use nalgebra::{DMatrix, Isometry3};

/// Joints of a robot that is read from a file: beyond that it is a slip, and C alone
/// would fill the memory.
pub const MOST_JOINTS: usize = 100;

/// What a cell file says of a robot that is in no catalogue: rows, and the
/// frames, limits and names that go with them.
#[derive(Debug, Clone, PartialEq)]
pub struct DhRobot {
    /// Name of the robot.
    pub name: String,
    /// Convention of the rows.
    pub convention: DhConvention,
    /// One row per joint.
    pub rows: Vec<DhRow>,
    /// Tilt of each joint's axis about the y axis of its frame \[rad\], as
    /// [`Robot::with_tilts`] has it; empty for none.
    pub tilts: Vec<f64>,
    /// Names of the controller's joints, one each.
    pub joint_names: Vec<String>,
    /// The machine's limits of the controller angles \[rad\], where known.
    pub limits: Option<Vec<[f64; 2]>>,
    /// C of θ = offset + C q (n × n).
    pub coupling: DMatrix<f64>,
    /// Frame 0 of the rows in the base frame \[m\].
    pub base: Isometry3<f64>,
    /// The flange in the last frame of the rows \[m\].
    pub flange: Isometry3<f64>,
    /// Largest joint speeds \[rad/s\], where known.
    pub speeds: Option<Vec<f64>>,
    /// The maker that the description names. Its pendant may count angles otherwise.
    pub maker: Option<Controller>,
}

impl DhRobot {
    /// C as the maker's pendant probably has it (see [`Robot::level_forearm`]) where the
    /// description does not: the maker couples joint 3 to joint 2, or the description counts joint 3
    /// against joint 2, as those of such arms do.
    ///
    /// # Errors
    /// As [`robot`](Self::robot).
    pub fn suspected_coupling(&self) -> Result<Option<DMatrix<f64>>> {
        let level = self.robot()?.level_forearm();
        // Where both count the same way the entry has the sign of joint 3 against joint 2 in −C.
        let against = |c: &DMatrix<f64>| c[(2, 1)] * c[(2, 2)] > 0.0;
        Ok(level.filter(|c| match self.maker {
            Some(Controller::Kuka) => false,
            // Of ABB's the arms with a parallelogram.
            Some(maker) if maker.couples_joint_3() || maker == Controller::Abb => true,
            _ => against(c),
        }))
    }

    /// The chain.
    ///
    /// # Errors
    /// No rows, numbers that are not finite, limits the wrong way round, names
    /// that appear twice, a singular C, lists of the wrong length.
    pub fn robot(&self) -> Result<Robot> {
        let mut robot = Robot::from_dh(self.name.as_str(), self.convention, &self.rows, self.base)?
            .with_flange(&self.flange)
            .with_joint_names(&self.joint_names)?
            .with_coupling(self.coupling.clone())?;
        if !self.tilts.is_empty() {
            robot = robot.with_tilts(&self.tilts)?;
        }
        match &self.limits {
            Some(limits) => robot.with_limits(limits),
            None => Ok(robot),
        }
    }
}
