//! `init` with a robot of one's own (URDF, xacro, rows) writes a cell that works, and says where the pendant may count
//! otherwise.

use crate::support;

use insta::assert_snapshot;
use std::ffi::OsString;
use stiffarm::Watch;
use stiffarm_cli::{Host, run_captured};
use support::{Folder, HEADING, block, codes, command, in_lines, replaced, sentence};

/// An arm whose elbow joint follows the shoulder, on a base of its own, with nearly
/// parallel axes 2 and 3 and a finger beside the chain.
const ARM: &str = include_str!("../../../../xtask/inputs/arm.urdf");

const ROWS: &str = include_str!("../../../../xtask/inputs/rows.csv");

fn folder() -> Folder {
    let folder = Folder::new();
    let slip = |from: &str, to: &str| replaced(ARM, from, to);
    folder.write("arm.urdf", ARM);
    folder.write("malformed.urdf", slip("</robot>", ""));
    folder.write("unclosed.urdf", slip("<link name=\"tool0\"/>", "<link name=\"tool0\">"));
    folder.write("inverted.urdf", slip("lower=\"-1.2\" upper=\"1.5\"", "lower=\"1.5\" upper=\"-1.2\""));
    folder.write("prismatic.urdf", slip("\"J4\" type=\"continuous\"", "\"J4\" type=\"prismatic\""));
    folder.write(
        "coupled.urdf",
        slip("<parent link=\"coupler\"/>", "<origin xyz=\"0.2 0 0\"/><parent link=\"coupler\"/>"),
    );
    folder.write(
        "two-tips.urdf",
        slip("<parent link=\"tool0\"/>", "<parent link=\"forearm\"/>").replace("tool0", "hand"),
    );
    folder.write("commands.urdf", slip("xyz=\"0 0 0.5\"", "xyz=\"0 0 ${height}\""));
    folder.write("arm.urdf.xacro", ARM);
    folder.write("rows.csv", ROWS);
    folder.write("no-column.csv", ROWS.replace(",d_mm", ",b_mm"));
    folder.write("no-d.csv", "joint,alpha_deg,a_mm,offset_deg\nA1,0,0,0\n");
    folder.write("sign.csv", ROWS.replace("185,-1", "185,0"));
    folder
}

#[test]
fn robots_that_begin_with_what_was_typed_are_all_named() {
    assert_snapshot!(Folder::new().each_refused(&[("init --robot kuka-kr210-r", "unknown-name", "")]), @r#"
    $ stiffarm init --robot kuka-kr210-r
    unknown-name

      × The catalogue has no robot "kuka-kr210-r".
      help: did you mean "kuka-kr210-r2700-2" or "kuka-kr210-r3100-2"?
    "#);
}

#[test]
fn an_arm_of_a_urdf_gets_a_cell_that_works() {
    let folder = folder();
    let line = "init --urdf arm.urdf --no-shapes --tip tool0 --output-dir cell";
    let printed = folder.transcript(line).replace('\\', "/");
    let cell = folder.read("cell/cell.toml");
    let (head, _) = cell.split_once("[tool]").unwrap();
    assert_snapshot!(format!("{printed}\n{head}"));
    folder.ok("check cell/cell.toml");
    let columns = folder.read("cell/measurements.csv");
    let columns = columns.lines().find(|line| line.starts_with("posture")).unwrap();
    assert_eq!(columns.split(',').filter(|column| column.starts_with('q')).count(), 4, "{columns}");
    assert!(!cell.contains("robot.shape"));
    // Standard input is a URDF, too.
    let ran = folder.run_with("init --urdf - --no-shapes --tip tool0 --output-dir stdin", ARM.as_bytes());
    assert_eq!(ran.code, Some(0), "{}", ran.err);
}

#[test]
fn its_links_get_capsules() {
    let folder = folder();
    std::fs::create_dir_all(folder.path("pkg/own_arm/meshes")).unwrap();
    let mesh = "pkg/own_arm/meshes/base.stl";
    folder.write(mesh, block([0.6, 0.5, 0.5]));
    let line = "init --urdf arm.urdf --tip tool0 --package-dir pkg --output-dir cell";
    let printed = folder.transcript(line).replace('\\', "/");
    let cell = folder.read("cell/cell.toml");
    let (_, shapes) = cell.split_once("down = ").unwrap();
    let (shapes, _) = shapes.split_once("[bounds]").unwrap();
    assert_snapshot!(format!("{printed}\n{shapes}"));
    folder.ok("check cell/cell.toml");
    let answer = folder.json(&line.replace("cell", "other"));
    assert_eq!(answer["result"]["chain"]["shapes"], 2);
    assert_eq!(answer["result"]["chain"]["capsules"], 2);
    assert_eq!(answer["result"]["chain"]["base_link"], "world");
    assert_eq!(answer["options"]["urdf"], "arm.urdf");
    let hash = |answer: &serde_json::Value| {
        let role = "mesh package://own_arm/meshes/base.stl";
        answer["inputs"][role].as_str().unwrap().to_string()
    };
    assert_eq!(folder.read("other/cell.toml"), cell);
    folder.write(mesh, block([0.6, 0.5, 0.4]));
    let changed = folder.json(&line.replace("cell", "changed"));
    assert_ne!(hash(&answer), hash(&changed));
    assert_ne!(folder.read("changed/cell.toml"), cell);
}

#[test]
fn meshes_that_cannot_be_meant_are_answered() {
    let folder = folder();
    std::fs::create_dir_all(folder.path("own_arm/meshes")).unwrap();
    let box_in_mm = ARM.replace("<cylinder radius=\"0.1\"", "<cylinder radius=\"100\"");
    folder.write("sizes.urdf", box_in_mm);
    let line = "init --urdf arm.urdf --tip tool0 --package-dir own_arm";
    let mut report = String::new();
    let mut refused = |line: &str| report += &folder.refusals([line]);
    folder.write("own_arm/meshes/base.stl", block([600.0, 500.0, 500.0]));
    refused(line);
    folder.write("own_arm/meshes/base.stl", "solid");
    refused(line);
    folder.write("own_arm/meshes/base.stl", block([0.6, 0.5, 0.5]));
    refused(&line.replace("arm.urdf", "sizes.urdf"));
    assert!(!folder.path("cell.toml").exists());
    assert_snapshot!(report.replace('\\', "/"));
}

#[test]
fn rows_of_ones_own_get_a_cell_that_works() {
    let folder = folder();
    let line = "init --dh rows.csv --output-dir cell";
    let printed = folder.transcript(line).replace('\\', "/");
    let cell = folder.read("cell/cell.toml");
    let (head, _) = cell.split_once("[tool]").unwrap();
    assert_snapshot!(format!("{printed}\n{head}"));
    folder.ok("check cell/cell.toml");
    // It is the arm of the catalogue with these rows.
    folder.ok("init --robot kuka-kr210-r2700-2 --output-dir catalogue");
    folder.write("p.csv", format!("{HEADING}p,10,-60,50,40,30,20\n"));
    let pose = |cell: &str| {
        let line = format!("pose {cell} p.csv --convention matrix");
        folder.json(&line)["result"]["postures"][0]["flange"].clone()
    };
    assert_eq!(pose("cell/cell.toml"), pose("catalogue/cell.toml"));
    // Rows of the other convention are told by two axes on one line.
    let wrong = "init --dh rows.csv --dh-convention standard --output-dir standard";
    assert_snapshot!(folder.each_refused(&[(wrong, "conflict", "rows.csv")]), @r"
    $ stiffarm init --dh rows.csv --dh-convention standard --output-dir standard
    conflict

      × rows.csv: Read as standard rows, axes 1 and 2 lie on one line, which no arm has; read as modified rows no two do.
      help: give the rows as dh_modified, or --dh-convention modified: there alpha and a of a row lie before the joint's turn
    ");
    folder.write(
        "data-sheet.csv",
        "joint,alpha_deg,a_mm,d_mm,offset_deg\n1,90,0,127.3,0\n2,0,-612,0,0\n3,0,-572.3,0,0\n\
         4,90,0,163.9,0\n5,-90,0,115.7,0\n6,0,0,92.2,0\n",
    );
    folder.ok("init --dh data-sheet.csv --dh-convention standard --output-dir standard");
    assert!(folder.read("standard/cell.toml").lines().any(|line| line == "dh_standard = ["));
}

/// The frames and joints of `r2000ic165f.xacro` of ros-industrial/fanuc_experimental, whose joint 3 is
/// J3 + J2; limits and speeds with digits as such files have them.
const FANUC: &str = r#"<robot name="fanuc_r2000ic165f">
  <link name="base"/><link name="l1"/><link name="l2"/><link name="l3"/><link name="l4"/><link name="l5"/><link name="l6"/>
  <joint name="joint_1" type="revolute"><origin xyz="0 0 0.67"/><parent link="base"/><child link="l1"/><axis xyz="0 0 1"/>
    <limit lower="-3.141593" upper="3.14159" effort="0" velocity="2.0944"/></joint>
  <joint name="joint_2" type="revolute"><origin xyz="0.312 0 0"/><parent link="l1"/><child link="l2"/><axis xyz="0 1 0"/>
    <limit lower="-1.0472" upper="1.32645" effort="0" velocity="2.0071"/></joint>
  <joint name="joint_3" type="revolute"><origin xyz="0 0 1.075"/><parent link="l2"/><child link="l3"/><axis xyz="0 -1 0"/>
    <limit lower="-2.3038" upper="3.1416" effort="0" velocity="2.1817"/></joint>
  <joint name="joint_4" type="revolute"><origin xyz="0 0 0.225"/><parent link="l3"/><child link="l4"/><axis xyz="-1 0 0"/>
    <limit lower="-6.2832" upper="6.2832" effort="0" velocity="3.1416"/></joint>
  <joint name="joint_5" type="revolute"><origin xyz="1.28 0 0"/><parent link="l4"/><child link="l5"/><axis xyz="0 -1 0"/>
    <limit lower="-2.1817" upper="2.1817" effort="0" velocity="3.1416"/></joint>
  <joint name="joint_6" type="revolute"><origin xyz="0.215 0 0"/><parent link="l5"/><child link="l6"/><axis xyz="-1 0 0"/>
    <limit lower="-6.2832" upper="6.2832" effort="0" velocity="4.5379"/></joint>
</robot>"#;

/// Nothing goes to a controller, and nothing comes from one, until the cell says whose angles it has.
#[test]
fn angles_of_a_urdf_are_nobodys_until_the_cell_says_so() {
    let folder = Folder::new();
    folder.write("fanuc.urdf", FANUC);
    let printed = folder.ok("init --urdf fanuc.urdf --output-dir cell").replace('\\', "/");
    let cell = folder.read("cell/cell.toml");
    let (robot_and_route, _) = cell.split_once("[bounds]").unwrap();
    assert_snapshot!(format!("{printed}\n{robot_and_route}"));
    folder.write("p.csv", format!("{HEADING}a,10,30,-20,15,-40,5\nb,-20,-10,10,5,30,5\n"));
    folder.write("changed.ls", "anything");
    let export = "export cell/cell.toml p.csv --language ls --output-dir program";
    let refused = folder.each_refused(&[
        (export, "missing-key", "robot.controller"),
        (
            "export cell/cell.toml p.csv --language ls --controller fanuc --output-dir program",
            "missing-key",
            "robot.controller",
        ),
        ("export cell/cell.toml p.csv --language ls --compare changed.ls", "missing-key", "robot.controller"),
        ("route cell/cell.toml p.csv --equivalents", "missing-key", "robot.controller"),
        ("pose cell/cell.toml p.csv --convention fanuc", "missing-key", "robot.controller"),
    ]);
    assert_snapshot!("angles_of_a_urdf_refused", refused.replace('\\', "/"));
    // What is nobody's goes on as before.
    folder.ok("pose cell/cell.toml p.csv");
    folder.run("export cell/cell.toml p.csv --language csv --output-dir table --despite-limits");
    assert!(folder.read("table/measure_p.csv").lines().any(|row| row.ends_with(",a,10,30,-20,15,-40,5,5,")));
    // The controller alone: the maker's pendants count otherwise.
    let with_controller = cell.replace("# controller =", "controller =");
    folder.write("cell/cell.toml", &with_controller);
    let export = format!("{export} --despite-limits --force");
    let findings = [&export, "pose cell/cell.toml p.csv"].map(|line| folder.json(line)["result"]["findings"].clone());
    assert_eq!(codes(&findings[0]), ["robot-doubt"]);
    assert_eq!(codes(&findings[1]), ["robot-doubt", "pendant-height"]);
    assert_eq!(findings[0][0], findings[1][0]);
    assert_snapshot!(in_lines(sentence(&findings[0], "robot-doubt")), @r"
    Pendants of FANUC count joint 3 by the forearm's angle to the floor, which stays while joint 2 moves
    alone; theta_from_q of this cell counts it otherwise. Look at the pendant (docs/robots.md) before
    the arm is driven.
    ");
    assert!(folder.run(&export).out.starts_with("cell: cell/cell.toml"));
    // With the lines that the comment offers it is the catalogue's arm, whose angles are the pendant's.
    let (head, tail) = with_controller.split_once("# theta_from_q = [").unwrap();
    let (rows, tail) = tail.split_once("# ]").unwrap();
    let rows = rows.replace("\n# ", "\n");
    folder.write("cell/cell.toml", format!("{head}theta_from_q = [{rows}]{tail}"));
    folder.ok("init --robot fanuc-r2000ic165f --output-dir catalogue");
    let position = |cell: &str| -> Vec<f64> {
        let poses = folder.json(&format!("pose {cell}/cell.toml p.csv --frame cell"));
        assert_eq!(poses["options"]["convention"], "fanuc");
        let at = poses["result"]["postures"][0]["flange"]["position_mm"].clone();
        serde_json::from_value(at).unwrap()
    };
    let (here, there) = (position("cell"), position("catalogue"));
    assert!(here.iter().zip(&there).all(|(a, b)| (a - b).abs() < 1e-6), "{here:?} {there:?}");
    folder.run(&export);
    assert!(folder.read("program/measure_p.ls").contains("J3=    -20.00 deg"));
    assert_ne!(folder.run("route cell/cell.toml p.csv --equivalents").code, Some(2));
    let line = "export cell/cell.toml p.csv --language krl --output-dir other";
    assert_snapshot!(folder.each_refused(&[(line, "conflict", "--controller")]), @r"
    $ stiffarm export cell/cell.toml p.csv --language krl --output-dir other
    conflict

      × --controller: KUKA KRL is for controllers of KUKA; the angles of this cell are those of FANUC.
      help: use --language ls; or --controller kuka if such a pendant shows these very angles
    ");
}

#[test]
fn wrong_descriptions_are_answered_with_place_and_hint() {
    let folder = folder();
    let before = folder.names();
    let report = folder.refusals([
        "init --urdf arm.urdf --tip hand",
        "init --urdf arm.urdf --base tool --tip tool0",
        "init --urdf arm.urdf --base tool0 --tip base",
        "init --urdf arm.urdf --tip tool0",
        "init --urdf arm.urdf --tip tool0 --package-dir nowhere",
        "init --urdf prismatic.urdf --tip tool0 --no-shapes",
        "init --urdf coupled.urdf --tip tool0 --no-shapes",
        "init --urdf inverted.urdf --tip tool0 --no-shapes",
        "init --urdf two-tips.urdf --no-shapes",
        "init --urdf malformed.urdf",
        "init --urdf unclosed.urdf",
        "init --urdf commands.urdf",
        "init --urdf rows.csv",
        "init --urdf nothing.urdf",
        "init --urdf arm.urdf --robot ur5e",
        "init --urdf arm.urdf --dh rows.csv",
        "init --tip tool0",
        "init --dh no-column.csv",
        "init --dh no-d.csv",
        "init --dh sign.csv",
        "init --dh arm.urdf",
    ]);
    assert_eq!(folder.names(), before);
    assert_snapshot!(report.replace('\\', "/"));
}

/// The gripper's drive is no axis: said, and written where the cell is read.
#[test]
fn a_gripper_behind_the_arm_is_said_in_the_cell() {
    let folder = folder();
    let drive = ARM.replace("\"grip\" type=\"prismatic\"", "\"jointGripper\" type=\"revolute\"");
    folder.write("drive.urdf", drive);
    // Without a tip, tool0 is taken.
    let [with, without] = ["--tip finger --output-dir cell", "--output-dir other"]
        .map(|options| folder.ok(&format!("init --urdf drive.urdf --no-shapes {options}")).replace('\\', "/"));
    assert_snapshot!(format!("{with}\n{without}"));
    let cells = ["cell", "other"].map(|name| folder.read(&format!("{name}/cell.toml")));
    assert_eq!(cells.map(|cell| cell.matches("CHECK FIRST, jointGripper").count()), [1, 0]);
    let findings = folder.json("check cell/cell.toml")["result"]["findings"].clone();
    assert_eq!(codes(&findings), ["no-prior", "urdf-gripper"]);
    assert_snapshot!(in_lines(sentence(&findings, "urdf-gripper")), @r"
    By its name jointGripper is a joint of a gripper, and no axis of the arm: write the cell again, up
    to the flange (`stiffarm init --urdf … --tip LINK`), or take the joint out of [robot].
    ");
    let findings = folder.json("check other/cell.toml")["result"]["findings"].clone();
    assert_eq!(codes(&findings), ["no-prior"]);
}

/// Whoever watches is told how far the meshes are, and may stop; a pipe is told nothing.
#[test]
fn meshes_show_how_far_they_are_and_stop() {
    use std::sync::{Arc, Mutex};
    let folder = folder();
    let meshes: String =
        (0..4).map(|i| format!("<collision><geometry><mesh filename=\"m{i}.stl\"/></geometry></collision>")).collect();
    folder
        .write("many.urdf", ARM.replace("<link name=\"column\"/>", &format!("<link name=\"column\">{meshes}</link>")));
    std::fs::create_dir_all(folder.path("pkg/own_arm/meshes")).unwrap();
    folder.write("pkg/own_arm/meshes/base.stl", block([0.6, 0.5, 0.5]));
    for i in 0..4 {
        folder.write(&format!("pkg/m{i}.stl"), block([0.6, 0.5, 0.5]));
    }
    let line = "init --urdf many.urdf --tip tool0 --package-dir pkg --output-dir";
    let ran = folder.run(&format!("{line} cell"));
    assert_eq!((ran.code, ran.err.as_str()), (Some(0), ""));
    let at = |name: &str| folder.path(name).display().to_string();
    let words = [
        "stiffarm",
        "init",
        "--urdf",
        &at("many.urdf"),
        "--tip",
        "tool0",
        "--package-dir",
        &at("pkg"),
        "--output-dir",
        &at("written"),
    ];
    let words: Vec<OsString> = words.iter().map(OsString::from).collect();
    let steps = Arc::<Mutex<Vec<(String, usize, usize)>>>::default();
    for most in [usize::MAX, 2] {
        steps.lock().unwrap().clear();
        let (before, all) = (Arc::clone(&steps), Arc::clone(&steps));
        let watch = Watch::new(
            move || before.lock().unwrap().len() > most,
            move |what, done, of| all.lock().unwrap().push((what.to_string(), done, of)),
        );
        let host = Host { watch: Some(watch), ..Host::default() };
        let ran = run_captured(&words, host);
        let steps = steps.lock().unwrap();
        let counted: Vec<usize> = steps.iter().map(|(_, done, _)| *done).collect();
        if most == 2 {
            assert_eq!(ran.code, 130, "{}", ran.err);
            assert_eq!(counted, [0, 1, 2]);
            continue;
        }
        assert_eq!(ran.code, 0, "{}", ran.err);
        assert_eq!(counted, [0, 1, 2, 3, 4]);
        assert!(steps.iter().all(|(what, _, of)| what == "meshes into capsules" && *of == 5));
        std::fs::remove_dir_all(folder.path("written")).unwrap();
    }
    assert!(!folder.path("written").exists());
    // `capsules`, too.
    steps.lock().unwrap().clear();
    let all = Arc::clone(&steps);
    let watch = Watch::new(|| false, move |what, done, of| all.lock().unwrap().push((what.to_string(), done, of)));
    let words: Vec<OsString> =
        ["stiffarm", "capsules", &at("pkg/m0.stl"), &at("pkg/m1.stl")].iter().map(OsString::from).collect();
    let ran = run_captured(&words, Host { watch: Some(watch), ..Host::default() });
    assert_eq!((ran.code, steps.lock().unwrap().len()), (0, 2), "{}", ran.err);
}

/// The command where only the programs of `bin` are found.
fn with_programs(folder: &Folder, line: &str) -> (Option<i32>, String) {
    let mut run = command(&folder.path("."));
    run.env("PATH", folder.path("bin"));
    let output = run.args(line.split_whitespace()).output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn without_xacro_it_says_how_to_get_it() {
    let folder = folder();
    let (code, said) = with_programs(&folder, "init --urdf arm.urdf.xacro --output-dir cell");
    assert_eq!(code, Some(2), "{said}");
    assert_snapshot!(said, @r"
    unsupported

      × arm.urdf.xacro: This is a xacro file, and the program xacro was not found.
      help: install it with `pip install xacro`, or expand the file yourself: xacro FILE > robot.urdf
    ");
}

#[cfg(unix)]
#[test]
fn xacro_is_run_where_it_is_found_and_its_errors_are_passed_on() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    std::fs::create_dir_all(folder.path("bin")).unwrap();
    let program = |script: &str| {
        folder.write("bin/xacro", format!("#!/bin/sh\n{script}\n"));
        let mode = std::fs::Permissions::from_mode(0o755);
        std::fs::set_permissions(folder.path("bin/xacro"), mode).unwrap();
    };
    let line = "init --urdf arm.urdf.xacro --tip tool0 --no-shapes --output-dir cell";
    program("while read -r line; do echo \"$line\"; done < \"$1\"");
    let ends = |line: &str, code: i32| {
        let (exit, said) = with_programs(&folder, line);
        assert_eq!(exit, Some(code), "{line}: {said}");
        said
    };
    ends(line, 0);
    assert!(folder.read("cell/cell.toml").contains("from arm.urdf.xacro:"));
    program("echo 'No such file or directory: materials.xacro' >&2; exit 2");
    let mut said = vec![ends(&line.replace("cell", "other"), 2)];
    // $(find NAME) needs ROS, or to be told where the package is.
    program(
        "case \"$PYTHONPATH\" in\n*stiffarm*) read -r known < \"${PYTHONPATH%%:*}/ament_index_python/packages.py\"\n\
         case \"$known\" in *'\"own_arm\":\"'*'/packages/arm-main\"'*)\n\
         while read -r line; do echo \"$line\"; done < \"$1\"; exit 0;; esac\n\
         echo \"LookupError: no such package\" >&2; exit 2;; esac\n\
         echo \"substitution args not supported:  No module named 'ament_index_python'\" >&2; exit 2",
    );
    let line = line.replace("cell", "in-a-package");
    said.push(ends(&line, 2));
    std::fs::create_dir_all(folder.path("packages/arm-main")).unwrap();
    let line = format!("{line} --package-dir packages");
    said.push(ends(&line, 2));
    assert_snapshot!(said.join("\n"));
    folder.write("packages/arm-main/package.xml", "<package><name>own_arm</name></package>");
    ends(&line, 0);
}
