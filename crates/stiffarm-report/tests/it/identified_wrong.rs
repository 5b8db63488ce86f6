//! Pages of results that are wrong, half made, or beside others.

use super::identified::{group, identified, measured, saved};
use serde_json::{Value, json};
use stiffarm::estimate::compliance::IdentifiedCompliance;
use stiffarm::estimate::validate::validate_with;
use stiffarm::files::result::SavedResult;
use stiffarm::measure::prepare;
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::ReadingTarget;
use stiffarm::model::stiffness::Model;
use stiffarm_report::page::{Block, Outcome, Page, Part, Piece, Section, Text, render_page};
use stiffarm_report::report::{Given, report};
use stiffarm_report::validated::validation_figure;

/// What `identify` makes of good readings.
fn good() -> (Cell, Value) {
    let cell = Cell::built_in("comau").unwrap();
    let result = identified(&cell, &measured(&cell, &group(&cell)));
    (cell, result)
}

fn finding(code: &str, severity: &str, sentence: &str) -> Value {
    json!({"code": code, "severity": severity, "subject": "readings", "sentence": sentence})
}

/// The same with one suspicion of the screening, and cautions of the fit.
fn suspected(mut result: Value, cause: &str, severity: &str, sentence: &str) -> Value {
    let suspicion = json!({
        "cause": cause, "postures": ["2"], "states": ["up-1"], "points": ["3"], "joints": ["joint 4"],
        "lines": [64, 69], "repeat": null, "before_m": null, "after_m": null, "off_m": 5e-4, "factor": null,
        "angles_deg": [], "alternatives": [], "certain": true
    });
    let sanity = &mut result["readings"]["sanity"];
    sanity["suspicions"] = json!([suspicion]);
    sanity["findings"] = json!([finding(cause, severity, sentence)]);
    for (i, place) in ["budget", "diagnosis", "diagnosis", "budget", "budget"]
        .into_iter()
        .enumerate()
    {
        let own = finding("of-the-fit", "caution", &format!("Of the fit {i}."));
        result[place]["findings"].as_array_mut().unwrap().push(own);
    }
    result
}

fn page(saved: &SavedResult) -> Page {
    report(&[Given { saved, cell: None }]).unwrap()
}

fn one(result: Value) -> Part {
    page(&saved("identify", result)).parts.remove(0)
}

fn sentences(part: &Part) -> Vec<&str> {
    part.warnings.iter().map(|f| f.sentence.as_str()).collect()
}

fn section<'a>(part: &'a Part, id: &str) -> Option<&'a Section> {
    part.sections.iter().find(|section| section.id == id)
}

/// Last cells of the key table.
fn verdicts(part: &Part) -> Vec<String> {
    let rows = part.key.as_ref().unwrap().rows.iter();
    rows.map(|row| row.last().unwrap().plain()).collect()
}

#[test]
fn what_is_wrong_with_the_readings_stands_before_what_the_fit_says() {
    let (_, result) = good();
    let part = one(suspected(
        result,
        "stray_repeat",
        "caution",
        "They lie apart.",
    ));
    let said = sentences(&part);
    assert_eq!(said[0], "They lie apart.");
    let at = |words: &str| said.iter().position(|s| *s == words).unwrap();
    // The diagnosis before the budget, as in the terminal.
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
    let (_, result) = good();
    let sentence =
        "The loads look like kilograms (kgf): factor 9.81. As typed, nothing fits. Check load_n.";
    let part = one(suspected(result, "load_units", "serious", sentence));
    assert_eq!(part.outcome, Outcome::Serious);
    let [_, came, next] = part.verdict.each_ref().map(Text::plain);
    assert_eq!(
        came,
        "The stiffness cannot be used. The loads look like kilograms (kgf): factor 9.81."
    );
    assert!(
        next.starts_with("Correct the table first (lines 64 and 69)"),
        "{next}"
    );
    for verdict in verdicts(&part) {
        assert_eq!(verdict, "settle what is wrong first");
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
    let (_, mut result) = good();
    let ends = json!([4472.0, null]);
    result["joints"][4]["verdict"] = json!("lower_bound_only");
    result["joints"][4]["interval"] = ends.clone();
    result["joints"][4]["readings_interval"] = json!([4290.0, null]);
    result["budget"]["uncertainty"][4]["interval_nm_per_rad"] = ends;
    let part = one(result);
    assert_eq!(
        verdicts(&part)[4],
        "only a lower bound: above 0.00447\u{a0}MN·m/rad"
    );
    let came = part.verdict[1].plain();
    assert!(
        came.contains("joint 5: only a lower bound, 0.00447\u{a0}MN·m/rad."),
        "{came}"
    );
}

#[test]
fn without_a_budget_the_page_says_what_was_not_examined() {
    let (_, mut result) = good();
    result["budget"] = Value::Null;
    let removed = one(result.clone());
    result["diagnosis"] = Value::Null;
    let envelope = json!({
        "format": 1, "stiffarm": "0.1.0", "command": "identify", "inputs": {}, "seed": 1,
        "options": {"exclude": [], "brief": true}, "result": result
    });
    let brief = page(&SavedResult::of(&envelope, "brief").unwrap());
    let brief = &brief.parts[0];
    for part in [&removed, brief] {
        assert_eq!(part.outcome, Outcome::Caution);
        let came = part.verdict[1].plain();
        assert!(
            came.contains("Systematic errors were not examined."),
            "{came}"
        );
        assert!(came.contains("the scatter of the readings alone"), "{came}");
        let codes = part.warnings.iter().map(|f| f.code.as_str());
        assert!(codes.collect::<Vec<_>>().contains(&"no-systematic-errors"));
    }
    let next = brief.verdict[2].plain();
    assert!(next.starts_with("Identify again without --brief"), "{next}");
}

#[test]
fn bars_stand_only_where_there_are_values() {
    let cell = Cell::built_in("comau").unwrap();
    let mut readings = stiffarm::simulated_readings(&cell, &group(&cell), 1).unwrap();
    let states = readings.postures[1].states.iter_mut();
    for reading in states.flat_map(|state| &mut state.readings) {
        reading.target = match reading.target.clone() {
            ReadingTarget::Point(0) => ReadingTarget::Point(2),
            ReadingTarget::Point(2) => ReadingTarget::Point(0),
            other => other,
        };
    }
    let measured = prepare(&cell, readings, &Default::default()).unwrap();
    let part = one(identified(&cell, &measured));
    let came = part.verdict[1].plain();
    assert!(
        came.starts_with("The stiffness cannot be used. Posture 2: points"),
        "{came}"
    );
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
fn results_beside_each_other_say_how_each_came_out_and_who_differs() {
    let (_, result) = good();
    let mut other = result.clone();
    let stiffness = other["joints"][2]["stiffness"].as_f64().unwrap();
    other["joints"][2]["stiffness"] = json!(1.5 * stiffness);
    let wrong = suspected(result.clone(), "load_units", "serious", "Kilograms.");
    let total = other["budget"]["uncertainty"][0]["total"].as_f64().unwrap();
    other["budget"]["uncertainty"][0]["total"] = json!(total + 0.02);
    let mut given: Vec<SavedResult> = [result, other, wrong.clone(), wrong]
        .into_iter()
        .map(|result| saved("identify", result))
        .collect();
    for (one, name) in given
        .iter_mut()
        .zip(["a.json", "b.json", "c.json", "d.json"])
    {
        one.name = name.to_string();
    }
    let all: Vec<Given<'_>> = given
        .iter()
        .map(|saved| Given { saved, cell: None })
        .collect();
    let page = report(&all).unwrap();
    let comparison = page.comparison.as_ref().unwrap();
    let [_, came, next] = comparison.verdict.each_ref().map(Text::plain);
    assert!(came.contains("joint\u{a0}3 differs by 50 %"), "{came}");
    assert!(came.contains("(b.json against a.json)"), "{came}");
    assert!(
        next.starts_with("Do not use c.json and d.json as they are"),
        "{next}"
    );
    let tables = comparison.sections.iter().flat_map(|s| &s.blocks);
    let tables: Vec<_> = tables
        .filter_map(|block| match block {
            Block::Table(table) => Some(table),
            _ => None,
        })
        .collect();
    let results = tables
        .iter()
        .find(|t| t.caption == "What came out")
        .unwrap();
    assert_eq!(results.rows[2][1].plain(), "✗\u{a0}Not usable as it is");
    assert!(matches!(&results.rows[2][0].0[0], Piece::Link(_, anchor) if anchor == "r2"));
    assert!(render_page(&page).contains("<a href=\"#r2\">c.json</a>"));
    let numbers = tables.iter().find(|t| t.headings[0] == "number").unwrap();
    assert_eq!(
        numbers.headings[5..],
        [
            "difference of b.json",
            "difference of c.json",
            "difference of d.json"
        ]
    );
    let rows: Vec<String> = numbers.rows.iter().map(|row| row[0].plain()).collect();
    assert!(
        rows[..6].iter().all(|row| row.contains("· k [")),
        "{rows:?}"
    );
    assert_eq!(numbers.rows[2][5].plain(), "+50.0 % beyond ±");
    assert_eq!(numbers.rows[2][6].plain(), "same");
    let row = &numbers.rows[6];
    assert_eq!(row[0].plain(), "joint\u{a0}1 · ± total [%]");
    assert_eq!(row[5].plain(), "+2.0\u{a0}points");
}

#[test]
fn bars_of_a_validation_are_named_by_what_tells_them_apart() {
    let cell = Cell::built_in("comau").unwrap();
    let prior = IdentifiedCompliance::from_stiffness(&cell, cell.require_prior().unwrap()).unwrap();
    let figure = |count: usize| {
        let measured = measured(&cell, &group(&cell)[..count]);
        let found = validate_with(&cell, &prior, &measured, Model::Linear, None).unwrap();
        validation_figure(&found)
    };
    let one = figure(1);
    let x = &one.panels[0].x;
    assert_eq!(x.label, "load state · measuring point");
    assert_eq!(x.categories.len(), 12);
    assert!(x.categories[1].ends_with(" · 2"), "{:?}", x.categories);
    assert!(one.caption.contains(", posture 1,"), "{}", one.caption);
    // Too many for a name each.
    let all = figure(6);
    assert_eq!(all.panels[0].x.label, "posture");
    assert_eq!(all.panels[0].x.categories.len(), 6);
    assert_eq!(all.panels[0].series[0].x.len(), 72);
}
