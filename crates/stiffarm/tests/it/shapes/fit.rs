//! Capsules around meshes hold every corner and are hardly larger than they must be.

use super::pose;
use crate::common::cases::slip;
use crate::common::meshes::{box_mesh, capsule_mesh, joined, l_mesh};
use crate::common::prelude::*;
use proptest::prelude::*;
use stiffarm::model::shape::capsules_of_mesh;

fn volume(capsules: &[Capsule]) -> f64 {
    capsules.iter().map(Capsule::volume).sum()
}

/// How far the furthest of all corners and of some points of every triangle sticks out \[m\].
fn sticks_out(mesh: &TriangleMesh, capsules: &[Capsule], dice: &mut Dice) -> f64 {
    let out = |p: &Vector3<f64>| {
        let each = capsules.iter().map(|c| c.distance_to(p));
        each.fold(f64::INFINITY, f64::min)
    };
    let mut worst = mesh.vertices.iter().map(&out).fold(f64::NEG_INFINITY, f64::max);
    for [a, b, c] in mesh.corners() {
        for _ in 0..4 {
            let (u, v) = (dice.between(0.0, 1.0), dice.between(0.0, 1.0));
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            worst = worst.max(out(&(a + (b - a) * u + (c - a) * v)));
        }
    }
    worst
}

/// The smallest volume of a capsule around points by trying: directions all over the half sphere,
/// the smallest circle around the points seen along each (Bădoiu and Clarkson), some widths.
fn by_trying(points: &[Vector3<f64>], directions: usize) -> f64 {
    let mut best = f64::INFINITY;
    for i in 0..directions {
        let z = (i as f64 + 0.5) / directions as f64;
        let turn = PI * (3.0 - 5.0_f64.sqrt()) * i as f64;
        let r = (1.0 - z * z).sqrt();
        let direction = Vector3::new(r * turn.cos(), r * turn.sin(), z);
        let flat: Vec<Vector3<f64>> = points.iter().map(|p| p - direction * p.dot(&direction)).collect();
        let mut centre = flat[0];
        for step in 0..400 {
            let far = flat.iter().max_by(|a, b| (*a - centre).norm_squared().total_cmp(&(*b - centre).norm_squared()));
            centre += (far.unwrap() - centre) / (step + 2) as f64;
        }
        let least = flat.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max);
        for wider in [0.0, 0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.5] {
            let radius = least * (1.0 + wider);
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for (p, q) in points.iter().zip(&flat) {
                let reach = (radius * radius - (q - centre).norm_squared()).max(0.0).sqrt();
                low = low.min(p.dot(&direction) + reach);
                high = high.max(p.dot(&direction) - reach);
            }
            let length = (high - low).max(0.0);
            best = best.min(PI * radius * radius * (length + 4.0 / 3.0 * radius));
        }
    }
    best
}

proptest! {
    #![proptest_config(cases(3))]

    #[test]
    fn everything_is_inside(seed: u64) {
        let mut dice = Dice::new(seed);
        let mut mesh = TriangleMesh::default();
        for _ in 0..1 + dice.below(4) {
            let (low, size) = (dice.vector(0.5), Vector3::from_fn(|_, _| dice.between(0.02, 0.8)));
            let part = if dice.chance(0.5) {
                box_mesh(low, low + size)
            } else {
                capsule_mesh(size.x, 0.3 * size.y, 12, &Isometry3::identity())
            };
            mesh = joined(mesh, &part.placed(&pose(&mut dice)));
        }
        let mut before = f64::INFINITY;
        for most in [1, 2, 4] {
            let capsules = capsules_of_mesh(&mesh, most);
            prop_assert!((1..=most).contains(&capsules.len()));
            prop_assert!(sticks_out(&mesh, &capsules, &mut dice) <= 0.0);
            prop_assert!(volume(&capsules) <= before);
            before = volume(&capsules);
            for c in &capsules {
                let steps = c.radius * 1e5;
                prop_assert!((steps - steps.round()).abs() < 1e-6, "whole hundredths: {}", c.radius);
            }
        }
    }

    /// As small as what trying everything finds, to 2 %: the search is local.
    #[test]
    fn no_larger_than_by_trying(seed: u64) {
        let mut dice = Dice::new(seed);
        let size = Vector3::from_fn(|_, _| dice.between(0.1, 1.0));
        let mut mesh = box_mesh(-size, size).placed(&pose(&mut dice));
        if dice.chance(0.7) {
            let scale = 0.3 * size.amax();
            mesh.vertices.iter_mut().for_each(|v| *v += dice.vector(scale));
        }
        let ours = volume(&capsules_of_mesh(&mesh, 1));
        let tried = by_trying(&mesh.vertices, 600);
        prop_assert!(ours < 1.02 * tried, "{ours} {tried}");
    }
}

#[test]
fn a_capsule_is_found_again() {
    let mut dice = Dice::new(5);
    for (half, radius) in [(0.5, 0.1), (0.3, 0.25), (0.02, 0.2), (1.2, 0.05)] {
        let mesh = capsule_mesh(half, radius, 48, &pose(&mut dice));
        let ours = volume(&capsules_of_mesh(&mesh, 1));
        let true_one = PI * radius * radius * (2.0 * half + 4.0 / 3.0 * radius);
        assert!((ours / true_one - 1.0).abs() < 0.02, "{half} {radius}: {ours} {true_one}");
    }
}

#[test]
fn an_l_gets_two() {
    let mut dice = Dice::new(6);
    let mesh = l_mesh().placed(&pose(&mut dice));
    let [one, two] = [1, 2].map(|most| capsules_of_mesh(&mesh, most));
    assert_eq!((one.len(), two.len()), (1, 2));
    assert!(volume(&two) < 0.3 * volume(&one));
    assert!(sticks_out(&mesh, &two, &mut dice) <= 0.0);
    // A straight bar does not.
    let bar = box_mesh(Vector3::zeros(), Vector3::new(1.0, 0.1, 0.1));
    assert_eq!(capsules_of_mesh(&bar, 4).len(), 1);
}

/// One triangle is long enough for both parts of a cut: it is in none of the capsules, but in both.
#[test]
fn a_large_triangle_is_cut() {
    let [a, b, c] = [Vector3::zeros(), Vector3::x(), Vector3::y()];
    let mesh = TriangleMesh::new(vec![a, b, c], vec![[0, 1, 2]]).unwrap();
    let capsules = capsules_of_mesh(&mesh, 6);
    assert!(capsules.len() > 1);
    assert!(sticks_out(&mesh, &capsules, &mut Dice::new(7)) <= 0.0);
}

#[test]
fn small_meshes_have_capsules_too() {
    assert!(capsules_of_mesh(&TriangleMesh::default(), 2).is_empty());
    let p = Vector3::new(0.1234567, 0.2, 0.3);
    let point = TriangleMesh::new(vec![p; 3], vec![[0, 1, 2]]).unwrap();
    let [capsule] = capsules_of_mesh(&point, 2)[..] else { panic!("one") };
    assert!(capsule.distance_to(&p) <= 0.0 && capsule.radius <= 2e-5);
    let line = TriangleMesh::new(vec![p, p + Vector3::x(), p], vec![[0, 1, 2]]).unwrap();
    let [capsule] = capsules_of_mesh(&line, 1)[..] else { panic!("one") };
    assert!(capsule.distance_to(&line.vertices[1]) <= 0.0 && capsule.radius < 1e-3);
    // A corner of no triangle counts.
    let mut mesh = box_mesh(Vector3::zeros(), Vector3::repeat(0.1));
    mesh.vertices.push(Vector3::x());
    for most in 1..3 {
        let capsules = capsules_of_mesh(&mesh, most);
        assert!(capsules.iter().any(|c| c.distance_to(&Vector3::x()) <= 0.0));
    }
}

#[test]
fn meshes_that_are_none_are_refused() {
    let o = Vector3::zeros();
    let report = slip("no triangle", TriangleMesh::new(vec![o], vec![]))
        + &slip("a corner that is not there", TriangleMesh::new(vec![o], vec![[0, 0, 1]]))
        + &slip("no number", TriangleMesh::new(vec![o * f64::NAN], vec![[0, 0, 0]]));
    insta::assert_snapshot!(report, @"
    » no triangle
    [too-few-data] The mesh has no triangles.

    » a corner that is not there
    [invalid-value] A triangle has corner 1, but there are 1 corners, counted from 0.

    » no number
    [not-finite] The mesh has a coordinate that is not finite.
    ");
    let mesh = l_mesh();
    assert!((mesh.extent() - Vector3::new(1.0, 1.0, 0.1)).norm() < 1e-15);
    assert!((mesh.volume() - 0.02).abs() < 1e-12, "both bars");
}

/// A mesh of more than 10,000 corners takes no longer to fit than anybody waits; this test says
/// nothing of seconds, only that it ends.
#[test]
fn a_large_mesh() {
    let mesh = capsule_mesh(0.4, 0.15, 110, &Isometry3::identity());
    assert!(mesh.vertices.len() > 10_000);
    let capsules = capsules_of_mesh(&mesh, 3);
    assert!(sticks_out(&mesh, &capsules, &mut Dice::new(8)) <= 0.0);
    assert_eq!(capsules.len(), 1);
}
