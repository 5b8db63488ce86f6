//! Table, object and files of `predict` and `compensate` agree, and commands bring the loaded tip back in every format.

use crate::support;

use insta::assert_snapshot;
use support::{Folder, in_lines, measurements, number, printed_sentence, stiffness, unbroken};

/// A folder with an identified stiffness.
fn folder() -> Folder {
    Folder::with("k.json", stiffness())
}

fn rows(text: &str) -> Vec<Vec<String>> {
    let fields = |line: &str| line.split(',').map(String::from).collect();
    text.lines().map(fields).collect()
}

#[test]
fn tasks_and_the_contour() {
    let folder = folder();
    assert_snapshot!("matrices", folder.ok("predict builtin:comau prior --matrix"));
    let line = "predict builtin:comau k.json --load-uncertainty-percent 5 --details";
    assert_snapshot!("tasks", folder.ok(line));
    let line = "predict builtin:comau k.json builtin:contour --free-turn=18";
    assert_snapshot!("contour", folder.ok(line));
    let line = "compensate builtin:comau k.json builtin:contour --output c.csv --figure c.svg";
    assert_snapshot!("compensated", folder.ok(line));
    assert!(folder.read("c.svg").starts_with("<svg"));
}

#[test]
fn the_object_and_the_table_agree() {
    let folder = folder();
    let line = "predict builtin:comau k.json builtin:contour --output p.csv --load-uncertainty-percent 5";
    let printed = folder.json(line);
    assert_eq!(printed["command"], "predict");
    assert_eq!(printed["options"]["model"], "equilibrium");
    let result = &printed["result"];
    let points = result["points"].as_array().unwrap();
    let rows = rows(&folder.read("p.csv"));
    assert_eq!((points.len(), rows.len()), (61, 62));
    let column = |name: &str| rows[0].iter().position(|h| h == name).unwrap();
    for (point, row) in points.iter().zip(&rows[1..]) {
        let mm: f64 = row[column("deflection_mm")].parse().unwrap();
        assert!((mm - 1e3 * number(&point["deflection_m"])).abs() < 1e-12);
        let half: f64 = row[column("total_half_width_mm")].parse().unwrap();
        assert!((half - 1e3 * number(&point["band"]["size_m"][3])).abs() < 1e-12);
        let load = number(&point["band"]["size_m"][2]);
        assert!((load / (1.959_964 * 0.05 * number(&point["deflection_m"])) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_compensated_dwell_at_the_workpiece_s_origin_can_be_read_again() {
    let folder = folder();
    // As small as the corrections are, it could be a path in metres.
    let heading = "x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg,fx_n,fy_n,fz_n";
    let rows = ["100,0,300", "0,200,300", "-50,-100,200", "20,30,100"];
    let rows = rows.map(|force| format!("0,0,0,180,0,0,{force}\n"));
    folder.write("dwell.csv", format!("{heading}\n{}", rows.concat()));
    folder.ok("compensate builtin:comau k.json dwell.csv --axes base --output c.csv");
    folder.ok("predict builtin:comau k.json c.csv --axes base");
}

#[test]
fn commands_bring_the_loaded_tip_back_in_every_format() {
    let folder = folder();
    // A force that does not turn with the commanded feed.
    let contour = "builtin:contour --axes base --force-n 80,-200,300";
    folder.ok(&format!("compensate builtin:comau k.json {contour} --output poses.csv"));
    folder.ok(&format!("compensate builtin:comau k.json {contour} --output angles.csv --write angles"));
    // The commanded poses are those of the commanded angles.
    let poses = rows(&folder.read("poses.csv"));
    assert_eq!(poses[0].join(","), "point,x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg");
    let angles = rows(&folder.read("angles.csv"));
    assert_eq!(angles[0].join(","), "point,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg");
    assert_eq!((poses.len(), angles.len()), (62, 62));
    // Tool axes in, tool axes out.
    let mut axes = "x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n".to_string();
    for i in 0..6 {
        axes += &format!("{},{},0,0,0,-1\n", 20 * i, 15 * i);
    }
    folder.write("axes.csv", axes);
    folder.ok("compensate builtin:comau k.json axes.csv --output out.csv");
    assert!(folder.read("out.csv").starts_with("x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n"));
}

#[test]
fn slips() {
    let folder = folder();
    folder.write("m.csv", measurements());
    let mut far = stiffarm_files::builtin::path_text("contour").unwrap().to_string();
    far = far.replace("5,120,0,0,", "5,2620,0,0,");
    folder.write("far.csv", far);
    folder.write("forces.csv", "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,fx_n,fy_n,fz_n\n0,20,-120,0,50,0,100,0,0\n");
    folder.write(
        "metres.csv",
        "x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg\n0.10,0.20,0,180,0,0\n0.12,0.20,0,180,0,0\n0.14,0.2,0,180,0,0\n",
    );
    folder.write("mixed.csv", "x_mm,y_mm,z_mm,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n0,0,0,0,20,-120,0,50,0\n");
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    let (bare, _) = cell.split_once("[[task]]").unwrap();
    folder.write("bare.toml", bare);
    let lines = [
        "predict builtin:comau k.json far.csv",
        "predict builtin:comau k.json forces.csv",
        "predict builtin:comau k.json metres.csv",
        "predict builtin:comau k.json mixed.csv",
        "predict bare.toml k.json",
        "predict builtin:comau k.json builtin:contour --force-n 1,2,3",
        "predict builtin:comau k.json builtin:contour --force-n 1,2",
        "predict builtin:comau k.json builtin:contour --cell-load",
        "predict builtin:comau k.json builtin:contour --near-deg 1,2,3",
        "predict builtin:comau k.json builtin:contour --max-step-deg 0.1",
        "predict builtin:comau k.json builtin:contour --load-uncertainty-percent -3",
        "predict builtin:fanuc-r2000ic prior builtin:contour",
        "compensate builtin:comau k.json far.csv --output out.csv",
        "compensate builtin:comau m.csv builtin:contour",
        "compensate builtin:comau k.json builtin:contour --output - --json",
    ];
    assert_snapshot!(folder.refusals(lines));
    assert!(!folder.names().contains(&"out.csv".to_string()));
}

#[test]
fn a_wrist_held_straight_is_named_with_its_row() {
    let folder = folder();
    folder.write("straight.csv", "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n0,20,-120,0,50,0\n0,20,-120,0,0.1,0\n");
    let line = "predict builtin:comau k.json straight.csv --axes base --force-n 0,0,300";
    assert_snapshot!(in_lines(printed_sentence(&folder.ok(line), "The posture at point 2")), @r"
    The posture at point 2 (line 3) is singular or nearly so: in one direction the tool hardly moves,
    whatever the joints do, and a controller may stop there.
    ");
}

#[test]
fn a_tip_that_nobody_gave_is_named() {
    let folder = Folder::new();
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    let from = cell.find("[work]").unwrap();
    folder.write("bare.toml", &cell[..from]);
    let path = "builtin:comau-group1 --axes base --force-n 80,-200,300";
    let said = "The tip is measuring point 1,";
    for line in [
        format!("predict bare.toml prior {path} --details"),
        format!("compensate bare.toml prior {path} --output c.csv --details"),
        "map bare.toml prior --steps 2 --force-n 80,-200,300 --details".to_string(),
    ] {
        let text = unbroken(&folder.run(&line).out);
        assert!(text.contains(said), "{line}: {text}");
    }
    let bare = folder.json(&format!("predict bare.toml prior {path}"));
    assert_eq!(bare["result"]["tip_point"], "1");
    folder.write("given.toml", format!("{}[work]\ntip_mm = [150, 0, 200]\n", &cell[..from]));
    let line = format!("predict given.toml prior {path}");
    assert!(folder.json(&line)["result"]["tip_point"].is_null());
    assert!(!folder.ok(&format!("{line} --details")).contains("The tip is"));
}

#[test]
fn a_free_turn_past_a_fixture_is_compensated_and_written() {
    let folder = Folder::new();
    // A circle beside the fixture, 900 mm to the side and 50 mm below the cell's own path.
    let mut path = "x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n".to_string();
    for i in 0..54 {
        let angle = std::f64::consts::TAU * f64::from(i) / 53.0;
        let (x, y) = (200.0 * angle.cos(), -550.0 + 200.0 * angle.sin());
        path += &format!("{x:.3},{y:.3},0,0,0,-1\n");
    }
    folder.write("path.csv", path);
    folder.ok("compensate builtin:comau-shapes prior path.csv --output commanded.csv");
    assert_eq!(folder.names(), ["commanded.csv", "path.csv"]);
    let printed = folder.ok("predict builtin:comau-shapes prior path.csv --details");
    let said = unbroken(&printed);
    let forbidden = said.split_inclusive(". ").find(|sentence| sentence.contains("is forbidden")).unwrap();
    assert_snapshot!(in_lines(forbidden.trim()), @r"
    note: The way that bends least, 1.286 mm RMS, is forbidden by the cell's bounds, limits or shapes at
    42 of 54 points: another was taken, which bends by 1.310 mm.
    ");
}
