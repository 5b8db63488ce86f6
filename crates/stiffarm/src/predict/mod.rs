//! How far the robot bends at work, and how sure that is.

mod predictor;

pub use predictor::{FittedNoise, Predictor, Spread};
