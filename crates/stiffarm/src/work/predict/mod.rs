//! How far the robot bends at work, and how sure that is.

mod band;
mod cartesian;
mod loaded_arm;
mod points;
mod table;

pub use band::TipBand;
pub use cartesian::{CartesianStiffness, PathExtremes, PointStiffness, PrincipalAxis};
pub use loaded_arm::{Deflection, LoadedArm};
pub(crate) use points::predict_on;
pub use points::{LoadPoint, PointPrediction, PredictOptions, Prediction, predict};
pub use table::{POINT_COLUMNS, PointColumn, PointMeasure};

pub(crate) use band::{Bands, with_bands};
pub(crate) use cartesian::principal_axes;
pub(crate) use loaded_arm::motion;
