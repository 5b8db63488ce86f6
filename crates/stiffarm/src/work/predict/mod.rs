//! How far the robot bends at work, and how sure that is.

mod arm;
mod band;
mod cartesian;
mod points;

pub use arm::{ArmAtWork, Bent};
pub use band::TipBand;
pub use cartesian::{CartesianStiffness, PrincipalAxis};
pub use points::{LoadPoint, PointPrediction, PredictOptions, Prediction, predict};

pub(crate) use arm::motion;
pub(crate) use band::Bands;
pub(crate) use cartesian::principal_axes;
