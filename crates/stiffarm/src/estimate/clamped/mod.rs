//! Clamped end-effector: the flange is fixed, the motors push, the controller's
//! angles and the wrench of the fixture are read; no tracker is needed.
//!
//! With the flange held, what the motors turn is what the joints give way:
//! J (C Δq_m + K_θ⁻¹ Γ) = t, where Δq_m are the controller's angles loaded minus
//! reference, Γ = Jᵀ W the torques of the wrench W of the fixture *on the robot*,
//! J the Jacobian at the clamp, which is the tool's loading point, and t the
//! twist of the fixture, zero where it is rigid. It is the general form
//! Δ = J^m (C Δq_m + K_θ⁻¹ Γ) of the free end-effector with J^m = J^f = J and
//! Δ = t. For six joints away from singular postures it decouples:
//! C Δq_m = −K_θ⁻¹ Γ.
//!
//! The errors are those of the angles, so that rows are formed in their space:
//! with J C = U S Vᵀ, rank r, the rows are
//! Vᵀ Δq_m + Vᵀ C⁻¹ K_θ⁻¹ Γ = S⁻¹ Uᵀ t, whose errors are independent with the
//! variance of an angle. An arm of seven joints gives six rows; what moves along
//! its null space moves freely and says nothing.
//!
//! Sources: Bennett, Hollerbach & Henri, ICRA 1992 (the idea, for
//! kinematic calibration); Lehmann et al., IFAC Proc. Volumes 46(9), 2013,
//! 813–818 (force sensor); Jubien, Abba & Gautier, ICINCO 2014, 585–591 (also
//! with motor torques alone).
//!
//! Clamped rows live in the space of the angles. J (C Δq_m + K_θ⁻¹ Γ) = t is
//! formed as V_rᵀ-rows of J C = U S Vᵀ, whose errors are independent with the
//! variance of an angle; for six joints they are a rotation of the decoupled
//! form, for seven they leave the null space out, near a singularity the
//! direction that the flange does not hold.

mod friction;
mod identification;
mod options;
mod simulation;

pub use friction::JointFriction;
pub use identification::{ClampedIdentification, ClampedResidual, StateWeight, identify_clamped};
pub use options::without;
pub use simulation::{ClampedSimulation, MotorMove, simulate_clamped};

use crate::error::{Code, Error, Result};
use crate::estimate::identify::{Block, Covariance, MeasuredSystem, RowLabel, by_name, unknowns};
use crate::model::cell::Cell;
use crate::model::kinematics::Frames;
use crate::model::load::Wrench;
use crate::model::observation::{ExtraTerm, PostureTerms, check_angles};
use crate::model::posture::Posture;
use crate::model::robot::Robot;
use crate::numerics::information::{scale_columns, svd};
use nalgebra::{DMatrix, DVector, Vector3, Vector6};

/// Singular values of J C (SI units) below this, relative to the largest, count
/// as zero. Along such a direction a fixture that gives way by a micrometre
/// would pass for a third of a milliradian of the joints.
const SINGULAR: f64 = 1e-3;

/// One load state of a posture with the flange fixed.
#[derive(Debug, Clone, PartialEq)]
pub struct ClampedPosture {
    /// Name and controller angles in the reference state \[rad\].
    pub posture: Posture,
    /// Load state, for example `up-250`, `down-250`.
    pub state: String,
    /// Wrench of the fixture *on the robot* at the loading point, which is the
    /// clamp, base axes, loaded minus reference.
    pub wrench: Wrench,
    /// The wrench that the robot had in the reference already, likewise: a preload; `None` where it was unloaded.
    pub preload: Option<Wrench>,
    /// Δq_m: controller angles loaded minus reference \[rad\].
    pub motor: Vec<f64>,
    /// Number of the reference reading: states of one posture with the same
    /// number share it, and with it half of their variance. `None` where each
    /// Δq_m stands for itself.
    pub reference: Option<u32>,
    /// How the clamp moved nevertheless, loaded minus reference, base axes:
    /// \[shift of the loading point (m); turn (rad)\]; `None` for a rigid fixture.
    pub fixture_motion: Option<Vector6<f64>>,
}

/// What a fixed flange says about the controller's angles at one posture.
pub(crate) struct LoopClosure {
    /// Combinations of angles that the flange holds: orthonormal columns, n × r.
    directions: DMatrix<f64>,
    /// From a twist of the clamp to what the angles in these combinations have
    /// to do for it: S⁻¹ Uᵀ, r × 6 \[rad/m; rad/rad\].
    follow: DMatrix<f64>,
    /// Combinations that a posture near a singularity hides.
    hidden: usize,
}

impl LoopClosure {
    fn new(robot: &Robot, frames: &Frames, clamp: &Vector3<f64>) -> Result<Self> {
        let n = robot.joint_count();
        let jacobian = frames.jacobian(clamp) * robot.coupling();
        // (J C)ᵀ has a row per angle; zero rows let the decomposition take
        // arms of fewer than six joints.
        let tall = DMatrix::from_fn(n.max(6), 6, |j, i| if j < n { jacobian[(i, j)] } else { 0.0 });
        let parts = svd(tall).ok_or_else(|| Error::new(Code::NotFinite, "The Jacobian is not finite."))?;
        let largest = parts.values[0];
        let rank = parts.values.iter().filter(|s| **s > SINGULAR * largest).count();
        let mut follow = parts.v.columns(0, rank).transpose();
        for (i, mut row) in follow.row_iter_mut().enumerate() {
            row.unscale_mut(parts.values[i]);
        }
        Ok(LoopClosure { directions: parts.u.view((0, 0), (n, rank)).into_owned(), follow, hidden: n.min(6) - rank })
    }

    fn rank(&self) -> usize {
        self.directions.ncols()
    }
}

/// Builds Ψ x = Δ of clamped postures: unknowns as with a free end-effector,
/// rows and Δ in radians, one block per posture. Nothing is shared within a
/// posture but the reference reading of its states.
///
/// # Errors
/// No postures, a number that is not finite, a wrong number of angles, or an
/// extra term that appears twice or that the robot cannot have.
pub fn clamped_system(cell: &Cell, clamped: &[ClampedPosture], extra: &[ExtraTerm]) -> Result<MeasuredSystem> {
    let closures = closures(cell, clamped)?;
    system(cell, clamped, extra, &closures)
}

/// The closure of each clamped posture.
fn closures(cell: &Cell, clamped: &[ClampedPosture]) -> Result<Vec<LoopClosure>> {
    if clamped.is_empty() {
        return Err(Error::new(Code::TooFewData, "There are no clamped postures to identify from."));
    }
    let robot = &cell.setup.robot;
    clamped
        .iter()
        .map(|c| {
            check_angles(robot, &c.posture.q)?;
            check_angles(robot, &c.motor)?;
            let numbers = c.wrench.force.iter().chain(c.wrench.moment.iter());
            let motion = c.fixture_motion.iter().flat_map(|t| t.iter());
            if numbers.chain(motion).any(|v| !v.is_finite()) {
                let message =
                    format!("The wrench or the fixture's motion of posture \"{}\" is not finite.", c.posture.name);
                return Err(Error::new(Code::NotFinite, message));
            }
            let frames = Frames::new(robot, &c.posture.q);
            LoopClosure::new(robot, &frames, &frames.point(&cell.setup.tool.loading_point))
        })
        .collect()
}

fn system(
    cell: &Cell,
    clamped: &[ClampedPosture],
    extra: &[ExtraTerm],
    closures: &[LoopClosure],
) -> Result<MeasuredSystem> {
    let robot = &cell.setup.robot;
    let springs = robot.spring_count();
    let unknowns = unknowns(robot, extra)?;
    let rows: usize = closures.iter().map(LoopClosure::rank).sum();
    let mut system = MeasuredSystem {
        psi: DMatrix::zeros(rows, unknowns.len()),
        delta: DVector::zeros(rows),
        unknowns,
        springs,
        extra: extra.to_vec(),
        blocks: Vec::new(),
        labels: Vec::with_capacity(clamped.len()),
    };
    let give = give_per_spring(robot)?;
    let mut at = 0;
    for states in by_name(clamped.iter().map(|c| c.posture.name.as_str())) {
        let from = at;
        for &m in &states {
            let (psi, delta) = rows_of(cell, &clamped[m], extra, &closures[m], &give)?;
            let rows = at..at + psi.nrows();
            system.psi.rows_mut(at, psi.nrows()).copy_from(&psi);
            system.delta.rows_mut(at, psi.nrows()).copy_from(&delta);
            at = rows.end;
            system.labels.push(RowLabel { measured: m, displacement: 0, rows });
        }
        system.blocks.push(Block {
            posture: clamped[states[0]].posture.name.clone(),
            rows: from..at,
            covariance: covariance(clamped, closures, &states),
            shared: DMatrix::zeros(at - from, 0),
        });
    }
    Ok(system)
}

/// C⁻¹ E⁻¹, n × n: controller angles that make up for a turn of each spring.
fn give_per_spring(robot: &Robot) -> Result<DMatrix<f64>> {
    let inverse =
        robot.coupling().clone().try_inverse().ok_or_else(|| Error::invalid("C (theta_from_q) is singular."))?;
    Ok(match robot.spring_mixing() {
        None => inverse,
        Some(mixing) => inverse * mixing,
    })
}

/// Rows of one clamped posture in one state: Ψ, r × unknowns, and Δ \[rad\].
fn rows_of(
    cell: &Cell,
    clamped: &ClampedPosture,
    extra: &[ExtraTerm],
    closure: &LoopClosure,
    give: &DMatrix<f64>,
) -> Result<(DMatrix<f64>, DVector<f64>)> {
    let setup = &cell.setup;
    let mut terms = PostureTerms::new(setup, &clamped.posture.q, Some(&clamped.wrench))?;
    if let Some(preload) = &clamped.preload {
        terms = terms.against(preload);
    }
    let clamp = *terms.loading_point();
    let loads = terms.spring_loads(&setup.robot);
    let springs = loads.len();
    // Vᵀ C⁻¹ E⁻¹ diag(E⁻ᵀΓ) for the springs, S⁻¹Uᵀ (twist) for other terms.
    let mut psi = closure.directions.tr_mul(give).resize_horizontally(springs + extra.len(), 0.0);
    scale_columns(&mut psi, loads.iter().copied());
    for (i, term) in extra.iter().enumerate() {
        let twist = &closure.follow * term.twist(&terms, &clamp);
        psi.column_mut(springs + i).copy_from(&twist);
    }
    let moved = clamped.fixture_motion.unwrap_or_default();
    let net_twist = moved - terms.known_twist(&setup.tool, &clamp);
    let motor = DVector::from_column_slice(&clamped.motor);
    let delta = &closure.follow * net_twist - closure.directions.tr_mul(&motor);
    Ok((psi, delta))
}

/// Covariance of the rows of one posture in units of the variance of an angle
/// difference: states against one reference reading share half of it.
fn covariance(clamped: &[ClampedPosture], closures: &[LoopClosure], states: &[usize]) -> Covariance {
    let starts: Vec<usize> = states
        .iter()
        .scan(0, |at, m| {
            let start = *at;
            *at += closures[*m].rank();
            Some(start)
        })
        .collect();
    let rows: usize = states.iter().map(|m| closures[*m].rank()).sum();
    let mut out = DMatrix::identity(rows, rows);
    for (a, &m) in states.iter().enumerate() {
        for (b, &k) in states.iter().enumerate().filter(|(b, _)| *b != a) {
            if clamped[m].reference.is_none() || clamped[m].reference != clamped[k].reference {
                continue;
            }
            let common = closures[m].directions.tr_mul(&closures[k].directions) * 0.5;
            out.view_mut((starts[a], starts[b]), common.shape()).copy_from(&common);
        }
    }
    Covariance::from_matrix(&out)
}
