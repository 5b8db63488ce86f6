//! Distances of shapes, written apart from the library's: a segment against a solid by samples and a
//! golden section of the point's distance, two capsules by the faces of the unit square, two solids by
//! the edges of one against the other.

use super::arm::Frame;
use crate::common::prelude::*;
use crate::common::segments::segments_apart;

type V = Vector3<f64>;

/// Samples of a segment before the golden section.
const SAMPLES: usize = 9;
/// Steps of the golden section: the bracket shrinks by 0.618 each.
const STEPS: usize = 44;
/// Sides of the prism that stands for a cylinder where it meets another solid; it lies inside.
const SIDES: usize = 16;

/// A shape with the numbers of its table, mm and degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    Box { center: [f64; 3], size: [f64; 3], rpy: [f64; 3] },
    Cylinder { from: [f64; 3], to: [f64; 3], radius: f64 },
    Capsule { from: [f64; 3], to: [f64; 3], radius: f64 },
    Floor(f64),
    Ceiling(f64),
    Wall { point: [f64; 3], normal: [f64; 3] },
}

/// A shape where it is, base frame, m.
#[derive(Debug, Clone)]
pub enum Body {
    Box { centre: V, axes: [V; 3], half: [f64; 3] },
    Cylinder { ends: [V; 2], radius: f64 },
    Capsule { ends: [V; 2], radius: f64 },
    Plane { point: V, normal: V },
}

impl Body {
    /// `shape` in the frame that it is given in.
    pub fn new(shape: &Shape, frame: &Frame) -> Self {
        let at = |p: &[f64; 3]| frame.point(&p.map(|v| v * 1e-3));
        match shape {
            Shape::Box { center, size, rpy } => {
                let turned = frame.times(&Frame::of_pose([0.0; 3], rpy.map(f64::to_radians)));
                Body::Box {
                    centre: at(center),
                    axes: [0, 1, 2].map(|i| turned.axis(i)),
                    half: size.map(|s| s * 0.5e-3),
                }
            }
            Shape::Cylinder { from, to, radius } => Body::Cylinder { ends: [at(from), at(to)], radius: radius * 1e-3 },
            Shape::Capsule { from, to, radius } => Body::Capsule { ends: [at(from), at(to)], radius: radius * 1e-3 },
            Shape::Floor(z) => Body::Plane { point: V::new(0.0, 0.0, z * 1e-3), normal: V::z() },
            Shape::Ceiling(z) => Body::Plane { point: V::new(0.0, 0.0, z * 1e-3), normal: -V::z() },
            Shape::Wall { point, normal } => Body::Plane { point: at(point), normal: V::from(*normal).normalize() },
        }
    }

    /// How far `p` is outside, minus its depth inside.
    pub fn to_point(&self, p: &V) -> f64 {
        match self {
            Body::Box { centre, axes, half } => {
                let local = axes.map(|axis| axis.dot(&(p - centre)));
                let mut square = 0.0;
                let mut depth = f64::INFINITY;
                for (x, h) in local.iter().zip(half) {
                    let nearest = x.clamp(-h, *h);
                    square += (x - nearest) * (x - nearest);
                    depth = depth.min(h - x.abs());
                }
                if depth >= 0.0 { -depth } else { square.sqrt() }
            }
            Body::Cylinder { ends, radius } => {
                let length = (ends[1] - ends[0]).norm();
                let axis = (ends[1] - ends[0]) / length;
                let along = axis.dot(&(p - ends[0]));
                // The area of a parallelogram over its base.
                let across = (p - ends[0]).cross(&axis).norm();
                let depth = (radius - across).min(along).min(length - along);
                if depth >= 0.0 {
                    return -depth;
                }
                let beyond = along - along.clamp(0.0, length);
                let outside = across - across.min(*radius);
                (beyond * beyond + outside * outside).sqrt()
            }
            Body::Capsule { ends, radius } => segments_apart(*ends, [*p, *p]) - radius,
            Body::Plane { point, normal } => normal.dot(&(p - point)),
        }
    }

    /// The smallest distance of the points of a segment.
    pub fn to_segment(&self, a: &V, b: &V) -> f64 {
        match self {
            Body::Capsule { ends, radius } => segments_apart(*ends, [*a, *b]) - radius,
            Body::Plane { .. } => self.to_point(a).min(self.to_point(b)),
            _ => self.searched(a, b),
        }
    }

    fn searched(&self, a: &V, b: &V) -> f64 {
        let at = |t: f64| self.to_point(&(a + (b - a) * t));
        let step = 1.0 / (SAMPLES - 1) as f64;
        let mut best = (f64::INFINITY, 0.0);
        for i in 0..SAMPLES {
            let t = i as f64 * step;
            let value = at(t);
            if value < best.0 {
                best = (value, t);
            }
        }
        let shrink = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut low, mut high) = ((best.1 - step).max(0.0), (best.1 + step).min(1.0));
        let (mut x, mut y) = (high - shrink * (high - low), low + shrink * (high - low));
        let (mut at_x, mut at_y) = (at(x), at(y));
        for _ in 0..STEPS {
            if at_x < at_y {
                (high, y, at_y) = (y, x, at_x);
                x = high - shrink * (high - low);
                at_x = at(x);
            } else {
                (low, x, at_x) = (x, y, at_y);
                y = low + shrink * (high - low);
                at_y = at(y);
            }
        }
        best.0.min(at_x).min(at_y)
    }

    /// Segments that lie in the solid and show where it touches another: its edges.
    fn edges(&self) -> Vec<[V; 2]> {
        match self {
            Body::Box { centre, axes, half } => {
                let corner = |i: usize| {
                    (0..3).fold(*centre, |p, axis| {
                        let sign = if i >> axis & 1 == 1 { 1.0 } else { -1.0 };
                        p + axes[axis] * (sign * half[axis])
                    })
                };
                let pairs = (0..8).flat_map(|i| [1, 2, 4].map(|bit| (i, i | bit)));
                pairs.filter(|(i, j)| i != j).map(|(i, j)| [corner(i), corner(j)]).collect()
            }
            Body::Cylinder { ends, radius } => {
                let axis = (ends[1] - ends[0]).normalize();
                let across = [V::x(), V::y(), V::z()]
                    .map(|v| axis.cross(&v))
                    .into_iter()
                    .max_by(|a, b| a.norm().total_cmp(&b.norm()))
                    .unwrap()
                    .normalize();
                let other = axis.cross(&across);
                let rim = |i: usize| {
                    let (s, c) = (i as f64 / SIDES as f64 * std::f64::consts::TAU).sin_cos();
                    (across * c + other * s) * *radius
                };
                let mut out = vec![*ends];
                for i in 0..SIDES {
                    out.push(ends.map(|end| end + rim(i)));
                    out.extend(ends.map(|end| [end + rim(i), end + rim(i + 1)]));
                }
                out
            }
            Body::Capsule { ends, .. } => vec![*ends],
            Body::Plane { .. } => Vec::new(),
        }
    }

    /// The distance of two solids: exact where one is a capsule or two boxes touch, else never below the
    /// true one by more than rounding.
    pub fn to_body(&self, other: &Body) -> f64 {
        match (self, other) {
            (Body::Capsule { ends, radius }, solid) | (solid, Body::Capsule { ends, radius }) => {
                solid.to_segment(&ends[0], &ends[1]) - radius
            }
            _ => {
                let least = |edges: Vec<[V; 2]>, solid: &Body| {
                    let each = edges.iter().map(|[a, b]| solid.to_segment(a, b));
                    each.fold(f64::INFINITY, f64::min)
                };
                least(self.edges(), other).min(least(other.edges(), self))
            }
        }
    }
}
