//! Pages of identify and validate say what came out, with numbers and arrows that are those of the file.

use crate::common::{good, group, measured, numbers_of_the_file, saved, saved_with, story};
use crate::summary::suspected;
use serde_json::{Value, json};
use stiffarm::estimate::clamped::{ClampedSimulation, MotorMove, identify_clamped, simulate_clamped};
use stiffarm::estimate::compliance::IdentifiedCompliance;
use stiffarm::estimate::identify::{Fit, Identification, IdentifyOptions};
use stiffarm::estimate::validate::{cross_validate, validate_with};
use stiffarm::model::cell::Cell;
use stiffarm::model::stiffness::Model;
use stiffarm_files::builtin;
use stiffarm_files::result::SavedResult;
use stiffarm_report::identified::residual_figure;
use stiffarm_report::page::{Block, Outcome, Page, Piece, render_page};
use stiffarm_report::report::{WithCell, report};
use stiffarm_report::validated::validation_figure;

fn page(saved: &SavedResult, cell: Option<&Cell>) -> Page {
    report(&[WithCell::new(saved, cell)]).unwrap()
}

#[test]
fn good_readings_tell_which_joints_are_known_and_that_the_rest_is_noise() {
    let cell = builtin::cell("comau").unwrap();
    let result = saved("identify", good());
    let made = page(&result, Some(&cell));
    insta::assert_snapshot!(story(&made.parts[0].verdict), @"
    The stiffness of 6 joints was identified from raw readings of the tracker at 6 postures: 72 displacements (216 components).
    The stiffness is known to ± 2.3 % (joint 1) to ± 24 % (joint 4) at 95 % confidence, readings and systematic errors together. Weak, above ± 10 %: joint 4 and joint 6. What the fit leaves looks like noise: a standard deviation of 0.0137 mm against 0.0136 mm expected.
    Validate on postures that took no part: stiffarm validate compares what this stiffness predicts with what is measured there.
    ");
    assert!(numbers_of_the_file(&made, &result) >= 70);
    let html = render_page(&made);
    assert_eq!(html, render_page(&page(&result, Some(&cell))));
    for id in ["joint-stiffness", "residuals", "systematic-errors", "correlations", "load-states", "influence"] {
        let has = made.parts[0].sections.iter().flat_map(|s| &s.blocks);
        let has = has.filter(|b| matches!(b, Block::Figure(figure) if figure.id == id));
        assert_eq!(has.count(), 1, "{id}");
    }
}

#[test]
fn arrows_stand_at_the_measuring_points_and_are_the_residuals() {
    let cell = builtin::cell("comau").unwrap();
    let result = saved("identify", good());
    let made = page(&result, Some(&cell));
    let mut blocks = made.parts[0].sections.iter().flat_map(|s| &s.blocks);
    let scene = blocks.find_map(|block| match block {
        Block::Scene(scene, _) => Some(scene),
        _ => None,
    });
    let scene = scene.expect("the cell is at hand");
    let arrows = &scene.arrows.as_ref().unwrap().arrows;
    assert_eq!(arrows.len(), 6 * 4);
    let postures = result.json["result"]["postures"].as_array().unwrap();
    for arrow in arrows {
        let name = &scene.groups[0].postures[arrow.posture].name;
        // The state that moves most.
        let states = postures.iter().filter(|p| p["posture"] == **name);
        let size = |p: &&Value| p["displacement_rms_m"].as_f64().unwrap();
        let most = states.max_by(|a, b| size(a).total_cmp(&size(b))).unwrap();
        let mut residuals = most["residuals"].as_array().unwrap().iter();
        let residual = residuals.find(|r| r["point"] == *arrow.name).unwrap();
        for i in 0..3 {
            let value = residual["residual_m"][i].as_f64().unwrap();
            assert!((arrow.vector[i] - value).abs() < 1e-3 * value.abs() + 1e-9);
        }
    }
}

#[test]
fn readings_of_a_point_that_no_list_has_are_in_no_category() {
    let cell = builtin::cell("comau").unwrap();
    let fit = Fit::new(&cell, measured(&cell, &group(&cell)), &IdentifyOptions::default()).unwrap();
    let mut identification = fit.identification().unwrap().clone();
    let shown = |identification: &Identification| -> Vec<usize> {
        residual_figure(identification).panels[0].series.iter().map(|series| series.x.len()).collect()
    };
    let before = shown(&identification);
    identification.postures[0].residuals[1].point = "elsewhere".into();
    let after = shown(&identification);
    assert_eq!(after[1], before[1] - 3);
    assert_eq!((after[0], &after[2..]), (before[0], &before[2..]));
}

#[test]
fn residuals_are_measured_minus_calculated() {
    let cell = builtin::cell("comau").unwrap();
    let measured = measured(&cell, &group(&cell));
    let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let identification = fit.identification().unwrap();
    let mut sum = 0.0;
    for posture in &identification.postures {
        assert_eq!(posture.angles.len(), 6);
        assert_eq!(posture.residuals.len(), 4);
        let squares = posture.residuals.iter().flat_map(|r| r.residual_m).map(|c| c * c);
        let squares: f64 = squares.sum();
        assert!(((squares / 12.0).sqrt() - posture.residual_rms_m).abs() < 1e-12);
        sum += squares;
    }
    assert!(((sum / identification.estimates.rows as f64).sqrt() - identification.residual_rms_m).abs() < 1e-12);
    assert_eq!(Some(&identification.prior_stiffness), cell.prior.as_ref());
}

/// A validation as its command writes it.
fn validated(result: Value) -> SavedResult {
    saved_with("validate", json!({"model": "linear", "only": []}), result)
}

#[test]
fn validation_says_how_far_calculated_and_measured_differ() {
    let cell = builtin::cell("comau").unwrap();
    let measured = measured(&cell, &group(&cell));
    let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let folds = cross_validate(&fit, 6, Some(1e-6)).unwrap();
    let result = validated(json!(folds));
    let made = page(&result, Some(&cell));
    insta::assert_snapshot!(story(&made.parts[0].verdict), @"
    72 displacements at 6 postures were each predicted by a fit without it, in 6 folds of postures under the loads that were measured, and compared with what was measured there, Eq. (22).
    Calculated and measured differ by 0.0221 mm (RMS), at most 0.0437 mm: 1.2 % of the displacements. Noise alone gives 0.0217 mm on average. 212 of 216 components lie inside the 95 % band of calculation and noise. Compensated as calculated, the errors would have been at least 185 times smaller, the noise of these readings aside. The RMS of the components, to be held beside the residual RMS of the identification, is 0.0128 mm. The tolerance of 0.0010 mm is not kept.
    No stiffness can keep this tolerance in such readings: by noise alone they deviate by 0.0217 mm on average. Ask for a larger one, or read each point more often.
    ");
    assert_eq!(made.parts[0].outcome, Outcome::Serious);
    assert!(numbers_of_the_file(&made, &result) >= 100);
    let arrows = made.parts[0].sections.iter().find(|section| section.id == "cell").unwrap();
    let Some(Block::Text(arrows)) = arrows.blocks.first() else { panic!("{:?}", arrows.blocks) };
    assert!(arrows.plain().contains("the one with the largest deviation is shown"), "{}", arrows.plain());

    let prior = IdentifiedCompliance::from_stiffness(&cell, cell.require_prior().unwrap()).unwrap();
    let validation = validate_with(&cell, &prior, &measured, Model::Equilibrium, None).unwrap();
    assert_eq!(validation.postures.len(), 18);
    let made = page(&validated(json!(validation)), None);
    assert_eq!(made.parts[0].outcome, Outcome::Good);
    insta::assert_snapshot!(story(&made.parts[0].verdict), @"
    72 displacements at 6 postures were calculated from the saved stiffness with the exact equilibrium, and compared with what was measured there, Eq. (22).
    Calculated and measured differ by 0.0215 mm (RMS), at most 0.0384 mm: 1.1 % of the displacements. Noise alone gives 0.0217 mm on average. Compensated as calculated, the errors would have been at least 185 times smaller, the noise of these readings aside.
    The stiffness can be worked with: stiffarm predict says how far the loaded tool bends away, stiffarm compensate gives the path to command instead.
    ");
}

#[test]
fn a_clamped_arm_has_a_page_of_angles() {
    let cell = builtin::cell("comau").unwrap();
    let truth = cell.require_prior().unwrap();
    let torque = [900.0, -1200.0, 700.0, 300.0, -250.0, 200.0];
    let motor: Vec<f64> = torque.iter().zip(truth).map(|(t, k)| t / k).collect();
    let moves = [("up-1", 1.0), ("down-1", 0.99)]
        .map(|(state, by)| MotorMove { state: state.to_string(), motor: motor.iter().map(|q| by * q).collect() });
    let simulation = ClampedSimulation {
        moves: moves.to_vec(),
        angle_std: 1e-6,
        force_std: 0.1,
        moment_std: 0.05,
        ..ClampedSimulation::default()
    };
    let postures = group(&cell);
    let clamped = simulate_clamped(&cell, &postures, truth, &simulation, 7, 0).unwrap();
    let identification = identify_clamped(&cell, &clamped, None, &IdentifyOptions::default()).unwrap();
    let result = saved("identify", json!(identification));
    let made = page(&result, Some(&cell));
    insta::assert_snapshot!(story(&made.parts[0].verdict), @"
    With the flange fixed, the stiffness of 6 joints was identified from motor angles and wrenches at 6 postures in 12 load states (72 combinations of angles), without a tracker.
    The stiffness is known to ± 0.041 % (joint 6) to ± 0.20 % (joint 3) at 95 % confidence, the scatter of the readings alone. The fit leaves 0.0513 mdeg of angles of 59.1 mdeg (0.087 %) that the flange holds (RMS).
    The ± holds the scatter of the angles alone. Compare with displacements under load: stiffarm validate with the flange free shows what the fixture and friction have changed.
    ");
    assert!(numbers_of_the_file(&made, &result) >= 30);
}

#[test]
fn results_beside_each_other_say_how_each_came_out_and_who_differs() {
    let result = good();
    let mut other = result.clone();
    let joint = &mut other["joints"][2];
    let value = |key: &Value| key.as_f64().unwrap();
    joint["stiffness"] = json!(1.5 * value(&joint["stiffness"]));
    joint["compliance"] = json!(value(&joint["compliance"]) / 1.5);
    for i in 0..2 {
        joint["interval"][i] = json!(1.5 * value(&joint["interval"][i]));
    }
    let wrong = suspected(result.clone(), "load_units", "serious", "Kilograms.");
    let total = other["systematic_errors"]["uncertainty"][0]["total"].as_f64().unwrap();
    other["systematic_errors"]["uncertainty"][0]["total"] = json!(total + 0.02);
    let mut files: Vec<SavedResult> =
        [result, other, wrong.clone(), wrong].into_iter().map(|result| saved("identify", result)).collect();
    for (one, name) in files.iter_mut().zip(["a.json", "b.json", "c.json", "d.json"]) {
        one.name = name.to_string();
    }
    let all: Vec<WithCell<'_>> = files.iter().map(|saved| WithCell::new(saved, None)).collect();
    let page = report(&all).unwrap();
    let comparison = page.comparison.as_ref().unwrap();
    insta::assert_snapshot!(story(&comparison.verdict), @"
    a.json, b.json, c.json and d.json are compared: 4 results of identify. They were made in the same way.
    The stiffness of joint 3 differs by 50 %, beyond the 11 % that the errors of both explain (b.json against a.json): they contradict each other. 2 of 24 numbers of the key tables differ.
    Do not use c.json and d.json as they are: the verdicts of their parts say why and what to do.
    ");
    let tables = comparison.sections.iter().flat_map(|s| &s.blocks);
    let tables: Vec<_> = tables
        .filter_map(|block| match block {
            Block::Table(table) => Some(table),
            _ => None,
        })
        .collect();
    let results = tables.iter().find(|t| t.caption == "What came out").unwrap();
    assert_eq!(results.rows[2][1].plain(), "✗\u{a0}Not usable as it is");
    assert!(matches!(&results.rows[2][0].0[0], Piece::Link(_, anchor) if anchor == "r2"));
    assert!(render_page(&page).contains("<a href=\"#r2\">c.json</a>"));
    let numbers = tables.iter().find(|t| t.headings[0] == "number").unwrap();
    assert_eq!(numbers.headings[5..], ["difference of b.json", "difference of c.json", "difference of d.json"]);
    let rows: Vec<String> = numbers.rows.iter().map(|row| row[0].plain()).collect();
    assert_eq!(rows[..6], [1, 2, 3, 4, 5, 6].map(|joint| format!("joint\u{a0}{joint} · k [10⁶ N·m/rad]")));
    assert_eq!(numbers.rows[2][5].plain(), "+50.0 % beyond ±");
    assert_eq!(numbers.rows[2][6].plain(), "same");
    let row = &numbers.rows[6];
    assert_eq!(row[0].plain(), "joint\u{a0}1 · ± total [%]");
    assert_eq!(row[5].plain(), "+2.0\u{a0}points");
}

#[test]
fn bars_of_a_validation_are_named_by_what_tells_them_apart() {
    let cell = builtin::cell("comau").unwrap();
    let prior = IdentifiedCompliance::from_stiffness(&cell, cell.require_prior().unwrap()).unwrap();
    let figure = |count: usize| {
        let measured = measured(&cell, &group(&cell)[..count]);
        let validation = validate_with(&cell, &prior, &measured, Model::Linear, None).unwrap();
        validation_figure(&validation)
    };
    let one = figure(1);
    let x = &one.panels[0].x;
    assert_eq!(x.label, "load state · measuring point");
    assert_eq!(x.categories.len(), 12);
    assert!(x.categories[1].ends_with(" · 2"), "{:?}", x.categories);
    insta::assert_snapshot!(one.caption, @"Deviation of calculated from measured displacement, Eq. (22), at each measuring point, posture 1, with what noise alone gives on average; and size of the displacement, calculated over measured: on the line the two agree.");
    // Too many for a name each.
    let all = figure(6);
    assert_eq!(all.panels[0].x.label, "posture");
    assert_eq!(all.panels[0].x.categories.len(), 6);
    assert_eq!(all.panels[0].series[0].x.len(), 72);
}
