//! Whether an identified stiffness can be meant: slips of units and signs show
//! as values that no industrial robot has.

use super::Identification;
use crate::findings::Finding;
use crate::model::cell::Cell;

/// Ratio to the prior, for all joints alike, beyond which a unit is suspected.
const SUSPICIOUS_RATIO: f64 = 100.0;
/// Joint stiffness beyond which, without a prior, a unit is suspected \[N·m/rad\].
const SUSPICIOUS_STIFFNESS: [f64; 2] = [1e3, 1e8];

/// Relative standard error above which a stiffness says nothing of a unit.
const LARGEST_TELLING_ERROR: f64 = 0.5;

/// A finding when the stiffness of the joints as a whole is far from the prior,
/// or, without one, from that of any industrial robot. Joints that the data
/// hardly determine say nothing of units: the finding needs half of the joints
/// known better than that.
pub fn implausible_scale(cell: &Cell, result: &Identification) -> Option<Finding> {
    let mut ratios: Vec<f64> = Vec::new();
    for (j, joint) in result.estimates.joints.iter().enumerate() {
        let Some(k) = joint.stiffness else { continue };
        let collinear = result.estimates.collinear.iter();
        let error = joint.readings_standard_error.map_or(0.0, |e| e / k.abs());
        if error > LARGEST_TELLING_ERROR || collinear.flat_map(|s| &s.unknowns).any(|n| *n == joint.name) {
            continue;
        }
        ratios.push(ratio(cell, j, k));
    }
    if 2 * ratios.len() < result.estimates.joints.len() {
        return None;
    }
    suspicious(cell, ratios, "measurements", |is_larger| {
        if is_larger {
            "Are the displacements in metres instead of millimetres, or is the force too large?"
        } else {
            "Are the displacements in micrometres instead of millimetres, or the force in kilonewtons?"
        }
    })
}

/// The same of stiffness that was given \[N·m/rad\].
pub(crate) fn implausible_stiffness(cell: &Cell, stiffness: &[f64]) -> Option<Finding> {
    let ratios = stiffness.iter().enumerate();
    let ratios = ratios.map(|(j, k)| ratio(cell, j, *k)).collect();
    suspicious(cell, ratios, "stiffness", |_| "Is it in N·m/rad?")
}

/// A stiffness against the prior, or against the plausible range, whose middle is neither small nor large.
fn ratio(cell: &Cell, joint: usize, stiffness: f64) -> f64 {
    match (&cell.prior, stiffness.abs()) {
        (Some(prior), k) => k / prior[joint],
        (None, k) if k < SUSPICIOUS_STIFFNESS[0] => k / SUSPICIOUS_STIFFNESS[0] / SUSPICIOUS_RATIO,
        (None, k) if k > SUSPICIOUS_STIFFNESS[1] => k / SUSPICIOUS_STIFFNESS[1] * SUSPICIOUS_RATIO,
        _ => 1.0,
    }
}

/// A finding where the middle of the ratios is far from 1, with what asks for the cause.
fn suspicious(
    cell: &Cell,
    mut ratios: Vec<f64>,
    subject: &str,
    cause: impl Fn(bool) -> &'static str,
) -> Option<Finding> {
    ratios.sort_by(f64::total_cmp);
    let middle = *ratios.get(ratios.len() / 2)?;
    if (1.0 / SUSPICIOUS_RATIO..=SUSPICIOUS_RATIO).contains(&middle) {
        return None;
    }
    let against = match cell.prior {
        Some(_) => "the cell's prior",
        None => "what industrial robots have",
    };
    let (factor, word) = if middle > 1.0 { (middle, "larger") } else { (1.0 / middle, "smaller") };
    let cause = cause(middle > 1.0);
    let sentence = format!("The joint stiffness is {factor:.0} times {word} than {against}. {cause}");
    Some(Finding::serious("implausible-stiffness", subject, sentence))
}
