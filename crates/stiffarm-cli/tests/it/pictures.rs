//! Pictures of a cell (`--figure` of `check` and `select`) show what the command says, the same every time.

use crate::support;

use insta::assert_snapshot;
use support::Folder;

/// Red of what violates a limit.
const RED: &str = "#c8102e";

/// A folder with the test cell that has a limit of every kind.
fn folder() -> Folder {
    let folder = Folder::new();
    let cells = concat!(env!("CARGO_MANIFEST_DIR"), "/../stiffarm/tests/cells/");
    let text = std::fs::read_to_string(format!("{cells}comau-shapes.toml")).unwrap();
    folder.write("shapes.toml", text);
    folder
}

/// What the command says about the picture.
fn about(folder: &Folder, line: &str) -> String {
    let ran = folder.run(line);
    assert!(ran.code == Some(0) || ran.code == Some(1), "{line}\n{}", ran.err);
    let picture = ran.out.split_once("\nPicture\n").unwrap().1;
    format!("$ stiffarm {line}\n{picture}\n")
}

#[test]
fn the_command_says_what_the_picture_shows() {
    let folder = folder();
    let report: String = [
        "check --figure middle.svg",
        "check --postures builtin:comau-group1 --figure tightest.svg",
        "check --postures builtin:comau-group1 --posture 3 --figure third.svg",
        "check --postures builtin:comau-group1 --posture all --figure all.svg",
        "check shapes.toml --figure usual.svg",
        "check shapes.toml --posture V2 --figure v2.svg",
        "check shapes.toml --posture all --figure red-all.svg",
    ]
    .iter()
    .map(|line| about(&folder, line))
    .collect();
    assert_snapshot!(report);
    for (name, red) in [
        ("middle", false),
        ("tightest", false),
        ("third", false),
        ("all", false),
        ("usual", false),
        ("v2", true),
        ("red-all", true),
    ] {
        let svg = folder.read(&format!("{name}.svg"));
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"), "{name}");
        assert_eq!(svg.contains(RED), red, "{name}");
    }
}

#[test]
fn a_picture_may_go_to_standard_output_and_is_the_same_every_time() {
    let folder = folder();
    let ran = folder.run("check --figure -");
    assert_eq!(ran.code, Some(0));
    assert!(ran.out.starts_with("<svg ") && ran.out.ends_with("</svg>\n"));
    assert!(ran.err.lines().any(|line| line.starts_with("cell: builtin:comau")), "{}", ran.err);
    folder.ok("check --figure cell.svg");
    assert_eq!(folder.read("cell.svg"), ran.out);
    folder.refused("check --figure cell.svg");
    folder.ok("check --figure cell.svg --force --threads 1");
    assert_eq!(folder.read("cell.svg"), ran.out);
    let value = folder.json("check --figure json.svg");
    assert_eq!(value["command"], "check");
    assert_eq!(folder.read("json.svg"), ran.out);
}

#[test]
fn a_plan_comes_with_its_picture() {
    let folder = folder();
    for (line, count) in [
        ("--initial builtin:comau-group1 --max-iterations 1", 6),
        ("-n 3 --rounds 1 --no-certificate", 3),
        ("--given builtin:comau-group1 --drop 2", 4),
        ("--space-filling -n 5", 5),
        ("--candidates builtin:comau-group1 -n 4 --no-certificate", 4),
    ] {
        folder.ok(&format!("select builtin:comau {line} --figure plan.svg --output plan.csv --force"));
        let svg = folder.read("plan.svg");
        assert!(svg.contains(&format!(" of {count}, the one with the least room")), "{line}");
        assert_eq!(folder.read("plan.csv").lines().count(), count + 1);
        // The plan that was written gives the same picture.
        folder.ok("check --postures plan.csv --figure again.svg --force");
        assert_eq!(folder.read("again.svg"), svg, "{line}");
    }
}

#[test]
fn wrong_requests_are_answered() {
    let folder = folder();
    folder.write("taken.svg", "mine");
    let cell = folder.read("shapes.toml");
    let (without, _) = cell.split_once("# Table 5.").unwrap();
    folder.write("bare.toml", without);
    let report = folder.refusals([
        "check --figure taken.svg",
        "check --figure nowhere/cell.svg",
        "check --figure cell.PDF",
        "select builtin:comau --figure plan.png",
        "predict builtin:comau prior builtin:contour --figure path.pdf --json",
        "check --posture V1",
        "check --postures builtin:comau-group1",
        "check --figure cell.svg --posture V9",
        "check --figure cell.svg --postures none.csv",
        "check bare.toml --figure cell.svg --posture all",
        "check --figure - --json",
        "check shapes.toml --figure shapes.toml --force",
        "select builtin:comau --figure plan.svg --output plan.svg",
        "select builtin:comau --curve --figure plan.svg",
    ]);
    assert_eq!(folder.read("taken.svg"), "mine");
    assert_snapshot!(report.replace("-- exit code 2\n", ""));
}
