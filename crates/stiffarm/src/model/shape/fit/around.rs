//! One capsule around points.

use super::super::Capsule;
use crate::numerics::nelder_mead::nelder_mead;
use crate::numerics::order::sort_by_number;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use std::f64::consts::{PI, TAU};

/// How long to look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effort {
    /// To compare cuts: few points, few starts; it may not contain all points.
    Rough,
    /// All of it.
    Full,
}

/// Whole multiples of this \[m\]: a hundredth of a millimetre.
const GRID: f64 = 1e5;
/// Rounds of adding the points that stick out.
const ROUNDS: usize = 30;
/// Directions of the half sphere that starts are taken from, and how much wider than necessary.
const SPREAD: usize = 80;
const WIDTHS: [f64; 4] = [0.0, 0.03, 0.1, 0.25];
/// Ends of searches that go on.
const AGAIN: usize = 4;
/// Points added in a round.
const ADDED: usize = 40;

/// A small capsule around all `points`, of which there is at least one.
///
/// For an axis the smallest radius is widened by a free amount and the segment shortened as far as
/// the points allow; a simplex search runs over direction, position and widening of the axis from
/// the best of many starts. It looks at the outermost points in many directions; those that stick out of the
/// result are added and the search goes on.
pub(super) fn capsule_around(points: &[Vector3<f64>], effort: Effort) -> Capsule {
    let (directions, starts, evaluations) = match effort {
        Effort::Rough => (40, 1, 150),
        Effort::Full => (250, 12, 600),
    };
    let mut shell = outermost(points, directions);
    let mut axis = search(&shell, &starting_axes(&shell, starts), evaluations);
    if effort == Effort::Rough {
        return axis.capsule(&shell);
    }
    for _ in 0..ROUNDS {
        let capsule = axis.capsule(&shell);
        let mut out: Vec<(f64, Vector3<f64>)> =
            points.iter().map(|p| (capsule.distance_to(p), *p)).filter(|(out, _)| *out > 0.1 / GRID).collect();
        if out.is_empty() {
            break;
        }
        sort_by_number(&mut out, |a| -a.0);
        shell.extend(out.iter().take(ADDED).map(|(_, p)| *p));
        axis = search(&shell, &[axis], evaluations);
    }
    rounded(&axis.capsule(&shell), points)
}

/// Ends on the grid, the radius up to the next that contains all points.
fn rounded(capsule: &Capsule, points: &[Vector3<f64>]) -> Capsule {
    let [a, b] = [capsule.a, capsule.b].map(|p| p.map(|v| (v * GRID).round() / GRID));
    let thin = Capsule { a, b, radius: 0.0 };
    let most = points.iter().map(|p| thin.distance_to(p));
    let most = most.fold(0.0, f64::max);
    // A little more than rounding of the distance.
    let steps = (most * GRID * (1.0 + 1e-12) + 1e-6).ceil().max(1.0);
    Capsule { a, b, radius: steps / GRID }
}

/// The outermost points in evenly spread directions, each once.
fn outermost(points: &[Vector3<f64>], directions: usize) -> Vec<Vector3<f64>> {
    if points.len() <= directions {
        return points.to_vec();
    }
    let mut chosen: Vec<usize> = spread(directions)
        .filter_map(|direction| {
            let heights = points.iter().map(|p| p.dot(&direction)).enumerate();
            let top = heights.max_by(|a, b| a.1.total_cmp(&b.1));
            top.map(|(at, _)| at)
        })
        .collect();
    chosen.sort_unstable();
    chosen.dedup();
    chosen.into_iter().map(|at| points[at]).collect()
}

/// Evenly spread unit directions, on a spiral from −z to z.
fn spread(count: usize) -> impl Iterator<Item = Vector3<f64>> {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    (0..count).map(move |i| {
        let z = (2 * i + 1) as f64 / count as f64 - 1.0;
        let (r, turn) = ((1.0 - z * z).sqrt(), golden * i as f64);
        Vector3::new(r * turn.cos(), r * turn.sin(), z)
    })
}

/// Directions of largest to smallest spread.
pub(super) fn principal_axes(points: &[Vector3<f64>]) -> [Vector3<f64>; 3] {
    let count = points.len().max(1) as f64;
    let mean = points.iter().sum::<Vector3<f64>>() / count;
    let mut spread = Matrix3::zeros();
    for p in points {
        spread += (p - mean) * (p - mean).transpose();
    }
    let frame = [Vector3::x(), Vector3::y(), Vector3::z()];
    let Some(eigen) = SymmetricEigen::try_new(spread, 1e-14, 1000) else {
        return frame;
    };
    let mut order = [0, 1, 2];
    sort_by_number(&mut order, |i| -eigen.eigenvalues[*i]);
    order.map(|i| eigen.eigenvectors.column(i).into_owned())
}

/// The `count` best of the principal axes, the axes of the frame and many spread directions, each
/// through the middle of the points and with the best of some widths.
fn starting_axes(points: &[Vector3<f64>], count: usize) -> Vec<Axis> {
    let frame = [Vector3::x(), Vector3::y(), Vector3::z()];
    let directions = principal_axes(points).into_iter().chain(frame);
    let mut axes: Vec<(f64, Axis)> = directions
        .chain(spread(2 * SPREAD).skip(SPREAD))
        .map(|direction| {
            let plain = Axis::through_the_middle(points, direction);
            let axes = WIDTHS.map(|wider| {
                let axis = Axis { wider, ..plain };
                (axis.volume(points), axis)
            });
            let least = |a: (f64, Axis), b: (f64, Axis)| if b.0 < a.0 { b } else { a };
            axes.into_iter().fold((f64::INFINITY, plain), least)
        })
        .collect();
    sort_by_number(&mut axes, |a| a.0);
    axes.truncate(count);
    axes.into_iter().map(|(_, axis)| axis).collect()
}

/// The axis of a capsule and how much wider than necessary it is.
#[derive(Debug, Clone, Copy)]
struct Axis {
    direction: Vector3<f64>,
    point: Vector3<f64>,
    /// The radius is 1 + this times the smallest.
    wider: f64,
}

impl Axis {
    /// Through the middle of the smallest circle around the points seen along the direction
    /// (Bădoiu and Clarkson, "Smaller core-sets for balls", 2003).
    fn through_the_middle(points: &[Vector3<f64>], direction: Vector3<f64>) -> Self {
        let flat: Vec<Vector3<f64>> = points.iter().map(|p| p - direction * p.dot(&direction)).collect();
        let mut point = flat.first().copied().unwrap_or_default();
        for step in 2..60 {
            let away = |p: &&Vector3<f64>| (*p - point).norm_squared();
            let far = flat.iter().max_by(|a, b| away(a).total_cmp(&away(b)));
            point += (far.copied().unwrap_or(point) - point) / f64::from(step);
        }
        Axis { direction, point, wider: 0.0 }
    }

    /// The shortest capsule about this axis that contains the points.
    fn capsule(&self, points: &[Vector3<f64>]) -> Capsule {
        let (along, radius, [low, high]) = self.fit(points);
        let at = |s: f64| along * s + self.point;
        Capsule { a: at(low), b: at(high), radius }
    }

    /// Unit direction, radius, and both ends of the segment along it.
    fn fit(&self, points: &[Vector3<f64>]) -> (Vector3<f64>, f64, [f64; 2]) {
        let along = self.direction;
        let split = |p: &Vector3<f64>| {
            let offset = p - self.point;
            let s = offset.dot(&along);
            (s, (offset.norm_squared() - s * s).max(0.0))
        };
        let most = points.iter().map(|p| split(p).1).fold(0.0, f64::max);
        let radius = most.sqrt() * (1.0 + self.wider.abs());
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in points {
            let (s, beside) = split(p);
            let reach = (radius * radius - beside).max(0.0).sqrt();
            low = low.min(s + reach);
            high = high.max(s - reach);
        }
        if low > high {
            // A sphere: any centre between is good.
            (low, high) = (0.5 * (low + high), 0.5 * (low + high));
        }
        (along, radius, [low, high])
    }

    fn volume(&self, points: &[Vector3<f64>]) -> f64 {
        let (_, r, [low, high]) = self.fit(points);
        PI * r * r * (high - low) + 2.0 * TAU / 3.0 * r * r * r
    }

    /// This axis after five small changes: two of direction, two of position in units of
    /// `size`, one of width.
    fn changed(&self, by: &[f64; 5], size: f64) -> Self {
        let [e, f] = across(&self.direction);
        Axis {
            direction: (self.direction + e * by[0] + f * by[1]).normalize(),
            point: self.point + (e * by[2] + f * by[3]) * size,
            wider: self.wider + by[4],
        }
    }
}

/// Two unit vectors across a direction and each other.
fn across(direction: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let e = direction.cross(&Vector3::ith(direction.iamin(), 1.0)).normalize();
    [e, direction.cross(&e)]
}

/// The best axis from any of the starts: a simplex from each, and from the best of these ends
/// some more, because a simplex may collapse.
fn search(points: &[Vector3<f64>], starts: &[Axis], evaluations: usize) -> Axis {
    let size = points.iter().map(|p| (p - points[0]).norm());
    let size = 0.5 * size.fold(0.0, f64::max);
    let better = |axis: &Axis, step: f64| {
        let value = |by: &[f64; 5]| axis.changed(by, size).volume(points);
        let (by, volume) = nelder_mead(value, [0.0; 5], step, evaluations);
        (volume, axis.changed(&by, size))
    };
    let by_volume = |a: &(f64, Axis), b: &(f64, Axis)| a.0.total_cmp(&b.0);
    let mut ends: Vec<(f64, Axis)> = starts.iter().map(|start| better(start, 0.2)).collect();
    ends.sort_by(by_volume);
    ends.truncate(AGAIN);
    for step in [0.05, 0.1, 0.02] {
        for end in &mut ends {
            *end = better(&end.1, step);
        }
    }
    let best = ends.into_iter().min_by(by_volume);
    best.map_or(starts[0], |(_, axis)| axis)
}
