//! The distance of two segments, written apart from the library's.

use nalgebra::Vector3;

/// The smallest distance of the segments `a` and `b` \[m\]: the quadratic
/// |a(s) − b(t)|² over the unit square is smallest inside, on one of four edges or in one of
/// four corners, and all nine are looked at.
pub fn segments_apart(a: [Vector3<f64>; 2], b: [Vector3<f64>; 2]) -> f64 {
    let (u, v, w) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let apart = |s: f64, t: f64| (w + u * s - v * t).norm();
    let mut best = f64::INFINITY;
    for s in [0.0, 1.0] {
        for t in [0.0, 1.0] {
            best = best.min(apart(s, t));
        }
        // Along the edge of one end the other point is free.
        let t = (w + u * s).dot(&v) / v.norm_squared();
        if (0.0..=1.0).contains(&t) {
            best = best.min(apart(s, t));
        }
        let s_free = (v * s - w).dot(&u) / u.norm_squared();
        if (0.0..=1.0).contains(&s_free) {
            best = best.min(apart(s_free, s));
        }
    }
    let normal = u.cross(&v);
    let area = normal.norm_squared();
    if area > 1e-18 * u.norm_squared() * v.norm_squared() {
        // Cramer's rule on w + s u − t v = multiple of u × v.
        let s = v.cross(&w).dot(&normal) / area;
        let t = u.cross(&w).dot(&normal) / area;
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            // The common normal's share of w is exact where the points are nearly the same.
            best = best.min(w.dot(&normal).abs() / area.sqrt());
        }
    }
    best
}
