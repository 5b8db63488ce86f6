//! `init` with a robot of one's own: URDF, xacro and rows.

use crate::support;

use insta::assert_snapshot;
use std::ffi::OsString;
use stiffarm::Watch;
use stiffarm_cli::{Host, run_captured};
use support::{Folder, block, command};

/// An arm whose elbow joint follows the shoulder, on a base of its own, with nearly
/// parallel axes 2 and 3 and a finger beside the chain.
const ARM: &str = include_str!("../../../../xtask/inputs/arm.urdf");

const ROWS: &str = include_str!("../../../../xtask/inputs/rows.csv");

fn folder() -> Folder {
    let folder = Folder::new();
    let slip = |from: &str, to: &str| {
        assert!(ARM.contains(from), "{from}");
        ARM.replace(from, to)
    };
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
    let refused = Folder::new().refused("init --robot kuka-kr210-r");
    for name in ["kuka-kr210-r2700-2", "kuka-kr210-r3100-2"] {
        assert!(refused.contains(name), "{refused}");
    }
    assert!(!refused.contains("kr240"), "{refused}");
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
    assert!(folder.read("cell/measurements.csv").contains("q4_deg"));
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
    let found = folder.json(&line.replace("cell", "other"));
    assert_eq!(found["result"]["chain"]["shapes"], 2);
    assert_eq!(found["result"]["chain"]["capsules"], 2);
    assert_eq!(found["result"]["chain"]["base_link"], "world");
    assert_eq!(found["options"]["urdf"], "arm.urdf");
    let hash = |found: &serde_json::Value| {
        let role = "mesh package://own_arm/meshes/base.stl";
        found["inputs"][role].as_str().unwrap().to_string()
    };
    assert_eq!(folder.read("other/cell.toml"), cell);
    folder.write(mesh, block([0.6, 0.5, 0.4]));
    let changed = folder.json(&line.replace("cell", "changed"));
    assert_ne!(hash(&found), hash(&changed));
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
    assert!(!folder.names().contains(&"cell.toml".to_string()));
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
    folder.write("p.csv", "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\np,10,-60,50,40,30,20\n");
    let pose = |cell: &str| {
        let line = format!("pose {cell} p.csv --convention matrix");
        folder.json(&line)["result"]["postures"][0]["flange"].clone()
    };
    assert_eq!(pose("cell/cell.toml"), pose("catalogue/cell.toml"));
    // Rows of the other convention are told by two axes on one line.
    let wrong = "init --dh rows.csv --dh-convention standard --output-dir standard";
    assert!(folder.refused(wrong).contains("--dh-convention modified"));
    folder.write(
        "data-sheet.csv",
        "joint,alpha_deg,a_mm,d_mm,offset_deg\n1,90,0,127.3,0\n2,0,-612,0,0\n3,0,-572.3,0,0\n\
         4,90,0,163.9,0\n5,-90,0,115.7,0\n6,0,0,92.2,0\n",
    );
    folder.ok("init --dh data-sheet.csv --dh-convention standard --output-dir standard");
    assert!(folder.read("standard/cell.toml").contains("dh_standard = ["));
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
    let said = folder.ok("init --urdf fanuc.urdf --output-dir cell");
    assert!(said.contains("joint_3") && said.contains("couple joint 3"), "{said}");
    let cell = folder.read("cell/cell.toml");
    assert!(cell.contains("\n# controller = \"fanuc\"\n"), "{cell}");
    assert!(cell.contains("CHECK FIRST: pendants of"), "{cell}");
    for (what, line) in [
        ("limits", "    [-180, 180],\n    [-60, 76],\n    [-132, 180],\n    [-360, 360],"),
        ("speeds", "\n[route]\n"),
        ("speeds", "\njoint_speeds_deg_s = [120, 115, 125, 180, 180, 260]\n"),
    ] {
        assert!(cell.contains(line), "{what}: {cell}");
    }
    folder.write(
        "p.csv",
        "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\na,10,30,-20,15,-40,5\nb,-20,-10,10,5,30,5\n",
    );
    folder.write("changed.ls", "anything");
    let lines = [
        "export cell/cell.toml p.csv --language ls --output-dir program",
        "export cell/cell.toml p.csv --language ls --controller fanuc --output-dir program",
        "export cell/cell.toml p.csv --language ls --compare changed.ls",
        "route cell/cell.toml p.csv --equivalents",
        "pose cell/cell.toml p.csv --convention fanuc",
    ];
    for line in lines {
        let said = folder.refused(line);
        assert!(said.contains("robot.controller") && said.contains("controller = "), "{line}\n{said}");
    }
    // What is nobody's goes on as before.
    folder.ok("pose cell/cell.toml p.csv");
    folder.run("export cell/cell.toml p.csv --language csv --output-dir table --despite-limits");
    assert!(folder.read("table/measure_p.csv").contains("a,10,30,-20,15,-40,5"));
    // The controller alone: the maker's pendants count otherwise.
    let told = cell.replace("# controller =", "controller =");
    folder.write("cell/cell.toml", &told);
    for line in [&format!("{} --despite-limits --force", lines[0]), "pose cell/cell.toml p.csv"] {
        let ran = folder.run(line);
        assert!(ran.out.contains("Pendants of FANUC count joint 3"), "{line}\n{}{}", ran.out, ran.err);
    }
    // With the lines that the comment offers it is the catalogue's arm, whose angles are the pendant's.
    let (head, tail) = told.split_once("# theta_from_q = [").unwrap();
    let (rows, tail) = tail.split_once("# ]").unwrap();
    let rows = rows.replace("\n# ", "\n");
    folder.write("cell/cell.toml", format!("{head}theta_from_q = [{rows}]{tail}"));
    folder.ok("init --robot fanuc-r2000ic165f --output-dir catalogue");
    let position = |cell: &str| -> Vec<f64> {
        let found = folder.json(&format!("pose {cell}/cell.toml p.csv --frame cell"));
        assert_eq!(found["options"]["convention"], "fanuc");
        let at = found["result"]["postures"][0]["flange"]["position_mm"].clone();
        serde_json::from_value(at).unwrap()
    };
    let (own, known) = (position("cell"), position("catalogue"));
    assert!(own.iter().zip(&known).all(|(a, b)| (a - b).abs() < 1e-6), "{own:?} {known:?}");
    folder.run(&format!("{} --despite-limits --force", lines[0]));
    assert!(folder.read("program/measure_p.ls").contains("J3=    -20.00 deg"));
    assert_ne!(folder.run("route cell/cell.toml p.csv --equivalents").code, Some(2));
    let said = folder.refused("export cell/cell.toml p.csv --language krl --output-dir other");
    assert!(said.contains("--controller kuka") && said.contains("--language ls"), "{said}");
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
    let said = folder.ok("init --urdf drive.urdf --no-shapes --tip finger --output-dir cell");
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("chain: 5 joints, J1 to jointGripper,"), "{said}");
    assert!(said.contains("caution: jointGripper: The joint looks like one of a gripper"), "{said}");
    assert!(said.contains("--tip tool0"), "{said}");
    assert!(folder.read("cell/cell.toml").contains("CHECK FIRST, jointGripper"));
    let said = folder.ok("check cell/cell.toml");
    assert!(said.contains("caution: By its name jointGripper"), "{said}");
    // Without a tip, tool0 is taken.
    let said = folder.ok("init --urdf drive.urdf --no-shapes --output-dir other");
    assert!(!said.contains("gripper") && !folder.read("other/cell.toml").contains("CHECK FIRST"));
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
        &at("told"),
    ];
    let words: Vec<OsString> = words.iter().map(OsString::from).collect();
    let told = Arc::<Mutex<Vec<(String, usize, usize)>>>::default();
    for most in [usize::MAX, 2] {
        told.lock().unwrap().clear();
        let (asked, all) = (Arc::clone(&told), Arc::clone(&told));
        let watch = Watch::new(
            move || asked.lock().unwrap().len() > most,
            move |what, done, of| all.lock().unwrap().push((what.to_string(), done, of)),
        );
        let host = Host { watch: Some(watch), ..Host::default() };
        let ran = run_captured(&words, host);
        let told = told.lock().unwrap();
        let counted: Vec<usize> = told.iter().map(|(_, done, _)| *done).collect();
        if most == 2 {
            assert_eq!(ran.code, 130, "{}", ran.err);
            assert_eq!(counted, [0, 1, 2]);
            continue;
        }
        assert_eq!(ran.code, 0, "{}", ran.err);
        assert_eq!(counted, [0, 1, 2, 3, 4]);
        assert!(told.iter().all(|(what, _, of)| what == "meshes into capsules" && *of == 5));
        std::fs::remove_dir_all(folder.path("told")).unwrap();
    }
    assert!(!folder.path("told").exists());
    // `capsules`, too.
    told.lock().unwrap().clear();
    let all = Arc::clone(&told);
    let watch = Watch::new(|| false, move |what, done, of| all.lock().unwrap().push((what.to_string(), done, of)));
    let words: Vec<OsString> =
        ["stiffarm", "capsules", &at("pkg/m0.stl"), &at("pkg/m1.stl")].iter().map(OsString::from).collect();
    let ran = run_captured(&words, Host { watch: Some(watch), ..Host::default() });
    assert_eq!((ran.code, told.lock().unwrap().len()), (0, 2), "{}", ran.err);
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
    assert!(said.contains("pip install xacro"), "{said}");
    assert!(said.contains("xacro FILE > robot.urdf"), "{said}");
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
    let (code, said) = with_programs(&folder, line);
    assert_eq!(code, Some(0), "{said}");
    assert!(folder.read("cell/cell.toml").contains("from arm.urdf.xacro:"));
    program("echo 'No such file or directory: materials.xacro' >&2; exit 2");
    let (code, said) = with_programs(&folder, &line.replace("cell", "other"));
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("materials.xacro"), "{said}");
    assert!(!said.contains("--package-dir"), "{said}");
    // $(find NAME) needs ROS, or to be told where the package is.
    program(
        "case \"$PYTHONPATH\" in\n*stiffarm*) read -r known < \"${PYTHONPATH%%:*}/ament_index_python/packages.py\"\n\
         case \"$known\" in *'\"own_arm\":\"'*'/packages/arm-main\"'*)\n\
         while read -r line; do echo \"$line\"; done < \"$1\"; exit 0;; esac\n\
         echo \"LookupError: no package in $known\" >&2; exit 2;; esac\n\
         echo \"substitution args not supported:  No module named 'ament_index_python'\" >&2; exit 2",
    );
    let line = line.replace("cell", "found");
    let (code, said) = with_programs(&folder, &line);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("without ROS say where it is with --package-dir"), "{said}");
    std::fs::create_dir_all(folder.path("packages/arm-main")).unwrap();
    let (code, said) = with_programs(&folder, &format!("{line} --package-dir packages"));
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("in no --package-dir"), "{said}");
    folder.write("packages/arm-main/package.xml", "<package><name>own_arm</name></package>");
    let (code, said) = with_programs(&folder, &format!("{line} --package-dir packages"));
    assert_eq!(code, Some(0), "{said}");
}
