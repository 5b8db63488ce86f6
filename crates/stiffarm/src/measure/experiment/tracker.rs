//! A simulated tracker: noise and drift of its readings.

use super::{Experiment, TrackerNoise};
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::instruments::TrackerAccuracy;
use crate::model::measurement::{Reading, ReadingTarget};
use crate::model::scene::Station;
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// The stations of a cell that has several, each set up by hand in axes of its own.
pub(super) fn set_up(cell: &Cell) -> Vec<(String, Isometry3<f64>)> {
    let sight = cell.scene.sight().filter(|sight| sight.stations.len() > 1);
    let stations = sight.iter().flat_map(|sight| &sight.stations);
    let set_up = |(number, station): (usize, &Station)| {
        let turn = UnitQuaternion::from_euler_angles(0.02, -0.03, 2.4 - 1.1 * number as f64);
        let frame = Isometry3::from_parts(Translation3::from(station.position), turn);
        (station.name.clone(), frame)
    };
    stations.enumerate().map(set_up).collect()
}

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
    pub fn read(&mut self, target: ReadingTarget, in_base: &Vector3<f64>, rng: &mut ChaCha8Rng) -> Result<Reading> {
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
        Ok(Reading { time, ..Reading::new(target, position) })
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
