//! Readings against a preload: they hold nothing of the lost motion, the way from no load to the preload does, and at
//! work all of it is there again.

use crate::common::prelude::*;
use crate::common::readings::{given, states, tracker_pose};
use crate::common::runs::fewest;
use stiffarm::estimate::mixed::MixedFit;
use stiffarm::estimate::systematic::{SystematicErrors, mixed_systematic_errors};
use stiffarm::model::measurement::Role;

const ARC_MINUTE: f64 = PI / 180.0 / 60.0;
/// Half the gap of each joint of a worn arm \[rad\].
const GAPS: [f64; 6] =
    [0.5 * ARC_MINUTE, 0.6 * ARC_MINUTE, 0.4 * ARC_MINUTE, 0.5 * ARC_MINUTE, 0.3 * ARC_MINUTE, 0.5 * ARC_MINUTE];
/// Unloaded, the preload, all of the load.
const ALL: [(&str, f64, usize); 3] = [("unloaded", 0.0, 1), ("preload", 0.2, 1), ("loaded", 1.0, 1)];

/// What was read of an arm with these gaps, in the states named.
fn read(cell: &Cell, taken: &[(&str, f64, usize)], seed: u64) -> Measured {
    let done = Experiment {
        base_from_tracker: tracker_pose(),
        states: states(taken),
        force: ForceRecord::Load,
        tracker_noise: TrackerNoise::Isotropic,
        lost_motion: Some(GAPS.to_vec()),
        ..Experiment::default()
    };
    let truth = cell.require_prior().unwrap();
    let postures = numbered(group1());
    let table = experiment(cell, &postures, truth, &done, seed, 0).unwrap();
    prepare(cell, table, &given(tracker_pose())).unwrap()
}

fn without<'a>(role: Role) -> Vec<(&'a str, f64, usize)> {
    let other = |state: &&(&str, f64, usize)| Role::of(state.0) != role;
    ALL.iter().filter(other).copied().collect()
}

fn systematic_of(cell: &Cell, measured: Measured, options: &IdentifyOptions) -> (Fit, SystematicErrors) {
    let fit = Fit::new(cell, measured, options).unwrap();
    let systematic = systematic_errors(&fit).unwrap();
    (fit, systematic)
}

fn said<'a>(systematic: &'a SystematicErrors, code: &str) -> Vec<&'a str> {
    let of_code = systematic.findings.iter().filter(|f| f.code == code);
    of_code.map(|f| f.sentence.as_str()).collect()
}

/// With the preload no joint is less sure than without, and none owes its ± to lost motion; who measured against one
/// is not told to.
#[test]
fn a_preload_makes_the_stiffness_surer() {
    let cell = default_cell();
    let options = IdentifyOptions::default();
    let (_, with) = systematic_of(&cell, read(&cell, &ALL, 1), &options);
    let (_, plain) = systematic_of(&cell, read(&cell, &without(Role::Preload), 1), &options);
    for (ours, other) in with.uncertainty.iter().zip(&plain.uncertainty) {
        println!("{:.3} with the preload, {:.3} without", ours.total.unwrap(), other.total.unwrap());
        assert!(ours.total.unwrap() <= other.total.unwrap(), "{ours:?} {other:?}");
        assert_ne!(ours.largest_source.as_deref(), Some("lost-motion"));
    }
    // The way to the preload shows what the arm has, and it counts at work; nobody is told to measure against one.
    let sentences: Vec<String> = with.findings.iter().map(|f| format!("{}: {}", f.code, f.sentence)).collect();
    insta::assert_snapshot!(sentences.join("\n"), @"
    force-scale: A force that is read 1.00 % too large (assumed) makes every k 1.00 % too large and shows in no residual.
    size-bounded: The readings bound tilt of the base (1.0e8 N·m/rad): they leave 67.9 % of that.
    size-contradicted: The residuals look like 4.6 times the lost motion (0.10 arc-minutes each joint) that is assumed: declare what the joints have as [uncertainty] lost_motion_arcmin; the preload keeps it out of k, and at work it acts again.
    largest-common-error: Of the systematic errors that the readings leave, force scale (1.00 %) is the largest for joint 1 (0.99 %), joint 3 (0.99 %) and joint 5 (0.99 %): check the force with a known weight and declare what it shows.
    largest-common-error: Of the systematic errors that the readings leave, anchor (5.000 mm an axis) is the largest for joint 6 (2.21 %): measure the anchor with the tracker and declare how well.
    largest-common-error: Of the systematic errors that the readings leave, tilt of the base (1.0e8 N·m/rad) is the largest for joint 2 (3.54 %) and joint 4 (2.69 %): measure a reflector on the base and subtract its motion.
    common-error-dominates: Systematic errors are larger than the scatter of the readings for joint 1, joint 2 and joint 3. Largest for most: force scale (1.00 %); check the force with a known weight and declare what it shows.
    assumed-uncertainty: Assumed, not declared in [uncertainty]: force scale (1.00 %), anchor (5.000 mm an axis), loading point (1.000 mm an axis), registration (0.50 mrad an axis), tilt of the base (1.0e8 N·m/rad) and lost motion (0.10 arc-minutes each joint).
    ");
    // Where nothing was read unloaded nothing shows it.
    let (_, alone) = systematic_of(&cell, read(&cell, &without(Role::Unloaded), 1), &options);
    assert_eq!(said(&alone, "lost-motion-not-seen").len(), 1, "{:?}", alone.findings);
    assert!(said(&with, "lost-motion-not-seen").is_empty());
    assert!(said(&plain, "lost-motion-not-seen").is_empty());
}

/// The mixed model learns of the gaps from the same ways, and its predictor has them.
#[test]
fn the_mixed_model_knows_the_gaps_by_the_preload() {
    let cell = default_cell();
    let fit = Fit::new(&cell, read(&cell, &ALL, 2), &IdentifyOptions::default()).unwrap();
    let mixed = MixedFit::new(&fit).unwrap();
    let of_gaps = |systematic: &SystematicErrors| {
        let source = systematic.sources.iter().find(|s| s.name == "lost-motion");
        source.unwrap().remaining.unwrap()
    };
    let plain = of_gaps(&systematic_errors(&fit).unwrap());
    let by_mixed = of_gaps(&mixed_systematic_errors(&mixed).unwrap());
    assert!(plain > 3.0 && (by_mixed / plain - 1.0).abs() < 0.2, "{by_mixed} {plain}");
}

/// Intervals of k and bands at work hold of an arm whose gaps are five times what is assumed.
#[test]
fn intervals_and_bands_at_work_hold_with_a_preload() {
    let cell = default_cell();
    let truth = cell.require_prior().unwrap();
    let arm = LoadedArm::from_stiffness(&cell, truth).unwrap();
    let work = work_near_tasks(&cell, &mut Dice::new(5));
    let mut predicting = PredictOptions::default();
    predicting.model = Model::Linear;
    let count = runs(100);
    let (mut joints, mut shifts, mut largest) = (0, 0, 0.0_f64);
    for seed in 0..count {
        let (fit, systematic) = systematic_of(&cell, read(&cell, &ALL, seed), &IdentifyOptions::default());
        for (joint, k) in systematic.uncertainty.iter().zip(truth) {
            let [low, high] = joint.interval_nm_per_rad;
            joints += u64::from(low.unwrap() <= *k && high.is_none_or(|high| *k <= high));
        }
        let predictor = fit.compliance().unwrap();
        let prediction = predict(&cell, &predictor, &work, &predicting, Control::default()).unwrap();
        for (point, at) in prediction.points.iter().zip(&work) {
            let terms = arm.terms(&at.q, &at.wrench).unwrap();
            let mut exact: Vector3<f64> = arm.linear(&terms).fixed_rows::<3>(0).into_owned();
            for (j, gap) in GAPS.iter().enumerate() {
                exact += ExtraTerm::LostMotion(j).column(&terms) * *gap;
            }
            let band = point.band.as_ref().unwrap();
            for i in 0..3 {
                let off = (point.shift_m[i] - exact[i]).abs();
                largest = largest.max(off / band.total_m[i]);
                shifts += u64::from(off <= band.total_m[i]);
            }
        }
    }
    let [joints, shifts] = [(joints, 6), (shifts, 18)].map(|(n, of)| n as f64 / (count * of) as f64);
    println!("k {joints:.3}, bands {shifts:.3}, {largest:.2} times the band at most");
    let least = fewest(0.95, count, 1000) as f64 / count as f64;
    assert!(joints > least && joints >= 0.93, "{joints}");
    assert!(shifts >= 0.93, "{shifts}");
}

/// As unknowns the gaps are what the way from no load to the preload shows; without it there is none.
#[test]
fn lost_motion_as_an_unknown_is_found_by_the_way_to_the_preload() {
    let cell = default_cell();
    let mut options = IdentifyOptions::default();
    options.extra = (0..6).map(ExtraTerm::LostMotion).collect();
    let (mut inside, count) = (0, runs(100));
    for seed in 0..count {
        let fit = Fit::new(&cell, read(&cell, &ALL, seed), &options).unwrap();
        // The same from a fit without them.
        if seed == 0 {
            let plain = Fit::new(&cell, read(&cell, &ALL, seed), &IdentifyOptions::default()).unwrap();
            let again = plain.with(&options).unwrap();
            let values = |fit: &Fit| fit.identification().unwrap().estimates.clone();
            assert_eq!(values(&again).lost_motion, values(&fit).lost_motion);
            let back = again.with(&IdentifyOptions::default()).unwrap();
            assert_eq!(values(&back).joints, values(&plain).joints);
        }
        let estimates = &fit.identification().unwrap().estimates;
        for (joint, gap) in estimates.lost_motion.iter().zip(&GAPS) {
            let (angle, [low, high]) = (joint.angle.unwrap(), joint.interval.map(Option::unwrap));
            inside += u64::from(low <= *gap && *gap <= high);
            assert!((angle - gap).abs() < 5.0 * joint.standard_error.unwrap(), "{joint:?}");
        }
    }
    let share = inside as f64 / (6 * count) as f64;
    println!("{share:.3}");
    assert!(share >= 0.93, "{share}");
    let alone = Fit::new(&cell, read(&cell, &without(Role::Unloaded), 1), &options);
    let error = alone.map(|_| ()).unwrap_err();
    assert_eq!(error.code(), Code::Conflict, "{error}");
}

/// A preload that pulls the other way leaves the joint on the other side: the load turns it through all of its gap.
#[test]
fn a_preload_the_other_way_counts_twice() {
    let cell = default_cell();
    let posture = numbered(group1()).swap_remove(0);
    let terms = PostureTerms::new(&cell.setup, &posture.q, None).unwrap();
    let column = |preload: Option<f64>| {
        let mut state = MeasuredPosture::new(posture.clone(), Vec::new());
        state.preload = preload.map(|size| Wrench::force(terms.wrench().force * size));
        let terms = state.terms(&cell.setup, None).unwrap();
        ExtraTerm::LostMotion(1).column(&terms)
    };
    let plain = column(None);
    assert_eq!(plain, ExtraTerm::LostMotion(1).column(&terms));
    assert_eq!(column(Some(0.2)).norm(), 0.0);
    assert_eq!(column(Some(-0.2)), &plain * 2.0);
    // The loaded state is against it: what is left of the load turns the same way.
    assert_eq!(column(Some(-2.0)).norm(), 0.0);
}

/// An arm without gaps that tilts by a tenth of what its joints turn is not taken for a worn one.
#[test]
fn give_beyond_the_axes_is_no_lost_motion() {
    let cell = default_cell();
    let truth = cell.require_prior().unwrap();
    let count = runs(60);
    let (mut alarms, mut largest) = (0, 0.0_f64);
    for seed in 0..count {
        let done = Experiment {
            base_from_tracker: tracker_pose(),
            states: states(&ALL),
            force: ForceRecord::Load,
            tracker_noise: TrackerNoise::Isotropic,
            joint_tilt: Some(truth.iter().map(|k| 0.1 / k).collect()),
            ..Experiment::default()
        };
        let table = experiment(&cell, &numbered(group1()), truth, &done, seed, 0).unwrap();
        let measured = prepare(&cell, table, &given(tracker_pose())).unwrap();
        let (_, systematic) = systematic_of(&cell, measured, &IdentifyOptions::default());
        let seen = said(&systematic, "size-contradicted");
        alarms += u64::from(seen.iter().any(|s| s.contains("lost motion")));
        let source = systematic.sources.iter().find(|s| s.name == "lost-motion");
        largest = largest.max(source.unwrap().remaining.unwrap());
    }
    println!("{alarms} of {count}, at most {largest:.2} of the size");
    assert!(alarms <= most(0.05, count, 1000), "{alarms} of {count}");
}
