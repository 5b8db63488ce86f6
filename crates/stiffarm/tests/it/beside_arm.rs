//! Sizes, places and angles that no cell has beside its arm are doubted; those of sound cells are not.

use crate::common::prelude::*;
use stiffarm::findings::codes;
use stiffarm::model::robot::catalogue;
use stiffarm::plan::check::check;
use stiffarm::plan::evaluated::Evaluated;
use stiffarm::plan::route::{RouteOptions, route, route_findings};
use stiffarm_files::cell::template;

/// A built-in cell with parts of its file replaced, and more behind it.
fn with_lines(name: &str, changes: &[(&str, &str)], more: &str) -> Cell {
    let mut text = builtin::cell_text(name).unwrap().to_string();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    parse_cell(&(text + more), "cell.toml").unwrap()
}

/// Subjects of the doubts about a cell.
fn doubted(cell: &Cell) -> Vec<String> {
    let findings = check(cell).unwrap().findings.into_iter();
    let doubts = findings.filter(|f| f.code == "suspicious-unit");
    doubts.map(|f| f.subject).collect()
}

/// A built-in cell, a part of its file, what it should not be, and the subjects that are doubted.
const DOUBTED: [(&str, &str, &str, &[&str]); 16] = [
    ("comau-shapes", "radius_mm = 70", "radius_mm = 0.085", &["tool.shape \"spindle\""]),
    (
        "comau-shapes",
        "center_mm = [130, 0, 250]\nsize_mm = [140, 40, 20]",
        "center_mm = [0.13, 0, 0.25]\nsize_mm = [0.14, 0.04, 0.02]",
        &["tool.shape \"bracket\""],
    ),
    (
        "comau-shapes",
        "center_mm = [1700, -1300, 350]\nsize_mm = [1200, 800, 700]",
        "center_mm = [1.7, -1.3, 0.35]\nsize_mm = [1.2, 0.8, 0.7]",
        &["obstacle \"table\"", "obstacle \"table\""],
    ),
    ("comau-shapes", "center_mm = [1700, -1300, 350]", "center_mm = [1.7, -1.3, 0.35]", &["obstacle \"table\""]),
    ("comau-shapes", "z_mm = 0", "z_mm = -0.65", &["obstacle \"floor\""]),
    ("comau-shapes", "radius_mm = 204", "radius_mm = 0.204", &["robot.shape \"link 2\""]),
    ("comau-shapes", "shapes_mm = 20", "shapes_mm = 0.02", &["clearance.shapes_mm"]),
    ("comau-shapes", "rope_mm = 20", "rope_mm = 0.02", &["clearance.rope_mm"]),
    ("comau-shapes", "wrist_height_mm = 300", "wrist_height_mm = 0.3", &["limits.wrist_height_mm"]),
    // In base axes, and in metres.
    ("comau", "loading_point_mm = [200, 0, 250]", "loading_point_mm = [1900, 180, 900]", &["tool.loading_point_mm"]),
    (
        "comau",
        "position_mm = [150, 0, 200]",
        "position_mm = [1900, 180, 900]",
        &["tool.measuring_point[1].position_mm"],
    ),
    ("comau", "[work]\n", "[work]\ntip_mm = [0.1, 0, 0.25]\n", &["work.tip_mm"]),
    ("comau", "[work]\n", "[work]\ntip_mm = [1900, 180, 900]\n", &["work.tip_mm"]),
    // In radians, and in degrees that are meant.
    ("comau", "[work]\n", "[work]\nworkpiece_rpy_deg = [0, 0, 1.5708]\n", &["work.workpiece_rpy_deg"]),
    ("comau", "[work]\n", "[work]\ntip_mm = [100, 0, 250]\ntip_rpy_deg = [3.14159, 0, 0]\n", &["work.tip_rpy_deg"]),
    ("comau", "[work]\n", "[work]\nworkpiece_rpy_deg = [0.12, -0.05, 1.3]\n", &[]),
];

#[test]
fn sizes_places_and_angles_in_another_unit_are_doubted() {
    for (name, from, to, subjects) in DOUBTED {
        assert_eq!(doubted(&with_lines(name, &[(from, to)], "")), subjects, "{to}");
    }
}

#[test]
fn what_is_added_in_another_unit_is_doubted() {
    let radians = "[-1.570796, 0.2, -0.2, 0, -1.0471976, 2.094395]";
    let start = |angles: &str| format!("[route]\nstart_deg = {angles}\n");
    let station = "[[tracker.station]]\nname = \"front\"\nposition_mm = [5, -0.6, 1.5]\n".to_string();
    let validation = format!("[[validation.posture]]\nq_deg = {radians}\nname = \"V\"\n");
    let task = format!("[[task]]\nq_deg = {radians}\nname = \"front\"\nforce_n = [0, 0, 200]\n");
    for (name, lines, subjects) in [
        ("comau", station, &["tracker.station \"front\""][..]),
        ("fanuc-r2000ic", start(radians), &["route.start_deg"]),
        ("fanuc-r2000ic", validation, &["validation.posture"]),
        ("fanuc-r2000ic", task, &["task[1].q_deg"]),
        // Near zero, and meant so: typed in whole degrees, or as the pendant shows a home posture.
        ("fanuc-r2000ic", start("[0, 0, 0, 0, 5, 0]"), &[]),
        ("fanuc-r2000ic", start("[0.002, 0.013, -0.004, 0, 0, 0]"), &[]),
        ("fanuc-r2000ic", start("[0, 0, -90, 0, 30, 0]"), &[]),
    ] {
        assert_eq!(doubted(&with_lines(name, &[], &format!("\n{lines}"))), subjects, "{lines}");
    }
}

#[test]
fn a_shape_that_is_none_is_serious() {
    let cell = with_lines("comau-shapes", &[("radius_mm = 70", "radius_mm = 0.07")], "");
    let checked = check(&cell).unwrap();
    assert!(checked.is_serious());
    let first = &checked.findings[0];
    assert_eq!(first.sentence, "The shortest side of spindle is 0.070 mm: is it in metres? The unit is mm.");
}

/// What ships, and what `init` writes for every robot, is not doubted.
#[test]
fn sound_cells_are_not_doubted() {
    for name in builtin::cell_names() {
        let cell = builtin::cell(name).unwrap();
        assert_eq!(doubted(&cell), [""; 0], "{name}");
    }
    for entry in catalogue() {
        let text = template(entry.key).unwrap();
        let cell = parse_cell(&text, "cell.toml").unwrap();
        assert_eq!(doubted(&cell), [""; 0], "{}", entry.key);
    }
}

#[test]
fn a_start_inside_something_is_told_once_by_all_commands() {
    // The table moved into the arm as it stands at the start.
    let cell = with_lines(
        "comau-shapes",
        &[(
            "center_mm = [1700, -1300, 350]\nsize_mm = [1200, 800, 700]",
            "center_mm = [1700, 0, 900]\nsize_mm = [1200, 800, 1800]",
        )],
        "\n[route]\nstart_deg = [0, 20, -120, 0, 50, 0]\n",
    );
    let checked = check(&cell).unwrap();
    let touches = |f: &&Finding| f.code == codes::START_TOUCHES;
    let touching: Vec<&Finding> = checked.findings.iter().filter(touches).collect();
    let [touching] = touching.as_slice() else { panic!("{:#?}", checked.findings) };
    assert_eq!(touching.severity, Severity::Serious);
    insta::assert_snapshot!(touching.sentence, @"At the start of the route link 4 and table overlap by 445 mm: no free move begins or ends there. Give a start that is clear of everything, or correct what stands in its way.");

    let plan = vec![vec![1.2, 0.2, -1.6, 0.0, 0.5, 0.0]];
    let group = PostureGroup::from_angles("plan", plan.clone());
    let groups = std::slice::from_ref(&group);
    let evaluated = Evaluated::new(&cell, groups).unwrap();
    assert_eq!(evaluated.findings.iter().filter(touches).count(), 1);

    let options = RouteOptions::default();
    let route = route(&cell, &plan, &options, Control::default()).unwrap();
    assert!(route.is_blocked());
    let findings = route_findings(&cell, &group.postures, &route).unwrap();
    assert_eq!(findings.iter().filter(touches).count(), 1);
    assert!(findings.iter().all(|f| f.code != codes::MOVE_BLOCKED), "{findings:#?}");

    // In the open nothing is said.
    let open = with_lines("comau-shapes", &[], "\n[route]\nstart_deg = [0, 20, -120, 0, 50, 0]\n");
    let findings = check(&open).unwrap().findings;
    assert!(findings.iter().all(|f| f.code != codes::START_TOUCHES), "{findings:#?}");
}

#[test]
fn moves_that_are_blocked_alike_are_one_sentence_with_their_names() {
    // A wall through the middle of the cell.
    let cell = with_lines(
        "comau-shapes",
        &[(
            "[clearance]",
            "[[obstacle]]\nname = \"wall\"\nkind = \"box\"\ncenter_mm = [1700, 0, 1500]\nsize_mm = [3000, 60, 6000]\n\n[clearance]",
        )],
        "",
    );
    let side = |turn: f64| vec![turn, -0.2, -1.9, 0.2, 0.9, 0.3];
    let plan = [side(-0.9), side(0.9), side(-0.85)];
    let options = with(|o: &mut RouteOptions| o.keep_order = true);
    let route = route(&cell, &plan, &options, Control::default()).unwrap();
    let stops = PostureGroup::from_angles("plan", plan.to_vec()).postures;
    let findings = route_findings(&cell, &stops, &route).unwrap();
    let [blocked] = findings.as_slice() else { panic!("{findings:#?}") };
    assert_eq!(blocked.code, codes::MOVE_BLOCKED);
    insta::assert_snapshot!(blocked.sentence, @"no free way was found for the moves 1 to 2 and 2 to 3: on the straight joint move link 3 and wall come too near each other. Drive them by hand over via postures of your own, or move what is in the way.");
}
