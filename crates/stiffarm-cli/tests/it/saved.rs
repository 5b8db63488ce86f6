//! What `identify` writes is read by the commands that use it, or refused with a reason.

use crate::support;

use insta::assert_snapshot;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use support::{
    Folder, codes, in_lines, measurements, paragraphs, place, printed_sentence, readings, sentence, stiffness, unbroken,
};

/// A table of displacements with dx, dy and dz in inches under the heading of millimetres.
pub fn in_inches(folder: &Folder, from: &str, to: &str) {
    let text = folder.read(from);
    let mut lines = text.lines();
    let heading = lines.find(|line| line.split(',').any(|name| name == "dx_mm")).unwrap();
    let columns: Vec<&str> = heading.split(',').collect();
    let mut out = vec![heading.to_string()];
    for line in lines {
        let fields = line.split(',').zip(&columns).map(|(field, column)| {
            if ["dx_mm", "dy_mm", "dz_mm"].contains(column) {
                (field.parse::<f64>().unwrap() / 25.4).to_string()
            } else {
                field.to_string()
            }
        });
        out.push(fields.collect::<Vec<_>>().join(","));
    }
    folder.write(to, out.join("\n") + "\n");
}

fn measured() -> Folder {
    let folder = Folder::with("m.csv", measurements());
    folder.write("r.csv", readings());
    folder
}

#[test]
fn every_kind_of_result_is_read_back() {
    let folder = measured();
    let kinds = [
        "m.csv",
        "m.csv --brief",
        "m.csv --extra tilt2,lost",
        "m.csv --elastic axes",
        "m.csv --bootstrap 200 --estimator ordinary",
        "m.csv --estimator huber --confidence 0.999",
        "m.csv --estimator non-negative --noise known",
        "r.csv",
    ];
    for kind in kinds {
        let line = format!("identify builtin:comau {kind} --output k.json --force");
        let ran = folder.run(&line);
        assert!(matches!(ran.code, Some(0 | 1)), "{line}: {}", ran.err);
        // Whatever the joints came out as.
        for line in ["validate builtin:comau k.json m.csv", "predict builtin:comau k.json"] {
            let used = folder.run(line);
            let is_read = matches!(used.code, Some(0 | 1));
            // The exact equilibrium of `validate` alone has no extra terms.
            assert!(is_read, "{kind}: {line}: {}", used.err);
        }
    }
}

/// Displacements in inches: `identify` finds the scale, and what is calculated with its
/// result says so first.
#[test]
fn a_scale_that_was_found_goes_with_the_stiffness() {
    let folder = measured();
    in_inches(&folder, "m.csv", "inch.csv");
    let ran = folder.run("identify builtin:comau inch.csv --output inch.json");
    assert_eq!(ran.code, Some(1), "{}", ran.out);
    let saved: Value = serde_json::from_str(&folder.read("inch.json")).unwrap();
    assert!(saved["result"]["screening"].is_object());
    let mut verdicts = BTreeSet::new();
    for line in [
        "predict builtin:comau inch.json builtin:contour",
        "compensate builtin:comau inch.json builtin:contour",
        "map builtin:comau inch.json --plane z=800 --steps 3",
    ] {
        let ran = folder.run(line);
        assert_eq!(ran.code, Some(1), "{line}\n{}", ran.err);
        let last = ran.out.rfind("SERIOUS").unwrap();
        assert!(last < ran.out.find("cell: ").unwrap(), "{line}\n{}", ran.out);
        let answer = folder.run(&format!("{line} --json --report page.html --force"));
        let answer: Value = serde_json::from_str(&answer.out).unwrap();
        let first = &answer["result"]["findings"][0];
        assert_eq!(first["code"], "stiffness-doubtful", "{line}");
        assert_eq!(first["severity"], "serious", "{line}");
        let sentence = first["sentence"].as_str().unwrap();
        assert!(unbroken(&ran.out).starts_with(&format!("SERIOUS: {sentence}")), "{line}\n{}", ran.out);
        // And on the page: before the first number of the verdict.
        let verdict = paragraphs(&folder.read("page.html"), "verdict");
        let [status, _, result, next] = verdict.lines().collect::<Vec<_>>()[..] else { panic!("{line}\n{verdict}") };
        assert!(result.starts_with(sentence), "{line}\n{verdict}");
        verdicts.insert([status, sentence, next].join("\n"));
    }
    assert_snapshot!(verdicts.into_iter().collect::<Vec<_>>().join("\n"), @r"
    ✗ Not usable as it is
    The stiffness cannot be used as it is, its readings have a serious fault (The displacements look like inches under a heading in millimetres: factor 25.4): correct them and identify again.
    Do not use these numbers: correct the readings behind the stiffness, identify again, and then this again.
    ");
    // No correction is written but where it is asked for.
    let line = "compensate builtin:comau inch.json builtin:contour --output go.csv --figure go.svg";
    let ran = folder.run(line);
    assert_eq!(ran.code, Some(1), "{}", ran.out);
    assert_snapshot!(ran.err, @"Nothing was written: the findings say why. `--beyond-data` writes it all the same.");
    let names = folder.names();
    assert!(!names.iter().any(|name| name.starts_with("go")), "{names:?}");
    let with_object = folder.run(&format!("{line} --json"));
    assert_eq!((with_object.code, with_object.err), (Some(1), ran.err));
    let ran = folder.run(&format!("{line} --beyond-data"));
    assert_eq!(ran.code, Some(1), "{}", ran.out);
    assert!(folder.path("go.csv").exists());
}

/// A force beyond those of the experiment.
#[test]
fn corrections_beyond_the_data_are_written_where_they_are_asked_for() {
    let folder = Folder::with("k.json", stiffness());
    folder.ok("compensate builtin:comau k.json builtin:contour --output a.csv");
    let findings = folder.json("compensate builtin:comau k.json builtin:contour")["result"]["findings"].clone();
    assert_eq!(codes(&findings), ["correction-beyond-uncertainty", "tip-assumed", "never-turned"]);
    folder.write("path.csv", "point,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n1,0,0,-90,0,20,0\n2,2,0,-90,0,20,0\n");
    let line = "compensate builtin:comau k.json path.csv --axes base --force-n 0,0,-20000";
    let findings = folder.json(line)["result"]["findings"].clone();
    let beyond = ["beyond-measured", "beyond-load", "tip-assumed", "implausible-load", "never-turned"];
    assert_eq!(codes(&findings), [&["correction-beyond-uncertainty"], &beyond[..]].concat());
    assert_snapshot!(beyond[..2].iter().map(|code| sentence(&findings, code)).collect::<Vec<_>>().join("\n"), @r"
    100 % of the points bend by more than any displacement that the identification has seen (3.145 mm): the model is trusted beyond its data there.
    100 % of the points are under a larger force than any that the identification has seen (500 N): the model is trusted beyond its data there.
    ");
    let line = format!("{line} --output b.csv");
    let ran = folder.run(&line);
    assert_eq!(ran.code, Some(1), "{}{}", ran.out, ran.err);
    assert!(unbroken(&ran.out).contains(sentence(&findings, "beyond-load")), "{}", ran.out);
    assert!(!folder.path("b.csv").exists());
    folder.run(&format!("{line} --beyond-data"));
    assert!(folder.path("b.csv").exists());
}

#[test]
fn an_edited_result_is_refused_by_every_command() {
    let folder = measured();
    folder.ok("identify builtin:comau m.csv --brief --elastic mixed --output k.json");
    let saved: Value = serde_json::from_str(&folder.read("k.json")).unwrap();
    let mut messages = BTreeSet::new();
    for (pointer, value) in [
        ("/result/sealed/values/0", json!(1e-9)),
        ("/result/joints/0/stiffness", Value::Null),
        ("/inputs/cell", json!("abc")),
    ] {
        let mut edited = saved.clone();
        *edited.pointer_mut(pointer).unwrap() = value;
        folder.write("edited.json", edited.to_string());
        for line in [
            "predict builtin:comau edited.json",
            "validate builtin:comau edited.json m.csv",
            "compensate builtin:comau edited.json builtin:contour",
            "map builtin:comau edited.json --plane z=800 --steps 2",
            "report edited.json",
        ] {
            let error = folder.error(line);
            assert_eq!(error["code"], "result-file", "{line} with {pointer}");
            folder.refused(line);
            messages.insert(format!("{pointer}: {}: {}\n", place(&error), error["message"].as_str().unwrap()));
        }
    }
    assert_snapshot!(messages.into_iter().collect::<String>(), @r"
    /inputs/cell: edited.json: The file was changed after it was written, beside what is calculated with: its numbers no longer belong together.
    /result/joints/0/stiffness: edited.json: The file was changed after it was written, beside what is calculated with: its numbers no longer belong together.
    /result/sealed/values/0: edited.json result.sealed: What is calculated with was changed after it was written.
    ");
    // Another layout is no edit.
    folder.write("short.json", saved.to_string());
    folder.ok("predict builtin:comau short.json");
    folder.ok("report short.json --output short.html");
}

#[test]
fn what_the_mixed_model_cannot_use_is_refused() {
    let folder = Folder::with("m.csv", measurements());
    let refused = folder.each_refused(&[
        ("identify builtin:comau m.csv --elastic mixed --extra tilt3", "conflict", "--elastic"),
        ("identify builtin:comau m.csv --elastic mixed --estimator ordinary", "conflict", "--elastic"),
        ("identify builtin:comau m.csv --elastic mixed --noise known", "conflict", "--elastic"),
    ]);
    assert_snapshot!(refused);
    // Two postures show nothing beyond the axes, and it is said.
    let line = "identify builtin:comau m.csv --elastic mixed --brief --exclude 1,2,3,4";
    let elastic = folder.json(line)["result"]["elastic"].clone();
    assert_eq!(elastic["model"], "axes");
    let shown = elastic["reasons"][0].as_str().unwrap();
    assert_snapshot!(shown, @"The joint axes alone predict. Fewer than 4 postures cannot show what gives way beyond them.");
    assert!(unbroken(&folder.ok(line)).contains(shown));
}

#[test]
fn what_is_free_is_told_and_what_cannot_be_is_refused() {
    let folder = measured();
    let ran = folder.run("identify builtin:comau r.csv --free anchor,common-shift --details --output k.json");
    assert!(matches!(ran.code, Some(0 | 1)), "{}{}", ran.out, ran.err);
    assert_snapshot!(in_lines(printed_sentence(&ran.out, "With it these readings")), @r"
    With it these readings gave the anchor at (1803, 10, 12) ± 39 mm; load.anchor_mm has (1800, 0, 0)
    and a shift common to all loaded readings, (0.01, −0.01, 0.01) ± 0.01 mm.
    ");
    let saved: Value = serde_json::from_str(&folder.read("k.json")).unwrap();
    let freed = saved["result"]["freed"].as_array().unwrap();
    let names: Vec<&str> = freed.iter().filter_map(|quantity| quantity["name"].as_str()).collect();
    assert_eq!(names, ["anchor", "common-shift"]);
    assert_eq!(freed[0]["key"], "load.anchor_mm");
    assert_eq!(saved["options"]["free"], json!(["anchor", "common-shift"]));
    folder.run("predict builtin:comau k.json --force");
    let refused = folder.each_refused(&[
        ("identify builtin:comau r.csv --free anchr", "unknown-name", "--free"),
        ("identify builtin:comau r.csv --free force-scale", "unknown-name", "--free"),
        ("identify builtin:comau r.csv --free lost-motion", "unknown-name", "--free"),
        ("identify builtin:comau r.csv --free sensor-axes", "unsupported", "--free"),
        ("identify builtin:comau r.csv --free anchor --brief", "usage", "--free"),
        ("identify builtin:comau r.csv --free anchor --bootstrap 200", "usage", "--free"),
    ]);
    assert_snapshot!("free_refused", refused);
}
