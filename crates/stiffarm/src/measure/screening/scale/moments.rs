//! Moments against forces: a force through the loading point has the moment
//! lever × force about the sensor's origin.

use super::super::motion::Move;
use super::super::slip::{Slip, Undo};
use super::super::units::MOMENTS;
use super::super::{Cause, Evidence, Work};
use crate::model::instruments::Mount;
use crate::model::kinematics::Frames;
use crate::model::load::Load;

/// Distance of the slope from a factor that still counts (logarithm).
const SLOPE_TOLERANCE: f64 = 0.2;
/// Cosine between measured and expected moments.
const ALONG_COSINE: f64 = 0.9;
/// Mean lever below which moments say nothing \[m\].
const LEVER: f64 = 0.02;

/// Moments of all states in another unit than the forces, by the stated loading
/// point; goes on with what they should be.
pub(super) fn check(work: &mut Work, moves: &[Move]) {
    let Some(sensor) = work.cell.sensor.clone().filter(|_| work.sheet.has_moments) else {
        return;
    };
    let pure = |load: &Load| !matches!(load, Load::Constant { .. });
    let cases = work.setup().load.cases();
    if !work.setup().load.each().all(pure) || cases.iter().any(|c| c.loading_point.is_some()) {
        return;
    }
    let (mut product, mut measured, mut expected, mut forces) = (0.0, 0.0, 0.0, 0.0);
    for one in moves {
        let before = work.sheet.at((one.posture, one.reference));
        let frames = Frames::new(&work.setup().robot, &before.q);
        let origin = match sensor.mount {
            Mount::Flange => frames.point(&sensor.pose.translation.vector),
            Mount::Base => sensor.pose.translation.vector,
        };
        let at = frames.point(&work.setup().tool.loading_point);
        let lever = (at - origin).cross(&one.wrench.force);
        // The moment about the loading point, moved back to the sensor.
        let read = one.wrench.moved(&at, &origin).moment;
        product += lever.dot(&read);
        measured += read.norm_squared();
        expected += lever.norm_squared();
        forces += one.wrench.force.norm_squared();
    }
    let aligned = product / (measured * expected).sqrt();
    // Not true for a number that is none.
    if !(aligned > ALONG_COSINE && expected > LEVER * LEVER * forces) {
        return;
    }
    let slope = product / expected;
    let near = |f: f64| (slope * f).ln().abs() < SLOPE_TOLERANCE;
    let Some(unit) = MOMENTS.into_iter().find(|u| near(u.factor)) else {
        return;
    };
    // Forces a factor too small make moments as much too large for them.
    let slip = Slip::new(match unit.typed {
        "" => Undo::Forces(1.0 / unit.factor),
        _ => Undo::Times(Cause::MomentUnits, unit),
    });
    let mut out = slip.suspicion(work);
    out.evidence = Some(Evidence::Readings);
    work.undo(&slip, out);
}
