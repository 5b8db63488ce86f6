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

/// Refuses robots whose J_N has no full rank in any posture for want of joints.
///
/// # Errors
/// Fewer than six joints.
pub(crate) fn require_six_joints(robot: &Robot) -> Result<()> {
    match robot.joint_count() {
        n if n < 6 => Err(Error::new(
            Code::Unsupported,
            format!(
                "k(J_N) needs at least 6 joints, and {} has {n}.",
                robot.name()
            ),
        )),
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

/// k(J_N) = (1/6)·sqrt(tr(J_N J_Nᵀ)·tr((J_N J_Nᵀ)⁻¹)) ≥ 1, Eq. (21), by
/// singular values; `None` at a singularity and for n < 6.
pub fn condition_number(frames: &Frames, p: &Vector3<f64>, length: f64) -> Option<f64> {
    let jacobian = normalised_jacobian(frames, p, length);
    if jacobian.ncols() < 6 {
        return None;
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
pub(crate) fn log_condition_gradient(
    frames: &Frames,
    p: &Vector3<f64>,
    length: f64,
    gradient: &mut [f64],
) -> (f64, f64) {
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
        (0..n)
            .map(|i| adjoint.fixed_view::<3, 1>(row, i) * scale)
            .collect()
    };
    let linear = part(0, 1.0 / length);
    frames.add_column_gradient(&columns, &linear, gradient);
    frames.add_axis_gradient(&part(3, 1.0), gradient);
    let length_gradient = -columns
        .iter()
        .zip(&linear)
        .map(|(c, a)| c.dot(a))
        .sum::<f64>();
    (value, length_gradient)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::robot::{DhConvention, DhRow, Robot};
    use nalgebra::Isometry3;

    fn arm(n: usize) -> Robot {
        let rows: Vec<DhRow> = (0..n)
            .map(|i| {
                let i = i as f64;
                DhRow {
                    alpha: 1.1 - 0.5 * i,
                    a: 0.2 + 0.1 * i,
                    d: 0.3 - 0.15 * i,
                    offset: 0.4 * i,
                }
            })
            .collect();
        Robot::from_dh("bent", DhConvention::Standard, &rows, Isometry3::identity()).unwrap()
    }

    #[test]
    fn derivatives_by_the_length_and_the_angles_are_those_of_differences() {
        let in_flange = Vector3::new(0.1, -0.2, 0.3);
        for n in [6, 7] {
            let robot = arm(n);
            let theta: Vec<f64> = (0..n).map(|j| 0.5 + 0.9 * (j as f64 * 1.7).sin()).collect();
            let log_k = |theta: &[f64], log_length: f64| {
                let frames = Frames::at_serial_angles(&robot, theta);
                condition_number(&frames, &frames.point(&in_flange), log_length.exp())
                    .unwrap()
                    .ln()
            };
            // Richardson: the error of order h² cancels.
            let slope = |f: &dyn Fn(f64) -> f64| {
                let central = |h: f64| (f(h) - f(-h)) / (2.0 * h);
                (4.0 * central(1e-3) - central(2e-3)) / 3.0
            };
            for length in [0.1, 0.7, 3.0_f64] {
                let frames = Frames::at_serial_angles(&robot, &theta);
                let mut gradient = vec![0.0; n];
                let (value, by_length) = log_condition_gradient(
                    &frames,
                    &frames.point(&in_flange),
                    length,
                    &mut gradient,
                );
                let at = length.ln();
                assert!((value - log_k(&theta, at)).abs() < 1e-10);
                let expected = slope(&|h| log_k(&theta, at + h));
                assert!(
                    (by_length - expected).abs() < 1e-8,
                    "n {n} L {length}: {by_length} {expected}"
                );
                // k(J_N) changes with the length, or the test says nothing.
                assert!(expected.abs() > 1e-3);
                for k in 0..n {
                    let expected = slope(&|h| {
                        let mut theta = theta.clone();
                        theta[k] += h;
                        log_k(&theta, at)
                    });
                    assert!(
                        (gradient[k] - expected).abs() < 1e-7,
                        "n {n} joint {k}: {} {expected}",
                        gradient[k]
                    );
                }
            }
        }
    }

    #[test]
    fn a_singular_posture_and_a_short_chain_have_no_condition_number() {
        let p = Vector3::new(0.4, 0.1, 0.2);
        // Every joint about one axis.
        let row = DhRow {
            alpha: 0.0,
            a: 0.0,
            d: 0.1,
            offset: 0.0,
        };
        let flat = Robot::from_dh(
            "flat",
            DhConvention::Modified,
            &[row; 6],
            Isometry3::identity(),
        )
        .unwrap();
        for robot in [flat, arm(5)] {
            let n = robot.joint_count();
            let frames = Frames::new(&robot, &vec![0.3; n]);
            assert_eq!(condition_number(&frames, &p, 0.7), None);
            let mut gradient = vec![0.0; n];
            let (value, by_length) = log_condition_gradient(&frames, &p, 0.7, &mut gradient);
            assert_eq!((value, by_length), (f64::INFINITY, 0.0));
            assert!(gradient.iter().all(|g| *g == 0.0));
        }
    }
}
