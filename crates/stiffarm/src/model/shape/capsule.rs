//! Capsules.

use crate::error::{Error, Result};
use nalgebra::{Isometry3, Vector3};

/// All points within `radius` of the segment from `a` to `b` \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    /// One end of the segment.
    pub a: Vector3<f64>,
    /// Its other end; a sphere where both are one point.
    pub b: Vector3<f64>,
    /// The radius.
    pub radius: f64,
}

impl Capsule {
    /// A capsule around the segment from `a` to `b` \[m\].
    ///
    /// # Errors
    /// A number that is not finite, or a radius that is not above zero.
    pub fn new(a: Vector3<f64>, b: Vector3<f64>, radius: f64) -> Result<Self> {
        if a.iter().chain(b.iter()).any(|v| !v.is_finite()) || !(radius.is_finite() && radius > 0.0) {
            return Err(Error::invalid("A capsule needs two finite end points and a radius above zero."));
        }
        Ok(Capsule { a, b, radius })
    }

    /// The same capsule seen from the frame in which its own frame lies at `pose`.
    #[must_use]
    pub fn placed(&self, pose: &Isometry3<f64>) -> Self {
        let place = |p: &Vector3<f64>| pose.rotation * p + pose.translation.vector;
        Capsule { a: place(&self.a), b: place(&self.b), radius: self.radius }
    }

    /// How far a point is outside the capsule, negative inside \[m\].
    pub fn distance_to(&self, point: &Vector3<f64>) -> f64 {
        let along = self.b - self.a;
        let length = along.norm_squared();
        let t = if length > 0.0 { ((point - self.a).dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
        (point - self.a - along * t).norm() - self.radius
    }

    /// Volume \[m³\].
    pub fn volume(&self) -> f64 {
        let r2 = self.radius * self.radius * std::f64::consts::PI;
        r2 * (self.b - self.a).norm() + r2 * self.radius * 4.0 / 3.0
    }
}
