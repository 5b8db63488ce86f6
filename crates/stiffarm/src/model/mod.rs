//! What is known before anything is measured: the robot, its tool and load, the
//! cell around them, and how they bend.

pub mod cell;
pub mod dexterity;
pub mod elastic;
pub mod implausible;
pub mod instruments;
pub mod inverse;
pub mod kinematics;
pub mod limit;
pub mod load;
pub mod load_log;
pub mod measurement;
pub mod observation;
pub mod path;
pub mod pose;
pub mod posture;
pub mod process;
pub mod robot;
pub mod route;
pub mod scene;
pub mod shape;
pub mod stiffness;
pub mod tool;
pub mod work;
