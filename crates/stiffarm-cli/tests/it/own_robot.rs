//! docs/own-robot.md, top to bottom: its files are written, its commands run.

use crate::support;

use support::{Folder, blocks};

#[test]
fn a_robot_of_ones_own_gets_a_plan_as_the_page_says() {
    let page = include_str!("../../../../docs/own-robot.md");
    let folder = Folder::new();
    let mut said = String::new();
    for (language, text) in blocks(page) {
        match language {
            "csv" => folder.write("kr210.csv", text),
            "toml" => {
                let written = folder.read("cell.toml");
                if text.starts_with("controller") {
                    let place = "# controller = \"other\"\n";
                    assert!(written.contains(place), "{written}");
                    folder.write("cell.toml", written.replace(place, text));
                    continue;
                }
                let (before, _) = written.split_once("[bounds]").unwrap();
                folder.write("cell.toml", format!("{before}{text}"));
            }
            "sh" => {
                for line in text.lines() {
                    let line = line.strip_prefix("stiffarm ").unwrap();
                    said += &folder.ok(line);
                }
            }
            other => panic!("{other}: {text}"),
        }
    }
    // What leaves each posture the least room stands beside it.
    for line in ["Nothing to complain about.", "posture  least at"] {
        assert!(said.lines().any(|printed| printed.starts_with(line)), "{line}\n{said}");
    }
    for picture in ["cell.svg", "plan.svg"] {
        assert!(folder.read(picture).starts_with("<svg"), "{picture}");
    }
    let plan = folder.read("plan.csv");
    assert_eq!(plan.lines().count(), 1 + 6, "{plan}");
    assert!(folder.read("readings.csv").lines().count() > 4 * 6);
}
