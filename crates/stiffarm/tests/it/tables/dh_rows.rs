//! Tables of Denavit–Hartenberg rows give the same robot in any unit, and are refused in the other convention.

use crate::common::cases::slip;
use stiffarm::Code;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::robot::{DhConvention, DhRobot, DhRow, Robot};
use stiffarm::units::deg_to_rad;
use stiffarm_files::cell::{parse_cell, template_of};
use stiffarm_files::table::read_dh_rows;

const ROWS: &str = "joint,alpha_deg,a_mm,d_mm,offset_deg,low_deg,high_deg,sign\n\
                    A1,0,0,645,0,-185,185,-1\n\
                    A2,-90,330,0,0,-140,-5,1\n\
                    A3,0,1150.5,0,-90,-120,168,1\n";

fn read(text: &str, convention: DhConvention) -> stiffarm::Result<DhRobot> {
    read_dh_rows(text.as_bytes(), "rows.csv", "mine", convention)
}

#[test]
fn rows_become_a_robot() {
    let read = read(ROWS, DhConvention::Modified).unwrap();
    let robot = read.robot().unwrap();
    let names: Vec<&str> = robot.joints().iter().map(|j| j.name.as_str()).collect();
    assert_eq!((robot.name(), names), ("mine", vec!["A1", "A2", "A3"]));
    assert_eq!(robot.joints()[1].limits, [-140.0, -5.0].map(deg_to_rad));
    assert_eq!(robot.coupling().diagonal().as_slice(), [-1.0, 1.0, 1.0]);
    let row =
        |alpha: f64, a: f64, d: f64, offset: f64| DhRow { alpha: deg_to_rad(alpha), a, d, offset: deg_to_rad(offset) };
    let rows = [row(0.0, 0.0, 0.645, 0.0), row(-90.0, 0.33, 0.0, 0.0), row(0.0, 1.1505, 0.0, -90.0)];
    assert_eq!(read.rows, rows);
}

#[test]
fn other_units_decimal_commas_and_missing_columns_are_the_same_robot() {
    let european = "joint;alpha_rad;a_m;d_m;offset_deg\nA1;0;0;0,645;0\nA2;-1,5707963267948966;0,33;0;0\n";
    let plain = "offset_deg,joint,d_mm,a_mm,alpha_deg\n0,A1,645,0,0\n0,A2,0,330,-90\n";
    for convention in [DhConvention::Modified, DhConvention::Standard] {
        let dh_rows = read(european, convention).unwrap();
        assert_eq!(dh_rows, read(plain, convention).unwrap());
        assert_eq!(dh_rows.limits, None);
        let robot = dh_rows.robot().unwrap();
        assert!(robot.limits_are_unknown());
        let by_hand = Robot::from_dh("mine", convention, &dh_rows.rows, nalgebra::Isometry3::identity());
        let q = [0.3, -0.4];
        let flange = |robot: &Robot| Frames::new(robot, &q).flange().to_homogeneous();
        assert_eq!(flange(&robot), flange(&by_hand.unwrap()));
        // And in the written cell.
        let text = template_of(&dh_rows, "Rows.").unwrap();
        let cell = parse_cell(&text, "cell.toml").unwrap();
        assert!((flange(&robot) - flange(&cell.setup.robot)).amax() < 1e-14);
    }
}

#[test]
fn slips_have_their_places() {
    for (from, to, code, line, column) in [
        ("alpha_deg", "alpha", Code::TableHeading, 1, Some(7)),
        ("offset_deg,", "", Code::TableHeading, 1, None),
        (",low_deg", ",ignore_deg", Code::TableHeading, 1, Some(38)),
        ("A3,", "A1,", Code::Duplicate, 4, Some(1)),
        ("1150.5", "1150,5", Code::DecimalComma, 4, Some(4)),
        ("1150.5", "nan", Code::NotFinite, 4, Some(6)),
        ("1150.5", "", Code::TableRow, 4, Some(6)),
        ("1150.5", "1e7", Code::TableRow, 4, Some(6)),
        ("-185,185,-1", "-185,185,2", Code::InvalidValue, 2, Some(23)),
        ("-140,-5", "-5,-140", Code::InvalidValue, 3, Some(19)),
        ("A3", "=A3", Code::TableRow, 4, Some(1)),
    ] {
        assert!(ROWS.contains(from), "{from}");
        let error = read(&ROWS.replacen(from, to, 1), DhConvention::Modified).unwrap_err();
        let place = error.place();
        assert_eq!((error.code(), place.line, place.column), (code, Some(line), column), "{error}");
    }
}

/// Rows of the other convention put two axes on one line; that no arm has them tells.
#[test]
fn rows_of_the_other_convention_are_refused() {
    // A lightweight arm as its maker's data sheet has it, and a heavy one with a spherical wrist.
    let light = "joint,alpha_deg,a_mm,d_mm,offset_deg\n1,90,0,127.3,0\n2,0,-612,0,0\n3,0,-572.3,0,0\n\
                 4,90,0,163.9,0\n5,-90,0,115.7,0\n6,0,0,92.2,0\n";
    let heavy = "joint,alpha_deg,a_mm,d_mm,offset_deg\n1,0,0,645,0\n2,-90,330,0,0\n3,0,1150,0,-90\n\
                 4,-90,115,1220,0\n5,90,0,0,0\n6,-90,0,0,0\n";
    let (modified, standard) = (DhConvention::Modified, DhConvention::Standard);
    let mut report = String::new();
    for (what, rows, right, other) in [("light", light, standard, modified), ("heavy", heavy, modified, standard)] {
        assert!(read(rows, right).is_ok(), "{what}");
        report += &slip(what, read(rows, other));
    }
    insta::assert_snapshot!(report, @"
    » light
    [conflict] rows.csv: Read as modified rows, axes 5 and 6 lie on one line, which no arm has; read as standard rows no two do.
      hint: give the rows as dh_standard, or --dh-convention standard: there alpha and a of a row lie behind the joint's turn

    » heavy
    [conflict] rows.csv: Read as standard rows, axes 1 and 2 lie on one line, which no arm has; read as modified rows no two do.
      hint: give the rows as dh_modified, or --dh-convention modified: there alpha and a of a row lie before the joint's turn
    ");
    // In a cell, too.
    let robot = read(light, standard).unwrap();
    let text = template_of(&robot, "").unwrap();
    assert!(parse_cell(&text, "cell.toml").is_ok());
    let wrong = text.replace("dh_standard", "dh_modified");
    assert_ne!(wrong, text);
    let error = parse_cell(&wrong, "cell.toml").unwrap_err();
    assert_eq!(error.place().key.as_deref(), Some("robot.dh_modified"));
}
