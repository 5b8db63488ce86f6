//! Space-filling groups stay inside the limits, are evenly spread and repeat.

use crate::common::prelude::*;
use proptest::prelude::*;
use std::f64::consts::TAU;
use stiffarm::Result;
use stiffarm::plan::select::{self, joint_distance, smallest_distance};

/// The postures alone, of a search that nobody stops.
fn space_filling(cell: &Cell, count: usize, seed: u64) -> Result<Vec<Vec<f64>>> {
    let filled = select::space_filling(cell, count, seed, Control::default())?;
    assert_ne!(filled.termination, Termination::Interrupted);
    Ok(filled.postures)
}

/// Asserts that a group is inside bounds and limits, and counted right.
fn assert_inside(cell: &Cell, group: &[Vec<f64>], count: usize) {
    assert_eq!(group.len(), count);
    for q in group {
        assert_eq!(q.len(), cell.bounds.len());
        let mut angles = q.iter().zip(&cell.bounds);
        assert!(angles.all(|(q, b)| (b[0]..=b[1]).contains(q)), "{q:?}");
    }
    assert!(smallest_margin(cell, group).unwrap().is_none_or(|m| m >= 0.0));
}

/// Median of the smallest distance of random groups of `count`.
fn random_distance(cell: &Cell, count: usize) -> f64 {
    let mut distances: Vec<f64> = (0..21)
        .map(|stream| {
            let group = random_group(cell, StartKind::Uniform, count, 7, stream).unwrap();
            smallest_distance(&cell.bounds, &group).unwrap()
        })
        .collect();
    distances.sort_by(f64::total_cmp);
    distances[distances.len() / 2]
}

/// Largest distance of random feasible postures to the nearest of a group.
fn largest_hole(cell: &Cell, group: &[Vec<f64>]) -> f64 {
    let probes = random_group(cell, StartKind::Uniform, 2000, 99, 0).unwrap();
    let holes = probes.iter().map(|q| {
        let distances = group.iter().map(|g| joint_distance(&cell.bounds, g, q));
        distances.fold(f64::INFINITY, f64::min)
    });
    holes.fold(0.0, f64::max)
}

#[test]
fn groups_are_inside_and_farther_apart_than_random_ones() {
    for cell in [reference_cell(), default_cell()] {
        for count in [15, 20, 50] {
            let group = space_filling(&cell, count, 1).unwrap();
            assert_inside(&cell, &group, count);
            let ours = smallest_distance(&cell.bounds, &group).unwrap();
            let random = random_distance(&cell, count);
            assert!(ours > 1.6 * random, "{count}: {ours} {random}");
        }
    }
}

#[test]
fn no_part_of_the_joint_space_is_left_out() {
    let cell = default_cell();
    for count in [20, 50] {
        let group = space_filling(&cell, count, 3).unwrap();
        let mut random: Vec<f64> = (0..11)
            .map(|stream| {
                let group = random_group(&cell, StartKind::Uniform, count, 7, stream).unwrap();
                largest_hole(&cell, &group)
            })
            .collect();
        random.sort_by(f64::total_cmp);
        let ours = largest_hole(&cell, &group);
        assert!(ours < random[5], "{count}: {ours} {random:?}");
        // And they are worth measuring: every joint is determined.
        let evaluated = evaluate(&cell, "", &group).unwrap();
        assert!(evaluated.undetermined_joints.is_empty());
        assert!(evaluated.indices.expected_error.unwrap() < 0.02);
    }
}

#[test]
fn a_seed_decides_and_another_seed_decides_otherwise() {
    let cell = default_cell();
    let group = |seed| space_filling(&cell, 15, seed).unwrap();
    assert_eq!(group(1), group(1));
    assert_ne!(group(1), group(2));
    // Not the numbers of a random group of that seed.
    let random = random_group(&cell, StartKind::Uniform, 15, 1, 0).unwrap();
    assert!(group(1).iter().all(|q| !random.contains(q)));
}

/// In one dimension the best is known: equal steps from border to border.
#[test]
fn one_free_joint_is_divided_equally() {
    let mut cell = reference_cell();
    for (j, bounds) in cell.bounds.iter_mut().enumerate() {
        *bounds = if j == 1 { [-0.5, 0.7] } else { [0.1 * j as f64; 2] };
    }
    let group = space_filling(&cell, 5, 1).unwrap();
    let mut angles: Vec<f64> = group.iter().map(|q| q[1]).collect();
    angles.sort_by(f64::total_cmp);
    for (i, angle) in angles.iter().enumerate() {
        let even = -0.5 + 1.2 * i as f64 / 4.0;
        assert!((angle - even).abs() < 0.05, "{angles:?}");
    }
    // On a full turn the ends are one place: five postures, 72° apart.
    cell.bounds[1] = [0.4; 2];
    cell.bounds[3] = [-PI, PI];
    let group = space_filling(&cell, 5, 1).unwrap();
    let smallest = smallest_distance(&cell.bounds, &group).unwrap();
    assert!((0.18..=0.2 + 1e-9).contains(&smallest), "{smallest}");
}

#[test]
fn distance_is_relative_to_the_ranges_and_counts_modulo_a_turn() {
    let bounds = [[-1.0, 1.0], [0.0, 0.5], [2.0, 2.0], [-PI, 3.0 * PI]];
    let a = [-1.0, 0.0, 2.0, 0.0];
    assert_eq!(joint_distance(&bounds, &a, &[1.0, 0.0, 2.0, 0.0]), 1.0);
    assert_eq!(joint_distance(&bounds, &a, &[-1.0, 0.25, 2.0, 0.0]), 0.5);
    let turned = joint_distance(&bounds, &a, &[-1.0, 0.0, 2.0, TAU]);
    assert!(turned < 1e-12, "{turned}");
    let half = joint_distance(&bounds, &a, &[-1.0, 0.0, 2.0, PI]);
    assert!((half - 0.5).abs() < 1e-12, "{half}");
    assert_eq!(smallest_distance(&bounds, &[a]), None);
}

#[test]
fn tight_limits_are_kept_and_impossible_ones_said() {
    // A box in which a few postures in a thousand have its tool.
    let mut cell = default_cell();
    cell.limits.tool_box = Some([Vector3::new(1.4, -0.4, 0.7), Vector3::new(2.1, 0.4, 1.5)]);
    let group = space_filling(&cell, 20, 1).unwrap();
    assert_inside(&cell, &group, 20);
    let ours = smallest_distance(&cell.bounds, &group).unwrap();
    assert!(ours > 0.25, "{ours}");
    // A box that no tool fits into.
    cell.limits.tool_box = Some([Vector3::new(1.4, 0.0, 0.7), Vector3::new(1.5, 0.1, 0.8)]);
    let error = space_filling(&cell, 3, 1).unwrap_err();
    assert_eq!(error.code(), Code::InvalidValue);
    assert_eq!(error.place().key.as_deref(), Some("limits"));
    assert!(error.hint_text().is_some());
}

#[test]
fn what_cannot_be_is_an_error() {
    let mut cell = default_cell();
    for count in [0, 100_000] {
        let error = space_filling(&cell, count, 1).unwrap_err();
        assert_eq!(error.code(), Code::InvalidValue, "{error}");
    }
    cell.bounds[2] = [0.3, -0.3];
    let error = space_filling(&cell, 3, 1).unwrap_err();
    insta::assert_snapshot!(error, @"bounds.q_deg: The bounds of joint 3 are reversed or not finite.");
    cell.bounds[2] = [f64::NAN, 0.3];
    assert!(space_filling(&cell, 3, 1).is_err());
    // Nothing can move: one posture, not two.
    let mut fixed = reference_cell();
    for bounds in &mut fixed.bounds {
        bounds[1] = bounds[0];
    }
    assert_eq!(space_filling(&fixed, 1, 1).unwrap().len(), 1);
    assert!(space_filling(&fixed, 2, 1).is_err());
}

#[test]
fn a_load_that_comes_with_the_measurement_is_no_obstacle() {
    let mut cell = default_cell();
    cell.limits.rope_length = None;
    let before = space_filling(&cell, 6, 1).unwrap();
    cell.setup.load = Load::Measured;
    assert_eq!(space_filling(&cell, 6, 1).unwrap(), before);
}

/// Exchanges that look at each candidate once choose what a look at all pairs chooses.
#[test]
fn many_postures_are_spread_as_far_and_soon() {
    let cell = default_cell();
    // Numbers of an earlier version, which took 23 s for the second.
    for (count, before) in [(20, 0.641_041_3), (60, 0.499_398_7)] {
        let group = space_filling(&cell, count, 1).unwrap();
        let ours = smallest_distance(&cell.bounds, &group).unwrap();
        assert!(ours > before - 1e-6, "{count}: {ours} {before}");
    }
}

#[test]
fn a_stopped_search_gives_the_postures_so_far() {
    let cell = default_cell();
    let polls = std::sync::atomic::AtomicUsize::new(0);
    let after = |most: usize| {
        polls.store(0, std::sync::atomic::Ordering::Relaxed);
        let stop = || polls.fetch_add(1, std::sync::atomic::Ordering::Relaxed) > most;
        let control = stopped_by(&stop);
        select::space_filling(&cell, 40, 1, control)
    };
    assert_eq!(after(10).unwrap_err().code(), Code::Interrupted);
    let whole = space_filling(&cell, 40, 1).unwrap();
    let distance = |group: &[Vec<f64>]| smallest_distance(&cell.bounds, group).unwrap();
    // Candidates and a first group take some hundred looks.
    let early = (1..40).map(|k| after(100 * k)).find_map(Result::ok).unwrap();
    assert_eq!(early.termination, Termination::Interrupted);
    assert_inside(&cell, &early.postures, 40);
    assert!(distance(&early.postures) <= distance(&whole));
}

proptest! {
    #![proptest_config(cases(8))]

    #[test]
    fn any_robot_gets_its_group(n in 3..8_usize, count in 2..12_usize, seed in any::<u64>()) {
        let mut dice = Dice::new(seed);
        let mut cell = dice.model(n, 0, false, false).cell();
        for bounds in &mut cell.bounds {
            let low = dice.between(-PI, 2.0);
            *bounds = [low, low + dice.between(0.2, 5.0)];
        }
        let group = space_filling(&cell, count, seed).unwrap();
        assert_inside(&cell, &group, count);
        let ours = smallest_distance(&cell.bounds, &group).unwrap();
        prop_assert!(ours > random_distance(&cell, count));
    }
}
