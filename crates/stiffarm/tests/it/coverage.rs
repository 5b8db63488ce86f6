//! Intervals cover as often as they say, in runs small enough for every day, and as the table that the library embeds
//! says.
//!
//! Seeds are fixed, so a failure is a change in behaviour and not bad luck.

#[path = "../../examples/coverage/page.rs"]
mod page;

use crate::common::cases::refusals;
use crate::common::prelude::*;
use crate::common::random_group;
use crate::common::runs::{fewest, wider};
use stiffarm::estimate::coverage::{
    Coverage, CoverageCase, ErrorModel, Intervals, Outliers, Record, Truth, coverage, measured, records,
};
use stiffarm::estimate::simulate::ModelErrors;
use stiffarm::model::measurement::ReadingScatter;
use stiffarm::plan::select::random_group as draw_group;

/// The reference cell with `points` measuring points and two readings for a displacement.
fn cell(points: usize) -> Cell {
    changed(reference_cell(), |o| {
        o.setup.tool.measuring_points.truncate(points);
        o.noise.readings_per_displacement = 2;
    })
}

fn postures(count: usize) -> Vec<Posture> {
    let angles = draw_group(&reference_cell(), StartKind::Uniform, count, 5, 0).unwrap();
    numbered(angles)
}

fn case(estimator: Estimator, experiments: usize) -> CoverageCase {
    CoverageCase { options: by(estimator), world: ErrorModel::default(), resamples: None, experiments, seed: 11 }
}

fn count(cell: &Cell, postures: &[Posture], case: &CoverageCase) -> Coverage {
    coverage(cell, postures, case, Control::default()).unwrap()
}

/// Every joint and all joints together within so many standard errors of 95 %.
fn assert_exact(counted: &Coverage, what: &str) {
    let z = (counted.coverage - 0.95) / counted.standard_error;
    println!("{what}: {:.2} %, z = {z:.2}", 100.0 * counted.coverage);
    assert!(z.abs() < 4.0, "{what}: {} (z = {z})", counted.coverage);
    let single = (0.95 * 0.05 / counted.experiments as f64).sqrt();
    for joint in &counted.joints {
        let z = (joint.coverage - 0.95) / single;
        assert!(z.abs() < 4.5, "{what}, {}: {}", joint.name, joint.coverage);
    }
    // The joints of an experiment share its estimated noise.
    assert!(counted.standard_error > 0.99 * single / 6f64.sqrt() && counted.standard_error < single);
}

#[test]
fn exact_intervals_cover_at_3_6_12_and_66_degrees_of_freedom() {
    let experiments = runs(2_000) as usize;
    for (number, points, dof) in [(3, 1, 3), (4, 1, 6), (6, 1, 12), (6, 4, 66)] {
        let (cell, postures) = (cell(points), postures(number));
        let ordinary = case(Estimator::Ordinary, experiments);
        let counted = count(&cell, &postures, &ordinary);
        assert_eq!(counted.degrees_of_freedom, Some(dof));
        assert_exact(&counted, &format!("ordinary, {dof}"));

        let mut known_noise = ordinary.clone();
        known_noise.options.noise = NoiseSource::Known;
        let counted = count(&cell, &postures, &known_noise);
        assert_eq!(counted.degrees_of_freedom, None);
        assert_exact(&counted, &format!("stated, {dof}"));

        let mut repeats = ordinary.clone();
        repeats.options.noise = NoiseSource::Repeats;
        repeats.options.scatter =
            Some(ReadingScatter { reading_std_m: cell.noise.reading_variance.sqrt(), degrees_of_freedom: dof });
        let counted = count(&cell, &postures, &repeats);
        assert_eq!(counted.degrees_of_freedom, Some(dof));
        assert_exact(&counted, &format!("repeats, {dof}"));

        // The cell knows of a shift, and three loads share an unloaded reading.
        let mut weighted = case(Estimator::Weighted, experiments);
        weighted.world.common_ratio = 1.0;
        let mut informed = cell.clone();
        informed.noise.posture_common_std = informed.noise.displacement_std();
        assert_exact(&count(&informed, &postures, &weighted), &format!("weighted, {dof}"));
        weighted.options.noise = NoiseSource::Known;
        assert_exact(&count(&informed, &postures, &weighted), &format!("weighted and stated, {dof}"));
        let mut three = case(Estimator::Weighted, experiments);
        three.world.load_states = vec![0.4, 1.0, -0.7];
        assert_exact(&count(&cell, &postures, &three), &format!("three loads, {dof}"));
    }
}

#[test]
fn the_two_variance_model_covers_whatever_the_shift() {
    for number in [6, 12] {
        let postures = postures(number);
        for common_ratio in [0.0, 1.0, 3.0] {
            for load_states in [vec![1.0], vec![1.0 / 3.0, 2.0 / 3.0, 1.0]] {
                let mut case = case(Estimator::TwoVariance, runs(400) as usize);
                case.world.common_ratio = common_ratio;
                case.world.load_states = load_states;
                let counted = count(&cell(4), &postures, &case);
                assert_eq!(counted.degrees_of_freedom, Some(3 * number - 6));
                println!(
                    "{number} postures, τ/σ = {common_ratio}: {:.2} ± {:.2} %",
                    100.0 * counted.coverage,
                    100.0 * counted.standard_error
                );
                assert!(
                    counted.coverage > 0.94 - 3.0 * counted.standard_error,
                    "{number} postures, τ/σ = {common_ratio}: {}",
                    counted.coverage
                );
                // Careful, but not by any width.
                let slack = slack(counted.standard_error, runs(400), 4000);
                assert!(counted.coverage < 0.985 + slack, "{}", counted.coverage);
            }
        }
    }
}

#[test]
fn what_the_model_leaves_out_is_missed() {
    let postures = postures(6);
    let experiments = runs(100) as usize;
    let mut shifted = case(Estimator::Ordinary, experiments);
    shifted.world.common_ratio = 3.0;
    let ignored = count(&cell(4), &postures, &shifted);
    assert!(ignored.coverage < 0.75, "{}", ignored.coverage);
    let mut lost = case(Estimator::Ordinary, experiments);
    lost.world.lost_motion_rad = 3e-4;
    assert!(count(&cell(4), &postures, &lost).coverage < 0.5);
    let mut scale = case(Estimator::Ordinary, experiments);
    scale.world.model_errors = ModelErrors { force_scale: 0.2, ..ModelErrors::default() };
    assert!(count(&cell(4), &postures, &scale).coverage < 0.5);
    // Gross errors spoil least squares by wide intervals, and Huber's less.
    let mut gross = case(Estimator::Ordinary, experiments);
    gross.world.outliers = Some(Outliers { share: 0.05, size: 30.0 });
    let wide = count(&cell(4), &postures, &gross);
    gross.options.estimator = Estimator::Huber;
    let robust = count(&cell(4), &postures, &gross);
    let width = |c: &Coverage| c.relative_half_width.unwrap();
    assert!(width(&robust) < 0.5 * width(&wide));
    let slack = slack(robust.standard_error, runs(100), 1000);
    assert!(robust.coverage > 0.92 - slack, "{}", robust.coverage);
}

#[test]
fn the_prior_helps_where_it_is_true_and_harms_where_not() {
    let postures = postures(6);
    let experiments = runs(200) as usize;
    let mut noisy = cell(4);
    noisy.noise.reading_variance *= 100.0;
    let with = |truth| {
        let mut case = case(Estimator::Prior, experiments);
        case.world.truth = truth;
        count(&noisy, &postures, &case)
    };
    let (drawn, off) = (with(Truth::Drawn), with(Truth::Off(2.0)));
    let slack = |counted: &Coverage| slack(counted.standard_error, runs(200), 2000);
    assert!(drawn.coverage > 0.94 - slack(&drawn), "{}", drawn.coverage);
    assert!(
        off.coverage < drawn.coverage - 0.02 + slack(&off).max(slack(&drawn)),
        "{} {}",
        off.coverage,
        drawn.coverage
    );
    let free = count(&noisy, &postures, &case(Estimator::TwoVariance, experiments));
    assert!(drawn.relative_half_width < free.relative_half_width);
}

#[test]
fn tracker_weights_cover_under_the_trackers_noise() {
    let mut cell = cell(4);
    cell.tracker.accuracy = Some(TrackerAccuracy {
        station: Vector3::new(2.0, -4.0, 1.5),
        range: 2e-6,
        range_per_metre: 0.5e-6,
        angle: 1e-5,
    });
    let mut case = case(Estimator::Weighted, runs(2_000) as usize);
    case.world.tracker_errors = true;
    case.options.weights = Weights::Tracker;
    let weighted = count(&cell, &postures(6), &case);
    assert_exact(&weighted, "tracker");
    case.options.weights = Weights::Readings;
    let plain = count(&cell, &postures(6), &case);
    assert!(weighted.relative_half_width < plain.relative_half_width);
}

#[test]
fn a_bootstrap_is_counted_like_the_others() {
    let mut case = case(Estimator::Ordinary, runs(20) as usize);
    case.resamples = Some(200);
    case.world.common_ratio = 1.0;
    let counted = count(&cell(4), &postures(12), &case);
    assert_eq!(counted.degrees_of_freedom, Some(30));
    // Between the half that no interval could miss and what it cannot exceed.
    let slack = slack(counted.standard_error, runs(20), 60);
    assert!((0.75 - slack..0.99 + slack).contains(&counted.coverage), "{}", counted.coverage);
    case.resamples = Some(10);
    let few = coverage(&cell(4), &postures(12), &case, Control::default()).unwrap_err();
    assert_eq!(few.code(), Code::InvalidValue);
}

#[test]
fn counts_do_not_depend_on_threads_or_on_later_experiments() {
    let postures = postures(6);
    let mut plain = case(Estimator::TwoVariance, 1100);
    plain.world.common_ratio = 1.0;
    let mut bootstrap = case(Estimator::Ordinary, 12);
    bootstrap.resamples = Some(200);
    let with = |threads: usize, case: &CoverageCase| {
        let counted = on_threads(threads, || count(&cell(4), &postures, case));
        serde_json::to_string(&counted).unwrap()
    };
    for case in [&plain, &bootstrap] {
        let one = with(1, case);
        assert_eq!(one, with(3, case));
        let other = CoverageCase { seed: 12, ..case.clone() };
        assert_ne!(one, with(1, &other));
    }
    // Counts of more experiments contain those of fewer.
    let held = |experiments| {
        let case = CoverageCase { experiments, ..plain.clone() };
        let counted = count(&cell(4), &postures, &case);
        (counted.joints[0].coverage * experiments as f64).round() as i64
    };
    let (first, both) = (held(250), held(251));
    assert!((0..=1).contains(&(both - first)));
}

#[test]
fn cases_that_make_no_sense_are_refused() {
    let cell = cell(4);
    let six = numbered(random_group());
    let good = case(Estimator::Ordinary, 10);
    let stop = || true;
    let of =
        |cell: &Cell, postures: &[Posture], case: &CoverageCase| coverage(cell, postures, case, Control::default());
    let with = |change: fn(&mut CoverageCase)| of(&cell, &six, &changed(good.clone(), change));
    // One posture with one point has three rows: the joints are named.
    let mut single = cell.clone();
    single.setup.tool.measuring_points.truncate(1);
    let blank = Cell { prior: None, ..cell.clone() };
    let rows = [
        ("no experiment", Code::InvalidValue, with(|c| c.experiments = 0)),
        ("no load", Code::InvalidValue, with(|c| c.world.load_states.clear())),
        ("a load of nothing", Code::InvalidValue, with(|c| c.world.load_states = vec![1.0, 0.0])),
        ("a shift that is no number", Code::InvalidValue, with(|c| c.world.common_ratio = f64::NAN)),
        ("negative lost motion", Code::InvalidValue, with(|c| c.world.lost_motion_rad = -1.0)),
        ("joints without stiffness", Code::InvalidValue, with(|c| c.world.stiffness_factors = vec![0.0; 6])),
        ("a factor of one joint of six", Code::Dimension, with(|c| c.world.stiffness_factors = vec![1.0])),
        ("a drawn truth without a prior in the fit", Code::Conflict, with(|c| c.world.truth = Truth::Drawn)),
        ("errors of no tracker", Code::MissingKey, with(|c| c.world.tracker_errors = true)),
        ("repeats of none", Code::TooFewData, with(|c| c.options.noise = NoiseSource::Repeats)),
        (
            "model errors in load states",
            Code::Conflict,
            with(|c| {
                c.world.load_states = vec![0.5, 1.0];
                c.world.model_errors.force_scale = 0.01;
            }),
        ),
        ("three rows", Code::NotIdentifiable, of(&single, &six[..1], &good)),
        ("a cell without prior", Code::MissingKey, of(&blank, &six, &good)),
        ("a stop at once", Code::Interrupted, coverage(&cell, &six, &good, stopped_by(&stop))),
    ];
    insta::assert_snapshot!("coverage_refusals", refusals(rows));
}

#[test]
fn the_page_shows_the_embedded_table() {
    let page = include_str!("../../../../docs/coverage.md");
    assert_eq!(page::page(records()), page, "run: cargo run --release -p stiffarm --example coverage");
}

#[test]
fn the_table_holds_what_is_promised() {
    let of = |table: &str| -> Vec<&Record> { records().iter().filter(|r| r.table == table).collect() };
    let exact = of(page::EXACT);
    for dof in [3, 6, 12, 66] {
        let rows = exact.iter().filter(|r| r.degrees_of_freedom == Some(dof));
        assert!(rows.count() >= 3, "{dof}");
    }
    for r in exact {
        assert!(r.experiments >= 50_000);
        assert!((r.coverage - 0.95).abs() <= 0.005, "{}: {}", r.situation, r.coverage);
    }
    let two = of(page::TWO_VARIANCE);
    for r in &two {
        assert!(r.experiments >= 50_000);
        assert!(r.coverage >= 0.94, "{}: {}", r.situation, r.coverage);
    }
    for (number, ratio) in [(6, 0), (6, 1), (6, 3), (12, 0), (12, 1), (12, 3)] {
        let ends = format!("τ/σ = {ratio}");
        let rows = two.iter().filter(|r| r.postures == number && r.situation.ends_with(&ends));
        assert!(rows.count() >= 2, "{number} {ratio}");
    }
}

#[test]
fn the_nearest_row_not_above_speaks_and_none_below_the_table() {
    for intervals in [Intervals::Huber, Intervals::NonNegative, Intervals::Prior, Intervals::Bootstrap] {
        let rows: Vec<&Record> = records().iter().filter(|r| r.intervals == Some(intervals) && !r.adverse).collect();
        let mut degrees: Vec<usize> = rows.iter().filter_map(|r| r.degrees_of_freedom).collect();
        degrees.sort_unstable();
        assert!(degrees.len() >= 2 && degrees.len() == rows.len(), "{intervals:?}");
        let smallest = degrees[0];
        assert!(measured(intervals, 0).is_none());
        assert!(measured(intervals, smallest - 1).is_none());
        for pair in degrees.windows(2) {
            assert!(pair[0] < pair[1], "one row for each number of degrees");
            for dof in [pair[0], pair[1] - 1] {
                let nearest = measured(intervals, dof).unwrap();
                assert_eq!(nearest.degrees_of_freedom, pair[0]);
                let row = rows.iter().find(|r| r.degrees_of_freedom == Some(pair[0])).unwrap();
                assert_eq!(
                    (nearest.coverage, nearest.standard_error, nearest.experiments),
                    (row.coverage, row.standard_error, row.experiments)
                );
                assert!(!nearest.adverse.is_empty());
            }
        }
        let far = measured(intervals, 10_000).unwrap();
        assert_eq!(far.degrees_of_freedom, *degrees.last().unwrap());
    }
    for estimator in Estimator::ALL {
        assert_eq!(Intervals::of(estimator).is_none(), estimator.is_exact());
    }
}

#[test]
fn one_experiment_is_no_certainty() {
    let cell = cell(4);
    // Agresti and Coull: of five experiments three are as found.
    let counted = count(&cell, &postures(8), &case(Estimator::Ordinary, 1));
    let expected = (0.6 * 0.4 / 5.0_f64).sqrt();
    assert!((counted.standard_error / expected - 1.0).abs() < 1e-12);
}

#[test]
fn limits_follow_from_the_count() {
    assert_eq!(most(0.01, 300, 300), 3);
    assert_eq!(fewest(0.99, 300, 300), 297);
    // P(more than 3 of 30) at 1 % is 2e-4, P(more than 2) is 3e-3.
    assert_eq!(most(0.01, 30, 300), 3);
    assert_eq!(fewest(0.99, 30, 300), 27);
    assert!((standard_error(0.5, 100) - 0.05).abs() < 1e-15);
    assert_eq!(wider(50, 200), 2.0);
    assert_eq!(wider(400, 200), 1.0);
    assert_eq!(slack(0.05, 30, 30), 0.0);
    assert!((slack(0.05, 29, 30) - 0.2).abs() < 1e-15);
}
