//! Table, object and picture of `stiffarm zones` agree.

use crate::support;

use serde_json::Value;
use support::Folder;

#[test]
fn zones_of_the_default_cell() {
    let folder = Folder::new();
    insta::assert_snapshot!(folder.ok("zones --steps 21"));
    assert!(folder.names().is_empty());
}

#[test]
fn the_object_the_table_and_the_picture_agree() {
    let folder = Folder::new();
    let printed = folder.json("zones builtin:comau --steps 9 --output-dir maps");
    let result = &printed["result"];
    assert_eq!(printed["options"]["steps"], 9);
    assert_eq!(result["q2_deg"][8], 40.0);
    let rows: Vec<Vec<String>> =
        folder.read("maps/zones.csv").lines().skip(1).map(|line| line.split(',').map(String::from).collect()).collect();
    assert_eq!(rows.len(), 81);
    let same = |text: &str, value: Option<f64>| match (text.parse::<f64>().ok(), value) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-14 * b.abs(),
        (a, b) => a == b,
    };
    let mut reachable = 0;
    for (i, row) in rows.iter().enumerate() {
        assert!(same(&row[0], result["q2_deg"][i % 9].as_f64()), "{row:?}");
        assert!(same(&row[1], result["q3_deg"][i / 9].as_f64()), "{row:?}");
        let dexterity: &Value = &result["inverse_condition"][i / 9][i % 9];
        assert!(same(&row[2], dexterity.as_f64()), "{row:?}");
        let deviation = &result["translation_deviation"][i / 9][i % 9];
        assert!(same(&row[3], deviation.as_f64().map(|v| 100.0 * v)), "{row:?}");
        reachable += usize::from(!dexterity.is_null());
    }
    assert_eq!(result["within_limits"], reachable);
    assert!(reachable > 0 && reachable < 81);
    let picture = folder.read("maps/zones.svg");
    assert!(picture.contains("1/k(J_N)") && picture.contains("relative deviation [%]"));
    // Equal runs are equal bytes.
    folder.ok("zones builtin:comau --steps 9 --output-dir again");
    assert_eq!(picture, folder.read("again/zones.svg"));
}

#[test]
fn angles_are_given_for_all_joints_and_negative_ones_are_read() {
    let folder = Folder::new();
    let printed = folder.json("zones --steps 3 --q-deg -20,0,0,-45,30,10.5");
    let held = &printed["result"]["held_deg"];
    assert_eq!(held.to_string(), "[-20.0,null,null,-45.0,30.0,10.5]");
}

#[test]
fn wrong_requests_are_answered() {
    let folder = Folder::new();
    folder.write("taken", "a file");
    std::fs::create_dir(folder.path("maps")).unwrap();
    folder.write("maps/zones.csv", "mine");
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    let measured = "kind = \"measured\"";
    let rope = "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]";
    let measured = cell.replace(rope, measured);
    folder.write("measured.toml", measured.replace("rope_length_mm = [800, 3400]", ""));
    let report = folder.refusals([
        "zones --steps 1",
        "zones --steps x",
        "zones --q-deg 0,0,0",
        "zones --q-deg 0,0,0,45,45,1e5",
        "zones --output-dir taken",
        "zones --output-dir maps",
        "zones measured.toml",
    ]);
    assert_eq!(folder.read("maps/zones.csv"), "mine");
    insta::assert_snapshot!(report.replace("-- exit code 2\n", ""));
    folder.ok("zones --steps 3 --output-dir maps --force");
    assert!(folder.read("maps/zones.csv").starts_with("q2_deg,"));
}
