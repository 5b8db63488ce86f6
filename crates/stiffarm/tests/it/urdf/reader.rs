//! A URDF may leave out or write in another way what it likes, and may not give anything twice.

use super::*;
use std::f64::consts::TAU;
use stiffarm::Code;
use stiffarm_files::urdf::CollisionGeometry;

/// An arm of two joints, every part of it written out.
const WHOLE: &str = r#"<robot name="arm">
  <link name="a"><collision><origin xyz="0 0 0" rpy="0 0 0"/><geometry><mesh filename="a.stl" scale="1 1 1"/></geometry></collision></link>
  <link name="b"/>
  <link name="c"/>
  <joint name="j1" type="revolute">
    <parent link="a"/><child link="b"/><origin xyz="0 0 0" rpy="0 0 0"/><axis xyz="1 0 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="j2" type="revolute">
    <parent link="b"/><child link="c"/><origin xyz="0.3 0 0.4" rpy="0 0 0.5"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1.5" effort="1" velocity="2"/>
  </joint>
</robot>
"#;

fn read(text: &str) -> UrdfRobot {
    let read = read_urdf(text, "robot.urdf", &UrdfOptions::default());
    read.unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn with(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(WHOLE.to_string(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    })
}

#[test]
fn what_is_left_out_has_its_default() {
    let origin = "<origin xyz=\"0 0 0\" rpy=\"0 0 0\"/>";
    for changes in [
        &[(origin, ""), (origin, "")][..],
        &[(origin, "<origin/>"), (" rpy=\"0 0 0\"", "")],
        &[("<axis xyz=\"1 0 0\"/>", "")],
        &[(" scale=\"1 1 1\"", "")],
        &[(" effort=\"1\"", "")],
    ] {
        assert_eq!(read(&with(changes)), read(WHOLE), "{changes:?}");
    }
    let unnamed = read(&with(&[(" name=\"arm\"", "")]));
    assert_eq!(unnamed.robot.name, "robot");
}

#[test]
fn the_same_may_be_written_in_other_ways() {
    for changes in [
        &[("0.3 0 0.4", " 3e-1\n\t0  +0.4 ")][..],
        &[("lower=\"-2\"", "lower=' -2.0 '")],
        &[("<robot", "\u{feff}\n<?xml version=\"1.0\"?><!-- <robot> -->\n<robot")],
        &[("<robot", "<robot xmlns=\"http://www.ros.org\"")],
        &[("name=\"j2\"", "name=\"j&#50;\"")],
        &[("<link name=\"b\"/>", "<link name=\"b\"></link><u:link xmlns:u=\"other\" name=\"b\"/>")],
        &[("<link name=\"b\"/>", ""), ("</robot>", "<link name=\"b\"/></robot>")],
    ] {
        assert_eq!(read(&with(changes)), read(WHOLE), "{changes:?}");
    }
    let escaped = read(&with(&[("a.stl", "a&amp;b.stl")]));
    let CollisionGeometry::Mesh { path, .. } = &escaped.shapes[0].geometry else {
        panic!("{escaped:?}");
    };
    assert_eq!(path, "a&b.stl");
}

#[test]
fn a_link_may_have_several_collisions_of_one_shape_each() {
    let second = "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>";
    let read = read(&with(&[("</link>", second)]));
    assert_eq!(read.shapes.len(), 2);
    assert_eq!(read.shapes[1].geometry, CollisionGeometry::Sphere { radius: 0.1 });
}

#[test]
fn limits_of_version_1_2_may_be_left_out() {
    let limit = "<limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/>";
    let newer = "<robot version=\"1.2\"";
    // Limits become the degrees that they mean.
    for (limit_of_j1, low, high) in [
        ("<limit/>", -TAU, TAU),
        ("<limit lower=\"-1\"/>", -1.0, TAU),
        ("<limit lower=\"-inf\" upper=\"1\"/>", -TAU, 1.0),
    ] {
        let read = read(&with(&[("<robot", newer), (limit, limit_of_j1)]));
        assert_eq!(read.robot.speeds, None);
        let [lower, upper] = read.robot.limits.unwrap()[0];
        assert!((lower - low).abs() < 1e-4 && (upper - high).abs() < 1e-4, "{limit_of_j1}");
    }
    for version in ["", " version=\"1.1\"", " version=\"new\""] {
        let text = with(&[("<robot", &format!("<robot{version}")), (limit, "<limit/>")]);
        let error = read_urdf(&text, "robot.urdf", &UrdfOptions::default()).unwrap_err();
        assert_eq!(error.message(), "<limit> has no velocity.", "{version}");
    }
}

#[test]
fn faults_are_named_with_line_and_column() {
    let origin = "<origin xyz=\"0.3 0 0.4\" rpy=\"0 0 0.5\"/>";
    let mesh = "<mesh filename=\"a.stl\" scale=\"1 1 1\"/>";
    for (from, to, code, place) in [
        ("0.3 0 0.4", "0.3 O 0.4", Code::Urdf, (10, 53)),
        ("0.3 0 0.4", "0.3 0", Code::Urdf, (10, 53)),
        ("0 0 0.5", "0 0 inf", Code::NotFinite, (10, 69)),
        ("velocity=\"2\"", "velocity=\"NaN\"", Code::NotFinite, (11, 56)),
        ("<child link=\"c\"/>", "", Code::Urdf, (9, 3)),
        ("<child link=\"c\"/>", "<child/>", Code::Urdf, (10, 23)),
        ("<axis xyz=\"0 1 0\"/>", "<axis/>", Code::Urdf, (10, 79)),
        (origin, &origin.repeat(2), Code::Duplicate, (10, 79)),
        (" lower=\"-1\"", " lower=\"\"", Code::Urdf, (11, 19)),
        (mesh, "", Code::Urdf, (2, 62)),
        (mesh, &mesh.repeat(2), Code::Urdf, (2, 62)),
        (mesh, "<plane/>", Code::Urdf, (2, 62)),
        (mesh, "<sphere radius=\"one\"/>", Code::Urdf, (2, 88)),
        (mesh, "<cylinder radius=\"1\"/>", Code::Urdf, (2, 72)),
        ("<geometry>", "<geometry/><geometry>", Code::Duplicate, (2, 73)),
        ("<robot", "<!DOCTYPE robot>\n<robot", Code::Unsupported, (1, 1)),
        ("<robot", "\n<robot u:name=\"x\"", Code::Urdf, (2, 8)),
        ("<link name=\"b\"/>", "<xacro:link/>", Code::Unsupported, (3, 4)),
    ] {
        let text = with(&[(from, to)]);
        let error = read_urdf(&text, "robot.urdf", &UrdfOptions::default()).unwrap_err();
        let at = error.place();
        assert_eq!(error.code(), code, "{error}");
        let place = (Some(place.0), Some(place.1));
        assert_eq!((at.line, at.column), place, "{error}");
    }
}

#[test]
fn what_is_no_xml_is_said_with_its_place() {
    let crowd: String = (0..2000).map(|i| format!(" a{i}=''")).collect();
    for (text, place) in [
        ("", (1, 1)),
        ("hello", (1, 1)),
        ("<!-- <a/> -->", (1, 1)),
        ("<", (1, 2)),
        ("<a", (1, 1)),
        ("<robot>\n<ß", (1, 1)),
        ("\n <!-- x --> <robot>", (2, 13)),
        ("<robot></b>", (1, 8)),
        ("</a>", (1, 2)),
        ("<a/>\n<b/>", (2, 1)),
        ("<a b>", (1, 5)),
        ("<a b=c/>", (1, 6)),
        ("<a b='c/>", (1, 10)),
        ("<a ß='<'/>", (1, 7)),
        ("<a b='1' b='2'/>", (1, 10)),
        ("<!-- <a/>", (1, 10)),
        ("<a><![CDATA[</a>", (1, 17)),
        ("<robot>\n<ignition:a/></robot>", (2, 2)),
        ("<?xml version='1.0'?><!DOCTYPE robot><robot/>", (1, 22)),
        (&format!("<robot>\n<link{crowd}/></robot>"), (2, 1)),
    ] {
        let error = read_urdf(text, "robot.urdf", &UrdfOptions::default()).unwrap_err();
        let at = error.place();
        let place = (Some(place.0), Some(place.1));
        assert_eq!((at.line, at.column), place, "{text}: {error}");
        assert!(error.hint_text().is_some(), "{error}");
    }
}

#[test]
fn elements_inside_elements_take_no_stack() {
    let deep = "<a>".repeat(100_000) + &"</a>".repeat(100_000);
    let text = with(&[("</robot>", &format!("{deep}</robot>"))]);
    assert_eq!(read(&text), read(WHOLE));
}
