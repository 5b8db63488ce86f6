//! The side to which the load turns joints, from which each posture may be reached.

use super::Cell;
use crate::error::Result;
use crate::model::load::Load;
use crate::model::observation::PostureTerms;

/// Torques below this part of the largest may have either sign, by a few millimetres of anchor or loading point: such a
/// joint has no side.
const TURNED: f64 = 1e-2;

impl Cell {
    /// For each joint the side to which the loads of the cell turn it at the posture `q` (controller angles, rad), 1 or
    /// −1; 0 where they do not, where two differ or where nothing says what acts.
    ///
    /// # Errors
    /// Angles that do not fit the robot; a rope without a direction.
    pub fn sides_of_load(&self, q: &[f64]) -> Result<Vec<f64>> {
        let mut sides: Option<Vec<f64>> = None;
        for setup in self.setup.cases() {
            if matches!(setup.load, Load::Measured) {
                return Ok(vec![0.0; self.setup.robot.joint_count()]);
            }
            let terms = PostureTerms::new(&setup, q, None)?;
            let torque = terms.torque().iter();
            let most = torque.clone().fold(0.0, |most: f64, t| most.max(t.abs()));
            let side = |t: &f64| {
                if t.abs() > TURNED * most {
                    t.signum()
                } else {
                    0.0
                }
            };
            let own: Vec<f64> = torque.map(side).collect();
            sides = Some(match sides {
                None => own,
                Some(all) => {
                    let both = all.iter().zip(&own);
                    both.map(|(a, b)| if a == b { *a } else { 0.0 }).collect()
                }
            });
        }
        Ok(sides.unwrap_or_default())
    }
}
