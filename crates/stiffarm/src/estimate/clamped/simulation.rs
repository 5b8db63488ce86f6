//! Simulated clamped experiments.

use super::ClampedPosture;
use crate::error::{Code, Error, Result};
use crate::estimate::noise::normal;
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::observation::{PostureTerms, check_angles};
use crate::model::posture::Posture;
use crate::model::stiffness::joint_compliance;
use crate::numerics::information::svd;
use crate::numerics::streams::run_rng;
use nalgebra::{DMatrix, DVector, Matrix6, Vector3, Vector6};

/// Singular values below this, relative to the largest, are zero: the arm
/// cannot push against the fixture along such a direction.
const ZERO: f64 = 1e-9;

/// A move of the motors against the fixture.
#[derive(Debug, Clone, PartialEq)]
pub struct MotorMove {
    /// Name of the load state it makes.
    pub state: String,
    /// Controller angles asked for, loaded minus reference \[rad\].
    pub motor: Vec<f64>,
}

/// What is simulated.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ClampedSimulation {
    /// The moves, the same in each posture.
    pub moves: Vec<MotorMove>,
    /// Standard deviation of an angle difference, each controller angle \[rad\].
    pub angle_std: f64,
    /// Standard deviation of each component of the force \[N\].
    pub force_std: f64,
    /// Standard deviation of each component of the moment \[N·m\].
    pub moment_std: f64,
    /// Compliance of the fixture at the clamp, base axes, 6 × 6 from \[F; M\] to
    /// \[shift; turn\]; zero for a rigid one.
    pub fixture_compliance: Matrix6<f64>,
    /// True where the motion of the fixture is measured, exactly.
    pub records_fixture_motion: bool,
}

/// Simulates clamped postures with the stiffness `truth`, one per spring
/// \[N·m/rad\]. The wrench W of the fixture on the robot follows from the moves:
/// (J K_θ⁻¹ Jᵀ + C_f) W = −J C Δq_m, C_f the compliance of the fixture; where
/// the arm cannot push in all directions it is the smallest such wrench.
///
/// # Errors
/// As [`joint_compliance`]; wrong numbers of angles, a negative or non-finite
/// standard deviation or compliance.
pub fn simulate_clamped(
    cell: &Cell,
    postures: &[Posture],
    truth: &[f64],
    simulation: &ClampedSimulation,
    seed: u64,
    stream: usize,
) -> Result<Vec<ClampedPosture>> {
    let robot = &cell.setup.robot;
    let compliance = joint_compliance(robot, truth)?;
    let noise = [simulation.angle_std, simulation.force_std, simulation.moment_std];
    if !noise.iter().all(|s| s.is_finite() && *s >= 0.0) || simulation.fixture_compliance.iter().any(|v| !v.is_finite())
    {
        return Err(Error::invalid("Standard deviations must be 0 or above, and the fixture's compliance finite."));
    }
    let mut rng = run_rng(seed, 1 << 16, 1, stream);
    let mut out = Vec::with_capacity(postures.len() * simulation.moves.len());
    for posture in postures {
        let none = Wrench::force(Vector3::zeros());
        let terms = PostureTerms::new(&cell.setup, &posture.q, Some(&none))?;
        let jacobian = terms.frames().jacobian(terms.loading_point());
        for motor_move in &simulation.moves {
            check_angles(robot, &motor_move.motor)?;
            let motor = DVector::from_column_slice(&motor_move.motor);
            let push = -(&jacobian * robot.coupling() * motor);
            let give = &jacobian * &compliance * jacobian.transpose() + simulation.fixture_compliance;
            let wrench = solve(give, &push)?;
            // The robot pushes the fixture by −W.
            let motion = -(simulation.fixture_compliance * wrench);
            let mut noisy = |value: f64, std: f64| value + std * normal(&mut rng);
            let motor = motor_move.motor.iter().map(|q| noisy(*q, simulation.angle_std)).collect();
            let read = Vector6::from_fn(|i, _| {
                let std = if i < 3 { simulation.force_std } else { simulation.moment_std };
                noisy(wrench[i], std)
            });
            out.push(ClampedPosture {
                posture: posture.clone(),
                state: motor_move.state.clone(),
                wrench: Wrench {
                    force: read.fixed_rows::<3>(0).into_owned(),
                    moment: read.fixed_rows::<3>(3).into_owned(),
                },
                preload: None,
                motor,
                reference: None,
                fixture_motion: simulation.records_fixture_motion.then_some(motion),
            });
        }
    }
    Ok(out)
}

/// Smallest W with `give`·W = `push`, by the decomposition of `give` with its
/// rows and columns brought to one size.
fn solve(give: Matrix6<f64>, push: &Vector6<f64>) -> Result<Vector6<f64>> {
    let failed = || Error::new(Code::Numerical, "The wrench of the fixture was not found.");
    let scale = Vector6::from_fn(|i, _| match give[(i, i)] {
        d if d > 0.0 => 1.0 / d.sqrt(),
        _ => 1.0,
    });
    let scaled = DMatrix::from_fn(6, 6, |i, j| scale[i] * give[(i, j)] * scale[j]);
    let parts = svd(scaled).ok_or_else(failed)?;
    let mut wrench = Vector6::zeros();
    for i in (0..6).filter(|i| parts.values[*i] > ZERO * parts.values[0]) {
        let along: f64 = (0..6).map(|r| parts.u[(r, i)] * scale[r] * push[r]).sum();
        for r in 0..6 {
            wrench[r] += scale[r] * parts.v[(r, i)] * along / parts.values[i];
        }
    }
    Ok(wrench)
}
