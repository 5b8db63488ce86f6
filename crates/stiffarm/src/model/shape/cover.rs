//! Shapes made of simpler ones that contain them.

use super::{Capsule, Solid};
use crate::numerics::order::sort_by_number;
use nalgebra::{Isometry3, Translation3, Vector3};

/// Most capsules side by side in a box.
const MOST_ROWS: usize = 4;
/// How much wider than a cylinder its capsule is, so that its ends reach less far beyond.
const WIDER: f64 = 1.05;

/// Capsules that contain a solid, in its frame; none for a half-space, which has no end.
///
/// A box becomes a row of capsules along its longest side, so many that a capsule is hardly wider
/// than the box is thick; a cylinder one capsule of 1.05 times its radius.
pub fn capsules_around(solid: &Solid) -> Vec<Capsule> {
    match solid {
        Solid::Capsule(capsule) => vec![*capsule],
        Solid::HalfSpace { .. } => Vec::new(),
        Solid::Cylinder { pose, half_length, radius } => {
            let end = Vector3::z() * reach(*half_length, *radius, WIDER * radius);
            vec![Capsule { a: -end, b: end, radius: WIDER * radius }.placed(pose)]
        }
        Solid::Block { pose, half } => {
            let mut order = [0, 1, 2];
            sort_by_number(&mut order, |i| -half[*i]);
            let [long, wide, thin] = order;
            let rows = ((half[wide] / half[thin]).ceil() as usize).clamp(1, MOST_ROWS);
            let share = half[wide] / rows as f64;
            let corner = share.hypot(half[thin]);
            let radius = WIDER * corner;
            (0..rows)
                .map(|row| {
                    let middle = Vector3::ith(wide, -half[wide] + share * (2 * row + 1) as f64);
                    let end = Vector3::ith(long, reach(half[long], corner, radius));
                    Capsule { a: middle - end, b: middle + end, radius }.placed(pose)
                })
                .collect()
        }
    }
}

/// Half the segment of a capsule of `radius` that contains a cylinder of half length `half` and
/// radius `corner`.
fn reach(half: f64, corner: f64, radius: f64) -> f64 {
    (half - (radius * radius - corner * corner).sqrt()).max(0.0)
}

/// Boxes along the axes of the frame that together contain all `triangles` (corners in
/// `vertices`, \[m\]), at most `most` of them, each at least `least` thick.
///
/// The box whose split saves most volume is split across its longest side, until `most` are there.
/// Triangles are cut at the plane of the split, so that a large triangle does not
/// keep a box large.
pub fn solids_around(vertices: &[Vector3<f64>], triangles: &[[usize; 3]], most: usize, least: f64) -> Vec<Solid> {
    let polygons: Vec<Vec<Vector3<f64>>> = triangles.iter().map(|t| t.iter().map(|v| vertices[*v]).collect()).collect();
    let mut boxes: Vec<(Bounds, Vec<Vec<Vector3<f64>>>)> =
        Bounds::of(&polygons, least).map(|bounds| (bounds, polygons)).into_iter().collect();
    while boxes.len() < most {
        let best = boxes
            .iter()
            .enumerate()
            .filter_map(|(i, (bounds, polygons))| {
                let split = best_split(bounds, polygons, least)?;
                Some((i, split))
            })
            .max_by(|a, b| a.1.saved.total_cmp(&b.1.saved));
        let Some((at, split)) = best.filter(|(_, split)| split.saved > 0.0) else {
            break;
        };
        boxes.splice(at..=at, split.halves);
    }
    boxes
        .into_iter()
        .map(|(bounds, _)| Solid::Block {
            pose: Isometry3::from_parts(
                Translation3::from((bounds.low + bounds.high) * 0.5),
                nalgebra::UnitQuaternion::identity(),
            ),
            half: (bounds.high - bounds.low) * 0.5,
        })
        .collect()
}

#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Bounds {
    fn of(polygons: &[Vec<Vector3<f64>>], least: f64) -> Option<Self> {
        let first = *polygons.first()?.first()?;
        let mut bounds = Bounds { low: first, high: first };
        for p in polygons.iter().flatten() {
            bounds.low = bounds.low.inf(p);
            bounds.high = bounds.high.sup(p);
        }
        for axis in 0..3 {
            let missing = least - (bounds.high[axis] - bounds.low[axis]);
            if missing > 0.0 {
                bounds.low[axis] -= 0.5 * missing;
                bounds.high[axis] += 0.5 * missing;
            }
        }
        Some(bounds)
    }

    fn volume(&self) -> f64 {
        (self.high - self.low).product()
    }
}

type Half = (Bounds, Vec<Vec<Vector3<f64>>>);

struct Split {
    saved: f64,
    halves: Vec<Half>,
}

/// Of some planes across each axis the one whose two boxes are smallest.
fn best_split(bounds: &Bounds, polygons: &[Vec<Vector3<f64>>], least: f64) -> Option<Split> {
    let mut best: Option<Split> = None;
    for axis in 0..3 {
        let (low, high) = (bounds.low[axis], bounds.high[axis]);
        if high - low < 2.0 * least {
            continue;
        }
        for share in [0.25, 0.5, 0.75] {
            let at = low + share * (high - low);
            let halves: Vec<Half> = [-1.0, 1.0]
                .into_iter()
                .filter_map(|side| {
                    let pieces: Vec<Vec<Vector3<f64>>> = polygons
                        .iter()
                        .map(|polygon| clipped(polygon, axis, at, side))
                        .filter(|polygon| !polygon.is_empty())
                        .collect();
                    Bounds::of(&pieces, least).map(|bounds| (bounds, pieces))
                })
                .collect();
            let saved = bounds.volume() - halves.iter().map(|(b, _)| b.volume()).sum::<f64>();
            if best.as_ref().is_none_or(|b| saved > b.saved) {
                best = Some(Split { saved, halves });
            }
        }
    }
    best
}

/// The part of a convex polygon on one side of a plane across `axis`.
fn clipped(polygon: &[Vector3<f64>], axis: usize, at: f64, side: f64) -> Vec<Vector3<f64>> {
    let beyond = |p: &Vector3<f64>| side * (p[axis] - at);
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (i, p) in polygon.iter().enumerate() {
        let next = &polygon[(i + 1) % polygon.len()];
        let (here, there) = (beyond(p), beyond(next));
        if here >= 0.0 {
            out.push(*p);
        }
        if here * there < 0.0 {
            let t = here / (here - there);
            let mut cut = p + (next - p) * t;
            cut[axis] = at;
            out.push(cut);
        }
    }
    out
}
