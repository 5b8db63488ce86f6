//! Pages of `check`, `route`, `evaluate`, `simulate` and `zones`.

use super::{figures, html, page, saved, story};
use serde_json::json;
use stiffarm::Control;
use stiffarm::estimate::simulate::{SimulationOptions, simulate};
use stiffarm::model::posture::PostureGroup;
use stiffarm::plan::characteristic_length::with_characteristic_length;
use stiffarm::plan::check::check;
use stiffarm::plan::evaluated::EvaluatedGroup;
use stiffarm::plan::route::{RouteOptions, route};
use stiffarm::plan::zones::{ZoneOptions, zones};
use stiffarm_files::builtin;

#[test]
fn groups_are_compared_and_the_best_is_named() {
    let cell = with_characteristic_length(builtin::cell("comau").unwrap()).unwrap();
    let first = builtin::postures("comau-group1", &cell.setup.robot).unwrap();
    let all = EvaluatedGroup::new(&cell, "all", &first).unwrap();
    let few = EvaluatedGroup::new(&cell, "few", &first[..3]).unwrap();
    let value = json!({"joints": cell.setup.robot.spring_names(), "groups": [few, &all], "findings": []});
    let shown = page(&saved("evaluate", None, &value), Some(&cell));
    let [_, came, _] = story(&shown);
    assert!(came.starts_with("Best is all:"), "{came}");
    let pictures = figures(&shown);
    assert!(pictures.contains(&"novel-index".to_string()), "{pictures:?}");
    let text = html(&shown);
    let error = json!(all.evaluation.indices.expected_error);
    assert!(text.contains(&format!("data-value=\"{error}\"")));
}

/// What the picture of the singular values says: n·error² = σ²·Σ 1/s².
#[test]
fn singular_values_and_correlations_belong_to_the_expected_errors() {
    let cell = builtin::cell("comau").unwrap();
    let first = builtin::postures("comau-group1", &cell.setup.robot).unwrap();
    let found = EvaluatedGroup::new(&cell, "all", &first).unwrap().evaluation;
    let error = found.indices.expected_error.unwrap();
    let inverse: f64 = found.scaled_singular_values.iter().map(|s| s.powi(-2)).sum();
    let expected = cell.noise.displacement_std() * (inverse / 6.0).sqrt();
    assert!((expected / error - 1.0).abs() < 1e-9, "{expected} {error}");
    for (i, row) in found.correlation.iter().enumerate() {
        assert_eq!((row.len(), row[i]), (6, 1.0));
        for (j, value) in row.iter().enumerate() {
            assert!((value - found.correlation[j][i]).abs() < 1e-12);
            assert!(value.abs() <= 1.0);
        }
    }
}

#[test]
fn a_group_that_leaves_a_joint_undetermined_says_so() {
    let mut cell = builtin::cell("comau").unwrap();
    cell.setup.tool.measuring_points.truncate(1);
    let first = builtin::postures("comau-group1", &cell.setup.robot).unwrap();
    let one = EvaluatedGroup::new(&cell, "one", &first[..1]).unwrap();
    let joints = one.evaluation.undetermined_joints.clone();
    assert!(!joints.is_empty());
    let value = json!({"joints": cell.setup.robot.spring_names(), "groups": [one], "findings": []});
    let shown = page(&saved("evaluate", None, &value), None);
    let [_, came, next] = story(&shown);
    assert!(came.contains(&joints[0]), "{came}");
    assert!(next.contains("stiffarm check"), "{next}");
}

#[test]
fn simulated_groups_are_shown_in_the_cell_and_against_noise() {
    let cell = builtin::cell("comau").unwrap();
    let group = PostureGroup {
        name: "Group 1".to_string(),
        postures: builtin::postures("comau-group1", &cell.setup.robot).unwrap(),
    };
    let mut options = SimulationOptions::default();
    options.variance_factors = vec![0.5, 1.0];
    options.runs = 30;
    let found = simulate(&cell, &[group], &options, Control::default()).unwrap();
    let value = serde_json::to_value(&found).unwrap();
    assert_eq!(value["groups"][0]["postures_deg"].as_array().unwrap().len(), 6);
    let shown = page(&saved("simulate", None, &value), Some(&cell));
    let [done, came, _] = story(&shown);
    assert!(done.starts_with("30 identifications"), "{done}");
    assert!(came.contains("at the cell's own noise"), "{came}");
    assert_eq!(figures(&shown), ["deviation-by-noise"]);
    assert!(html(&shown).contains("<div class=\"scene\""));
}

#[test]
fn zones_say_where_to_measure() {
    let cell = with_characteristic_length(builtin::cell("comau").unwrap()).unwrap();
    let mut options = ZoneOptions::default();
    options.steps = 15;
    let maps = zones(&cell, &options, Control::default()).unwrap();
    let best = maps.best.clone();
    let value = serde_json::to_value(&maps).unwrap();
    let shown = page(&saved("zones", None, &value), Some(&cell));
    let [_, came, _] = story(&shown);
    assert_eq!(came.starts_with("The best zone"), best.is_some(), "{came}");
    assert_eq!(figures(&shown), ["zones"]);
    html(&shown);
}

#[test]
fn a_cell_says_what_it_is_and_what_to_look_at() {
    let mut cell = builtin::cell("comau").unwrap();
    let value = serde_json::to_value(check(&cell).unwrap()).unwrap();
    let shown = page(&saved("check", None, &value), Some(&cell));
    let [done, came, next] = story(&shown);
    assert!(done.contains("postures spread over its bounds"), "{done}");
    assert!(came.starts_with("The cell can be used"), "{came}");
    assert!(next.contains("stiffarm select"), "{next}");
    let text = html(&shown);
    assert!(text.contains("towards the anchor (1800, 0, 0) mm"));
    assert!(text.contains("<div class=\"scene\""));
    // The rope's force goes through the axis of joint 6, and the only measuring point lies on it.
    cell.setup.tool.loading_point.x = 0.0;
    cell.setup.tool.loading_point.y = 0.0;
    cell.setup.tool.measuring_points.truncate(1);
    cell.setup.tool.measuring_points[0].position.x = 0.0;
    cell.setup.tool.measuring_points[0].position.y = 0.0;
    let value = serde_json::to_value(check(&cell).unwrap()).unwrap();
    let shown = page(&saved("check", None, &value), None);
    let [_, came, _] = story(&shown);
    assert!(came.starts_with("The cell can be used, but not for joint 6"), "{came}");
    let rows = &shown.parts[0].key.as_ref().unwrap().rows;
    assert_eq!(rows[5][1].plain(), "not determined");
}

#[test]
fn a_route_says_which_moves_are_free() {
    let cell = builtin::cell("comau-shapes").unwrap();
    let group = builtin::postures("comau-group1", &cell.setup.robot).unwrap();
    let angles: Vec<Vec<f64>> = group.into_iter().map(|posture| posture.q).collect();
    let found = route(&cell, &angles, &RouteOptions::default(), Control::default()).unwrap();
    let mut value = serde_json::to_value(&found).unwrap();
    value["posture_names"] = json!(["1", "2", "3", "4", "5", "6"]);
    value["findings"] = json!([]);
    let [_, came, next] = story(&page(&saved("route", None, &value), Some(&cell)));
    assert_eq!(came, "5 moves, every one of them free.");
    assert!(next.contains("stiffarm export"), "{next}");
    value["moves"][0]["free"] = json!(false);
    let [_, came, next] = story(&page(&saved("route", None, &value), None));
    assert_eq!(came, "No free way was found for 1 of 5 moves.");
    assert!(next.starts_with("Teach a way of your own"), "{next}");
}
