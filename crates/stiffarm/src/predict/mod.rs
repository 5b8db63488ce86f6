//! How far the robot bends at work, and how sure that is.

mod arm;
mod band;
mod cartesian;
mod points;
mod predictor;

pub use arm::{ArmAtWork, Bent};
pub use band::TipBand;
pub use cartesian::{CartesianStiffness, PrincipalAxis};
pub use points::{LoadPoint, PointPrediction, PredictOptions, Prediction, predict};
pub use predictor::{CommonError, FittedNoise, Predictor, Spread};

pub(crate) use arm::motion;
pub(crate) use band::Bands;
pub(crate) use cartesian::principal_axes;
