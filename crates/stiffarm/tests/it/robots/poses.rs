//! Orientations in the makers' conventions are read, written, refused where they are none, and lead to all their postures.

use super::*;
use crate::common::cases::slip;
use proptest::prelude::*;
use stiffarm::Code;
use stiffarm::model::inverse::InverseKinematics;
use stiffarm::model::pose::{Convention, held_postures};
use stiffarm_files::table::{NamedPose, read_poses, write_poses};

/// Turns about x, y and z, written out.
fn about(axis: usize, deg: f64) -> Matrix4<f64> {
    let (s, c) = deg.to_radians().sin_cos();
    let mut m = Matrix4::identity();
    let (i, j) = [(1, 2), (2, 0), (0, 1)][axis];
    (m[(i, i)], m[(j, j)], m[(i, j)], m[(j, i)]) = (c, c, -s, s);
    m
}

fn difference(rotation: &UnitQuaternion<f64>, expected: &Matrix4<f64>) -> f64 {
    (rotation.to_homogeneous() - expected).amax()
}

fn radians(degrees: [f64; 3]) -> Vec<f64> {
    degrees.map(deg_to_rad).to_vec()
}

/// Each convention against a product of elementary turns.
#[test]
fn conventions_are_products_of_turns() {
    for [a, b, c] in [[30.0, 40.0, 50.0], [-170.0, 12.0, 95.0], [10.0, 90.0, 0.0]] {
        let numbers = radians([a, b, c]);
        let zyx = about(2, a) * about(1, b) * about(0, c);
        let kuka = Convention::Kuka.rotation(&numbers).unwrap();
        assert!(difference(&kuka, &zyx) < 1e-15, "KUKA");
        // Fixed x, then y, then z: the last turn stands in front.
        let fixed = about(2, c) * about(1, b) * about(0, a);
        for convention in [Convention::Fanuc, Convention::Yaskawa] {
            let rotation = convention.rotation(&numbers).unwrap();
            assert!(difference(&rotation, &fixed) < 1e-15, "{convention:?}");
        }
        let xyz = about(0, a) * about(1, b) * about(2, c);
        let staubli = Convention::Staubli.rotation(&numbers).unwrap();
        assert!(difference(&staubli, &xyz) < 1e-15, "Stäubli");
        let zyz = about(2, a) * about(1, b) * about(2, c);
        let comau = Convention::Comau.rotation(&numbers).unwrap();
        assert!(difference(&comau, &zyz) < 1e-15, "COMAU");
    }
    // 90° about z, then 90° about the new y: a third of a turn about (−1, 1, 1).
    let turned = Convention::Kuka.rotation(&radians([90.0, 90.0, 0.0])).unwrap();
    let third = 2.0 * std::f64::consts::FRAC_PI_3 / 3_f64.sqrt();
    let vector = Convention::Ur.numbers(&turned);
    for (component, expected) in vector.iter().zip([-third, third, third]) {
        assert!((component - expected).abs() < 1e-15, "{vector:?}");
    }
    let quaternion = Convention::Abb.numbers(&turned);
    for (component, expected) in quaternion.iter().zip([0.5, -0.5, 0.5, 0.5]) {
        assert!((component - expected).abs() < 1e-15, "{quaternion:?}");
    }
}

/// COMAU's second turn is never negative; where it is none or half a turn the first takes all.
#[test]
fn comau_shows_euler_angles() {
    for (typed, shown) in [
        ([10.0, 30.0, -20.0], [10.0, 30.0, -20.0]),
        ([10.0, -30.0, -20.0], [-170.0, 30.0, 160.0]),
        ([10.0, 0.0, -40.0], [-30.0, 0.0, 0.0]),
        ([10.0, 180.0, -40.0], [50.0, 180.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        ([180.0, 90.0, 180.0], [180.0, 90.0, 180.0]),
    ] {
        let rotation = Convention::Comau.rotation(&radians(typed)).unwrap();
        let numbers = Convention::Comau.shown(&rotation);
        let off = numbers.iter().zip(shown).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-9, "{typed:?}: {numbers:?}");
    }
    let comau = Robot::from_catalogue("comau-nj165-3.0").unwrap();
    assert_eq!(Convention::of(comau.controller()), Convention::Comau);
}

/// What makers' pendants show at well-known postures.
#[test]
fn poses_of_known_postures() {
    let shown = |key: &str, degrees: [f64; 6]| {
        let robot = Robot::from_catalogue(key).unwrap();
        let flange = *Frames::new(&robot, &degrees.map(deg_to_rad)).flange();
        let pose = robot.controller_base().inverse() * flange;
        let numbers = Convention::of(robot.controller()).shown(&pose.rotation);
        let mm = pose.translation.vector.map(|v| (v * 1e6).round() / 1e3);
        let numbers: Vec<f64> = numbers.iter().map(|v| (v * 1e6).round() / 1e6 + 0.0).collect();
        (mm.map(|v| v + 0.0).as_slice().to_vec(), numbers)
    };
    // KUKA at home: X = a1 + d4 + d6, Z = 645 + 1150 + 115.
    let (at, abc) = shown("kuka-kr210-r2700-2", [0.0, -90.0, 90.0, 0.0, 0.0, 0.0]);
    assert_eq!(at, [1765.0, 0.0, 1910.0]);
    assert_eq!(abc, [0.0, 90.0, 0.0]);
    // FANUC with all angles zero: W 180, P −90, R 0, heights from axis 2.
    let (at, wpr) = shown("fanuc-m10ia", [0.0; 6]);
    assert_eq!(at, [890.0, 0.0, 800.0]);
    assert_eq!(wpr, [180.0, -90.0, 0.0]);
    // ABB with all angles zero: z forward.
    let (at, q) = shown("abb-irb120-3-58", [0.0; 6]);
    assert_eq!(at, [374.0, 0.0, 630.0]);
    let half = (0.5_f64.sqrt() * 1e6).round() / 1e6;
    assert_eq!(q, [half, 0.0, half, 0.0]);
    // Universal Robots count from a base turned by half a turn.
    let (at, _) = shown("ur5e", [0.0; 6]);
    assert_eq!(at, [-817.2, -232.9, 62.8]);
}

fn rotation() -> impl Strategy<Value = UnitQuaternion<f64>> {
    let angle = -3.2..3.2_f64;
    // Quarter and half turns, and near them, where angles run into each other.
    let special = (0..8_i32, 0..8_i32, 0..8_i32, -1e-7..1e-7_f64).prop_map(|(a, b, c, off)| {
        let turn = |k: i32| f64::from(k) * std::f64::consts::FRAC_PI_4;
        UnitQuaternion::from_euler_angles(turn(a), turn(b) + off, turn(c))
    });
    prop_oneof![
        (angle.clone(), angle.clone(), angle).prop_map(|(a, b, c)| UnitQuaternion::from_euler_angles(a, b, c)),
        special,
    ]
}

proptest! {
    #[test]
    fn every_convention_gives_its_rotation_back(rotation in rotation()) {
        for convention in Convention::ALL {
            let numbers = convention.numbers(&rotation);
            prop_assert_eq!(numbers.len(), convention.columns().len());
            let back = convention.rotation(&numbers).unwrap();
            let off = (back.to_rotation_matrix().into_inner() - rotation.to_rotation_matrix().into_inner()).amax();
            prop_assert!(off < 1e-9, "{:?}: {off:e} by {numbers:?}", convention);
            for (column, value) in convention.columns().iter().zip(convention.shown(&rotation)) {
                let half_turn = column.ends_with("_deg");
                prop_assert!(!half_turn || (-180.0..=180.0 + 1e-9).contains(&value));
            }
        }
    }

    #[test]
    fn written_poses_are_read_back(rotation in rotation(), x in -4.0..4.0_f64) {
        let pose = Isometry3::from_parts(Translation3::new(x, -x, 0.5 * x), rotation);
        let named = [NamedPose { name: "a,b".to_string(), pose }];
        for convention in Convention::ALL {
            let text = write_poses(&named, convention);
            let read = read_poses(text.as_bytes(), "poses.csv", convention).unwrap();
            prop_assert_eq!(&read[0].name, "a,b");
            let off = (read[0].pose.to_homogeneous() - pose.to_homogeneous()).amax();
            prop_assert!(off < 1e-8, "{:?}: {off:e}", convention);
        }
    }
}

#[test]
fn numbers_that_are_no_orientation_are_refused() {
    let mirrored = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0];
    let mut report = String::new();
    for (convention, numbers, code) in [
        (Convention::Kuka, &[0.0; 2][..], Code::Dimension),
        (Convention::Ur, &[f64::NAN, 0.0, 0.0], Code::NotFinite),
        (Convention::Abb, &[0.7, 0.0, 0.0, 0.0], Code::InvalidValue),
        (Convention::Matrix, &mirrored, Code::InvalidValue),
        (Convention::Matrix, &[1.0; 9], Code::InvalidValue),
    ] {
        let error = convention.rotation(numbers).unwrap_err();
        assert_eq!(error.code(), code, "{convention:?} {numbers:?}: {error}");
        report += &slip::<()>(&format!("{convention:?} {numbers:?}"), Err(error));
    }
    insta::assert_snapshot!(report, @"
    » Kuka [0.0, 0.0]
    [dimension] An orientation has 3 numbers, got 2.

    » Ur [NaN, 0.0, 0.0]
    [not-finite] An orientation has a number that is not finite.

    » Abb [0.7, 0.0, 0.0, 0.0]
    [invalid-value] The quaternion has length 0.7000; it must be 1.
      hint: q1 is the scalar; look for a number in a wrong column

    » Matrix [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0]
    [invalid-value] The matrix is not a rotation: its axes are left-handed.
      hint: r11, r12, r13 are the first row; the columns are the axes of the frame

    » Matrix [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    [invalid-value] The matrix is not a rotation: its columns are not at right angles and of length 1.
      hint: r11, r12, r13 are the first row; the columns are the axes of the frame
    ");
    // What a pendant rounds is taken.
    assert!(Convention::Abb.rotation(&[0.866, 0.0, 0.5, 0.0]).is_ok());
}

#[test]
fn tables_of_poses_are_read_with_their_units() {
    let read = |text: &str, convention| read_poses(text.as_bytes(), "p.csv", convention);
    let metres = read("x_m,y_m,z_m,rx_deg,ry_deg,rz_deg\n1,2,3,0,0,90\n", Convention::Ur).unwrap();
    assert_eq!(metres[0].name, "P1");
    assert_eq!(metres[0].pose.translation.vector, Vector3::new(1.0, 2.0, 3.0));
    assert!((metres[0].pose.rotation.angle() - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    let error = |text: &str| read(text, Convention::Kuka).unwrap_err();
    let missing = error("x_mm,y_mm,z_mm,a_deg,b_deg\n1,2,3,0,0\n");
    assert_eq!(missing.message(), "The column c_deg is missing.");
    let twice = error("posture,x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\nA,1,2,3,0,0,0\nA,1,2,3,0,0,0\n");
    assert_eq!(twice.code(), Code::Duplicate);
    let wrong = read("x_mm,y_mm,z_mm,q1,q2,q3,q4\n1,2,3,0,0,0,0\n", Convention::Abb).unwrap_err();
    assert_eq!(wrong.place().line, Some(2));
}

/// Every posture within the limits, full turns included, holds the pose, and the
/// one that the pose was made of is among them.
#[test]
fn all_postures_of_a_pose() {
    for key in ["kuka-kr210-r2700-2", "fanuc-m10ia", "staubli-rx160", "abb-irb4400l-30-243", "ur10e"] {
        let robot = Robot::from_catalogue(key).unwrap();
        let inverse = InverseKinematics::new(&robot);
        let mut dice = Dice::new(4);
        for _ in 0..20 {
            let limits = robot.joints().iter().map(|j| j.limits);
            let q: Vec<f64> = limits.map(|[low, high]| dice.between(low, high)).collect();
            let pose = *Frames::new(&robot, &q).flange();
            let held = held_postures(&inverse, &pose).unwrap();
            let mut matching = 0;
            for other in held.iter().flat_map(|h| &h.turns) {
                assert_eq!(robot.outside_limits(other), None);
                let reached = Frames::new(&robot, other).flange().to_homogeneous();
                assert!((reached - pose.to_homogeneous()).amax() < 1e-8, "{key}");
                let apart = other.iter().zip(&q).map(|(a, b)| (a - b).abs());
                matching += usize::from(apart.fold(0.0, f64::max) < 1e-6);
            }
            assert_eq!(matching, 1, "{key}: {q:?}");
        }
    }
}

#[test]
fn a_pose_without_a_posture_says_why() {
    let robot = Robot::from_catalogue("kuka-kr210-r2700-2").unwrap();
    let inverse = InverseKinematics::new(&robot);
    let error = held_postures(&inverse, &Isometry3::translation(9.0, 0.0, 1.0)).unwrap_err();
    assert_eq!(error.code(), Code::Unreachable);
    let narrow = robot.with_limits(&[[0.1, 0.2]; 6]).unwrap();
    let pose = *Frames::new(&narrow, &[1.0, -1.0, 1.0, 0.0, 0.5, 0.0]).flange();
    let error = held_postures(&InverseKinematics::new(&narrow), &pose).unwrap_err();
    assert_eq!(error.code(), Code::OutsideLimits);
    let nowhere = Isometry3::translation(f64::NAN, 0.0, 0.0);
    assert!(held_postures(&inverse, &nowhere).is_err());
}
