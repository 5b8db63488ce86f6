//! What comes nearest on a move.

use super::found::NearestOnTheWay;
use super::moves::{Moves, between};
use crate::error::Result;
use crate::model::cell::{Cell, LimitKind, LimitMargin};
use crate::model::inverse::largest_change;

/// Turn between two looks for what comes nearest on a move \[rad\].
const LOOK_EACH: f64 = 0.01;

/// What comes nearest along the legs of a move.
pub(super) fn nearest(
    cell: &Cell,
    ways: &mut Moves<'_>,
    legs: &[Vec<f64>],
) -> Result<Option<NearestOnTheWay>> {
    let mut least: Option<NearestOnTheWay> = None;
    for leg in legs.windows(2) {
        let looks = (largest_change(&leg[0], &leg[1]) / LOOK_EACH)
            .ceil()
            .max(1.0) as usize;
        for look in 0..=looks {
            let q = between(&leg[0], &leg[1], look as f64 / looks as f64);
            let Some(margin) = ways.smallest(&q)? else {
                return Ok(None);
            };
            let distance_m = margin.margin + allowance(cell, ways.cell, &margin);
            if least.as_ref().is_none_or(|l| distance_m < l.distance_m) {
                least = Some(NearestOnTheWay {
                    kind: margin.kind,
                    subject: margin.point,
                    distance_m,
                });
            }
        }
    }
    Ok(least)
}

/// What a margin of the way's cell leaves out of the distance itself.
fn allowance(cell: &Cell, way_cell: &Cell, margin: &LimitMargin) -> f64 {
    let less = |own: Option<f64>, way: Option<f64>| way.zip(own).map_or(0.0, |(w, o)| w - o);
    match margin.kind {
        LimitKind::Shapes => way_cell.scene.clearance(),
        LimitKind::RopeClearance => {
            let rope = way_cell.scene.rope();
            rope.and_then(|rope| rope.clearance).unwrap_or(0.0)
        }
        LimitKind::Floor => less(cell.limits.floor, way_cell.limits.floor),
        LimitKind::KeepOut => less(cell.limits.keep_out_radius, way_cell.limits.keep_out_radius),
        _ => 0.0,
    }
}
