//! `stiffarm capsules`: tables, TOML and the object.

use crate::support;

use support::Folder;

#[test]
fn capsules_of_a_spindle() {
    let folder = Folder::new();
    let lines = [
        "capsules builtin:spindle.obj --unit mm",
        "capsules builtin:spindle.obj --unit mm --most 3 --tool",
        "capsules builtin:spindle.obj --unit mm --most 1 --link 3",
    ];
    let said: Vec<String> = lines
        .iter()
        .map(|line| format!("$ stiffarm {line}\n{}", folder.ok(line)))
        .collect();
    let said = said.join("\n");
    assert!(said.lines().all(|l| l.chars().count() <= 80), "{said}");
    insta::assert_snapshot!(said);
}

/// The object, the tables and the mesh agree: every corner is in a capsule.
#[test]
fn every_corner_is_inside() {
    let folder = Folder::new();
    let text = stiffarm::files::builtin::mesh_text("spindle.obj").unwrap();
    folder.write("part.obj", text);
    let printed = folder.json("capsules part.obj --unit mm --most 4");
    let mesh = &printed["result"]["meshes"][0];
    let three =
        |value: &serde_json::Value| -> [f64; 3] { [0, 1, 2].map(|i| value[i].as_f64().unwrap()) };
    let capsules: Vec<stiffarm::model::shape::Capsule> = mesh["capsules"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| {
            let radius = c["radius_mm"].as_f64().unwrap();
            let [a, b] = ["from_mm", "to_mm"].map(|end| three(&c[end]).into());
            stiffarm::model::shape::Capsule::new(a, b, radius).unwrap()
        })
        .collect();
    assert!(capsules.len() >= 2);
    let corners = text.lines().filter_map(|line| line.strip_prefix("v "));
    let mut count = 0;
    for corner in corners {
        let p: Vec<f64> = corner.split(' ').map(|v| v.parse().unwrap()).collect();
        let p = nalgebra::Vector3::from_row_slice(&p);
        assert!(capsules.iter().any(|c| c.distance_to(&p) <= 1e-9), "{p}");
        count += 1;
    }
    assert_eq!(mesh["vertices"], count);
    let ratio =
        mesh["capsules_volume_m3"].as_f64().unwrap() / mesh["hull_volume_m3"].as_f64().unwrap();
    assert!(ratio > 0.7 && ratio < 2.0, "{ratio}");
}

#[test]
fn names_and_numbers_are_toml() {
    let folder = Folder::new();
    let text = stiffarm::files::builtin::mesh_text("spindle.obj").unwrap();
    folder.write("a\"b.obj", text);
    let said = folder.ok("capsules a\"b.obj --unit mm --most 1 --tool");
    assert!(said.contains("name = \"a\\\"b\"\n"), "{said}");
    assert!(
        said.lines()
            .all(|l| !l.starts_with("radius_mm") || l.contains('.'))
    );
}

#[test]
fn wrong_meshes_are_answered() {
    let folder = Folder::new();
    folder.write("a.txt", "no mesh");
    folder.write("a.stl", "no mesh");
    folder.write("empty.obj", "v 0 0 0\n");
    let lines = [
        "capsules",
        "capsules no-such.stl",
        "capsules a.txt",
        "capsules a.stl",
        "capsules empty.obj",
        "capsules builtin:spindle.obj",
        "capsules builtin:spindle.obj --unit mm --most 0",
        "capsules builtin:spindle.obj --unit mm --tool --link 2",
        "capsules builtin:spindle",
    ];
    let said: Vec<String> = lines
        .iter()
        .map(|line| format!("$ stiffarm {line}\n{}", folder.refused(line)))
        .collect();
    insta::assert_snapshot!(said.join("\n"));
}
