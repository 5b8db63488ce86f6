//! `cargo xtask robots FOLDER`: the catalogue's data file from descriptions of robots.
//!
//! FOLDER holds `robots_catalogue.json`, `capsules.json`, `distances.json` and `urdf/NAME.urdf`. A robot is added
//! there; nothing here knows one by name except what other sources say of it (`elsewhere` in `words.json`).

mod capsules;
mod entry;
mod words;

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use serde::de::DeserializeOwned;

use crate::files::{self, first_difference};
use crate::run::{Failure, Workspace};
use capsules::{Capsules, Distances};
use entry::Robot;
use words::Words;

/// The data file, relative to the workspace root.
const TARGET: &str = "crates/stiffarm/data/robots.toml";

const HEADING: &str = "\
# Robots of the catalogue, from public robot descriptions.
# Written by `cargo xtask robots FOLDER`; change the generator or its data, not this file.
#
# payload [kg] and reach [m], each with its source.
# rows: alpha [deg], a [mm], d [mm], offset [deg] of modified (Craig) Denavit-Hartenberg rows, one per joint.
# coupling: C of theta = offset + C q as row, column, factor, counted from 0; q are the pendant's angles.
# limits_deg: of the pendant's angles. speeds_deg_s: largest joint speeds. Left out where not known.
# capsules: link, both ends, radius [mm]; of link 0 in the base frame, of link i in the frame that row i ends in.
# ignored_pairs: links that are no neighbours whose capsules overlap always, or overlap where the links never collide.
# base, flange, controller_base: x, y, z [mm] and turns about fixed x, then y, then z [deg].
";

/// Writes the data file, or with `check` compares it with what would be written.
pub fn run(workspace: &Workspace, folder: &Path, check: bool) -> Result<(), Failure> {
    let text = generated(folder)?;
    let path = workspace.root().join(TARGET);
    if !check {
        return files::write(&path, text);
    }
    let there = files::read(&path)?;
    if there == text.as_bytes() {
        return Ok(());
    }
    let line = first_difference(&there, text.as_bytes());
    Err(Failure::finding(
        format!("{TARGET} is not what {} gives: line {line} differs", folder.display()),
        format!("run `cargo xtask robots {}`", folder.display()),
    ))
}

/// The data file of the robots in `folder`.
fn generated(folder: &Path) -> Result<String, Failure> {
    let robots: BTreeMap<String, Robot> = read(&folder.join("robots_catalogue.json"))?;
    let capsules: BTreeMap<String, Capsules> = read(&folder.join("capsules.json"))?;
    let distances: BTreeMap<String, Distances> = read(&folder.join("distances.json"))?;
    let words = Words::read();
    // The catalogue has the order of its description, which a map forgets.
    let text = files::text(&folder.join("robots_catalogue.json"))?;
    let mut robots = Vec::from_iter(&robots);
    robots.sort_by_key(|(name, _)| text.find(&format!("\"{name}\":")));
    let mut out = HEADING.to_string();
    for (name, robot) in robots {
        let path = folder.join("urdf").join(format!("{name}.urdf"));
        let urdf = std::fs::read_to_string(&path).map_err(|e| wrong(&path, e))?;
        let (Some(capsules), Some(distances)) = (capsules.get(name), distances.get(name)) else {
            return Err(wrong(folder, format!("{name} has no capsules or distances")));
        };
        let fields = entry::fields(name, robot, &urdf, &words)
            .and_then(|lines| Ok(lines + &capsules::fields(name, capsules, distances, &words)?))
            .map_err(|e| wrong(folder, format!("{name}: {e}")))?;
        out += &format!("\n[[robot]]\n{fields}");
    }
    Ok(out)
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T, Failure> {
    let text = std::fs::read_to_string(path).map_err(|e| wrong(path, e))?;
    serde_json::from_str(&text).map_err(|e| wrong(path, e))
}

fn wrong(path: &Path, message: impl fmt::Display) -> Failure {
    Failure::usage(
        format!("{}: {message}", path.display()),
        "name the folder of the robots, for example ../shared/reference/robots",
    )
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
