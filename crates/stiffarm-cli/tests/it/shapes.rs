//! A wrong shape is refused with its place, and limits that leave no posture are named.

use crate::support;

use insta::assert_snapshot;
use support::{Folder, replaced};

/// A test cell with every kind of limit.
const CELL: &str = include_str!("../../../stiffarm/tests/cells/comau-shapes.toml");

#[test]
fn a_wrong_shape_is_answered_with_place_and_hint() {
    let folder = Folder::new();
    let inside = replaced(CELL, "position_mm = [5000, 1200, 1500]", "position_mm = [1900, -700, 500]");
    folder.write("station-in-obstacle.toml", inside);
    assert_snapshot!(folder.refusals(["check station-in-obstacle.toml"]));
}

#[test]
fn limits_that_leave_no_posture_are_named() {
    let folder = Folder::new();
    folder.write("wrist.toml", replaced(CELL, "wrist_height_mm = 300", "wrist_height_mm = 5000"));
    // A floor above the top of the box.
    let corner = "box_max_mm = [3000, 1900, 3000]";
    folder.write("floor.toml", replaced(CELL, corner, "box_max_mm = [3000, 1900, 1000]\nfloor_mm = 1200"));
    let report = folder.refusals([
        "select wrist.toml --count 4 --rounds 1 --output plan.csv",
        "select floor.toml --count 4 --rounds 1 --output plan.csv",
    ]);
    assert!(!folder.path("plan.csv").exists());
    assert_snapshot!(report);
}
