//! Table, object, files and picture of `stiffarm map` agree, and the best place holds what it promises.

use crate::support;

use insta::assert_snapshot;
use serde_json::Value;
use support::{Folder, codes, in_lines, measurements, printed_sentence, sentence, stiffness, unbroken};

/// The default cell with a workpiece and a load on it.
fn working_cell(load: &str) -> String {
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    let (cell, _) = cell.split_once("[work]").unwrap();
    format!("{cell}\n[work]\nworkpiece_mm = [1700, 900, 700]\n\n[work.force]\n{load}\n")
}

/// An L on the workpiece, the tool down.
fn path() -> String {
    let mut text = "x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg\n".to_string();
    let corner = |i: i32| {
        if i <= 15 { (20 * i, 0) } else { (300, 20 * (i - 15)) }
    };
    for (x, y) in (0..=25).map(corner) {
        text += &format!("{x},{y},50,180,0,0\n");
    }
    text
}

#[test]
fn a_plane_of_the_default_cell() {
    let folder = Folder::new();
    assert_snapshot!(folder.ok("map builtin:comau prior --plane z=800 --steps 15"));
    assert!(folder.names().is_empty());
}

#[test]
fn the_object_the_table_and_the_picture_agree() {
    let folder = Folder::new();
    let line = "map builtin:comau prior --plane z=800 --steps 7 --free-turn=4 --force-n 100,-200,50 \
                --direction 0,0,2 --output-dir out";
    let printed = folder.json(line);
    let result = &printed["result"];
    assert_eq!(printed["options"]["rpy_deg"].to_string(), "[180.0,0.0,0.0]");
    assert_eq!(result["direction"].to_string(), "[0.0,0.0,1.0]");
    let nodes = result["nodes"].as_array().unwrap();
    let csv = folder.read("out/map.csv");
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), nodes.len() + 1);
    let mut reachable = 0;
    for (node, row) in nodes.iter().zip(&rows[1..]) {
        for axis in 0..3 {
            let mm: f64 = row[axis].parse().unwrap();
            assert!((mm - 1e3 * node["position_m"][axis].as_f64().unwrap()).abs() < 1e-6);
        }
        let values = &node["values"];
        assert_eq!(values.is_null(), row[3] != "reachable");
        if let Some(v) = values["deflection_m"].as_f64() {
            let micrometres: f64 = row[7].parse().unwrap();
            assert!((micrometres / (1e6 * v) - 1.0).abs() < 1e-12);
            reachable += 1;
        }
    }
    assert!(reachable > 0);
    assert_eq!(result["counts"]["reachable"], reachable);
    assert!(folder.read("out/map.svg").contains("deflection per newton [µm/N]"));
}

#[test]
fn the_load_of_the_cell_is_taken_in_its_axes() {
    let folder = Folder::new();
    let force = |printed: &Value| -> Vec<f64> {
        let force = printed["result"]["force_n"].as_array().unwrap().iter();
        force.map(|v| v.as_f64().unwrap().round()).collect()
    };
    let line = "map cell.toml prior --plane z=900 --steps 7";
    for (axes, expected) in [
        ("base", [10.0, 20.0, 30.0]),
        // The tool is turned upside down about x.
        ("tool", [10.0, -20.0, -30.0]),
        ("workpiece", [10.0, 20.0, 30.0]),
    ] {
        folder.write("cell.toml", working_cell(&format!("force_n = [10, 20, 30]\naxes = \"{axes}\"")));
        let printed = folder.json(line);
        assert_eq!(force(&printed), expected, "{axes}");
        let size = 1400_f64.sqrt();
        let along = printed["result"]["direction"][0].as_f64().unwrap();
        assert!((along - expected[0] / size).abs() < 1e-12);
    }
    // A path's axes are no axes of a map.
    folder.write("cell.toml", working_cell("force_n = [10, 20, 30]\naxes = \"path\""));
    assert_eq!(force(&folder.json(line)), [0.0, 0.0, 1.0]);
    assert_snapshot!(in_lines(printed_sentence(&folder.ok(line), "1 N along the direction:")), @r"
    1 N along the direction: the cell's [work] gives a load in the axes of a path, which a map has not;
    10 of them are reachable within all limits.
    ");
}

#[test]
fn nothing_reachable_is_a_finding() {
    let folder = Folder::new();
    let line = "map builtin:comau prior --from-mm 5000,0,800 --to-mm 6000,0,800 --steps 3";
    assert_snapshot!(folder.transcript(line));
}

#[test]
fn the_best_place_of_a_path() {
    let folder = Folder::new();
    folder.write("path.csv", path());
    folder.write("cell.toml", working_cell("force_n = [-250, 150, 80]\naxes = \"path\""));
    let line = "map cell.toml prior --place path.csv --yaw-deg 0,90 --steps 5 --output-dir out";
    assert_snapshot!(folder.ok(line));
    assert_eq!(folder.names(), ["cell.toml", "out", "path.csv"]);
    assert!(folder.read("out/placement.svg").contains("RMS deflection [mm]"));
    let printed = folder.json("map cell.toml prior --place path.csv --yaw-deg 0,90 --steps 5");
    let result = &printed["result"];
    let rows = folder.read("out/placement.csv").lines().count();
    assert_eq!(result["candidates"].as_array().unwrap().len() + 1, rows);
    // At the place that it names, the path bends the arm as it says.
    let best = &result["best"];
    let list = |key: &str, factor: f64| {
        let items = best[key].as_array().unwrap().iter();
        let items = items.map(|v| (factor * v.as_f64().unwrap()).to_string());
        format!("[{}]", items.collect::<Vec<_>>().join(", "))
    };
    let moved = working_cell("force_n = [-250, 150, 80]\naxes = \"path\"").replace(
        "workpiece_mm = [1700, 900, 700]",
        &format!("workpiece_mm = {}\nworkpiece_rpy_deg = {}", list("position_m", 1e3), list("rpy_deg", 1.0)),
    );
    folder.write("moved.toml", moved);
    let there = folder.json("map moved.toml prior --place path.csv --steps 2 --refine 0");
    let rms = |v: &Value| v["deflection_rms_m"].as_f64().unwrap();
    assert!((rms(&there["result"]["given"]) / rms(best) - 1.0).abs() < 1e-9);
    // Nowhere is a finding.
    let far = "map cell.toml prior --place path.csv --from-mm 5000,0,700 --to-mm 6000,0,700 --steps 2";
    let ran = folder.run(far);
    assert_eq!(ran.code, Some(1), "{}{}", ran.out, ran.err);
    let findings = folder.json(far)["result"]["findings"].clone();
    assert!(codes(&findings).contains(&"nowhere"), "{findings}");
    assert_snapshot!(in_lines(sentence(&findings, "nowhere")), @r"
    At no place of the grid can the arm go along the path. At x = 5000, y = 0, z = 700 mm, for one,
    point 1: 1823.3 mm out of the arm's reach.
    ");
    assert!(unbroken(&ran.out).contains(sentence(&findings, "nowhere")), "{}", ran.out);
}

#[test]
fn wrong_requests_are_answered() {
    let folder = Folder::new();
    folder.write("taken", "a file");
    std::fs::create_dir(folder.path("maps")).unwrap();
    folder.write("maps/map.csv", "mine");
    folder.write("path.csv", path());
    folder.write("empty.csv", "x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg\n");
    let report = folder.refusals([
        "map builtin:comau",
        "map builtin:comau none.json",
        "map builtin:fanuc-r2000ic prior --plane z=800",
        "map builtin:comau prior --plane w=800",
        "map builtin:comau prior --plane z=0.8m",
        "map builtin:comau prior --from-mm 1000,0,500",
        "map builtin:comau prior --from-mm 1000,0,900 --to-mm 2000,0,800",
        "map builtin:comau prior --plane z=800 --steps 0",
        "map builtin:comau prior --plane z=800 --steps 5,5,5",
        "map builtin:comau prior --steps 500",
        "map builtin:comau prior --plane z=800 --force-n 0,0,0",
        "map builtin:comau prior --plane z=800 --force-n 1,2",
        "map builtin:comau prior --plane z=800 --direction 0,0,0",
        "map builtin:comau prior --plane z=800 --free-turn=0",
        "map builtin:comau prior --plane z=800 --output-dir taken",
        "map builtin:comau prior --plane z=800 --output-dir maps",
        "map builtin:comau prior --place path.csv --force-n 1,0,0",
        "map builtin:comau prior --yaw-deg 30",
        "map builtin:comau prior --place empty.csv",
    ]);
    assert_eq!(folder.read("maps/map.csv"), "mine");
    assert_snapshot!(report.replace("-- exit code 2\n", ""));
}

#[test]
fn a_saved_identification_brings_bands() {
    let folder = Folder::with("m.csv", measurements());
    folder.write("full.json", stiffness());
    folder.ok("identify builtin:comau m.csv --brief --output brief.json");
    let map = |file: &str| folder.json(&format!("map builtin:comau {file} --plane z=800 --steps 7"));
    let (full, brief, prior) = (map("full.json"), map("brief.json"), map("prior"));
    let widths = |v: &Value| -> Vec<f64> {
        let nodes = v["result"]["nodes"].as_array().unwrap().iter();
        nodes.filter_map(|n| n["values"]["half_width_m"].as_f64()).collect()
    };
    let (full, brief) = (widths(&full), widths(&brief));
    assert!(!full.is_empty() && full.len() == brief.len() && widths(&prior).is_empty());
    // The budget of common errors widens every band.
    assert!(full.iter().zip(&brief).all(|(full, brief)| full > brief && *brief > 0.0));
}
