//! Friction of the gears, from loads that go up and down.

use super::{ClampedPosture, LoopClosure, give_per_spring};
use crate::error::{Error, Result};
use crate::estimate::identify::{MeasuredSystem, rms};
use crate::model::cell::Cell;
use crate::model::observation::PostureTerms;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};

/// What loads going up and down differ by at one joint (spring).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointFriction {
    /// Joint.
    pub joint: String,
    /// Pairs of states behind it.
    pub pairs: usize,
    /// Half of the loop between up and down, less what the wrenches differ by:
    /// RMS over the pairs \[rad\]. The noise of the angles is in it.
    pub half_loop_rad: f64,
    /// The same as a torque, half loop · k \[N·m\]; `None` without a positive stiffness.
    pub torque_nm: Option<f64>,
    /// RMS of the joint's torque in these states \[N·m\].
    pub load_rms_nm: f64,
}

/// States `up…` and `down…` of one posture with the same end of the name.
fn pairs(clamped: &[ClampedPosture]) -> Vec<(usize, usize)> {
    let mut taken = vec![false; clamped.len()];
    let mut out = Vec::new();
    for (up, a) in clamped.iter().enumerate() {
        let Some(load) = a.state.strip_prefix("up") else {
            continue;
        };
        let down = clamped.iter().enumerate().find(|(i, b)| {
            !taken[*i] && b.posture.name == a.posture.name && b.state.strip_prefix("down") == Some(load)
        });
        if let Some((down, _)) = down {
            taken[down] = true;
            out.push((up, down));
        }
    }
    out
}

/// Friction joint by joint; empty where no posture was loaded up and down.
pub(super) fn friction(
    cell: &Cell,
    clamped: &[ClampedPosture],
    closures: &[LoopClosure],
    system: &MeasuredSystem,
    values: &DVector<f64>,
) -> Result<Vec<JointFriction>> {
    let pairs = pairs(clamped);
    if pairs.is_empty() {
        return Ok(Vec::new());
    }
    let robot = &cell.setup.robot;
    let springs = system.springs;
    // From controller angles to turns of the springs: E C.
    let turn = give_per_spring(robot)?.try_inverse();
    let turn = turn.ok_or_else(|| Error::invalid("C or E is singular."))?;
    let residual = &system.delta - &system.psi * values;
    let gap = |m: usize| {
        let label = system.labels.iter().find(|label| label.measured == m);
        let rows = label.map_or(0..0, |label| label.rows.clone());
        &turn * &closures[m].directions * residual.rows(rows.start, rows.len())
    };
    let mut halves = vec![Vec::new(); springs];
    let mut loads = vec![Vec::new(); springs];
    for (up, down) in &pairs {
        let half = (gap(*up) - gap(*down)) * 0.5;
        for state in [up, down] {
            let c = &clamped[*state];
            let terms = PostureTerms::new(&cell.setup, &c.posture.q, Some(&c.wrench))?;
            for (j, load) in terms.spring_loads(robot).iter().enumerate() {
                loads[j].push(*load);
            }
        }
        for (j, value) in half.iter().enumerate() {
            halves[j].push(*value);
        }
    }
    Ok((0..springs)
        .map(|j| {
            let half_loop_rad = rms(&halves[j]);
            JointFriction {
                joint: system.unknowns[j].clone(),
                pairs: pairs.len(),
                half_loop_rad,
                torque_nm: (values[j] > 0.0).then(|| half_loop_rad / values[j]),
                load_rms_nm: rms(&loads[j]),
            }
        })
        .collect())
}
