//! Several loads under which every posture is measured, from the cell to the stiffness.

use crate::support;

use insta::assert_snapshot;
use support::Folder;

/// The default cell, whose load is replaced.
const CELL: &str = include_str!("../../../stiffarm-files/data/cells/comau.toml");

/// Several loads for its place.
const CASES: &str = include_str!("../../../stiffarm/tests/cells/load-cases.toml");

/// The cell with these lines instead of its load.
fn cell(load: &str) -> String {
    let (before, rest) = CELL.split_once("[load]").unwrap();
    let (_, after) = rest.split_once("[limits]").unwrap();
    format!("{before}{load}\n[limits]{after}")
}

#[test]
fn from_the_cell_to_the_stiffness() {
    let folder = Folder::new();
    folder.write("cell.toml", cell(CASES));
    let mut report = String::new();
    let mut run = |line: &str| {
        let ran = folder.run(line);
        report += &ran.transcript(line).replace("-- standard error\n", "");
        report.push('\n');
        ran
    };
    run("check cell.toml");
    let ran = run("select cell.toml --count 4 --rounds 1 --output plan.csv --sheet sheet.csv");
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    run("evaluate cell.toml plan.csv");
    run("predict cell.toml prior plan.csv --cell-load");
    run("predict cell.toml prior plan.csv --cell-load --load-case push");
    // States of a posture in the sheet: each load between unloaded ones.
    let sheet = std::fs::read_to_string(folder.path("sheet.csv")).unwrap();
    let mut states: Vec<&str> =
        sheet.lines().skip(1).filter(|line| line.starts_with("1,")).filter_map(|line| line.split(',').nth(1)).collect();
    states.dedup();
    let expected = ["unloaded", "left", "unloaded-2", "push", "unloaded-3", "weight"];
    assert_eq!(states, expected);
    let ran = folder.run("simulate cell.toml plan.csv --runs 20 --readings readings.csv");
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    let ran = run("identify cell.toml readings.csv");
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    // No two loads are taken for the way up and the way down.
    assert!(!ran.out.contains("friction"));
    assert_snapshot!(report);
}

#[test]
fn wrong_load_cases_are_answered_with_place_and_hint() {
    let folder = Folder::new();
    let like_another = CASES.replacen("\"push\"", "\"left-2\"", 1);
    folder.write("like-another.toml", cell(&like_another));
    folder.write("cell.toml", cell(CASES));
    folder.write(
        "readings.csv",
        "posture,state,point,dx_mm,dy_mm,dz_mm,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n\
         1,above,1,0.1,0.2,0.3,10,-20,-90,30,40,50\n",
    );
    let heading = "posture,state,point,x_mm,y_mm,z_mm,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n";
    let angles = "10,-20,-90,30,40,50";
    let states = ["unloaded", "left-low", "left-two"].map(|state| {
        let point = |point: u32| format!("1,{state},{point},1,2,3,{angles}\n");
        (1..=4).map(point).collect::<String>()
    });
    folder.write("two-sizes.csv", format!("{heading}{}", states.concat()));
    folder.write(
        "no-state.csv",
        format!(
            "posture,point,dx_mm,dy_mm,dz_mm,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n1,1,0.1,0.2,0.3,{angles}\n"
        ),
    );
    assert_snapshot!(folder.refusals([
        "check like-another.toml",
        "identify cell.toml two-sizes.csv",
        "identify cell.toml no-state.csv",
        "select cell.toml --count 4 --states left,loaded --sheet s.csv",
        "select cell.toml --count 4 --states preload,left --sheet s.csv",
        "identify cell.toml readings.csv",
        "select cell.toml --count 4 --largest-load-n 600",
        "zones cell.toml",
        "predict cell.toml prior plan.csv --cell-load --load-case right",
    ]));
}

#[test]
fn a_sheet_with_two_sizes_of_one_load_asks_for_them() {
    let folder = Folder::new();
    folder.write("cell.toml", cell(CASES));
    let line = "select cell.toml --space-filling --count 2 --states left-250,left-500,push \
                --sheet sheet.csv";
    assert_eq!(folder.run(line).code, Some(0));
    let sheet = std::fs::read_to_string(folder.path("sheet.csv")).unwrap();
    let loads = |sheet: &str| -> Vec<String> {
        let rows = sheet.lines().filter(|line| line.starts_with("1,"));
        let rows = rows.filter(|line| line.split(',').nth(2) == Some("1"));
        let fields = rows.map(|line| line.split(',').map(String::from).collect::<Vec<_>>());
        fields.map(|f| format!("{} {}", f[1], f[6])).collect()
    };
    // Sizes are those of the names, else those of the cell: a mass of 50 kg weighs 490 N.
    let expected = ["unloaded ", "left-250 250", "left-500 500", "push 400"];
    assert_eq!(loads(&sheet), expected);
    let line = "select cell.toml --space-filling --count 2 --sheet plain.csv";
    assert_eq!(folder.run(line).code, Some(0));
    let sheet = std::fs::read_to_string(folder.path("plain.csv")).unwrap();
    let expected = ["unloaded ", "left 500", "unloaded-2 ", "push 400", "unloaded-3 "];
    let loads = loads(&sheet);
    assert_eq!(loads[..5], expected);
    assert!(loads[5].starts_with("weight 490."), "{}", loads[5]);
}
