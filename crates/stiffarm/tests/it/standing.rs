//! What a running experiment forecasts is what the further postures bring.

use crate::common::prelude::*;
use std::sync::LazyLock;
use stiffarm::ask::identify::{Identified, IdentifiedOptions};
use stiffarm::estimate::forecast::forecast;
use stiffarm::estimate::next_posture::planned_errors;
use stiffarm::estimate::standing::{InterimEstimate, is_better, standing};

fn experiment(count: usize, seed: u64) -> (Cell, Vec<Posture>, Measured) {
    let cell = builtin::cell("comau").unwrap();
    let group = random_group(&cell, StartKind::Uniform, 12, seed, 0).unwrap();
    let postures = numbered(group);
    let truth = cell.prior.clone().unwrap();
    let measured = simulate_measurements(&cell, &postures[..count], &truth, Model::Linear, seed, 0).unwrap();
    (cell, postures, measured.into())
}

fn fitted(count: usize, seed: u64) -> (Fit, Vec<Posture>) {
    let (cell, postures, measured) = experiment(count, seed);
    let fit = Fit::new(&cell, measured, &IdentifyOptions::default()).unwrap();
    (fit, postures)
}

#[test]
fn planned_postures_bring_what_the_information_says() {
    for seed in 0..4 {
        let (early, plan) = fitted(5, seed);
        let (late, _) = fitted(12, seed);
        let forecast = planned_errors(&early, &plan[5..]).unwrap();
        assert_eq!(forecast.after.len(), 7);
        for after in &forecast.after {
            for (now, then) in forecast.now.iter().zip(after) {
                assert!(then.unwrap() <= now.unwrap() * (1.0 + 1e-9));
            }
        }
        // Measured as linear as the plan says, the standard errors are those, but for the scatter's own.
        let really = planned_errors::<Vec<f64>>(&late, &[]).unwrap().now;
        let ratios: Vec<f64> = forecast.after[6]
            .iter()
            .zip(&really)
            .map(|(expected, actual)| expected.unwrap() / actual.unwrap())
            .collect();
        let first = ratios[0];
        for ratio in &ratios {
            // One factor for all joints: the scatter that each fit finds.
            assert!((ratio / first - 1.0).abs() < 0.25, "{ratios:?}");
        }
        assert!((0.5..2.0).contains(&first), "{ratios:?}");
    }
}

#[test]
fn a_goal_is_reached_ahead_or_out_of_reach() {
    let (fit, plan) = fitted(6, 1);
    let so_far = InterimEstimate::new(&fit).unwrap();
    let at = |goal: f64| standing(&so_far, &plan[6..], Some(goal)).unwrap();
    let now = at(0.99);
    let largest = now.largest.unwrap();
    assert_eq!((now.reached, now.postures_to_goal), (Some(true), None));
    assert_eq!(at(largest * 1.0001).reached, Some(true));
    assert_eq!(at(largest * 0.9999).reached, Some(false));
    // A force known to 1 % leaves 2 % of every stiffness, whatever is measured.
    let far = at(0.019);
    assert_eq!((far.reached, far.postures_to_goal), (Some(false), None));
    assert_eq!(far.findings[0].code, "goal-out-of-reach");
    assert!(at(0.021).findings.is_empty());
    // Without a goal nothing is said of one.
    let plain = standing(&so_far, &plan[6..], None).unwrap();
    assert_eq!((plain.reached, plain.findings.len()), (None, 0));
    for joint in &plain.joints {
        assert!(joint.with_all <= joint.with_next && joint.with_next <= joint.total);
        assert!(joint.systematic <= joint.total);
    }
    // Nothing left: nothing expected.
    let last = standing::<Vec<f64>>(&so_far, &[], None).unwrap();
    assert!(last.joints.iter().all(|joint| joint.with_next.is_none()));
}

#[test]
fn a_far_better_posture_is_worth_naming_and_an_equal_one_is_not() {
    let (fit, _) = fitted(5, 2);
    let options = rounds(1);
    let best = next_posture(&fit, &options, Control::default()).unwrap();
    // The best itself as the planned one: no reason to leave the plan.
    let same = planned_errors(&fit, std::slice::from_ref(&best.angles)).unwrap();
    assert!(!is_better(&best, &same));
    // One that is measured already shows hardly anything new.
    let poor = planned_errors(&fit, &[vec![0.0, 0.0, -1.5, 0.0, 0.01, 0.0]]).unwrap();
    assert!(is_better(&best, &poor));
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// ± of each joint with all errors that `identify` prints.
fn identified(fit: &Fit) -> Vec<Option<f64>> {
    let fitted = Identified::new(fit, &IdentifiedOptions::default(), Control::default()).unwrap();
    let systematic = fitted.systematic_errors.unwrap();
    systematic.uncertainty.iter().map(|joint| joint.total).collect()
}

/// What `identify` prints of twelve postures, for each seed.
static OF_TWELVE: LazyLock<Vec<Vec<Option<f64>>>> =
    LazyLock::new(|| (0..12).map(|seed| identified(&fitted(12, seed).0)).collect());

#[test]
fn it_stands_as_identify_says_and_three_postures_reach_no_goal() {
    for count in [3, 4, 7] {
        let (fit, plan) = fitted(count, 3);
        let so_far = InterimEstimate::new(&fit).unwrap();
        let now = standing(&so_far, &plan[count..], Some(0.99)).unwrap();
        let totals: Vec<Option<f64>> = now.joints.iter().map(|joint| joint.total).collect();
        assert_eq!(totals, identified(&fit), "{count}");
        // Four postures are the fewest that show what gives way beyond the axes.
        let missing = (count < 4).then_some(4 - count.min(4));
        assert_eq!((now.reached, now.postures_to_goal), (Some(count >= 4), missing));
        let named = now.findings.iter().any(|f| f.code == "too-few-postures");
        assert_eq!(named, count < 4);
        // Where no posture is left, the goal is judged by what there is.
        let last = standing::<Vec<f64>>(&so_far, &[], Some(0.99)).unwrap();
        assert_eq!(last.reached, Some(true));
    }
}

#[test]
fn the_first_postures_foresee_what_the_whole_plan_will_say() {
    for done in [1, 3, 6] {
        let mut ratios = Vec::new();
        for (seed, really) in (0..8).zip(OF_TWELVE.iter()) {
            let (early, plan) = fitted(done, seed);
            let so_far = InterimEstimate::new(&early).unwrap();
            let forecast = standing(&so_far, &plan[done..], None).unwrap();
            for (joint, really) in forecast.joints.iter().zip(really) {
                ratios.push(joint.with_all.unwrap() / really.unwrap());
            }
        }
        let (least, most) = ratios.iter().fold((f64::MAX, 0.0_f64), |(a, b), r| (a.min(*r), b.max(*r)));
        let middle = median(ratios);
        assert!((0.8..1.25).contains(&middle), "{done}: {middle}");
        assert!(least > 0.3 && most < 3.0, "{done}: {least} to {most}");
    }
}

#[test]
fn a_plan_promises_what_identify_prints_of_it() {
    let mut ratios = Vec::new();
    for (seed, really) in (0..).zip(OF_TWELVE.iter()) {
        let (fit, plan) = fitted(12, seed);
        let promised = forecast(fit.cell(), &plan).unwrap();
        for (total, really) in promised.total.iter().zip(really) {
            ratios.push(total.unwrap() / really.unwrap());
        }
        // Systematic errors are most of it, and noise alone says far less.
        let joint_1 = promised.total[0].unwrap();
        assert!(joint_1 > 1.5 * promised.readings[0].unwrap() && joint_1 > 0.0196);
    }
    let middle = median(ratios);
    assert!((0.8..1.25).contains(&middle), "{middle}");
}

#[test]
fn nothing_is_promised_without_a_load_or_a_prior() {
    let (fit, plan) = fitted(6, 1);
    let mut cell = fit.cell().clone();
    cell.setup.load = Load::Measured;
    assert!(forecast(&cell, &plan).is_err());
    let mut cell = fit.cell().clone();
    cell.prior = None;
    assert!(forecast(&cell, &plan).is_err());
    // One posture leaves joints open: there is no ± for them, and no error either.
    let promised = forecast(fit.cell(), &plan[..1]).unwrap();
    assert_eq!(promised.total.len(), 6);
}
