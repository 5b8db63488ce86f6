//! What cannot be determined is a finding with its result and not an error; an error with `--json` is an object.

use crate::support;

use insta::assert_snapshot;
use support::{Folder, HEADING, one_point_cell};

#[test]
fn a_group_that_cannot_determine_all_joints_is_a_finding_not_a_fault() {
    let folder = Folder::with("one.csv", format!("{HEADING}1,-35,-10,-95,10,15,-20\n"));
    folder.write(
        "few.csv",
        "posture,point,dx_mm,dy_mm,dz_mm,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\nA,1,0.1,0,0,0,0,-90,0,20,0\n",
    );
    // One posture with one measuring point: three rows for six joints.
    folder.write("one-point.toml", one_point_cell());
    let mut report = String::new();
    for line in [
        "evaluate one-point.toml one.csv --json",
        "select one-point.toml --initial one.csv --output plan.csv",
        "simulate one-point.toml one.csv",
        "identify one-point.toml few.csv",
    ] {
        let ran = folder.run(line);
        assert_eq!(ran.code, Some(1), "{line}\n{}{}", ran.out, ran.err);
        if line.starts_with("evaluate") {
            let value: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
            assert_eq!(value["result"]["groups"][0]["undetermined_joints"].as_array().unwrap().len(), 6);
            continue;
        }
        report += &ran.transcript(line);
        report.push('\n');
    }
    assert!(!folder.path("plan.csv").exists());
    assert_snapshot!(report);
}

#[test]
fn with_json_an_error_is_an_object_on_standard_output() {
    let ran = Folder::new().run("evaluate builtin:comau nothing.csv --json");
    assert_eq!((ran.code, ran.err.as_str()), (Some(2), ""));
    assert_snapshot!(ran.out, @r#"
    {
      "error": {
        "code": "file-read",
        "message": "There is no such file.",
        "file": "nothing.csv",
        "line": null,
        "column": null,
        "key": null,
        "hint": "check the path; `stiffarm init` writes files to start from, and builtin:comau is built in"
      }
    }
    "#);
}
