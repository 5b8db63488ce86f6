//! What commands ask for, as values: the same numbers as by the parts, and errors that name
//! the field.

use crate::common::prelude::*;
use stiffarm::ask::map::{LoadSource, MapOptions};
use stiffarm::ask::path::PathOptions;
use stiffarm::ask::pose::{PoseOptions, PosePoint};
use stiffarm::ask::predict::PredictOptions;
use stiffarm::ask::region::{Plane, RegionOptions, Steps};
use stiffarm::ask::register::PairOptions;
use stiffarm::ask::simulate::{ErrorOptions, SimulateOptions};
use stiffarm::ask::validate::{Folds, ValidateOptions};
use stiffarm::estimate::saved::Saved;
use stiffarm_files::table::read_pairs;

fn key(error: Error) -> (Code, String) {
    (error.code(), error.place().key.clone().unwrap_or_default())
}

fn wrong(field: &str) -> (Code, String) {
    (Code::InvalidValue, field.to_string())
}

fn measured() -> Measured {
    let cell = default_cell();
    let group = PostureGroup::from_angles("", group1());
    let readings = simulated_readings(&cell, &group.postures, 1).unwrap();
    prepare(&cell, readings, &Default::default()).unwrap()
}

#[test]
fn a_saved_stiffness_is_validated_at_the_postures_asked_for() {
    let (cell, measured) = (default_cell(), measured());
    let mut saved = Saved::prior(&cell).unwrap();
    let name = measured.postures[1].posture.name.clone();
    let request = ValidateOptions { tolerance_mm: Some(0.1), only: vec![name.clone()], ..ValidateOptions::default() };
    saved.postures = vec![name.clone()];
    saved.cell = Some("another".to_string());
    let validated = request.held_out(&cell, Some("this"), &saved, measured.clone()).unwrap();
    let mut chosen = measured.clone();
    chosen.keep_only(std::slice::from_ref(&name)).unwrap();
    let by_parts = validate_with(&cell, &saved.predictor, &chosen, Model::Linear, Some(1e-4));
    assert_eq!(validated.validation, by_parts.unwrap());
    let codes: Vec<&str> = validated.remarks.iter().map(|f| f.code.as_str()).collect();
    assert!(codes.ends_with(&["other-cell", "seen-postures"]), "{codes:?}");

    // Angles tell, where they are known: another day has postures of the same names.
    for (angles, name, is_seen) in
        [(vec![0.1; 6], name.clone(), false), (measured.postures[1].posture.q.clone(), "7".to_string(), true)]
    {
        (saved.angles, saved.postures) = (vec![angles], vec![name]);
        let validated = request.held_out(&cell, Some("this"), &saved, measured.clone());
        let codes = validated.unwrap().remarks.into_iter().map(|f| f.code);
        assert_eq!(codes.into_iter().any(|code| code == "seen-postures"), is_seen);
    }

    // Each is named once: the states of a posture need not stand together.
    let twice = Measured::from([measured.postures.clone(), measured.postures.clone()].concat());
    (saved.angles, saved.postures) = (Vec::new(), vec!["1".to_string(), "2".to_string()]);
    let validated = ValidateOptions::default().held_out(&cell, Some("this"), &saved, twice).unwrap();
    let seen = validated.remarks.into_iter().find(|finding| finding.code == "seen-postures").unwrap();
    assert!(seen.sentence.starts_with("Postures 1 and 2 "), "{}", seen.sentence);

    let negative = ValidateOptions { tolerance_mm: Some(-1.0), ..request.clone() };
    let refused = negative.held_out(&cell, None, &saved, measured.clone());
    assert_eq!(key(refused.unwrap_err()), wrong("tolerance_mm"));
    let unknown = ValidateOptions { only: vec!["nobody".to_string()], ..request };
    let refused = unknown.held_out(&cell, None, &saved, measured);
    let expected = (Code::UnknownName, "only".to_string());
    assert_eq!(key(refused.unwrap_err()), expected);
}

#[test]
fn postures_are_predicted_by_the_others() {
    let fit = Fit::new(&default_cell(), measured(), &Default::default()).unwrap();
    let request = ValidateOptions::default();
    let axes = changed(request.clone(), |axes_request| axes_request.fit.elastic = Some(ElasticChoice::Axes));
    let (validated, options) = axes.by_folds(&fit, Folds::All).unwrap();
    let count = group1().len();
    assert_eq!(validated.validation, cross_validate(&fit, count, None).unwrap());
    assert_eq!((options.folds, options.elastic), (count, ElasticChoice::Axes));
    let (_, options) = request.by_folds(&fit, Folds::Count(2)).unwrap();
    assert_eq!((options.folds, options.elastic), (2, ElasticChoice::Mixed));
    let exact = ValidateOptions { model: Model::Equilibrium, ..request };
    let refused = exact.by_folds(&fit, Folds::All).unwrap_err();
    assert_eq!(key(refused), (Code::Unsupported, "model".to_string()));
}

#[test]
fn deflections_at_the_tasks_are_those_of_predict() {
    let cell = default_cell();
    let saved = Saved::prior(&cell).unwrap();
    let request = PredictOptions::default();
    let control = Control::default();
    let loaded = request.loaded(cell.clone(), &saved.predictor, None, control).unwrap();
    assert_eq!(loaded.postures.len(), cell.tasks.len());
    let predicted = request.predict(&loaded, &saved, control).unwrap();
    let by_parts = predict(&loaded.cell, &saved.predictor, &loaded.postures, &Default::default(), control);
    assert_eq!(predicted.prediction, by_parts.unwrap());
    assert!(predicted.postures.is_none());
    // A stiffness that has seen less than the tasks ask for says so, as `compensate` does.
    let seen_less = Saved { largest_displacement: Some(1e-6), largest_force: Some(1.0), ..saved.clone() };
    let predicted = request.predict(&loaded, &seen_less, control).unwrap();
    let codes = predicted.prediction.findings.iter().map(|f| f.code.as_str());
    let beyond: Vec<&str> = codes.filter(|code| code.starts_with("beyond-")).collect();
    assert_eq!(beyond, ["beyond-measured", "beyond-load"]);
    let unknown = PredictOptions { cell_load: true, load_case: Some("nobody".to_string()), ..request };
    let refused = unknown.under_case(cell).unwrap_err();
    assert_eq!(key(refused), wrong("load_case"));
}

#[test]
fn options_of_a_path_name_what_is_wrong() {
    let cell = default_cell();
    let refused = |change: fn(&mut PathOptions)| {
        let mut options = PathOptions::default();
        change(&mut options);
        key(options.posture_options(&cell).unwrap_err())
    };
    assert_eq!(refused(|o| o.near_deg = Some(vec![1.0])), wrong("near_deg"));
    assert_eq!(refused(|o| o.max_step_deg = 0.0), wrong("max_step_deg"));
    assert_eq!(refused(|o| o.force_n = Some([1.0; 3])), wrong("force_n"));
    let unsure = PathOptions { load_uncertainty_percent: f64::NAN, ..PathOptions::default() };
    let refusal = key(unsure.load_uncertainty().unwrap_err());
    assert_eq!(refusal, wrong("load_uncertainty_percent"));
    let steps = PathOptions::default().posture_options(&cell).unwrap();
    assert_eq!((steps.turns, steps.free_turn), (72, false));
}

#[test]
fn a_map_takes_the_force_given_and_the_plane_asked_for() {
    let cell = default_cell();
    let plane = RegionOptions {
        plane: Some(Plane { axis: 2, mm: 800.0 }),
        steps: Some(Steps::Longest(5)),
        ..RegionOptions::default()
    };
    let request = MapOptions { region: plane, force_n: Some([0.0, 2.0, 0.0]), ..MapOptions::default() };
    let options = request.map_options(&cell).unwrap();
    let source = request.options(&options, &cell).load_from;
    assert_eq!(source, LoadSource::Given);
    assert_eq!((options.lower[2], options.upper[2]), (0.8, 0.8));
    assert_eq!((options.steps[2], options.direction.y), (1, 1.0));
    assert_eq!(request.options(&options, &cell).rpy_deg, [180.0, 0.0, 0.0]);
    let nowhere = MapOptions { direction: Some([0.0; 3]), ..request };
    let refused = nowhere.map_options(&cell).unwrap_err();
    assert_eq!(key(refused), wrong("direction"));
    let upside_down =
        RegionOptions { from_mm: Some([0.0, 0.0, 1.0]), to_mm: Some([1.0, 1.0, 0.0]), ..RegionOptions::default() };
    let request = MapOptions { region: upside_down, ..MapOptions::default() };
    let refused = request.place_options(&cell).unwrap_err();
    assert_eq!(key(refused), wrong("from_mm"));
}

#[test]
fn a_simulation_is_the_papers_unless_asked_otherwise() {
    let request = SimulateOptions::default();
    let options = request.simulation_options().unwrap();
    assert_eq!(options, SimulationOptions::default());
    let errors = ErrorOptions { anchor_error_mm: 2.0, ..Default::default() };
    let with_errors = SimulateOptions { errors, ..request };
    let options = with_errors.simulation_options().unwrap();
    assert_eq!(options.model_errors.anchor_m, 2e-3);
    let refused = with_errors.elastic_options();
    let refusal = (Code::Conflict, "anchor_error_mm".to_string());
    assert_eq!(key(refused.unwrap_err()), refusal);
    let negative = SimulateOptions { levels: vec![1.0, -1.0], ..SimulateOptions::default() };
    let refused = negative.simulation_options().unwrap_err();
    assert_eq!(key(refused), wrong("levels"));
}

#[test]
fn a_registration_leaves_out_pairs_by_name() {
    let bytes = builtin::bytes("example-pairs").unwrap();
    let pairs = read_pairs(bytes, "pairs").unwrap();
    let mut options = PairOptions { exclude: vec!["B".to_string()], ..Default::default() };
    let remaining = options.kept(pairs.clone()).unwrap();
    assert_eq!(remaining.len() + 1, pairs.len());
    assert_eq!(options.register(&remaining).unwrap().names.len(), remaining.len());
    options.exclude = vec!["nobody".to_string()];
    let refused = options.kept(pairs).unwrap_err();
    assert_eq!(key(refused), (Code::UnknownName, "exclude".to_string()));
    assert!(builtin::bytes("nobody").is_err());
}

#[test]
fn postures_come_back_from_their_poses() {
    let cell = default_cell();
    let postures = numbered(group1());
    let options = PoseOptions { point: PosePoint::Tip, ..PoseOptions::default() };
    let request = options.of(&cell).unwrap();
    let listed = request.poses_of(&cell, &postures);
    assert_eq!(listed.postures.len(), postures.len());
    let named = request.named_poses(&cell, &postures);
    let (solved, all) = request.postures_of(&cell, &named).unwrap();
    assert_eq!(solved.poses.len(), postures.len());
    for (posture, pose) in postures.iter().zip(&solved.poses) {
        let near = |q: &[f64]| q.iter().zip(&posture.q).all(|(a, b)| (a - b).abs() < 1e-6);
        let candidates = all.iter().filter(|p| p.name.starts_with(&pose.name));
        assert!(candidates.into_iter().any(|p| near(&p.q)), "{}", posture.name);
    }
}
