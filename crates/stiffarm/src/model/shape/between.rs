//! Signed distance of two convex solids.
//!
//! From a capsule it is the distance from the capsule's segment, from a plane that of a support point. Boxes and
//! cylinders are compared by the origin's distance from their Minkowski difference (Gilbert, Johnson and Keerthi
//! 1988, doi:10.1109/56.2083). Where they overlap, a layer is taken off one of them, each of its faces by
//! the same thickness, until it only touches: the distance is minus that thickness, of the two the thicker. That is the
//! depth below the surface of the deepest point that is inside both.

use super::nearest::{nearest, nearest_within};
use super::{Capsule, Solid};
use nalgebra::Vector3;

/// Points that are looked at for one distance.
const STEPS: usize = 100;
/// Upper and lower bound of a distance this near to each other are one \[m\].
const DISTANCE_TOLERANCE: f64 = 1e-14;
/// Layers that are tried, and how near the last of them leaves a touch \[m\].
const LAYERS: usize = 40;
const TOUCH: f64 = 1e-8;

/// Where two solids are nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Between {
    /// Signed distance \[m\], negative where they overlap.
    pub distance: f64,
    /// The point of the first that is nearest to the second, or deepest in it.
    pub point: Vector3<f64>,
    /// The derivative of the distance by a shift of the first: a unit vector away from the second where
    /// they do not overlap.
    pub direction: Vector3<f64>,
}

/// The signed distance of two solids in the same frame, or `None` where it is `enough` or more and not
/// worth the work of finding it exactly. Never above the true one by more than rounding; outside exact to
/// rounding. A half-space is the second of the two.
pub fn between(first: &Solid, second: &Solid, enough: f64) -> Option<Between> {
    match (first, second) {
        (Solid::Capsule(capsule), _) => {
            let at = nearest_within(second, &capsule.a, &capsule.b, enough + capsule.radius)?;
            Some(Between {
                distance: at.distance - capsule.radius,
                point: capsule.a + (capsule.b - capsule.a) * at.t - at.direction * capsule.radius,
                direction: at.direction,
            })
        }
        (_, Solid::Capsule(other)) => {
            let at = nearest_within(first, &other.a, &other.b, enough + other.radius)?;
            Some(Between {
                distance: at.distance - other.radius,
                point: other.a + (other.b - other.a) * at.t - at.direction * at.distance,
                direction: -at.direction,
            })
        }
        (_, Solid::HalfSpace { point, normal }) => {
            let support = first.support(&-normal.into_inner(), 0.0);
            Some(Between { distance: normal.dot(&(support - point)), point: support, direction: normal.into_inner() })
        }
        _ => match minkowski(first, 0.0, second, enough) {
            MinkowskiDistance::Enough => None,
            MinkowskiDistance::Apart(at) => Some(at),
            MinkowskiDistance::Overlap => {
                let (direct, other) = (peeled(first, second), peeled(second, first));
                Some(if direct.distance <= other.distance {
                    direct
                } else {
                    Between { direction: -other.direction, ..other }
                })
            }
        },
    }
}

/// How thick a layer has to go from the first solid until it touches the second from outside. The distance of
/// what is left is a convex function of the thickness, so Newton's steps come from its far side and
/// never overshoot.
fn peeled(first: &Solid, second: &Solid) -> Between {
    let most = first.half_thickness();
    let mut layer = most;
    let mut last = None;
    for _ in 0..LAYERS {
        let MinkowskiDistance::Apart(at) = minkowski(first, layer, second, f64::INFINITY) else {
            break;
        };
        // Taking off a layer moves each face by its thickness, and an edge by more.
        let faster = first.support_rate(&at.direction);
        let step = at.distance / faster;
        layer -= step;
        last = Some(Between { distance: -layer, point: at.point, direction: at.direction / faster });
        if step < TOUCH || layer <= 0.0 {
            break;
        }
    }
    last.unwrap_or_else(|| {
        // Not even its core is outside: how deep the middle of that is.
        let [a, b] = first.middle();
        let at = nearest(second, &a, &b);
        Between { distance: at.distance.min(0.0) - most, point: a + (b - a) * at.t, direction: at.direction }
    })
}

/// What the distance from a Minkowski difference comes to.
enum MinkowskiDistance {
    Apart(Between),
    Overlap,
    /// At least as far as was asked.
    Enough,
}

/// A corner of the simplex: a point of the first solid, and less the second's.
#[derive(Clone, Copy)]
struct Corner {
    point: Vector3<f64>,
    apart: Vector3<f64>,
}

/// Corners with their weights, the newest last, and the point nearest to the origin that they give.
struct Simplex {
    corners: Vec<(Corner, f64)>,
    nearest: Vector3<f64>,
}

/// The distance of the first solid, less a layer, from the second.
fn minkowski(first: &Solid, layer: f64, second: &Solid, enough: f64) -> MinkowskiDistance {
    let (_, away) = second.signed_distance(&first.ball().0);
    let mut simplex = Simplex { corners: Vec::with_capacity(4), nearest: away };
    // No direction shows more room than there is, and the nearest point found never less.
    let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
    for _ in 0..STEPS {
        let towards = simplex.nearest;
        let point = first.support(&-towards, layer);
        let apart = point - second.support(&towards, 0.0);
        least = least.max(towards.dot(&apart) / towards.norm());
        if least >= enough {
            return MinkowskiDistance::Enough;
        }
        let repeated = simplex.corners.iter().any(|(c, _)| c.apart == apart);
        if repeated || most - least <= DISTANCE_TOLERANCE * (1.0 + least.abs()) {
            break;
        }
        let Some(next) = simplex.with(Corner { point, apart }) else {
            return MinkowskiDistance::Overlap;
        };
        let norm = next.nearest.norm();
        if norm <= DISTANCE_TOLERANCE {
            return MinkowskiDistance::Overlap;
        }
        if norm >= most {
            break;
        }
        (simplex, most) = (next, norm);
    }
    if least <= 0.0 {
        return MinkowskiDistance::Overlap;
    }
    let points = simplex.corners.iter().map(|(c, weight)| c.point * *weight);
    let mut at = Between { distance: least, point: points.sum(), direction: simplex.nearest / most };
    if layer == 0.0 && least > TOUCH {
        // Corners that crowd around a rounded place leave the direction a few digits less than the distance.
        for _ in 0..2 {
            let (away, normal) = second.signed_distance(&at.point);
            let other = at.point - normal * away;
            let (back, towards) = first.signed_distance(&other);
            (at.point, at.direction) = (other - towards * back, -towards);
        }
    }
    MinkowskiDistance::Apart(at)
}

impl Simplex {
    /// With one more corner, and without those that the nearest point does not need; `None` where the origin
    /// is inside. The nearest point is in a face that has the new corner.
    fn with(&self, new: Corner) -> Option<Simplex> {
        let w = new.apart;
        let old: Vec<Corner> = self.corners.iter().map(|(corner, _)| *corner).collect();
        let edge = |i: usize| old[i].apart - w;
        let mut best = Simplex { corners: vec![(new, 1.0)], nearest: w };
        let mut take = |nearest: Vector3<f64>, others: &[(usize, f64)]| {
            let rest: f64 = others.iter().map(|(_, weight)| weight).sum();
            let is_inside = rest < 1.0 && others.iter().all(|(_, weight)| *weight > 0.0);
            if is_inside && nearest.norm_squared() < best.nearest.norm_squared() {
                best.corners.clear();
                best.corners.extend(others.iter().map(|(i, weight)| (old[*i], *weight)));
                best.corners.push((new, 1.0 - rest));
                best.nearest = nearest;
            }
        };
        for i in 0..old.len() {
            let e = edge(i);
            let t = -w.dot(&e) / e.norm_squared();
            take(w + e * t, &[(i, t)]);
            for j in i + 1..old.len() {
                let f = edge(j);
                let normal = e.cross(&f);
                let square = normal.norm_squared();
                let nearest = normal * (normal.dot(&w) / square);
                let across = nearest - w;
                let weights = [across.cross(&f), e.cross(&across)].map(|v| v.dot(&normal) / square);
                take(nearest, &[(i, weights[0]), (j, weights[1])]);
            }
        }
        if let [a, b, c] = old[..] {
            let [e, f, g] = [a, b, c].map(|corner| corner.apart - w);
            let volume = e.dot(&f.cross(&g));
            let weights = [f.cross(&g), g.cross(&e), e.cross(&f)].map(|v| -w.dot(&v) / volume);
            if weights.iter().all(|weight| *weight > 0.0) && weights.iter().sum::<f64>() < 1.0 {
                return None;
            }
        }
        Some(best)
    }
}

impl Solid {
    /// The farthest point in a direction of any length, after a layer has been taken off all faces.
    fn support(&self, along: &Vector3<f64>, layer: f64) -> Vector3<f64> {
        match self {
            Solid::Block { pose, half } => {
                let local = pose.rotation.inverse() * along;
                let corner = half.zip_map(&local, |half, way| (half - layer).copysign(way));
                pose.rotation * corner + pose.translation.vector
            }
            Solid::Cylinder { pose, half_length, radius } => {
                let local = pose.rotation.inverse() * along;
                let across = local.x.hypot(local.y);
                let out = if across > 0.0 { (radius - layer) / across } else { 0.0 };
                let up = (half_length - layer).copysign(local.z);
                let corner = Vector3::new(local.x * out, local.y * out, up);
                pose.rotation * corner + pose.translation.vector
            }
            Solid::Capsule(Capsule { a, b, radius }) => {
                let end = if along.dot(&(b - a)) > 0.0 { b } else { a };
                end + along.normalize() * (radius - layer)
            }
            Solid::HalfSpace { point, .. } => *point,
        }
    }

    /// How fast the support in a direction of unit length falls as a layer is taken off.
    fn support_rate(&self, along: &Vector3<f64>) -> f64 {
        match self {
            Solid::Block { pose, .. } => (pose.rotation.inverse() * along).abs().sum(),
            Solid::Cylinder { pose, .. } => {
                let local = pose.rotation.inverse() * along;
                local.x.hypot(local.y) + local.z.abs()
            }
            _ => 1.0,
        }
    }

    /// The thickest layer that can be taken off all faces.
    fn half_thickness(&self) -> f64 {
        match self {
            Solid::Block { half, .. } => half.min(),
            Solid::Cylinder { half_length, radius, .. } => half_length.min(*radius),
            Solid::Capsule(capsule) => capsule.radius,
            Solid::HalfSpace { .. } => f64::INFINITY,
        }
    }

    /// The longest segment along an axis that is left when that layer is gone.
    fn middle(&self) -> [Vector3<f64>; 2] {
        let (pose, way) = match self {
            Solid::Block { pose, half } => {
                let long = half.imax();
                (pose, Vector3::ith(long, half[long] - half.min()))
            }
            Solid::Cylinder { pose, half_length, radius } => (pose, Vector3::z() * (half_length - radius).max(0.0)),
            Solid::Capsule(capsule) => return [capsule.a, capsule.b],
            Solid::HalfSpace { point, .. } => return [*point; 2],
        };
        let end = pose.rotation * way;
        [pose.translation.vector - end, pose.translation.vector + end]
    }

    /// Distance of the farthest point from the origin of the frame \[m\].
    pub(crate) fn farthest(&self) -> f64 {
        match self {
            Solid::Capsule(c) => c.a.norm().max(c.b.norm()) + c.radius,
            Solid::Block { pose, half } => (pose.inverse().translation.vector.abs() + half).norm(),
            Solid::Cylinder { pose, half_length, radius } => {
                let local = pose.inverse().translation.vector;
                (local.x.hypot(local.y) + radius).hypot(local.z.abs() + half_length)
            }
            Solid::HalfSpace { .. } => f64::INFINITY,
        }
    }
}
