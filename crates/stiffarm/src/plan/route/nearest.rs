//! What comes nearest on a move.

use super::moves::{Moves, between};
use super::planned_route::NearestOnTheWay;
use crate::error::Result;
use crate::model::cell::{Cell, LimitKind};
use crate::model::inverse::largest_change;
use std::collections::VecDeque;

/// Turn between two looks at first \[rad\].
const LOOK_EACH: f64 = 0.01;
/// What is told may be this much less than the truth \[m\], and more only after the most looks of a move.
const TOLERANCE: f64 = 1e-5;
const MOST_LOOKS: usize = 4000;

/// What comes nearest along the legs of a move. No point moves farther than each joint's turn times that joint's reach,
/// so two looks say how near anything may come between them; that bound is told, never more than the
/// truth. On a move that is not free it is what leaves least of the room that is asked.
pub(super) fn nearest(
    cell: &Cell,
    ways: &mut Moves<'_>,
    legs: &[Vec<f64>],
    free: bool,
) -> Result<Option<NearestOnTheWay>> {
    let [first, .., last] = legs else {
        return Ok(None);
    };
    ways.begin(first, last)?;
    let about = ways.named(first)?;
    let each = about.iter().zip(ways.leeway());
    let added: Vec<f64> = each
        .map(|(margin, leeway)| match (free, margin.kind.keeps_off()) {
            (true, true) => allowance(cell, ways.cell, margin.kind),
            (true, false) => f64::INFINITY,
            (false, _) => *leeway,
        })
        .collect();
    let Some(least) = SmallestMargin::of(ways, legs, &added)? else {
        return Ok(None);
    };
    let Some(margin) = about.get(least.which) else {
        return Ok(None);
    };
    let left_out = if free { 0.0 } else { allowance(cell, ways.cell, margin.kind) - added[least.which] };
    Ok(Some(NearestOnTheWay { kind: margin.kind, subject: margin.point.clone(), distance_m: least.bound + left_out }))
}

/// What a margin of the way's cell leaves out of the distance itself.
fn allowance(cell: &Cell, way_cell: &Cell, kind: LimitKind) -> f64 {
    let less = |limit: Option<f64>, way: Option<f64>| way.zip(limit).map_or(0.0, |(w, o)| w - o);
    match kind {
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

/// The smallest of some margins, each with something added, along a way.
struct SmallestMargin {
    /// The smallest that was seen, and which of them it was.
    seen: f64,
    which: usize,
    /// The smallest that any can be.
    bound: f64,
}

/// Between two looks.
struct LegInterval {
    leg: usize,
    shares: [f64; 2],
    seen: [f64; 2],
}

impl SmallestMargin {
    /// `None` where none of them counts.
    fn of(ways: &mut Moves<'_>, legs: &[Vec<f64>], added: &[f64]) -> Result<Option<Self>> {
        if !added.iter().any(|added| added.is_finite()) {
            return Ok(None);
        }
        let mut least = SmallestMargin { seen: f64::INFINITY, which: 0, bound: f64::INFINITY };
        let travels: Vec<f64> = legs.windows(2).map(|leg| ways.travel(&leg[0], &leg[1])).collect();
        let mut open = VecDeque::new();
        for (leg, ends) in legs.windows(2).enumerate() {
            let turn = largest_change(&ends[0], &ends[1]);
            let looks = (turn / LOOK_EACH).ceil().max(1.0) as usize;
            let each = travels[leg] / looks as f64;
            let mut before = 0.0;
            for look in 0..=looks {
                let share = look as f64 / looks as f64;
                let now = least.look(ways, &between(&ends[0], &ends[1], share), added, each)?;
                if look > 0 {
                    open.push_back(LegInterval {
                        leg,
                        shares: [(look - 1) as f64 / looks as f64, share],
                        seen: [before, now],
                    });
                }
                before = now;
            }
        }
        let mut looks = 0;
        while let Some(LegInterval { leg, shares, seen }) = open.pop_front() {
            let length = travels[leg] * (shares[1] - shares[0]);
            let bound = 0.5 * (seen[0] + seen[1] - length);
            if bound >= least.seen - TOLERANCE || looks == MOST_LOOKS {
                least.bound = least.bound.min(bound);
                continue;
            }
            looks += 1;
            let middle = 0.5 * (shares[0] + shares[1]);
            let q = between(&legs[leg], &legs[leg + 1], middle);
            let at = least.look(ways, &q, added, 0.5 * length)?;
            let halves = [(shares[0], middle, seen[0], at), (middle, shares[1], at, seen[1])];
            open.extend(halves.map(|(a, b, at_a, at_b)| LegInterval { leg, shares: [a, b], seen: [at_a, at_b] }));
        }
        least.bound = least.bound.min(least.seen);
        Ok(Some(least))
    }

    /// Looks at one posture, exactly where it has less than was seen or little more than `near`.
    fn look(&mut self, ways: &mut Moves<'_>, q: &[f64], added: &[f64], near: f64) -> Result<f64> {
        let smallest = added.iter().fold(f64::INFINITY, |least, a| least.min(*a));
        let values = ways.margins(q, self.seen - smallest + 2.0 * near)?;
        let each = values.iter().zip(added).map(|(value, added)| value + added).enumerate();
        let Some((which, value)) = each.min_by(|a, b| a.1.total_cmp(&b.1)) else {
            return Ok(f64::INFINITY);
        };
        if value < self.seen {
            (self.seen, self.which) = (value, which);
        }
        Ok(value)
    }
}
