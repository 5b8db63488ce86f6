//! Force sensor and tracker, and the uncertainty of errors of the whole experiment.

use crate::error::{Error, Result};
use crate::model::kinematics::Frames;
use crate::model::load::Wrench;
use nalgebra::{Isometry3, Matrix3, Vector3};

/// What a force sensor is fixed to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mount {
    /// Between flange and tool: it turns with the flange.
    Flange,
    /// In the cell, for example at the rope's anchor or under the fixture.
    Base,
}

/// A force sensor: where it sits and which way it counts.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// What it is fixed to.
    pub mount: Mount,
    /// Its frame in flange axes or in the base frame \[m\].
    pub pose: Isometry3<f64>,
    /// True where it reports the wrench *by* the robot on its surroundings;
    /// false where it reports the wrench *on* the robot.
    pub reports_by_robot: bool,
    /// The axis (0 to 2) along and about which it counts the other way, where its axes are left-handed.
    pub mirrored: Option<usize>,
}

impl Sensor {
    /// A reading in sensor axes about the sensor's origin as the wrench on the
    /// robot at the base-frame point `at`, base axes.
    pub fn wrench_on_robot(&self, frames: &Frames, reading: &Wrench, at: &Vector3<f64>) -> Wrench {
        let pose = match self.mount {
            Mount::Flange => frames.flange() * self.pose,
            Mount::Base => self.pose,
        };
        let sign = if self.reports_by_robot { -1.0 } else { 1.0 };
        let turned = reading.map(|v| pose.rotation * self.right_handed(*v) * sign);
        turned.moved(&pose.translation.vector, at)
    }

    /// A force or moment as the sensor counts it in right-handed axes, and back.
    pub(crate) fn right_handed(&self, mut vector: Vector3<f64>) -> Vector3<f64> {
        if let Some(axis) = self.mirrored {
            vector[axis] = -vector[axis];
        }
        vector
    }
}

/// Accuracy of a tracker's reading: a range part and an angular part that
/// grows with the distance from the station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackerAccuracy {
    /// Station in tracker axes \[m\].
    pub station: Vector3<f64>,
    /// Standard deviation along the beam, constant part \[m\].
    pub range: f64,
    /// Standard deviation along the beam per metre of distance \[m/m\].
    pub range_per_metre: f64,
    /// Standard deviation of each of the two angles \[rad\].
    pub angle: f64,
}

impl TrackerAccuracy {
    /// Covariance of one reading at `position`, tracker axes \[m²\].
    ///
    /// # Errors
    /// The position is the station itself.
    pub fn covariance(&self, position: &Vector3<f64>) -> Result<Matrix3<f64>> {
        let beam = position - self.station;
        let distance = beam.norm();
        let along = beam
            .try_normalize(1e-6)
            .ok_or_else(|| Error::invalid("A reading lies at the tracker's station itself."))?;
        let projector = along * along.transpose();
        let range = self.range + self.range_per_metre * distance;
        let across = self.angle * distance;
        Ok(projector * range.powi(2) + (Matrix3::identity() - projector) * across.powi(2))
    }
}

/// The tracker, as far as the cell knows it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tracker {
    /// Base frame from tracker frame, where the readings' frame is known
    /// beforehand \[m\]; the identity where the software already gives base axes.
    pub base_from_tracker: Option<Isometry3<f64>>,
    /// Accuracy of its readings, where known.
    pub accuracy: Option<TrackerAccuracy>,
}

/// Standard uncertainty of errors common to the whole experiment, before the readings
/// say what they can; `None` where the cell says nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Uncertainty {
    /// Scale of the force (fraction).
    pub force_scale: Option<f64>,
    /// Each coordinate of the rope's anchor \[m\].
    pub anchor: Option<f64>,
    /// Each coordinate of the loading point \[m\].
    pub loading_point: Option<f64>,
    /// Each axis of the turn from tracker to base \[rad\].
    pub registration: Option<f64>,
    /// Compliance of the base about each of its horizontal axes that nobody
    /// models \[rad/(N·m)\].
    pub base_tilt_compliance: Option<f64>,
    /// Compliance about each axis between flange and reflectors that nobody
    /// models \[rad/(N·m)\].
    pub sensor_compliance: Option<f64>,
    /// Each component of a constant force beside the load, of what hangs on the rope \[N\].
    pub force_beside: Option<f64>,
    /// Each component of a displacement that all loaded readings share \[m\].
    pub common_shift: Option<f64>,
    /// Lost motion of each joint: half the gap \[rad\].
    pub lost_motion: Option<f64>,
}
