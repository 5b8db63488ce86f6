//! How makers write an orientation in numbers.

use crate::error::{Code, Error, Result};
use crate::model::robot::Controller;
use crate::units::{rad_to_deg, roll_pitch_yaw};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Numbers on a pendant are rounded: a quaternion or matrix may be off by so much.
const ROUNDED: f64 = 2e-3;

/// Cosine of a turn that is a quarter turn (sine: none or half a turn) but for rounding.
const QUARTER: f64 = 1e-11;
/// An angle this near to −180° is half a turn but for rounding \[deg\].
const ROUNDING_DEG: f64 = 1e-10;

/// A maker's numbers for an orientation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// KUKA's A, B, C: R = Rz(A)·Ry(B)·Rx(C).
    Kuka,
    /// ABB's quaternion q1 to q4, the scalar first; q1 is not negative here.
    Abb,
    /// FANUC's W, P, R: turns about the fixed x, then y, then z axis,
    /// R = Rz(R)·Ry(P)·Rx(W).
    Fanuc,
    /// COMAU's Euler angles A, E, R, as a `POS` of PDL2 has them: R = Rz(A)·Ry(E)·Rz(R).
    Comau,
    /// Yaskawa's Rx, Ry, Rz: turns about the fixed x, then y, then z axis.
    Yaskawa,
    /// Stäubli's Rx, Ry, Rz: R = Rx(Rx)·Ry(Ry)·Rz(Rz).
    Staubli,
    /// Universal Robots' rotation vector: axis times angle.
    Ur,
    /// The rotation matrix, row by row.
    Matrix,
}

impl Convention {
    /// All conventions.
    pub const ALL: [Convention; 8] = [
        Convention::Kuka,
        Convention::Abb,
        Convention::Fanuc,
        Convention::Comau,
        Convention::Yaskawa,
        Convention::Staubli,
        Convention::Ur,
        Convention::Matrix,
    ];

    /// Name for options and results.
    pub fn as_str(self) -> &'static str {
        match self {
            Convention::Kuka => "kuka",
            Convention::Abb => "abb",
            Convention::Fanuc => "fanuc",
            Convention::Comau => "comau",
            Convention::Yaskawa => "yaskawa",
            Convention::Staubli => "staubli",
            Convention::Ur => "ur",
            Convention::Matrix => "matrix",
        }
    }

    /// The convention of a maker's controller; the matrix where it has none here.
    pub fn of(controller: Option<Controller>) -> Self {
        match controller {
            Some(Controller::Kuka) => Convention::Kuka,
            Some(Controller::Abb) => Convention::Abb,
            Some(Controller::Fanuc) => Convention::Fanuc,
            Some(Controller::Comau) => Convention::Comau,
            Some(Controller::Yaskawa) => Convention::Yaskawa,
            Some(Controller::Staubli) => Convention::Staubli,
            Some(Controller::Ur) => Convention::Ur,
            Some(Controller::Other) | None => Convention::Matrix,
        }
    }

    /// What it is, in a few words.
    pub fn describe(self) -> &'static str {
        match self {
            Convention::Kuka => "A, B, C: turns about z, then y', then x''",
            Convention::Abb => "quaternion q1 to q4, the scalar first",
            Convention::Fanuc => "W, P, R: turns about fixed x, then y, then z",
            Convention::Comau => "A, E, R: turns about z, then y', then z''",
            Convention::Yaskawa => "Rx, Ry, Rz: turns about fixed x, then y, then z",
            Convention::Staubli => "Rx, Ry, Rz: turns about x, then y', then z''",
            Convention::Ur => "rotation vector: axis times angle",
            Convention::Matrix => "rotation matrix, its columns the axes of the frame",
        }
    }

    /// Columns of a table: `_deg` and `_rad` are angles, others plain numbers.
    pub fn columns(self) -> &'static [&'static str] {
        match self {
            Convention::Kuka => &["a_deg", "b_deg", "c_deg"],
            Convention::Abb => &["q1", "q2", "q3", "q4"],
            Convention::Fanuc => &["w_deg", "p_deg", "r_deg"],
            Convention::Comau => &["a_deg", "e_deg", "r_deg"],
            Convention::Yaskawa | Convention::Staubli => &["rx_deg", "ry_deg", "rz_deg"],
            Convention::Ur => &["rx_rad", "ry_rad", "rz_rad"],
            Convention::Matrix => &["r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"],
        }
    }

    /// The numbers of an orientation, angles in radians.
    pub fn numbers(self, rotation: &UnitQuaternion<f64>) -> Vec<f64> {
        match self {
            Convention::Fanuc | Convention::Yaskawa => fixed_turns(rotation).to_vec(),
            Convention::Kuka => {
                let [c, b, a] = fixed_turns(rotation);
                vec![a, b, c]
            }
            Convention::Comau => euler_zyz(rotation).to_vec(),
            // The inverse of Rx·Ry·Rz is Rz(−)·Ry(−)·Rx(−).
            Convention::Staubli => fixed_turns(&rotation.inverse()).map(|angle| -angle).to_vec(),
            Convention::Abb => {
                let sign = if rotation.w < 0.0 { -1.0 } else { 1.0 };
                [rotation.w, rotation.i, rotation.j, rotation.k].map(|v| sign * v).to_vec()
            }
            Convention::Ur => rotation.scaled_axis().as_slice().to_vec(),
            Convention::Matrix => {
                let r = rotation.to_rotation_matrix();
                let rows = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
                rows.map(|place| r[place]).collect()
            }
        }
    }

    /// The same in the units of [`columns`](Self::columns), as the pendant shows them.
    pub fn shown(self, rotation: &UnitQuaternion<f64>) -> Vec<f64> {
        let columns = self.columns().iter();
        columns
            .zip(self.numbers(rotation))
            .map(|(column, value)| {
                if column.ends_with("_deg") {
                    within_half_turn(rad_to_deg(value))
                } else {
                    // Adding zero turns −0 into 0.
                    value + 0.0
                }
            })
            .collect()
    }

    /// The orientation of these numbers, angles in radians. A quaternion and a
    /// matrix may be rounded as a pendant rounds them; the nearest rotation is
    /// taken.
    ///
    /// # Errors
    /// Another number of numbers, one that is not finite, a quaternion that has
    /// not length 1, a matrix that is no rotation.
    pub fn rotation(self, numbers: &[f64]) -> Result<UnitQuaternion<f64>> {
        let count = self.columns().len();
        if numbers.len() != count {
            let message = format!("An orientation has {count} numbers, got {}.", numbers.len());
            return Err(Error::new(Code::Dimension, message));
        }
        if numbers.iter().any(|v| !v.is_finite()) {
            let message = "An orientation has a number that is not finite.";
            return Err(Error::new(Code::NotFinite, message));
        }
        let turns = UnitQuaternion::from_euler_angles;
        Ok(match (self, numbers) {
            (Convention::Kuka, [a, b, c]) => turns(*c, *b, *a),
            (Convention::Comau, [a, e, r]) => turns(0.0, 0.0, *a) * turns(0.0, *e, 0.0) * turns(0.0, 0.0, *r),
            (Convention::Staubli, [x, y, z]) => turns(-x, -y, -z).inverse(),
            (Convention::Ur, [x, y, z]) => {
                let vector = Vector3::new(*x, *y, *z);
                let angle = vector.norm();
                if angle > TAU + ROUNDED {
                    let message = format!("A rotation vector of {angle:.4} rad is more than a turn.");
                    return Err(Error::invalid(message).hint("give it in radians, as the pendant shows it"));
                }
                UnitQuaternion::from_scaled_axis(vector)
            }
            (Convention::Fanuc | Convention::Yaskawa, [x, y, z]) => turns(*x, *y, *z),
            (Convention::Abb, [w, x, y, z]) => quaternion([*w, *x, *y, *z])?,
            _ => matrix(&Matrix3::from_row_slice(numbers))?,
        })
    }
}

/// Turns about the fixed x, then y, then z axis \[rad\]. Where the second is a
/// quarter turn only the sum of the others is determined: the third is zero.
fn fixed_turns(rotation: &UnitQuaternion<f64>) -> [f64; 3] {
    let r = rotation.to_rotation_matrix();
    if r[(2, 1)].hypot(r[(2, 2)]) < QUARTER {
        [(-r[(1, 2)]).atan2(r[(1, 1)]), r[(2, 0)].signum() * -FRAC_PI_2, 0.0]
    } else {
        roll_pitch_yaw(rotation)
    }
}

/// Turns about z, then y', then z'' \[rad\], the second from 0 to half a turn. Where it is one of these
/// only the sum or difference of the others is determined: the third is zero.
fn euler_zyz(rotation: &UnitQuaternion<f64>) -> [f64; 3] {
    let r = rotation.to_rotation_matrix();
    if r[(0, 2)].hypot(r[(1, 2)]) < QUARTER {
        let second = if r[(2, 2)] > 0.0 { 0.0 } else { PI };
        return [(-r[(0, 1)]).atan2(r[(1, 1)]), second, 0.0];
    }
    let first = r[(1, 2)].atan2(r[(0, 2)]);
    // The others are what is left once this turn is undone.
    let (sine, cosine) = first.sin_cos();
    let undone = |column: usize| cosine * r[(1, column)] - sine * r[(0, column)];
    let second = (cosine * r[(0, 2)] + sine * r[(1, 2)]).atan2(r[(2, 2)]);
    [first, second, undone(0).atan2(undone(1))]
}

/// Half a turn is 180° and not −180°, and zero is not −0.
fn within_half_turn(deg: f64) -> f64 {
    if deg < -180.0 + ROUNDING_DEG { deg + 360.0 } else { deg + 0.0 }
}

fn quaternion([w, x, y, z]: [f64; 4]) -> Result<UnitQuaternion<f64>> {
    let quaternion = nalgebra::Quaternion::new(w, x, y, z);
    let length = quaternion.norm();
    if (length - 1.0).abs() > ROUNDED {
        let message = format!("The quaternion has length {length:.4}; it must be 1.");
        return Err(Error::invalid(message).hint("q1 is the scalar; look for a number in a wrong column"));
    }
    Ok(UnitQuaternion::new_normalize(quaternion))
}

fn matrix(matrix: &Matrix3<f64>) -> Result<UnitQuaternion<f64>> {
    let off = (matrix.transpose() * matrix - Matrix3::identity()).amax();
    if off > ROUNDED || matrix.determinant() < 0.0 {
        let message = if off > ROUNDED {
            "The matrix is not a rotation: its columns are not at right angles and of length 1."
        } else {
            "The matrix is not a rotation: its axes are left-handed."
        };
        return Err(
            Error::invalid(message).hint("r11, r12, r13 are the first row; the columns are the axes of the frame")
        );
    }
    let x = matrix.column(0).normalize();
    let y = (matrix.column(1) - x * x.dot(&matrix.column(1))).normalize();
    let axes = Matrix3::from_columns(&[x, y, x.cross(&y)]);
    Ok(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes)))
}
