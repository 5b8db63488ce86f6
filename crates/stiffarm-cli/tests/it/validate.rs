//! `validate`: bands of saved estimates, and folds without any.

use crate::support;

use insta::assert_snapshot;
use support::{Folder, measurements, paragraphs, unbroken};

/// A folder with simulated measurements of Group 1's six postures.
fn measured() -> Folder {
    Folder::with("simulated.csv", measurements())
}

#[test]
fn each_posture_is_predicted_from_the_others() {
    let folder = measured();
    let line = "validate builtin:comau simulated.csv --folds all --tolerance-mm 0.1";
    assert_snapshot!(folder.transcript(line));
    let value = folder.json("validate builtin:comau simulated.csv --folds 3 --estimator ordinary --extra tilt2");
    assert_eq!(value["result"]["folds"], 3);
    assert_eq!(value["options"]["fit"]["estimator"], "ordinary");
    assert_eq!(value["options"]["fit"]["extra"][0]["joint_tilt"], 1);
    assert_eq!(value["result"]["band"]["components"], 72);
    let strict = folder.run("validate builtin:comau simulated.csv --folds all --tolerance-mm 0.001");
    assert_eq!(strict.code, Some(1));
}

#[test]
fn saved_further_terms_are_used_and_not_lost() {
    let folder = measured();
    let fit = folder.json("identify builtin:comau simulated.csv --extra tilt3 --estimator ordinary --output tilt.json");
    let with = folder.json("validate builtin:comau tilt.json simulated.csv");
    let rms = with["result"]["component_rms_m"].as_f64().unwrap();
    let residual = fit["result"]["residual_rms_m"].as_f64().unwrap();
    assert!((rms / residual - 1.0).abs() < 1e-9, "{rms} {residual}");
    let line = "validate builtin:comau tilt.json simulated.csv --model equilibrium";
    assert_snapshot!(folder.each_refused(&[(line, "unsupported", "")]), @"
    $ stiffarm validate builtin:comau tilt.json simulated.csv --model equilibrium
    unsupported

      × The equilibrium model holds the axes' springs alone.
      help: use the linear model, or identify with --elastic axes and without --extra
    ");
}

/// A stiffness that was identified from displacements in inches: it is said first, and the
/// errors would not have been smaller.
#[test]
fn a_serious_stiffness_comes_first_and_ends_with_one() {
    let folder = measured();
    crate::saved::in_inches(&folder, "simulated.csv", "inch.csv");
    let ran = folder.run("identify builtin:comau inch.csv --output inch.json");
    assert_eq!(ran.code, Some(1), "{}", ran.out);
    let ran = folder.run("validate builtin:comau inch.json simulated.csv");
    assert_eq!(ran.code, Some(1), "{}", ran.out);
    assert!(ran.out.starts_with("SERIOUS: The stiffness cannot be used as it is"), "{}", ran.out);
    let answer = folder.json("validate builtin:comau inch.json simulated.csv");
    let remark = &answer["result"]["remarks"][0];
    assert_eq!(remark["code"], "stiffness-doubtful");
    assert_eq!(remark["severity"], "serious");
    // The other way round: displacements of tenths against a stiffness of a tenth.
    let soft = "{\"stiffness_nm_per_rad\": [2e5, 3e5, 2e5, 3e4, 3e4, 2e4]}";
    folder.write("soft.json", soft);
    let line = "validate builtin:comau soft.json simulated.csv";
    let factor = folder.json(line)["result"]["compensation_factor"].as_f64().unwrap();
    assert!(factor < 0.5, "{factor}");
    let larger = format!("would have been {:.2} times larger", 1.0 / factor);
    folder.ok(&format!("{line} --report soft.html"));
    let page = paragraphs(&folder.read("soft.html"), "verdict");
    for said in [unbroken(&folder.ok(line)), page] {
        assert_eq!(["times larger", "times smaller"].map(|words| said.matches(words).count()), [1, 0], "{said}");
        assert!(said.contains(&larger), "{larger}\n{said}");
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
        "validate builtin:comau simulated.csv --folds 3 --extra tilt9",
        "validate builtin:comau simulated.csv --folds 3 --estimator best",
        "validate builtin:comau simulated.csv --folds 3 --model equilibrium",
        "validate builtin:comau simulated.csv --folds 3 --confidence 95",
        "validate builtin:comau",
    ];
    assert_snapshot!(folder.refusals(lines));
}
