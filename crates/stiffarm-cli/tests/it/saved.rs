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
        let mut edited = saved.clone();
        *edited.pointer_mut(pointer).unwrap() = value.into();
        folder.write("edited.json", edited.to_string());
        for line in [
            "predict builtin:comau edited.json",
            "validate builtin:comau edited.json m.csv",
        ] {
            let ran = folder.run(line);
            assert_eq!(ran.code, Some(2), "{line}\n{}", ran.out);
            assert!(ran.err.contains(key), "{}", ran.err);
        }
    }
}
