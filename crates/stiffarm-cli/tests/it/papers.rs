//! Pictures for papers: `report --figures`.

use crate::support;

use support::Folder;

/// A folder with a saved result under two names.
fn folder() -> Folder {
    let folder = Folder::new();
    let result = folder.ok("predict builtin:comau prior builtin:contour --json");
    folder.write("path.json", &result);
    folder.write("other.json", &result);
    folder
}

#[test]
fn pictures_and_data_without_a_page() {
    let folder = folder();
    let said = folder.ok("report path.json --figures pictures --width-mm 60");
    assert!(said.ends_with("\nwrote 5 files in pictures\n"), "{said}");
    assert!(!folder.path("report.html").exists());
    // Of a chart also what it shows; the cell is a drawing.
    assert_eq!(
        folder.names_in("pictures"),
        ["cell.svg", "path-components.csv", "path-components.svg", "path.csv", "path.svg"]
    );
    let svg = folder.read("pictures/path.svg");
    assert!(svg.contains(r#"width="60mm""#), "{svg}");
    let refused = folder.refused("report path.json --figures pictures");
    assert!(refused.contains("--force"), "{refused}");
    folder.ok("report path.json --figures pictures --width-mm 60 --force");
    assert_eq!(svg, folder.read("pictures/path.svg"));
}

#[test]
fn pictures_of_several_results_begin_with_their_names() {
    let folder = folder();
    let said = folder.ok("report path.json other.json --figures p --format csv,svg --output page.html");
    assert!(said.ends_with("\nwrote page.html and 10 files in p\n"), "{said}");
    assert_eq!(
        folder.names_in("p"),
        [
            "other-cell.svg",
            "other-path-components.csv",
            "other-path-components.svg",
            "other-path.csv",
            "other-path.svg",
            "path-cell.svg",
            "path-path-components.csv",
            "path-path-components.svg",
            "path-path.csv",
            "path-path.svg"
        ]
    );
    let csv = folder.read("p/path-path.csv");
    assert_eq!(csv, folder.read("p/other-path.csv"));
    assert!(csv.starts_with("panel,panel title,series,"), "{csv}");
}

#[test]
fn wrong_requests_are_answered_and_write_nothing() {
    let folder = folder();
    for (options, answer) in [
        ("--figures p --width-mm 10", "must be 20 to 500 mm, got 10"),
        ("--figures p --font-pt 3", "must be 4 to 30 pt, got 3"),
        ("--figures p --format gif", "invalid value 'gif' for '--format <FORMAT,...>': svg and csv are written"),
        ("--figures p --format svg,PDF", "convert the SVG"),
        ("--width-mm 88", "--figures <DIR>"),
        ("--figures path.json", "the output is a folder"),
    ] {
        let said = folder.refused(&format!("report path.json {options}"));
        assert!(said.contains(answer), "{options}: {said}");
    }
    assert_eq!(folder.names(), ["other.json", "path.json"]);
}
