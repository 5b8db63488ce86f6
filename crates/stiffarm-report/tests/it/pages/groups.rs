//! Pages of `check`, `route`, `evaluate`, `simulate` and `zones` say what came out and what to do next.

use super::{figures, html, page, saved, scenes, story};
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
    insta::assert_snapshot!(story(&shown), @"
    2 groups of postures were evaluated: what each can tell of the joint stiffness, before anything is measured.
    Best is all: the joint stiffness can be expected with a relative standard error (RMS over the joints) of 3.94 % by noise alone. By noise alone joint 4 is least sure, with a standard error of 7.47 %.
    Measure at these postures, or let stiffarm select find a better plan of as many postures.
    ");
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
    let evaluation = EvaluatedGroup::new(&cell, "all", &first).unwrap().evaluation;
    let error = evaluation.indices.expected_error.unwrap();
    let inverse: f64 = evaluation.scaled_singular_values.iter().map(|s| s.powi(-2)).sum();
    let expected = cell.noise.displacement_std() * (inverse / 6.0).sqrt();
    assert!((expected / error - 1.0).abs() < 1e-9, "{expected} {error}");
    for (i, row) in evaluation.correlation.iter().enumerate() {
        assert_eq!((row.len(), row[i]), (6, 1.0));
        for (j, value) in row.iter().enumerate() {
            assert!((value - evaluation.correlation[j][i]).abs() < 1e-12);
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
    insta::assert_snapshot!(format!("{joints:?}\n{}", story(&shown)), @r#"
    ["joint 1", "joint 2", "joint 3", "joint 4", "joint 5", "joint 6"]
    one with 1 posture was evaluated: what it can tell of the joint stiffness, before anything is measured.
    It cannot determine joint 1, joint 2, joint 3, joint 4, joint 5 and joint 6.
    Add postures that differ, or measuring points: stiffarm check looks for the reason, and stiffarm select chooses postures that determine every joint.
    "#);
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
    let simulation = simulate(&cell, &[group], &options, Control::default()).unwrap();
    let value = serde_json::to_value(&simulation).unwrap();
    assert_eq!(value["groups"][0]["postures_deg"].as_array().unwrap().len(), 6);
    let shown = page(&saved("simulate", None, &value), Some(&cell));
    insta::assert_snapshot!(story(&shown), @"
    30 identifications with fresh tracker noise were simulated for one group of postures at each of 2 noise levels.
    The stiffness that comes out worst, of joint 4, deviates from the truth by 4.46 % ± 0.55 % on average at the cell's own noise; the closed form expects 5.96 %.
    If that is sure enough, measure; if not, stiffarm select finds postures that tell more. Errors beside the tracker's are simulated with --force-error-percent, --joint-angle-error-deg and --loading-point-error-mm.
    ");
    assert_eq!(figures(&shown), ["deviation-by-noise"]);
    assert_eq!(scenes(&shown), 1);
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
    insta::assert_snapshot!(format!("{best:?}\n{}", story(&shown)), @"
    None
    Dexterity and the influence of K_C, what the load adds to the stiffness, were mapped at 225 postures: joint 2 from −60° to 40°, joint 3 from −180° to −40°, with q1 = 0°, q4 = 45°, q5 = 45° and q6 = 45°; 106 of them meet the limits of the cell.
    No posture of the map is both dexterous and little affected by K_C.
    Hold the other joints elsewhere (--q-deg), widen the limits, or choose postures with stiffarm select.
    ");
    assert_eq!(figures(&shown), ["zones"]);
    html(&shown);
}

#[test]
fn a_cell_says_what_it_is_and_what_to_look_at() {
    let mut cell = builtin::cell("comau").unwrap();
    let value = serde_json::to_value(check(&cell).unwrap()).unwrap();
    let shown = page(&saved("check", None, &value), Some(&cell));
    insta::assert_snapshot!(story(&shown), @"
    The cell was looked at in 256 postures spread over its bounds; 67 of them meet its limits.
    The cell can be used; 1 thing to look at. Every pull goes through the anchor, so that some of what gives way is never loaded: after 12 random postures deflections under forces in all directions can be predicted to 0.018 mm, with a weight of 51 kg hung in the same postures as well, 12 minutes more, to 0.011 mm (a second [[load.case]], docs/selecting.md). Where none can be hung, hooking the rope to a second anchor as well, say at [900, 1559, 0] mm, would lead to 9.5 µm and take 22 minutes more.
    Choose the postures to measure with stiffarm select.
    ");
    assert!(html(&shown).contains("towards the anchor (1800, 0, 0) mm"));
    assert_eq!(scenes(&shown), 1);
    // The rope's force goes through the axis of joint 6, and the only measuring point lies on it.
    cell.setup.tool.loading_point.x = 0.0;
    cell.setup.tool.loading_point.y = 0.0;
    cell.setup.tool.measuring_points.truncate(1);
    cell.setup.tool.measuring_points[0].position.x = 0.0;
    cell.setup.tool.measuring_points[0].position.y = 0.0;
    let value = serde_json::to_value(check(&cell).unwrap()).unwrap();
    let shown = page(&saved("check", None, &value), None);
    insta::assert_snapshot!(story(&shown), @"
    The cell was looked at in 256 postures spread over its bounds; 75 of them meet its limits.
    The cell can be used, but not for joint 6; 2 things to look at.
    Choose the postures to measure with stiffarm select.
    ");
    let rows = &shown.parts[0].key.as_ref().unwrap().rows;
    assert_eq!(rows[5][1].plain(), "not determined");
}

#[test]
fn a_route_says_which_moves_are_free() {
    let cell = builtin::cell("comau-shapes").unwrap();
    let group = builtin::postures("comau-group1", &cell.setup.robot).unwrap();
    let angles: Vec<Vec<f64>> = group.into_iter().map(|posture| posture.q).collect();
    let route = route(&cell, &angles, &RouteOptions::default(), Control::default()).unwrap();
    let mut value = serde_json::to_value(&route).unwrap();
    value["posture_names"] = json!(["1", "2", "3", "4", "5", "6"]);
    value["findings"] = json!([]);
    insta::assert_snapshot!(story(&page(&saved("route", None, &value), Some(&cell))), @"
    The order of 6 postures was chosen for the least turning or time.
    5 moves, every one of them free.
    Write the postures in this order with --output plan.csv, and the robot's program with stiffarm export.
    ");
    value["moves"][0]["free"] = json!(false);
    insta::assert_snapshot!(story(&page(&saved("route", None, &value), None)), @"
    The order of 6 postures was chosen for the least turning or time.
    No free way was found for 1 of 5 moves.
    Teach a way of your own for the moves that are not free, or move what is in the way.
    ");
}
