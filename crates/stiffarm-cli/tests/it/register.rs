//! `register` finds the frame, names a wrong point, saves what reads back, and refuses wrong tables with their place.

use crate::support;

use insta::assert_snapshot;
use serde_json::Value;
use stiffarm_files::registration::read_registration;
use support::{Folder, redact, rounded};

const HEADING: &str = "name,tracker_x_mm,tracker_y_mm,tracker_z_mm,base_x_mm,base_y_mm,base_z_mm";

/// The rows of the built-in pairs: a name and six numbers each.
fn rows() -> Vec<(String, [f64; 6])> {
    let text = stiffarm_files::builtin::pairs_text("example-pairs").unwrap();
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines
        .skip(1)
        .map(|line| {
            let (name, numbers) = line.split_once(',').unwrap();
            let numbers: Vec<f64> = numbers.split(',').map(|n| n.parse().unwrap()).collect();
            (name.to_string(), numbers.try_into().unwrap())
        })
        .collect()
}

fn csv(rows: &[(String, [f64; 6])]) -> String {
    let row = |(name, numbers): &(String, [f64; 6])| {
        let numbers = numbers.map(|n| n.to_string());
        format!("{name},{}\n", numbers.join(","))
    };
    format!("{HEADING}\n{}", rows.iter().map(row).collect::<String>())
}

/// The built-in pairs after `change`, as a file in a folder of its own.
fn changed(change: impl FnOnce(&mut Vec<(String, [f64; 6])>)) -> Folder {
    let mut rows = rows();
    change(&mut rows);
    let folder = Folder::new();
    folder.write("pairs.csv", csv(&rows));
    folder
}

fn printed(folder: &Folder, line: &str, code: i32) -> String {
    let ran = folder.run(line);
    assert_eq!(ran.code, Some(code), "{line}\n{}{}", ran.out, ran.err);
    ran.transcript(line)
}

#[test]
fn good_pairs() {
    let line = "register builtin:example-pairs";
    assert_snapshot!(printed(&Folder::new(), line, 0));
}

#[test]
fn good_pairs_as_json() {
    let line = "register builtin:example-pairs --std-mm 0.03 --exclude B";
    let value = rounded(&Folder::new().json(line));
    assert_snapshot!(redact(&serde_json::to_string_pretty(&value).unwrap()));
}

#[test]
fn a_wrong_point_is_a_finding() {
    let folder = changed(|rows| rows[2].1[4] += 1.5);
    assert_snapshot!(printed(&folder, "register pairs.csv", 1));
    // Without it all is well.
    folder.ok("register pairs.csv --exclude C");
}

#[test]
fn a_set_without_a_registration_is_refused() {
    let few = changed(|rows| rows.truncate(2));
    assert_snapshot!(few.refusals(["register pairs.csv --output registration.json", "register pairs.csv --json",]));
    assert_eq!(few.names(), ["pairs.csv"], "nothing is written");
}

#[test]
fn wrong_tables_are_answered_with_place_and_hint() {
    let folder = Folder::new();
    let row = "A,1,2,3,4,5,6\n";
    folder.write("metres.csv", format!("{}\n{row}", HEADING.replace("tracker_y_mm", "tracker_y_m")));
    folder.write("no-unit.csv", format!("{}\n{row}", HEADING.replace("base_z_mm", "base_z")));
    folder.write("missing.csv", "name,tracker_x_mm,tracker_y_mm,tracker_z_mm\nA,1,2,3\n");
    folder.write("other.csv", format!("{}\n{row}", HEADING.replace("name", "point")));
    folder.write("twice.csv", format!("{HEADING}\n{row}B,1,2,3,4,5,6\n{row}"));
    folder.write("text.csv", format!("{HEADING}\nA,1,2,3,4,5 mm,6\n"));
    folder.write("nan.csv", format!("{HEADING}\nA,1,2,nan,4,5,6\n"));
    folder.write("comma.csv", format!("{HEADING}\nA,1,5,2,3,4,5,6\n"));
    folder.write("empty.csv", format!("{HEADING}\n"));
    let before = folder.names();
    let report = folder.refusals([
        "register metres.csv",
        "register no-unit.csv",
        "register missing.csv",
        "register other.csv",
        "register twice.csv",
        "register text.csv",
        "register nan.csv",
        "register comma.csv",
        "register empty.csv",
        "register nothing.csv",
        "register builtin:example-pairs --exclude F",
        "register builtin:example-pairs --std-mm 0",
        "register builtin:example-pairs --output metres.csv",
        "register builtin:example-pairs --output - --json",
    ]);
    assert_eq!(folder.names(), before);
    assert_snapshot!(report);
}

#[test]
fn european_spreadsheets_are_read() {
    let folder = changed(|_| {});
    let text = folder.read("pairs.csv");
    let european = text.replace(',', ";").replace('.', ",").replace('\n', "\r\n");
    folder.write("european.csv", format!("\u{feff}{european}"));
    let [a, b] = ["pairs.csv", "european.csv"].map(|file| folder.json(&format!("register {file}")));
    assert_eq!(a["result"], b["result"]);
}

#[test]
fn a_saved_registration_is_read_back() {
    let folder = Folder::new();
    folder.ok("register builtin:example-pairs --output registration.json");
    let text = folder.read("registration.json");
    let saved = read_registration(text.as_bytes(), "registration.json").unwrap();
    let value: Value = serde_json::from_str(&text).unwrap();
    let result = &value["result"];
    for i in 0..3 {
        let translation = saved.base_from_tracker.translation.vector[i];
        assert_eq!(Some(translation), result["translation_m"][i].as_f64());
    }
    let rotation = saved.base_from_tracker.rotation.to_rotation_matrix();
    assert!((rotation[(0, 1)] - result["rotation"][0][1].as_f64().unwrap()).abs() < 1e-15);
    // Bare, without what made it.
    let bare = serde_json::to_vec(result).unwrap();
    let bare = read_registration(&bare, "bare.json").unwrap();
    assert_eq!(bare.base_from_tracker, saved.base_from_tracker);
    assert_eq!(bare.names, saved.names);
    // The cell's lines give the same transform to a tenth of a micrometre.
    let out = folder.ok("register builtin:example-pairs");
    let numbers = |key: &str| -> Vec<f64> {
        let line = out.lines().find(|line| line.starts_with(key)).unwrap();
        let list = line.split_once('[').unwrap().1.trim_end_matches(']');
        list.split(", ").map(|n| n.parse().unwrap()).collect()
    };
    let (xyz, rpy) = (numbers("xyz_mm"), numbers("rpy_deg"));
    let rpy: Vec<f64> = rpy.iter().map(|deg| deg.to_radians()).collect();
    let turned = nalgebra::UnitQuaternion::from_euler_angles(rpy[0], rpy[1], rpy[2]);
    assert!(turned.angle_to(&saved.base_from_tracker.rotation) < 3e-9);
    let origin = saved.base_from_tracker.translation.vector * 1e3;
    assert!(origin.iter().zip(&xyz).all(|(a, b)| (a - b).abs() <= 5.1e-5));

    for (text, said) in [
        ("no json", "not JSON"),
        ("{}", "holds no registration"),
        (r#"{"rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}"#, "missing field `translation_m`"),
        (&text.replace("\"rotation\": [\n      [-", "\"rotation\": [\n      ["), "not a rotation"),
    ] {
        let error = read_registration(text.as_bytes(), "wrong.json").unwrap_err();
        assert_eq!(error.code(), stiffarm::Code::ResultFile);
        assert!(error.to_string().contains(said), "{error}");
    }
}
