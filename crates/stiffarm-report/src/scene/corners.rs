//! Corners of solids and boxes.

use stiffarm::model::shape::Solid;
use stiffarm::nalgebra::{Point3, Vector3};

/// Points of a circle.
const ROUND: usize = 40;

/// Points on the solid's edges, those of round edges sampled; empty for what has no end.
pub(crate) fn corner_points(solid: &Solid) -> Vec<Vector3<f64>> {
    match solid {
        Solid::Capsule(capsule) => {
            let r = capsule.radius;
            let ends = [capsule.a, capsule.b];
            let sides = [-1.0, 1.0];
            ends.iter()
                .flat_map(|end| {
                    let along = (0..3).flat_map(move |i| sides.map(|side| end + Vector3::ith(i, side * r)));
                    along.collect::<Vec<_>>()
                })
                .collect()
        }
        Solid::Block { pose, half } => {
            corners(&-half, half).iter().map(|corner| (pose * Point3::from(*corner)).coords).collect()
        }
        Solid::Cylinder { pose, half_length, radius } => {
            let axes = [Vector3::x(), Vector3::y()].map(|axis| pose.rotation * axis);
            let along = pose.rotation * Vector3::z() * *half_length;
            let middle = pose.translation.vector;
            let mut points = circle(middle - along, *radius, axes);
            points.extend(circle(middle + along, *radius, axes));
            points
        }
        Solid::HalfSpace { .. } => Vec::new(),
    }
}

/// Points of a circle in the plane of two axes.
pub(crate) fn circle(centre: Vector3<f64>, radius: f64, axes: [Vector3<f64>; 2]) -> Vec<Vector3<f64>> {
    (0..ROUND)
        .map(|i| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / ROUND as f64).sin_cos();
            centre + (axes[0] * cos + axes[1] * sin) * radius
        })
        .collect()
}

/// Corners of a box, its smallest first and its largest last.
pub(crate) fn corners(low: &Vector3<f64>, high: &Vector3<f64>) -> [Vector3<f64>; 8] {
    let ends = [low, high];
    [0_usize, 1, 2, 3, 4, 5, 6, 7].map(|i| {
        let pick = |axis: usize| ends[i >> axis & 1][axis];
        Vector3::new(pick(0), pick(1), pick(2))
    })
}

/// Edges of a box by its [`corners`].
pub(crate) fn edges(corners: &[Vector3<f64>]) -> impl Iterator<Item = [Vector3<f64>; 2]> {
    let ends = (0..8_usize).flat_map(|i| [1, 2, 4].map(|bit| [i, i | bit]));
    ends.filter(|[a, b]| a != b).map(|ends| ends.map(|i| corners[i]))
}

/// Smallest and largest corner of the box around points.
pub(super) fn bounds(points: &[Vector3<f64>]) -> (Vector3<f64>, Vector3<f64>) {
    let none = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    let finite = points.iter().filter(|p| p.iter().all(|v| v.is_finite()));
    finite.fold(none, |(low, high), p| (low.inf(p), high.sup(p)))
}
