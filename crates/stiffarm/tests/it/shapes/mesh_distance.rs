//! Distances of meshes are the smallest signed distance over every triangle.

use super::{pose, solid};
use crate::common::meshes::{box_mesh, capsule_mesh, joined, l_mesh};
use crate::common::prelude::*;
use proptest::prelude::*;
use stiffarm::model::shape::{MeshBody, Solid, hull_volume};

/// The smallest value of a convex function on \[0, 1\], by golden sections.
fn smallest(f: impl Fn(f64) -> f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..45 {
        let (left, right) = (high - golden * (high - low), low + golden * (high - low));
        if f(left) < f(right) { high = right } else { low = left }
    }
    f(0.0).min(f(1.0)).min(f(0.5 * (low + high)))
}

/// The signed distance of a convex solid is convex over a triangle, so its smallest value there is
/// found by two nested searches.
fn by_triangles(mesh: &TriangleMesh, solid: &Solid) -> f64 {
    let over = |[a, b, c]: [Vector3<f64>; 3]| {
        smallest(|u| {
            let (from, to) = (a + (b - a) * u, a + (c - a) * u);
            smallest(|v| solid.signed_distance(&(from + (to - from) * v)).0)
        })
    };
    mesh.corners().map(over).fold(f64::INFINITY, f64::min)
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn distances_of_meshes(seed: u64) {
        let mut dice = Dice::new(seed);
        let mesh = if dice.chance(0.5) {
            l_mesh()
        } else {
            box_mesh(-Vector3::new(0.3, 0.2, 0.1), Vector3::new(0.3, 0.2, 0.1))
        };
        let (frame, solid) = (pose(&mut dice), solid(&mut dice));
        let body = MeshBody::new(mesh.clone()).unwrap();
        let distance = body.distance_to(&frame, &solid).unwrap();
        let expected = by_triangles(&mesh.placed(&frame), &solid);
        // The solid wholly inside the mesh is 0 apart, and the search says otherwise.
        if distance > 0.0 || expected <= 0.0 {
            let tolerance = if matches!(solid, Solid::Cylinder { .. }) { 1e-5 } else { 1e-8 };
            prop_assert!((distance - expected.max(0.0)).abs() < tolerance, "{distance} {expected} {solid:?}");
        }
    }

    #[test]
    fn distances_of_two_meshes(seed: u64) {
        let mut dice = Dice::new(seed);
        let half = [(); 2].map(|_| Vector3::from_fn(|_, _| dice.between(0.05, 0.6)));
        let frames = [pose(&mut dice), pose(&mut dice)];
        let bodies = half.map(|h| MeshBody::new(box_mesh(-h, h)).unwrap());
        let [first, second] = &bodies;
        let distance = first.distance_to_mesh(&frames[0], second, &frames[1]).unwrap();
        // Boxes are solids, too.
        let blocks = [0, 1].map(|i| Solid::Block { pose: frames[i], half: half[i] });
        let one_way = by_triangles(&first.mesh().placed(&frames[0]), &blocks[1]);
        let middle = frames[1].translation.vector;
        let expected = if blocks[0].signed_distance(&middle).0 < 0.0 {
            0.0
        } else {
            one_way.max(0.0)
        };
        prop_assert!((distance - expected).abs() < 1e-8, "{distance} {expected}");
        let back = second.distance_to_mesh(&frames[1], first, &frames[0]).unwrap();
        prop_assert!((distance - back).abs() < 1e-9);
    }
}

#[test]
fn what_is_wholly_inside_is_no_distance_away() {
    let body = MeshBody::new(box_mesh(Vector3::zeros(), Vector3::repeat(1.0))).unwrap();
    let here = Isometry3::identity();
    let at = |x: f64| {
        let p = Vector3::new(x, 0.5, 0.5);
        Solid::Capsule(Capsule::new(p, p + Vector3::z() * 0.1, 0.05).unwrap())
    };
    assert_eq!(body.distance_to(&here, &at(0.5)).unwrap(), 0.0);
    assert!((body.distance_to(&here, &at(1.5)).unwrap() - 0.45).abs() < 1e-9);
    // The same for meshes, also where only the second part is inside.
    let small = box_mesh(Vector3::repeat(0.4), Vector3::repeat(0.6));
    let far = box_mesh(Vector3::repeat(3.0), Vector3::repeat(3.2));
    let parts = MeshBody::new(joined(far.clone(), &small)).unwrap();
    assert_eq!(body.distance_to_mesh(&here, &parts, &here).unwrap(), 0.0);
    assert_eq!(parts.distance_to_mesh(&here, &body, &here).unwrap(), 0.0);
    let far = MeshBody::new(far).unwrap();
    let apart = body.distance_to_mesh(&here, &far, &here).unwrap();
    assert!((apart - 12.0_f64.sqrt()).abs() < 1e-9, "{apart}");
    // Between the bars of an L is outside.
    let l = MeshBody::new(l_mesh()).unwrap();
    let p = Vector3::new(0.5, 0.5, 0.05);
    let ball = Solid::Capsule(Capsule::new(p, p, 0.1).unwrap());
    assert!((l.distance_to(&here, &ball).unwrap() - 0.3).abs() < 1e-9);
}

#[test]
fn volumes_of_hulls() {
    let hull = hull_volume(&l_mesh()).unwrap();
    // The L with the triangle between the ends of its bars.
    assert!((hull - 0.1 * (0.19 + 0.5 * 0.9 * 0.9)).abs() < 1e-9, "{hull}");
    let flat = TriangleMesh::new(vec![Vector3::zeros(), Vector3::x(), Vector3::y()], vec![[0, 1, 2]]);
    assert_eq!(hull_volume(&flat.unwrap()), None);
    let mesh = capsule_mesh(0.5, 0.1, 48, &Isometry3::identity());
    assert!((hull_volume(&mesh).unwrap() / mesh.volume() - 1.0).abs() < 1e-9);
}

#[test]
fn meshes_without_triangles_are_refused() {
    assert!(MeshBody::new(TriangleMesh::default()).is_err());
}
