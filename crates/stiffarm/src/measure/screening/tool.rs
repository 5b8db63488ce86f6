//! The measuring points as one rigid body that sits elsewhere on the flange than the cell says.

use super::frame::{item_pairs, items};
use super::rigid::{Pair, fit, misfit, moved};
use super::{Cause, Suspicion, Work};
use crate::numerics::arrangements::signed_axes;
use crate::numerics::information::Factor;
use crate::numerics::order::sort_by_number;
use crate::units::{m_to_mm, rad_to_deg};
use nalgebra::{DMatrix, DVector, Isometry3, Rotation3, Translation3, UnitQuaternion, Vector6};

/// Starts that are followed, and steps of each.
const FOLLOWED: usize = 4;
const STEPS: usize = 30;
/// Step for a derivative by differences \[m, rad\], and change that ends the search.
const DIFFERENCE: f64 = 1e-6;
const SETTLED_CHANGE: f64 = 1e-9;

/// The motion of the measuring points on the flange that suits the unloaded readings best, from all quarter turns.
pub(super) fn place(work: &Work) -> Option<Isometry3<f64>> {
    let at = items(work);
    let mut setup = work.setup().clone();
    let points = setup.tool.measuring_points.clone();
    let mut pairs = |motion: &Isometry3<f64>| -> Vec<Pair> {
        for (point, drawn) in setup.tool.measuring_points.iter_mut().zip(&points) {
            point.position = moved(motion, &drawn.position);
        }
        item_pairs(work, &setup, &at).concat()
    };
    let turns = signed_axes().filter(|turn| turn.determinant() > 0.0);
    let mut starts: Vec<(f64, Isometry3<f64>)> = turns
        .filter_map(|turn| {
            let turn = Rotation3::from_matrix_unchecked(turn);
            let turn = UnitQuaternion::from_rotation_matrix(&turn);
            let start = Isometry3::from_parts(Translation3::identity(), turn);
            let pairs = pairs(&start);
            Some((misfit(&fit(&pairs)?, &pairs), start))
        })
        .collect();
    sort_by_number(&mut starts, |(value, _)| *value);
    starts.truncate(FOLLOWED);
    let mut best: Option<(f64, Isometry3<f64>)> = None;
    for (mut value, mut motion) in starts {
        let mut left = |motion: &Isometry3<f64>| -> Option<DVector<f64>> {
            let pairs = pairs(motion);
            let transform = fit(&pairs)?;
            let rows = pairs.iter().flat_map(|(a, b)| {
                let off = moved(&transform, a) - b;
                [off.x, off.y, off.z]
            });
            Some(DVector::from_iterator(3 * pairs.len(), rows))
        };
        for _ in 0..STEPS {
            let now = left(&motion)?;
            let mut slopes = DMatrix::zeros(now.len(), 6);
            for k in 0..6 {
                let beside = |by: f64| by_small(&motion, &(Vector6::ith(k, 1.0) * by));
                let slope = left(&beside(DIFFERENCE))? - left(&beside(-DIFFERENCE))?;
                slopes.set_column(k, &(slope / (2.0 * DIFFERENCE)));
            }
            let step = Factor::new(&slopes).ok()?.solve(&-now);
            let step = Vector6::from_column_slice(step.as_slice());
            let shares = [1.0, 0.3, 0.1, 0.03].into_iter();
            let better = shares
                .map(|share| by_small(&motion, &(step * share)))
                .filter_map(|next| Some((left(&next)?.norm_squared(), next)))
                .find(|(next, _)| *next < value);
            let Some((next, place)) = better else { break };
            let fall = value - next;
            (value, motion) = (next, place);
            if fall < SETTLED_CHANGE * value {
                break;
            }
        }
        if best.as_ref().is_none_or(|(least, _)| value < *least) {
            best = Some((value, motion));
        }
    }
    best.map(|(_, motion)| motion)
}

/// Moved on by a small shift and turn.
fn by_small(motion: &Isometry3<f64>, step: &Vector6<f64>) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(step.fixed_rows::<3>(3).into_owned());
    let shift = motion.translation.vector + step.fixed_rows::<3>(0);
    Isometry3::from_parts(shift.into(), turn * motion.rotation)
}

/// The suspicion with the motion: shift in millimetres, axis and angle.
pub(super) fn suspicion(motion: &Isometry3<f64>) -> Suspicion {
    let mut out = Suspicion::new(Cause::ToolPlace).off(motion.translation.vector.norm());
    out.tool_shift_mm = motion.translation.vector.iter().map(|v| m_to_mm(*v)).collect();
    out.angles_deg = motion.rotation.scaled_axis().iter().map(|v| rad_to_deg(*v)).collect();
    out
}
