//! How far the robot bends at work, and what to command instead.

mod at_work;
mod beyond_data;
pub(crate) mod never_loaded;

pub mod compensate;
pub mod features;
pub mod map;
pub mod posture_path;
pub mod predict;
pub mod tasks;
