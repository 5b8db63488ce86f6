//! Which postures may hold the tip at a pose.

use super::status::Status;
use crate::error::Result;
use crate::findings::length;
use crate::model::cell::Cell;
use crate::model::inverse::{InverseKinematics, Outcome};
use crate::work::at_work::AtWork;
use crate::work::predict::LoadedArm;
use nalgebra::Isometry3;

/// Deflections that differ by less than this share are equal: the two postures
/// of a wrist bend alike but for rounding.
const EQUAL_DEFLECTIONS: f64 = 1e-9;

/// The better of two: what bends less, of equals what is farther from the limits.
pub(super) fn is_better(size: f64, strain: f64, than: (f64, f64)) -> bool {
    let (least, least_strain) = than;
    if (size - least).abs() <= EQUAL_DEFLECTIONS * least { strain < least_strain } else { size < least }
}

/// The first value that is the smallest but for rounding.
pub(super) fn first_smallest(values: impl Iterator<Item = (usize, f64)> + Clone) -> Option<usize> {
    let least = values.clone().map(|(_, v)| v).fold(f64::INFINITY, f64::min);
    let mut values = values;
    let smallest = values.find(|(_, v)| v - least <= EQUAL_DEFLECTIONS * least.abs());
    smallest.map(|(i, _)| i)
}

/// Why a posture, or a pose, is not allowed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Refusal {
    pub status: Status,
    /// The sentence's part after "because".
    pub reason: String,
    /// How far: metres of an unreachable or forbidden pose.
    pub distance: Option<f64>,
    /// Of several refusals the one that lacks least is told.
    excess: f64,
}

impl Refusal {
    /// The nearer miss of two: what comes closest to being allowed.
    pub(super) fn nearer(self, other: Option<Refusal>) -> Refusal {
        match other {
            Some(other) if other.rank() <= self.rank() => other,
            _ => self,
        }
    }

    /// Forbidden postures exist and are within their bounds; those outside at least exist.
    fn rank(&self) -> (u8, f64) {
        let kind = match self.status {
            Status::Reachable => 0,
            Status::Forbidden => 1,
            Status::OutsideJointLimits => 2,
            Status::Discontinuous => 3,
            Status::Unreachable => 4,
            Status::NotComputed => 5,
        };
        (kind, self.excess)
    }

    /// A path that no branch goes along.
    pub(super) fn discontinuous() -> Self {
        Refusal {
            status: Status::Discontinuous,
            reason: "the posture cannot be followed: a singular posture, or another branch, lies between".to_string(),
            distance: None,
            excess: 0.0,
        }
    }
}

/// The arm with everything that forbids a posture.
pub(super) struct Reach<'a> {
    pub arm: &'a LoadedArm,
    pub inverse: InverseKinematics,
    pub characteristic_length: Option<f64>,
    flange_in_tip: Isometry3<f64>,
}

impl<'a> Reach<'a> {
    pub(super) fn new(cell: &Cell, arm: &'a LoadedArm) -> Self {
        Reach {
            arm,
            inverse: InverseKinematics::new(arm.at_work().robot()),
            characteristic_length: cell.characteristic_length,
            flange_in_tip: arm.tip().inverse(),
        }
    }

    /// Pose of the flange with the tip at `tip`, base frame.
    pub(super) fn flange(&self, tip: &Isometry3<f64>) -> Isometry3<f64> {
        tip * self.flange_in_tip
    }

    /// The postures with the tip at `tip`, within their bounds or not, or
    /// why there are none.
    pub(super) fn postures(&self, tip: &Isometry3<f64>) -> Result<std::result::Result<Vec<Vec<f64>>, Refusal>> {
        Ok(match self.inverse.solve(&self.flange(tip))? {
            Outcome::Reachable(branches) => Ok(branches.into_iter().map(|b| b.q).collect()),
            Outcome::Unreachable(away) => Err(Refusal {
                status: Status::Unreachable,
                reason: if away.rotation_rad > 0.0 {
                    "the arm does not reach this orientation".to_string()
                } else {
                    format!("{} out of the arm's reach", length(away.distance_m))
                },
                distance: Some(away.distance_m),
                excess: away.distance_m,
            }),
        })
    }

    /// Why the posture `q` is not allowed, if it is not.
    pub(super) fn refusal(&self, q: &[f64]) -> Result<Option<Refusal>> {
        match self.outside(q) {
            Some(refusal) => Ok(Some(refusal)),
            None => self.forbidden(q),
        }
    }

    /// How near `q` comes to its bounds: 0 in their middle, 1 at them.
    pub(super) fn strain(&self, q: &[f64]) -> f64 {
        let joints = self.inverse.robot().joints().iter();
        let share = joints.zip(q).map(|(joint, q)| {
            let [low, high] = joint.limits;
            let half = 0.5 * (high - low);
            if half.is_finite() && half > 0.0 { (q - 0.5 * (low + high)).abs() / half } else { 0.0 }
        });
        share.fold(0.0, f64::max)
    }

    /// The joint that leaves its bounds most.
    pub(super) fn outside(&self, q: &[f64]) -> Option<Refusal> {
        let at_work = self.arm.at_work();
        let outside = at_work.outside(q)?;
        Some(Refusal {
            status: Status::OutsideJointLimits,
            reason: at_work.outside_words(outside),
            distance: None,
            excess: outside.1,
        })
    }

    /// The cell's limit that is violated most.
    pub(super) fn forbidden(&self, q: &[f64]) -> Result<Option<Refusal>> {
        Ok(self.arm.at_work().violated(q)?.map(|violated| Refusal {
            status: Status::Forbidden,
            reason: AtWork::words(&violated),
            distance: Some(-violated.margin),
            excess: -violated.margin,
        }))
    }
}
