//! Modified Denavit–Hartenberg rows of given joint axes.
//!
//! Craig's frames have z along the joint axis and x along the common normal to
//! the next axis. Where two axes are nearly parallel the foot of that normal
//! runs away to infinity; there the frame keeps its origin, x leads to the point
//! where the next axis meets the plane z = 0, and the tilt β about y, the fifth
//! number of Hayati & Mirmirani (1985, doi:10.1002/rob.4620020406), takes up the
//! rest: T = RotX(α) TransX(a) RotY(β) RotZ(θ) TransZ(d). Both are exact.

use super::DhRow;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Sine of the angle between axes below which their common normal is not used:
/// at this angle its foot is at most a hundred times as far as the axes are apart.
const NEARLY_PARALLEL: f64 = 1e-2;
/// Axes this near to each other meet \[m\].
const MEETING_DISTANCE: f64 = 1e-9;
/// Axes this near to each other, where one goes through the other's origin,
/// are one \[m\].
const SAME_AXIS_DISTANCE: f64 = 1e-13;

/// A joint's axis at zero, base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointAxis {
    /// A point on it \[m\].
    pub point: Vector3<f64>,
    /// Its direction, a unit vector; the joint turns about it in the positive sense.
    pub direction: Vector3<f64>,
}

/// Rows of given axes, with the frames at both ends.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisRows {
    /// Frame 0 of the rows in the base frame \[m\].
    pub base: Isometry3<f64>,
    /// Modified rows; at zero angles θ is their offset.
    pub rows: Vec<DhRow>,
    /// Tilt of each axis about the y axis of its frame \[rad\].
    pub tilts: Vec<f64>,
    /// What moves with each joint, at zero angles, in the base frame: the joint's frame
    /// after its turn, as [`Frames::links`](crate::model::kinematics::Frames::links) has
    /// it (d of its row comes after) \[m\].
    pub links: Vec<Isometry3<f64>>,
    /// The flange in the last frame of the rows \[m\].
    pub flange: Isometry3<f64>,
}

/// From the frame before to where the next axis stands.
struct Step {
    /// Turn about and shift along the axis that is there.
    turn: f64,
    shift: f64,
    alpha: f64,
    a: f64,
    tilt: f64,
}

/// Modified rows whose chain has `axes`, and `flange` at zero, in the base frame.
///
/// Frame 0 is the base frame where axis 1 is its z axis or parallel to it. The
/// last frame has its origin beside the flange's and an axis along one of the
/// flange's, so that a flange square to the last axis leaves round numbers.
pub fn rows_of_axes(axes: &[JointAxis], flange: &Isometry3<f64>) -> AxisRows {
    let mut chain = AxisRows {
        base: Isometry3::identity(),
        rows: Vec::with_capacity(axes.len()),
        tilts: Vec::with_capacity(axes.len()),
        links: Vec::with_capacity(axes.len()),
        flange: Isometry3::identity(),
    };
    // z along the axis, not yet turned and shifted to the next one.
    let mut entry = Isometry3::identity();
    for axis in axes {
        let point = entry.inverse_transform_point(&axis.point.into()).coords;
        let direction = entry.inverse_transform_vector(&axis.direction);
        let step = step(&point, &direction);
        let frame = chain.leave(&entry, step.turn, step.shift);
        chain.rows.push(DhRow { alpha: step.alpha, a: step.a, d: 0.0, offset: 0.0 });
        chain.tilts.push(step.tilt);
        let about = UnitQuaternion::from_axis_angle;
        entry = frame
            * about(&Vector3::x_axis(), step.alpha)
            * Translation3::new(step.a, 0.0, 0.0)
            * about(&Vector3::y_axis(), step.tilt);
    }
    let end = entry.inv_mul(flange);
    let sideways = [Vector3::x(), Vector3::y()].map(|v| end.rotation * v).into_iter().find(|v| v.x.hypot(v.y) > 0.5);
    let turn = sideways.map_or(0.0, |v| v.y.atan2(v.x));
    let frame = chain.leave(&entry, turn, end.translation.z);
    chain.flange = frame.inv_mul(flange);
    chain
}

impl AxisRows {
    /// Ends the row that `entry` belongs to (of the base, before the first row),
    /// and gives its frame.
    fn leave(&mut self, entry: &Isometry3<f64>, turn: f64, shift: f64) -> Isometry3<f64> {
        let about_z = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
        let frame = entry * Isometry3::from_parts(Translation3::new(0.0, 0.0, shift), about_z);
        match self.rows.last_mut() {
            Some(row) => {
                (row.offset, row.d) = (turn, shift);
                self.links.push(entry * about_z);
            }
            None => self.base = frame,
        }
        frame
    }
}

/// From the z axis to the axis through `point` along `direction`.
fn step(point: &Vector3<f64>, direction: &Vector3<f64>) -> Step {
    let sine = direction.x.hypot(direction.y);
    if sine < NEARLY_PARALLEL {
        return tilted(point, direction);
    }
    // Common normal: z × direction.
    let mut x = Vector3::new(-direction.y, direction.x, 0.0) / sine;
    let mut a = point.dot(&x);
    let mut alpha = sine.atan2(direction.z);
    let backwards = if a.abs() > MEETING_DISTANCE {
        a < 0.0
    } else {
        // Either way is a normal of axes that meet: the smaller turn.
        x.x < -1e-9 || (x.x < 1e-9 && x.y < 0.0)
    };
    if backwards {
        (x, a, alpha) = (-x, -a, -alpha);
    }
    // Where on the next axis its distance from z is a.
    let along = -(point.x * direction.x + point.y * direction.y) / (sine * sine);
    Step { turn: x.y.atan2(x.x), shift: point.z + along * direction.z, alpha, a, tilt: 0.0 }
}

/// As [`step`], for an axis nearly parallel to z: by the point where it meets z = 0.
fn tilted(point: &Vector3<f64>, direction: &Vector3<f64>) -> Step {
    let met = point - direction * (point.z / direction.z);
    let apart = met.x.hypot(met.y);
    let (turn, a) = if apart > SAME_AXIS_DISTANCE { (met.y.atan2(met.x), apart) } else { (0.0, 0.0) };
    let back = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -turn);
    // RotX(α) RotY(β) z = (sin β, −sin α cos β, cos α cos β).
    let z = back * direction;
    Step { turn, shift: 0.0, alpha: (-z.y).atan2(z.z), a, tilt: z.x.atan2(z.y.hypot(z.z)) }
}
