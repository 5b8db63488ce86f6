//! Parts of a mesh on both sides of a plane.

use super::around::principal_axes;
use nalgebra::Vector3;

/// Corners of a flat convex polygon, in order \[m\].
pub(super) type Polygon = Vec<Vector3<f64>>;

/// All points with `normal` · point = `offset`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    normal: Vector3<f64>,
    offset: f64,
}

/// Where along a direction planes lie, as shares of the extent.
const SHARES: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];

/// Planes worth a try: across the principal axes and the axes of the frame, across the diagonals
/// between two of these, and the one halfway between two clusters of corners.
pub(super) fn planes(polygons: &[Polygon]) -> Vec<Plane> {
    let corners: Vec<Vector3<f64>> = polygons.concat();
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let mut normals = principal_axes(&corners).to_vec();
    normals.extend([x, y, z]);
    normals.extend([x + y, x - y, y + z, y - z, z + x, z - x].map(|d| d.normalize()));
    let mut planes = Vec::new();
    for normal in normals {
        let along = corners.iter().map(|p| p.dot(&normal));
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(s), high.max(s)));
        planes.extend(SHARES.map(|share| Plane { normal, offset: low + share * (high - low) }));
    }
    planes.extend(between_clusters(&corners));
    planes
}

/// Halfway between the means of two clusters (Lloyd's algorithm from the ends of the longest axis).
fn between_clusters(corners: &[Vector3<f64>]) -> Option<Plane> {
    let [long, ..] = principal_axes(corners);
    let by_long = |a: &&Vector3<f64>, b: &&Vector3<f64>| a.dot(&long).total_cmp(&b.dot(&long));
    let mut means = [*corners.iter().min_by(by_long)?, *corners.iter().max_by(by_long)?];
    for _ in 0..20 {
        let mut sums = [(Vector3::zeros(), 0.0); 2];
        for p in corners {
            let near = usize::from((p - means[1]).norm_squared() < (p - means[0]).norm_squared());
            sums[near].0 += p;
            sums[near].1 += 1.0;
        }
        if sums.iter().any(|(_, count)| *count == 0.0) {
            return None;
        }
        means = sums.map(|(sum, count)| sum / count);
    }
    let normal = (means[1] - means[0]).try_normalize(1e-9)?;
    let offset = normal.dot(&((means[0] + means[1]) * 0.5));
    Some(Plane { normal, offset })
}

/// The polygons below the plane and those above; one that it passes through is in both in part.
pub(super) fn cut(polygons: &[Polygon], plane: &Plane) -> [Vec<Polygon>; 2] {
    let mut halves = [Vec::new(), Vec::new()];
    for polygon in polygons {
        let heights: Vec<f64> = polygon.iter().map(|p| plane.normal.dot(p) - plane.offset).collect();
        if heights.iter().all(|h| *h <= 0.0) {
            halves[0].push(polygon.clone());
        } else if heights.iter().all(|h| *h >= 0.0) {
            halves[1].push(polygon.clone());
        } else {
            let (mut below, mut above) = (Polygon::new(), Polygon::new());
            for (i, p) in polygon.iter().enumerate() {
                let next = (i + 1) % polygon.len();
                let (here, there) = (heights[i], heights[next]);
                if here <= 0.0 {
                    below.push(*p);
                }
                if here >= 0.0 {
                    above.push(*p);
                }
                if here * there < 0.0 {
                    let crossing = p + (polygon[next] - p) * (here / (here - there));
                    below.push(crossing);
                    above.push(crossing);
                }
            }
            halves[0].push(below);
            halves[1].push(above);
        }
    }
    halves
}
