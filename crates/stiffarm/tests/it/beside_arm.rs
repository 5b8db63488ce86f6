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
    let found = check(cell).unwrap().findings.into_iter();
    let doubts = found.filter(|f| f.code == "suspicious-unit");
    doubts.map(|f| f.subject).collect()
}

#[test]
fn shapes_in_metres_are_doubted() {
    let shapes = "comau-shapes";
    for (from, to, subject) in [
        ("radius_mm = 70", "radius_mm = 0.085", "tool.shape \"spindle\""),
        (
            "center_mm = [130, 0, 250]\nsize_mm = [140, 40, 20]",
            "center_mm = [0.13, 0, 0.25]\nsize_mm = [0.14, 0.04, 0.02]",
            "tool.shape \"bracket\"",
        ),
        (
            "center_mm = [1700, -1300, 350]\nsize_mm = [1200, 800, 700]",
            "center_mm = [1.7, -1.3, 0.35]\nsize_mm = [1.2, 0.8, 0.7]",
            "obstacle \"table\"",
        ),
        ("center_mm = [1700, -1300, 350]", "center_mm = [1.7, -1.3, 0.35]", "obstacle \"table\""),
        ("z_mm = 0", "z_mm = -0.65", "obstacle \"floor\""),
        ("radius_mm = 204", "radius_mm = 0.204", "robot.shape \"link 2\""),
        ("shapes_mm = 20", "shapes_mm = 0.02", "clearance.shapes_mm"),
        ("rope_mm = 20", "rope_mm = 0.02", "clearance.rope_mm"),
        ("wrist_height_mm = 300", "wrist_height_mm = 0.3", "limits.wrist_height_mm"),
    ] {
        let subjects = doubted(&with_lines(shapes, &[(from, to)], ""));
        assert!(subjects.contains(&subject.to_string()), "{to}: {subjects:?}");
    }
}

#[test]
fn a_station_in_metres_is_doubted() {
    let station = "\n[[tracker.station]]\nname = \"front\"\nposition_mm = [5, -0.6, 1.5]\n";
    let subjects = doubted(&with_lines("comau", &[], station));
    assert_eq!(subjects, ["tracker.station \"front\""]);
}

#[test]
fn a_shape_that_is_none_is_serious() {
    let cell = with_lines("comau-shapes", &[("radius_mm = 70", "radius_mm = 0.07")], "");
    let checked = check(&cell).unwrap();
    assert!(checked.is_serious());
    let first = &checked.findings[0];
    assert_eq!(first.sentence, "The shortest side of spindle is 0.070 mm: is it in metres? The unit is mm.");
}

#[test]
fn points_in_base_axes_and_in_metres_are_doubted() {
    for (from, to, subject) in [
        ("loading_point_mm = [200, 0, 250]", "loading_point_mm = [1900, 180, 900]", "tool.loading_point_mm"),
        ("position_mm = [150, 0, 200]", "position_mm = [1900, 180, 900]", "tool.measuring_point[1].position_mm"),
        ("[work]\n", "[work]\ntip_mm = [0.1, 0, 0.25]\n", "work.tip_mm"),
        ("[work]\n", "[work]\ntip_mm = [1900, 180, 900]\n", "work.tip_mm"),
    ] {
        let subjects = doubted(&with_lines("comau", &[(from, to)], ""));
        assert!(subjects.contains(&subject.to_string()), "{to}: {subjects:?}");
    }
}

#[test]
fn angles_in_radians_are_doubted() {
    let work = "[work]\n";
    for (from, to, subject) in [
        (work, "[work]\nworkpiece_rpy_deg = [0, 0, 1.5708]\n", "work.workpiece_rpy_deg"),
        (work, "[work]\ntip_mm = [100, 0, 250]\ntip_rpy_deg = [3.14159, 0, 0]\n", "work.tip_rpy_deg"),
    ] {
        let subjects = doubted(&with_lines("comau", &[(from, to)], ""));
        assert!(subjects.contains(&subject.to_string()), "{to}: {subjects:?}");
    }
    let given = |table: &str, key: &str, angles: &str, more: &str| {
        let lines = format!("\n{table}\n{key} = {angles}\n{more}");
        with_lines("fanuc-r2000ic", &[], &lines)
    };
    let start = |angles: &str| given("[route]", "start_deg", angles, "");
    let angles = "[-1.570796, 0.2, -0.2, 0, -1.0471976, 2.094395]";
    assert_eq!(doubted(&start(angles)), ["route.start_deg"]);
    let validation = given("[[validation.posture]]", "q_deg", angles, "name = \"V\"\n");
    assert_eq!(doubted(&validation), ["validation.posture"]);
    let more = "name = \"front\"\nforce_n = [0, 0, 200]\n";
    assert_eq!(doubted(&given("[[task]]", "q_deg", angles, more)), ["task[1].q_deg"]);
    // Near zero, and meant so: typed in whole degrees, or as the pendant shows a home posture.
    for angles in ["[0, 0, 0, 0, 5, 0]", "[0.002, 0.013, -0.004, 0, 0, 0]", "[0, 0, -90, 0, 30, 0]"] {
        assert_eq!(doubted(&start(angles)), [""; 0], "{angles}");
    }
    let turned = "[work]\nworkpiece_rpy_deg = [0.12, -0.05, 1.3]\n";
    assert_eq!(doubted(&with_lines("comau", &[(work, turned)], "")), [""; 0]);
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
    let own = |f: &&Finding| f.code == codes::START_TOUCHES;
    let told: Vec<&Finding> = checked.findings.iter().filter(own).collect();
    let [told] = told.as_slice() else { panic!("{:#?}", checked.findings) };
    assert_eq!(told.severity, Severity::Serious);
    assert!(told.sentence.contains("and table overlap by"), "{}", told.sentence);
    assert!(told.sentence.contains(" mm: no free move"), "{}", told.sentence);

    let plan = vec![vec![1.2, 0.2, -1.6, 0.0, 0.5, 0.0]];
    let group = PostureGroup::from_angles("plan", plan.clone());
    let groups = std::slice::from_ref(&group);
    let evaluated = Evaluated::new(&cell, groups).unwrap();
    assert_eq!(evaluated.findings.iter().filter(own).count(), 1);

    let options = RouteOptions::default();
    let found = route(&cell, &plan, &options, Control::default()).unwrap();
    assert!(found.is_blocked());
    let findings = route_findings(&cell, &group.postures, &found).unwrap();
    assert_eq!(findings.iter().filter(own).count(), 1);
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
    let found = route(&cell, &plan, &options, Control::default()).unwrap();
    let stops = PostureGroup::from_angles("plan", plan.to_vec()).postures;
    let findings = route_findings(&cell, &stops, &found).unwrap();
    let [blocked] = findings.as_slice() else { panic!("{findings:#?}") };
    assert_eq!(blocked.code, codes::MOVE_BLOCKED);
    let named = "for the moves 1 to 2 and 2 to 3: on the straight joint move";
    assert!(blocked.sentence.contains(named), "{}", blocked.sentence);
}
