//! Any saved result is read back as what was written, or refused with a reason.

use crate::common::cases::slip;
use crate::common::prelude::*;
use serde_json::{Value, json};
use stiffarm::study::{Study, StudyOptions, study};
use stiffarm_files::envelope::write_result;
use stiffarm_files::result::{SavedResult, read_result};

fn wrapped(result: Value) -> Value {
    json!({
        "format": 1,
        "stiffarm": "0.1.0",
        "command": "study",
        "arguments": ["study", "{cell}"],
        "inputs": {"cell": "ab12"},
        "seed": 7,
        "options": {},
        "result": result,
    })
}

fn small_study() -> Study {
    let cell = builtin::cell("comau").unwrap();
    let group = PostureGroup {
        name: "Group 1".to_string(),
        postures: builtin::postures("comau-group1", &cell.setup.robot).unwrap(),
    };
    let mut options = StudyOptions::default();
    options.simulation.runs = 3;
    options.starts = 2;
    options.q1_draws = 5;
    options.max_iterations = 20;
    study(&cell, &group, &options, Control::default()).unwrap()
}

#[test]
fn a_study_is_read_back_to_the_last_bit() {
    let written = small_study();
    let value = wrapped(serde_json::to_value(&written).unwrap());
    let text = write_result(&value).unwrap();
    let saved = read_result(text.as_bytes(), "study.json").unwrap();
    assert_eq!(saved.command, "study");
    assert_eq!((saved.seed, saved.input("cell")), (Some(7), Some("ab12")));
    assert_eq!(saved.arguments, ["study", "{cell}"]);
    let read: Study = saved.result().unwrap();
    assert_eq!(serde_json::to_value(&read).unwrap(), value["result"]);
    // Angles go through degrees; everything else is the same to the last bit.
    for (a, b) in written.groups.iter().zip(&read.groups) {
        assert_eq!(a.evaluation, b.evaluation);
        assert_eq!(a.identification.is_some(), b.identification.is_some());
        for (a, b) in a.identification.iter().zip(&b.identification) {
            assert_eq!(a.estimates, b.estimates);
            assert_eq!(a.points, b.points);
            for (a, b) in a.postures.iter().zip(&b.postures) {
                assert_eq!(a.residuals, b.residuals);
                let same = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-15;
                assert!(a.angles.iter().zip(&b.angles).all(same), "{a:?} {b:?}");
            }
        }
    }
    for finding in &written.findings {
        assert!(read.every_finding().contains(finding), "{finding:?}");
    }
}

#[test]
fn a_selection_keeps_its_indices() {
    let cell = builtin::cell("comau-reference").unwrap();
    let postures = builtin::postures("comau-group1", &cell.setup.robot).unwrap();
    let group = PostureGroup { name: "Group 1".to_string(), postures };
    let options = Default::default();
    let selection = select_from(&cell, Index::ExpectedError, &group.postures, options, Control::default());
    let selection = selection.unwrap();
    let value = serde_json::to_value(&selection).unwrap();
    let read: Selection = serde_json::from_value(value.clone()).unwrap();
    assert_eq!(read.evaluation.indices, selection.evaluation.indices);
    assert_eq!(serde_json::to_value(&read).unwrap(), value);
}

#[test]
fn what_is_no_result_is_refused() {
    let refused = |text: &str| read_result(text.as_bytes(), "x.json").unwrap_err();
    let error = refused("{\"format\": 1,\n \"a\" }");
    assert_eq!((error.code(), error.place().line), (Code::ResultFile, Some(2)));
    let mut report = String::new();
    for text in [
        "[]",
        r#"{"format": 3}"#,
        r#"{"format": 1, "command": "study"}"#,
        r#"{"error": {"message": "No."}}"#,
        r#"{"format": 1, "format": 1}"#,
    ] {
        let error = refused(text);
        assert_eq!(error.code(), Code::ResultFile, "{text}: {error}");
        assert_eq!(error.place().file.as_deref(), Some("x.json"), "{text}");
        report += &slip::<()>(text, Err(error));
    }
    // One number more or less, and a seal that was taken off.
    let text = write_result(&wrapped(json!({"a": [1.0, 2.5], "b": "c"}))).unwrap();
    assert!(read_result(text.as_bytes(), "x.json").is_ok());
    for (old, new) in [("2.5", "2.6"), ("\"c\"", "\"d\""), ("\"seed\": 7", "\"seed\": 8")] {
        let edited = text.replacen(old, new, 1);
        assert_ne!(edited, text);
        report += &slip::<()>(new, Err(refused(&edited)));
    }
    insta::assert_snapshot!("no_results", report);
    let bare = serde_json::to_string(&wrapped(json!({}))).unwrap();
    let error = refused(&bare);
    assert_eq!(error.place().key.as_deref(), Some("seal"), "{error}");
    // A result of another shape names its version.
    let value = wrapped(json!({"cell": 3}));
    let saved = SavedResult::of(&value, "result").unwrap();
    insta::assert_snapshot!(saved.result::<Study>().unwrap_err(), @"
    result: result: The result of `study` cannot be read: invalid type: integer `3`, expected a string.
      hint: it was written by version 0.1.0; make it again with this version
    ");
}
