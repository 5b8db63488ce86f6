//! A simulated tracker: noise and drift of its readings.

use super::{Experiment, TrackerNoise};
use crate::error::Result;
use crate::model::instruments::TrackerAccuracy;
use crate::model::measurement::{Reading, ReadingTarget};
use nalgebra::{Isometry3, Matrix3, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Takes readings one after the other.
pub(super) struct SimulatedTracker<'a> {
    pub options: &'a Experiment,
    pub tracker_from_base: Isometry3<f64>,
    /// Standard deviation along each axis \[m\].
    pub noise: f64,
    pub accuracy: Option<&'a TrackerAccuracy>,
    pub time: f64,
}

impl SimulatedTracker<'_> {
    pub fn read(
        &mut self,
        target: ReadingTarget,
        in_base: &Vector3<f64>,
        rng: &mut ChaCha8Rng,
    ) -> Result<Reading> {
        let mut position = self.tracker_from_base.rotation * in_base
            + self.tracker_from_base.translation.vector
            + self.options.drift * self.time;
        if self.options.tracker_noise != TrackerNoise::None {
            let draw = normal3(rng);
            position += match self.accuracy {
                None => draw * self.noise,
                Some(accuracy) => root(&accuracy.covariance(&position)?) * draw,
            };
        }
        let time = (self.options.seconds_per_reading > 0.0).then_some(self.time);
        self.time += self.options.seconds_per_reading;
        Ok(Reading {
            target,
            position,
            time,
            expanded: None,
            temperature: None,
            line: 0,
        })
    }
}

/// Lower factor L of a covariance LLᵀ that may be singular.
fn root(covariance: &Matrix3<f64>) -> Matrix3<f64> {
    let mut lower = Matrix3::zeros();
    for j in 0..3 {
        for i in j..3 {
            let mut sum = covariance[(i, j)];
            for k in 0..j {
                sum -= lower[(i, k)] * lower[(j, k)];
            }
            lower[(i, j)] = if i == j {
                sum.max(0.0).sqrt()
            } else if lower[(j, j)] > 0.0 {
                sum / lower[(j, j)]
            } else {
                0.0
            };
        }
    }
    lower
}

pub(super) fn normal3(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| StandardNormal.sample(rng))
}
