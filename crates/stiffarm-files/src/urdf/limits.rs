//! Limits of the controller's joints.

use super::angles::in_degrees;
use super::robot::{Joint, JointKind};
use super::source::Source;
use std::f64::consts::TAU;
use stiffarm::error::{Code, Result};
use stiffarm::findings::Finding;
use stiffarm::units::{deg_to_rad, rad_to_deg, rounded};

/// Limits of a joint \[rad\]: full turns for one without end.
pub(super) fn limits(source: &Source<'_>, joint: &Joint) -> Result<[f64; 2]> {
    if joint.kind == JointKind::Continuous {
        return Ok([-TAU, TAU]);
    }
    let joint_limits = [joint.limit.lower, joint.limit.upper];
    let [low, high] = joint_limits.map(rad_to_deg);
    let error = |code, message| source.error_at("joint", &joint.name, code, message);
    if joint_limits[0] >= joint_limits[1] {
        let message = if joint.limit.is_given {
            format!(
                "The lower limit of the joint \"{}\" is not below the upper one: {low:.3}° and {high:.3}°.",
                joint.name
            )
        } else {
            format!("The joint \"{}\" has no limits.", joint.name)
        };
        let error = error(Code::InvalidValue, message);
        return Err(error.hint("give <limit lower=\"…\" upper=\"…\" …/> in rad, or type=\"continuous\""));
    }
    degrees(source, joint, joint_limits)?;
    // From URDF 1.2 on there may be none to one side: a full turn stands in for it.
    let turn = |limit: f64| {
        if limit.is_finite() { meant(limit) } else { TAU.copysign(limit) }
    };
    Ok(joint_limits.map(turn))
}

/// Decimals of radians at least: who writes 2.5 may mean just that.
const FEWEST_DECIMALS: usize = 4;
/// Largest joint speed that is not a stand-in for none \[rad/s\]: 2000°/s.
const FASTEST: f64 = 34.9;

/// An angle that was written in radians with a few digits, \[rad\]: that of fewest decimals in degrees
/// which these digits do not tell from it, cut off or rounded. 3.14159 means 180°.
fn meant(rad: f64) -> f64 {
    let digits = rad.to_string();
    let decimals = digits.split_once('.').map_or(0, |(_, after)| after.len());
    let decimals = decimals.max(FEWEST_DECIMALS);
    let deg = rad_to_deg(rad);
    // Of all digits the conversion itself costs the last.
    let last = rad_to_deg(10f64.powi(-(decimals as i32))).max(4.0 * f64::EPSILON * deg.abs());
    let near = (0..decimals).map(|decimals| rounded(deg, decimals as i32)).find(|r| (r - deg).abs() <= last);
    near.map_or(rad, deg_to_rad)
}

/// Largest speeds of the controller's joints \[rad/s\], where the file has one for each.
pub(super) fn speeds(drives: &[&Joint]) -> Option<Vec<f64>> {
    let speeds = drives.iter().map(|drive| {
        let speed = drive.limit.velocity;
        (speed > 0.0 && speed <= FASTEST).then(|| meant(speed))
    });
    speeds.collect()
}

/// Says that limits of a joint without end do not count.
pub(super) fn endless(joint: &Joint) -> Option<Finding> {
    let has_limits = joint.limit.is_given && joint.limit.lower < joint.limit.upper;
    (has_limits && joint.kind == JointKind::Continuous).then(|| {
        let [low, high] = [joint.limit.lower, joint.limit.upper].map(rad_to_deg);
        let sentence = format!(
            "The joint is of the type continuous, so that its limits, {low:.1}° to {high:.1}°, do not count; ±360° \
             stand for them. Set limits_deg in the cell if they hold.",
        );
        Finding::caution("urdf-limits", joint.name.as_str(), sentence)
    })
}

/// Refuses limits that were written in degrees, which a URDF does not have.
fn degrees(source: &Source<'_>, joint: &Joint, limits: [f64; 2]) -> Result<()> {
    let Some((far, hint)) = in_degrees(&limits) else {
        return Ok(());
    };
    let message = format!(
        "The joint \"{}\" has a limit of {far} rad, which is {:.0} turns: are these degrees?",
        joint.name,
        far.abs() / TAU
    );
    let error = source.error_at("joint", &joint.name, Code::InvalidValue, message);
    let hint = hint + "; for a joint without end write type=\"continuous\"";
    Err(error.key("limit").hint(hint))
}

/// Doubts limits that are possible in radians, and as whole numbers more probable in degrees.
pub(super) fn doubted(joint: &Joint) -> Option<Finding> {
    let limits = [joint.limit.lower, joint.limit.upper];
    let is_odd = |limit: &f64| limit.fract() == 0.0 && limit.abs() > TAU;
    if joint.kind == JointKind::Continuous || !limits.iter().any(is_odd) {
        return None;
    }
    let [low, high] = limits;
    let sentence = format!(
        "Limits of {low} and {high} rad are {:.0}° and {:.0}°: are these degrees? A URDF has radians.",
        rad_to_deg(low),
        rad_to_deg(high)
    );
    Some(Finding::caution("urdf-limits", joint.name.as_str(), sentence))
}

/// Limits of a `drive` as the limits of a joint leave them whose angle is `multiplier` times
/// the drive's, plus `offset`.
pub(super) fn narrowed(
    source: &Source<'_>,
    limits: [f64; 2],
    joint: &Joint,
    (drive, multiplier, offset): (&Joint, f64, f64),
) -> Result<[f64; 2]> {
    let written = [joint.limit.lower, joint.limit.upper];
    let joint_limits = written.map(meant);
    if joint.kind == JointKind::Continuous || joint_limits[0] == joint_limits[1] || multiplier == 0.0 {
        return Ok(limits);
    }
    if joint_limits[0] > joint_limits[1] {
        return self::limits(source, joint);
    }
    degrees(source, joint, written)?;
    let mut ends = joint_limits.map(|end| (end - offset) / multiplier);
    ends.sort_by(f64::total_cmp);
    let both = [limits[0].max(ends[0]), limits[1].min(ends[1])];
    if both[0] < both[1] {
        return Ok(both);
    }
    let message = format!(
        "The limits of the joint \"{}\" leave the joint \"{}\" no range, which it follows.",
        joint.name, drive.name
    );
    Err(source.error_at("joint", &joint.name, Code::InvalidValue, message))
}
