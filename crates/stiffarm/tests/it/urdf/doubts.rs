//! Angles in degrees, and chains that go on into a gripper.

use super::*;
use stiffarm::{Code, Error};

/// A joint about z from `parent` to `child`, with limits and what else stands in it.
fn turning(name: &str, [parent, child]: [&str; 2], [low, high]: [&str; 2], more: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"revolute\"><origin xyz=\"0.1 0 0.3\" rpy=\"1 0 0\"/><parent link=\"{parent}\"/>\
         <child link=\"{child}\"/><axis xyz=\"0 0 1\"/><limit lower=\"{low}\" upper=\"{high}\" effort=\"100\" \
         velocity=\"1\"/>{more}</joint>\n"
    )
}

fn fixed(parent: &str, child: &str) -> String {
    format!(
        "<joint name=\"{child}_fixed\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/></joint>\n"
    )
}

/// A robot of these joints, with the links that they name.
fn robot(joints: &str) -> String {
    let mut links: Vec<&str> = joints.split("link=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    links.sort_unstable();
    links.dedup();
    let links: String = links.iter().map(|link| format!("<link name=\"{link}\"/>\n")).collect();
    format!("<robot name=\"test\">\n{links}{joints}</robot>\n")
}

const TURN: [&str; 2] = ["-3", "3"];

/// An arm of three joints, base to l3.
fn arm() -> String {
    turning("j1", ["base", "l1"], TURN, "")
        + &turning("j2", ["l1", "l2"], TURN, "")
        + &turning("j3", ["l2", "l3"], TURN, "")
}

fn read(text: &str, tip: Option<&str>) -> Result<UrdfRobot, Error> {
    let options = UrdfOptions { base: None, tip: tip.map(str::to_string) };
    read_urdf(text, "robot.urdf", &options)
}

fn cautions(read: &UrdfRobot, code: &str) -> Vec<(String, String)> {
    let found = read.findings.iter().filter(|finding| finding.code == code);
    found.map(|finding| (finding.subject.clone(), finding.sentence.clone())).collect()
}

#[test]
fn limits_in_degrees_are_refused_or_doubted() {
    for (limits, in_rad) in [
        (["-180", "180"], "-180° is -3.1416"),
        (["-170", "170"], "-170° is -2.9671"),
        (["-3", "360"], "360° is 6.2832"),
        (["-117.5", "117.5"], "-117.5° is -2.0508"),
        (["-15", "0"], "-15° is -0.2618"),
    ] {
        let text = robot(&(arm() + &turning("j4", ["l3", "l4"], limits, "")));
        let error = read(&text, None).unwrap_err();
        assert_eq!((error.code(), error.place().line), (Code::InvalidValue, Some(10)), "{error}");
        assert!(error.message().contains("\"j4\" has a limit"), "{error}");
        assert!(error.message().contains("are these degrees?"), "{error}");
        assert!(error.hint_text().unwrap().contains(in_rad), "{error:?}");
    }
    // Of a joint that another one drives, too.
    let follows = "<mimic joint=\"j5\"/>";
    let text = robot(
        &(arm() + &turning("j4", ["l3", "l4"], ["-90", "90"], follows) + &turning("j5", ["base", "l5"], TURN, "")),
    );
    let error = read(&text, Some("l4")).unwrap_err();
    assert!(error.message().contains("are these degrees?"), "{error}");
    // Real ones: UR, COMAU, wrists of once and a quarter, a joint of three half turns.
    for limits in [
        ["-6.28", "6.28"],
        ["-6.2831853", "6.2831853"],
        ["-7.941248096574199", "7.941248096574199"],
        ["-9.42477796077", "9.42477796077"],
        ["-6", "6"],
        ["-3.1416", "0"],
    ] {
        let text = robot(&(arm() + &turning("j4", ["l3", "l4"], limits, "")));
        let read = read(&text, None).unwrap();
        assert!(read.findings.is_empty(), "{limits:?} {:?}", read.findings);
    }
    let text = robot(&(arm() + &turning("j4", ["l3", "l4"], ["-10", "10"], "")));
    let found = cautions(&read(&text, None).unwrap(), "urdf-limits");
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].0, "j4");
    assert!(found[0].1.contains("573°"), "{found:?}");
    // What is beside the chain is nobody's.
    let text = robot(&(arm() + &turning("j4", ["l1", "l4"], ["-180", "180"], "")));
    assert!(read(&text, Some("l3")).is_ok());
}

#[test]
fn turns_in_degrees_are_refused() {
    for rpy in ["0 0 90", "-180 0 0", "1.57 45 0"] {
        let text = robot(&arm()).replacen("1 0 0\"/>", &format!("{rpy}\"/>"), 1);
        let error = read(&text, None).unwrap_err();
        assert_eq!(error.code(), Code::InvalidValue, "{error}");
        assert_eq!(error.place().line, Some(6), "{error}");
        assert!(error.message().contains("are these degrees?"), "{error}");
    }
    let text = robot(&arm()).replacen("1 0 0\"/>", "6.2832 -6.28 3.15\"/>", 1);
    assert!(read(&text, None).is_ok());
}

#[test]
fn the_likeliest_tips_come_first_with_their_joints() {
    let hand = fixed("l3", "hand")
        + &turning("left_finger_joint", ["hand", "left"], ["0", "0.8"], "")
        + &turning("right_finger_joint", ["hand", "right"], ["0", "0.8"], "")
        + &fixed("l1", "camera");
    let error = read(&robot(&(arm() + &hand)), None).unwrap_err();
    let arm_joints = "(3 joints, j1 to j3)";
    assert_eq!(
        error.hint_text().unwrap(),
        format!(
            "--tip one of l3 {arm_joints}, l1 (1 joint, j1), camera (1 joint, j1), left (4 joints, j1 to \
             left_finger_joint; left_finger_joint looks like a gripper's), right (4 joints, j1 to right_finger_joint; \
             right_finger_joint looks like a gripper's)"
        )
    );
    // By custom, by number, and behind a joint that shifts.
    for (more, first) in [
        (fixed("l3", "arm_tool0"), "arm_tool0 (3 joints, j1 to j3), l"),
        (fixed("l3", "ee_link"), "ee_link (3 joints, j1 to j3), l"),
        (fixed("l3", "l4"), "l4 (3 joints, j1 to j3), l"),
        (fixed("l3", "my_flange"), "my_flange (3 joints, j1 to j3), l"),
    ] {
        let error = read(&robot(&(arm() + &hand + &more)), None).unwrap_err();
        let hint = error.hint_text().unwrap();
        assert!(hint.starts_with(&format!("--tip one of {first}")), "{hint}");
    }
    let track = turning("track", ["world", "base"], ["0", "3"], "");
    let track = track.replace("revolute", "prismatic");
    let error = read(&robot(&(track + &arm() + &hand)), None).unwrap_err();
    let hint = error.hint_text().unwrap();
    let first = "--tip one of l3 (3 joints, j1 to j3; with --base base), ";
    assert!(hint.starts_with(first), "{hint}");
    // Fingers that shift are no tips.
    let shifts = hand.replace("type=\"revolute\"", "type=\"prismatic\"");
    let error = read(&robot(&(arm() + &shifts)), None).unwrap_err();
    assert!(!error.hint_text().unwrap().contains("left"), "{error:?}");
    let error = read(&robot(&(arm() + &shifts)), Some("left")).unwrap_err();
    assert!(error.hint_text().unwrap().contains("--tip l3 "), "{error:?}");
}

#[test]
fn a_gripper_behind_the_arm_is_doubted() {
    let limits = ["0", "0.85"];
    let mimic = "<mimic joint=\"last\"/>";
    let weak = |text: String| text.replace("effort=\"100\"", "effort=\"5\"");
    let shifting = turning("slide", ["l4", "pad"], ["0", "0.1"], "").replace("revolute", "prismatic");
    let last = |name: &str, limits| turning(name, ["l3", "l4"], limits, "");
    for (more, said) in [
        (last("jointGripper", ["-1.5", "0"]), "by its name"),
        (last("robotiq_85_left_knuckle_joint", limits), "by its name"),
        (last("finger_joint", limits), "by its name"),
        (turning("drive", ["l3", "outer_knuckle"], limits, ""), "by its name"),
        (last("last", TURN) + &turning("finger2", ["l3", "f2"], TURN, mimic), "fingers follow it"),
        (last("last", limits) + &turning("other", ["l3", "f2"], limits, mimic), "another joint follows it"),
        (weak(last("last", ["-0.3", "0.3"])), "far weaker"),
        (last("last", limits) + &shifting, "beside it shifts"),
    ] {
        let tip = if more.contains("outer_knuckle") { "outer_knuckle" } else { "l4" };
        let read = read(&robot(&(arm() + &more)), Some(tip)).unwrap();
        let found = cautions(&read, "urdf-gripper");
        assert_eq!(found.len(), 1, "{more}");
        assert!(found[0].1.contains(said), "{found:?}");
        assert!(found[0].1.contains("--tip l3."), "{found:?}");
    }
    // An arm is none: a wrist that turns the gripper, one that follows, one that is weak, one that turns little.
    for (more, what) in [
        (last("gripper_roll_joint", TURN), "a wrist"),
        (last("last", TURN) + &turning("rod", ["l3", "f2"], TURN, mimic), "a rod"),
        (weak(last("last", TURN)), "a weak wrist"),
        (last("last", ["-0.5", "0.5"]), "short"),
        (last("last", ["-2", "0"]), "to one side"),
    ] {
        let read = read(&robot(&(arm() + &more)), Some("l4")).unwrap();
        assert_eq!(cautions(&read, "urdf-gripper"), [], "{what}");
    }
    // A robot that is a finger has no arm before it.
    let finger = arm().replace("\"j", "\"finger_j");
    assert_eq!(cautions(&read(&robot(&finger), None).unwrap(), "urdf-gripper"), []);
}
