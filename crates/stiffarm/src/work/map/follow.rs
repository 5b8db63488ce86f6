//! One branch of postures along a path of tip poses.

use super::reach::{Reach, Refusal};
use crate::error::Result;
use crate::numerics::control::Control;
use nalgebra::Isometry3;

/// Largest change of an angle between two poses that counts as the same branch
/// \[rad\]: larger ones are looked at in smaller steps.
const LARGEST_CHANGE: f64 = 0.2;
/// Times a step is halved before the branch counts as ended.
const HALVINGS: usize = 10;
/// Most choices of full turns that are tried.
const MOST_TURNS: usize = 256;

/// Why a branch ends, and at which pose.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stopped {
    pub at: usize,
    pub refusal: Refusal,
}

/// The postures along `poses` from `start` at the first of them, with the full
/// turns that keep the whole path within its bounds, or where the
/// branch ends; stopped as `control` says.
pub(super) fn follow(
    reach: &Reach<'_>,
    poses: &[Isometry3<f64>],
    start: &[f64],
    control: Control<'_>,
) -> Result<std::result::Result<Vec<Vec<f64>>, Stopped>> {
    let mut offsets: Vec<Vec<f64>> = reach
        .inverse
        .turns_within_limits(start)
        .iter()
        .take(MOST_TURNS)
        .map(|q| q.iter().zip(start).map(|(a, b)| a - b).collect())
        .collect();
    if offsets.is_empty() {
        offsets.push(vec![0.0; start.len()]);
    }
    let mut path: Vec<Vec<f64>> = Vec::with_capacity(poses.len());
    for (at, pose) in poses.iter().enumerate() {
        control.check()?;
        let q = match path.last() {
            None => start.to_vec(),
            Some(before) => match step(reach, &poses[at - 1], pose, before, HALVINGS)? {
                Some(q) => q,
                None => {
                    let refusal = match reach.postures(pose)? {
                        Err(refusal) => refusal,
                        Ok(_) => Refusal::discontinuous(),
                    };
                    return Ok(Err(Stopped { at, refusal }));
                }
            },
        };
        let mut nearest = None;
        offsets.retain(|offset| match reach.outside(&added(&q, offset)) {
            None => true,
            Some(refusal) => {
                nearest = Some(refusal.nearer(nearest.take()));
                false
            }
        });
        let refusal = match nearest.filter(|_| offsets.is_empty()) {
            Some(refusal) => Some(refusal),
            // Full turns leave every link where it is.
            None => reach.forbidden(&q)?,
        };
        if let Some(refusal) = refusal {
            return Ok(Err(Stopped { at, refusal }));
        }
        path.push(q);
    }
    if let Some(offset) = offsets.first() {
        path = path.iter().map(|q| added(q, offset)).collect();
    }
    Ok(Ok(path))
}

fn added(q: &[f64], offset: &[f64]) -> Vec<f64> {
    q.iter().zip(offset).map(|(a, b)| a + b).collect()
}

/// The posture at `to` on the branch of `q` at `from`, by way of poses between
/// them where the angles change much.
fn step(
    reach: &Reach<'_>,
    from: &Isometry3<f64>,
    to: &Isometry3<f64>,
    q: &[f64],
    halvings: usize,
) -> Result<Option<Vec<f64>>> {
    let followed = reach.inverse.follow(&reach.flange(to), q).ok();
    if let Some(followed) = followed {
        let changes = followed.iter().zip(q).map(|(a, b)| (a - b).abs());
        if changes.fold(0.0, f64::max) <= LARGEST_CHANGE {
            return Ok(Some(followed));
        }
    }
    if halvings == 0 {
        return Ok(None);
    }
    // No shortest way between opposite orientations: the branch ends.
    let Some(between) = from.try_lerp_slerp(to, 0.5, 1e-9) else {
        return Ok(None);
    };
    match step(reach, from, &between, q, halvings - 1)? {
        Some(half) => step(reach, &between, to, &half, halvings - 1),
        None => Ok(None),
    }
}
