//! Pages of `select` say how good a plan is, against what, and what to do with it.

use super::{figures, page, saved, scenes, story};
use serde_json::{Value, json};
use stiffarm::Control;
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::PostureGroup;
use stiffarm::plan::certificate::{CertificateOptions, certify};
use stiffarm::plan::evaluated::EvaluatedGroup;
use stiffarm::plan::index::{Index, evaluate};
use stiffarm::plan::route::{RouteOptions, route};
use stiffarm::plan::select::{GlobalOptions, LocalOptions, Selection, drop_postures, select, select_from};
use stiffarm_files::builtin;

/// A selection as `select` writes it, with what goes with it.
fn result(cell: &Cell, selection: &Selection, more: Value) -> Value {
    let mut value = serde_json::to_value(selection).unwrap();
    let evaluation = evaluate(cell, "selected", &selection.group).unwrap();
    let count = selection.group.len();
    let names: Vec<String> = (1..=count).map(|i| i.to_string()).collect();
    let mut options = RouteOptions::default();
    options.keep_order = true;
    options.keep_angles = true;
    let route = route(cell, &selection.group, &options, Control::default()).unwrap();
    let with = json!({
        "posture_names": names, "joints": cell.setup.robot.spring_names(), "evaluation": evaluation,
        "repeats": [], "given_names": [], "route": route, "findings": [],
    });
    let all = with.as_object().unwrap().iter().chain(more.as_object().unwrap());
    for (key, one) in all {
        value[key] = one.clone();
    }
    value
}

fn plan(cell: &Cell, index: Index, rounds: u64) -> Selection {
    let mut options = GlobalOptions::default();
    options.rounds = Some(rounds);
    select(cell, index, 4, &options, Control::default()).unwrap()
}

#[test]
fn a_plan_says_how_good_it_is_and_shows_why() {
    let cell = builtin::cell("comau").unwrap();
    let selection = plan(&cell, Index::ExpectedError, 3);
    assert!(!selection.improvements.is_empty());
    for pair in selection.improvements.windows(2) {
        assert!(pair[1].rounds > pair[0].rounds);
        assert!(pair[1].value < pair[0].value);
    }
    let last = selection.improvements.last().and_then(|report| report.value);
    assert!(selection.value <= last.unwrap() * (1.0 + 1e-9));
    let mut options = CertificateOptions::default();
    options.samples = 32;
    let index = selection.index;
    let bound = certify(&cell, index, &selection.group, &options, Control::default()).unwrap();
    let value = result(&cell, &selection, json!({"certificate": bound}));
    let file = saved("select", Some("global"), &value);
    let shown = page(&file, Some(&cell));
    insta::assert_snapshot!(story(&shown), @"
    4 postures were chosen inside the cell's limits by 145 local searches in 3 rounds.
    The joint stiffness can be expected with a relative standard error (RMS over the joints) of 1.15 %. No plan of as many postures can be below 1.14 %: this one reaches 99.1 % of what is possible. By noise alone joint 6 is least sure, with a standard error of 2.41 %.
    Drive to the postures in this order, fill in the sheet for the readings (--sheet measurements.xlsx), and let stiffarm identify give the stiffness.
    ");
    let key = shown.parts[0].key.as_ref().unwrap();
    assert_eq!(key.rows.len(), 4);
    assert!(key.headings.contains(&"room [mm]".to_string()));
    let pictures = figures(&shown);
    for wanted in ["expected-deviation", "convergence", "singular-values", "correlation"] {
        assert!(pictures.iter().any(|id| id == wanted), "{wanted}: {pictures:?}");
    }
    assert_eq!(scenes(&shown), 1);
    // Without the cell only its pictures are missing.
    let without = page(&file, None);
    assert_eq!(figures(&without), pictures);
    assert_eq!(scenes(&without), 0);
}

#[test]
fn a_move_that_is_not_free_comes_before_everything_else() {
    let cell = builtin::cell("comau").unwrap();
    let selection = plan(&cell, Index::ExpectedError, 1);
    let finding = json!({"code": "move-blocked", "severity": "serious", "subject": "move 1 to 2",
        "sentence": "The way is not free."});
    let value = result(&cell, &selection, json!({"findings": [finding]}));
    let shown = page(&saved("select", Some("global"), &value), None);
    insta::assert_snapshot!(story(&shown), @"
    4 postures were chosen inside the cell's limits by 49 local searches.
    The joint stiffness can be expected with a relative standard error (RMS over the joints) of 1.15 %. By noise alone joint 6 is least sure, with a standard error of 2.41 %.
    Teach a way of your own for the moves that are not free, listed below, before driving; then measure.
    ");
    assert_eq!(shown.parts[0].warnings.len(), 1);
}

#[test]
fn a_plan_from_an_initial_group_is_compared_with_it() {
    let cell = builtin::cell("comau").unwrap();
    let first = builtin::postures("comau-group1", &cell.setup.robot).unwrap();
    let mut options = LocalOptions::default();
    options.max_iterations = 20;
    let index = Index::ExpectedError;
    let selection = select_from(&cell, index, &first, options, Control::default()).unwrap();
    let before = EvaluatedGroup::new(&cell, "initial", &first).unwrap();
    let value = result(&cell, &selection, json!({"before": before}));
    let shown = page(&saved("select", Some("from"), &value), Some(&cell));
    insta::assert_snapshot!(story(&shown), @"
    The initial group of 6 postures was improved, as in the paper, by a local search inside the cell's limits.
    The joint stiffness can be expected with a relative standard error (RMS over the joints) of 3.94 %, against 3.94 % with the initial group. By noise alone joint 4 is least sure, with a standard error of 7.47 %.
    Drive to the postures in this order, fill in the sheet for the readings (--sheet measurements.xlsx), and let stiffarm identify give the stiffness.
    ");
    assert!(!figures(&shown).contains(&"convergence".to_string()));
}

#[test]
fn a_plan_that_is_too_unsure_says_so() {
    let mut cell = builtin::cell("comau").unwrap();
    let selection = plan(&cell, Index::ExpectedError, 1);
    cell.noise.reading_variance *= 1e5;
    let value = result(&cell, &selection, json!({}));
    insta::assert_snapshot!(story(&page(&saved("select", Some("global"), &value), None)), @"
    4 postures were chosen inside the cell's limits by 49 local searches.
    The joint stiffness can be expected with a relative standard error (RMS over the joints) of 1.15 %. By noise alone joint 6 is least sure, with a standard error of 762 %.
    That is too unsure to rely on: add postures (--count) or measuring points, pull harder or elsewhere, and look at what each limit costs (--prices).
    ");
}

#[test]
fn a_cell_without_prior_stiffness_has_a_page() {
    let mut cell = builtin::cell("comau").unwrap();
    cell.prior = None;
    let selection = plan(&cell, Index::Condition, 1);
    let value = result(&cell, &selection, json!({}));
    let shown = page(&saved("select", Some("global"), &value), Some(&cell));
    insta::assert_snapshot!(story(&shown), @"
    4 postures were chosen inside the cell's limits by 97 local searches. This index has many local minima: another --seed may find a better plan.
    The condition number of the observation matrix is 6.244.
    Drive to the postures in this order, fill in the sheet for the readings (--sheet measurements.xlsx), and let stiffarm identify give the stiffness.
    ");
    let pictures = figures(&shown);
    assert!(!pictures.contains(&"expected-deviation".to_string()));
    assert!(pictures.contains(&"singular-values".to_string()));
}

#[test]
fn postures_left_out_are_named_with_their_loss() {
    let cell = builtin::cell("comau").unwrap();
    let first = builtin::postures("comau-group1", &cell.setup.robot).unwrap();
    let index = Index::ExpectedError;
    let dropped = drop_postures(&cell, index, &first, 1, Control::default()).unwrap();
    let mut value = serde_json::to_value(&dropped).unwrap();
    let group = PostureGroup { name: "given".to_string(), postures: first };
    let names: Vec<&str> = group.postures.iter().map(|p| p.name.as_str()).collect();
    let degrees = |q: &Vec<f64>| q.iter().map(|q| q.to_degrees()).collect::<Vec<f64>>();
    let angles: Vec<Vec<f64>> = group.postures.iter().map(|p| degrees(&p.q)).collect();
    value["posture_names"] = json!(names);
    value["postures_deg"] = json!(angles);
    value["findings"] = json!([]);
    let shown = page(&saved("select", Some("drop"), &value), Some(&cell));
    insta::assert_snapshot!(story(&shown), @"
    Of 6 given postures, every way of leaving out 1 was compared.
    The joint stiffness can be expected with a relative standard error (RMS over the joints) of 4.07 % without 3, against 3.94 % with all 6.
    Measure the other 5, where that loss is worth the time saved; else keep them all.
    ");
    let rows = shown.parts[0].key.as_ref().unwrap().rows.iter();
    let left_out: Vec<String> = rows.filter(|row| row[3].plain() == "leave out").map(|row| row[0].plain()).collect();
    assert_eq!(left_out, [group.postures[dropped.dropped[0]].name.clone()]);
}

#[test]
fn a_curve_says_how_many_postures_are_enough() {
    let size = |postures: usize, value: Option<f64>, gain: Option<f64>| {
        json!({"postures": postures, "value": value, "expected_error": value, "rounds": 1,
               "evaluations": 1, "gain": gain, "bound": 0.01, "efficiency": null})
    };
    let sizes = [
        size(1, None, None),
        size(2, Some(0.08), Some(0.5)),
        size(3, Some(0.04), Some(0.25)),
        size(4, Some(0.03), Some(0.05)),
        size(5, Some(0.0285), None),
    ];
    let value = json!({"index": "expected_error", "largest": 5, "sizes": sizes, "certificate_missing": null,
                       "findings": []});
    let shown = page(&saved("select", Some("curve"), &value), None);
    insta::assert_snapshot!(story(&shown), @"
    The best plan was searched for every number of postures from 1 to 5. –: so few postures cannot determine every joint.
    The index expected error goes from 8.00 % with 2 postures to 2.85 % with 5 postures.
    Beyond 4 postures one more gains less than a tenth: plan with --count 4 unless the error is still too large.
    ");
    assert_eq!(figures(&shown), ["count"]);
}
