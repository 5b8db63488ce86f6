//! What `identify` writes is read by the commands that use it, or refused with a reason.

use crate::support;

use serde_json::Value;
use support::Folder;

#[test]
fn every_kind_of_result_is_read_back() {
    let folder = Folder::new();
    folder.ok("simulate builtin:comau builtin:comau-group1 --runs 1 --levels 1 --measurements m.csv --readings r.csv");
    let kinds = [
        "m.csv",
        "m.csv --brief",
        "m.csv --terms tilt2,lost",
        "m.csv --elastic mixed",
        "m.csv --elastic auto --brief",
        "m.csv --bootstrap 200 --estimator ordinary",
        "m.csv --estimator huber --confidence 0.999",
        "m.csv --estimator non-negative --noise known",
        "r.csv",
    ];
    for kind in kinds {
        let line = format!("identify builtin:comau {kind} --output k.json --force");
        let ran = folder.run(&line);
        assert!(matches!(ran.code, Some(0 | 1)), "{line}: {}", ran.err);
        let used = folder.run("validate builtin:comau k.json m.csv");
        let saved: Value = serde_json::from_str(&folder.read("k.json")).unwrap();
        let joints = saved["result"]["joints"].as_array().unwrap().iter();
        match joints
            .clone()
            .all(|j| j["stiffness"].as_f64().is_some_and(|k| k > 0.0))
        {
            true => assert_eq!(used.code, Some(0), "{line}: {}", used.err),
            false => {
                assert_eq!(used.code, Some(2), "{line}");
                assert!(
                    used.err.contains("The file has no stiffness of"),
                    "{}",
                    used.err
                );
            }
        }
    }
}

#[test]
fn an_edited_result_is_refused_with_the_key() {
    let folder = Folder::new();
    folder
        .ok("simulate builtin:comau builtin:comau-group1 --runs 1 --levels 1 --measurements m.csv");
    folder.ok("identify builtin:comau m.csv --output k.json");
    let saved: Value = serde_json::from_str(&folder.read("k.json")).unwrap();
    for (pointer, value, key) in [
        ("/result/confidence", 95.0, "result.confidence"),
        (
            "/result/joints/0/stiffness",
            1e5,
            "result.joints[0].compliance",
        ),
        ("/result/covariance/0/0", -1e-20, "result.covariance[0][0]"),
    ] {
        let lines = [
            "predict builtin:comau edited.json",
            "validate builtin:comau edited.json m.csv",
        ];
        refused(&folder, &saved, pointer, value.into(), &lines, key);
    }
}

/// With one value changed no line takes `edited.json`, and each names the key.
fn refused(folder: &Folder, saved: &Value, pointer: &str, value: Value, lines: &[&str], key: &str) {
    let mut edited = saved.clone();
    *edited.pointer_mut(pointer).unwrap() = value;
    folder.write("edited.json", edited.to_string());
    for line in lines {
        let why = folder.refused(line);
        assert!(why.contains(key), "{line} with {pointer}\n{why}");
    }
}

#[test]
fn an_edited_mixed_model_is_refused_with_the_key() {
    let folder = Folder::new();
    folder
        .ok("simulate builtin:comau builtin:comau-group1 --runs 1 --levels 1 --measurements m.csv");
    folder.ok("identify builtin:comau m.csv --brief --elastic mixed --output k.json");
    let saved: Value = serde_json::from_str(&folder.read("k.json")).unwrap();
    let lines = ["predict builtin:comau edited.json builtin:contour"];
    for (pointer, value, key) in [
        ("/joints/1/compliance", 2.0, "joints[1].compliance"),
        ("/joints/1/stiffness", 1e3, "joints[1].compliance"),
        (
            "/springs/3/compliance/5/5",
            1e-9,
            "springs[3].compliance[5][5]",
        ),
        (
            "/springs/0/compliance/1/2",
            0.5,
            "springs[0].compliance[1][2]",
        ),
        ("/springs/2/joint", 5.0, "springs[2].joint"),
        (
            "/covariance/0/0",
            -1e-20,
            "joints[0].compliance_standard_error",
        ),
        ("/covariance/9/2", 1e-3, "covariance[2][9]"),
        ("/residual_std_m", -1.0, "residual_std_m"),
        (
            "/interval_degrees_of_freedom",
            0.0,
            "interval_degrees_of_freedom",
        ),
    ] {
        let value = match key.ends_with("joint") || key.contains("degrees") {
            true => (value as u64).into(),
            false => value.into(),
        };
        let pointer = format!("/result/elastic/mixed{pointer}");
        refused(&folder, &saved, &pointer, value, &lines, key);
    }
    // One number of the covariance less, another model, a key of somebody else.
    for (pointer, value, key) in [
        (
            "/result/elastic/mixed/covariance/3",
            "[]",
            "result.elastic.mixed.covariance",
        ),
        ("/result/elastic/model", "\"axes\"", "result.elastic.model"),
        ("/result/elastic/mixed", "null", "result.elastic.model"),
        ("/result/elastic/mixed/sizes", "3", "result.elastic"),
    ] {
        let value = serde_json::from_str(value).unwrap();
        refused(&folder, &saved, pointer, value, &lines, key);
    }
}

#[test]
fn what_the_mixed_model_cannot_use_is_refused() {
    let folder = Folder::new();
    folder
        .ok("simulate builtin:comau builtin:comau-group1 --runs 1 --levels 1 --measurements m.csv");
    for (options, words) in [
        (
            "--elastic mixed --terms tilt3",
            "leave the further terms out",
        ),
        ("--elastic auto --estimator ordinary", "two-variance"),
        ("--elastic mixed --noise known", "noise from the residuals"),
    ] {
        let ran = folder.run(&format!("identify builtin:comau m.csv {options}"));
        assert_eq!(ran.code, Some(2), "{options}: {}", ran.out);
        assert!(
            ran.err.contains(words) && ran.err.contains("--elastic"),
            "{}",
            ran.err
        );
    }
    // Two postures show nothing beyond the axes, and it is said.
    let ran = folder.run("identify builtin:comau m.csv --elastic mixed --brief --exclude 1,2,3,4");
    assert!(
        ran.out.contains("2 postures cannot show what gives way"),
        "{}{}",
        ran.out,
        ran.err
    );
}
