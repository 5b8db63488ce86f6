//! Wrong inputs: what is wrong, where, and what to do; nothing half written.

use crate::support;

use insta::assert_snapshot;
use support::{Folder, measurements};

const HEADING: &str = "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n";

/// A folder with the default cell, its Group 1 simulated, and slips of all kinds.
fn folder() -> Folder {
    let folder = Folder::new();
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    let slip = |from: &str, to: &str| {
        assert!(cell.contains(from), "{from}");
        cell.replace(from, to)
    };
    folder.write("unknown-key.toml", slip("magnitude_n = 500", "magnitud_n = 500"));
    folder.write("nan.toml", slip("magnitude_n = 500", "magnitude_n = nan"));
    folder.write("text.toml", slip("magnitude_n = 500", "magnitude_n = \"500\""));
    folder.write("comma.toml", slip("magnitude_n = 500", "magnitude_n = 500,5"));
    folder.write("robot.toml", slip("comau-nj165-3.0", "comau-nj165"));
    folder.write("bom.toml", format!("\u{feff}{}", slip("magnitude_n = 500", "magnitud_n = 500")));
    folder.write("latin-1.toml", b"format = 1\nname = \"Pr\xfcfzelle\"\n");
    folder.write(
        "no-prior.toml",
        slip(
            "catalogue = \"comau-nj165-3.0\"",
            "catalogue = \"fanuc-r2000ic165f\"\nlimits_deg = [[-360, 360], [-360, 360], [-360, 360], [-360, 360], [-360, 360], [-360, 360]]",
        )
        .replace("prior_nm_per_rad", "# prior_nm_per_rad"),
    );
    folder.write("empty.csv", "");
    folder.write("heading.csv", HEADING);
    folder.write("decimal-comma.csv", format!("{HEADING}1,-35,-10,-95,\"10,5\",15.5,-20\n"));
    folder.write("beyond.csv", format!("{HEADING}1,0,0,-90,0,20,0\n2,-35,100,-95,10,15,-20\n"));
    folder.write("twice.csv", format!("{HEADING}1,0,0,-90,0,20,0\n1,0,0,-90,0,20,0\n"));
    folder.write("five.csv", "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg\n1,0,0,-90,0,20\n");
    folder.write("one.csv", format!("{HEADING}1,-35,-10,-95,10,15,-20\n"));
    folder.write("raw.csv", "posture,point,x_mm,y_mm,z_mm\n1,1,0,0,0\n");
    folder.write("readings.xlsx", include_bytes!("../../../stiffarm/tests/golden/xlsx/readings.xlsx"));
    folder.write(
        "few.csv",
        "posture,point,dx_mm,dy_mm,dz_mm,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\nA,1,0.1,0,0,0,0,-90,0,20,0\n",
    );
    folder.write("no-json.json", "k1 = 3\n");
    folder.write("three.json", "{\"stiffness_nm_per_rad\": [1e6, 2e6, 3e6]}\n");
    folder.write("negative.json", "{\"stiffness_nm_per_rad\": [1e6, 2e6, 3e6, -1e5, 1e5, 1e5]}\n");
    folder.write("other.json", "{\"result\": {\"groups\": []}}\n");
    folder.write("simulated.csv", measurements());
    let named = folder.ok("identify builtin:comau simulated.csv --json").replace("\"joint 2\"", "\"A2\"");
    folder.write("kuka.json", named);
    folder
}

#[test]
fn wrong_inputs_are_answered_with_place_and_hint() {
    let folder = folder();
    let before = folder.names();
    let lines = [
        "check nothing.toml",
        "check .",
        "check comau",
        "check builtin:komau",
        "check unknown-key.toml",
        "check bom.toml",
        "check nan.toml",
        "check text.toml",
        "check comma.toml",
        "check robot.toml",
        "check latin-1.toml",
        "init --robot kuka-kr240 --output-dir new",
        "evaluate builtin:comau empty.csv",
        "evaluate builtin:comau heading.csv",
        "evaluate builtin:comau decimal-comma.csv",
        "evaluate builtin:comau beyond.csv",
        "evaluate builtin:comau twice.csv",
        "evaluate builtin:comau simulated.csv",
        "evaluate builtin:fanuc-r2000ic one.csv",
        "select builtin:comau --index nowel",
        "select builtin:comau --initial builtin:comau-group1 --output simulated.csv",
        "select no-prior.toml --rounds 2",
        "select no-prior.toml --index d --rounds 2",
        "select builtin:comau --initial builtin:comau-group1 --rounds 3",
        "select builtin:comau --max-iterations 5",
        "select builtin:comau --count 0",
        "select builtin:comau --rounds 0",
        "select builtin:comau --time-limit 0",
        "select builtin:comau --time-limit -1",
        "select builtin:comau --time-limit nan",
        "select builtin:comau --time-limit 1e30",
        "select builtin:comau --add 1",
        "select builtin:comau --given builtin:comau-group1 --add 0",
        "select builtin:comau --given builtin:comau-group1 --count 3",
        "select builtin:comau --given builtin:comau-group1 --add 1 --drop 1",
        "select builtin:comau --given builtin:comau-group1 --drop 0",
        "select builtin:comau --given builtin:comau-group1 --drop 6",
        "select builtin:comau --given builtin:comau-group1 --drop --rounds 2",
        "select builtin:comau --given five.csv",
        "select builtin:comau --given builtin:comau-group1 --anchor-box-mm 0,0,0,1,1,1",
        "select builtin:comau --anchor-box-mm 1800,0,0,1700,0,0",
        "select builtin:comau --loading-point-box-mm 1,2,3",
        "select builtin:comau --loading-point-box-mm 0,0,0,inf,0,0",
        "select builtin:comau --largest-load-n -5",
        "select builtin:fanuc-r2000ic --anchor-box-mm 0,0,0,1,1,1",
        "select builtin:comau --curve --sheet sheet.csv",
        "select builtin:comau --drift",
        "select builtin:comau --sheet sheet.csv --sheet-of displacements --base-reflector",
        "select builtin:comau --sheet sheet.csv --sheet-of deflections",
        "select builtin:comau --space-filling --index d",
        "select builtin:comau --curve --index nowel",
        "simulate builtin:comau builtin:comau-group1 --levels 1,-2",
        "simulate builtin:comau builtin:comau-group1 --elastic mixed --levels -2",
        "simulate builtin:comau builtin:comau-group1 --elastic mixed --anchor-error-mm 5",
        "simulate builtin:comau builtin:comau-group1 --elastic mixed --readings r.csv",
        "simulate builtin:comau builtin:comau-group1 --elastic some",
        "study builtin:comau --measured simulated.csv --elastic mixed",
        "identify builtin:comau raw.csv",
        "identify builtin:comau readings.xlsx",
        "identify builtin:comau simulated.csv --exclude 7",
        "identify builtin:comau simulated.csv --confidence 95",
        "identify builtin:comau simulated.csv --postures one.csv",
        "identify simulated.csv builtin:comau",
        "identify builtin:comau simulated.csv --noise -1",
        "select builtin:comau -n -3",
        "validate builtin:comau simulated.csv other.json",
        "validate builtin:comau no-json.json simulated.csv",
        "validate builtin:comau other.json simulated.csv",
        "validate builtin:comau three.json simulated.csv",
        "validate builtin:comau negative.json simulated.csv",
        "validate builtin:comau kuka.json simulated.csv",
        "robots comau-nj165",
        "schema cel",
        "selekt builtin:comau",
    ];
    let report = folder.refusals(lines);
    // No file was made or changed.
    assert_eq!(folder.names(), before);
    assert_snapshot!(report);
}

#[test]
fn a_group_that_cannot_determine_all_joints_is_a_finding_not_a_fault() {
    let folder = folder();
    // One posture with one measuring point: three rows for six joints.
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    let start = cell.find("[[tool.measuring_point]]\nname = \"2\"").unwrap();
    let end = cell.find("[load]").unwrap();
    folder.write("one-point.toml", format!("{}{}", &cell[..start], &cell[end..]));
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
fn with_json_errors_are_objects_on_standard_output() {
    let folder = folder();
    let mut report = String::new();
    for line in [
        "check unknown-key.toml --json",
        "evaluate builtin:comau beyond.csv --json",
        "check nothing.toml --json",
        "selekt --json",
        "select --json",
        "simulate builtin:comau one.csv --runs 0 --json",
    ] {
        let ran = folder.run(line);
        assert_eq!(ran.code, Some(2), "{line}");
        assert_eq!(ran.err, "", "{line}");
        let value: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
        let error = value["error"].as_object().unwrap();
        let mut keys: Vec<&str> = error.keys().map(String::as_str).collect();
        keys.sort_unstable();
        assert_eq!(keys, ["code", "column", "file", "hint", "key", "line", "message"], "{line}");
        report += &ran.transcript(line);
        report.push('\n');
    }
    assert_snapshot!(report);
}

#[test]
fn an_error_about_what_was_asked_names_the_option_whichever_function_finds_it() {
    let folder = folder();
    for (line, key) in [
        ("select builtin:comau --index d --repeats", "--repeats"),
        ("zones builtin:comau --q-deg 1,2", "--q-deg"),
        ("map builtin:comau prior --force-n 0,0,0 --steps 2", "--force-n"),
        ("map builtin:comau prior --from-mm 1,0,0 --to-mm 0,0,0", "--from-mm"),
        ("simulate builtin:comau builtin:comau-group1 --levels -1", "--levels"),
        ("identify builtin:comau simulated.csv --bootstrap 1", "--bootstrap"),
        ("identify builtin:comau simulated.csv --free load.anchor_mm", "--free"),
    ] {
        let ran = folder.run(&format!("{line} --json"));
        let value: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
        assert_eq!(value["error"]["key"], key, "{line}: {}", ran.out);
    }
}
