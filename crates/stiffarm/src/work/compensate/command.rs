//! The command of one point.
//!
//! The command from its end. The loaded tip is right when the loaded joints
//! stand at the nominal posture, so the command follows in one step from the
//! load there; iterating the mirror correction converges to the same (a test
//! does it). Only what gives way beyond the joints needs Newton steps. The
//! check is the equilibrium from the command's side, which knows nothing of
//! this.

use crate::error::{Code, Error, Result};
use crate::model::dexterity::{ELIMINATION_CONDITION, inverted};
use crate::model::load::Wrench;
use crate::model::observation::PostureTerms;
use crate::numerics::information::svd::svd;
use crate::work::predict::{LoadedArm, motion};
use nalgebra::{DMatrix, DVector, Isometry3};

/// A tip this near to its pose is there \[m, rad\].
const ARRIVED_DISTANCE: f64 = 1e-13;
/// Steps to a pose that a neighbour of the nominal one takes three of.
const STEPS: usize = 50;
/// The inverse of J stands as long as a step leaves no more than this share.
const AS_BEFORE: f64 = 0.1;
/// Singular values of J below this share of the largest are directions in
/// which the arm cannot move.
const IMMOVABLE_SHARE: f64 = 1e-9;

/// A command and the state it leads to.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// Controller angles \[rad\].
    pub q: Vec<f64>,
    /// Nominal tip pose, base frame \[m\].
    pub nominal: Isometry3<f64>,
    /// Tip pose of the command without load.
    pub unloaded: Isometry3<f64>,
    /// Tip pose under load by the equilibrium from the command.
    pub loaded: Isometry3<f64>,
}

/// The command that brings the loaded tip to where `nominal` (controller
/// angles, rad) has it without load.
///
/// # Errors
/// Angles of the wrong number or not finite; a coupling that cannot be undone;
/// a load that buckles the arm, or bends what is not determined; a posture in which the
/// arm cannot make up for what gives way beyond its joints.
pub fn command(arm: &LoadedArm, nominal: &[f64], wrench: &Wrench) -> Result<Command> {
    command_in(arm, nominal, wrench, &mut arm.memory())
}

/// The same in the memory of `terms`.
///
/// # Errors
/// As [`command`].
pub(super) fn command_in(
    arm: &LoadedArm,
    nominal: &[f64],
    wrench: &Wrench,
    terms: &mut PostureTerms,
) -> Result<Command> {
    let robot = arm.robot();
    arm.stand_at(nominal, wrench, terms)?;
    let target = terms.frames().flange() * arm.tip();
    let mut theta = robot.serial_angles(nominal);
    if arm.has_more_than_joints() {
        reach(arm, &mut theta, terms, wrench, &target)?;
    }
    // θ_command = θ_loaded − K_θ⁻¹ Γ(θ_loaded)
    let give = arm.compliance() * DVector::from_column_slice(terms.torque());
    let q = robot
        .controller_angles(&(theta - give))
        .ok_or_else(|| Error::new(Code::Internal, "The coupling of the robot cannot be undone."))?;
    let q: Vec<f64> = q.iter().copied().collect();
    let bent = arm.deflect_in(&q, wrench, terms)?;
    Ok(Command { q, nominal: target, unloaded: bent.before, loaded: bent.after })
}

/// Moves the joints until the loaded tip, with all that gives way beyond them,
/// is at `target`.
fn reach(
    arm: &LoadedArm,
    theta: &mut DVector<f64>,
    terms: &mut PostureTerms,
    wrench: &Wrench,
    target: &Isometry3<f64>,
) -> Result<()> {
    let mut last = f64::INFINITY;
    let mut inverse = None;
    for _ in 0..STEPS {
        let error = motion(&arm.loaded_tip(terms), target);
        let size = error.amax();
        // Rounding lets it stall a little above the aim.
        if size <= ARRIVED_DISTANCE || (size < 1e-9 && size >= 0.5 * last) {
            return Ok(());
        }
        // Small steps hardly change the Jacobian.
        if size > AS_BEFORE * last {
            inverse = None;
        }
        last = size;
        let inverse = match &mut inverse {
            Some(inverse) => inverse,
            none => none.insert(inverse_jacobian(terms)?),
        };
        *theta += &*inverse * error;
        arm.move_to(theta, terms, wrench)?;
    }
    let message = "This posture is singular, and the arm cannot make up for what gives way beyond its joints.";
    Err(Error::invalid(message)
        .hint("choose another posture for this point, or leave the turn about the tool axis free"))
}

/// Least joint motion whose twist at the tip is nearest to a given one, joints × 6.
fn inverse_jacobian(terms: &PostureTerms) -> Result<DMatrix<f64>> {
    let jacobian = terms.frames().jacobian(&terms.measuring_points()[0]);
    let n = jacobian.ncols();
    if n == 6
        && let (..ELIMINATION_CONDITION, Some(inverse)) = inverted(jacobian.fixed_columns::<6>(0).into_owned())
    {
        return Ok(DMatrix::from_column_slice(6, 6, inverse.as_slice()));
    }
    // Jᵀ has at least as many rows as columns for n ≥ 6, J for n ≤ 6.
    let wide = n > 6;
    let matrix: DMatrix<f64> = if wide {
        jacobian.transpose().clone_owned().resize(n, 6, 0.0)
    } else {
        DMatrix::from_fn(6, n, |i, j| jacobian[(i, j)])
    };
    let parts = svd(matrix).ok_or_else(|| Error::new(Code::Numerical, "The Jacobian could not be decomposed."))?;
    let (from, to) = if wide { (&parts.v, &parts.u) } else { (&parts.u, &parts.v) };
    let mut along = from.transpose();
    for (mut row, value) in along.row_iter_mut().zip(parts.values.iter()) {
        row *= if *value > IMMOVABLE_SHARE * parts.values[0] { 1.0 / value } else { 0.0 };
    }
    Ok(to * along)
}
