//! How often faults of scale are named, and how often sound experiments are
//! suspected of one: the table of docs/readings.md.
//!
//! `cargo run --release -p stiffarm --example scales [EXPERIMENTS [SOUND [SEED [NAME]]]]`
//!
//! Five robots, EXPERIMENTS (20) of each with every fault, SOUND (1000) without.
//! With NAME only faults whose name holds it, each that is not named in full.

mod experiments;
mod faults;

use experiments::{Dice, KINDS, ROBOTS, sound};
use faults::{FAULTS, Fault, Judged, OTHERS, Outcome, findings, judge};
use rayon::prelude::*;
use stiffarm::findings::Severity;

fn main() {
    let mut args = std::env::args().skip(1);
    let mut number = |otherwise: u64| args.next().and_then(|text| text.parse().ok()).unwrap_or(otherwise);
    let (runs, sounds, seed) = (number(20), number(1000), number(1));
    let only = args.next();
    println!(
        "| fault | experiments | named | alone | first of several | among several | wrong | silent | by the prior alone | serious | other findings beside |"
    );
    println!("|:--|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
    let mut total = [0; 2];
    for fault in FAULTS.iter().chain(&OTHERS) {
        if only.as_ref().is_some_and(|text| !fault.name.contains(text)) {
            continue;
        }
        let judged = planted(fault, runs, seed);
        let count = |of: Outcome| judged.iter().filter(|j| j.outcome == of).count();
        let [alone, first, among, wrong, silent] =
            [Outcome::Alone, Outcome::First, Outcome::Among, Outcome::Wrong, Outcome::Silent].map(count);
        let by_prior = judged.iter().filter(|j| j.by_prior).count();
        let serious = judged.iter().filter(|j| j.is_serious).count();
        let beside = judged.iter().filter(|j| j.beside > 0).count();
        let named = alone + first + among;
        total[0] += named;
        total[1] += judged.len();
        println!(
            "| {} | {} | {named} | {alone} | {first} | {among} | {wrong} | {silent} | {by_prior} | {serious} | {beside} |",
            fault.name,
            judged.len()
        );
        if only.is_some() {
            for (i, j) in judged.iter().enumerate() {
                if matches!(j.outcome, Outcome::Wrong | Outcome::Silent) {
                    println!("  {} {}: {:?}: {}", ROBOTS[i % 5], i / 5, j.outcome, j.said);
                }
            }
        }
    }
    println!("\nnamed: {} of {}", total[0], total[1]);
    let alarms = alarms(sounds, seed);
    let of_scale = alarms.iter().filter(|a| a.0).count();
    println!("sound experiments: {sounds}, suspected of a scale: {of_scale}, with any finding: {}", alarms.len());
    for (_, alarm) in &alarms {
        println!("- {alarm}");
    }
}

/// The fault in `runs` experiments of each robot.
fn planted(fault: &Fault, runs: u64, seed: u64) -> Vec<Judged> {
    let all: Vec<(usize, u64)> = (0..runs).flat_map(|n| (0..ROBOTS.len()).map(move |r| (r, n))).collect();
    all.into_par_iter()
        .map(|(robot, n)| {
            let mut experiment = sound(robot, n, fault.kind, seed);
            let mut dice = Dice::new(seed + 1, robot, n);
            let expected = fault.plant(&mut experiment, &mut dice);
            judge(&experiment, &expected)
        })
        .collect()
}

/// What is said of sound experiments of all kinds, and whether it is about a scale.
fn alarms(count: u64, seed: u64) -> Vec<(bool, String)> {
    (0..count)
        .into_par_iter()
        .filter_map(|n| {
            let robot = (n % 5) as usize;
            let kind = KINDS[(n / 5 % 6) as usize];
            let experiment = sound(robot, n + 1000, kind, seed);
            let (suspicions, findings) = findings(&experiment);
            let is_of_scale = suspicions.iter().any(|s| s.cause.is_scale());
            let said: Vec<String> = findings
                .iter()
                .filter(|f| f.severity != Severity::Note)
                .map(|f| format!("{}: {}", f.code, f.sentence))
                .collect();
            let said = format!("{} {kind:?} {n}: {}", ROBOTS[robot], said.join(" | "));
            (!findings.is_empty()).then_some((is_of_scale, said))
        })
        .collect()
}
