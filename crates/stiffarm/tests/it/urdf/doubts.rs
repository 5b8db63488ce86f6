//! Angles in degrees are refused or doubted, and chains that go on into a gripper are told.

use super::*;
use crate::common::cases::slip;
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
    let findings = read.findings.iter().filter(|finding| finding.code == code);
    findings.map(|finding| (finding.subject.clone(), finding.sentence.clone())).collect()
}

#[test]
fn angles_in_degrees_are_refused_or_doubted() {
    // The last of a joint that another one drives.
    let driver = turning("j5", ["base", "l5"], TURN, "");
    let mut report = String::new();
    for (limits, mimic, others, line) in [
        (["-180", "180"], "", "", 10),
        (["-170", "170"], "", "", 10),
        (["-3", "360"], "", "", 10),
        (["-117.5", "117.5"], "", "", 10),
        (["-15", "0"], "", "", 10),
        (["-90", "90"], "<mimic joint=\"j5\"/>", driver.as_str(), 11),
    ] {
        let text = robot(&(arm() + &turning("j4", ["l3", "l4"], limits, mimic) + others));
        let error = read(&text, Some("l4")).unwrap_err();
        assert_eq!((error.code(), error.place().line), (Code::InvalidValue, Some(line)), "{limits:?}: {error}");
        report += &slip::<()>(&limits.join(" to "), Err(error));
    }
    // Turns about fixed axes.
    for rpy in ["0 0 90", "-180 0 0", "1.57 45 0"] {
        let text = robot(&arm()).replacen("1 0 0\"/>", &format!("{rpy}\"/>"), 1);
        let error = read(&text, None).unwrap_err();
        assert_eq!((error.code(), error.place().line), (Code::InvalidValue, Some(6)), "{rpy}: {error}");
        report += &slip::<()>(rpy, Err(error));
    }
    insta::assert_snapshot!("degrees_in_a_urdf", report);
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
    let [(subject, sentence)] = &cautions(&read(&text, None).unwrap(), "urdf-limits")[..] else {
        panic!("one caution")
    };
    assert_eq!(subject, "j4");
    insta::assert_snapshot!(sentence, @"Limits of -10 and 10 rad are -573° and 573°: are these degrees? A URDF has radians.");
    // What is beside the chain is nobody's.
    let text = robot(&(arm() + &turning("j4", ["l1", "l4"], ["-180", "180"], "")));
    assert!(read(&text, Some("l3")).is_ok());
    let text = robot(&arm()).replacen("1 0 0\"/>", "6.2832 -6.28 3.15\"/>", 1);
    assert!(read(&text, None).is_ok());
}

#[test]
fn the_likeliest_tips_come_first_with_their_joints() {
    let hand = fixed("l3", "hand")
        + &turning("left_finger_joint", ["hand", "left"], ["0", "0.8"], "")
        + &turning("right_finger_joint", ["hand", "right"], ["0", "0.8"], "")
        + &fixed("l1", "camera");
    let track = turning("track", ["world", "base"], ["0", "3"], "").replace("revolute", "prismatic");
    // Fingers that shift are no tips.
    let shifts = hand.replace("type=\"revolute\"", "type=\"prismatic\"");
    let mut report = String::new();
    // By custom, by number, and behind a joint that shifts.
    for (what, joints, tip) in [
        ("a hand", arm() + &hand, None),
        ("a tool0", arm() + &hand + &fixed("l3", "arm_tool0"), None),
        ("an ee_link", arm() + &hand + &fixed("l3", "ee_link"), None),
        ("one more link", arm() + &hand + &fixed("l3", "l4"), None),
        ("a flange", arm() + &hand + &fixed("l3", "my_flange"), None),
        ("on a track", track + &arm() + &hand, None),
        ("fingers that shift", arm() + &shifts, None),
        ("to one of them", arm() + &shifts, Some("left")),
    ] {
        report += &slip(what, read(&robot(&joints), tip));
    }
    insta::assert_snapshot!("tips_of_a_urdf", report);
}

#[test]
fn a_gripper_behind_the_arm_is_doubted() {
    let limits = ["0", "0.85"];
    let mimic = "<mimic joint=\"last\"/>";
    let weak = |text: String| text.replace("effort=\"100\"", "effort=\"5\"");
    let shifting = turning("slide", ["l4", "pad"], ["0", "0.1"], "").replace("revolute", "prismatic");
    let last = |name: &str, limits| turning(name, ["l3", "l4"], limits, "");
    let mut report = String::new();
    for (more, tip, what) in [
        (last("jointGripper", ["-1.5", "0"]), "l4", "jointGripper"),
        (last("robotiq_85_left_knuckle_joint", limits), "l4", "robotiq_85_left_knuckle_joint"),
        (last("finger_joint", limits), "l4", "finger_joint"),
        (turning("drive", ["l3", "outer_knuckle"], limits, ""), "outer_knuckle", "outer_knuckle"),
        (last("last", TURN) + &turning("finger2", ["l3", "f2"], TURN, mimic), "l4", "a finger follows"),
        (last("last", limits) + &turning("other", ["l3", "f2"], limits, mimic), "l4", "another joint follows"),
        (weak(last("last", ["-0.3", "0.3"])), "l4", "weak and short"),
        (last("last", limits) + &shifting, "l4", "beside a joint that shifts"),
    ] {
        let read = read(&robot(&(arm() + &more)), Some(tip)).unwrap();
        let [(_, sentence)] = &cautions(&read, "urdf-gripper")[..] else { panic!("{what}: {:?}", read.findings) };
        report += &format!("» {what}\n{sentence}\n\n");
    }
    insta::assert_snapshot!("grippers_in_a_urdf", report);
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
