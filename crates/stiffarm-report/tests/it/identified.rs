//! Pages of identify and validate.

use serde_json::{Map, Value, json};
use stiffarm::estimate::clamped::{
    ClampedSimulation, MotorMove, identify_clamped, simulate_clamped,
};
use stiffarm::estimate::compliance::IdentifiedCompliance;
use stiffarm::estimate::diagnose::diagnose;
use stiffarm::estimate::identify::{Fit, IdentifyOptions};
use stiffarm::estimate::systematic::systematic_errors;
use stiffarm::estimate::validate::{cross_validate, validate_with};
use stiffarm::files::builtin;
use stiffarm::files::result::SavedResult;
use stiffarm::measure::{Measured, prepare};
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::ReadingTarget;
use stiffarm::model::posture::Posture;
use stiffarm::model::stiffness::Model;
use stiffarm::simulated_readings;
use stiffarm_report::page::{Block, Number, Outcome, Page, Piece, Text, render_page};
use stiffarm_report::report::{Given, report};

const HOSTILE: &str = "</script><img src=x onerror=alert(1)>";

pub(crate) fn group(cell: &Cell) -> Vec<Posture> {
    builtin::postures("comau-group1", &cell.setup.robot).unwrap()
}

/// A cell with simulated displacements of these postures.
pub(crate) fn measured(cell: &Cell, postures: &[Posture]) -> Measured {
    let readings = simulated_readings(cell, postures, 1).unwrap();
    prepare(cell, readings, &Default::default()).unwrap()
}

pub(crate) fn saved(command: &str, result: Value) -> SavedResult {
    let envelope = json!({
        "format": 1, "stiffarm": "0.1.0", "command": command, "inputs": {}, "seed": 1,
        "options": {"exclude": []}, "result": result
    });
    SavedResult::of(&envelope, "result").unwrap()
}

/// What the command writes, without the search for a next posture.
pub(crate) fn identified(cell: &Cell, measured: &Measured) -> Value {
    let fit = Fit::new(cell, measured, &IdentifyOptions::default()).unwrap();
    let mut result: Map<String, Value> = to(&fit.identification().unwrap());
    result.insert("budget".into(), json!(systematic_errors(&fit).unwrap()));
    result.insert("diagnosis".into(), json!(diagnose(&fit).unwrap()));
    if let (Some(reduction), Some(sanity)) = (&measured.reduction, &measured.screening) {
        let readings = json!({"reduction": reduction, "sanity": sanity});
        result.insert("readings".into(), readings);
    }
    Value::Object(result)
}

fn to(value: &impl serde::Serialize) -> Map<String, Value> {
    serde_json::to_value(value)
        .unwrap()
        .as_object()
        .unwrap()
        .clone()
}

fn page(saved: &SavedResult, cell: Option<&Cell>) -> Page {
    report(&[Given { saved, cell }]).unwrap()
}

/// Every text of a page.
fn texts(page: &Page) -> Vec<Text> {
    fn of(blocks: &[Block], out: &mut Vec<Text>) {
        for block in blocks {
            match block {
                Block::Text(text) => out.push(text.clone()),
                Block::List(list) => out.extend(list.iter().cloned()),
                Block::Table(table) => out.extend(table.rows.iter().flatten().cloned()),
                Block::Details(_, inside) => of(inside, out),
                _ => {}
            }
        }
    }
    let mut out = Vec::new();
    for part in &page.parts {
        out.extend(part.verdict.iter().cloned());
        let key = part.key.iter().flat_map(|key| key.rows.iter().flatten());
        out.extend(key.cloned());
        part.sections
            .iter()
            .for_each(|section| of(&section.blocks, &mut out));
    }
    out
}

fn numbers(page: &Page) -> Vec<Number> {
    let pieces = texts(page).into_iter().flat_map(|text| text.0);
    let numbers = pieces.filter_map(|piece| match piece {
        Piece::Number(number) => Some(number),
        _ => None,
    });
    numbers.collect()
}

/// Numbers of the page are those of the file; this many stand in it at least.
fn numbers_are_those_of_the_file(page: &Page, saved: &SavedResult, at_least: usize) {
    let numbers = numbers(page);
    let tied = numbers.iter().filter(|n| !n.pointer.is_empty());
    let mut count = 0;
    for number in tied {
        let value = saved.json.pointer(&number.pointer);
        assert!(value.is_some(), "{} is not in the file", number.pointer);
        assert_eq!(number.value, value.unwrap().as_f64(), "{}", number.pointer);
        count += 1;
    }
    assert!(count >= at_least, "{count} numbers");
}

fn words(page: &Page) -> [String; 3] {
    page.parts[0].verdict.each_ref().map(Text::plain)
}

#[test]
fn good_readings_tell_which_joints_are_known_and_that_the_rest_is_noise() {
    let cell = Cell::built_in("comau").unwrap();
    let result = saved(
        "identify",
        identified(&cell, &measured(&cell, &group(&cell))),
    );
    let made = page(&result, Some(&cell));
    let [done, came, _] = words(&made);
    assert!(
        done.contains("raw readings of the tracker at 6 postures: 72 displacements"),
        "{done}"
    );
    assert!(came.contains("looks like noise"), "{came}");
    assert!(
        came.contains("Weak, above ± 10 %: joint 2, joint 4 and joint 6"),
        "{came}"
    );
    numbers_are_those_of_the_file(&made, &result, 70);
    let html = render_page(&made);
    assert_eq!(html, render_page(&page(&result, Some(&cell))));
    for id in [
        "joint-stiffness",
        "residuals",
        "systematic-errors",
        "correlations",
        "load-states",
        "influence",
    ] {
        let has = made.parts[0].sections.iter().flat_map(|s| &s.blocks);
        let has = has.filter(|b| matches!(b, Block::Figure(figure) if figure.id == id));
        assert_eq!(has.count(), 1, "{id}");
    }
}

#[test]
fn arrows_stand_at_the_measuring_points_and_are_the_residuals() {
    let cell = Cell::built_in("comau").unwrap();
    let result = saved(
        "identify",
        identified(&cell, &measured(&cell, &group(&cell))),
    );
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
        let own = postures.iter().filter(|p| p["posture"] == **name);
        let size = |p: &&Value| p["displacement_rms_m"].as_f64().unwrap();
        let most = own.max_by(|a, b| size(a).total_cmp(&size(b))).unwrap();
        let mut residuals = most["residuals"].as_array().unwrap().iter();
        let residual = residuals.find(|r| r["point"] == *arrow.name).unwrap();
        for i in 0..3 {
            let value = residual["residual_m"][i].as_f64().unwrap();
            assert!((arrow.vector[i] - value).abs() < 1e-3 * value.abs() + 1e-9);
        }
    }
}

#[test]
fn residuals_are_measured_minus_calculated() {
    let cell = Cell::built_in("comau").unwrap();
    let measured = measured(&cell, &group(&cell));
    let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let found = fit.identification().unwrap();
    let mut sum = 0.0;
    for posture in &found.postures {
        assert_eq!(posture.angles.len(), 6);
        assert_eq!(posture.residuals.len(), 4);
        let squares = posture
            .residuals
            .iter()
            .flat_map(|r| r.residual_m)
            .map(|c| c * c);
        let squares: f64 = squares.sum();
        assert!(((squares / 12.0).sqrt() - posture.residual_rms_m).abs() < 1e-12);
        sum += squares;
    }
    assert!(((sum / found.estimates.rows as f64).sqrt() - found.residual_rms_m).abs() < 1e-12);
    assert_eq!(Some(&found.prior_stiffness), cell.prior.as_ref());
}

#[test]
fn an_earlier_result_without_vectors_has_a_page() {
    let cell = Cell::built_in("comau").unwrap();
    let mut result = identified(&cell, &measured(&cell, &group(&cell)));
    result.as_object_mut().unwrap().remove("prior_stiffness");
    for posture in result["postures"].as_array_mut().unwrap() {
        for key in ["q_deg", "wrench", "residuals"] {
            posture.as_object_mut().unwrap().remove(key);
        }
    }
    let saved = saved("identify", result);
    let made = page(&saved, Some(&cell));
    assert!(
        made.parts[0]
            .sections
            .iter()
            .all(|section| section.id != "cell")
    );
    numbers_are_those_of_the_file(&made, &saved, 60);
}

#[test]
fn a_fault_in_the_table_comes_first_and_says_what_to_correct() {
    let cell = Cell::built_in("comau").unwrap();
    let mut readings = simulated_readings(&cell, &group(&cell), 1).unwrap();
    // Two points of the second posture exchanged.
    let states = readings.postures[1].states.iter_mut();
    for reading in states.flat_map(|state| &mut state.readings) {
        reading.target = match reading.target.clone() {
            ReadingTarget::Point(0) => ReadingTarget::Point(2),
            ReadingTarget::Point(2) => ReadingTarget::Point(0),
            other => other,
        };
    }
    let measured = prepare(&cell, readings, &Default::default()).unwrap();
    let made = page(
        &saved("identify", identified(&cell, &measured)),
        Some(&cell),
    );
    assert_eq!(made.parts[0].outcome, Outcome::Serious);
    assert!(
        words(&made)[2].starts_with("Correct the table first"),
        "{:?}",
        words(&made)
    );
    assert_eq!(made.parts[0].sections[0].id, "readings");
}

#[test]
fn a_joint_that_cannot_be_told_is_named() {
    // The rope's force goes through the axis of joint 6, and the only measuring point lies on it.
    let mut cell = Cell::built_in("comau").unwrap();
    cell.setup.tool.loading_point.x = 0.0;
    cell.setup.tool.loading_point.y = 0.0;
    let made = identified(&cell, &measured(&cell, &group(&cell)));
    let result = saved("identify", made);
    let made = page(&result, None);
    let [_, came, next] = words(&made);
    assert!(came.contains("No usable value: joint 6"), "{came}");
    assert!(next.contains("joint 6"), "{next}");
    assert_ne!(made.parts[0].outcome, Outcome::Good);
    let key = made.parts[0].key.as_ref().unwrap();
    let last = key.rows[5].last().unwrap().plain();
    assert!(last.contains("not determined"), "{last}");
}

#[test]
fn hostile_names_stay_text() {
    let cell = Cell::built_in("comau").unwrap();
    let mut postures = group(&cell);
    postures[0].name = HOSTILE.to_string();
    postures[1].name = "\u{1b}[31mred".to_string();
    let result = saved("identify", identified(&cell, &measured(&cell, &postures)));
    let html = render_page(&page(&result, Some(&cell)));
    assert!(!html.contains("<img src=x"));
    assert!(!html.contains('\u{1b}'));
}

#[test]
fn validation_says_how_far_calculated_and_measured_differ() {
    let cell = Cell::built_in("comau").unwrap();
    let measured = measured(&cell, &group(&cell));
    let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let folds = cross_validate(&fit, 6, Some(1e-6)).unwrap();
    let result = saved("validate", json!(folds));
    let made = page(&result, Some(&cell));
    let [done, came, _] = words(&made);
    assert!(
        done.contains("each predicted by a fit without it, in 6 folds"),
        "{done}"
    );
    assert!(came.contains("is not kept"), "{came}");
    assert_eq!(made.parts[0].outcome, Outcome::Serious);
    numbers_are_those_of_the_file(&made, &result, 100);

    let prior = IdentifiedCompliance::from_stiffness(&cell, cell.require_prior().unwrap()).unwrap();
    let found = validate_with(&cell, &prior, &measured, Model::Equilibrium, None).unwrap();
    assert_eq!(found.postures.len(), 18);
    let made = page(&saved("validate", json!(found)), None);
    assert_eq!(made.parts[0].outcome, Outcome::Good);
    assert!(
        words(&made)[2].contains("stiffarm predict"),
        "{:?}",
        words(&made)
    );
}

#[test]
fn a_clamped_arm_has_a_page_of_angles() {
    let cell = Cell::built_in("comau").unwrap();
    let truth = cell.require_prior().unwrap();
    let torque = [900.0, -1200.0, 700.0, 300.0, -250.0, 200.0];
    let motor: Vec<f64> = torque.iter().zip(truth).map(|(t, k)| t / k).collect();
    let moves = [("up-1", 1.0), ("down-1", 0.99)].map(|(state, by)| MotorMove {
        state: state.to_string(),
        motor: motor.iter().map(|q| by * q).collect(),
    });
    let simulation = ClampedSimulation {
        moves: moves.to_vec(),
        angle_std: 1e-6,
        force_std: 0.1,
        moment_std: 0.05,
        ..ClampedSimulation::default()
    };
    let postures = group(&cell);
    let clamped = simulate_clamped(&cell, &postures, truth, &simulation, 7, 0).unwrap();
    let found = identify_clamped(&cell, &clamped, None, &IdentifyOptions::default()).unwrap();
    let result = saved("identify", json!(found));
    let made = page(&result, Some(&cell));
    let [done, came, _] = words(&made);
    assert!(done.contains("With the flange fixed"), "{done}");
    assert!(came.contains("mdeg"), "{came}");
    numbers_are_those_of_the_file(&made, &result, 30);
}
