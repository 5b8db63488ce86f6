//! The words and numbers by which KUKA tells the postures of a pose apart; arms without a spherical wrist have none.

use stiffarm::model::pose::{Configuration, kuka_status, kuka_turn};
use stiffarm::model::robot::Robot;
use stiffarm::units::deg_to_rad;

fn kuka(degrees: [f64; 6]) -> (String, u8, u8) {
    let robot = Robot::from_catalogue("kuka-kr210-r2700-2").unwrap();
    let q = degrees.map(deg_to_rad);
    let configuration = Configuration::of(&robot, &q).unwrap();
    (configuration.words(), kuka_status(&robot, &q).unwrap(), kuka_turn(&q))
}

#[test]
fn status_and_turn_of_kuka() {
    let said = |words: &str, s, t| (words.to_string(), s, t);
    // The usual home: S 2 with A5 ≥ 0, T has the sign of A2.
    let home = kuka([0.0, -90.0, 90.0, 0.0, 0.0, 0.0]);
    assert_eq!(home, said("front, elbow up, no flip", 0b010, 0b000010));
    let bent = kuka([-10.0, -90.0, 90.0, 20.0, -30.0, -40.0]);
    assert_eq!(bent, said("front, elbow up, flip", 0b110, 0b110011));
    // Reaching backward over the shoulder.
    let back = kuka([0.0, -139.0, 0.0, 0.0, 30.0, 0.0]);
    assert_eq!(back.1 & 1, 1);
    assert!(back.0.starts_with("back"));
    // Stretched where the wrist centre lies on the line through axes 2 and 3:
    // the forearm's offset is 115 mm on 1220 mm.
    let stretched = 115_f64.atan2(1220.0).to_degrees();
    let status = |a3: f64| kuka([0.0, -60.0, a3, 0.0, 10.0, 0.0]).1;
    assert_eq!(status(stretched - 0.01), 0b000);
    assert_eq!(status(stretched + 0.01), 0b010);
}

#[test]
fn arms_without_a_spherical_wrist_have_no_words() {
    let ur = Robot::from_catalogue("ur5e").unwrap();
    assert_eq!(Configuration::of(&ur, &[0.1; 6]), None);
    assert_eq!(kuka_status(&ur, &[0.1; 6]), None);
    let panda = Robot::from_catalogue("panda").unwrap();
    assert_eq!(Configuration::of(&panda, &[0.1; 7]), None);
}
