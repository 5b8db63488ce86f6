//! Faults that were found once stay away, and inputs follow from their seed.

use std::path::Path;
use stiffarm_fuzz::input::Input;
use stiffarm_fuzz::run::{judge, make};
use stiffarm_fuzz::targets::{ALL, named};

#[test]
fn faults_that_were_found_stay_away() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("regressions");
    let entries = |folder: &Path| {
        let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        paths
    };
    let mut faults = Vec::new();
    for folder in entries(&root) {
        if !folder.is_dir() {
            continue;
        }
        let name = folder.file_name().unwrap().to_string_lossy().into_owned();
        let target = named(&name).unwrap_or_else(|| panic!("no target {name}"));
        for path in entries(&folder) {
            let bytes = std::fs::read(&path).unwrap();
            let input = Input::from_bytes(&bytes, target.is_command);
            if let Err(fault) = judge(target, &input) {
                faults.push(format!("{}: {fault}", path.display()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn inputs_follow_from_seed_and_index() {
    for target in &ALL {
        let inputs: Vec<Input> = (0..50).map(|i| make(target, 7, i)).collect();
        let again: Vec<Input> = (0..50).map(|i| make(target, 7, i)).collect();
        assert_eq!(inputs, again, "{}", target.name);
        let different = inputs.iter().filter(|input| **input != inputs[0]).count();
        assert!(different > 40, "{}: {different}", target.name);
    }
}

/// Inputs of each reader; `cargo xtask fuzz` goes on from there.
const INPUTS: u64 = 80;

#[test]
fn readers_take_some_inputs_and_refuse_others() {
    for target in ALL.iter().filter(|target| !target.is_command) {
        let accepted = (0..INPUTS)
            .map(|i| (i, judge(target, &make(target, 11, i))))
            .filter(|(i, judged)| match judged {
                Ok(accepted) => *accepted,
                Err(fault) => panic!("{}, input {i} of seed 11: {fault}", target.name),
            })
            .count();
        assert!(accepted > 0 && accepted < INPUTS as usize, "{}: {accepted}", target.name);
    }
}
