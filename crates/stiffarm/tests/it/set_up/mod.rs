//! What the cell states of the set-up is held against the readings.

pub mod days;
mod free;
mod mistakes;

use crate::common::prelude::*;
use days::{Beyond, Day, Kind, day, displacements, move_states};
use mistakes::{MISTAKES, Mistake, Plant};
use rayon::prelude::*;
use stiffarm::ask::identify::{Identified, IdentifiedOptions};
use stiffarm::ask::measure::{MeasureOptions, judge};
use stiffarm::estimate::setup::{SetUp, set_up};
use stiffarm::estimate::standing::InterimEstimate;
use stiffarm::estimate::systematic::{SystematicErrors, systematic_errors};
use stiffarm::findings::codes;
use stiffarm::model::measurement::{Measurements, Role};

const QUIET: MeasureOptions = MeasureOptions { until: None, no_search: true, seed: 1 };

/// The cell as it is stated, and what was read.
fn planted(mistake: &Mistake, beyond: Beyond, seed: u64) -> (Cell, Measurements) {
    let Day { mut cell, mut table } = day(mistake.kind, beyond, 12, mistake.states, seed);
    match mistake.plant {
        Plant::Cell(plant) => plant(&mut cell),
        Plant::Readings(plant) => plant(&cell, &mut table),
        Plant::Table(plant) => {
            let mut measured = displacements(&cell, &table);
            plant(&mut measured);
            return (cell, measured.into());
        }
        Plant::CellOfTable(plant) => {
            let measured = displacements(&cell, &table);
            plant(&mut cell);
            return (cell, measured.into());
        }
    }
    (cell, table.into())
}

/// All that `measure` says of the readings.
fn said(cell: &Cell, measurements: Measurements) -> Vec<Finding> {
    let reduce = ReduceOptions::default();
    match judge((cell, &[]), Ok(measurements), &reduce, &QUIET, Control::default()) {
        Ok(judged) => judged.readings,
        Err(error) => vec![Finding::serious("error", "", error.to_string())],
    }
}

/// `named` where a finding has the words, `misled` where another quantity of the set-up is rejected, `noticed` where
/// something else is said, `silent`; with what is said.
fn outcome(mistake: &Mistake, beyond: Beyond, seed: u64) -> (&'static str, String) {
    let (cell, measurements) = planted(mistake, beyond, seed);
    let short = |f: &Finding| format!("{}: {}", f.code, f.subject);
    let findings = said(&cell, measurements);
    let is_it = |f: &&Finding| mistake.words.iter().all(|word| f.sentence.contains(word));
    let mut heard: Vec<&Finding> = findings.iter().filter(|f| f.severity > Severity::Note).collect();
    heard.sort_by_key(|f| std::cmp::Reverse(f.severity));
    let has_words = !mistake.words.is_empty();
    let named = findings.iter().find(|f| has_words && is_it(f));
    let other = |f: &&Finding| f.code == codes::SET_UP && !(has_words && is_it(f));
    match (named, findings.iter().find(other)) {
        (_, Some(other)) => return ("misled", short(other)),
        (Some(named), None) => return ("named", short(named)),
        (None, None) => {}
    }
    match heard.first() {
        Some(first) => ("noticed", short(first)),
        None => ("silent", String::new()),
    }
}

fn tested(cell: &Cell, measurements: impl Into<Measurements>) -> SetUp {
    let measured = prepare(cell, measurements, &Default::default()).unwrap();
    let fit = Fit::new(cell, measured, &Default::default()).unwrap();
    set_up(&fit, None, &[]).unwrap().unwrap_or_default()
}

/// What came of each row: `named`, `misled`, `noticed` or `silent`, and the finding behind it.
fn outcomes(rows: &[&Mistake], beyond: Beyond) -> Vec<(&'static str, String)> {
    let all = rows.par_iter().map(|mistake| outcome(mistake, beyond, 1));
    all.collect()
}

fn count(outcomes: &[(&'static str, String)], of: &str) -> usize {
    outcomes.iter().filter(|(word, _)| *word == of).count()
}

/// Rigid links, so that only the planted mistake is in the readings.
#[test]
fn mistakes_are_named() {
    let rows: Vec<&Mistake> = MISTAKES.iter().collect();
    let judged = outcomes(&rows, Beyond::Nothing);
    let line =
        |(mistake, (outcome, said)): (&&Mistake, &(&str, String))| format!("{} | {outcome} | {said}\n", mistake.name);
    let table: String = rows.iter().zip(&judged).map(line).collect();
    insta::assert_snapshot!("mistakes", table);
    for (mistake, (outcome, said)) in rows.iter().zip(&judged) {
        // What no reading can tell has no words.
        let is_told = !mistake.words.is_empty();
        assert_ne!(*outcome, "misled", "{}: {said}", mistake.name);
        assert!(*outcome != "silent" || !is_told, "{}", mistake.name);
    }
    assert!(count(&judged, "named") >= 90, "{table}");
}

/// Springs beyond the axes hide the smaller mistakes; they make no other quantity of them.
#[test]
fn a_soft_structure_misleads_nobody() {
    let of_default = |m: &&Mistake| m.kind != Kind::Lever;
    let rows: Vec<&Mistake> = MISTAKES.iter().filter(of_default).step_by(3).collect();
    let judged = outcomes(&rows, Beyond::Structure("arm_4"));
    for (mistake, (outcome, said)) in rows.iter().zip(&judged) {
        assert_ne!(*outcome, "misled", "{}: {said}", mistake.name);
    }
    let named = count(&judged, "named");
    assert!(3 * named >= 2 * rows.len(), "{named} of {}", rows.len());
}

/// A shift of 0.02 mm on an arm with springs beyond its axes, which excuse most of it: at least a doubt is said. It was
/// silent.
#[test]
fn what_springs_may_excuse_is_doubted() {
    let mut codes = Vec::new();
    for seed in 0..6 {
        let Day { cell, mut table } = day(Kind::Rope, Beyond::Structure("realistic"), 12, 3, seed);
        let shift = Vector3::new(0.015, -0.015, 0.0075) * 1e-3;
        move_states(&mut table, Role::Loaded, |_, _| vec![shift; 4]);
        let test = tested(&cell, table);
        let finding = test.finding.filter(|_| test.freed[0].name == "common-shift");
        codes.extend(finding.map(|finding| finding.code));
    }
    let doubted = codes.iter().filter(|code| *code == "set-up-doubtful").count();
    assert!(codes.len() >= 5 && doubted >= 2, "{codes:?}");
}

/// An anchor 60 mm off in eight postures of a long lever: the readings are likelier with the true one, though not surely, or
/// by one posture alone. That was no finding, and joint 1 stood as known with too small a ±. Now it is doubted, and the
/// total ± holds what the readings ask for.
#[test]
fn what_is_doubted_is_in_every_interval() {
    let (mut words, mut missed) = (Vec::new(), 0);
    for seed in [400, 404, 406, 409] {
        let Day { mut cell, table } = day(Kind::Lever, Beyond::Nothing, 8, 3, seed);
        let truth = cell.require_prior().unwrap().to_vec();
        rope_anchor(&mut cell).z -= 0.06;
        let measured = prepare(&cell, table, &Default::default()).unwrap();
        let fit = Fit::new(&cell, measured, &Default::default()).unwrap();
        let all = Identified::new(&fit, &IdentifiedOptions::default(), Control::default()).unwrap();
        let diagnosis = all.diagnosis.unwrap();
        let doubted = diagnosis.doubted().unwrap();
        assert_eq!(doubted.severity, Severity::Caution);
        words.push(doubted.sentence.clone());
        let systematic = all.systematic_errors.unwrap();
        let anchor = systematic.sources.iter().find(|errors| errors.name == "anchor").unwrap();
        let quantity = &diagnosis.set_up.as_ref().unwrap().freed[0];
        let squares = quantity.asked.iter().zip(&quantity.stated);
        let squares: f64 = squares.map(|(a, b)| (a - b).powi(2)).sum();
        assert!(anchor.doubtful);
        assert!((anchor.size - (squares / 3.0).sqrt()).abs() < 1e-9);
        let before = systematic_errors(&fit).unwrap();
        for (j, joint) in all.identification.estimates.joints.iter().enumerate() {
            let [low, high] = joint.interval;
            let holds = |k: &f64| low.unwrap() <= *k && high.is_none_or(|high| *k <= high);
            assert!(holds(&truth[j]), "{seed} {}: {:?}", joint.name, joint.interval);
            if j == 0 {
                let total = |errors: &SystematicErrors| errors.uncertainty[0].total.unwrap();
                assert!(total(&systematic) > 1.25 * total(&before), "{seed}");
                let off = (joint.stiffness.unwrap() / truth[0] - 1.0).abs();
                missed += u32::from(off > total(&before));
            }
        }
        // `measure` says the same ±.
        let so_far = InterimEstimate::new(&fit).unwrap();
        assert_eq!(so_far.systematic().total, systematic.total);
    }
    insta::assert_snapshot!("doubted_by_days", words.join("\n\n"));
    assert_eq!(missed, 1);
}

/// A quantity off by less than three of its standard uncertainties is no finding: the total ± has it.
#[test]
fn what_the_uncertainty_holds_is_no_finding() {
    // By chance this sound day asks for 14 N beside 981; a force is known to 1 %.
    let Day { mut cell, table } = day(Kind::Weight, Beyond::Common(3e-5), 12, 3, 1197);
    let test = tested(&cell, table.clone());
    let [first, ..] = &test.freed[..] else { panic!("{test:#?}") };
    assert_eq!(first.name, "force-offset");
    assert!(first.likelihood_ratio > 26.0 && first.asked[0] < 20.0);
    assert_eq!(test.finding, None);
    // Who knows it better is told.
    cell.uncertainty.force_scale = Some(1e-3);
    assert!(tested(&cell, table).finding.is_some());
    // An anchor that is stated to 5 mm by default, and to 50 mm where the cell says so.
    let lever = |far: f64, stated_m: Option<f64>| {
        let Day { mut cell, table } = day(Kind::Rope, Beyond::Nothing, 12, 3, 1);
        rope_anchor(&mut cell).z -= far;
        cell.uncertainty.anchor = stated_m;
        tested(&cell, table).finding.is_some()
    };
    let said = [(0.15, None), (0.15, Some(0.1)), (0.15, Some(0.01))].map(|(far, stated_m)| lever(far, stated_m));
    assert_eq!(said, [true, false, true]);
}

/// Sound days of arms that do more than turn about their axes: no quantity is rejected in more than 2 %.
#[test]
fn sound_days_reject_nothing() {
    const WHOLE: u64 = 300;
    let beyonds = [
        Beyond::Nothing,
        Beyond::Tilts(5e-8, 1e-8),
        Beyond::Tilts(3e-7, 3e-8),
        Beyond::Structure("realistic"),
        Beyond::Structure("arm_0"),
        Beyond::Structure("arm_8"),
        Beyond::Structure("links_half"),
        Beyond::Structure("bearings_double"),
        Beyond::LostMotion(0.3),
        Beyond::Drift(4e-9),
        Beyond::Common(3e-5),
    ];
    let kinds = [Kind::Rope, Kind::Lever, Kind::Weight, Kind::Sensor, Kind::Forces];
    let runs = runs(WHOLE / 10);
    let rejected = |run: u64| {
        let i = run as usize;
        let beyond = beyonds[i % beyonds.len()];
        // The structures are those of the default cell's arm.
        let kind = match (kinds[i % kinds.len()], beyond) {
            (Kind::Lever, Beyond::Structure(_)) => Kind::Rope,
            (kind, _) => kind,
        };
        let is_table = i.is_multiple_of(3) && !matches!(kind, Kind::Sensor | Kind::Forces);
        let states = if is_table { 2 } else { 3 };
        let Day { cell, table } = day(kind, beyond, [6, 12, 9][i % 4 % 3], states, 1000 + run);
        let test = match is_table {
            true => tested(&cell, displacements(&cell, &table)),
            false => tested(&cell, table),
        };
        let finding = test.finding.filter(|finding| finding.code.starts_with(codes::SET_UP))?;
        Some(format!("{kind:?} {beyond:?} {run}: {}", finding.sentence))
    };
    let rejections: Vec<String> = (0..runs).into_par_iter().filter_map(rejected).collect();
    println!("{} of {runs}\n{}", rejections.len(), rejections.join("\n"));
    assert!(rejections.len() as u64 <= most(0.02, runs, WHOLE), "{}", rejections.join("\n"));
}

#[test]
fn the_measured_robot_has_no_mistake() {
    let (cell, measured) = common::readings::measured_robot();
    let fit = Fit::new(&cell, measured, &Default::default()).unwrap();
    let test = set_up(&fit, None, &[]).unwrap().unwrap();
    assert_eq!(test.finding, None);
    assert!(test.freed.iter().all(|f| f.likelihood_ratio < 20.0), "{test:#?}");
}

/// One row by its name.
fn mistake(name: &str) -> &'static Mistake {
    MISTAKES.iter().find(|m| m.name == name).unwrap()
}

/// `identify` says it too, and what only follows from it is not said beside it.
#[test]
fn identify_says_what_measure_says() {
    let mut sentences = String::new();
    for name in [
        "lever 50 mm too long",
        "gravity upside down",
        "all loaded 0.05 mm later",
        "joint 6 off by 180°, displacements",
    ] {
        let (cell, measurements) = planted(mistake(name), Beyond::Nothing, 1);
        let by_measure = said(&cell, measurements.clone());
        let measured = prepare(&cell, measurements, &Default::default()).unwrap();
        let fit = Fit::new(&cell, measured, &Default::default()).unwrap();
        let all = Identified::new(&fit, &IdentifiedOptions::default(), Control::default()).unwrap();
        let rejected = all.rejected().unwrap().clone();
        assert_eq!(&rejected, the(&by_measure, codes::SET_UP));
        assert_eq!(rejected.severity, Severity::Serious);
        let serious = by_measure.iter().filter(|f| f.severity == Severity::Serious);
        assert_eq!(serious.count(), 1, "{by_measure:#?}");
        let screening = all.screening().map(|s| s.findings.len());
        assert_eq!(screening.unwrap_or(0), 0, "{name}");
        sentences += &(rejected.sentence.clone() + "\n");
        // What predicts later says so.
        let doubts = all.sealed.unwrap().predictor.doubts;
        the(&doubts, "stiffness-doubtful");
    }
    insta::assert_snapshot!("sentences", sentences);
}

/// The value that the readings ask for is the true one, within its errors.
#[test]
fn what_the_readings_ask_for_is_true() {
    let (mut outside, mut all) = (0, 0);
    for seed in 0..runs(8) {
        for (name, truth) in [("anchor 300 mm too low", [1.8, 0.0, 0.0]), ("lever 50 mm too long", [0.2, 0.0, 0.25])] {
            let (cell, measurements) = planted(mistake(name), Beyond::Nothing, 50 + seed);
            let test = tested(&cell, measurements);
            let first = &test.freed[0];
            assert!(test.finding.is_some(), "{name} {seed} {test:#?}");
            for i in 0..3 {
                let off = (first.asked[i] - truth[i]) / first.standard_error[i].unwrap();
                assert!(off.abs() < 5.0, "{name} {seed}: {first:#?}");
                outside += u64::from(off.abs() > 2.0);
                all += 1;
            }
        }
    }
    assert!(outside <= most(0.06, all, 3000), "{outside} of {all}");
}

/// The springs of the structural code give what it gives, but for its second order.
#[test]
fn the_structures_are_those_of_the_structural_code() {
    let cell = reference_cell();
    let data: serde_json::Value = serde_json::from_str(include_str!("../../golden/structural-springs.json")).unwrap();
    for check in common::list(&data["check"]) {
        let q: Vec<f64> = common::numbers(&check["q_deg"]).iter().map(|q| q.to_radians()).collect();
        let mut cell = cell.clone();
        cell.setup.tool.loading_point = cell.setup.tool.tcp();
        cell.setup.load =
            Load::Constant { wrench: Wrench::force(common::vector3(&check["force_n"])), axes: Axes::Base };
        let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
        let joints = terms.block(&cell.setup.robot) * compliance_of(cell.require_prior().unwrap());
        let beyond = days::structural(&cell, &days::structure("realistic"), &q, 1.0);
        for (a, expected) in common::list(&check["displacement_mm"]).iter().enumerate() {
            let all = joints.fixed_rows::<3>(3 * a) + beyond[a];
            let off = (all * 1e3 - common::vector3(expected)).norm();
            assert!(off < 0.05 && beyond[a].norm() > 1e-4, "point {a}: {off} mm");
        }
    }
}
