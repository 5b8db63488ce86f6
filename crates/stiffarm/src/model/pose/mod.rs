//! Poses as pendants show them: orientations in the makers' conventions, and
//! the configuration of an arm in words.
//!
//! A pendant counts poses from its controller's base frame
//! ([`Robot::controller_base`](crate::model::robot::Robot::controller_base)),
//! which need not be the robot's own.

mod configuration;
mod convention;
mod held;

pub use configuration::{Configuration, Elbow, Shoulder, Wrist, kuka_status, kuka_turn};
pub use convention::Convention;
pub use held::{HeldPosture, held_postures};

use nalgebra::Isometry3;

/// A pose with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedPose {
    /// Its name.
    pub name: String,
    /// The pose, in the frame that the table means \[m\].
    pub pose: Isometry3<f64>,
}
