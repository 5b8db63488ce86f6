//! Signed distances of solids and nearest points of segments are those of many drawn points.

mod cover;
mod fit;
mod mesh_distance;
mod mesh_files;

use crate::common::prelude::*;
use crate::common::segments::segments_apart;
use nalgebra::Unit;
use proptest::prelude::*;
use stiffarm::model::shape::{Solid, between, nearest};

fn pose(dice: &mut Dice) -> Isometry3<f64> {
    let turn = Unit::new_unchecked(dice.direction());
    Isometry3::from_parts(
        Translation3::from(dice.vector(1.0)),
        UnitQuaternion::from_axis_angle(&turn, dice.between(-3.0, 3.0)),
    )
}

fn capsule(dice: &mut Dice) -> Capsule {
    let a = dice.vector(1.0);
    let b = if dice.chance(0.2) { a } else { dice.vector(1.0) };
    Capsule::new(a, b, dice.between(0.02, 0.5)).unwrap()
}

fn solid(dice: &mut Dice) -> Solid {
    match dice.below(4) {
        0 => Solid::Capsule(capsule(dice)),
        1 => {
            let size = Vector3::from_fn(|_, _| dice.between(0.05, 1.5));
            Solid::block(pose(dice), size).unwrap()
        }
        2 => {
            let (from, to) = (dice.vector(1.0), dice.vector(1.0));
            Solid::cylinder(from, to, dice.between(0.05, 0.8)).unwrap()
        }
        _ => Solid::HalfSpace { point: dice.vector(1.0), normal: Unit::new_unchecked(dice.direction()) },
    }
}

/// Distance of a point outside from the nearest point of the solid, which is found by clamping
/// coordinates instead of by distances from faces.
fn distance_outside(solid: &Solid, point: &Vector3<f64>) -> f64 {
    match solid {
        Solid::Capsule(c) => segments_apart([c.a, c.b], [*point, *point]) - c.radius,
        Solid::HalfSpace { point: on, normal } => (point - on).dot(normal),
        Solid::Block { pose, half } => {
            let local = pose.inverse() * nalgebra::Point3::from(*point);
            let clamped = local.coords.inf(half).sup(&-half);
            (local.coords - clamped).norm()
        }
        Solid::Cylinder { pose, half_length, radius } => {
            let local = (pose.inverse() * nalgebra::Point3::from(*point)).coords;
            let flat = local.xy();
            let inside = flat * (radius / flat.norm()).min(1.0);
            let nearest = Vector3::new(inside.x, inside.y, local.z.clamp(-half_length, *half_length));
            (local - nearest).norm()
        }
    }
}

/// A box or a cylinder, sometimes thin.
fn flat_ended(dice: &mut Dice) -> Solid {
    let thin = |dice: &mut Dice| {
        if dice.chance(0.3) { dice.between(0.01, 0.05) } else { dice.between(0.1, 1.0) }
    };
    if dice.chance(0.5) {
        let size = Vector3::from_fn(|_, _| thin(dice));
        Solid::block(pose(dice), size).unwrap()
    } else {
        let along = Vector3::z() * thin(dice);
        let solid = Solid::cylinder(-along, along, thin(dice)).unwrap();
        solid.placed(&pose(dice))
    }
}

/// Points all over the surface of a box or a cylinder, and how far a point of the surface may be from them.
fn surface(solid: &Solid) -> (Vec<Vector3<f64>>, f64) {
    const EACH: usize = 48;
    let share = |i: usize| 2.0 * i as f64 / EACH as f64 - 1.0;
    let grid = (0..=EACH).flat_map(|i| (0..=EACH).map(move |j| (i, j)));
    match solid {
        Solid::Block { pose, half } => {
            let on_faces = grid.flat_map(|(i, j)| {
                (0..3).flat_map(move |axis| {
                    [-1.0, 1.0].map(|side| {
                        let mut at = Vector3::repeat(side);
                        (at[(axis + 1) % 3], at[(axis + 2) % 3]) = (share(i), share(j));
                        at
                    })
                })
            });
            let placed = on_faces.map(|at| (pose * nalgebra::Point3::from(half.component_mul(&at))).coords);
            (placed.collect(), half.norm() / EACH as f64 * 2.0)
        }
        Solid::Cylinder { pose, half_length, radius } => {
            let on_it = grid.flat_map(|(i, j)| {
                let (s, c) = (std::f64::consts::TAU * i as f64 / EACH as f64).sin_cos();
                let ring = |r: f64, z: f64| Vector3::new(r * c, r * s, z);
                let r = 0.5 * (1.0 + share(j)) * radius;
                [ring(*radius, share(j) * half_length), ring(r, *half_length), ring(r, -half_length)]
            });
            let placed = on_it.map(|at| (pose * nalgebra::Point3::from(at)).coords);
            (placed.collect(), (half_length + radius * 4.0) / EACH as f64)
        }
        _ => unreachable!("flat ends"),
    }
}

/// The nearest point of a solid to a point outside it.
fn onto(solid: &Solid, p: &Vector3<f64>) -> Vector3<f64> {
    let (distance, direction) = solid.signed_distance(p);
    p - direction * distance.max(0.0)
}

proptest! {
    #![proptest_config(cases(150))]

    /// The distance of flat-ended solids against points all over the surface of one of them: never larger, and
    /// smaller by no more than points lie apart; and to a micrometre against projecting to and fro from there.
    #[test]
    fn solids_are_as_far_apart_as_they_are_drawn(seed: u64) {
        let mut dice = Dice::new(seed);
        let first = flat_ended(&mut dice);
        let second = if dice.chance(0.6) { flat_ended(&mut dice) } else { solid(&mut dice) };
        let separation = between(&first, &second, f64::INFINITY).unwrap();
        let (points, spacing) = surface(&first);
        let to = |p: &Vector3<f64>| second.signed_distance(p).0;
        let mut best = *points.iter().min_by(|a, b| to(a).total_cmp(&to(b))).unwrap();
        let sampled = to(&best);
        if sampled < 0.0 {
            prop_assert!(separation.distance < 0.0, "{} {sampled}", separation.distance);
            return Ok(());
        }
        prop_assert!(separation.distance <= sampled + 1e-12);
        prop_assert!(separation.distance >= sampled - spacing, "{} {sampled}", separation.distance);
        if separation.distance < 0.0 {
            return Ok(());
        }
        for _ in 0..20_000 {
            let next = onto(&first, &onto(&second, &best));
            if (next - best).norm() < 1e-13 {
                break;
            }
            best = next;
        }
        prop_assert!((separation.distance - to(&best)).abs() < 1e-6, "{} {}", separation.distance, to(&best));
        // The point is on the first, the direction leads away from the second, and round the other way it is the same.
        prop_assert!(first.signed_distance(&separation.point).0.abs() < 1e-9);
        prop_assert!((to(&separation.point) - separation.distance).abs() < 1e-9);
        prop_assert!((separation.direction.norm() - 1.0).abs() < 1e-9);
        if !matches!(second, Solid::HalfSpace { .. }) {
            let back = between(&second, &first, f64::INFINITY).unwrap();
            prop_assert!((back.distance - separation.distance).abs() < 1e-9);
        }
        // Not worth the work where that much is enough, and nowhere else.
        prop_assert!(between(&first, &second, separation.distance + 1e-6).is_some());
    }

    /// A shift changes the distance by no more than itself, and as the direction says, overlapping too.
    #[test]
    fn distances_of_solids_change_as_they_say(seed: u64) {
        let mut dice = Dice::new(seed);
        let (first, second) = (flat_ended(&mut dice), flat_ended(&mut dice));
        let way = dice.direction();
        let at = |by: f64| {
            let moved = first.placed(&Isometry3::from_parts(Translation3::from(way * by), UnitQuaternion::identity()));
            between(&moved, &second, f64::INFINITY).unwrap()
        };
        let (here, far) = (at(0.0), dice.between(0.0, 0.5));
        prop_assert!((at(far).distance - here.distance).abs() <= far + 1e-9);
        let h = 1e-4;
        let (up, down) = (at(h).distance, at(-h).distance);
        let kink = (up - here.distance) - (here.distance - down);
        // One that is nowhere near the surface of the other has nothing that changes.
        if kink.abs() < 1e-7 && (up != down || here.distance > 0.0) {
            let slope = (up - down) / (2.0 * h);
            prop_assert!((slope - here.direction.dot(&way)).abs() < 2e-3, "{slope} {} at {}", here.direction.dot(&way), here.distance);
        }
    }
}

proptest! {
    #![proptest_config(cases(400))]

    /// Outside, the distance to the nearest point; everywhere 1-Lipschitz, convex along any line
    /// and grown by its own direction.
    #[test]
    fn signed_distances_are_distances(seed: u64) {
        let mut dice = Dice::new(seed);
        let solid = solid(&mut dice);
        let (p, q) = (dice.vector(2.0), dice.vector(2.0));
        let ((at_p, direction), (at_q, _)) = (solid.signed_distance(&p), solid.signed_distance(&q));
        if at_p > 0.0 {
            prop_assert!((at_p - distance_outside(&solid, &p)).abs() < 1e-12);
        }
        prop_assert!((direction.norm() - 1.0).abs() < 1e-12);
        prop_assert!((at_p - at_q).abs() <= (p - q).norm() + 1e-12);
        let t = dice.between(0.0, 1.0);
        let (between, _) = solid.signed_distance(&(p + (q - p) * t));
        prop_assert!(between <= at_p + (at_q - at_p) * t + 1e-12, "convex");
        // A convex function lies above its tangents.
        prop_assert!(at_q >= at_p + direction.dot(&(q - p)) - 1e-12, "supported");
        // Out of a solid it goes on for as far as it says.
        if at_p < 0.0 {
            let out = p - direction * at_p;
            prop_assert!(solid.signed_distance(&out).0.abs() < 1e-12);
        }
    }

    /// The direction is the gradient, where there is one.
    #[test]
    fn directions_are_gradients(seed: u64) {
        let mut dice = Dice::new(seed);
        let (solid, p) = (solid(&mut dice), dice.vector(2.0));
        let (value, direction) = solid.signed_distance(&p);
        let h = 1e-6;
        for axis in 0..3 {
            let step = Vector3::ith(axis, h);
            let (up, down) = (solid.signed_distance(&(p + step)).0, solid.signed_distance(&(p - step)).0);
            // Between two faces the gradient jumps: there both sides differ.
            let kink = (up - value) - (value - down);
            if kink.abs() < 1e-8 {
                prop_assert!(((up - down) / (2.0 * h) - direction[axis]).abs() < 1e-2 * h.sqrt() + kink.abs() / h);
            }
        }
    }

    /// A solid that moves with a point keeps its distance.
    #[test]
    fn distances_move_with_the_frame(seed: u64) {
        let mut dice = Dice::new(seed);
        let (solid, p, frame) = (solid(&mut dice), dice.vector(2.0), pose(&mut dice));
        let (value, direction) = solid.signed_distance(&p);
        let (again, turned) = solid.placed(&frame).signed_distance(&(frame * nalgebra::Point3::from(p)).coords);
        prop_assert!((value - again).abs() < 1e-12);
        prop_assert!((frame.rotation * direction - turned).norm() < 1e-7 || value.abs() < 1e-9 || value < 0.0);
    }

    /// The point of a segment with the smallest signed distance, against golden sections.
    #[test]
    fn the_nearest_point_of_a_segment(seed: u64) {
        let mut dice = Dice::new(seed);
        let solid = solid(&mut dice);
        let a = dice.vector(2.0);
        let b = match dice.below(4) {
            0 => a,
            // Along an axis of the solid, where a box has whole faces as near.
            1 => match &solid {
                Solid::Block { pose, .. } => a + pose.rotation * Vector3::x() * dice.between(-2.0, 2.0),
                Solid::Cylinder { pose, .. } => a + pose.rotation * Vector3::z() * dice.between(-2.0, 2.0),
                Solid::Capsule(c) => a + (c.b - c.a) * dice.between(-2.0, 2.0),
                Solid::HalfSpace { normal, .. } => a + normal.cross(&dice.vector(1.0)),
            },
            _ => dice.vector(2.0),
        };
        let closest = nearest(&solid, &a, &b);
        prop_assert!((0.0..=1.0).contains(&closest.t));
        let point = a + (b - a) * closest.t;
        // Shorter than a unit only where two faces are as near.
        prop_assert!(closest.direction.norm() < 1.0 + 1e-12);
        prop_assert!((closest.direction.norm() - 1.0).abs() < 1e-12 || closest.distance < 0.0);
        prop_assert!((solid.signed_distance(&point).0 - closest.distance).abs() < 1e-9);
        let at = |t: f64| solid.signed_distance(&(a + (b - a) * t)).0;
        let (mut low, mut high) = (0.0, 1.0);
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        for _ in 0..90 {
            let (left, right) = (high - golden * (high - low), low + golden * (high - low));
            if at(left) < at(right) { high = right } else { low = left }
        }
        let expected = at(low).min(at(high)).min(at(0.0)).min(at(1.0));
        prop_assert!((closest.distance - expected).abs() < 1e-9, "{} {}", closest.distance, expected);
        // The convex function lies above its tangent there: what a linearised limit is built on.
        for t in [0.0, 0.5, 1.0] {
            let other = a + (b - a) * t;
            let tangent = closest.distance + closest.direction.dot(&(other - point));
            prop_assert!(at(t) >= tangent - 1e-9);
        }
    }

    /// Two segments, parallel, crossing, touching and of no length among them.
    #[test]
    fn two_segments(seed: u64) {
        let mut dice = Dice::new(seed);
        let (a, b) = (dice.vector(1.0), dice.vector(1.0));
        let along = b - a;
        let scale = dice.between(-1.5, 1.5);
        let (c, d) = match dice.below(6) {
            0 => { let c = dice.vector(1.0); (c, c + along * scale) }
            1 => (a + along * dice.between(-2.0, 2.0), a + along * dice.between(-2.0, 2.0)),
            2 => { let middle = a + along * 0.4; let v = dice.vector(0.5); (middle - v, middle + v) }
            3 => { let c = dice.vector(1.0); (c, c) }
            4 => { let c = dice.vector(1.0); (c, c + along + dice.vector(1e-7)) }
            _ => (dice.vector(1.0), dice.vector(1.0)),
        };
        let expected = segments_apart([a, b], [c, d]);
        let capsule = Solid::Capsule(Capsule { a: c, b: d, radius: 0.1 });
        let closest = nearest(&capsule, &a, &b);
        prop_assert!((closest.distance + 0.1 - expected).abs() < 1e-9, "{} {}", closest.distance + 0.1, expected);
        prop_assert!((closest.direction.norm() - 1.0).abs() < 1e-9);
        // Both ways round the same.
        let back = nearest(&Solid::Capsule(Capsule { a, b, radius: 0.1 }), &c, &d);
        prop_assert!((closest.distance - back.distance).abs() < 1e-9);
    }
}

#[test]
fn shapes_without_a_size_are_refused() {
    let (o, x) = (Vector3::zeros(), Vector3::x());
    assert!(Capsule::new(o, o, 0.1).is_ok(), "a sphere");
    assert!(Capsule::new(o, x, 0.0).is_err());
    assert!(Capsule::new(o, x, f64::INFINITY).is_err());
    assert!(Capsule::new(o, x * f64::NAN, 0.1).is_err());
    assert!(Solid::cylinder(o, o, 0.1).is_err());
    assert!(Solid::cylinder(o, x, -0.1).is_err());
    assert!(Solid::cylinder(o, x * f64::NAN, 0.1).is_err());
    assert!(Solid::block(Isometry3::identity(), Vector3::new(1.0, 0.0, 1.0)).is_err());
    let down = Solid::cylinder(o, -Vector3::z(), 0.1).unwrap();
    assert!((down.signed_distance(&Vector3::new(0.0, 0.0, -0.5)).0 + 0.1).abs() < 1e-12);
}
