//! `stiffarm capsules` prints tables and TOML that a cell takes, and refuses what is no mesh.

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
    let said: Vec<String> = lines.iter().map(|line| format!("$ stiffarm {line}\n{}", folder.ok(line))).collect();
    let said = said.join("\n");
    assert!(said.lines().all(|l| l.chars().count() <= 80), "{said}");
    insta::assert_snapshot!(said);
}

#[test]
fn names_and_numbers_are_toml() {
    let folder = Folder::new();
    let text = stiffarm_files::builtin::mesh_text("spindle.obj").unwrap();
    folder.write("a\"b.obj", text);
    let said = folder.ok("capsules a\"b.obj --unit mm --most 1 --tool");
    assert!(said.contains("name = \"a\\\"b\"\n"), "{said}");
    assert!(said.lines().all(|l| !l.starts_with("radius_mm") || l.contains('.')));
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
    let said = folder.refusals(lines);
    insta::assert_snapshot!(said.replace("-- exit code 2\n", ""));
}
