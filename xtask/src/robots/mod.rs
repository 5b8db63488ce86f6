//! `cargo xtask robots FOLDER`: the catalogue's data file from descriptions of robots.
//!
//! FOLDER holds `robots_catalogue.json`, `capsules.json`, `distances.json` and `urdf/NAME.urdf`. A robot is added there; nothing here knows one by name
//! except what other sources say of it (`ELSEWHERE` in `doubts`).

mod capsules;
mod doubts;
mod entry;
mod json;

use std::path::Path;

use crate::generate::first_difference;
use crate::run::{Failure, Workspace};
use json::Json;

/// The data file, relative to the workspace root.
const TARGET: &str = "crates/stiffarm/data/robots.rs";

const HEADING: &str = "\
// Robots of the catalogue: Rust literals, so that the compiler checks every field and nothing is read at run time.
// Written by `cargo xtask robots FOLDER` from public robot descriptions; change the generator or its data, not this file.
//
// rows: alpha [deg], a [mm], d [mm], offset [deg] of modified (Craig) Denavit-Hartenberg rows, one per joint.
// coupling: C of theta = offset + C q as (row, column, factor), counted from 0; q are the pendant's angles.
// limits_deg: of the pendant's angles. speeds_deg_s: largest joint speeds. Empty where not known.
// capsules: link, both ends, radius [mm]; of link 0 in the base frame, of link i in the frame that row i ends in.
// ignored_pairs: links that are no neighbours whose capsules overlap always, or overlap where the links never collide.
// base, flange, controller_base: x, y, z [mm] and turns about fixed x, then y, then z [deg].
&[
";

/// Writes the data file, or with `check` compares it with what would be written.
pub fn run(workspace: &Workspace, folder: &Path, check: bool) -> Result<(), Failure> {
    let text = generated(folder)?;
    let path = workspace.root().join(TARGET);
    if !check {
        return std::fs::write(&path, text)
            .map_err(|e| Failure::internal(format!("{TARGET}: {e}"), "make it writable"));
    }
    let there = std::fs::read(&path)
        .map_err(|e| Failure::internal(format!("{TARGET}: {e}"), "run it without --check"))?;
    if there == text.as_bytes() {
        return Ok(());
    }
    let line = first_difference(&there, text.as_bytes());
    Err(Failure::finding(
        format!(
            "{TARGET} is not what {} gives: line {line} differs",
            folder.display()
        ),
        format!("run `cargo xtask robots {}`", folder.display()),
    ))
}

/// The data file of the robots in `folder`.
fn generated(folder: &Path) -> Result<String, Failure> {
    let wrong = |path: &Path, message: String| {
        Failure::usage(
            format!("{}: {message}", path.display()),
            "name the folder of the robots, for example ../shared/reference/robots",
        )
    };
    let read = |name: &str| -> Result<Json, Failure> {
        let path = folder.join(name);
        let text = std::fs::read_to_string(&path).map_err(|e| wrong(&path, e.to_string()))?;
        Json::parse(&text).map_err(|e| wrong(&path, e))
    };
    let Json::Object(robots) = read("robots_catalogue.json")? else {
        return Err(wrong(folder, "no object of robots".to_string()));
    };
    let (capsules, distances) = (read("capsules.json")?, read("distances.json")?);
    let mut out = HEADING.to_string();
    for (name, robot) in &robots {
        let path = folder.join("urdf").join(format!("{name}.urdf"));
        let urdf = std::fs::read_to_string(&path).map_err(|e| wrong(&path, e.to_string()))?;
        let fields = entry::fields(name, robot, &urdf)
            .and_then(|own| Ok(own + &capsules::fields(name, &capsules, &distances)?))
            .map_err(|e| wrong(folder, format!("{name}: {e}")))?;
        out +=
            &format!("    CatalogueEntry {{\n{fields}        ..CatalogueEntry::UNKNOWN\n    }},\n");
    }
    Ok(out + "]\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[ignore = "needs STIFFARM_REFERENCE_DATA"]
    fn the_data_file_is_what_the_descriptions_give() {
        let reference = std::env::var_os("STIFFARM_REFERENCE_DATA").expect("names a folder");
        let workspace = Workspace::find().unwrap();
        let folder = Path::new(&reference).join("robots");
        if let Err(failure) = run(&workspace, &folder, true) {
            panic!("{}", failure.message);
        }
    }

    #[test]
    fn a_folder_without_robots_is_wrong_usage() {
        let workspace = Workspace::find().unwrap();
        let failure = run(&workspace, Path::new("no-such-folder"), true).unwrap_err();
        assert_eq!(failure.code, 2);
        assert!(failure.message.contains("robots_catalogue.json"));
    }
}
