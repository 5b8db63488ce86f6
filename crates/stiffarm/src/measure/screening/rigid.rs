//! Rigid fits of points, and the other orders in which points can be labelled.

use crate::measure::registration::rigid_transform;
pub(super) use crate::measure::registration::{Pair, is_spread, misfit, moved};
use nalgebra::Isometry3;

/// Most points whose labels are tried in every order.
const ALL_ORDERS: usize = 4;

/// Least-squares rigid transform, second from first, det = +1; directions that
/// the points leave open are taken as they come. `None` without two pairs.
pub(super) fn fit(pairs: &[Pair]) -> Option<Isometry3<f64>> {
    if pairs.len() < 2 {
        return None;
    }
    rigid_transform(pairs.iter().copied())
}

/// RMS of the distances that the best rigid transform leaves \[m\].
pub(super) fn best_rms(pairs: &[Pair]) -> f64 {
    match fit(pairs) {
        Some(transform) => (misfit(&transform, pairs) / pairs.len() as f64).sqrt(),
        None => 0.0,
    }
}

/// Orders in which `count` labels can be mixed up: all exchanges of two first,
/// then, for few points, every other order. `order[a]` is the point at which
/// the reading labelled `a` was really taken.
pub(super) fn orders(count: usize) -> Vec<Vec<usize>> {
    let natural: Vec<usize> = (0..count).collect();
    let mut out = Vec::new();
    for b in 0..count {
        for a in 0..b {
            let mut order = natural.clone();
            order.swap(a, b);
            out.push(order);
        }
    }
    if count <= ALL_ORDERS {
        let mut others = Vec::new();
        extend(&mut Vec::new(), count, &mut others);
        others.retain(|order| *order != natural && !out.contains(order));
        out.extend(others);
    }
    out
}

fn extend(start: &mut Vec<usize>, count: usize, out: &mut Vec<Vec<usize>>) {
    if start.len() == count {
        out.push(start.clone());
        return;
    }
    for next in 0..count {
        if !start.contains(&next) {
            start.push(next);
            extend(start, count, out);
            start.pop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn fit_recovers_a_transform_also_of_points_on_a_line() {
        let transform = Isometry3::new(Vector3::new(0.4, -2.0, 1.0), Vector3::new(0.3, 1.2, -2.0));
        let points = [
            Vector3::new(0.1, 0.2, 0.3),
            Vector3::new(-0.4, 0.2, 0.9),
            Vector3::new(0.7, -0.3, 0.2),
            Vector3::new(0.5, 0.5, -0.5),
        ];
        for count in 2..=4 {
            let pairs: Vec<Pair> = points[..count]
                .iter()
                .map(|p| (*p, moved(&transform, p)))
                .collect();
            assert!(best_rms(&pairs) < 1e-14, "{count}");
            let found = fit(&pairs).unwrap();
            assert!(
                (found.rotation.to_rotation_matrix().matrix().determinant() - 1.0).abs() < 1e-12
            );
            if count > 2 {
                assert!(found.rotation.angle_to(&transform.rotation) < 1e-12);
            }
        }
        assert!(fit(&[(points[0], points[1])]).is_none());
        assert!(!is_spread(&points[..2]) && is_spread(&points[..3]));
        let line: Vec<_> = (0..4).map(|i| points[0] * f64::from(i)).collect();
        assert!(!is_spread(&line));
    }

    #[test]
    fn orders_are_the_exchanges_first_and_then_the_rest() {
        let four = orders(4);
        assert_eq!(four.len(), 23);
        assert_eq!(four[0], [1, 0, 2, 3]);
        let moved = |order: &[usize]| (0..4).filter(|i| order[*i] != *i).count();
        assert!(four[..6].iter().all(|o| moved(o) == 2));
        assert!(four[6..].iter().all(|o| moved(o) > 2));
        assert_eq!(orders(5).len(), 10);
    }
}
