//! What is asked of the rope.

use super::placed_parts::Bounded;
use super::slope::Slope;
use crate::model::shape::nearest_within;
use nalgebra::{Unit, Vector3};

/// What the rope must not touch, and the cone in which its loading device may pull.
#[derive(Debug, Clone, PartialEq)]
pub struct RopeRules {
    /// Distance kept between the rope and every part \[m\]; `None` lets it touch.
    pub clearance: Option<f64>,
    /// Lengths at the loading point and at the anchor that may touch what they are fixed to \[m\].
    pub free: [f64; 2],
    /// Axis from the anchor outwards, base axes, and the largest angle between it and the rope \[rad\].
    pub cone: Option<(Unit<Vector3<f64>>, f64)>,
}

/// Distance of the rope from the loading point `p` to the anchor, but for its free ends, to a solid;
/// or a lower bound not below `enough`.
pub(super) fn rope_to_solid(
    p: &Vector3<f64>,
    anchor: &Vector3<f64>,
    free: [f64; 2],
    solid: &Bounded,
    (moved_by, solid_moved_by): (usize, usize),
    enough: f64,
) -> (f64, Option<Slope<'static>>) {
    let length = (anchor - p).norm();
    if length <= free[0] + free[1] {
        return (f64::INFINITY, None);
    }
    let unit = (anchor - p) / length;
    let (a, b) = (p + unit * free[0], anchor - unit * free[1]);
    let bound = solid.least_distance(&a, &b);
    if bound >= enough {
        return (bound, None);
    }
    let Some(at) = nearest_within(&solid.solid, &a, &b, enough) else {
        return (enough, None);
    };
    let s = free[0] + at.t * (length - free[0] - free[1]);
    let point = p + unit * s;
    // The point at a fixed share of the rope moves by the shares of its ends; at a free end it keeps
    // its distance from that end, so it slides along the rope as the rope's length changes.
    let share = s / length;
    let along = at.direction.dot(&unit);
    let slide = match at.t {
        0.0 => along * free[0] / length,
        1.0 => -along * free[1] / length,
        _ => 0.0,
    };
    let on_point = at.direction * (1.0 - share) + unit * slide;
    let on_anchor = at.direction * share - unit * slide;
    let mut slope = Slope::NONE;
    slope.push(*p, on_point, moved_by);
    slope.push(point, -at.direction, solid_moved_by);
    slope.by_anchor = on_anchor;
    // A loading point that moves in the tool does not move the solid.
    slope.by_loading_point = on_point;
    (at.distance, Some(slope))
}

/// How far the rope is inside the cone about `axis` \[rad\].
pub(super) fn cone_margin(
    p: &Vector3<f64>,
    anchor: &Vector3<f64>,
    (axis, largest): &(Unit<Vector3<f64>>, f64),
    moved_by: usize,
) -> (f64, Slope<'static>) {
    let mut slope = Slope::NONE;
    let rope = p - anchor;
    let length = rope.norm();
    let unit = rope / length;
    let cosine = axis.dot(&unit).clamp(-1.0, 1.0);
    let sine = (1.0 - cosine * cosine).sqrt();
    if sine > 1e-9 {
        // −∂angle/∂p = ∂cos/∂p / sin.
        let force = (axis.into_inner() - unit * cosine) / (length * sine);
        slope.push(*p, force, moved_by);
        slope.by_anchor = -force;
        slope.by_loading_point = force;
    }
    (largest - cosine.acos(), slope)
}
