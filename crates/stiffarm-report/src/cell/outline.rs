//! Outlines of solids in a view: convex hulls of projected points.

use super::camera::Camera;
use crate::scene::corners::{circle, corner_points};
use stiffarm::model::shape::Solid;
use stiffarm::nalgebra::Vector3;

/// Points whose convex hull in this view is the solid's outline; empty for what has no end.
fn rim_points(solid: &Solid, camera: &Camera) -> Vec<Vector3<f64>> {
    match solid {
        Solid::Capsule(capsule) => [capsule.a, capsule.b]
            .iter()
            .flat_map(|end| {
                let (centre, radius, axes) = camera.rim(end, capsule.radius);
                circle(centre, radius, axes)
            })
            .collect(),
        _ => corner_points(solid),
    }
}

/// The outline of a solid in a view; `None` for what has no end or lies behind who looks.
pub(super) fn outline(solid: &Solid, camera: &Camera) -> Option<Vec<[f64; 2]>> {
    hull_of(&rim_points(solid, camera), camera)
}

/// The convex hull of points in a view.
pub(super) fn hull_of(points: &[Vector3<f64>], camera: &Camera) -> Option<Vec<[f64; 2]>> {
    let seen: Option<Vec<[f64; 2]>> = points.iter().map(|p| camera.point(p)).collect();
    let corners = hull(seen?);
    (corners.len() > 2).then_some(corners)
}

/// Corners of the convex hull, counter-clockwise (Andrew's monotone chain).
pub(super) fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.retain(|p| p.iter().all(|v| v.is_finite()));
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let half = |points: &mut dyn Iterator<Item = &[f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                let turn = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
                if turn > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(*p);
        }
        chain.pop();
        chain
    };
    let mut corners = half(&mut points.iter());
    corners.extend(half(&mut points.iter().rev()));
    corners
}

#[cfg(test)]
mod tests {
    use super::*;
    use stiffarm::model::shape::Capsule;
    use stiffarm::nalgebra::Isometry3;

    /// Smallest distance of a point inside a counter-clockwise hull from its sides, negative outside.
    fn depth(corners: &[[f64; 2]], p: [f64; 2]) -> f64 {
        let next = corners.iter().cycle().skip(1);
        let sides = corners.iter().zip(next).map(|(a, b)| {
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            (dx * (p[1] - a[1]) - dy * (p[0] - a[0])) / dx.hypot(dy)
        });
        sides.fold(f64::INFINITY, f64::min)
    }

    fn cameras() -> [Camera; 3] {
        let centre = Vector3::new(0.5, 0.1, 0.4);
        [Camera::side(), Camera::above(), Camera::perspective(centre, 2.0)]
    }

    #[test]
    fn a_capsules_outline_is_a_radius_around_its_ends() {
        let capsule = Capsule::new(Vector3::new(0.2, -0.3, 0.1), Vector3::new(1.1, 0.4, 0.9), 0.2);
        let capsule = capsule.unwrap();
        for camera in cameras() {
            let corners = outline(&Solid::Capsule(capsule), &camera).unwrap();
            for end in [capsule.a, capsule.b] {
                let inside = depth(&corners, camera.point(&end).unwrap());
                assert!(inside > 0.19 && inside < 0.23, "{inside} {camera:?}");
            }
        }
    }

    #[test]
    fn an_outline_contains_every_corner() {
        let turn = Isometry3::new(Vector3::new(0.3, 0.0, 0.5), Vector3::new(0.4, 0.5, -0.2));
        let block = Solid::block(turn, Vector3::new(0.5, 0.8, 0.3)).unwrap();
        let tube = Solid::cylinder(Vector3::zeros(), Vector3::new(0.2, 0.9, 0.4), 0.3).unwrap();
        for camera in cameras() {
            for solid in [block, tube] {
                let corners = outline(&solid, &camera).unwrap();
                for p in corner_points(&solid) {
                    assert!(depth(&corners, camera.point(&p).unwrap()) > -1e-9);
                }
            }
        }
    }

    #[test]
    fn a_hull_leaves_out_what_lies_inside() {
        let square = vec![[0.0, 0.0], [1.0, 0.0], [0.5, 0.5], [1.0, 1.0], [0.0, 1.0], [0.0, 0.5]];
        assert_eq!(hull(square), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(hull(vec![[1.0, 1.0]; 3]).len(), 1);
    }
}
