//! What an identification seals is what is calculated with later, and nobody changes it unseen.

use crate::common::prelude::*;
use serde_json::{Value, json};
use std::sync::LazyLock;
use stiffarm::ask::identify::{Identified, IdentifiedOptions};
use stiffarm::estimate::saved::Saved;
use stiffarm::work::compensate::{CompensateOptions, compensate};
use stiffarm_files::envelope::write_result;
use stiffarm_files::stiffness::read_stiffness;

fn cell() -> Cell {
    default_cell()
}

fn measured(cell: &Cell) -> Vec<MeasuredPosture> {
    let postures = numbered(group1());
    let truth = cell.prior.clone().unwrap();
    simulate_measurements(cell, &postures, &truth, Model::Linear, 5, 0).unwrap()
}

fn fit(cell: &Cell, options: &IdentifyOptions) -> Fit {
    Fit::new(cell, measured(cell), options).unwrap()
}

fn identified(fit: &Fit, elastic: ElasticChoice) -> Identified {
    let mut wanted = IdentifiedOptions::default();
    wanted.fit.elastic = Some(elastic);
    Identified::new(fit, &wanted, Control::default()).unwrap()
}

fn terms() -> IdentifyOptions {
    with(|o: &mut IdentifyOptions| o.extra = vec![ExtraTerm::JointTilt(2), ExtraTerm::LostMotion(1)])
}

/// The result with what made it, sealed.
fn text(result: &impl serde::Serialize) -> String {
    let envelope = json!({
        "format": 1, "stiffarm": "0.1.0", "command": "identify", "seed": 1,
        "inputs": {"cell": "abc"}, "options": {"confidence": 0.95}, "result": result,
    });
    write_result(&envelope).unwrap()
}

static SAVED: LazyLock<Value> = LazyLock::new(|| {
    let fitted = identified(&fit(&cell(), &terms()), ElasticChoice::Axes);
    serde_json::from_str(&text(&fitted)).unwrap()
});

fn read_text(text: &str) -> Result<Saved, Error> {
    read_stiffness(text.as_bytes(), "k.json", &cell())
}

fn read(value: &Value) -> Result<Saved, Error> {
    read_text(&value.to_string())
}

/// The saved result with one value changed, its seal as it was.
fn changed(pointer: &str, value: Value) -> Value {
    let mut saved = SAVED.clone();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let parent = saved.pointer_mut(parent).unwrap();
    match parent {
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
        _ => parent[key] = value,
    }
    saved
}

/// The same with a seal of its own.
fn sealed_anew(mut saved: Value) -> String {
    saved.as_object_mut().unwrap().remove("seal").unwrap();
    write_result(&saved).unwrap()
}

#[test]
fn what_predicts_is_read_back_to_the_last_bit() {
    let cell = cell();
    for options in [IdentifyOptions::default(), terms()] {
        let fit = fit(&cell, &options);
        let saved = read_text(&text(&identified(&fit, ElasticChoice::Axes))).unwrap();
        assert_eq!(saved.cell.as_deref(), Some("abc"));
        assert_eq!(saved.postures.len(), 6);
        assert!(saved.predictor == fit.compliance().unwrap());
        assert!(saved.predictor.spread.is_some() && !saved.predictor.common.is_empty());
    }
    // The mixed model, with how well its sizes are known and errors of its own.
    let fit = fit(&cell, &IdentifyOptions::default());
    let fitted = identified(&fit, ElasticChoice::Mixed);
    let saved = read_text(&text(&fitted)).unwrap();
    let mixed = stiffarm::estimate::mixed::MixedFit::new(&fit).unwrap();
    let systematic = fitted.systematic_errors.unwrap();
    let direct = mixed.compliance().clone().with_systematic_errors(&systematic);
    // Not printed where it fails: twenty thousand numbers.
    assert!(saved.predictor.spread == direct.spread);
    assert!(saved.predictor.values == direct.values && saved.predictor.common == direct.common);
}

/// The largest displacement is a length, as the deflections are that are held against it.
#[test]
fn the_largest_displacement_is_that_of_a_point() {
    let cell = cell();
    let fitted = identified(&fit(&cell, &IdentifyOptions::default()), ElasticChoice::Axes);
    let saved = read_text(&text(&fitted)).unwrap();
    let sizes = measured(&cell);
    let sizes = sizes.iter().flat_map(|m| &m.displacements);
    let longest = sizes.map(|d| d.value.norm()).fold(0.0, f64::max);
    assert_eq!(saved.largest_displacement, Some(longest));
    let rms = fitted.identification.postures.iter();
    let rms = rms.map(|p| p.displacement_rms_m).fold(0.0, f64::max);
    assert!(longest > 1.5 * rms, "{longest} {rms}");
    // The rope's force, which is the only load.
    let force = saved.largest_force.unwrap();
    let work = |factor: f64| {
        let force = Vector3::new(0.0, 0.0, -factor * force);
        vec![LoadedPosture::new("a", group1()[0].clone(), Wrench::force(force))]
    };
    let objections = |factor: f64| {
        let mut options = CompensateOptions::default();
        options.loaded_up_to = saved.largest_force;
        let control = Control::default();
        let compensation = compensate(&cell, &saved.predictor, &work(factor), &options, control).unwrap();
        compensation.objections().map(|f| f.code.clone()).collect::<Vec<_>>()
    };
    assert!(objections(0.5).is_empty());
    assert_eq!(objections(1.1), ["beyond-load"]);
}

/// Programs write JSON each in their own way: sorted keys, no spaces, 1 for 1.0.
#[test]
fn another_layout_leaves_the_seal_whole() {
    fn whole(value: &mut Value) {
        match value {
            Value::Array(items) => items.iter_mut().for_each(whole),
            Value::Object(map) => map.values_mut().for_each(whole),
            Value::Number(number) => {
                let float = number.as_f64().unwrap();
                if float.fract() == 0.0 && float.abs() < 1e15 {
                    *value = json!(float as i64);
                }
            }
            _ => {}
        }
    }
    let mut other = SAVED.clone();
    whole(&mut other);
    assert_ne!(other, *SAVED);
    assert_eq!(read(&other).unwrap(), read(&SAVED).unwrap());
    assert_eq!(read(&SAVED).unwrap(), read_text(&sealed_anew(SAVED.clone())).unwrap());
}

#[test]
fn every_estimator_writes_what_can_be_read() {
    for estimator in Estimator::ALL {
        for noise in [NoiseSource::Estimated, NoiseSource::Known] {
            let mut options = IdentifyOptions::default();
            options.estimator = estimator;
            options.noise = noise;
            let fitted = identified(&fit(&cell(), &options), ElasticChoice::Axes);
            read_text(&text(&fitted)).unwrap_or_else(|e| panic!("{estimator:?} {noise:?}: {e}"));
        }
    }
}

#[test]
fn whatever_was_changed_is_refused() {
    let k = SAVED["result"]["joints"][1]["stiffness"].as_f64().unwrap();
    let sealed = Some("result.sealed");
    for (pointer, value, key) in [
        ("/result/sealed/values/1", json!(2.0 / k), sealed),
        ("/result/sealed/spread/confidence", json!(0.5), sealed),
        ("/result/sealed/spread/covariance/3/1", json!(0), sealed),
        ("/result/sealed/doubts", json!([1]), sealed),
        ("/result/sealed/note", json!("mine"), sealed),
        ("/result/joints/1/stiffness", json!(-k), None),
        ("/result/joints/1/stiffness", Value::Null, None),
        ("/result/joints/1/determined", json!(false), None),
        ("/result/degrees_of_freedom", json!(2), None),
        ("/result/confidence", json!(0.5), None),
        ("/result/postures/0/posture", json!("1 "), None),
        ("/result/note", json!("mine"), None),
        ("/options/confidence", json!(0.9), None),
        ("/inputs/cell", json!("abd"), None),
        ("/note", json!(null), None),
        ("/seal", json!({"file": "", "sealed": ""}), sealed),
        ("/seal", json!(1), Some("seal")),
    ] {
        let error = read(&changed(pointer, value)).expect_err(pointer);
        assert_eq!(error.place().key.as_deref(), key, "{pointer}: {error}");
        assert_eq!(error.place().file.as_deref(), Some("k.json"));
        assert_eq!(error.code(), Code::ResultFile, "{pointer}: {error}");
        assert!(error.hint_text().is_some(), "{error}");
    }
}

#[test]
fn an_earlier_version_is_told_apart_and_what_does_not_fit_is_refused() {
    let mut earlier = SAVED.clone();
    earlier.as_object_mut().unwrap().remove("seal");
    insta::assert_snapshot!(read(&earlier).unwrap_err(), @"
    k.json: seal: This result has no seal: an earlier version wrote it, or the seal was taken out.
      hint: make it again with this version, for a stiffness: identify again
    ");
    let without = changed("/result/sealed", Value::Null);
    let error = read_text(&sealed_anew(without)).unwrap_err();
    assert_eq!(error.place().key.as_deref(), Some("result.sealed"));
    for [pointer, value, key] in table(
        r#"
        /result/sealed/springs | ["a", "b", "c", "d", "e", "f"] | result.sealed.springs
        /result/sealed/values/0 | "soft" | result.sealed
        /result/sealed/values | [1e-6] | result.sealed
        /result/sealed/extra | [] | result.sealed
        /result/sealed/extra/0 | {"joint_tilt": 77} | result.sealed
        /result/sealed/undetermined | [9] | result.sealed
        /result/sealed/spread/covariance | [[1.0]] | result.sealed
        /result/sealed/spread/covariance/2 | [1.0] | result.sealed
        /result/sealed/spread/confidence | 95 | result.sealed
        /result/sealed/common/mean | [0.0] | result.sealed
        /result/sealed/common/parts/0/change | [] | result.sealed
        /command | "predict" | command
        "#,
    ) {
        let value = serde_json::from_str(value).unwrap();
        let error = read_text(&sealed_anew(changed(pointer, value))).expect_err(pointer);
        let place = error.place();
        assert_eq!(place.key.as_deref(), Some(key), "{pointer}: {error}");
        assert_eq!(error.code(), Code::ResultFile, "{pointer}: {error}");
    }
    insta::assert_snapshot!(read(&changed("/format", json!(2))).unwrap_err(), @"
    k.json: The result has format 2; this version reads 1.
      hint: give a file that a command wrote with --output, or what it printed with --json
    ");
}

/// Displacements in inches, as it were: what was found about the scale goes with the stiffness.
#[test]
fn what_was_wrong_with_the_data_goes_with_the_stiffness() {
    let cell = cell();
    let mut inches = measured(&cell);
    for m in &mut inches {
        m.displacements.iter_mut().for_each(|d| d.value /= 25.4);
    }
    let measured = prepare(&cell, inches, &Default::default()).unwrap();
    let fit = Fit::new(&cell, measured, &IdentifyOptions::default()).unwrap();
    let fitted = identified(&fit, ElasticChoice::Axes);
    assert!(fitted.screening.is_some());
    let saved = read_text(&text(&fitted)).unwrap();
    let serious: Vec<_> = saved.predictor.serious().collect();
    assert_eq!(serious[0].code, "stiffness-doubtful");
    assert_eq!(serious[0], &saved.predictor.doubts[0]);
}

/// The load goes through the axis of joint 6 in the experiment: work that does the same can be
/// predicted, other work cannot.
#[test]
fn an_undetermined_joint_matters_where_the_load_bends_it() {
    let mut cell = cell();
    cell.setup.tool.loading_point = Vector3::new(0.0, 0.0, 0.25);
    let fitted = identified(&fit(&cell, &IdentifyOptions::default()), ElasticChoice::Axes);
    let saved = read_stiffness(text(&fitted).as_bytes(), "k.json", &cell).unwrap();
    let predictor = &saved.predictor;
    assert_eq!(predictor.undetermined, [5]);
    assert_eq!(predictor.doubts[0].code, "stiffness-undetermined");
    insta::assert_snapshot!(predictor.doubts[0].sentence, @"The readings say nothing of joint 6: nothing can be calculated where the load bends it.");
    let force = Wrench::force([100.0, -200.0, -300.0]);
    let work = [LoadedPosture::new("a", group1()[1].clone(), force)];
    let mut bend = |tip: [f64; 3]| {
        cell.work.tip = Some(Isometry3::translation(tip[0], tip[1], tip[2]));
        predict(&cell, predictor, &work, &Default::default(), Control::default())
    };
    let prediction = bend([0.0, 0.0, 0.3]).unwrap();
    assert!(prediction.points[0].band.is_some() && prediction.extremes.is_none());
    assert_eq!(prediction.stiffness_nm_per_rad[5], None);
    assert_eq!(prediction.findings[0].code, "stiffness-undetermined");
    let error = bend([0.1, 0.0, 0.3]).unwrap_err();
    assert_eq!(error.code(), Code::NotIdentifiable);
    insta::assert_snapshot!(error, @"
    Nothing is known of how joint 6 gives way, and the load bends it here.
      hint: measure postures that load it and identify again, or identify with --estimator prior
    ");
    // Postures of the same experiment, and some under a load beside the axis.
    let mut all = measured(&cell);
    let same_experiment = validate_with(&cell, predictor, &all, Model::Linear, Some(1.0)).unwrap();
    assert!(same_experiment.unpredicted.is_empty() && same_experiment.passed == Some(true));
    all[0].wrench = Some(Wrench { force: Vector3::new(0.0, 300.0, 0.0), moment: Vector3::new(50.0, 20.0, 30.0) });
    let some = validate_with(&cell, predictor, &all, Model::Linear, Some(1.0)).unwrap();
    assert_eq!((some.unpredicted.len(), some.passed), (1, Some(false)));
}

/// Noise alone can make a compliance come out below zero: it is a broad one, and no reason to
/// refuse.
#[test]
fn a_compliance_below_zero_is_a_broad_one() {
    let cell = cell();
    let fit = fit(&cell, &IdentifyOptions::default());
    let mut identification = fit.identification().unwrap().clone();
    // Of the joints that the load bends below: it turns joint 5 by 85 N·m, joint 4 by 4.
    let (compliance, error) = (-1e-6, 4e-6);
    let joint = &mut identification.estimates.joints[4];
    joint.compliance = Some(compliance);
    joint.stiffness = None;
    joint.verdict = Verdict::LowerBoundOnly;
    for row in 0..6 {
        let free = if row == 4 { Some(error * error) } else { Some(0.0) };
        identification.estimates.covariance[4][row] = free;
        identification.estimates.covariance[row][4] = free;
    }
    let open = IdentifiedCompliance::from_identification(&cell, &identification).unwrap();
    assert_eq!(open.doubts.len(), 1);
    assert_eq!(open.doubts[0].code, "stiffness-open");
    assert_eq!(open.doubts[0].severity, Severity::Caution);
    insta::assert_snapshot!(open.doubts[0].sentence, @"The readings do not tell the compliance of joint 5 from none. It counts as it came out, with all of its uncertainty: bands are wide where the load bends it.");
    let closed = fit.compliance().unwrap();
    let force = Wrench::force([100.0, -200.0, -300.0]);
    let work = [LoadedPosture::new("a", group1()[1].clone(), force)];
    let bend = |predictor| predict(&cell, predictor, &work, &Default::default(), Control::default());
    let (open_bend, closed_bend) = (bend(&open).unwrap(), bend(&closed).unwrap());
    assert_eq!(open_bend.stiffness_nm_per_rad[4], None);
    let width = |bend: &stiffarm::Prediction| bend.points[0].band.unwrap().rms_m;
    assert!(width(&open_bend) > 2.0 * width(&closed_bend));
    let far = Vector3::from(open_bend.points[0].shift_m) - Vector3::from(closed_bend.points[0].shift_m);
    assert!(far.norm() < 3.0 * open_bend.points[0].band.unwrap().rms_m);
    // The equilibrium of `validate` needs no 1/h either.
    let exact = validate_with(&cell, &open, measured(&cell), Model::Equilibrium, None).unwrap();
    let linear = validate_with(&cell, &open, measured(&cell), Model::Linear, None).unwrap();
    let ratio = exact.deviation_rms_m / linear.deviation_rms_m;
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    let spread = open.spread.unwrap();
    assert!(spread.covariance == DMatrix::from_fn(6, 6, |i, j| spread.covariance[(j, i)]));
}

#[test]
fn lists_by_hand() {
    let k = [1e6, 2e6, 3e6, 1e5, 1e5, 1e5];
    let saved = read(&json!({"stiffness_nm_per_rad": k})).unwrap();
    assert_eq!(saved.predictor.spread, None);
    for [text, key] in table(
        r#"
        {"stiffness_nm_per_rad": [1e6, 2e6, 3e6, 1e5, 1e5, 1e5], "confidence": 0.9} | confidence
        {"stiffness_nm_per_rad": [1e6]} | stiffness_nm_per_rad
        {"stiffness_nm_per_rad": 3} | stiffness_nm_per_rad
        {"stiffness_nm_per_rad": [1e6, 1e6, -1, 1, 1, 1]} | stiffness_nm_per_rad[2]
        {"stiffness_nm_per_rad": [1e6, 1e6, 1e300, 1, 1, 1]} | stiffness_nm_per_rad[2]
        {"stiffness_nm_per_rad": [null, 1e6, 1, 1, 1, 1]} | stiffness_nm_per_rad[0]
        "#,
    ) {
        let error = read_text(text).unwrap_err();
        assert_eq!(error.place().key.as_deref(), Some(key), "{error}");
    }
    insta::assert_snapshot!(read(&json!({"joints": [{"stiffness": 1e6}]})).unwrap_err(), @r#"
    k.json: The file holds no joint stiffness.
      hint: give the saved result of an identification, or {"stiffness_nm_per_rad": [k1, …]}
    "#);
}

#[test]
fn a_key_twice_and_a_number_beyond_all_are_named() {
    let read = |text: &str| read_text(text).unwrap_err();
    let error = read("{\"a\": 1,\n\"a\": 2}");
    assert_eq!(error.place().line, Some(2));
    insta::assert_snapshot!(error, @r#"
    k.json:2:3: This is not a saved result: the key "a" stands twice.
      hint: give the saved result of an identification, or {"stiffness_nm_per_rad": [k1, …]}
    "#);
    insta::assert_snapshot!(read("{\"stiffness_nm_per_rad\": [1e999]}"), @r#"
    k.json:1:31: This is not a saved result: number out of range.
      hint: give the saved result of an identification, or {"stiffness_nm_per_rad": [k1, …]}
    "#);
    let deep = "[".repeat(100_000);
    assert_eq!(read(&deep).code(), Code::ResultFile);
}

#[test]
fn a_stiffness_is_held_against_the_robot_and_its_prior() {
    let cell = cell();
    let sealed_text = text(&identified(&fit(&cell, &terms()), ElasticChoice::Axes));
    let read_in = |cell: &Cell| read_stiffness(sealed_text.as_bytes(), "k.json", cell);
    assert!(read_in(&cell).is_ok());
    let mut other = cell.clone();
    other.setup.robot = Robot::from_catalogue("comau-nj220-foundry").unwrap();
    let error = read_in(&other).unwrap_err();
    assert_eq!(error.place().key.as_deref(), Some("result.sealed.flange_m"));
    insta::assert_snapshot!(error, @"
    k.json: result.sealed.flange_m: The stiffness belongs to another robot than Comau NJ 220 Foundry: with every joint at half a radian its flange is 318.7 mm from this one's.
      hint: give the cell that it was identified in, or identify on this robot
    ");
    // A list in another unit is told by the prior.
    let prior = cell.prior.clone().unwrap();
    for (factor, is_doubted) in [(1.0, false), (20.0, false), (1e3, true), (1e-3, true)] {
        let listed: Vec<f64> = prior.iter().map(|k| k * factor).collect();
        let saved = Saved::bare(&cell, &listed, "list").unwrap();
        let doubted =
            saved.predictor.doubts.iter().any(|f| f.code == "implausible-stiffness" && f.severity == Severity::Serious);
        assert_eq!(doubted, is_doubted, "{factor}");
    }
}
