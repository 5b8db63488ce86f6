//! `report --figures` writes pictures and their data for papers, and nothing where it is asked for what it cannot do.

use crate::support;

use insta::assert_snapshot;
use support::{Folder, place};

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
    let error = folder.error("report path.json --figures pictures");
    assert_eq!((error["code"].as_str(), place(&error)), (Some("file-exists"), "pictures/path.svg".to_string()));
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
    let refused = folder.each_refused(&[
        ("report path.json --figures p --width-mm 10", "invalid-value", ""),
        ("report path.json --figures p --font-pt 3", "invalid-value", ""),
        ("report path.json --figures p --format gif", "usage", "--format"),
        ("report path.json --figures p --format svg,PDF", "usage", "--format"),
        ("report path.json --width-mm 88", "usage", ""),
        ("report path.json --figures path.json", "file-write", "path.json"),
    ]);
    assert_snapshot!(refused);
    assert_eq!(folder.names(), ["other.json", "path.json"]);
}
