//! The side to which the load turns joints, from which each posture may be reached.

use super::Cell;
use crate::error::Result;
use crate::model::load::Load;
use crate::model::observation::PostureTerms;

/// Torques below this part of the largest may have either sign, by a few millimetres of anchor or loading point, and
/// friction holds the joint: it has no side and needs none.
const TURNED: f64 = 1e-2;

impl Cell {
    /// For each joint the side to which the loads of the cell turn it at the posture `q` (controller angles, rad), 1 or
    /// −1; 0 where they hardly turn it, `None` where two turn it to different sides or nothing says what acts.
    ///
    /// # Errors
    /// Angles that do not fit the robot; a rope without a direction.
    pub fn sides_of_load(&self, q: &[f64]) -> Result<Vec<Option<f64>>> {
        let mut sides = vec![Some(0.0); self.setup.robot.joint_count()];
        for setup in self.setup.cases() {
            if matches!(setup.load, Load::Measured) {
                return Ok(vec![None; sides.len()]);
            }
            let terms = PostureTerms::new(&setup, q, None)?;
            let torque = terms.torque().iter();
            let most = torque.clone().fold(0.0, |most: f64, t| most.max(t.abs()));
            for (side, torque) in sides.iter_mut().zip(torque) {
                if torque.abs() > TURNED * most {
                    let sign = torque.signum();
                    *side = side.filter(|earlier| earlier * sign >= 0.0).map(|_| sign);
                }
            }
        }
        Ok(sides)
    }
}
