//! Shapes of kind "mesh" in cell.toml: read beside the cell, hashed, refused with place and hint.

use crate::support;

use insta::assert_snapshot;
use support::{Folder, block};

/// The default cell with more tables.
fn cell(tables: &str) -> String {
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    format!("{cell}\n{tables}")
}

const FIXTURE: &str = "[[obstacle]]\nname = \"fixture\"\nkind = \"mesh\"\nfile = \"meshes/fixture.stl\"\n\
                       unit = \"mm\"\nxyz_mm = [2500, 0, 300]\nrpy_deg = [0, 0, 30]\n";
const SPINDLE: &str = "[[tool.shape]]\nname = \"spindle\"\nkind = \"mesh\"\nfile = \"builtin:spindle.obj\"\n\
                       unit = \"mm\"\n";

#[test]
fn a_mesh_is_found_beside_the_cell_and_its_hash_is_kept() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path("own/meshes")).unwrap();
    folder.write("own/cell.toml", cell(&format!("{FIXTURE}\n{SPINDLE}")));
    folder.write("own/meshes/fixture.stl", block([800.0, 400.0, 600.0]));
    let line = "check own/cell.toml";
    let first = folder.json(line);
    let hash = |checked: &serde_json::Value| {
        let inputs = checked["inputs"].as_object().unwrap();
        let roles: Vec<&str> = inputs.keys().map(String::as_str).collect();
        let all = ["cell", "cell mesh builtin:spindle.obj", "cell mesh meshes/fixture.stl"];
        assert_eq!(roles, all);
        inputs["cell mesh meshes/fixture.stl"].clone()
    };
    assert_eq!(folder.json(line), first);
    // Twice as high: another hash, and other bytes.
    folder.write("own/meshes/fixture.stl", block([800.0, 400.0, 1200.0]));
    assert_ne!(hash(&folder.json(line)), hash(&first));
    // It is not overwritten.
    let line = "select own/cell.toml --rounds 1 --output own/meshes/fixture.stl --force";
    assert_snapshot!(folder.each_refused(&[(line, "conflict", "own/cell.toml:134:8 obstacle[1].file")]), @r#"
    $ stiffarm select own/cell.toml --rounds 1 --output own/meshes/fixture.stl --force
    conflict

      × meshes/fixture.stl: This file is an input of the same command, and it is not overwritten even with --force.
         ╭─[own/cell.toml:134:8]
     133 │ kind = "mesh"
     134 │ file = "meshes/fixture.stl"
         ·        ──────────┬─────────
         ·                  ╰── obstacle[1].file
     135 │ unit = "mm"
         ╰────
      help: give the output another name
    "#);
}

#[test]
fn wrong_meshes_are_answered_with_place_and_hint() {
    let folder = Folder::new();
    folder.write("big.stl", block([800.0, 400.0, 600.0]));
    folder.write("small.stl", block([0.8, 0.4, 0.6]));
    folder.write("text.stl", "no mesh");
    folder.write("part.step", "ISO-10303-21;");
    folder.write("part.dae", "<COLLADA/>");
    let shape = |keys: &str| format!("[[obstacle]]\nname = \"fixture\"\nkind = \"mesh\"\n{keys}\n");
    let cells = [
        ("not-there", shape("file = \"fixture.stl\"")),
        ("no-file", shape("unit = \"mm\"")),
        ("mm", shape("file = \"big.stl\"")),
        ("m", shape("file = \"small.stl\"\nunit = \"mm\"")),
        ("no-mesh", shape("file = \"text.stl\"")),
        ("step", shape("file = \"part.step\"")),
        ("folder", shape("file = \".\"")),
        ("unit", shape("file = \"big.stl\"\nunit = \"cm\"")),
        ("own-unit", shape("file = \"part.dae\"\nunit = \"mm\"")),
        ("foreign", shape("file = \"big.stl\"\nunit = \"mm\"\ncenter_mm = [0, 0, 0]")),
        ("tool", SPINDLE.replace("spindle.obj", "spindel.obj")),
    ];
    let lines = cells.map(|(name, tables)| {
        folder.write(&format!("{name}.toml"), cell(&tables));
        format!("check {name}.toml")
    });
    let report = folder.refusals(lines.iter().map(String::as_str));
    let report = report.replace("-- exit code 2\n", "");
    insta::assert_snapshot!(report.replace('\\', "/"));
}

/// The tables of docs/shapes.md, all in one cell.
#[test]
fn the_tables_of_the_page_are_read() {
    let page = include_str!("../../../../docs/shapes.md");
    let folder = Folder::new();
    folder.write("fixture.stl", block([800.0, 400.0, 600.0]));
    let mut text = cell("");
    let mut count = 0;
    for part in page.split("```toml\n").skip(1) {
        let part = part.split("```").next().unwrap();
        count += 1;
        // Tables that the cell has already get more keys.
        for table in part.split("\n\n") {
            match ["[robot]\n", "[tool]\n"].into_iter().find(|head| table.starts_with(head)) {
                Some(head) => text = text.replacen(head, &format!("{}\n", table.trim_end()), 1),
                None => text += &format!("\n{table}\n"),
            }
        }
    }
    assert_eq!(count, 6);
    folder.write("cell.toml", &text);
    let ran = folder.run("check cell.toml");
    assert!(ran.code != Some(2), "{text}\n{}", ran.err);
}
