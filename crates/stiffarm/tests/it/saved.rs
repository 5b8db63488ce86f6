//! A saved stiffness is an input like any other: what contradicts itself or
//! cannot be is refused with the key.

use crate::common;

use serde_json::{Value, json};
use std::sync::LazyLock;
use stiffarm::estimate::common::CommonErrors;
use stiffarm::estimate::identify::{Estimator, Fit, IdentifyOptions, NoiseSource};
use stiffarm::estimate::systematic::systematic_errors;
use stiffarm::estimate::validate::{Model, simulate_measurements};
use stiffarm::files::stiffness::{SavedStiffness, read_stiffness};
use stiffarm::model::cell::Cell;
use stiffarm::model::observation::ExtraTerm;
use stiffarm::model::posture::PostureGroup;
use stiffarm::{Code, Error};

fn cell() -> Cell {
    common::default_cell()
}

/// The result of an identification as the command writes it.
fn result(options: &IdentifyOptions) -> Value {
    let cell = cell();
    let postures = PostureGroup::from_angles("Group 1", common::group1()).postures;
    let truth = cell.prior.clone().unwrap();
    let measured = simulate_measurements(&cell, &postures, &truth, Model::Linear, 5, 0).unwrap();
    let fit = Fit::new(&cell, measured, options).unwrap();
    let mut result = serde_json::to_value(fit.identification().unwrap()).unwrap();
    result["budget"] = serde_json::to_value(systematic_errors(&fit).unwrap()).unwrap();
    json!({
        "format": 1, "stiffarm": "0.1.0", "command": "identify", "seed": 1,
        "inputs": {"cell": "abc"}, "options": {}, "result": result,
    })
}

static SAVED: LazyLock<Value> = LazyLock::new(|| {
    result(&{
        let mut options = IdentifyOptions::default();
        options.extra = vec![ExtraTerm::JointTilt(2), ExtraTerm::LostMotion(1)];
        options
    })
});

fn read(value: &Value) -> Result<SavedStiffness, Error> {
    read_stiffness(value.to_string().as_bytes(), "k.json", &cell())
}

/// The saved result with one value changed.
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

#[test]
fn what_was_saved_is_read_back_with_all_it_says() {
    let saved = read(&SAVED).unwrap();
    assert_eq!(saved.cell.as_deref(), Some("abc"));
    assert_eq!(saved.postures.len(), 6);
    assert!(saved.largest_displacement.is_some_and(|d| d > 0.0));
    assert_eq!(saved.compliance.extra.len(), 2);
    assert!(saved.compliance.spread.is_some() && !saved.compliance.common.is_empty());
    // Bare, and with what the library alone writes.
    let bare = read(&SAVED["result"]).unwrap();
    assert_eq!(bare.compliance, saved.compliance);
}

/// Results of earlier versions know nothing of what the readings left: every part
/// counts with its whole size, and none again at work.
#[test]
fn common_errors_of_earlier_versions_are_read_with_their_whole_size() {
    let mut earlier = SAVED.clone();
    let budget = earlier["result"]["budget"].as_object_mut().unwrap();
    for name in ["total", "confidence", "uncertainty", "posterior"] {
        budget.remove(name).unwrap();
    }
    let squares = |j: usize, sources: &Value| -> f64 {
        let of = |source: &Value| source["change"][j].as_f64().unwrap().powi(2);
        sources.as_array().unwrap().iter().map(of).sum()
    };
    let sums: Vec<f64> = (0..6)
        .map(|j| squares(j, &budget["sources"]).sqrt())
        .collect();
    budget["combined"] = json!(sums);
    for source in budget["sources"].as_array_mut().unwrap() {
        let source = source.as_object_mut().unwrap();
        source.remove("remaining").unwrap();
        source.remove("bounded").unwrap();
    }
    let (old, new) = (
        read(&earlier).unwrap().compliance,
        read(&SAVED).unwrap().compliance,
    );
    let (old, new) = (old.common, new.common);
    assert_eq!(old.parts.len(), new.parts.len());
    assert_eq!(old, CommonErrors::independent(old.parts.clone()));
    for (old, new) in old.parts.iter().zip(&new.parts) {
        assert_eq!((&old.source, old.at_work), (&new.source, None));
        for j in 0..6 {
            let size = new.change[j].abs();
            assert!((old.change[j] - new.change[j]).abs() <= 1e-9 * size + 1e-18);
        }
    }
    earlier["result"]["budget"]["combined"][2] = json!(0.5);
    let error = read(&earlier).unwrap_err();
    assert_eq!(
        error.place().key.as_deref(),
        Some("result.budget.combined[2]")
    );
}

#[test]
fn every_estimator_writes_what_can_be_read() {
    use Estimator::{Huber, NonNegative, Ordinary, Prior, TwoVariance, Weighted};
    for estimator in [Ordinary, Weighted, TwoVariance, Huber, NonNegative, Prior] {
        for noise in [NoiseSource::Estimated, NoiseSource::Known] {
            let options = {
                let mut options = IdentifyOptions::default();
                options.estimator = estimator;
                options.noise = noise;
                options
            };
            let saved = result(&options);
            read(&saved).unwrap_or_else(|e| panic!("{estimator:?} {noise:?}: {e}"));
        }
    }
}

#[test]
fn a_value_that_contradicts_the_rest_or_cannot_be_is_refused_with_its_key() {
    let k = SAVED["result"]["joints"][1]["stiffness"].as_f64().unwrap();
    let variance = SAVED["result"]["covariance"][0][0].as_f64().unwrap();
    let cases = [
        (
            "/result/joints/1/stiffness",
            json!(k / 10.0),
            "result.joints[1].compliance",
        ),
        (
            "/result/joints/1/stiffness",
            json!(-k),
            "result.joints[1].stiffness",
        ),
        (
            "/result/joints/1/stiffness",
            json!(1e308),
            "result.joints[1].stiffness",
        ),
        (
            "/result/joints/1/stiffness",
            json!(1e-300),
            "result.joints[1].stiffness",
        ),
        (
            "/result/joints/1/stiffness",
            Value::Null,
            "result.joints[1].stiffness",
        ),
        (
            "/result/joints/1/stiffness",
            json!("soft"),
            "result.joints[1]",
        ),
        (
            "/result/joints/1/compliance",
            json!(-1.0 / k),
            "result.joints[1].compliance",
        ),
        (
            "/result/joints/1/compliance",
            json!(1e308),
            "result.joints[1].compliance",
        ),
        (
            "/result/joints/1/compliance",
            Value::Null,
            "result.joints[1].compliance",
        ),
        (
            "/result/joints/1/name",
            json!("A2"),
            "result.joints[1].name",
        ),
        (
            "/result/joints/1/stiffness_nm_per_rad",
            json!(k),
            "result.joints[1].stiffness_nm_per_rad",
        ),
        (
            "/result/stiffness_nm_per_rad",
            json!([k]),
            "result.stiffness_nm_per_rad",
        ),
        (
            "/stiffness_nm_per_rad",
            json!([1, 2]),
            "stiffness_nm_per_rad",
        ),
        (
            "/result/joints/0/compliance_standard_error",
            json!(1e-3),
            "result.joints[0].standard_error",
        ),
        (
            "/result/extra_springs/0/compliance",
            json!(1e9),
            "result.extra_springs[0].compliance",
        ),
        ("/result/extra_springs", json!([]), "result.extra_springs"),
        (
            "/result/lost_motion/0/angle",
            json!(100.0),
            "result.lost_motion[0].angle",
        ),
        (
            "/result/extra/0",
            json!({"joint_tilt": 77}),
            "result.extra[0]",
        ),
        ("/result/unknowns/0", json!("x"), "result.unknowns"),
        ("/result/confidence", json!(95), "result.confidence"),
        ("/result/confidence", json!(1.0), "result.confidence"),
        ("/result/confidence", json!(-1), "result.confidence"),
        ("/result/confidence", json!(0), "result.confidence"),
        ("/result/confidence", json!("0.95"), "result"),
        (
            "/result/interval_degrees_of_freedom",
            json!(0),
            "result.interval_degrees_of_freedom",
        ),
        (
            "/result/interval_degrees_of_freedom",
            json!(1e6 as u64),
            "result.interval_degrees_of_freedom",
        ),
        (
            "/result/degrees_of_freedom",
            json!(1000),
            "result.degrees_of_freedom",
        ),
        (
            "/result/covariance/0/0",
            json!(-variance),
            "result.covariance[0][0]",
        ),
        (
            "/result/covariance/0/0",
            json!(1e308),
            "result.covariance[0][0]",
        ),
        (
            "/result/covariance/0/0",
            json!(100.0 * variance),
            "result.covariance[0][0]",
        ),
        (
            "/result/covariance/0/1",
            json!(1.0),
            "result.covariance[0][1]",
        ),
        (
            "/result/covariance/0/1",
            Value::Null,
            "result.covariance[0][1]",
        ),
        ("/result/covariance", json!([]), "result.covariance"),
        (
            "/result/residual_std_m",
            json!(-1e-5),
            "result.residual_std_m",
        ),
        (
            "/result/residual_std_m",
            json!(1e300),
            "result.residual_std_m",
        ),
        (
            "/result/residual_std_m",
            json!("1"),
            "result.residual_std_m",
        ),
        (
            "/result/posture_common_std_m",
            json!(-1),
            "result.posture_common_std_m",
        ),
        (
            "/result/postures/0/displacement_rms_m",
            json!(-1),
            "result.postures[0].displacement_rms_m",
        ),
        ("/result/postures", json!("all"), "result.postures"),
        (
            "/result/budget/sources/0/change/2",
            json!(-1),
            "result.budget.sources[0].change[2]",
        ),
        (
            "/result/budget/sources/0/change/2",
            json!(-5),
            "result.budget.sources[0].change[2]",
        ),
        (
            "/result/budget/sources/0/change",
            json!([]),
            "result.budget.sources[0].change",
        ),
        (
            "/result/budget/sources/0/change/2",
            json!(0.5),
            "result.budget.posterior.parts[0].response[2]",
        ),
        (
            "/result/budget/combined/2",
            json!(0.5),
            "result.budget.combined[2]",
        ),
        (
            "/result/budget/combined",
            json!([0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1]),
            "result.budget.combined",
        ),
        (
            "/result/budget/posterior/parts/0/source",
            json!("anchor"),
            "result.budget.posterior.parts[0].part",
        ),
        (
            "/result/budget/posterior/parts/0/size",
            json!(0.5),
            "result.budget.posterior.parts[0].size",
        ),
        (
            "/result/budget/posterior/parts/0/response",
            json!([1.0]),
            "result.budget.posterior.parts[0].response",
        ),
        (
            "/result/budget/posterior/parts/11/at_work",
            json!({"lost_motion": 9}),
            "result.budget.posterior.parts[11].at_work",
        ),
        (
            "/result/budget/posterior/mean/1",
            json!(1e300),
            "result.budget.posterior.mean[1]",
        ),
        (
            "/result/budget/posterior/covariance/0/0",
            json!(-1),
            "result.budget.posterior.covariance[0][0]",
        ),
        (
            "/result/budget/posterior/covariance/1/0",
            json!(50),
            "result.budget.posterior.covariance[0][1]",
        ),
        (
            "/result/budget/posterior/covariance/2",
            json!([1.0]),
            "result.budget.posterior.covariance",
        ),
        (
            "/result/budget/posterior/sizes",
            json!(1),
            "result.budget.posterior.sizes",
        ),
        (
            "/result/budget/sources/0/size",
            json!(-1),
            "result.budget.sources[0].size",
        ),
        (
            "/result/budget/sources/0/changes",
            json!([]),
            "result.budget.sources[0].changes",
        ),
        (
            "/result/budget/joints/0",
            json!("A1"),
            "result.budget.joints[0]",
        ),
        ("/result/budget", json!(7), "result.budget"),
        ("/format", json!(2), "format"),
        ("/command", json!("predict"), "command"),
        ("/inputs/cell", json!(3), "inputs.cell"),
    ];
    for (pointer, value, key) in cases {
        let error = read(&changed(pointer, value.clone())).expect_err(pointer);
        let place = error.place();
        assert_eq!(
            place.key.as_deref(),
            Some(key),
            "{pointer} {value}: {error}"
        );
        assert_eq!(place.file.as_deref(), Some("k.json"));
        assert_eq!(error.code(), Code::ResultFile, "{pointer}: {error}");
        assert!(error.hint_text().is_some(), "{error}");
    }
}

#[test]
fn a_missing_estimate_says_why() {
    let mut saved = changed("/result/joints/3/stiffness", Value::Null);
    for (verdict, why) in [
        ("undetermined", "did not determine it"),
        ("lower_bound_only", "only a lower bound"),
        ("sign_or_model_fault", "came out negative"),
    ] {
        saved["result"]["joints"][3]["verdict"] = verdict.into();
        let error = read(&saved).unwrap_err().to_string();
        assert!(error.contains(why) && error.contains("joint 4"), "{error}");
    }
}

#[test]
fn no_covariance_is_no_band_and_no_degree_of_freedom_neither() {
    let mut saved = SAVED.clone();
    for row in saved["result"]["covariance"].as_array_mut().unwrap() {
        for entry in row.as_array_mut().unwrap() {
            *entry = Value::Null;
        }
    }
    assert_eq!(read(&saved).unwrap().compliance.spread, None);
    let mut saved = SAVED.clone();
    saved["result"]["interval_degrees_of_freedom"] = 0.into();
    for joint in saved["result"]["joints"].as_array_mut().unwrap() {
        joint["interval"] = json!([null, null]);
    }
    assert_eq!(read(&saved).unwrap().compliance.spread, None);
}

#[test]
fn lists_by_hand() {
    let k = [1e6, 2e6, 3e6, 1e5, 1e5, 1e5];
    let saved = read(&json!({"stiffness_nm_per_rad": k})).unwrap();
    assert_eq!(saved.compliance.spread, None);
    let joints: Vec<Value> = k.iter().map(|k| json!({"stiffness": k})).collect();
    let by_hand = read(&json!({"joints": joints})).unwrap();
    assert_eq!(by_hand.compliance, saved.compliance);

    let error = read(&json!({"stiffness_nm_per_rad": k, "confidence": 0.9})).unwrap_err();
    assert_eq!(error.place().key.as_deref(), Some("confidence"));
    let error = read(&json!({"joints": joints, "stiffnes_nm_per_rad": k})).unwrap_err();
    assert_eq!(error.place().key.as_deref(), Some("stiffnes_nm_per_rad"));
    let mut joints = joints;
    joints[2]["compliance"] = 1e-6.into();
    let error = read(&json!({"joints": joints})).unwrap_err();
    assert_eq!(error.place().key.as_deref(), Some("joints[2].compliance"));
}

#[test]
fn a_key_twice_and_a_number_beyond_all_are_named() {
    let read = |text: &str| read_stiffness(text.as_bytes(), "k.json", &cell()).unwrap_err();
    let error = read("{\"a\": 1,\n\"a\": 2}");
    assert!(error.message().contains("\"a\" stands twice"), "{error}");
    assert_eq!(error.place().line, Some(2));
    let error = read("{\"stiffness_nm_per_rad\": [1e999]}");
    assert!(error.message().contains("out of range"), "{error}");
    let deep = "[".repeat(100_000);
    assert_eq!(read(&deep).code(), Code::ResultFile);
}
