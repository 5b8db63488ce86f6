//! Pairs of parts and the distance between them.

use super::placed_parts::{Bounded, PlacedParts};
use super::slope::Touch;
use crate::model::shape::{Capsule, Nearest, Solid, between, nearest_within};

/// Two parts that are kept apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pair {
    /// The part that moves.
    pub mover: usize,
    /// The other.
    pub solid: usize,
}

/// A line and how each end moves.
pub(super) struct Line {
    pub capsule: Capsule,
    pub moved_by: [usize; 2],
}

/// Distance between a line's surface and a solid in the base frame, or a lower bound
/// of it that is not below `enough`; with the derivative where it is exact.
#[inline]
pub(super) fn line_to_solid(line: &Line, solid: &Bounded, solid_moved_by: usize, enough: f64) -> (f64, Option<Touch>) {
    let Capsule { a, b, radius } = line.capsule;
    let bound = solid.least_distance(&a, &b) - radius;
    if bound >= enough {
        return (bound, None);
    }
    let Some(at) = nearest_within(&solid.solid, &a, &b, enough + radius) else {
        return (enough, None);
    };
    let touch = Touch { ends: [a, b], moved_by: line.moved_by, solid_moved_by, at };
    (at.distance - radius, Some(touch))
}

impl Pair {
    /// Distance between both parts, or a lower bound not below `enough`.
    pub fn distance(&self, placed: &PlacedParts<'_>, enough: f64) -> (f64, Option<Touch>) {
        let (moved, solid_moved) = (placed.moved_by(self.mover), placed.moved_by(self.solid));
        let moved_by = [moved, moved];
        let mut best = (f64::INFINITY, None);
        for mover in placed.solids(self.mover) {
            for solid in placed.solids(self.solid) {
                let enough = best.0.min(enough);
                let separation = match mover.solid {
                    Solid::Capsule(capsule) => {
                        let line = Line { capsule, moved_by };
                        line_to_solid(&line, solid, solid_moved, enough)
                    }
                    _ => solid_to_solid(mover, moved_by, solid, solid_moved, enough),
                };
                if separation.0 < best.0 {
                    best = separation;
                }
            }
        }
        best
    }
}

/// The same of two solids.
fn solid_to_solid(
    mover: &Bounded,
    moved_by: [usize; 2],
    solid: &Bounded,
    solid_moved_by: usize,
    enough: f64,
) -> (f64, Option<Touch>) {
    let bound = solid.solid.signed_distance(&mover.centre).0 - mover.radius;
    if bound >= enough {
        return (bound, None);
    }
    let Some(at) = between(&mover.solid, &solid.solid, enough) else {
        return (enough, None);
    };
    let touch = Touch {
        ends: [at.point; 2],
        moved_by,
        solid_moved_by,
        at: Nearest { distance: at.distance, t: 0.0, direction: at.direction },
    };
    (at.distance, Some(touch))
}
