//! Rounded plans stay inside their limits; a route is free, short and says so on cells whose answers are known.

use crate::common::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use stiffarm::plan::route::{Route, RouteOptions, route, route_findings};

fn routed(cell: &Cell, plan: &[Vec<f64>], keep_angles: bool) -> Route {
    let mut options = RouteOptions::default();
    options.keep_angles = keep_angles;
    options.step_deg = Some(0.01);
    route(cell, plan, &options, Control::default()).unwrap()
}

/// Postures along joint moves, `count` steps each.
fn looks(legs: &[Vec<f64>], count: u32) -> impl Iterator<Item = Vec<f64>> {
    legs.windows(2).flat_map(move |leg| {
        (0..=count).map(move |i| {
            let share = f64::from(i) / f64::from(count);
            let joints = leg[0].iter().zip(&leg[1]);
            joints.map(|(a, b)| a + (b - a) * share).collect()
        })
    })
}

fn degrees(q: &[f64]) -> Vec<f64> {
    q.iter().map(|angle| (angle.to_degrees() * 1e6).round() * 1e-6).collect()
}

#[test]
fn a_plan_on_its_limits_is_rounded_to_the_inside_of_them() {
    let cell = builtin::cell("comau-shapes").unwrap();
    let options = rounds(1);
    let selection = select(&cell, Index::ExpectedError, 6, &options, Control::default()).unwrap();
    let typed = rounded(&cell, &selection.group, 0.01).unwrap();
    let mut margins = cell.posture_margins().unwrap();
    for q in &typed {
        assert!(margins.least(q).unwrap() >= -1e-9);
        assert_eq!(cell.outside_bounds(q).count(), 0);
        for angle in q {
            let steps = angle.to_degrees() * 100.0;
            assert!((steps - steps.round()).abs() < 1e-6, "{steps}");
        }
    }
    // The plain rounding of a plan that lies on its limits leaves some of them.
    let plain = |q: &Vec<f64>| -> Vec<f64> {
        let steps = q.iter().map(|angle| (angle.to_degrees() * 100.0).round());
        steps.map(|steps| (steps / 100.0).to_radians()).collect()
    };
    let outside = |q: Vec<f64>| margins.least(&q).unwrap() < -1e-9;
    assert!(selection.group.iter().map(plain).any(outside));
    // What is typed is worth as much.
    let value = selection.value;
    let typed = selection.with_group::<Vec<f64>>(&cell, &[], typed).unwrap();
    assert!((typed.value / value - 1.0).abs() < 1e-3, "{} {value}", typed.value);
    // Rounding again changes nothing.
    assert_eq!(rounded(&cell, &typed.group, 0.01).unwrap(), typed.group);
}

#[test]
fn a_step_must_be_above_zero() {
    let cell = builtin::cell("comau").unwrap();
    for step in [0.0, -0.01, f64::NAN, f64::INFINITY] {
        assert!(rounded(&cell, &[vec![0.0; 6]], step).is_err());
    }
}

#[test]
fn the_wrist_the_other_way_round_and_full_turns_measure_the_same() {
    let cell = builtin::cell("comau").unwrap();
    let near = vec![0.1, 0.1, -1.6, 0.3, 0.8, 0.2];
    // The same with the wrist turned by half a turn, and another posture beside it.
    let mut flipped = near.clone();
    flipped[0] = 0.15;
    flipped[3] -= PI;
    flipped[4] *= -1.0;
    flipped[5] += PI;
    let plan = rounded(&cell, &[near.clone(), flipped], 0.01).unwrap();
    let fixed = routed(&cell, &plan, true);
    assert!(fixed.turned.is_empty() && fixed.turn > 3.0, "{fixed:?}");
    let tour = routed(&cell, &plan, false);
    assert_eq!(tour.turned.len(), 1, "{tour:?}");
    assert!(tour.turn < 0.2, "{tour:?}");
    let of = |group: &[Vec<f64>]| evaluate(&cell, "plan", group).unwrap();
    let (before, after) = (of(&plan), of(&tour.postures));
    for index in [Index::D, Index::Condition, Index::Classical, Index::O3] {
        let (a, b) = (before.indices.get(index), after.indices.get(index));
        match (a, b) {
            (Some(a), Some(b)) => assert!((a / b - 1.0).abs() < 1e-9, "{index:?}: {a} {b}"),
            other => assert_eq!(other, (None, None), "{index:?}"),
        }
    }
}

#[test]
fn the_same_posture_twice_is_not_driven_to_twice_in_a_row() {
    let cell = builtin::cell("comau").unwrap();
    let at = |q1: f64| vec![q1, 0.1, -1.6, 0.3, 0.8, 0.2];
    let plan = [at(0.0), at(0.0), at(0.5), at(1.0)];
    let tour = routed(&cell, &plan, true);
    let places: Vec<usize> = tour.order.iter().map(|p| (*p).max(1)).collect();
    assert!(places.windows(2).all(|pair| pair[0] != pair[1]), "{tour:?}");
    // Nothing but the two: they have to follow each other.
    assert_eq!(routed(&cell, &plan[..2], true).order.len(), 2);
}

#[test]
fn a_start_is_driven_from_and_back_to() {
    let mut cell = builtin::cell("comau").unwrap();
    let at = |q1: f64| vec![q1, 0.1, -1.6, 0.3, 0.8, 0.2];
    cell.route.start = Some(at(-0.2));
    cell.route.joint_speeds = Some(vec![2.0; 6]);
    let tour = routed(&cell, &[at(1.0), at(0.0), at(0.5)], true);
    // There and back is the same whichever way: out to 1.0 and home past the others, or the other way.
    assert_eq!(tour.moves.len(), 4);
    assert_eq!((tour.moves[0].from, tour.moves[3].to), (None, None));
    assert!((tour.turn - 2.4).abs() < 1e-9, "{tour:?}");
    // 2.4 rad at a tenth of 2 rad/s.
    assert!((tour.travel_s.unwrap() - 12.0).abs() < 1e-9, "{tour:?}");
    assert_eq!(tour.shortest, Some(true));
}

#[test]
fn what_stands_in_the_way_is_driven_around() {
    let cell = builtin::cell("comau-shapes").unwrap();
    let robot = &cell.setup.robot;
    let plan: Vec<Vec<f64>> =
        builtin::postures("comau-group1", robot).unwrap().into_iter().map(|posture| posture.q).collect();
    let mut options = RouteOptions::default();
    options.keep_order = true;
    options.keep_angles = true;
    let tour = route(&cell, &plan, &options, Control::default()).unwrap();
    assert_eq!(tour.order, [0, 1, 2, 3, 4, 5]);
    assert_eq!(tour.shortest, None);
    let first = &tour.moves[0];
    assert!(first.free && first.via.len() == 1, "{first:?}");
    // The straight move comes nearer to the column than half of what shapes keep.
    let margin = |q: &[f64]| {
        let margins = cell.posture_margins().unwrap().named(q).unwrap();
        let shapes = margins.into_iter().filter(|m| m.kind == LimitKind::Shapes);
        shapes.map(|m| m.margin).fold(f64::INFINITY, f64::min)
    };
    let half = 0.5 * cell.scene.clearance();
    let along = |from: &[f64], to: &[f64]| {
        looks(&[from.to_vec(), to.to_vec()], 400).map(|q| margin(&q) + half).fold(f64::INFINITY, f64::min)
    };
    assert!(along(&plan[0], &plan[1]) < 0.0);
    assert!(along(&plan[0], &first.via[0]) > -2e-4);
    assert!(along(&first.via[0], &plan[1]) > -2e-4);
    // The same seed, the same route; and via postures can be typed.
    assert_eq!(route(&cell, &plan, &options, Control::default()).unwrap(), tour);
    for angle in degrees(&first.via[0]) {
        assert!((angle * 100.0 - (angle * 100.0).round()).abs() < 1e-6, "{angle}");
    }
}

/// Every kind of limit on points is kept on the way to a millimetre, and what is told as nearest is never more than
/// what a dense look finds.
#[test]
fn boxes_hold_between_the_postures_and_nearest_is_never_too_far() {
    for name in ["comau", "comau-shapes"] {
        let cell = builtin::cell(name).unwrap();
        let plan = random_group(&cell, StartKind::Uniform, 6, 3, 1).unwrap();
        let tour = routed(&cell, &plan, true);
        for kind in [LimitKind::ToolBox, LimitKind::WristHeight, LimitKind::KeepOut] {
            assert!(tour.checked.contains(&kind), "{:?}", tour.checked);
        }
        let mut margins = cell.posture_margins().unwrap();
        let mut free = 0;
        for each in tour.moves.iter().filter(|each| each.free) {
            free += 1;
            let ends = [each.from, each.to].map(|stop| tour.postures[stop.unwrap()].clone());
            let legs = [vec![ends[0].clone()], each.via.clone(), vec![ends[1].clone()]].concat();
            let mut nearest = f64::INFINITY;
            for q in looks(&legs, 2000) {
                for margin in margins.named(&q).unwrap() {
                    match margin.kind {
                        LimitKind::ToolBox | LimitKind::WristHeight => {
                            assert!(margin.margin > -1.2e-3, "{name}: {margin:?}");
                        }
                        LimitKind::KeepOut => nearest = nearest.min(margin.margin),
                        LimitKind::Shapes => {
                            nearest = nearest.min(margin.margin + cell.scene.clearance());
                        }
                        _ => {}
                    }
                }
            }
            let stated = each.nearest.as_ref().unwrap().distance_m;
            assert!(stated <= nearest, "{name}: {stated} {nearest}");
            assert!(stated > nearest - 1e-3, "{name}: {stated} {nearest}");
        }
        assert!(free > 2, "{name}: {free}");
    }
}

/// Postures that touch something have no way, and none is looked for; who asks to stop is heard.
#[test]
fn postures_in_the_way_are_not_searched_for() {
    let cell = builtin::cell("comau-shapes").unwrap();
    let mut margins = cell.posture_margins().unwrap();
    let mut unlimited = cell.clone();
    unlimited.scene = Default::default();
    unlimited.limits = Default::default();
    let random = random_group(&unlimited, StartKind::Uniform, 40, 5, 1).unwrap();
    let touches = |q: &Vec<f64>| {
        let named = margins.named(q).unwrap();
        let shapes = named.iter().filter(|m| m.kind == LimitKind::Shapes);
        shapes.map(|m| m.margin + cell.scene.clearance()).fold(f64::INFINITY, f64::min) < 0.0
    };
    let bad: Vec<Vec<f64>> = random.into_iter().filter(touches).take(12).collect();
    assert_eq!(bad.len(), 12);
    let looked_at = AtomicUsize::new(0);
    let progress = |_: &str, _: usize, _: usize| {
        looked_at.fetch_add(1, Ordering::Relaxed);
    };
    let control = Control { stop: None, progress: Some(&progress) };
    let mut options = RouteOptions::default();
    options.keep_angles = true;
    let tour = route(&cell, &bad, &options, control).unwrap();
    assert!(tour.moves.iter().all(|each| !each.free && each.via.is_empty()));
    // No other order is tried: none would spare a posture.
    assert_eq!(looked_at.into_inner(), tour.moves.len());
    // The question is asked at every look, so that a stop is heard at once.
    let count = AtomicUsize::new(0);
    let stop = || count.fetch_add(1, Ordering::Relaxed) >= 20;
    let control = stopped_by(&stop);
    let error = route(&cell, &bad, &options, control).unwrap_err();
    assert_eq!(error.code(), Code::Interrupted);
    assert!(count.into_inner() < 30);
}

#[test]
fn rounding_mends_no_posture_that_violates_limits() {
    let cell = builtin::cell("comau").unwrap();
    let far = vec![2.967_123, -1.5, 1.57, 0.0, 1.0, 0.0];
    let typed = rounded(&cell, std::slice::from_ref(&far), 0.01).unwrap();
    for (q, typed) in far.iter().zip(&typed[0]) {
        assert!((q - typed).abs() < 0.0051_f64.to_radians(), "{q} {typed}");
    }
}

#[test]
fn one_flange_pose_with_the_wrist_both_ways_is_one_posture_measured_twice() {
    let cell = builtin::cell("comau").unwrap();
    let first = vec![0.1, 0.1, -1.6, 0.3, 0.8, 0.2];
    let mut flipped = first.clone();
    flipped[3] -= PI;
    flipped[4] *= -1.0;
    flipped[5] += PI;
    let other = vec![0.6, 0.2, -1.4, 0.3, 0.8, 0.2];
    let plan = rounded(&cell, &[first, flipped, other], 0.01).unwrap();
    let tour = routed(&cell, &plan, false);
    assert_eq!(tour.repeats.len(), 1, "{tour:?}");
    assert_eq!(tour.order[1], 2, "{tour:?}");
    // What was found is found again.
    let again = routed(&cell, &tour.postures, false);
    assert!(again.turn <= tour.turn + 1e-9, "{again:?} {tour:?}");
}

/// The load does work when a joint turns from the stop to where it is approached from, so that it presses the joint to
/// the side that its last turn leaves it on; and no leg goes where a move may not.
#[test]
fn stops_are_reached_from_the_side_to_which_their_load_turns() {
    let mut cell = builtin::cell("comau-shapes").unwrap();
    let mut plan = random_group(&cell, StartKind::Uniform, 9, 3, 1).unwrap();
    let turn = 0.5_f64.to_radians();
    cell.route.start = plan.pop();
    assert!(routed(&cell, &plan, true).moves.iter().all(|m| m.approached.is_empty()));
    cell.route.approach = Some(turn);
    let tour = routed(&cell, &plan, true);
    let robot = &cell.setup.robot;
    let Load::Rope { anchor, .. } = cell.setup.load.clone() else { panic!("a rope") };
    let loading_point = |theta: &DVector<f64>| {
        let q = robot.controller_angles(theta).unwrap();
        *PostureTerms::new(&cell.setup, q.as_slice(), None).unwrap().loading_point()
    };
    let mut margins = cell.posture_margins().unwrap();
    let mut approached = 0;
    for each in tour.moves.iter().filter(|each| each.free) {
        let at = |stop: Option<usize>| stop.map_or(cell.route.start.clone(), |s| Some(tour.postures[s].clone()));
        let (from, to) = (at(each.from).unwrap(), at(each.to).unwrap());
        if each.to.is_none() {
            assert!(each.approached.is_empty());
            continue;
        }
        let standing = robot.serial_angles(&to);
        let beyond = robot.serial_angles(each.via.last().unwrap_or(&to));
        for joint in 0..6 {
            let turned = beyond[joint] - standing[joint];
            if !each.approached.contains(&joint) {
                assert!(turned.abs() < 0.02_f64.to_radians(), "{each:?}");
                continue;
            }
            approached += 1;
            assert!((turned.abs() - turn).abs() < 0.02_f64.to_radians(), "{turned}");
            let mut there = standing.clone();
            there[joint] += 1e-4 * turned.signum();
            let point = loading_point(&standing);
            let pull = (anchor - point).normalize();
            assert!(pull.dot(&(loading_point(&there) - point)) > 0.0, "{joint}");
        }
        let legs = [vec![from], each.via.clone(), vec![to]].concat();
        for q in looks(&legs, 500) {
            for margin in margins.named(&q).unwrap() {
                let least = match margin.kind {
                    LimitKind::ToolBox | LimitKind::WristHeight | LimitKind::KeepOut => -1.2e-3,
                    LimitKind::Shapes => -0.5 * cell.scene.clearance() - 1.5e-4,
                    _ => f64::NEG_INFINITY,
                };
                assert!(margin.margin > least, "{margin:?}");
            }
        }
    }
    assert!(approached > 30, "{approached} of 48");
    // What is not approached is named, joint by joint.
    let group = PostureGroup::from_angles("route", tour.postures.iter().cloned());
    let said = route_findings(&cell, &group.postures, &tour).unwrap();
    let said = said.iter().find(|f| f.code == "not-approached");
    let sides = tour.postures.iter().flat_map(|q| cell.sides_of_load(q).unwrap());
    let turned = sides.filter(|side| side.is_some_and(|side| side != 0.0)).count();
    assert!(turned > 40, "{turned} of 48");
    assert_eq!(said.is_some(), approached < turned, "{approached} of {turned}: {said:?}");
    // Who measures the force with a sensor has no side to come from.
    cell.setup.load = Load::Measured;
    let tour = routed(&cell, &plan, true);
    assert!(tour.moves.iter().all(|m| m.approached.is_empty()));
    let said = route_findings(&cell, &group.postures, &tour).unwrap();
    insta::assert_snapshot!(the(&said, "not-approached").sentence, @"[route] approach_deg needs to know which load acts: no posture is approached from its side. Give [load], or take the key out.");
}

#[test]
fn an_approach_needs_a_start_and_a_turn_that_takes_up_lost_motion() {
    let text = builtin::cell_text("comau").unwrap();
    let of = |table: &str| parse_cell(&format!("{text}\n[route]\n{table}"), "cell.toml");
    let start = "start_deg = [0, -20, -90, 0, 60, 0]\n";
    let cell = of(&format!("{start}approach_deg = 0.5")).unwrap();
    assert_eq!(cell.route.approach, Some(0.5_f64.to_radians()));
    let mut report = String::new();
    for wrong in ["0", "-0.5", "0.01", "45", "nan"] {
        let error = of(&format!("{start}approach_deg = {wrong}")).unwrap_err();
        assert_eq!(error.place().key.as_deref(), Some("route.approach_deg"), "{wrong}: {error}");
        report += &format!("{wrong}: {}\n", error.message());
    }
    let error = of("approach_deg = 0.5").unwrap_err();
    assert_eq!(error.place().key.as_deref(), Some("route.approach_deg"), "no start: {error}");
    report += &format!("no start: {} {}\n", error.message(), error.hint_text().unwrap_or_default());
    insta::assert_snapshot!(report, @"
    0: The value must be above 0, got 0.
    -0.5: The value must be above 0, got -0.5.
    0.01: A turn of 0.01° does not take up lost motion.
    45: A turn of 45° does not take up lost motion.
    nan: NaN is not a finite number.
    no start: Nothing says how the first posture is reached. give start_deg, a safe posture that the robot starts from
    ");
}
