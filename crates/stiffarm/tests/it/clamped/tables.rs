//! Tables of clamped data are read as they are written, and refused with their place where they cannot be meant.

use super::*;
use crate::common::cases::refusals;

fn from_table(cell: &Cell, text: &str) -> Vec<ClampedPosture> {
    read_clamped(text.as_bytes(), "clamped.csv", cell, None).unwrap()
}

#[test]
fn a_written_table_is_read_again() {
    let cell = reference_cell();
    let mut data = exact(&cell, 3, 2, 2);
    let text = write_clamped(&data, &cell.setup.robot);
    let again = from_table(&cell, &text);
    assert_eq!(write_clamped(&again, &cell.setup.robot), text);
    assert_close(&stiffness(&cell, &again), &stiffness(&cell, &data), 1e-9, "read again");
    data[1].fixture_motion = Some(Vector6::new(1e-5, -2e-5, 3e-6, 1e-4, 0.0, -2e-4));
    let text = write_clamped(&data, &cell.setup.robot);
    let again = from_table(&cell, &text);
    assert_eq!(write_clamped(&again, &cell.setup.robot), text);
    let motion = again[1].fixture_motion.unwrap();
    assert!((motion - data[1].fixture_motion.unwrap()).amax() < 1e-15);
}

#[test]
fn states_are_taken_against_their_reference() {
    let mut cell = reference_cell();
    let pose = Isometry3::translation(0.0, 0.0, 0.1);
    cell.sensor = Some(Sensor { mount: Mount::Flange, pose, reports_by_robot: true, mirrored: None });
    let text = "posture;state;q1_deg;q2_deg;q3_deg;q4_deg;q5_deg;q6_deg;fx_n;fy_n;fz_n;mx_nm;my_nm;mz_nm\n\
                A;unloaded;10;0;-90;10;50;20;1;2;3;4;5;6\n\
                A;up;10,01;0;-90;10;50;20;101;2;3;4;5;6\n\
                B;unloaded;20;0;-90;10;50;20;;;;;;\n\
                B;unloaded-2;20,002;0;-90;10;50;20;;;;;;\n\
                B;up;20;0,1;-90;10;50;20;0;0;7;0;0;0\n";
    let read = from_table(&cell, text);
    assert_eq!(read.len(), 2);
    let a = &read[0];
    assert!((a.motor[0] - 0.01_f64.to_radians()).abs() < 1e-15);
    assert_eq!((a.reference, a.posture.q[0]), (Some(0), 10.0_f64.to_radians()));
    // 100 N along the flange's x, by the robot: turned, with its sign, moved to the clamp.
    let frames = Frames::new(&cell.setup.robot, &a.posture.q);
    let force = frames.direction(&Vector3::new(-100.0, 0.0, 0.0));
    assert!((a.wrench.force - force).norm() < 1e-9);
    let arm = frames.direction(&(Vector3::new(0.0, 0.0, 0.1) - cell.setup.tool.loading_point));
    assert!((a.wrench.moment - arm.cross(&force)).norm() < 1e-9);
    let b = &read[1];
    assert!((b.posture.q[0] - 20.001_f64.to_radians()).abs() < 1e-15);
    assert!((b.motor[0] + 0.001_f64.to_radians()).abs() < 1e-15);
    assert!((b.wrench.force.norm() - 7.0).abs() < 1e-12);
}

/// What a preload has taken up is in no state against it, and no unknown of them.
#[test]
fn against_a_preload_no_clamped_state_shows_lost_motion() {
    let cell = reference_cell();
    let head = "posture,state,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n";
    let rows = |name: &str, q1: f64| {
        let q = |more: f64| format!("{},{},-90,10,50,20", q1 + more, q1 / 3.0 - more);
        [("unloaded", 0.0, 0.0), ("preload", 0.2, 0.01), ("up", 1.0, 0.02)].map(|(state, share, more)| {
            let [x, y, z] = [100.0, 200.0, -500.0].map(|v| v * share);
            format!("{name},{state},{x},{y},{z},0,0,0,{}\n", q(more))
        })
    };
    let text = head.to_string() + &rows("A", 10.0).concat() + &rows("B", 40.0).concat();
    let read = from_table(&cell, &text);
    assert_eq!(read.len(), 2);
    assert_eq!(read[0].preload.unwrap().force.as_slice(), [20.0, 40.0, -100.0]);
    assert_eq!(read[0].wrench.force.as_slice(), [80.0, 160.0, -400.0]);
    let mut options = IdentifyOptions::default();
    options.estimator = Estimator::Ordinary;
    options.extra = vec![ExtraTerm::LostMotion(1)];
    let undetermined = |read: &[ClampedPosture]| {
        let identification = identify_clamped(&cell, read, None, &options).unwrap();
        let names = identification.estimates.undetermined_joints;
        names.contains(&"lost motion of joint 2".to_string())
    };
    assert!(undetermined(&read));
}

#[test]
fn a_table_that_cannot_be_meant_is_refused_with_its_place() {
    let cell = reference_cell();
    let wrench = "fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm";
    let q = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg";
    let dq = "dq1_deg,dq2_deg,dq3_deg,dq4_deg,dq5_deg,dq6_deg";
    let angles = "10,0,-90,10,50,20";
    let cases = [
        ("no reference", Code::TableRow, format!("{wrench},{q}\nA,up,1,2,3,4,5,6,{angles}\n")),
        ("no load", Code::TableRow, format!("{wrench},{q}\nA,unloaded,1,2,3,4,5,6,{angles}\n")),
        (
            "a joint that gives way by 6°",
            Code::TableRow,
            format!("{wrench},{q}\nA,unloaded,1,2,3,4,5,6,{angles}\nA,up,1,2,3,4,5,6,10,0,-90,10,50,26\n"),
        ),
        (
            "a load without force",
            Code::TableRow,
            format!("{wrench},{q}\nA,unloaded,1,2,3,4,5,6,{angles}\nA,up,,,,,,,{angles}\n"),
        ),
        ("differences without postures", Code::TableHeading, format!("{wrench},{dq}\nA,up,1,2,3,4,5,6,0,0,0,0,0,0\n")),
        (
            "a difference of the reference",
            Code::TableRow,
            format!("{wrench},{dq},{q}\nA,unloaded,1,2,3,4,5,6,0,0,0,0,0,0,{angles}\n"),
        ),
        ("forces without moments", Code::TableHeading, format!("fx_n,fy_n,fz_n,{q}\nA,up,1,2,3,{angles}\n")),
        (
            "a difference of one joint of six",
            Code::TableHeading,
            format!("{wrench},dq1_rad,{q}\nA,up,1,2,3,4,5,6,0,{angles}\n"),
        ),
        ("a shift along one axis", Code::TableHeading, format!("{wrench},dx_mm,{q}\nA,up,1,2,3,4,5,6,0,{angles}\n")),
        ("no angles", Code::TableHeading, format!("{wrench}\nA,up,1,2,3,4,5,6\n")),
    ];
    let read = |table: &str| read_clamped(format!("posture,state,{table}").as_bytes(), "clamped.csv", &cell, None);
    let rows = cases.iter().map(|(what, code, table)| (*what, *code, read(table)));
    insta::assert_snapshot!("refused_tables", refusals(rows));
}
