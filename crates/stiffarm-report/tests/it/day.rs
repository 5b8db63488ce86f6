//! A day of measuring, and the registration before it, say how far they are, what is wrong and what comes next.

use crate::common::{exchange, group, saved, saved_with, story};
use serde_json::json;
use stiffarm::ask::identify::Identified;
use stiffarm::ask::measure::{Goal, MeasureOptions, judge};
use stiffarm::findings::{Finding, Severity};
use stiffarm::measure::prepare;
use stiffarm::measure::registration::{RegistrationRecord, register};
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::{Measurements, ReadingTable};
use stiffarm::simulated_readings;
use stiffarm::{Code, Control, Error, Fit, Result};
use stiffarm_files::builtin;
use stiffarm_files::table::read_pairs;
use stiffarm_report::summary::{Block, Outcome, Summary, WithCell, summarise};

/// What is said of readings beside a plan of six postures.
fn day(goal: Option<f64>, readings: impl FnOnce(ReadingTable) -> Result<Measurements>) -> Summary {
    let cell = builtin::cell("comau").unwrap();
    let plan = group(&cell);
    let options = MeasureOptions { until: goal.map(Goal::Stiffness), no_search: true, seed: 1 };
    let table = simulated_readings(&cell, &plan, 1).unwrap();
    let judged = judge((&cell, &plan), readings(table), &Default::default(), &options, Control::default());
    let saved = saved_with("measure", json!(options), json!(judged.unwrap()));
    summarise(&WithCell::new(&saved, Some(&cell))).unwrap()
}

/// The first postures of a table.
fn first(count: usize) -> impl FnOnce(ReadingTable) -> Result<Measurements> {
    move |mut table| {
        table.postures.truncate(count);
        Ok(table.into())
    }
}

#[test]
fn a_day_says_how_far_it_is_and_which_posture_comes_next() {
    let part = day(Some(0.001), first(4));
    insta::assert_snapshot!(story(&part.verdict), @"
    4 of 6 planned postures measured.
    Every joint is known to ± 50 % at 95 % confidence, all errors together; the goal of ± 0.10 % may not be reached with the 2 postures left. What the fit leaves has a standard deviation of 0.0134 mm against 0.0136 mm expected.
    Posture 5 at q = (25.00, −20.00, −115.00, 15.00, 10.00, 0.00)°.
    ");
    let headings = part.key.unwrap().headings;
    assert!(headings.contains(&"with all ≈ [%]".to_string()), "{headings:?}");
}

#[test]
fn a_day_ends_with_the_goal_or_the_plan() {
    insta::assert_snapshot!(story(&day(Some(0.5), first(6)).verdict), @"
    6 of 6 planned postures measured.
    Every joint is known to ± 24 % at 95 % confidence, all errors together; the goal is reached (± 50 %). What the fit leaves has a standard deviation of 0.0137 mm against 0.0136 mm expected.
    Nothing more: the goal is reached.
    ");
    let part = day(Some(0.001), first(6));
    insta::assert_snapshot!(story(&part.verdict), @"
    6 of 6 planned postures measured.
    Every joint is known to ± 24 % at 95 % confidence, all errors together; the goal of ± 0.10 % is not reached with the whole plan. What the fit leaves has a standard deviation of 0.0137 mm against 0.0136 mm expected.
    Nothing more: the plan is measured.
    ");
    assert_ne!(part.outcome, Outcome::Good);
    // Nothing is expected of postures that are not left.
    assert!(!part.key.unwrap().headings.iter().any(|h| h.contains('≈')));
}

#[test]
fn before_the_first_posture_nothing_is_said_of_the_stiffness() {
    let part = day(None, |_| Err(Error::new(Code::TooFewData, "No row yet.")));
    insta::assert_snapshot!(story(&part.verdict), @"
    0 of 6 planned postures measured.
    Nothing can be said of the stiffness yet. No row yet.
    Posture 1 at q = (−35.00, −10.00, −95.00, 10.00, 15.00, −20.00)°.
    ");
    assert!(part.key.is_none() && part.outcome == Outcome::Caution);
}

#[test]
fn what_is_wrong_is_settled_before_the_next_posture() {
    let part = day(None, |mut table| {
        exchange(&mut table);
        Ok(table.into())
    });
    assert_eq!(part.outcome, Outcome::Serious);
    insta::assert_snapshot!(story(&part.verdict), @"
    6 of 6 planned postures measured.
    Something is wrong with the readings: settle it before the next posture. As they are: The stiffness is not known yet of joint 1, joint 2, joint 3 and joint 4. What the fit leaves has a standard deviation of 1.7109 mm against 0.0136 mm expected, 126 times as much.
    Settle what is marked serious: measure that posture again or correct the table.
    ");
}

#[test]
fn a_registration_says_which_point_is_off_and_what_goes_into_the_cell() {
    let text = builtin::pairs_text("example-pairs").unwrap();
    let mut pairs = read_pairs(text.as_bytes(), "pairs.csv").unwrap();
    let part = |pairs: &[_]| {
        let record = RegistrationRecord::from(&register(pairs).unwrap());
        let saved = saved("register", json!(record));
        summarise(&WithCell::new(&saved, None)).unwrap()
    };
    let good = part(&pairs);
    assert_eq!(good.outcome, Outcome::Good);
    let Block::Lines(lines) = &good.sections[0].blocks[0] else {
        panic!("no lines");
    };
    let lines: Vec<String> = lines.iter().map(|line| line.line()).collect();
    assert_eq!(
        lines,
        ["[tracker]", "xyz_mm = [4100.0115, -2649.9725, 1319.9384]", "rpy_deg = [-0.7002512, 0.3988742, 118.0005733]"]
    );
    pairs[2].base.y += 1.5e-3;
    let wrong = part(&pairs);
    assert_eq!(wrong.outcome, Outcome::Serious);
    assert_eq!(wrong.key.as_ref().unwrap().rows[0][0].plain(), "C");
    insta::assert_snapshot!(format!("{}\n{}", wrong.sections[0].title, story(&wrong.verdict)), @"
    Base frame from tracker frame; not to be used before the serious finding is settled
    The tracker was registered to the robot's base by 5 points given in both frames.
    The points agree within 0.5746 mm (RMS); a coordinate scatters by 0.4283 mm, from 9 degrees of freedom.
    Settle what is marked serious first: the points at the top of the table, then register again.
    ");
}

/// What `identify` says of the same readings is said here, too: a sign of the set-up, a load that was typed wrong.
#[test]
fn a_day_says_what_identify_says_of_the_readings() {
    let cell = builtin::cell("comau").unwrap();
    let plan = group(&cell);
    let judged = |cell: &Cell, table: ReadingTable| {
        let options = MeasureOptions { no_search: true, ..MeasureOptions::default() };
        let control = Control::default();
        judge((cell, &plan), Ok(table.into()), &Default::default(), &options, control).unwrap()
    };
    let identified = |cell: &Cell, table: &ReadingTable| {
        let measured = prepare(cell, table.clone(), &Default::default()).unwrap();
        let fit = Fit::new(cell, &measured, &Default::default()).unwrap();
        Identified::new(&fit, &Default::default(), Control::default()).unwrap()
    };
    let table = simulated_readings(&cell, &plan, 1).unwrap();
    let mut turned = cell.clone();
    turned.setup.tool.loading_point.x *= -1.0;
    let day = judged(&turned, table.clone());
    assert!(day.is_serious(), "{:?}", day.readings);
    let of_identify = identified(&turned, &table);
    let rejected = of_identify.rejected().unwrap();
    assert!(day.readings.contains(rejected), "{rejected:?}");
    // The loading point it is; a joint that yields against its torque only follows.
    assert_eq!(rejected.subject, "tool.loading_point_mm");
    let of_joints = day.readings.iter();
    assert_eq!(of_joints.filter(|f| f.code == "negative-compliance").count(), 0);
    let standing = day.standing.as_ref().unwrap();
    assert!(standing.residual_std_m.unwrap() > 1.5 * standing.expected_std_m);

    let mut wrong = table.clone();
    for state in &mut wrong.postures[5].states {
        state.load = state.load.map(|load| 0.9 * load);
    }
    let day = judged(&cell, wrong.clone());
    let diagnosis = identified(&cell, &wrong).diagnosis.unwrap();
    let outlying: Vec<_> = diagnosis.findings.iter().filter(|f| f.code.starts_with("outlying")).collect();
    assert!(!outlying.is_empty());
    assert!(outlying.iter().all(|f| day.readings.contains(f)));

    // Sound readings have no word against them, however many postures there are.
    for seed in 1..5 {
        let table = simulated_readings(&cell, &plan, seed).unwrap();
        for count in 1..=5 {
            let mut part = table.clone();
            part.postures.truncate(count);
            let day = judged(&cell, part);
            let loud = day.readings.iter().filter(|f| f.severity > Severity::Note);
            assert_eq!(loud.collect::<Vec<_>>(), Vec::<&Finding>::new(), "seed {seed}, {count} postures");
        }
    }
}
