//! Set-ups that every newcomer meets once are named, not calculated with.

use crate::support;

use support::{Folder, HEADING, replaced};

const CELL: &str = include_str!("../../../stiffarm-files/data/cells/comau.toml");

/// The default cell with one measuring point instead of four.
fn one_point() -> String {
    let points = CELL.find("[[tool.measuring_point]]").unwrap();
    let load = CELL.find("[load]").unwrap();
    format!(
        "{}[[tool.measuring_point]]\nname = \"1\"\nposition_mm = [150, 0, 200]\n\n{}",
        &CELL[..points],
        &CELL[load..]
    )
}

/// The lines of the load's table replaced.
fn with_load(text: &str, load: &str) -> String {
    let start = text.find("[load]").unwrap();
    let end = start + text[start + 1..].find("\n[").unwrap() + 2;
    format!("{}[load]\n{load}\n\n{}", &text[..start], &text[end..])
}

fn folder() -> Folder {
    let folder = Folder::new();
    let equal: String = (1..=6).map(|p| format!("{p},10,5,-100,-20,-15,-30\n")).collect();
    folder.write("equal.csv", format!("{HEADING}{equal}"));
    folder.write("one.csv", format!("{HEADING}1,10,5,-100,-20,-15,-30\n"));
    folder.write("inf.csv", format!("{HEADING}1,inf,5,-100,-20,-15,-30\n"));
    folder.write("nan.csv", format!("{HEADING}1,10,NaN,-100,-20,-15,-30\n"));
    folder.write("one-point.toml", one_point());
    folder.write("axis-6.toml", replaced(CELL, "loading_point_mm = [200, 0, 250]", "loading_point_mm = [0, 0, 250]"));
    let without_rope: String =
        CELL.lines().filter(|l| !l.starts_with("rope_length_mm")).map(|l| format!("{l}\n")).collect();
    folder.write("weight.toml", with_load(&without_rope, "kind = \"weight\"\nmagnitude_n = 500"));
    let five = "format = 1\nname = \"five joints\"\n[robot]\nname = \"five\"\ndh_modified = [[0, 0, 400, 0], [-90, 100, 0, 0], \
                [0, 600, 0, 0], [-90, 100, 500, 0], [90, 0, 100, 0]]\n[bounds]\nq_deg = [[-90, 90], [-90, 90], [-90, 90], \
                [-90, 90], [-90, 90]]\n[tool]\nloading_point_mm = [100, 0, 50]\n[[tool.measuring_point]]\nname = \"a\"\n\
                position_mm = [50, 0, 100]\n[[tool.measuring_point]]\nname = \"b\"\nposition_mm = [0, 50, 100]\n[load]\n\
                kind = \"rope\"\nmagnitude_n = 300\nanchor_mm = [1500, 0, -500]\n[stiffness]\nprior_nm_per_rad = [5e5, 1e6, \
                5e5, 1e5, 1e5]\n";
    folder.write("five.toml", five);
    folder.write(
        "five.csv",
        "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg\n1,10,20,30,40,50\n2,-30,10,50,-20,35\n3,50,-40,20,10,-60\n",
    );
    folder
}

#[test]
fn newcomers_set_ups_are_named() {
    let folder = folder();
    let mut report = String::new();
    for line in [
        // Six equal postures seen at one point: rank 3.
        "evaluate one-point.toml equal.csv",
        "select one-point.toml --initial equal.csv --index condition",
        "simulate one-point.toml equal.csv",
        // One posture with one point.
        "evaluate one-point.toml one.csv",
        // The load passes through axis 6; a vertical load on joint 1.
        "check axis-6.toml",
        "evaluate axis-6.toml builtin:comau-group1",
        "check weight.toml",
        "evaluate weight.toml builtin:comau-group1",
        // Fewer than six joints: no k(J_N).
        "evaluate five.toml five.csv",
        "select five.toml --initial five.csv --index classical",
        "evaluate builtin:comau five.csv",
        // Not numbers.
        "evaluate builtin:comau inf.csv",
        "evaluate builtin:comau nan.csv",
    ] {
        report += &folder.transcript(line);
    }
    insta::assert_snapshot!(report);
}
