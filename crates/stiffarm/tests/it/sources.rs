//! Results are written as JSON that reads back, and every input comes through one method.

use serde_json::{Value, json};
use std::cell::RefCell;
use std::collections::BTreeMap;
use stiffarm::findings::is_hidden;
use stiffarm::{Code, Error, Result};
use stiffarm_files::builtin;
use stiffarm_files::envelope::to_json;
use stiffarm_files::source::{Source, beside, read_cell, read_groups, read_stiffness};
use stiffarm_files::table::sha256_hex;

#[test]
fn plain_lists_are_joined_and_nothing_else_changes() {
    let value = json!({
        "a": [1.5, null, "x, ] [ \" \\", true],
        "b": [[1, 2], [3, 4]],
        "c": [{"d": []}],
        "e": "[not,\na list]",
        "f\"[": {}
    });
    let text = to_json(&value).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    insta::assert_snapshot!(text, @r#"
    {
      "a": [1.5, null, "x, ] [ \" \\", true],
      "b": [
        [1, 2],
        [3, 4]
      ],
      "c": [
        {
          "d": []
        }
      ],
      "e": "[not,\na list]",
      "f\"[": {}
    }
    "#);
}

#[test]
fn hidden_characters_are_in_letters_and_read_back() {
    let value = json!({"a\u{202e}": "b\u{1b}\u{85}\u{feff}\u{e0041}\nc"});
    let text = to_json(&value).unwrap();
    assert!(text.contains(r"a\u202e") && text.contains(r"\udb40\udc41"), "{text}");
    assert!(text.chars().all(|c| c == '\n' || !is_hidden(c)));
    assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
}

#[test]
fn numbers_that_are_not_finite_are_null() {
    assert_eq!(to_json(&[f64::NAN, f64::INFINITY, 1.0]).unwrap(), "[null, null, 1.0]\n");
}

/// Built-in files, and tables in memory.
#[derive(Default)]
struct Memory {
    files: BTreeMap<String, Vec<u8>>,
    hashes: RefCell<BTreeMap<String, String>>,
}

impl Source for Memory {
    fn read(&self, role: &str, from: &str) -> Result<(String, Vec<u8>)> {
        let bytes = match from.strip_prefix(builtin::PREFIX) {
            Some(name) => builtin::bytes(name)?.to_vec(),
            None => self
                .files
                .get(from)
                .cloned()
                .ok_or_else(|| Error::new(Code::FileRead, "There is no such file.").file(from))?,
        };
        let mut hashes = self.hashes.borrow_mut();
        hashes.insert(role.to_string(), sha256_hex(&bytes));
        Ok((from.to_string(), bytes))
    }
}

#[test]
fn all_that_a_plan_needs_comes_through_one_method() {
    let group = builtin::postures_text("comau-group1").unwrap();
    let mut memory = Memory::default();
    memory.files.insert("a/plan.csv".into(), group.into());
    memory.files.insert("b/plan.csv".into(), group.into());
    let cell = read_cell(&memory, "builtin:comau").unwrap();
    assert_eq!(cell.name, "builtin:comau");
    let from = ["a/plan.csv", "b/plan.csv"].map(String::from);
    let groups = read_groups(&memory, &from, &cell.cell.setup.robot).unwrap();
    assert_eq!(groups[0].postures, groups[1].postures);
    assert_eq!((&*groups[0].name, &*groups[1].name), ("plan", "plan (2)"));
    let prior = read_stiffness(&memory, "prior", &cell.cell).unwrap();
    assert_eq!(prior.name, "prior");
    let hashes = memory.hashes.borrow();
    let roles: Vec<&str> = hashes.keys().map(String::as_str).collect();
    assert_eq!(roles, ["cell", "postures_1", "postures_2"]);
}

#[test]
fn meshes_lie_beside_the_cell_that_names_them() {
    assert_eq!(beside("builtin:comau-shapes", "a.obj"), "builtin:a.obj");
    assert_eq!(beside("cells/c.toml", "builtin:a.obj"), "builtin:a.obj");
    let slashes = |path: String| path.replace('\\', "/");
    assert_eq!(slashes(beside("cells/c.toml", "m/a.obj")), "cells/m/a.obj");
    assert_eq!(slashes(beside("c.toml", "a.obj")), "./a.obj");
    // Standard input, and a file of its name.
    assert_eq!(slashes(beside("-", "-")), "./-");
}

#[test]
fn sha256_of_the_standard_example() {
    // FIPS 180-4 example: "abc".
    assert_eq!(sha256_hex(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}
