//! Dexterity: condition number k(J_N) of the normalised Jacobian, Eqs. (20)–(21).
//!
//! Eq. (21) is printed with the inverse outside the second trace, which would
//! make it constant; the inverse belongs inside. The factor 1/6 counts the rows
//! of J_N, so a chain with n > 6 joints uses its 6 × n Gram matrix; with n < 6
//! J_N has no full rank and k(J_N) does not exist.

use crate::error::{Code, Error, Result};
use crate::model::kinematics::Frames;
use crate::model::robot::Robot;
use crate::numerics::information::{GRAM_ROUNDING, svd, symmetric_eigen};
use nalgebra::{DMatrix, Matrix6, Matrix6xX, Vector3};

/// Relative size of the smallest singular value below which J_N counts as singular.
const SINGULAR: f64 = 1e-12;

/// k of six joints up to which J is inverted by elimination; beyond it by singular values.
pub(crate) const ELIMINATION_CONDITION: f64 = 1e4;

/// Refuses robots whose J_N has no full rank in any posture for want of joints.
///
/// # Errors
/// Fewer than six joints.
pub(crate) fn require_six_joints(robot: &Robot) -> Result<()> {
    match robot.joint_count() {
        n if n < 6 => {
            Err(Error::new(Code::Unsupported, format!("k(J_N) needs at least 6 joints, and {} has {n}.", robot.name())))
        }
        _ => Ok(()),
    }
}

/// Normalised Jacobian J_N = diag(I/L, I) J, Eq. (20), at the base-frame point
/// `p` \[m\] with the characteristic length `length` \[m\]; 6 × n, dimensionless.
pub fn normalised_jacobian(frames: &Frames, p: &Vector3<f64>, length: f64) -> Matrix6xX<f64> {
    let mut jacobian = frames.jacobian(p);
    // Eq. (20)
    jacobian.rows_mut(0, 3).scale_mut(1.0 / length);
    jacobian
}

/// Condition number (1/6)·‖J‖·‖J⁻¹‖ of a Jacobian of six joints, by Frobenius norms, and its
/// inverse: Eq. (21), as tr(J Jᵀ) = ‖J‖². Infinite and none where it has no inverse.
pub(crate) fn inverted(jacobian: Matrix6<f64>) -> (f64, Option<Matrix6<f64>>) {
    let inverse = jacobian.try_inverse().filter(|m| m.norm().is_finite());
    let condition = inverse.map_or(f64::INFINITY, |m| jacobian.norm() * m.norm() / 6.0);
    (condition, inverse)
}

/// k(J_N) = (1/6)·sqrt(tr(J_N J_Nᵀ)·tr((J_N J_Nᵀ)⁻¹)) ≥ 1, Eq. (21); `None` at a
/// singularity and for n < 6.
pub fn condition_number(frames: &Frames, p: &Vector3<f64>, length: f64) -> Option<f64> {
    let jacobian = normalised_jacobian(frames, p, length);
    if jacobian.ncols() < 6 {
        return None;
    }
    if jacobian.ncols() == 6
        && let (k @ ..ELIMINATION_CONDITION, _) = inverted(jacobian.fixed_columns::<6>(0).into_owned())
    {
        return Some(k);
    }
    let tall = DMatrix::from_fn(jacobian.ncols(), 6, |i, j| jacobian[(j, i)]);
    let values = svd(tall)?.values;
    if values.min() <= SINGULAR * values.max() {
        return None;
    }
    let trace: f64 = values.iter().map(|s| s * s).sum();
    let inverse_trace: f64 = values.iter().map(|s| 1.0 / (s * s)).sum();
    // Eq. (21), inverse inside the trace.
    Some((trace * inverse_trace).sqrt() / 6.0)
}

/// ln k(J_N) with its derivatives with respect to θ (added to `gradient`) and
/// to ln L (returned second). Infinite, with no derivative, at a singularity.
#[doc(hidden)]
pub fn log_condition_gradient(frames: &Frames, p: &Vector3<f64>, length: f64, gradient: &mut [f64]) -> (f64, f64) {
    let n = frames.joint_count();
    let jacobian = normalised_jacobian(frames, p, length);
    let gram: Matrix6<f64> = &jacobian * jacobian.transpose();
    let Some((values, vectors)) =
        symmetric_eigen(DMatrix::from_iterator(6, 6, gram.iter().copied())).filter(|_| n >= 6)
    else {
        return (f64::INFINITY, 0.0);
    };
    if values[0] <= 6.0 * GRAM_ROUNDING * values[5] {
        return (f64::INFINITY, 0.0);
    }
    let trace = values.sum();
    let inverse_trace: f64 = values.iter().map(|v| 1.0 / v).sum();
    let value = 0.5 * (trace * inverse_trace).ln() - 6f64.ln();
    // d ln k = ⟨J_N/tr A − A⁻² J_N/tr A⁻¹, dJ_N⟩ with A = J_N J_Nᵀ.
    let weights = values.map(|v| 1.0 / trace - 1.0 / (v * v * inverse_trace));
    let adjoint = &vectors
        * DMatrix::from_diagonal(&weights)
        * vectors.transpose()
        * DMatrix::from_iterator(6, n, jacobian.iter().copied());
    let columns: Vec<Vector3<f64>> = (0..n).map(|i| frames.column(i, p)).collect();
    let part = |row: usize, scale: f64| -> Vec<Vector3<f64>> {
        (0..n).map(|i| adjoint.fixed_view::<3, 1>(row, i) * scale).collect()
    };
    let linear = part(0, 1.0 / length);
    frames.add_column_gradient(&columns, &linear, gradient);
    frames.add_axis_gradient(&part(3, 1.0), gradient);
    let length_gradient = -columns.iter().zip(&linear).map(|(c, a)| c.dot(a)).sum::<f64>();
    (value, length_gradient)
}
