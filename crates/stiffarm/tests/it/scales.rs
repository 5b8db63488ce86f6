//! Faults of scale: each is named, with its factor, and sound experiments are not
//! suspected. The experiments are those of the example `scales`, in smaller number.

#[path = "../../examples/scales/experiments.rs"]
mod experiments;
#[path = "../../examples/scales/faults.rs"]
mod faults;

use crate::common::prelude::*;
use crate::common::runs::fewest;
use experiments::{Dice, KINDS, Kind, ROBOTS, sound};
use faults::{FAULTS, OTHERS, Outcome, findings, judge};
use rayon::prelude::*;
use stiffarm::measure::screening::{Cause, Evidence, screen_displacements};
use stiffarm::model::measurement::Measurements;

/// Another seed than that of the table in docs/readings.md.
const SEED: u64 = 7;

#[test]
fn every_fault_of_scale_is_named() {
    let mut missed = Vec::new();
    let mut all = 0;
    for (i, fault) in FAULTS.iter().chain(&OTHERS).enumerate() {
        // Kilograms of which the prior alone tells are named always, and alone.
        let by_prior = i < 3;
        let each = runs(if by_prior { 4 } else { 2 });
        let of: Vec<(usize, u64)> = (0..each).flat_map(|n| (0..ROBOTS.len()).map(move |r| (r, n))).collect();
        all += of.len() as u64;
        let wrong: Vec<String> = of
            .into_par_iter()
            .filter_map(|(robot, n)| {
                let mut experiment = sound(robot, n, fault.kind, SEED);
                let mut dice = Dice::new(SEED + 1, robot, n);
                let expected = fault.plant(&mut experiment, &mut dice);
                let judged = judge(&experiment, &expected);
                if by_prior {
                    assert!(judged.said.contains("9.81"), "{}", judged.said);
                    // A caution where the prior alone speaks, and nothing that only follows.
                    assert!(judged.by_prior || judged.is_serious, "{}", judged.said);
                    assert_eq!(judged.beside, 0, "{}", judged.said);
                }
                matches!(judged.outcome, Outcome::Wrong | Outcome::Silent).then(|| {
                    let robot = ROBOTS[robot];
                    format!("{}, {robot} {n}: {:?}: {}", fault.name, judged.outcome, judged.said)
                })
            })
            .collect();
        missed.extend(wrong);
    }
    let named = all - missed.len() as u64;
    println!("{named} of {all} named\n{}", missed.join("\n"));
    assert!(named >= fewest(0.99, all, 3700), "{}", missed.join("\n"));
}

#[test]
fn sound_experiments_are_not_suspected_of_a_scale() {
    let count = runs(150);
    let alarms: Vec<String> = (0..count)
        .into_par_iter()
        .filter_map(|n| {
            let kind = KINDS[(n / 5 % 6) as usize];
            let experiment = sound((n % 5) as usize, n + 1000, kind, SEED);
            let (suspicions, findings) = findings(&experiment);
            let i = suspicions.iter().position(|s| s.cause.is_scale())?;
            Some(format!("{kind:?} {n}: {}", findings[i].sentence))
        })
        .collect();
    let allowed = most(0.001, count, 1000);
    assert!(alarms.len() as u64 <= allowed, "{}", alarms.join("\n"));
}

/// The first fault of this name, planted in an experiment of the first robot.
fn planted(name: &str) -> experiments::Sound {
    let fault = FAULTS.iter().chain(&OTHERS).find(|f| f.name == name);
    let fault = fault.expect("a fault of this name");
    let mut experiment = sound(0, 3, fault.kind, SEED);
    fault.plant(&mut experiment, &mut Dice::new(SEED, 0, 3));
    experiment
}

#[test]
fn sentences_about_scales() {
    let mut said = Vec::new();
    for fault in FAULTS.iter().chain(&OTHERS) {
        let (_, findings) = findings(&planted(fault.name));
        let of: Vec<String> =
            findings.iter().map(|f| format!("[{}] {:?}, {}: {}", f.code, f.severity, f.subject, f.sentence)).collect();
        said.push(format!("{}\n  {}", fault.name, of.join("\n  ")));
    }
    insta::assert_snapshot!("scales", said.join("\n"));
}

#[test]
fn one_fault_is_one_finding_through_the_reduction_too() {
    // A sensor in kilograms has forces, moments and sizes that do not fit: one finding.
    for name in ["kg for N, sensor", "moments in N·mm", "kg for N, load_n"] {
        let experiment = planted(name);
        let measured = prepare(&experiment.cell, experiment.table, &Default::default()).unwrap();
        let serious: Vec<&str> =
            measured.findings().filter(|f| f.severity == Severity::Serious).map(|f| f.code.as_str()).collect();
        assert_eq!(serious.len(), 1, "{name}: {serious:?}");
        assert_eq!(measured.screening.unwrap().scales().count(), 1, "{name}");
    }
}

#[test]
fn a_table_of_displacements_is_screened_where_it_is_prepared() {
    let experiment = planted("displacements in m");
    let table = experiment.displacements.unwrap();
    let direct = screen_displacements(&experiment.cell, &table).unwrap();
    let table = Measurements::Displacements(table);
    let measured = prepare(&experiment.cell, table, &Default::default()).unwrap();
    assert!(measured.reduction.is_none());
    assert_eq!(measured.worst(), Some(Severity::Serious));
    assert_eq!(measured.screening, Some(direct));
}

#[test]
fn one_point_and_the_arms_reach_tell_units_too() {
    // One point has no shape; the way it goes from posture to posture tells.
    let mut experiment = sound(0, 2, Kind::RopeLoads, SEED);
    experiment.cell.setup.tool.measuring_points.truncate(1);
    for state in experiment.table.postures.iter_mut().flat_map(|p| &mut p.states) {
        state.readings.retain(|r| r.target == ReadingTarget::Point(0));
        state.readings.iter_mut().for_each(|r| r.position /= 25.4);
    }
    let screening = screen(&experiment.cell, &experiment.table, None).unwrap();
    let first = &screening.suspicions[0];
    assert_eq!((first.cause, first.factor), (Cause::Units, Some(1.0 / 25.4)));
    // Lengths of a robot of one's own, in metres where millimetres are asked for.
    let mut experiment = sound(0, 2, Kind::RopeLoads, SEED);
    let right = FRAC_PI_2;
    let row = |alpha, a: f64, d: f64| [alpha, a * 1e-6, d * 1e-6, 0.0];
    let rows = [
        row(0.0, 0.0, 830.0),
        row(-right, 400.0, 0.0),
        row(0.0, 1175.0, 0.0),
        row(-right, 250.0, 1444.0),
        row(right, 0.0, 0.0),
        row(-right, 0.0, 230.0),
    ];
    experiment.cell.setup.robot = chain("own", DhConvention::Modified, &rows);
    let screening = screen(&experiment.cell, &experiment.table, None).unwrap();
    assert_eq!(screening.suspicions.len(), 1, "{:?}", screening.findings);
    assert_eq!(screening.suspicions[0].cause, Cause::RobotUnits);
    assert_eq!(screening.suspicions[0].factor, Some(1e3));
}

#[test]
fn without_a_prior_robots_of_the_class_speak() {
    let mut report = String::new();
    for (robot, name) in ROBOTS.iter().enumerate() {
        let mut experiment = sound(robot, 5, Kind::RopeAlone, SEED);
        experiment.cell.prior = None;
        let sane = screen(&experiment.cell, &experiment.table, None).unwrap();
        assert_eq!(sane.scales().count(), 0, "{name}: {:?}", sane.findings);
        experiments::scale_loads(&mut experiment.cell.setup.load, 1e-3);
        let screening = screen(&experiment.cell, &experiment.table, None).unwrap();
        let one = screening.suspicions.iter().find(|s| s.cause.is_scale()).unwrap();
        assert_eq!((one.cause, one.factor), (Cause::LoadUnits, Some(1e3)), "{name}");
        report += &format!("{name}: {}\n", screening.scales().next().unwrap().sentence);
    }
    insta::assert_snapshot!(report, @"
    comau-nj165-3.0: The loads look like kilonewtons: factor 1000. As typed, the joint stiffness comes out 2651 times below what robots of this class have, all joints alike. The file itself says so too: 0.50 N, which hardly bends such a robot. Check load_n and load.magnitude_n (N).
    kuka-kr240-2: The loads look like kilonewtons: factor 1000. As typed, the joint stiffness comes out 682 times below what robots of this class have, all joints alike. The file itself says so too: 1.7 N, which hardly bends such a robot. Check load_n and load.magnitude_n (N).
    fanuc-r2000ic165f: The loads look like kilonewtons: factor 1000. As typed, the joint stiffness comes out 2948 times below what robots of this class have, all joints alike. The file itself says so too: 0.62 N, which hardly bends such a robot. Check load_n and load.magnitude_n (N).
    abb-irb4600-60-205: The loads look like kilonewtons: factor 1000. As typed, the joint stiffness comes out 1579 times below what robots of this class have, all joints alike. The file itself says so too: 0.46 N, which hardly bends such a robot. Check load_n and load.magnitude_n (N).
    kuka-kr10r1100sixx: The loads look like kilonewtons: factor 1000. As typed, the joint stiffness comes out 2379 times below what robots of this class have, all joints alike. The file itself says so too: 0.06 N, which hardly bends such a robot. Check load_n and load.magnitude_n (N).
    ");
}

#[test]
fn the_names_of_states_confirm_what_the_prior_says() {
    // Numbered names are in about half of the experiments.
    let experiments = (0..20).map(|n| sound(0, n, Kind::RopeLoads, SEED));
    let mut experiment = experiments.into_iter().find(|e| e.is_named).unwrap();
    for state in experiment.table.postures.iter_mut().flat_map(|p| &mut p.states) {
        state.load = state.load.map(|l| l / 9.806_65);
    }
    // The cell's own load says the same as the table: the names alone confirm.
    experiments::scale_loads(&mut experiment.cell.setup.load, 1.0 / 9.806_65);
    let screening = screen(&experiment.cell, &experiment.table, None).unwrap();
    let one = &screening.suspicions[0];
    assert_eq!(one.cause, Cause::LoadUnits, "{:?}", screening.findings);
    assert_eq!(one.evidence, Some(Evidence::File));
    assert_eq!(screening.findings[0].severity, Severity::Serious);
    assert!(one.alternatives.is_empty(), "{:?}", one.alternatives);
}
