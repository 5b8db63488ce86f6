//! Wrong shapes, stations, clearances and torques, and limits that leave no posture.

use crate::support;

use insta::assert_snapshot;
use support::Folder;

/// A test cell with every kind of limit.
const CELL: &str = include_str!("../../../stiffarm/tests/cells/comau-shapes.toml");

/// The cell with `from` replaced where it stands first.
fn slip(from: &str, to: &str) -> String {
    assert!(CELL.contains(from), "{from}");
    CELL.replacen(from, to, 1)
}

#[test]
fn wrong_shapes_are_answered_with_place_and_hint() {
    let folder = Folder::new();
    let slips = [
        ("bounds-inverted", "[-60, 40],", "[40, -60],"),
        (
            "limits-inverted",
            "characteristic_length_mm = 773",
            "characteristic_length_mm = 773\n\
             limits_deg = [[-180, 180], [60, -60], [-180, 0], [-300, 300], [-120, 120], [-300, 300]]",
        ),
        (
            "station-in-obstacle",
            "position_mm = [5000, 1200, 1500]",
            "position_mm = [1900, -700, 500]",
        ),
        (
            "point-in-tool",
            "position_mm = [150, 0, 200]",
            "position_mm = [50, 0, 200]",
        ),
        ("unknown-kind", "kind = \"capsule\"", "kind = \"sphere\""),
        ("floor-on-tool", "kind = \"cylinder\"", "kind = \"floor\""),
        (
            "foreign-key",
            "kind = \"box\"",
            "kind = \"box\"\nradius_mm = 20",
        ),
        ("no-radius", "radius_mm = 80\n", ""),
        (
            "flat-box",
            "size_mm = [900, 700, 800]",
            "size_mm = [900, 0, 800]",
        ),
        (
            "ignore-unknown",
            "[\"link 1\", \"beam\"]",
            "[\"link 1\", \"bean\"]",
        ),
        (
            "ignore-three",
            "[\"link 1\", \"beam\"]",
            "[\"link 1\", \"beam\", \"table\"]",
        ),
        ("cone-without-axis", "rope_axis = [0, 0, 1]\n", ""),
        (
            "axis-zero",
            "rope_axis = [0, 0, 1]",
            "rope_axis = [0, 0, 0]",
        ),
        ("visible-5", "visible_points = 3", "visible_points = 5"),
        ("visible-0", "visible_points = 3", "visible_points = 0"),
        (
            "torques-5",
            "[900, 1600, 1200, 300, 250, 120]",
            "[900, 1600, 1200, 300, 250]",
        ),
        (
            "torque-zero",
            "[900, 1600, 1200, 300, 250, 120]",
            "[900, 1600, 0, 300, 250, 120]",
        ),
        ("station-twice", "name = \"left\"", "name = \"front\""),
        ("cone-without-axis", "rope_axis = [0, 0, 1]\n", ""),
        (
            "too-many-points",
            "visible_points = 3",
            "visible_points = 9",
        ),
        (
            "torque-limits",
            "torque_limits_nm = [900, 1600, 1200, 300, 250, 120]",
            "torque_limits_nm = [900, 1600, 1200]",
        ),
        ("name-of-a-link", "name = \"spindle\"", "name = \"link 3\""),
        ("no-such-link", "link = 6", "link = 7"),
    ];
    let mut report = String::new();
    for (name, from, to) in slips {
        folder.write(&format!("{name}.toml"), slip(from, to));
        let line = format!("check {name}.toml");
        let ran = folder.run(&line);
        assert_eq!(ran.code, Some(2), "{line}\n{}{}", ran.out, ran.err);
        assert_eq!(ran.out, "", "{line} printed a part of a result");
        report += &ran.transcript(&line).replace("-- standard error\n", "");
        report.push('\n');
    }
    assert_snapshot!(report);
}

#[test]
fn limits_that_leave_no_posture_are_named() {
    let folder = Folder::new();
    folder.write(
        "wrist.toml",
        slip("wrist_height_mm = 300", "wrist_height_mm = 5000"),
    );
    // A floor above the top of the box.
    let corner = "box_max_mm = [3000, 1900, 3000]";
    folder.write(
        "floor.toml",
        slip(corner, "box_max_mm = [3000, 1900, 1000]\nfloor_mm = 1200"),
    );
    let mut report = String::new();
    for line in [
        "select wrist.toml --count 4 --rounds 1 --output plan.csv",
        "select floor.toml --count 4 --rounds 1 --output plan.csv",
    ] {
        let ran = folder.run(line);
        assert_eq!(ran.code, Some(2), "{line}\n{}{}", ran.out, ran.err);
        report += &ran.transcript(line).replace("-- standard error\n", "");
        report.push('\n');
    }
    assert!(!folder.path("plan.csv").exists());
    assert_snapshot!(report);
}
