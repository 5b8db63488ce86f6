//! How far the robot bends at work, and what to command instead.

mod at_work;
mod beyond_data;
mod never_loaded;

pub mod along;
pub mod compensate;
pub mod compensated;
pub mod features;
pub mod judged;
pub mod map;
pub mod mapped;
pub mod placed;
pub mod posture_path;
pub mod predict;
pub mod predicted;
pub mod region;
