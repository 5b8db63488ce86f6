//! The catalogue of robots says of each where it comes from, and stands as its pendant shows it.

mod configuration;
mod conventions;
mod descriptions;
mod poses;
mod shapes;

use crate::common;

use common::random::Dice;
use nalgebra::{Isometry3, Matrix4, Translation3, UnitQuaternion, Vector3};
use stiffarm::model::kinematics::Frames;
use stiffarm::model::robot::{CatalogueEntry, Controller, DoubtAbout, Robot, catalogue, find_in_catalogue};
use stiffarm::units::deg_to_rad;

#[test]
fn keys_are_one_robot_each() {
    let mut keys: Vec<&str> = catalogue().iter().map(|e| e.key).collect();
    assert_eq!(keys.len(), 42);
    assert_eq!(keys[0], "comau-nj165-3.0", "the default robot");
    keys.sort_unstable();
    keys.dedup();
    assert_eq!(keys.len(), catalogue().len());
}

#[test]
fn every_entry_says_where_it_comes_from() {
    for entry in catalogue() {
        let robot = entry.robot().unwrap();
        let n = robot.joint_count();
        assert!(!entry.source.is_empty() && !entry.pendant.is_empty(), "{}", entry.key);
        assert_eq!(entry.file.is_empty(), entry.commit.is_empty(), "{}", entry.key);
        assert_eq!(entry.file.is_empty(), entry.licence.is_empty(), "{}", entry.key);
        assert!([0, n].contains(&entry.speeds_deg_s.len()), "{}", entry.key);
        assert!(entry.speeds_deg_s.iter().all(|v| *v > 0.0), "{}", entry.key);
        assert_eq!(entry.has_limits(), !robot.limits_are_unknown(), "{}", entry.key);
        assert!(robot.controller().is_some(), "{}", entry.key);
        assert_eq!(robot.doubts(), entry.doubts);
        for text in entry.doubts.iter().map(|d| d.sentence) {
            assert!(text.ends_with('.') && !text.contains("URDF"), "{}: {text}", entry.key);
        }
        for set in entry.stiffness {
            assert_eq!(set.values.len(), n, "{}", entry.key);
        }
    }
}

/// The reach stated is that of the chain: the wrist centre of the stretched arm,
/// up to how makers count it.
#[test]
fn lengths_agree_with_the_reach() {
    for entry in catalogue() {
        let (Some(reach), robot) = (entry.reach_m(), entry.robot().unwrap()) else {
            continue;
        };
        let length = robot.length();
        let within = reach < length && length < 2.2 * reach + 0.6;
        assert!(within, "{}: {reach} m of {length} m", entry.key);
    }
}

#[test]
fn numbers_of_ones_own_settle_doubts() {
    let about = |robot: &Robot| robot.doubts().iter().map(|d| d.about).collect::<Vec<_>>();
    let fanuc = Robot::from_catalogue("fanuc-m10ia").unwrap();
    assert_eq!(about(&fanuc), [DoubtAbout::Limits]);
    let limited = fanuc.clone().with_limits(&[[-1.0, 1.0]; 6]).unwrap();
    assert_eq!(about(&limited), []);
    let yaskawa = Robot::from_catalogue("motoman-mh50").unwrap();
    assert_eq!(about(&yaskawa), [DoubtAbout::Source, DoubtAbout::Angles]);
    let coupling = yaskawa.coupling().clone();
    let coupled = yaskawa.with_coupling(coupling).unwrap();
    assert_eq!(about(&coupled), [DoubtAbout::Source]);
}

#[test]
fn an_arm_has_one_entry() {
    let mut arms: Vec<&str> = catalogue().iter().map(|e| e.name).collect();
    arms.sort_unstable();
    arms.dedup();
    assert_eq!(arms.len(), catalogue().len());
}

#[test]
fn a_text_names_a_maker_where_it_names_no_other() {
    let named = |text: &str| Controller::named_in(text);
    assert_eq!(named("package://Fanuc_m10ia/x.stl fanuc"), Some(Controller::Fanuc));
    assert_eq!(named("rabbit, cabbage"), None);
    assert_eq!(named("kuka on a fanuc table"), None);
    assert_eq!(named("ur10e_base_link"), Some(Controller::Ur));
}

/// The descriptions of FANUC's arms have J3 + J2 as joint 3: C with the forearm level gives the catalogue's.
#[test]
fn the_pendants_coupling_is_found_in_the_geometry() {
    for key in ["fanuc-r2000ic165f", "abb-irb2400-12-155"] {
        let pendant = Robot::from_catalogue(key).unwrap();
        let mut described = pendant.coupling().clone();
        described[(2, 1)] = 0.0;
        let described = pendant.clone().with_coupling(described).unwrap();
        assert_eq!(described.level_forearm().as_ref(), Some(pendant.coupling()));
        assert_eq!(pendant.level_forearm(), None, "coupled already");
    }
    let panda = Robot::from_catalogue("panda").unwrap();
    assert_eq!(panda.level_forearm(), None, "axes 2 and 3 are not parallel");
}

#[test]
fn the_controllers_base_moves_with_the_robot() {
    let height = |robot: &Robot| robot.controller_base().translation.vector.z;
    let robot = Robot::from_catalogue("fanuc-r2000ic165f").unwrap();
    assert_eq!(height(&robot), 0.67);
    let placed = robot.with_base(&Isometry3::translation(0.0, 0.0, 0.5));
    assert!((height(&placed) - 1.17).abs() < 1e-15);
}

#[test]
fn a_robot_that_the_catalogue_lacks_is_told_with_the_nearest() {
    let error = find_in_catalogue("kuka-kr500-r2800").unwrap_err();
    assert_eq!(error.code().as_str(), "unknown-name");
    insta::assert_snapshot!(error, @r#"
    The catalogue has no robot "kuka-kr500-r2800".
      hint: did you mean "kuka-kr500-r2800-2"?
    "#);
    insta::assert_snapshot!(find_in_catalogue("???").unwrap_err(), @r#"
    The catalogue has no robot "???".
      hint: `stiffarm robots` lists the robots
    "#);
}

/// At KUKA's home, A2 = −90°, A3 = 90°, the upper arm is upright, the forearm
/// level, and the flange looks forward.
#[test]
fn kuka_at_home() {
    for entry in catalogue().iter().filter(|e| e.brand == "KUKA") {
        let robot = entry.robot().unwrap();
        let q = [0.0, -90.0, 90.0, 0.0, 0.0, 0.0].map(deg_to_rad);
        let frames = Frames::new(&robot, &q);
        let upper_arm = frames.origins()[2] - frames.origins()[1];
        let out = frames.flange().rotation * Vector3::z();
        assert!((upper_arm.normalize() - Vector3::z()).norm() < 3e-3, "{}", entry.key);
        assert!((out - Vector3::x()).norm() < 1e-4, "{}", entry.key);
        // A1 is positive clockwise seen from above.
        let mut turned = q;
        turned[0] = 0.5;
        let way = Frames::new(&robot, &turned).flange().translation.vector;
        assert!(way.y < -0.1, "{}: {way}", entry.key);
    }
}
