//! Angles that were written in degrees, which a URDF does not have.

use std::f64::consts::TAU;
use stiffarm::units::deg_to_rad;

/// Farthest angle of a joint that turns \[rad\]: wrists turn once and a quarter to each side, and what turns
/// on and on is of the type continuous. In degrees even 15° is beyond it.
const FARTHEST: f64 = 2.0 * TAU;

/// The first of some angles \[rad\] that is none, and what it is in radians if degrees were meant.
pub(super) fn in_degrees(angles: &[f64]) -> Option<(f64, String)> {
    let is_far = |angle: &&f64| angle.is_finite() && angle.abs() > FARTHEST;
    let far = *angles.iter().find(is_far)?;
    let hint = format!("a URDF has radians: {far}° is {:.4}", deg_to_rad(far));
    Some((far, hint))
}
