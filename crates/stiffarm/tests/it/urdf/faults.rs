//! URDF files that are no arm are refused with their line; mimic joints are coupled as they move.

use super::*;
use crate::common::cases::slip;
use stiffarm::{Code, Error};

const LIMIT: &str = r#"<limit lower="-2" upper="2" effort="1" velocity="1"/>"#;

/// A joint from `parent` to `child`; `inside` comes after both.
fn joint(name: &str, kind: &str, parent: &str, child: &str, inside: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{inside}</joint>\n"
    )
}

/// A robot of links a, b, c, … and the joints given.
fn robot(links: &str, joints: &[String]) -> String {
    let links: String = links.chars().map(|c| format!("<link name=\"{c}\"/>\n")).collect();
    format!("<robot name=\"test\">\n{links}{}</robot>\n", joints.concat())
}

fn refused(text: &str, options: &UrdfOptions) -> Error {
    match read_urdf(text, "robot.urdf", options) {
        Ok(read) => panic!("accepted: {read:?}\n{text}"),
        Err(error) => error,
    }
}

fn arm() -> [String; 2] {
    let z = format!("<axis xyz=\"0 0 1\"/>{LIMIT}");
    let y = format!("<origin xyz=\"0.3 0 0.4\"/><axis xyz=\"0 1 0\"/>{LIMIT}");
    [joint("j1", "revolute", "a", "b", &z), joint("j2", "revolute", "b", "c", &y)]
}

#[test]
fn faults_are_named_with_their_lines() {
    let [j1, j2] = arm();
    let whole = robot("abc", &[j1.clone(), j2.clone()]);
    assert!(read_urdf(whole.as_str(), "robot.urdf", &UrdfOptions::default()).is_ok());
    let child = "<child link=\"c\"/>";
    // Most others: `reader.rs`.
    for (from, to, code, line) in [
        ("lower=\"-2\"", "lower=\"3\"", Code::InvalidValue, Some(5)),
        (LIMIT, "", Code::InvalidValue, Some(5)),
        ("lower=\"-2\" upper=\"2\"", "lower=\"-180\" upper2=\"1\" upper=\"900\"", Code::InvalidValue, Some(5)),
        ("0.3 0 0.4", "300 0 4e5", Code::InvalidValue, Some(6)),
        ("0 1 0", "0 0 0", Code::InvalidValue, Some(6)),
        ("\"j2\" type=\"revolute\"", "\"j2\" type=\"revolut\"", Code::Urdf, Some(6)),
        ("\"j2\" type=\"revolute\"", "\"j2\" type=\"prismatic\"", Code::Unsupported, Some(6)),
        ("\"j2\" type=\"revolute\"", "\"j2\" type=\"planar\"", Code::Unsupported, Some(6)),
        (child, "<child link=\"d\"/>", Code::UnknownName, Some(6)),
        (child, "<child link=\"b\"/>", Code::Urdf, Some(6)),
        ("\"j2\"", "\"j1\"", Code::Duplicate, Some(5)),
        ("\"j2\"", "\"=j2\"", Code::InvalidValue, Some(6)),
        ("<link name=\"c\"/>", "<link name=\"c\"/><link name=\"c\"/>", Code::Duplicate, Some(4)),
        ("<link name=\"c\"/>", "<link/>", Code::Urdf, Some(4)),
        ("xyz=\"0.3 0 0.4\"", "quat_xyzw=\"0 0 0 1\"", Code::Unsupported, Some(6)),
        ("0.3 0 0.4", "${x} 0 0.4", Code::Unsupported, Some(6)),
        ("robot", "sdf", Code::Urdf, Some(1)),
        (whole.as_str(), "<robot name=\"x\"/>", Code::Urdf, None),
        (whole.as_str(), "", Code::Urdf, Some(1)),
    ] {
        assert!(whole.contains(from), "{from}");
        let text = whole.replace(from, to);
        let error = refused(&text, &UrdfOptions::default());
        assert_eq!((error.code(), error.place().line), (code, line), "{error}\n{text}");
        assert_eq!(error.place().file.as_deref(), Some("robot.urdf"), "{error}");
    }
}

#[test]
fn base_and_tip_must_be_on_one_branch() {
    let [j1, j2] = arm();
    let fork = joint("j3", "revolute", "b", "d", LIMIT);
    let text = robot("abcd", &[j1.clone(), j2.clone(), fork]);
    // Two trees, and one that bites its tail.
    let two = robot("abcde", &[j1.clone(), j2.clone()]);
    let round = robot("abc", &[j1, j2, joint("j3", "revolute", "c", "a", LIMIT)]);
    let mut report = String::new();
    for (what, text, options) in [
        ("a fork", &text, UrdfOptions::default()),
        ("from c to a", &text, options("c", "a")),
        ("from c to d", &text, options("c", "d")),
        ("from a to a", &text, options("a", "a")),
        ("two trees", &two, UrdfOptions::default()),
        ("a circle", &round, UrdfOptions::default()),
    ] {
        report += &slip(what, read_urdf(text, "robot.urdf", &options));
    }
    insta::assert_snapshot!("no_branch_of_a_urdf", report);
    let arm = read_urdf(&text, "robot.urdf", &options("b", "d")).unwrap();
    assert_eq!(arm.robot.joint_names, ["j3"]);
    // A custom name decides, and an end that nothing moves is none.
    let named = text.replace("\"c\"", "\"tool0\"");
    let arm = read_urdf(&named, "robot.urdf", &UrdfOptions::default()).unwrap();
    assert_eq!(arm.tip_link, "tool0");
    let still = text.replace("name=\"j3\" type=\"revolute\"", "name=\"j3\" type=\"fixed\"");
    let still = still.replace("<parent link=\"b\"/><child link=\"d\"/>", "<parent link=\"a\"/><child link=\"d\"/>");
    let arm = read_urdf(&still, "robot.urdf", &UrdfOptions::default()).unwrap();
    assert_eq!(arm.tip_link, "c");
}

#[test]
fn joints_off_the_chain_may_be_of_any_kind() {
    let [j1, j2] = arm();
    let track = joint("track", "prismatic", "t", "a", LIMIT);
    let finger = joint("finger", "prismatic", "c", "f", "<mimic joint=\"j2\"/>");
    let lever = joint("lever", "continuous", "b", "l", "<mimic joint=\"j2\" multiplier=\"-1\"/>");
    let text = robot("tabcfl", &[track, j1, j2, finger, lever]);
    let read = read_urdf(&text, "robot.urdf", &options("a", "c")).unwrap();
    assert_eq!(read.robot.joint_names, ["j1", "j2"]);
}

/// Poses and Jacobians of a chain with mimic joints, as a second reading has them.
fn sound(text: &str) -> UrdfRobot {
    let read = read_urdf(text, "robot.urdf", &UrdfOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let worst = differences(text, &read, &mut Dice::new(5), 20);
    assert!(worst.pose < 1e-12 && worst.jacobian < 1e-12 && worst.cell < 1e-9);
    read
}

/// Base to d: a swivel, a shoulder, then an axis that `passive` and `j3` share.
fn parallelogram(passive: &str, passive_axis: &str, between: &str) -> String {
    let [j1, j2] = arm();
    let at = format!("<origin xyz=\"0 0 1.1\"/><axis xyz=\"{passive_axis}\"/>{LIMIT}{passive}");
    let elbow = format!("<origin xyz=\"{between}\"/><axis xyz=\"0 1 0\"/>{LIMIT}");
    let hand = "<origin xyz=\"0.9 0.1 0\" rpy=\"0.2 0.1 0.3\"/>";
    robot(
        "abcdef",
        &[
            j1,
            j2,
            joint("passive", "revolute", "c", "d", &at),
            joint("j3", "revolute", "d", "e", &elbow),
            joint("hand", "fixed", "e", "f", hand),
        ],
    )
}

#[test]
fn a_mimic_joint_on_the_axis_of_the_next_is_an_entry_of_the_coupling() {
    let follows = "<mimic joint=\"j2\" multiplier=\"-1\" offset=\"0.1\"/>";
    for (axis, sign) in [("0 1 0", -1.0), ("0 -1 0", 1.0)] {
        let read = sound(&parallelogram(follows, axis, "0 0 0"));
        assert_eq!(read.robot.joint_names, ["j1", "j2", "j3"]);
        let rows = &read.robot.coupling;
        assert_eq!((rows[(2, 1)], rows[(2, 2)], rows[(1, 2)]), (sign, 1.0, 0.0));
        // The limits of the passive joint hold for the one that it follows.
        let limits = read.robot.limits.as_ref().unwrap();
        assert!((limits[1][0] + 1.9).abs() < 1e-4 && (limits[1][1] - 2.0).abs() < 1e-4, "{limits:?}");
    }
    // Along the axis is still the same axis; beside it is not.
    sound(&parallelogram(follows, "0 1 0", "0 0.2 0"));
    let error = refused(&parallelogram(follows, "0 1 0", "0.01 0 0"), &UrdfOptions::default());
    assert_eq!((error.code(), error.place().line), (Code::Unsupported, Some(10)));
    insta::assert_snapshot!(error, @r#"
    robot.urdf:10:1: The joint "passive" follows another one (mimic) in a way that is not supported: 4 axes between base and tip are turned by 3 joints of the controller.
      hint: there must be as many: a mimic joint may follow a joint off the chain, or share its axis with the joint next to it; else describe the arm without it
    "#);
}

#[test]
fn a_mimic_joint_may_follow_one_that_is_off_the_chain() {
    let [j1, _] = arm();
    let motor = joint("motor", "revolute", "b", "m", LIMIT);
    let gear = joint("gear", "continuous", "b", "g", "<mimic joint=\"motor\" multiplier=\"2\" offset=\"0.2\"/>");
    let follows =
        format!("<origin xyz=\"0.3 0 0.4\"/><axis xyz=\"0 1 0\"/>{LIMIT}<mimic joint=\"gear\" multiplier=\"-0.5\"/>");
    let elbow = joint("j2", "revolute", "b", "c", &follows);
    let tool = joint("mount", "fixed", "c", "tool0", "<origin xyz=\"1 0 0\"/>");
    let text = robot("abmgc", &[j1.clone(), motor.clone(), gear.clone(), elbow, tool]);
    let text = text.replace("<link name=\"c\"/>", "<link name=\"c\"/><link name=\"tool0\"/>");
    let read = sound(&text);
    assert_eq!(read.robot.joint_names, ["j1", "motor"]);
    assert_eq!(read.robot.coupling[(1, 1)], -1.0);
    // One that stands still whatever the other does is fixed.
    let still = text.replace("multiplier=\"-0.5\"", "multiplier=\"0\" offset=\"0.3\"");
    assert_eq!(sound(&still).robot.joint_names, ["j1"]);
    let mut report = String::new();
    for (from, to) in [
        ("joint=\"gear\"", "joint=\"geer\""),
        ("joint=\"motor\"", "joint=\"j2\""),
        ("name=\"motor\" type=\"revolute\"", "name=\"motor\" type=\"prismatic\""),
    ] {
        report += &slip(to, read_urdf(&text.replace(from, to), "robot.urdf", &UrdfOptions::default()));
    }
    insta::assert_snapshot!("mimic_joints_of_a_urdf", report);
}

#[test]
fn two_joints_that_one_moves_are_refused() {
    let [j1, _] = arm();
    let follows = format!("<origin xyz=\"0.3 0 0.4\"/><axis xyz=\"0 1 0\"/>{LIMIT}<mimic joint=\"j1\"/>");
    let text = robot("abc", &[j1, joint("j2", "revolute", "b", "c", &follows)]);
    let error = refused(&text, &UrdfOptions::default());
    assert_eq!((error.code(), error.place().line), (Code::Unsupported, Some(6)));
    insta::assert_snapshot!(error, @r#"
    robot.urdf:6:1: The joint "j2" follows another one (mimic) in a way that is not supported: 2 axes between base and tip are turned by 1 joints of the controller.
      hint: there must be as many: a mimic joint may follow a joint off the chain, or share its axis with the joint next to it; else describe the arm without it
    "#);
}

#[test]
fn limits_in_degrees_are_said_as_they_stand() {
    let limit = r#"<limit lower="-180" upper="180" effort="1" velocity="1"/>"#;
    let [_, j2] = arm();
    let direct = joint("j1", "revolute", "a", "b", &format!("<axis xyz=\"0 0 1\"/>{limit}"));
    // An elbow that follows a motor beside the chain.
    let motor = joint("motor", "revolute", "b", "m", LIMIT);
    let follows = format!("<origin xyz=\"0.3 0 0.4\"/><axis xyz=\"0 1 0\"/>{limit}<mimic joint=\"motor\"/>");
    let elbow = joint("elbow", "revolute", "b", "c", &follows);
    let [j1, _] = arm();
    for (joints, name) in [(vec![direct, j2], "j1"), (vec![j1, motor, elbow], "elbow")] {
        let error = refused(&robot("abcm", &joints), &options("a", "c"));
        let message = format!("The joint \"{name}\" has a limit of -180 rad, which is 29 turns: are these degrees?");
        assert_eq!(error.message(), message);
    }
}

#[test]
fn what_says_nothing_here_may_be_anything() {
    let [j1, j2] = arm();
    let text = robot("abc", &[j1, j2]);
    let odd = "<link name=\"c\"><inertial/><visual><geometry><plane/></geometry></visual></link>\
               <gazebo><joint name=\"j1\"/></gazebo><transmission name=\"t\"><joint name=\"j1\"/></transmission>";
    let odd = text.replace("<link name=\"c\"/>", odd);
    assert_eq!(
        read_urdf(&odd, "robot.urdf", &UrdfOptions::default()).unwrap().robot,
        read_urdf(&text, "robot.urdf", &UrdfOptions::default()).unwrap().robot
    );
}
