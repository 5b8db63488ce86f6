//! Maps of dexterity and of the influence of K_C over joints 2 and 3 have the values of their formulas.

use crate::common::prelude::*;
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_4;
use stiffarm::Result;
use stiffarm::model::dexterity::condition_number;
use stiffarm::plan::zones::{ZoneMap, ZoneOptions, Zones};
use stiffarm::units::rad_to_shortest_deg;

/// The maps of a search that nobody stops.
fn zones(cell: &Cell, options: &ZoneOptions) -> Result<Zones> {
    stiffarm::plan::zones::zones(cell, options, Control::default())
}

fn held(steps: usize, q: Option<Vec<f64>>) -> ZoneOptions {
    with(|o: &mut ZoneOptions| {
        o.steps = steps;
        o.q = q;
    })
}

fn options(steps: usize) -> ZoneOptions {
    held(steps, None)
}

fn posture(zones: &Zones, row: usize, column: usize) -> Vec<f64> {
    let mut q: Vec<f64> = zones.held.iter().map(|q| q.unwrap_or(0.0)).collect();
    (q[1], q[2]) = (zones.q2[column], zones.q3[row]);
    q
}

/// Relative deviations of translation and rotation, with K_C by differences of
/// Γ = J(θ)ᵀ W: W is constant in base axes, but for a rope, which stays directed to its anchor.
fn deviations(cell: &Cell, q: &[f64]) -> [f64; 2] {
    let robot = &cell.setup.robot;
    let theta = robot.serial_angles(q);
    let frames = Frames::new(robot, q);
    let loading = &cell.setup.tool.loading_point;
    let load = cell.setup.load.wrench(&frames, &frames.point(loading)).unwrap();
    let wrench = DVector::from_iterator(6, load.force.iter().chain(load.moment.iter()).copied());
    let torque = |theta: &DVector<f64>| {
        let frames = Frames::at_serial_angles(robot, theta.as_slice());
        let at = frames.point(loading);
        let jacobian = frames.jacobian(&at);
        match &cell.setup.load {
            rope @ Load::Rope { .. } => {
                let force = rope.wrench(&frames, &at).unwrap().force;
                jacobian.rows(0, 3).tr_mul(&force)
            }
            _ => jacobian.tr_mul(&wrench),
        }
    };
    let n = theta.len();
    let h = 1e-5;
    let mut correction = DMatrix::zeros(n, n);
    for j in 0..n {
        let (mut up, mut down) = (theta.clone(), theta.clone());
        up[j] += h;
        down[j] -= h;
        correction.set_column(j, &((torque(&up) - torque(&down)) / (2.0 * h)));
    }
    let stiffness = DMatrix::from_diagonal(&DVector::from_row_slice(cell.prior.as_ref().unwrap()));
    let jacobian = frames.jacobian(&frames.point(&cell.setup.tool.tcp()));
    let shift = |stiffness: DMatrix<f64>| &jacobian * stiffness.lu().solve(&torque(&theta)).unwrap();
    let (without, with) = (shift(stiffness.clone()), shift(stiffness - correction));
    [0, 3].map(|at| {
        let before = without.rows(at, 3);
        (with.rows(at, 3) - before).norm() / before.norm()
    })
}

fn values(map: &ZoneMap) -> Vec<f64> {
    map.iter().flatten().flatten().copied().collect()
}

#[test]
fn values_are_those_of_the_formulas() {
    let cell = reference_cell();
    let maps = zones(&cell, &options(7)).unwrap();
    assert_eq!(maps.joints, ["joint 2", "joint 3"]);
    assert_eq!(maps.held, [Some(0.0), None, None, Some(FRAC_PI_4), Some(FRAC_PI_4), Some(FRAC_PI_4)]);
    assert_eq!([maps.q2[0], maps.q2[6]].map(rad_to_shortest_deg), [-60.0, 40.0]);
    assert_eq!([maps.q3[0], maps.q3[6]].map(rad_to_shortest_deg), [-180.0, -40.0]);
    assert_eq!((maps.postures, maps.within_limits), (49, 49));
    for (row, column) in [(0, 0), (2, 5), (6, 1), (3, 3)] {
        let q = posture(&maps, row, column);
        let frames = Frames::new(&cell.setup.robot, &q);
        let tcp = frames.point(&cell.setup.tool.tcp());
        let k = condition_number(&frames, &tcp, 0.773).unwrap();
        let ours = maps.inverse_condition[row][column].unwrap();
        assert!((ours * k - 1.0).abs() < 1e-12, "{ours} {k}");
        let [translation, rotation] = deviations(&cell, &q);
        let ours = maps.translation_deviation[row][column].unwrap();
        assert!((ours / translation - 1.0).abs() < 1e-5, "{ours} {translation}");
        let ours = maps.rotation_deviation[row][column].unwrap();
        assert!((ours / rotation - 1.0).abs() < 1e-5, "{ours} {rotation}");
    }
    // A rope's own turning is in it: K_C of a constant force alone would give 0.0242 %.
    let mut one = default_cell();
    for (joint, low) in [(1, 0.0), (2, -159.0)] {
        one.bounds[joint] = [low, low + 1.0].map(f64::to_radians);
    }
    let found_one = zones(&one, &options(2)).unwrap();
    let deviation = found_one.translation_deviation[0][0].unwrap();
    assert!((deviation - 0.000_932).abs() < 1e-6, "{deviation}");
    // Below 2 % at 500 N, and not nothing.
    let largest = maps.translation_range.unwrap().largest;
    assert!((1e-4..0.02).contains(&largest), "{largest}");
}

#[test]
fn postures_outside_the_limits_have_no_values() {
    let cell = default_cell();
    let zones = zones(&cell, &options(15)).unwrap();
    let mut inside = 0;
    for row in 0..15 {
        for column in 0..15 {
            let q = posture(&zones, row, column);
            let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
            let margin = cell.margins().smallest(&terms).unwrap().margin;
            let maps = [&zones.inverse_condition, &zones.translation_deviation, &zones.rotation_deviation];
            for map in maps {
                assert_eq!(map[row][column].is_some(), margin >= 0.0, "{row} {column}");
            }
            inside += usize::from(margin >= 0.0);
        }
    }
    assert_eq!(zones.within_limits, inside);
    assert!((20..200).contains(&inside), "{inside}");
}

#[test]
fn the_best_zone_is_dexterous_untouched_and_in_one_piece() {
    for mut cell in [reference_cell(), default_cell()] {
        // Near the anchor the arm is most dexterous and the rope turns most: they do not meet.
        assert_eq!(zones(&cell, &options(31)).unwrap().best, None);
        cell.setup.load = hanging(500.0);
        let zones = zones(&cell, &options(31)).unwrap();
        let best = zones.best.clone().unwrap();
        let sorted = |map: &ZoneMap| changed(values(map), |o| o.sort_by(f64::total_cmp));
        let dexterity = sorted(&zones.inverse_condition);
        // As many postures as the upper quarter holds.
        let above = dexterity.iter().filter(|v| **v > best.inverse_condition).count();
        assert!(above < dexterity.len() / 4);
        assert!(best.translation_deviation <= zones.translation_range.unwrap().median);
        assert!(best.rotation_deviation <= zones.rotation_range.unwrap().median);
        assert_eq!(zones.inverse_condition_range.unwrap().largest, dexterity[dexterity.len() - 1]);
        // Nothing else that is as little touched is more dexterous.
        for row in 0..31 {
            for column in 0..31 {
                let Some(value) = zones.inverse_condition[row][column] else {
                    continue;
                };
                let calm = zones.translation_deviation[row][column].unwrap() <= zones.translation_range.unwrap().median
                    && zones.rotation_deviation[row][column].unwrap() <= zones.rotation_range.unwrap().median;
                assert!(!calm || value <= best.inverse_condition);
            }
        }
        let [low, high] = best.q2;
        assert!((low..=high).contains(&best.best_q[1]), "{best:?}");
        let [low, high] = best.q3;
        assert!((low..=high).contains(&best.best_q[2]), "{best:?}");
        assert!(best.posture_count >= 1 && best.posture_count <= zones.within_limits / 4 + 1);
        assert_eq!([best.best_q[0], best.best_q[3]], [0.0, FRAC_PI_4]);
    }
}

#[test]
fn joint_1_turns_the_dexterity_nowhere_and_held_angles_are_held() {
    let cell = reference_cell();
    let straight = zones(&cell, &options(5)).unwrap();
    let q = [70.0, 1e6, -1e6, 45.0, 45.0, 45.0].map(f64::to_radians);
    let turned = zones(&cell, &held(5, Some(q.to_vec()))).unwrap();
    assert_eq!(turned.held[0], Some(70_f64.to_radians()));
    let pairs = values(&straight.inverse_condition);
    for (a, b) in pairs.iter().zip(values(&turned.inverse_condition)) {
        assert!((a / b - 1.0).abs() < 1e-10);
    }
    // The rope does not turn with joint 1.
    assert_ne!(straight.translation_deviation, turned.translation_deviation);
    let wrist = [0.0, 0.0, 0.0, 10.0, 20.0, 30.0].map(f64::to_radians);
    let wrist = zones(&cell, &held(5, Some(wrist.to_vec()))).unwrap();
    assert_ne!(straight.inverse_condition, wrist.inverse_condition);
}

#[test]
fn what_is_missing_is_said() {
    let cell = reference_cell();
    let error = |cell: &Cell, options: &ZoneOptions| zones(cell, options).unwrap_err();
    for steps in [0, 1, 501] {
        assert_eq!(error(&cell, &options(steps)).code(), Code::InvalidValue);
    }
    let mut other = cell.clone();
    other.prior = None;
    let fault = error(&other, &options(3));
    assert_eq!(fault.place().key.as_deref(), Some("stiffness.prior_nm_per_rad"));
    let mut other = cell.clone();
    other.characteristic_length = None;
    assert_eq!(error(&other, &options(3)).code(), Code::MissingKey);
    let mut other = cell.clone();
    other.setup.load = Load::Measured;
    assert_eq!(error(&other, &options(3)).code(), Code::MissingKey);
    let held = |q: Vec<f64>| held(3, Some(q));
    assert_eq!(error(&cell, &held(vec![0.0; 5])).code(), Code::Dimension);
    assert_eq!(error(&cell, &held(vec![f64::NAN; 6])).code(), Code::NotFinite);
    let mut limited = cell.clone();
    let limits = vec![[-3.2, 3.2]; 6];
    limited.setup.robot = limited.setup.robot.with_limits(&limits).unwrap();
    let fault = error(&limited, &held(vec![0.0, 0.0, 0.0, 4.0, 0.0, 0.0]));
    assert_eq!(fault.code(), Code::OutsideLimits);
    insta::assert_snapshot!(fault, @"
    q_deg: joint 4 is held at 229.183118°, outside the machine's limits, -183.346494° to 183.346494°.
      hint: hold the joints at angles the machine can take
    ");
    // Other than six joints.
    let mut dice = Dice::new(3);
    let five = dice.model(5, 0, false, false).cell();
    assert_eq!(error(&five, &options(3)).code(), Code::Unsupported);
    let seven = dice.model(7, 0, false, false).cell();
    let fault = error(&seven, &options(3));
    insta::assert_snapshot!(fault, @"
    q_deg: Dumas' choice of the held angles is for six joints, and random has 7.
      hint: give the angles of all 7 joints (those of joints 2 and 3 are replaced by the map's)
    ");
    assert!(zones(&seven, &held(vec![0.3; 7])).is_ok());
}

#[test]
fn a_load_that_bends_nothing_gives_no_values_and_no_zone() {
    let mut cell = reference_cell();
    cell.setup.load = Load::Constant { wrench: Wrench::force(Vector3::zeros()), axes: Axes::Base };
    let zones = zones(&cell, &options(4)).unwrap();
    assert!(values(&zones.inverse_condition).is_empty());
    assert_eq!((zones.within_limits, zones.best), (16, None));
    assert_eq!(zones.translation_range, None);
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn deviations_grow_with_the_load_and_agree_with_differences(
        n in 6..8_usize,
        kind in 0..4_usize,
        seed in any::<u64>(),
    ) {
        let mut dice = Dice::new(seed);
        let mut cell = dice.model(n, kind, false, false).cell();
        let held = held(3, Some(dice.posture(n)));
        let before = zones(&cell, &held).unwrap();
        let q = posture(&before, 1, 2);
        if let Some(ours) = before.translation_deviation[1][2] {
            let [translation, rotation] = deviations(&cell, &q);
            prop_assert!((ours / translation - 1.0).abs() < 1e-4, "{ours} {translation}");
            let ours = before.rotation_deviation[1][2].unwrap();
            prop_assert!((ours / rotation - 1.0).abs() < 1e-4, "{ours} {rotation}");
        }
        // To first order the influence of K_C is proportional to the load.
        match &mut cell.setup.load {
            Load::Rope { magnitude, .. } | Load::Weight { magnitude, .. } => *magnitude *= 1e-3,
            Load::Constant { wrench, .. } => {
                wrench.force *= 1e-3;
                wrench.moment *= 1e-3;
            }
            Load::Measured | Load::Cases(_) => {}
        }
        let after = zones(&cell, &held).unwrap();
        for (a, b) in values(&before.translation_deviation).iter().zip(values(&after.translation_deviation)) {
            if *a < 1e-2 {
                prop_assert!((1e-3 * a / b - 1.0).abs() < 0.1, "{a} {b}");
            }
        }
    }
}
