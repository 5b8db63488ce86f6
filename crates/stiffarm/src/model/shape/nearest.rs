//! The point of a segment that is nearest to a convex solid, or deepest in it.

use super::signed_distance::{any_across, of_block, of_cylinder};
use super::{Capsule, Solid};
use nalgebra::{Isometry3, Vector3};

/// Steps after which the narrowest segment is good enough: halving alone, every third of them, is
/// exact to rounding.
const STEPS: usize = 160;

/// Where a segment is nearest to a solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Signed distance there \[m\].
    pub distance: f64,
    /// The point: `a` + t (`b` − `a`).
    pub t: f64,
    /// Direction away from the solid: the derivative of the distance by the point. Of unit length but
    /// where a segment is as deep below one face as below another.
    pub direction: Vector3<f64>,
}

/// The smallest signed distance of the points of the segment from `a` to `b`, and where.
/// Segment and solid are in the same frame.
///
/// Against a capsule by the closest points of two segments (Ericson, "Real-Time Collision
/// Detection", 2005, section 5.1.9), against a plane at an end; else by narrowing the segment by
/// the sign of the slope, which a convex function allows.
pub fn nearest(solid: &Solid, a: &Vector3<f64>, b: &Vector3<f64>) -> Nearest {
    nearest_within(solid, a, b, f64::INFINITY).unwrap_or_else(|| {
        // Only coordinates that are no numbers come here.
        let (distance, direction) = solid.signed_distance(a);
        Nearest { distance, t: 0.0, direction }
    })
}

/// As [`nearest`], or `None` where that is `enough` or more and not worth the work of finding it exactly.
pub(crate) fn nearest_within(solid: &Solid, a: &Vector3<f64>, b: &Vector3<f64>, enough: f64) -> Option<Nearest> {
    match solid {
        Solid::Capsule(capsule) => Some(nearest_to_capsule(capsule, a, b)),
        Solid::HalfSpace { .. } => {
            let (at_a, at_b) = (solid.signed_distance(a), solid.signed_distance(b));
            let ((distance, direction), t) = if at_b.0 < at_a.0 { (at_b, 1.0) } else { (at_a, 0.0) };
            Some(Nearest { distance, t, direction })
        }
        Solid::Block { pose, half } => {
            let (a, b) = own_axes(pose, a, b);
            let at = nearest_by_slope(|p| of_block(half, p), &a, &b, enough)?;
            Some(Nearest { direction: pose.rotation * at.direction, ..at })
        }
        Solid::Cylinder { pose, half_length, radius } => {
            let (a, b) = own_axes(pose, a, b);
            let at = nearest_by_slope(|p| of_cylinder(*half_length, *radius, p), &a, &b, enough)?;
            Some(Nearest { direction: pose.rotation * at.direction, ..at })
        }
    }
}

/// Where the tangents at two points of a convex function meet: at which t, and how low; the
/// function is nowhere between them below that.
fn tangents((low, falls): &(Nearest, f64), (high, rises): &(Nearest, f64)) -> (f64, f64) {
    let t = (high.distance - low.distance + falls * low.t - rises * high.t) / (falls - rises);
    (t, low.distance + falls * (t - low.t))
}

fn own_axes(pose: &Isometry3<f64>, a: &Vector3<f64>, b: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let local = |p: &Vector3<f64>| pose.inverse_transform_point(&(*p).into()).coords;
    (local(a), local(b))
}

fn nearest_by_slope(
    signed_distance: impl Fn(&Vector3<f64>) -> (f64, Vector3<f64>),
    a: &Vector3<f64>,
    b: &Vector3<f64>,
    enough: f64,
) -> Option<Nearest> {
    let along = b - a;
    let at = |t: f64| {
        let (distance, direction) = signed_distance(&(a + along * t));
        let slope = direction.dot(&along);
        (Nearest { distance, t, direction }, slope)
    };
    let mut low = at(0.0);
    if low.1 >= 0.0 {
        return Some(low.0);
    }
    let mut high = at(1.0);
    if high.1 <= 0.0 {
        return Some(high.0);
    }
    for step in 0..STEPS {
        let (meet, least) = tangents(&low, &high);
        if least >= enough {
            return None;
        }
        let width = high.0.t - low.0.t;
        let best = low.0.distance.min(high.0.distance);
        if best - least <= 4.0 * f64::EPSILON * (1.0 + best.abs()) || width <= f64::EPSILON {
            break;
        }
        // The tangents find a kink at once, the secant of the slopes a smooth minimum; halving keeps both honest.
        let next = match step % 3 {
            0 => meet,
            1 => low.0.t - low.1 * width / (high.1 - low.1),
            _ => 0.5 * (low.0.t + high.0.t),
        };
        let inside = next > low.0.t && next < high.0.t;
        let middle = at(if inside { next } else { 0.5 * (low.0.t + high.0.t) });
        if middle.1 > 0.0 {
            high = middle;
        } else if middle.1 < 0.0 {
            low = middle;
        } else {
            return Some(middle.0);
        }
    }
    let best = if low.0.distance < high.0.distance { low.0 } else { high.0 };
    // Deep inside, the minimum may be a kink between two faces: neither slope is zero there, but the
    // mean that weighs them to zero is, and its direction is the derivative.
    let share = high.1 / (high.1 - low.1);
    Some(Nearest { direction: low.0.direction * share + high.0.direction * (1.0 - share), ..best })
}

fn nearest_to_capsule(capsule: &Capsule, a: &Vector3<f64>, b: &Vector3<f64>) -> Nearest {
    let (segment, other) = (b - a, capsule.b - capsule.a);
    let between = a - capsule.a;
    let (aa, bb) = (segment.norm_squared(), other.norm_squared());
    let (ab, ar, br) = (segment.dot(&other), segment.dot(&between), other.dot(&between));
    // Squares below this are points.
    let point = 1e-24;
    let on_other = |t: f64| {
        if bb > point { ((br + ab * t) / bb).clamp(0.0, 1.0) } else { 0.0 }
    };
    let on_own = |s: f64| {
        if aa > point { ((ab * s - ar) / aa).clamp(0.0, 1.0) } else { 0.0 }
    };
    let determinant = aa * bb - ab * ab;
    let first = if determinant > 1e-14 * aa * bb { ((ab * br - ar * bb) / determinant).clamp(0.0, 1.0) } else { 0.0 };
    // Clamped in turn; for parallel segments from either end.
    let mut best = Nearest { distance: f64::INFINITY, t: 0.0, direction: Vector3::z() };
    let mut best_across = Vector3::zeros();
    for start in [first, 1.0] {
        let s = on_other(start);
        let t = on_own(s);
        let s = on_other(t);
        let across = (a + segment * t) - (capsule.a + other * s);
        let distance = across.norm();
        if distance < best.distance {
            best = Nearest { distance, t, direction: Vector3::z() };
            best_across = across;
        }
        if determinant > 1e-14 * aa * bb {
            break;
        }
    }
    best.direction = if best.distance > 1e-12 {
        best_across / best.distance
    } else {
        // Segments that cross part fastest across both.
        segment.cross(&other).try_normalize(1e-12).unwrap_or_else(|| any_across(&segment))
    };
    best.distance -= capsule.radius;
    best
}
