//! Sheets to fill in, pages to print, and tables that are filled in part or come in several files.

use crate::support;

use insta::assert_snapshot;
use support::{Folder, sentence, unbroken};

const PLAN: &str = "select builtin:comau --initial builtin:comau-group1 --max-iterations 1 --output plan.csv --force";

/// A plan of six postures and the readings of an experiment with it.
fn experiment() -> (Folder, Vec<String>) {
    let folder = Folder::new();
    folder.ok(PLAN);
    folder.ok("simulate builtin:comau plan.csv --runs 2 --readings readings.csv");
    let rows = folder.read("readings.csv");
    let rows = rows.lines().map(String::from).collect();
    (folder, rows)
}

#[test]
fn a_workbook_is_the_sheet_of_the_text() {
    let folder = Folder::new();
    let states = "--states up-250,up-500 --drift --base-reflector";
    folder.ok(&format!("{PLAN} --sheet sheet.csv {states}"));
    folder.ok(&format!("{PLAN} --sheet sheet.xlsx {states}"));
    let first = std::fs::read(folder.path("sheet.xlsx")).unwrap();
    assert!(first.starts_with(b"PK"));
    folder.ok(&format!("{PLAN} --sheet sheet.XLSX {states}"));
    let second = std::fs::read(folder.path("sheet.XLSX")).unwrap();
    assert_eq!(first, second);
    // Both are read, and neither is filled in yet.
    let said = |sheet: &str| {
        let ran = folder.run(&format!("identify builtin:comau {sheet}"));
        assert_eq!(ran.code, Some(2));
        ran.err
    };
    assert_eq!(said("sheet.csv"), said("sheet.xlsx"));
    assert_snapshot!(said("sheet.xlsx"));
}

#[test]
fn names_of_sheets_say_their_format() {
    let folder = Folder::new();
    let ran = folder.run(&format!("{PLAN} --sheet sheet.ods"));
    assert_eq!((ran.code, folder.names().len()), (Some(2), 0));
    assert_snapshot!(ran.err);
}

#[test]
fn the_page_to_print_shows_each_posture_once() {
    let folder = Folder::new();
    folder.ok(&format!("{PLAN} --print plan.html --states up-250,up-500"));
    let page = folder.read("plan.html");
    for (what, count) in [
        ("<section>", 6),
        ("<svg ", 6),
        ("☐", 6 * 3 * 4),
        // As the pendant of a COMAU has it.
        ("<th>J6 [°]</th>", 6),
        ("<th>load [N]</th>", 6),
    ] {
        assert_eq!(page.matches(what).count(), count, "{what}");
    }
    // The angles are those of the plan, to a hundredth.
    let plan = folder.read("plan.csv");
    let first: f64 = plan.lines().nth(1).unwrap().split(',').nth(1).unwrap().parse().unwrap();
    assert!(page.contains(&format!(">{first:.2}<").replace('-', "−")), "{first}");
    // The same plan gives the same bytes.
    folder.ok(&format!("{PLAN} --print again.html --states up-250,up-500"));
    assert_eq!(page, folder.read("again.html"));
}

#[test]
fn a_sheet_filled_in_part_is_read_and_says_what_is_missing() {
    let (folder, rows) = experiment();
    // Postures 5 and 6 are not measured yet, of 4 only the unloaded readings.
    let part = rows.iter().map(|row| {
        let mut fields: Vec<&str> = row.split(',').collect();
        let open = ["5", "6"].contains(&fields[0]) || (fields[0] == "4" && fields[1] != "unloaded");
        if open {
            fields.splice(3..6, [""; 3]);
        }
        fields.join(",") + "\n"
    });
    folder.write("part.csv", part.collect::<String>());
    let done = rows.iter().filter(|row| !row.starts_with(['4', '5', '6']));
    folder.write("done.csv", done.map(|row| format!("{row}\n")).collect::<String>());
    let (part, done) = (folder.run("identify builtin:comau part.csv"), folder.run("identify builtin:comau done.csv"));
    assert_eq!(part.code, done.code, "{}", part.err);
    // One line more; the numbers are those of the postures that are measured.
    let more: Vec<&str> = part.out.lines().filter(|line| !done.out.contains(line)).collect();
    assert_snapshot!(more.join("\n"));
    let identified = folder.json("identify builtin:comau part.csv")["result"]["readings"]["reduction"].clone();
    let missing = sentence(&identified["findings"], "not-measured-yet");
    assert!(unbroken(&part.out).contains(missing), "{missing}\n{}", part.out);
    let validated = folder.run("validate builtin:comau part.csv --folds all");
    assert!(unbroken(&validated.out).contains(missing), "{missing}\n{}", validated.out);
}

#[test]
fn several_files_are_one_table() {
    let (folder, rows) = experiment();
    let write = |name: &str, wanted: &dyn Fn(&str) -> bool| {
        let part = rows[1..].iter().filter(|row| wanted(row));
        let text: String = part.map(|row| format!("{row}\n")).collect();
        folder.write(name, format!("{}\n{text}", rows[0]));
    };
    write("a.csv", &|row| row.starts_with(['1', '2', '3']));
    write("b.csv", &|row| !row.starts_with(['1', '2', '3']));
    let out = |line: &str| {
        let ran = folder.run(line);
        assert!(matches!(ran.code, Some(0 | 1)), "{line}\n{}", ran.err);
        ran.out
    };
    let whole = out("identify builtin:comau readings.csv");
    assert_eq!(out("identify builtin:comau a.csv b.csv"), whole);
    out("identify builtin:comau readings.csv --output stiffness.json");
    assert_eq!(
        out("validate builtin:comau stiffness.json a.csv b.csv"),
        out("validate builtin:comau stiffness.json readings.csv")
    );
    assert_eq!(
        out("validate builtin:comau a.csv b.csv --folds 3"),
        out("validate builtin:comau readings.csv --folds 3")
    );
    // A slip is told with the file it stands in.
    let broken = folder.read("b.csv").replacen("unloaded", "unloded", 1);
    folder.write("b.csv", broken);
    let ran = folder.run("identify builtin:comau a.csv b.csv");
    assert_eq!(ran.code, Some(2));
    assert_snapshot!(ran.err);
}
