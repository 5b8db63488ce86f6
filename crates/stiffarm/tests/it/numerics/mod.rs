//! Mathematics that knows nothing of robots is right, repeats, and stops when it is told.

mod arrangements;
mod information;
mod small;
mod svd;

use crate::common::prelude::*;
use rand::RngExt;
use statrs::distribution::{ContinuousCDF, Normal};
use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};
use stiffarm::internals::half_width::Level;
use stiffarm::internals::jobs::{as_far_as, in_order_watched, spread};
use stiffarm::internals::nelder_mead::nelder_mead;
use stiffarm::internals::scalar::{minimum, zero};
use stiffarm::internals::streams::{group_rng, run_rng};

#[test]
fn the_half_width_holds_its_share() {
    let normal = Normal::new(0.0, 1.0).unwrap();
    for confidence in [0.3, 0.5, 0.95, 0.999] {
        let level = Level::new(confidence).unwrap();
        for mean in [0.0, 1e-9, 0.1, 1.0, 3.0, 50.0] {
            let w = level.half_width(-2.0 * mean, 2.0) / 2.0;
            let held = normal.cdf(w - mean) - normal.cdf(-w - mean);
            assert!((held - confidence).abs() < 1e-9, "{confidence} {mean}");
        }
        assert_eq!(level.half_width(0.0, 3.0), 3.0 * level.quantile());
        assert_eq!(level.half_width(-4.0, 0.0), 4.0);
    }
    assert!(Level::new(1.0).is_err());
}

#[test]
fn a_spread_order_has_every_number_once() {
    for count in [0, 1, 2, 63, 64, 65, 1000] {
        let mut order = spread(count);
        order.sort_unstable();
        assert!(order.into_iter().eq(0..count), "{count}");
    }
}

#[test]
fn what_was_done_before_a_stop_stays() {
    let jobs: Vec<usize> = (0..500).collect();
    let polls = AtomicUsize::new(0);
    let stop = || polls.fetch_add(1, Ordering::Relaxed) > 100;
    let control = Control { stop: Some(&stop), progress: None };
    let sums = as_far_as(&jobs, "", control, |(i, job)| Ok(i + job)).unwrap();
    let done = sums.iter().flatten().count();
    assert!((1..500).contains(&done), "{done}");
    let mut values = sums.iter().enumerate();
    assert!(values.all(|(i, value)| value.is_none_or(|v| v == 2 * i)));
    let error = in_order_watched(&jobs, "", control, |(i, _)| Ok(i)).unwrap_err();
    assert_eq!(error.code(), Code::Interrupted);
}

#[test]
fn the_valley_of_rosenbrock() {
    let (x, value) = nelder_mead(|[x, y]| (1.0 - x).powi(2) + 100.0 * (y - x * x).powi(2), [-1.2, 1.0], 0.5, 2000);
    assert!(value < 1e-12, "{value:e}");
    assert!((x[0] - 1.0).abs() < 1e-5 && (x[1] - 1.0).abs() < 1e-5);
}

#[test]
fn what_is_not_a_number_is_avoided() {
    let (x, _) = nelder_mead(|[x]| (x - 2.0).abs() + (x - 1.0).sqrt() * 0.0, [3.0], 0.5, 500);
    assert!((x[0] - 2.0).abs() < 1e-6);
}

/// A function, the ends of an interval, and the place looked for.
type Case = (fn(f64) -> f64, [f64; 2], f64);

#[test]
fn minima_are_found_in_few_steps() {
    let count = Cell::new(0);
    let counted = |f: fn(f64) -> f64| {
        let count = &count;
        move |x: f64| {
            count.set(count.get() + 1);
            f(x)
        }
    };
    let cases: [Case; 3] = [
        (|x| (x - 0.3).powi(2) + 2.0, [-1.0, 1.0], 0.3),
        (|x| x.cosh() + 0.5 * x, [-2.0, 2.0], -(0.5_f64.asinh())),
        (|x| (1.0 + x * x).ln() - 0.1 * x, [-2.0, 2.0], 0.050_125_629),
    ];
    for (f, ends, place) in cases {
        count.set(0);
        let middle = 0.1;
        let (x, value) = minimum(counted(f), ends, (middle, f(middle)), 1e-7);
        assert!((x - place).abs() < 2e-7, "{x} {place}");
        assert_eq!(value, f(x));
        assert!(count.get() < 20, "{}", count.get());
    }
    // At an end of the interval.
    let (x, _) = minimum(|x| x, [0.0, 1.0], (0.5, 0.5), 1e-7);
    assert!(x < 1e-6);
}

#[test]
fn zeros_are_found_in_few_steps() {
    let cases: [Case; 3] = [
        (|x| x * x - 2.0, [0.0, 2.0], 2f64.sqrt()),
        (|x| x.exp() - 5.0, [0.0, 10.0], 5f64.ln()),
        (|x| (x - 1.0).powi(3), [0.0, 4.0], 1.0),
    ];
    for (f, [a, b], place) in cases {
        let x = zero(f, (a, f(a)), (b, f(b)), 1e-12);
        assert!((x - place).abs() < 1e-9, "{x} {place}");
    }
}

#[test]
fn runs_and_groups_do_not_share_numbers() {
    let first: u64 = run_rng(1, 0, 0, 3).random();
    let group: u64 = group_rng(1, 3).random();
    let again: u64 = run_rng(1, 0, 0, 3).random();
    assert_ne!(first, group);
    assert_eq!(first, again);
}
