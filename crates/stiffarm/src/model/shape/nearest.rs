//! The point of a segment that is nearest to a convex solid, or deepest in it.

use super::signed_distance::any_across;
use super::{Capsule, Solid};
use nalgebra::Vector3;

/// Halvings of the segment: its position is exact to rounding.
const HALVINGS: usize = 54;

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
/// Detection", 2005, section 5.1.9), against a plane at an end; else by halving the segment by
/// the sign of the slope, which a convex function allows.
pub fn nearest(solid: &Solid, a: &Vector3<f64>, b: &Vector3<f64>) -> Nearest {
    match solid {
        Solid::Capsule(capsule) => nearest_to_capsule(capsule, a, b),
        Solid::HalfSpace { .. } => {
            let (at_a, at_b) = (solid.signed_distance(a), solid.signed_distance(b));
            let ((distance, direction), t) = if at_b.0 < at_a.0 {
                (at_b, 1.0)
            } else {
                (at_a, 0.0)
            };
            Nearest {
                distance,
                t,
                direction,
            }
        }
        _ => nearest_by_slope(solid, a, b),
    }
}

fn nearest_by_slope(solid: &Solid, a: &Vector3<f64>, b: &Vector3<f64>) -> Nearest {
    let along = b - a;
    let at = |t: f64| {
        let (distance, direction) = solid.signed_distance(&(a + along * t));
        let slope = direction.dot(&along);
        (
            Nearest {
                distance,
                t,
                direction,
            },
            slope,
        )
    };
    let (first, falls) = at(0.0);
    if falls >= 0.0 {
        return first;
    }
    let (last, rises) = at(1.0);
    if rises <= 0.0 {
        return last;
    }
    let (mut low, mut high) = ((first, falls), (last, rises));
    for _ in 0..HALVINGS {
        let (middle, slope) = at(0.5 * (low.0.t + high.0.t));
        if slope > 0.0 {
            high = (middle, slope);
        } else if slope < 0.0 {
            low = (middle, slope);
        } else {
            return middle;
        }
    }
    let best = if low.0.distance < high.0.distance {
        low.0
    } else {
        high.0
    };
    // Deep inside, the minimum may be a kink between two faces: neither slope is zero there, but the
    // mean that weighs them to zero is, and its direction is the derivative.
    let share = high.1 / (high.1 - low.1);
    Nearest {
        direction: low.0.direction * share + high.0.direction * (1.0 - share),
        ..best
    }
}

fn nearest_to_capsule(capsule: &Capsule, a: &Vector3<f64>, b: &Vector3<f64>) -> Nearest {
    let (own, other) = (b - a, capsule.b - capsule.a);
    let between = a - capsule.a;
    let (aa, bb) = (own.norm_squared(), other.norm_squared());
    let (ab, ar, br) = (own.dot(&other), own.dot(&between), other.dot(&between));
    // Squares below this are points.
    let point = 1e-24;
    let on_other = |t: f64| match bb > point {
        true => ((br + ab * t) / bb).clamp(0.0, 1.0),
        false => 0.0,
    };
    let on_own = |s: f64| match aa > point {
        true => ((ab * s - ar) / aa).clamp(0.0, 1.0),
        false => 0.0,
    };
    let determinant = aa * bb - ab * ab;
    let first = match determinant > 1e-14 * aa * bb {
        true => ((ab * br - ar * bb) / determinant).clamp(0.0, 1.0),
        false => 0.0,
    };
    // Clamped in turn; for parallel segments from either end.
    let mut best = Nearest {
        distance: f64::INFINITY,
        t: 0.0,
        direction: Vector3::z(),
    };
    let mut best_across = Vector3::zeros();
    for start in [first, 1.0] {
        let s = on_other(start);
        let t = on_own(s);
        let s = on_other(t);
        let across = (a + own * t) - (capsule.a + other * s);
        let distance = across.norm();
        if distance < best.distance {
            best = Nearest {
                distance,
                t,
                direction: Vector3::z(),
            };
            best_across = across;
        }
        if determinant > 1e-14 * aa * bb {
            break;
        }
    }
    best.direction = match best.distance > 1e-12 {
        true => best_across / best.distance,
        // Segments that cross part fastest across both.
        false => own
            .cross(&other)
            .try_normalize(1e-12)
            .unwrap_or_else(|| any_across(&own)),
    };
    best.distance -= capsule.radius;
    best
}
