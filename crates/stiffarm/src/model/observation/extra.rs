//! Further elastic elements beside the joint axes, as more columns of Ψ: tilt
//! of a joint about its two other axes, tilt of the base, and lost motion.
//!
//! A virtual spring that is equally soft about all axes perpendicular to `a`
//! and sits at the point o turns by h·m⊥ under the moment m about o, where m⊥
//! is the part of m perpendicular to a. So its column at the point p is
//! m⊥ × (p − o), whatever pair of perpendicular axes one has in mind.

use super::PostureTerms;
use crate::error::{Code, Error, Result, did_you_mean};
use crate::model::robot::Robot;
use nalgebra::{DVector, Vector3, Vector6};
use serde::{Deserialize, Serialize};

/// One further unknown of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ExtraTerm {
    /// Tilt of joint `j` (counted from 0) about the axes perpendicular to its
    /// own, equally soft about both, at the origin of its frame; unknown: a
    /// compliance \[rad/(N·m)\].
    JointTilt(usize),
    /// Tilt of the base about the axes perpendicular to axis 1, at the point
    /// of axis 1 nearest the base frame's origin; unknown: a compliance \[rad/(N·m)\].
    BaseTilt,
    /// Lost motion of joint `j` (counted from 0): it gives way by a constant
    /// angle in the direction of its torque; unknown: that angle \[rad\].
    LostMotion(usize),
}

impl ExtraTerm {
    /// Name in tables: `tilt of joint 3`, `tilt of the base`, `lost motion of joint 2`.
    pub fn name(self, robot: &Robot) -> String {
        let joint = |j: usize| robot.joints().get(j).map_or("?", |joint| &joint.name);
        match self {
            ExtraTerm::JointTilt(j) => format!("tilt of {}", joint(j)),
            ExtraTerm::BaseTilt => "tilt of the base".to_string(),
            ExtraTerm::LostMotion(j) => format!("lost motion of {}", joint(j)),
        }
    }

    /// True for an elastic element, false for lost motion.
    pub fn is_spring(self) -> bool {
        !matches!(self, ExtraTerm::LostMotion(_))
    }

    /// The joint it belongs to, counted from 0.
    pub fn joint(self) -> Option<usize> {
        match self {
            ExtraTerm::JointTilt(j) | ExtraTerm::LostMotion(j) => Some(j),
            ExtraTerm::BaseTilt => None,
        }
    }

    /// The terms that `word` names: `tilt` (all joints), `tilt3`, `base`,
    /// `lost` (all joints), `lost2`; joints count from 1.
    ///
    /// # Errors
    /// Another word, or a joint that the robot does not have.
    pub fn parse(word: &str, robot: &Robot) -> Result<Vec<ExtraTerm>> {
        let n = robot.joint_count();
        let unknown = || {
            let known = ["tilt", "tilt1", "base", "lost", "lost1"];
            Error::new(
                Code::UnknownName,
                format!("There is no further term \"{word}\"."),
            )
            .hint(did_you_mean(word, known).unwrap_or_else(|| {
                "terms: tilt (all joints), tilt1 … of one joint, base, lost (all joints), lost1 …"
                    .to_string()
            }))
        };
        type Make = fn(usize) -> ExtraTerm;
        let families: [(&str, Make); 2] = [
            ("tilt", ExtraTerm::JointTilt),
            ("lost", ExtraTerm::LostMotion),
        ];
        if word == "base" {
            return Ok(vec![ExtraTerm::BaseTilt]);
        }
        for (family, make) in families {
            let Some(rest) = word.strip_prefix(family) else {
                continue;
            };
            if rest.is_empty() {
                return Ok((0..n).map(make).collect());
            }
            let number: usize = rest.parse().map_err(|_| unknown())?;
            if !(1..=n).contains(&number) {
                return Err(Error::new(
                    Code::UnknownName,
                    format!("{} has no joint {number}.", robot.name()),
                )
                .hint(format!("joints are counted from 1 to {n}")));
            }
            return Ok(vec![make(number - 1)]);
        }
        Err(unknown())
    }

    /// Column of this term at the measuring points, 3m: \[m·N·m/rad\] for a
    /// spring, \[m/rad\] for lost motion.
    ///
    /// # Panics
    /// If the term names a joint that the robot does not have.
    pub fn column(self, terms: &PostureTerms) -> DVector<f64> {
        let points = terms.measuring_points();
        let (turn, origin) = self.turn(terms);
        let rows = points
            .iter()
            .flat_map(|p| turn.cross(&(p - origin)).data.0[0]);
        DVector::from_iterator(3 * points.len(), rows)
    }

    /// What one unit of this term does to the base-frame point `at`:
    /// \[shift (m); turn (rad)\], base axes.
    ///
    /// # Panics
    /// If the term names a joint that the robot does not have.
    pub fn twist(self, terms: &PostureTerms, at: &Vector3<f64>) -> Vector6<f64> {
        let (turn, origin) = self.turn(terms);
        let shift = turn.cross(&(at - origin));
        Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
    }

    /// Turn per unit of this term, and a point on its axis.
    fn turn(self, terms: &PostureTerms) -> (Vector3<f64>, Vector3<f64>) {
        let frames = terms.frames();
        let tilt = |axis: Vector3<f64>, origin: Vector3<f64>| {
            let moment = terms.wrench().moved(terms.loading_point(), &origin).moment;
            (moment - axis * axis.dot(&moment), origin)
        };
        match self {
            ExtraTerm::JointTilt(j) => tilt(frames.axes()[j], frames.origins()[j]),
            ExtraTerm::BaseTilt => {
                let (axis, origin) = (frames.axes()[0], frames.origins()[0]);
                tilt(axis, origin - axis * axis.dot(&origin))
            }
            ExtraTerm::LostMotion(j) => {
                // Without torque the joint may rest anywhere in its gap.
                let torque = terms.torque()[j];
                let sign = if torque == 0.0 { 0.0 } else { torque.signum() };
                (frames.axes()[j] * sign, frames.origins()[j])
            }
        }
    }
}
