//! All postures that hold a pose.

use crate::error::Result;
use crate::model::inverse::InverseKinematics;
use crate::numerics::order::sort_by_number;
use nalgebra::Isometry3;

/// Postures of a pose that differ by full turns of joints alone.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldPosture {
    /// Controller angles within the machine's limits \[rad\], those nearest to
    /// the middle of the limits first; at least one posture.
    pub turns: Vec<Vec<f64>>,
    /// Whether the posture is singular: where angles are free, it stands for
    /// all of them.
    pub is_singular: bool,
}

/// Every posture within the machine's limits with the flange at `flange` (base
/// frame, \[m\]), full turns included.
///
/// As complete as [`InverseKinematics::branches`]: all of them for arms in
/// closed form, those that a search finds for others, a sample for more than six
/// joints.
///
/// # Errors
/// A pose that is not finite; [`Code::Unreachable`](crate::Code::Unreachable)
/// or [`Code::OutsideLimits`](crate::Code::OutsideLimits) where there is none.
pub fn held_postures(inverse: &InverseKinematics, flange: &Isometry3<f64>) -> Result<Vec<HeldPosture>> {
    let branches = inverse.branches(flange)?;
    let mut held = Vec::with_capacity(branches.len());
    for branch in &branches {
        let mut turns = inverse.turns_within_limits(&branch.q);
        let change = |q: &[f64]| -> f64 {
            let changes = q.iter().zip(&branch.q).map(|(a, b)| (a - b).abs());
            changes.fold(0.0, f64::max)
        };
        // Stable: turns that are equally far stay in their order.
        sort_by_number(&mut turns, |q| change(q));
        if !turns.is_empty() {
            held.push(HeldPosture { turns, is_singular: branch.singular });
        }
    }
    if let (true, Some(first)) = (held.is_empty(), branches.first()) {
        // Says which joint is in the way.
        let q = inverse.nearest(flange, &first.q)?;
        held.push(HeldPosture { turns: vec![q], is_singular: false });
    }
    Ok(held)
}
