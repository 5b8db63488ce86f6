//! How far the robot bends at work, and what to command instead.

mod at_work;

pub mod compensate;
pub mod map;
pub mod posture_path;
pub mod predict;
