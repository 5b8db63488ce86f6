//! `validate`: bands of saved estimates, and folds without any.

use crate::support;

use insta::assert_snapshot;
use support::Folder;

/// A folder with simulated measurements of Group 1's six postures.
fn measured() -> Folder {
    let folder = Folder::new();
    folder.ok("simulate builtin:comau builtin:comau-group1 --runs 1 --levels 1 --measurements simulated.csv");
    folder
}

fn transcript(folder: &Folder, line: &str) -> String {
    folder.run(line).transcript(line)
}

#[test]
fn each_posture_is_predicted_from_the_others() {
    let folder = measured();
    let line = "validate builtin:comau simulated.csv --folds all --tolerance-mm 0.1";
    assert_snapshot!(transcript(&folder, line));
    let value = folder
        .json("validate builtin:comau simulated.csv --folds 3 --estimator ordinary --terms tilt2");
    assert_eq!(value["result"]["folds"], 3);
    assert_eq!(value["options"]["fit"]["estimator"], "ordinary");
    assert_eq!(value["options"]["fit"]["extra"][0]["joint_tilt"], 1);
    assert_eq!(value["result"]["band"]["components"], 72);
    // Leave one out is six folds here.
    let six = folder.json("validate builtin:comau simulated.csv --folds 6");
    let all = folder.json("validate builtin:comau simulated.csv --folds all");
    assert_eq!(six["result"], all["result"]);
    let strict =
        folder.run("validate builtin:comau simulated.csv --folds all --tolerance-mm 0.001");
    assert_eq!(strict.code, Some(1));
}

#[test]
fn saved_further_terms_are_used_and_not_lost() {
    let folder = measured();
    // A result with a further term, as the library writes it.
    let cell = stiffarm::files::builtin::cell_text("comau").unwrap();
    let cell = stiffarm::files::cell::parse_cell(cell, "comau").unwrap();
    let table = folder.read("simulated.csv");
    let data =
        stiffarm::files::table::read_displacements(table.as_bytes(), "simulated.csv", &cell, None)
            .unwrap();
    let options = {
        let mut options = stiffarm::IdentifyOptions::default();
        options.extra = vec![stiffarm::model::observation::ExtraTerm::JointTilt(2)];
        options
    };
    let fit = stiffarm::estimate::identify::identify(&cell, &data, &options).unwrap();
    let mut saved = serde_json::to_value(&fit).unwrap();
    folder.write("tilt.json", saved.to_string());
    let with = folder.json("validate builtin:comau tilt.json simulated.csv");
    let tilt = &mut saved["extra_springs"][0];
    tilt["compliance"] = 1e-6.into();
    tilt["stiffness"] = 1e6.into();
    tilt["standard_error"] = serde_json::Value::Null;
    tilt["interval"] = serde_json::json!([null, null]);
    folder.write("soft.json", saved.to_string());
    let soft = folder.json("validate builtin:comau soft.json simulated.csv");
    let rms = |v: &serde_json::Value| v["result"]["component_rms_m"].as_f64().unwrap();
    assert!((rms(&with) / fit.residual_rms_m - 1.0).abs() < 1e-9);
    assert!(rms(&soft) > 2.0 * rms(&with));
    for (file, line) in [
        (
            "exact",
            "validate builtin:comau tilt.json simulated.csv --model equilibrium",
        ),
        ("broken", "validate builtin:comau broken.json simulated.csv"),
    ] {
        saved["covariance"] = "lost".into();
        folder.write("broken.json", saved.to_string());
        let ran = folder.run(line);
        assert_eq!(ran.code, Some(2), "{file}");
        let wanted = if file == "exact" {
            "cannot use further terms"
        } else {
            "cannot be read"
        };
        assert!(ran.err.contains(wanted), "{}", ran.err);
    }
}

#[test]
fn wrong_requests_are_answered() {
    let folder = measured();
    folder.ok("identify builtin:comau simulated.csv --output k.json");
    let lines = [
        "validate builtin:comau simulated.csv",
        "validate builtin:comau k.json simulated.csv --folds 3",
        "validate builtin:comau k.json simulated.csv --estimator huber",
        "validate builtin:comau simulated.csv --folds 7",
        "validate builtin:comau simulated.csv --folds 1",
        "validate builtin:comau simulated.csv --folds 3 --terms tilt9",
        "validate builtin:comau simulated.csv --folds 3 --estimator best",
        "validate builtin:comau simulated.csv --folds 3 --model equilibrium",
        "validate builtin:comau simulated.csv --folds 3 --confidence 95",
        "validate builtin:comau",
    ];
    let said: Vec<String> = lines.iter().map(|line| transcript(&folder, line)).collect();
    assert_snapshot!(said.join("\n"));
}
