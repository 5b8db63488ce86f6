//! What is wrong with point pairs is refused or named, and what is right is not.

use crate::common::prelude::*;
use crate::common::runs::fewest;
use std::fmt::Write;
use stiffarm::measure::registration::{RegisterOptions, Registration, register_with};

/// Noise of each coordinate in either frame \[m\]: a laser tracker at a few metres.
const NOISE: f64 = 2e-5;

/// Five points as one would place them: two metres wide, off any plane \[m\].
const BASE: [[f64; 3]; 5] =
    [[1.45, -0.62, 0.905], [1.71, 0.54, 1.18], [2.28, -0.18, 1.54], [1.88, -0.84, 1.795], [2.42, 0.61, 0.82]];

fn pose() -> Isometry3<f64> {
    Isometry3::new(Vector3::new(4.1, -2.65, 1.32), Vector3::new(0.01, -0.02, 2.05))
}

/// The first `count` of the points in both frames, with noise.
fn pairs(count: usize, seed: u64) -> Vec<PointPair> {
    noisy(&BASE.map(Vector3::from)[..count], &pose(), &mut Dice::new(seed))
}

fn noisy(base: &[Vector3<f64>], pose: &Isometry3<f64>, dice: &mut Dice) -> Vec<PointPair> {
    base.iter()
        .enumerate()
        .map(|(i, base)| PointPair {
            name: format!("p{}", i + 1),
            tracker: pose.inverse_transform_point(&(*base).into()).coords + dice.noise(NOISE),
            base: base + dice.noise(NOISE),
        })
        .collect()
}

/// Random points in a box of 1 to 3 m, none near a line with all others.
fn anywhere(dice: &mut Dice, count: usize) -> Vec<PointPair> {
    let half = dice.between(0.5, 1.5);
    let base: Vec<Vector3<f64>> = (0..count).map(|_| dice.vector(half)).collect();
    let pose = dice.pose();
    noisy(&base, &pose, dice)
}

fn swap(pairs: &mut [PointPair], i: usize, j: usize) {
    let tracker = pairs[i].tracker;
    pairs[i].tracker = pairs[j].tracker;
    pairs[j].tracker = tracker;
}

fn codes(registration: &Registration) -> Vec<&str> {
    registration.findings.iter().map(|f| f.code.as_str()).collect()
}

fn with_std(std: f64) -> RegisterOptions {
    with(|o: &mut RegisterOptions| o.std = Some(std))
}

fn report(title: &str, pairs: &[PointPair], options: &RegisterOptions) -> String {
    let mut out = format!("# {title}\n");
    match register_with(pairs, options) {
        Ok(registration) => {
            let _ = writeln!(out, "RMS {:.4} mm", registration.rms * 1e3);
            for f in registration.findings {
                let _ = writeln!(out, "{:?} {} [{}]: {}", f.severity, f.code, f.subject, f.sentence);
            }
        }
        Err(error) => {
            let _ = writeln!(out, "{}: {error}", error.code().as_str());
        }
    }
    out.push('\n');
    out
}

#[test]
fn wrong_sets_are_refused() {
    let free = RegisterOptions::default();
    let good = pairs(5, 1);
    let change = |of: &dyn Fn(usize, &mut PointPair)| {
        changed(good.clone(), |o| o.iter_mut().enumerate().for_each(|(i, p)| of(i, p)))
    };
    let mut out = String::new();
    let mut add = |title: &str, pairs: &[PointPair], options: &RegisterOptions| {
        out += &report(title, pairs, options);
        let error = register_with(pairs, options).unwrap_err();
        assert!(!error.code().is_internal(), "{title}: {error}");
    };
    add("no pairs", &[], &free);
    add("two pairs", &good[..2], &free);
    let on_line = |i: usize| Vector3::new(1.0, 0.2, 0.4) * (0.5 * i as f64);
    let near = |i: usize| on_line(i) + Vector3::new(0.0, 1e-4 * (i % 2) as f64, 0.0);
    type Change<'a> = &'a dyn Fn(usize, &mut PointPair);
    let changes: [(&str, Change<'_>); 10] = [
        ("a name twice", &|i, p| p.name = "abcbd"[i..=i].to_string()),
        ("not a number", &|i, p| {
            if i == 2 {
                p.base.y = f64::NAN;
            }
        }),
        ("on a line in tracker axes", &|i, p| p.tracker = on_line(i)),
        ("on a line in base axes", &|i, p| p.base = near(i)),
        ("all the same point", &|_, p| {
            p.tracker = Vector3::new(3.0, 1.0, 0.1);
        }),
        ("metres for millimetres", &|_, p| p.tracker *= 1e-3),
        ("inches for millimetres", &|_, p| p.base /= 25.4),
        ("another scale", &|_, p| p.base *= 3.2),
        ("mirrored: y reversed", &|_, p| p.tracker.y *= -1.0),
        ("mirrored: base x and y exchanged", &|_, p| {
            p.base.swap_rows(0, 1);
        }),
    ];
    for (title, of) in changes {
        add(title, &change(of), &free);
    }
    let same = pose();
    let parallel = |reverse: fn(&mut Vector3<f64>)| {
        change(&|_, p| {
            p.tracker = same.rotation * p.tracker;
            reverse(&mut p.tracker);
        })
    };
    add("mirrored: parallel frames, z reversed", &parallel(|t| t.z *= -1.0), &free);
    add("mirrored: parallel frames, x and z exchanged", &parallel(|t| t.swap_rows(0, 2)), &free);
    // 3 mm off the line, with errors of 1 mm.
    let mut dice = Dice::new(3);
    let thin: Vec<PointPair> = (0..6)
        .map(|i| PointPair {
            name: format!("p{i}"),
            tracker: on_line(i) + dice.noise(3e-3),
            base: on_line(i) + dice.noise(1e-3),
        })
        .collect();
    add("too near to a line for their errors", &thin, &free);
    let weights = |weights: &[f64]| with(|o: &mut RegisterOptions| o.weights = weights.to_vec());
    add("a weight missing", &good, &weights(&[1.0; 4]));
    let zero = weights(&[1.0, 1.0, 0.0, 1.0, 1.0]);
    add("a weight of zero", &good, &zero);
    add("no standard deviation", &good, &with_std(-1.0));
    insta::assert_snapshot!("registration_refusals", out);
}

#[test]
fn wrong_pairs_are_named() {
    let free = RegisterOptions::default();
    let mut out = String::new();
    let mut add = |title: &str, pairs: &[PointPair], options: &RegisterOptions, expected: &[&str]| {
        out += &report(title, pairs, options);
        assert_eq!(codes(&register_with(pairs, options).unwrap()), expected, "{title}");
    };
    let off = |count: usize, i: usize, mm: f64| {
        let mut pairs = pairs(count, 2);
        pairs[i].tracker += Vector3::new(0.5, -0.7, 0.5) * mm * 1e-3;
        pairs
    };
    let swapped = |count: usize, i: usize, j: usize| {
        let mut pairs = pairs(count, 3);
        swap(&mut pairs, i, j);
        pairs
    };
    add("five pairs", &pairs(5, 1), &free, &[]);
    add("three pairs", &pairs(3, 1), &free, &["few-pairs"]);
    for (words, count, std, expected) in [
        ("five", 5, None, &["outlier"][..]),
        ("four", 4, None, &["outlier"]),
        ("four", 4, Some(3e-5), &["outlier"]),
        ("three", 3, None, &["few-pairs"]),
        ("three", 3, Some(3e-5), &["residuals-exceed-noise", "few-pairs"]),
    ] {
        let note = if std.is_some() { ", noise known" } else { "" };
        let title = format!("{words} pairs, p3 off by 1 mm{note}");
        let options = std.map_or(free.clone(), with_std);
        add(&title, &off(count, 2, 1.0), &options, expected);
    }
    for (words, count, i, j) in [("five", 5, 1, 3), ("four", 4, 0, 2), ("three", 3, 0, 1)] {
        let title = format!("{words} pairs, p{} and p{} swapped", i + 1, j + 1);
        add(&title, &swapped(count, i, j), &free, &["swapped-points"]);
    }
    let mut order = pairs(5, 4);
    let tracker: Vec<Vector3<f64>> = order.iter().map(|p| p.tracker).collect();
    order.iter_mut().enumerate().for_each(|(i, p)| p.tracker = tracker[(i + 1) % 5]);
    add("all labels in another order", &order, &free, &["not-rigid"]);
    let mut long = pairs(5, 5);
    long.iter_mut().for_each(|p| p.base *= 1.0004);
    add("base axes 0.04 % longer", &long, &free, &["scale"]);
    let exceed = ["residuals-exceed-noise"];
    add("noise given too small", &pairs(5, 6), &with_std(5e-6), &exceed);
    let flat = BASE.map(|[x, y, _]| Vector3::new(x, y, 1.0));
    let flat = noisy(&flat, &pose(), &mut Dice::new(7));
    add("points in a plane", &flat, &free, &["hand-unknown"]);
    let thin = [0.0, 1.0, 2.0, 3.0, 4.0].map(|i| Vector3::new(1.0 + 0.5 * i, 0.01 * (i % 2.0), 1.0));
    let thin = noisy(&thin, &pose(), &mut Dice::new(8));
    let unsure = ["uncertain-turn", "hand-unknown"];
    add("points near a line", &thin, &free, &unsure);
    // Whichever corner of a square is off along its diagonal, all four share it.
    let square = [[1.0, 0.4, 1.0], [1.6, 1.0, 1.0], [1.0, 1.6, 1.0], [0.4, 1.0, 1.0]];
    let mut square = noisy(&square.map(Vector3::from), &pose(), &mut Dice::new(10));
    square[2].base += Vector3::new(0.0, 0.0, 2e-3);
    let title = "a square, p3 out of its plane by 2 mm";
    add(title, &square, &with_std(3e-5), &["outlier"]);
    let all = register_with(&square, &with_std(3e-5)).unwrap();
    assert_eq!(all.findings[0].subject, "p1, p2, p3, p4");
    insta::assert_snapshot!("registration_findings", out);
}

#[test]
fn a_symmetric_tool_leaves_two_explanations() {
    // Four reflectors, mirror-symmetric about y = 0: exchanging the two sides
    // is the same as reversing y.
    let tool = [[0.4, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, -0.3, 0.0], [0.1, 0.0, 0.35]];
    let tool = tool.map(Vector3::from);
    let mut swapped = noisy(&tool, &pose(), &mut Dice::new(9));
    swap(&mut swapped, 1, 2);
    let error = register(&swapped).unwrap_err();
    assert_eq!(error.code(), Code::Registration);
    insta::assert_snapshot!("registration_symmetric_tool", error.to_string());
}

#[test]
fn right_pairs_raise_no_alarm() {
    let mut dice = Dice::new(20);
    let mut out = String::new();
    for count in 3..9 {
        let runs = runs(300);
        let (mut outlier, mut serious, mut scale, mut refused) = (0, 0, 0, 0);
        for _ in 0..runs {
            match register(&anywhere(&mut dice, count)) {
                Ok(registration) => {
                    serious += u64::from(registration.is_serious());
                    outlier += u64::from(codes(&registration).contains(&"outlier"));
                    scale += u64::from(codes(&registration).contains(&"scale"));
                }
                Err(_) => refused += 1,
            }
        }
        let _ = writeln!(
            out,
            "{count} pairs: {outlier} outliers, {serious} serious, {scale} scale, {refused} refused of {runs}"
        );
        // The tests are made for 0.1 % and 1 %; standard errors of 3000 runs 0.06 and 0.18 %.
        assert!(outlier <= most(0.018, runs, 3000), "{out}");
        assert!(serious <= most(0.004, runs, 3000), "{out}");
        assert!(scale <= most(0.004, runs, 3000), "{out}");
        assert!(refused <= 1, "{out}");
    }
    println!("{out}");
}

#[test]
fn a_wrong_point_is_found_and_rarely_the_wrong_one_is_named() {
    let mut dice = Dice::new(21);
    let runs = runs(100);
    println!("pairs  off by [mm]  found  named  one of several  named wrongly  refused");
    for (count, has_std) in [(4, false), (4, true), (5, false), (6, false), (8, false)] {
        for mm in [0.1, 0.3, 1.0, 3.0, 30.0] {
            let (mut named, mut several, mut wrong, mut refused) = (0, 0, 0, 0);
            for _ in 0..runs {
                let mut pairs = anywhere(&mut dice, count);
                let at = dice.below(count);
                pairs[at].base += dice.direction() * mm * 1e-3;
                let std = has_std.then_some(NOISE * 2f64.sqrt());
                let options = with(|o: &mut RegisterOptions| o.std = std);
                let Ok(registration) = register_with(&pairs, &options) else {
                    refused += 1;
                    continue;
                };
                let name = &pairs[at].name;
                for f in registration.findings.iter().filter(|f| f.code == "outlier") {
                    let subjects: Vec<&str> = f.subject.split(", ").collect();
                    match subjects.as_slice() {
                        [one] if one == name => named += 1,
                        [_] => wrong += 1,
                        // A list that lacks the wrong one misleads as well.
                        some if some.contains(&name.as_str()) => several += 1,
                        _ => wrong += 1,
                    }
                }
                wrong += u64::from(codes(&registration).contains(&"swapped-points"));
            }
            let share = |n: u64| 100.0 * n as f64 / runs as f64;
            println!(
                "{count}{}  {mm:>8}  {:>5.1} %  {:>5.1} %  {:>5.1} %  {:>5.1} %  {:>5.1} %",
                if has_std { " σ" } else { "  " },
                share(named + several + wrong),
                share(named),
                share(several),
                share(wrong),
                share(refused)
            );
            // Named with at least 99 % of the evidence.
            assert!(wrong <= most(0.01, runs, 1000), "{count} {mm}");
            assert!(refused <= 2);
            if mm >= 1.0 && count >= 5 {
                assert!(named > fewest(0.90, runs, 1000), "{count} {mm}");
            }
        }
    }
}

#[test]
fn two_swapped_points_are_named() {
    let mut dice = Dice::new(22);
    let runs = runs(100);
    println!("pairs  named  something else  refused (mirrored too)");
    for count in 3..8 {
        let (mut named, mut other, mut refused) = (0, 0, 0);
        for _ in 0..runs {
            let mut pairs = anywhere(&mut dice, count);
            let i = dice.below(count);
            let j = (i + 1 + dice.below(count - 1)) % count;
            swap(&mut pairs, i, j);
            match register(&pairs) {
                Ok(registration) => {
                    let subject = format!("p{}, p{}", i.min(j) + 1, i.max(j) + 1);
                    let is = |f: &Finding| f.code == "swapped-points" && f.subject == subject;
                    if registration.findings.iter().any(is) { named += 1 } else { other += 1 }
                }
                Err(_) => refused += 1,
            }
        }
        let share = |n: u64| 100.0 * n as f64 / runs as f64;
        println!("{count}  {:>5.1} %  {:>5.1} %  {:>5.1} %", share(named), share(other), share(refused));
        if count >= 5 {
            assert!(named > fewest(0.99, runs, 1000), "{count}");
        }
    }
}

#[test]
fn a_mirrored_frame_is_refused() {
    let runs = runs(50);
    let mut dice = Dice::new(23);
    for count in 4..8 {
        let mut refused = 0;
        for _ in 0..runs {
            let mut pairs = anywhere(&mut dice, count);
            let axis = dice.below(3);
            pairs.iter_mut().for_each(|p| p.tracker[axis] *= -1.0);
            let error = register(&pairs).err();
            refused += u64::from(error.is_some_and(|e| e.code() == Code::Registration));
        }
        println!("{count} pairs: {refused} of {runs} refused");
        let share = if count == 4 { 0.96 } else { 0.996 };
        assert!(refused >= fewest(share, runs, 500), "{count}: {refused}");
    }
}
