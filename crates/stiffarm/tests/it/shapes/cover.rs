//! Shapes that are put around others contain them.

use super::{pose, solid};
use crate::common::prelude::*;
use proptest::prelude::*;
use stiffarm::model::shape::{Solid, capsules_around, solids_around};

/// A point on the surface, in the solid's frame.
fn surface_point(solid: &Solid, dice: &mut Dice) -> Vector3<f64> {
    let (pose, local) = match solid {
        Solid::Block { pose, half } => {
            let mut p = half.map(|h| dice.between(-h, h));
            let face = dice.below(3);
            for axis in 0..3 {
                if axis == face || dice.chance(0.5) {
                    p[axis] = half[axis] * dice.signed(1.0, 1.0);
                }
            }
            (pose, p)
        }
        Solid::Cylinder { pose, half_length, radius } => {
            let turn = dice.between(-3.2, 3.2);
            let (r, z) = match dice.below(3) {
                0 => (*radius, dice.between(-half_length, *half_length)),
                1 => (radius * dice.between(0.0, 1.0), half_length * dice.signed(1.0, 1.0)),
                _ => (*radius, half_length * dice.signed(1.0, 1.0)),
            };
            (pose, Vector3::new(r * turn.cos(), r * turn.sin(), z))
        }
        _ => unreachable!(),
    };
    pose.rotation * local + pose.translation.vector
}

fn triangles(dice: &mut Dice, count: usize) -> (Vec<Vector3<f64>>, Vec<[usize; 3]>) {
    let vertices: Vec<_> = (0..3 * count).map(|_| dice.vector(1.0)).collect();
    let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    (vertices, triangles)
}

fn volume(boxes: &[Solid]) -> f64 {
    let one = |solid: &Solid| match solid {
        Solid::Block { half, .. } => 8.0 * half.product(),
        _ => unreachable!(),
    };
    boxes.iter().map(one).sum()
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn capsules_contain_what_they_are_around(seed: u64) {
        let mut dice = Dice::new(seed);
        let mut shape = solid(&mut dice);
        match &mut shape {
            // Plates and rods, too.
            Solid::Block { half, .. } => half[dice.below(3)] *= dice.between(0.01, 4.0),
            Solid::Cylinder { half_length, .. } => *half_length *= dice.between(0.01, 4.0),
            Solid::HalfSpace { .. } => {
                prop_assert!(capsules_around(&shape).is_empty());
                return Ok(());
            }
            Solid::Capsule(capsule) => {
                prop_assert_eq!(capsules_around(&Solid::Capsule(*capsule)), vec![*capsule]);
                return Ok(());
            }
        }
        let capsules = capsules_around(&shape);
        prop_assert!((1..=4).contains(&capsules.len()));
        for _ in 0..300 {
            let p = surface_point(&shape, &mut dice);
            prop_assert!(shape.signed_distance(&p).0.abs() < 1e-12, "on the surface");
            let out = capsules.iter().map(|c| c.distance_to(&p)).fold(f64::INFINITY, f64::min);
            prop_assert!(out < 1e-12, "{out}");
        }
    }

    #[test]
    fn boxes_contain_every_triangle(seed: u64) {
        let mut dice = Dice::new(seed);
        let count = 1 + dice.below(30);
        let (vertices, triangles) = triangles(&mut dice, count);
        let least = dice.between(0.001, 0.1);
        let mut before = f64::INFINITY;
        for most in [1, 2, 4, 8, 16] {
            let boxes = solids_around(&vertices, &triangles, most, least);
            prop_assert!((1..=most).contains(&boxes.len()));
            let now = volume(&boxes);
            prop_assert!(now <= before + 1e-12, "{now} after {before}");
            before = now;
            for t in &triangles {
                let [u, v] = [dice.between(0.0, 1.0), dice.between(0.0, 1.0)];
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                let [a, b, c] = t.map(|i| vertices[i]);
                for p in [a, b, c, a + (b - a) * u + (c - a) * v] {
                    let out = boxes.iter().map(|s| s.signed_distance(&p).0).fold(f64::INFINITY, f64::min);
                    prop_assert!(out < 1e-12, "{out}");
                }
            }
        }
    }
}

#[test]
fn nothing_has_no_boxes() {
    assert!(solids_around(&[], &[], 4, 0.01).is_empty());
}

#[test]
fn a_flat_triangle_gets_the_least_thickness() {
    let vertices = [Vector3::zeros(), Vector3::x(), Vector3::y()];
    let boxes = solids_around(&vertices, &[[0, 1, 2]], 1, 0.01);
    let Solid::Block { half, .. } = boxes[0] else { panic!("a box") };
    assert!((half - Vector3::new(0.5, 0.5, 0.005)).norm() < 1e-15);
}

/// Two bars of an L fill little of the box around both.
#[test]
fn boxes_follow_an_l() {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for (low, high) in
        [(Vector3::zeros(), Vector3::new(1.0, 0.1, 0.1)), (Vector3::zeros(), Vector3::new(0.1, 1.0, 0.1))]
    {
        let at = vertices.len();
        for corner in 0..8 {
            let pick = |axis: usize| {
                if corner >> axis & 1 == 0 { low[axis] } else { high[axis] }
            };
            vertices.push(Vector3::new(pick(0), pick(1), pick(2)));
        }
        // Two opposite faces are enough to hold the bar's corners.
        for face in [[0, 1, 3], [0, 3, 2], [4, 5, 7], [4, 7, 6]] {
            triangles.push(face.map(|v| at + v));
        }
    }
    let one = volume(&solids_around(&vertices, &triangles, 1, 0.01));
    let more = volume(&solids_around(&vertices, &triangles, 4, 0.01));
    assert!((one - 0.1).abs() < 1e-12);
    assert!(more < 0.45 * one, "{more}");
}

#[test]
fn poses_of_boxes_are_kept() {
    let mut dice = Dice::new(3);
    let frame = pose(&mut dice);
    let block = Solid::block(frame, Vector3::new(0.4, 0.1, 0.1)).unwrap();
    let [capsule] = capsules_around(&block)[..] else { panic!("one capsule") };
    let along = (capsule.b - capsule.a).normalize();
    assert!((along.dot(&(frame.rotation * Vector3::x())).abs() - 1.0).abs() < 1e-12);
}
