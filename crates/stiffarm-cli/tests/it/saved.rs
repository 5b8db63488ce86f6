//! What `identify` writes is read by the commands that use it, or refused with a reason.

use crate::support;

use serde_json::{Value, json};
use support::{Folder, measurements, readings, stiffness};

/// A table of displacements with dx, dy and dz in inches under the heading of millimetres.
pub fn in_inches(folder: &Folder, from: &str, to: &str) {
    let text = folder.read(from);
    let mut lines = text.lines();
    let heading = lines.find(|line| line.contains("dx_mm")).unwrap();
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
    for line in [
        "predict builtin:comau inch.json builtin:contour",
        "compensate builtin:comau inch.json builtin:contour",
        "map builtin:comau inch.json --plane z=800 --steps 3",
    ] {
        let ran = folder.run(line);
        assert_eq!(ran.code, Some(1), "{line}\n{}", ran.err);
        assert!(ran.out.starts_with("SERIOUS: "), "{line}\n{}", ran.out);
        let last = ran.out.rfind("SERIOUS").unwrap();
        assert!(last < ran.out.find("cell: ").unwrap(), "{line}\n{}", ran.out);
        // And on the page: before the first number of the verdict.
        let told = folder.run(&format!("{line} --json --report page.html --force"));
        let told: Value = serde_json::from_str(&told.out).unwrap();
        let first = &told["result"]["findings"][0];
        assert_eq!(first["code"], "stiffness-doubtful", "{line}");
        assert_eq!(first["severity"], "serious", "{line}");
        let page = folder.read("page.html");
        for words in ["Not usable as it is", "Do not use these numbers"] {
            assert!(page.contains(words), "{line}: {words}");
        }
        let verdict = page.find("<p class=\"result\">").unwrap();
        let said = page[verdict..].find("The stiffness cannot be used as it is").unwrap();
        assert!(said < page[verdict..].find("data-value").unwrap(), "{line}");
    }
    // No correction is written but where it is asked for.
    let line = "compensate builtin:comau inch.json builtin:contour --output go.csv --figure go.svg";
    let ran = folder.run(line);
    assert_eq!(ran.code, Some(1), "{}", ran.out);
    assert!(ran.err.contains("Nothing was written"), "{}", ran.err);
    let names = folder.names();
    assert!(!names.iter().any(|name| name.starts_with("go")), "{names:?}");
    let ran = folder.run(&format!("{line} --json"));
    assert_eq!(ran.code, Some(1));
    assert!(ran.err.contains("--beyond-data"), "{}", ran.err);
    let ran = folder.run(&format!("{line} --beyond-data"));
    assert_eq!(ran.code, Some(1), "{}", ran.out);
    assert!(folder.names().contains(&"go.csv".to_string()));
}

/// A force beyond those of the experiment.
#[test]
fn corrections_beyond_the_data_are_written_where_they_are_asked_for() {
    let folder = Folder::with("k.json", stiffness());
    let said = folder.ok("compensate builtin:comau k.json builtin:contour --output a.csv");
    assert!(!said.contains("beyond its data"), "{said}");
    folder.write("path.csv", "point,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n1,0,0,-90,0,20,0\n2,2,0,-90,0,20,0\n");
    let line = "compensate builtin:comau k.json path.csv --axes base --force-n 0,0,-20000 --output b.csv";
    let ran = folder.run(line);
    assert_eq!(ran.code, Some(1), "{}{}", ran.out, ran.err);
    assert!(ran.out.contains("larger force than any"), "{}", ran.out);
    assert!(!folder.names().contains(&"b.csv".to_string()));
    folder.run(&format!("{line} --beyond-data"));
    assert!(folder.names().contains(&"b.csv".to_string()));
}

#[test]
fn an_edited_result_is_refused_by_every_command() {
    let folder = measured();
    folder.ok("identify builtin:comau m.csv --brief --elastic mixed --output k.json");
    let saved: Value = serde_json::from_str(&folder.read("k.json")).unwrap();
    let (sealed, rest) = ("result.sealed", "no longer belong together");
    for (pointer, value, said) in [
        ("/result/sealed/values/0", json!(1e-9), sealed),
        ("/result/joints/0/stiffness", Value::Null, rest),
        ("/inputs/cell", json!("abc"), rest),
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
            let why = folder.refused(line);
            let why = why.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(why.contains(said), "{line} with {pointer}\n{why}");
        }
    }
    // Another layout is no edit.
    folder.write("short.json", saved.to_string());
    folder.ok("predict builtin:comau short.json");
    folder.ok("report short.json --output short.html");
}

#[test]
fn what_the_mixed_model_cannot_use_is_refused() {
    let folder = Folder::with("m.csv", measurements());
    for (options, words) in [
        ("--elastic mixed --extra tilt3", "leave the extra terms out"),
        ("--elastic mixed --estimator ordinary", "two-variance"),
        ("--elastic mixed --noise known", "noise from the residuals"),
    ] {
        let ran = folder.run(&format!("identify builtin:comau m.csv {options}"));
        assert_eq!(ran.code, Some(2), "{options}: {}", ran.out);
        assert!(ran.err.contains(words) && ran.err.contains("--elastic"), "{}", ran.err);
    }
    // Two postures show nothing beyond the axes, and it is said.
    let ran = folder.run("identify builtin:comau m.csv --elastic mixed --brief --exclude 1,2,3,4");
    assert!(ran.out.contains("Fewer than 4 postures cannot show"), "{}{}", ran.out, ran.err);
}

#[test]
fn what_is_free_is_told_and_what_cannot_be_is_refused() {
    let folder = measured();
    let ran = folder.run("identify builtin:comau r.csv --free anchor,common-shift --details --output k.json");
    assert!(matches!(ran.code, Some(0 | 1)), "{}{}", ran.out, ran.err);
    assert!(ran.out.contains("With it these readings gave the anchor at ("), "{}", ran.out);
    assert!(ran.out.contains("these readings"), "{}", ran.out);
    let saved: Value = serde_json::from_str(&folder.read("k.json")).unwrap();
    let freed = saved["result"]["freed"].as_array().unwrap();
    let names: Vec<&str> = freed.iter().filter_map(|own| own["name"].as_str()).collect();
    assert_eq!(names, ["anchor", "common-shift"]);
    assert_eq!(freed[0]["key"], "load.anchor_mm");
    assert_eq!(saved["options"]["free"], json!(["anchor", "common-shift"]));
    folder.run("predict builtin:comau k.json --force");
    for (options, words) in [
        ("--free anchr", "did you mean \"anchor\"?"),
        ("--free force-scale", "No reading tells"),
        ("--free lost-motion", "extra term"),
        ("--free sensor-axes", "they do on anchor"),
        ("--free anchor --brief", "cannot be used with '--brief'"),
        ("--free anchor --bootstrap 200", "cannot be used with '--bootstrap"),
    ] {
        let ran = folder.run(&format!("identify builtin:comau r.csv {options}"));
        assert_eq!(ran.code, Some(2), "{options}: {}", ran.out);
        let is_said = ran.err.contains(words) && ran.err.contains("--free");
        assert!(is_said, "{options}: {}", ran.err);
    }
}
