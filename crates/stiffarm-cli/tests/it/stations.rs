//! A cell with two stations of the tracker, from the plan to the stiffness; and the same day without the word.

use crate::support::Folder;

/// A test cell whose tracker has two stations.
const CELL: &str = include_str!("../../../stiffarm/tests/cells/comau-shapes.toml");

/// The names in a column of a table, each as often as it changes.
fn changes(table: &str, column: &str) -> Vec<String> {
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let at = rows.next().unwrap().iter().position(|name| *name == column);
    let mut out: Vec<String> = rows.map(|row| row[at.unwrap()].to_string()).collect();
    out.dedup();
    out
}

/// The codes of the findings that `identify` tells, and its exit code.
fn codes(folder: &Folder, readings: &str) -> (Vec<String>, String) {
    let found = folder.json(&format!("identify cell.toml {readings}"));
    let reduction = &found["result"]["readings"];
    let mut all = Vec::new();
    let mut sentences = String::new();
    for part in ["reduction", "screening"] {
        for finding in reduction[part]["findings"].as_array().unwrap() {
            all.push(finding["code"].as_str().unwrap().to_string());
            sentences += finding["sentence"].as_str().unwrap();
        }
    }
    (all, sentences)
}

#[test]
fn the_word_of_the_station_goes_from_plan_to_stiffness() {
    let folder = Folder::with("cell.toml", CELL.replace("[5000, 1200, 1500]", "[4500, -2500, 1500]"));
    let plan = "select cell.toml --space-filling --count 12 --seed 3 --force --output plan.csv";
    folder.ok(&format!("{plan} --sheet sheet.csv --print plan.html"));
    let sheet = folder.read("sheet.csv");
    let mut stations = changes(&sheet, "station");
    assert_eq!(stations.len(), 2, "{stations:?}");
    assert!(folder.read("plan.html").contains("Tracker at station left"));
    // The workbook has the same rows.
    folder.ok(&format!("{plan} --sheet sheet.xlsx"));
    let said = |sheet: &str| folder.run(&format!("identify cell.toml {sheet}")).err;
    assert_eq!(said("sheet.csv"), said("sheet.xlsx"));

    folder.ok("simulate cell.toml plan.csv --runs 2 --readings day.csv");
    let day = folder.read("day.csv");
    assert_eq!(changes(&day, "station"), stations);
    let (found, _) = codes(&folder, "day.csv");
    assert_eq!(found, ["stations", "drift"]);
    let shown = folder.ok("identify cell.toml day.csv --details");
    stations.sort();
    assert_eq!(stations, ["front", "left"]);
    assert!(shown.contains("The tracker read from 2 stations"), "{shown}");
    folder.ok("measure cell.toml plan.csv day.csv --once --no-search");

    // Without the column the move is found, and the rows that want a word.
    let table = day.lines().map(|line| {
        let mut fields: Vec<&str> = line.split(',').collect();
        fields.remove(6);
        fields.join(",") + "\n"
    });
    folder.write("silent.csv", table.collect::<String>());
    let (found, sentences) = codes(&folder, "silent.csv");
    assert!(found.contains(&"moved-tracker".to_string()), "{found:?}");
    assert!(!found.contains(&"registration-outlier".to_string()), "{found:?}");
    assert!(sentences.contains("add a column station with 2"), "{sentences}");
    let judged = folder.run("measure cell.toml plan.csv silent.csv --once --no-search");
    assert_eq!(judged.code, Some(1));
    assert!(judged.out.contains("another tracker"), "{}", judged.out);
}
