//! A cell with two stations of the tracker, from the plan to the stiffness; and the same day without the word.

use crate::support::{self, Folder, in_lines, printed_sentence};
use insta::assert_snapshot;

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

/// Codes and sentences of what `identify` says of the readings.
fn codes(folder: &Folder, readings: &str) -> Vec<(String, String)> {
    let reduction = folder.json(&format!("identify cell.toml {readings}"))["result"]["readings"].clone();
    let parts = ["reduction", "screening"].map(|part| reduction[part]["findings"].clone());
    let text = |value: &serde_json::Value| value.as_str().unwrap().to_string();
    let finding = |finding: &serde_json::Value| (text(&finding["code"]), text(&finding["sentence"]));
    parts.iter().flat_map(|findings| findings.as_array().unwrap()).map(finding).collect()
}

#[test]
fn the_word_of_the_station_goes_from_plan_to_stiffness() {
    let folder = Folder::with("cell.toml", CELL.replace("[5000, 1200, 1500]", "[4500, -2500, 1500]"));
    let plan = "select cell.toml --space-filling --count 12 --seed 3 --force --output plan.csv";
    folder.ok(&format!("{plan} --sheet sheet.csv --print plan.html"));
    let sheet = folder.read("sheet.csv");
    let mut stations = changes(&sheet, "station");
    assert_eq!(stations.len(), 2, "{stations:?}");
    let page = folder.read("plan.html");
    let seen = stations.iter().map(|station| page.matches(&format!("Tracker at station {station}")).count());
    assert_eq!(seen.sum::<usize>(), page.matches("<section>").count());
    // The workbook has the same rows.
    folder.ok(&format!("{plan} --sheet sheet.xlsx"));
    let said = |sheet: &str| folder.run(&format!("identify cell.toml {sheet}")).err;
    assert_eq!(said("sheet.csv"), said("sheet.xlsx"));

    folder.ok("simulate cell.toml plan.csv --runs 2 --readings day.csv");
    let day = folder.read("day.csv");
    assert_eq!(changes(&day, "station"), stations);
    let findings = codes(&folder, "day.csv");
    assert_eq!(findings.iter().map(|(code, _)| code).collect::<Vec<_>>(), ["stations", "drift"]);
    let shown = folder.ok("identify cell.toml day.csv --details");
    stations.sort();
    assert_eq!(stations, ["front", "left"]);
    assert_snapshot!(in_lines(printed_sentence(&shown, "The tracker read")), @r"
    The tracker read from 2 stations, each registered by itself: front (7 postures, 9.6 µm RMS) and left
    (5 postures, 8.2 µm RMS).
    ");
    folder.ok("measure cell.toml plan.csv day.csv --once --no-search");

    // Without the column the move is found, and the rows that want a word.
    let table = day.lines().map(|line| {
        let mut fields: Vec<&str> = line.split(',').collect();
        fields.remove(6);
        fields.join(",") + "\n"
    });
    folder.write("silent.csv", table.collect::<String>());
    let findings = codes(&folder, "silent.csv");
    assert_eq!(findings.iter().map(|(code, _)| code).collect::<Vec<_>>(), ["drift", "moved-tracker"]);
    let (_, moved) = &findings[1];
    assert_snapshot!(in_lines(moved), @r"
    From posture 8 on the readings fit another tracker frame: one for all leaves the unloaded points
    3620 mm from the kinematic model, one of its own for each part 0.013 mm; they lie 7600 mm apart at
    the points, with a turn of 63.03°. If the tracker was moved or knocked, add a column station with 2
    in the rows of postures 8, 9, 10, 11 and 12, and another name in those before. If the robot was
    moved, for example on a rail, what stands beside it (anchor, obstacles) is elsewhere, too: identify
    what was read at each of its places with a cell of its own.
    ");
    let judged = folder.run("measure cell.toml plan.csv silent.csv --once --no-search");
    assert_eq!(judged.code, Some(1));
    assert!(support::unbroken(&judged.out).contains(moved), "{}", judged.out);
}
