//! Mistakes in a path table are reported with place and hint; small paths are none.

use super::*;
use crate::common::cases::{cases, slip};

#[test]
fn slips_in_a_path_table() -> Check {
    let cell = cell_with("");
    let mut report = String::new();
    let mut note = |what: &str, read: stiffarm::Result<PathTable>| report += &slip(what, read);
    for [text, from, to] in cases(include_str!("slips.txt")) {
        let text = match text.as_str() {
            "POSES" => POSES,
            "ANGLES" => ANGLES,
            _ => TOOL_AXES,
        };
        assert!(text.contains(&from), "{from}");
        let shown = match to.as_str() {
            "" => format!("without {from}"),
            to => to.to_string(),
        };
        note(&shown.replace('\n', "; "), read(&text.replacen(&from, &to, 1), &cell));
    }
    // A path in metres beside the origin of its own frame.
    let metres = "x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n\
                  0,0,0,0,0,-1\n0.3,0,0,0,0,-1\n0.3,0.2,0,0,0,-1\n";
    note("metres in the workpiece frame", read(metres, &cell_with(WORKPIECE)));
    // The base frame need not be the robot's.
    let mut aside = cell_with("");
    let placed = Isometry3::translation(-2.0, 0.0, 0.5);
    aside.setup.robot = aside.setup.robot.with_base(&placed);
    note("metres beside the robot", read(metres, &aside));
    insta::assert_snapshot!("path_slips", report);
    Ok(())
}

#[test]
fn small_paths_and_points_are_no_slips() -> Check {
    let cell = cell_with(WORKPIECE);
    // One hole, the same point under several loads, a small engraving.
    for rows in
        ["0,0,0\n0,0,-5\n0,0,-10\n", "0,0,0\n0,0,0\n0,0,0\n0,0,0\n", "0,0,0\n0.2,0,0\n", "0,0,0\n2,0,0\n2,2,0\n0,2,0\n"]
    {
        let rows = rows.replace('\n', ",0,0,-1\n");
        let text = format!("x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n{rows}");
        read(&text, &cell)?;
        // The same in metres is no slip either.
        let text = "x_m,y_m,z_m,axis_x,axis_y,axis_z\n0,0,0,0,0,-1\n0.3,0,0,0,0,-1\n0.3,0.2,0,0,0,-1\n";
        read(text, &cell)?;
    }
    Ok(())
}
