//! Results say what is wrong first, what can be used and what to do next: good ones, wrong ones, half made ones.

use crate::common::{exchange, good, group, identified, measured, saved, saved_with, story};
use serde_json::{Value, json};
use std::sync::LazyLock;
use stiffarm::findings::Severity;
use stiffarm::measure::prepare;
use stiffarm::simulated_readings;
use stiffarm_files::builtin;
use stiffarm_files::result::SavedResult;
use stiffarm_report::summary::{Block, Depth, Outcome, Section, Summary, Text, WithCell, summarise};

fn finding(code: &str, severity: &str, sentence: &str) -> Value {
    json!({"code": code, "severity": severity, "subject": "readings", "sentence": sentence})
}

/// The same with one suspicion of the screening, and cautions of the fit.
pub(crate) fn suspected(mut result: Value, cause: &str, severity: &str, sentence: &str) -> Value {
    let suspicion = json!({
        "cause": cause, "postures": ["2"], "states": ["up-1"], "points": ["3"], "joints": ["joint 4"],
        "lines": [64, 69], "repeat": null, "before_m": null, "after_m": null, "off_m": 5e-4, "factor": null,
        "angles_deg": [], "alternatives": [], "certain": true
    });
    let screening = &mut result["readings"]["screening"];
    screening["suspicions"] = json!([suspicion]);
    screening["findings"] = json!([finding(cause, severity, sentence)]);
    for (i, place) in ["systematic_errors", "diagnosis", "diagnosis", "systematic_errors", "systematic_errors"]
        .into_iter()
        .enumerate()
    {
        let caution = finding("of-the-fit", "caution", &format!("Of the fit {i}."));
        result[place]["findings"].as_array_mut().unwrap().push(caution);
    }
    result
}

/// What is said where two points of the second posture are exchanged.
fn exchanged() -> Summary {
    static RESULT: LazyLock<Value> = LazyLock::new(|| {
        let cell = builtin::cell("comau").unwrap();
        let mut readings = simulated_readings(&cell, &group(&cell), 1).unwrap();
        exchange(&mut readings);
        identified(&cell, &prepare(&cell, readings, &Default::default()).unwrap())
    });
    one(RESULT.clone())
}

fn one(result: Value) -> Summary {
    part_of(&saved("identify", result))
}

fn part_of(saved: &SavedResult) -> Summary {
    summarise(&WithCell::new(saved, None)).unwrap()
}

/// What is more than a note.
fn sentences(part: &Summary) -> Vec<&str> {
    let warnings = part.findings.iter().filter(|f| f.severity > Severity::Note);
    warnings.map(|f| f.sentence.as_str()).collect()
}

fn section<'a>(part: &'a Summary, id: &str) -> Option<&'a Section> {
    part.sections.iter().find(|section| section.id == id)
}

/// Last cells of the key table.
fn verdicts(part: &Summary) -> Vec<String> {
    let rows = part.key.as_ref().unwrap().rows.iter();
    rows.map(|row| row.last().unwrap().plain()).collect()
}

#[test]
fn what_is_wrong_with_the_readings_stands_before_what_the_fit_says() {
    let result = good();
    let part = one(suspected(result, "stray_repeat", "caution", "They lie apart."));
    let said = sentences(&part);
    assert_eq!(said[0], "They lie apart.");
    let at = |words: &str| said.iter().position(|s| *s == words).unwrap();
    // The diagnosis before the systematic errors, as in the terminal.
    assert!(at("Of the fit 1.") < at("Of the fit 0."), "{said:?}");
    assert!(section(&part, "held-back").is_none());
    let table = section(&part, "readings").unwrap();
    let Block::Table(table) = &table.blocks[0] else {
        panic!("no table");
    };
    let row: Vec<String> = table.rows[0].iter().map(Text::plain).collect();
    assert_eq!(row[2], "posture 2, state up-1, point 3, joint 4");
    assert_eq!(table.headings, ["likely cause", "weight", "where", "lines"]);
    assert_eq!(row[3], "64 and 69");
}

#[test]
fn a_serious_finding_leaves_no_stiffness_known() {
    let result = good();
    let sentence = "The loads look like kilograms (kgf): factor 9.81. As typed, nothing fits. Check load_n.";
    let part = one(suspected(result, "load_units", "serious", sentence));
    assert_eq!(part.outcome, Outcome::Serious);
    insta::assert_snapshot!(story(&part.verdict), @"
    The stiffness of 6 joints was identified from raw readings of the tracker at 6 postures: 72 displacements (216 components).
    The stiffness cannot be used. The loads look like kilograms (kgf): factor 9.81.
    Correct the table first (lines 64 and 69), then identify again; until then the numbers here are not to be used.
    ");
    for verdict in verdicts(&part) {
        assert_eq!(verdict, "not to be used");
    }
    // What follows from a wrong scale is folded away.
    assert_eq!(sentences(&part), [sentence]);
    let held = section(&part, "held-back").unwrap();
    let Some(Block::Details(summary, blocks)) = held.blocks.last() else {
        panic!("not folded");
    };
    let Block::Findings(held) = &blocks[0] else {
        panic!("no findings");
    };
    assert!(held.len() >= 5 && summary.starts_with(&held.len().to_string()));
}

#[test]
fn a_bound_has_its_unit_and_goes_by_all_errors() {
    let mut result = good();
    let ends = json!([4472.0, null]);
    result["joints"][4]["verdict"] = json!("lower_bound_only");
    result["joints"][4]["interval"] = ends.clone();
    result["joints"][4]["readings_interval"] = json!([4290.0, null]);
    result["systematic_errors"]["uncertainty"][4]["interval_nm_per_rad"] = ends;
    let part = one(result);
    assert_eq!(verdicts(&part)[4], "above 0.00447");
    insta::assert_snapshot!(part.verdict[1].plain(), @"The stiffness is known to ± 2.3 % (joint 1) to ± 24 % (joint 4) at 95 % confidence, readings and systematic errors together. Weak, above ± 10 %: joint 4 and joint 6. k of joint 5: only a lower bound, 0.00447 · 10⁶ N·m/rad. What the fit leaves looks like noise: a standard deviation of 0.0137 mm against 0.0136 mm expected.");
}

#[test]
fn without_a_budget_it_says_what_was_not_examined() {
    let mut result = good();
    result["systematic_errors"] = Value::Null;
    let removed = one(result.clone());
    result["diagnosis"] = Value::Null;
    let options = json!({"exclude": [], "brief": true});
    let brief = part_of(&saved_with("identify", options, result));
    for part in [&removed, &brief] {
        assert_eq!(part.outcome, Outcome::Caution);
        let codes: Vec<&str> = part.findings.iter().map(|f| f.code.as_str()).collect();
        assert!(codes.contains(&"no-systematic-errors"), "{codes:?}");
    }
    assert_eq!(removed.verdict[1], brief.verdict[1]);
    insta::assert_snapshot!(story(&brief.verdict), @"
    The stiffness of 6 joints was identified from raw readings of the tracker at 6 postures: 72 displacements (216 components).
    The stiffness is known to ± 2.3 % (joint 1) to ± 24 % (joint 4) at 95 % confidence, the scatter of the readings alone. Weak, above ± 10 %: joint 4 and joint 6. Systematic errors were not examined. What the fit leaves looks like noise: a standard deviation of 0.0137 mm against 0.0136 mm expected.
    Identify again without --brief: that adds the systematic errors, the search for readings that do not fit, and the next posture to measure.
    ");
}

#[test]
fn bars_stand_only_where_there_are_values() {
    let part = exchanged();
    insta::assert_snapshot!(part.verdict[1].plain(), @"The stiffness cannot be used. Posture 2: points 1 and 3 are exchanged.");
    let blocks = part.sections.iter().flat_map(|section| &section.blocks);
    let figures = blocks.filter_map(|block| match block {
        Block::Figure(figure) => Some(figure),
        _ => None,
    });
    let mut left_out = 0;
    for figure in figures.filter(|f| ["registration", "systematic-errors"].contains(&&*f.id)) {
        for series in figure.panels.iter().flat_map(|panel| &panel.series) {
            assert!(series.y.iter().all(|y| y.is_finite()), "{}", figure.id);
            if series.label.starts_with("left out") {
                left_out = series.x.len();
            }
        }
    }
    assert_eq!(left_out, 1);
}

#[test]
fn joints_of_one_fault_are_named_in_one_finding() {
    let mut result = good();
    for j in [1, 3] {
        result["joints"][j]["verdict"] = json!("sign_or_model_fault");
    }
    let part = one(result);
    let faults = part.findings.iter().filter(|f| f.code == "negative-compliance");
    let subjects: Vec<&str> = faults.map(|f| f.subject.as_str()).collect();
    assert_eq!(subjects, ["joint 2 and joint 4"]);
    assert_eq!(verdicts(&part)[1], "negative");
    insta::assert_snapshot!(part.verdict[2].plain(), @"Check the sign of the force (on the robot), the frames and the model, then identify again.");
}

#[test]
fn a_column_that_says_nothing_is_left_out_and_the_summary_is_short() {
    let mut result = good();
    let full = one(result.clone());
    assert!(full.key.as_ref().unwrap().headings.contains(&"± systematic [%]".to_string()));
    result["systematic_errors"] = Value::Null;
    let brief = one(result);
    assert_eq!(brief.key.as_ref().unwrap().headings, ["joint", "k [10⁶ N·m/rad]", "± readings [%]", "verdict"]);
    let summary = full.sections.iter().filter(|s| s.depth == Depth::Summary);
    let ids: Vec<&str> = summary.map(|section| section.id.as_str()).collect();
    assert_eq!(ids, ["basis"]);
}

#[test]
fn a_joint_that_cannot_be_told_is_named() {
    // The rope's force goes through the axis of joint 6, and the only measuring point lies on it.
    let mut cell = builtin::cell("comau").unwrap();
    cell.setup.tool.loading_point.x = 0.0;
    cell.setup.tool.loading_point.y = 0.0;
    let made = identified(&cell, &measured(&cell, &group(&cell)));
    let result = saved("identify", made);
    let made = part_of(&result);
    insta::assert_snapshot!(story(&made.verdict), @"
    The stiffness of 6 joints was identified from raw readings of the tracker at 6 postures: 72 displacements (216 components).
    No usable value: joint 6. The stiffness is known to ± 2.4 % (joint 1) to ± 35 % (joint 4) at 95 % confidence, readings and systematic errors together. Weak, above ± 10 %: joint 4. What the fit leaves looks like noise: a standard deviation of 0.0138 mm against 0.0136 mm expected.
    stiffarm check of the cell looks for the reason why joint 6 cannot be told; other postures or loads may show it.
    ");
    assert_eq!(made.outcome, Outcome::Serious);
    assert_eq!(verdicts(&made)[5], "not determined");
    let first = &made.findings[0];
    assert_eq!((first.code.as_str(), first.severity), ("undetermined", Severity::Serious));
}

#[test]
fn a_fault_in_the_table_comes_first_and_says_what_to_correct() {
    let made = exchanged();
    assert_eq!(made.outcome, Outcome::Serious);
    insta::assert_snapshot!(made.verdict[2].plain(), @"Correct the table first, then identify again; until then the numbers here are not to be used.");
    assert_eq!(made.sections[0].id, "readings");
}
