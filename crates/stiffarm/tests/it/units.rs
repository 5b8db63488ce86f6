//! Units are told by the end of a name, and numbers that are round in degrees and millimetres stay round in JSON.

use nalgebra::UnitQuaternion;
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;
use stiffarm::units::{Sense, deg_to_rad, degrees, m_to_shortest_mm, mm_to_m, rad_to_shortest_deg, roll_pitch_yaw};
use stiffarm_files::internals::fixed;

#[test]
fn angles_are_degrees_in_json_only() {
    #[derive(serde::Serialize, serde::Deserialize, PartialEq, Debug)]
    struct Record {
        #[serde(rename = "q_deg", with = "degrees")]
        q: Vec<Vec<f64>>,
        #[serde(rename = "held_deg", with = "degrees")]
        held: [Option<f64>; 2],
        #[serde(rename = "turn_deg", with = "degrees::all_digits")]
        turn: f64,
    }
    let record = Record {
        q: vec![vec![deg_to_rad(15.0), deg_to_rad(-72.81)]],
        held: [None, Some(deg_to_rad(45.0))],
        turn: deg_to_rad(15.0),
    };
    let text = serde_json::to_string(&record).unwrap();
    let expected = r#"{"q_deg":[[15.0,-72.81]],"held_deg":[null,45.0],"turn_deg":14.999999999999998}"#;
    assert_eq!(text, expected);
    let read: Record = serde_json::from_str(&text).unwrap();
    assert_eq!((&read.q, read.held), (&record.q, record.held));
}

#[test]
fn round_numbers_stay_round() {
    for deg in [15.0, -30.0, 0.1, 72.81, -272.36, 179.999, 0.0, -0.0] {
        assert_eq!(rad_to_shortest_deg(deg_to_rad(deg)), deg);
    }
    for mm in [773.0, 0.2, 1444.0, -0.123456] {
        assert_eq!(m_to_shortest_mm(mm_to_m(mm)), mm);
    }
    assert_eq!(mm_to_m(773.0), 0.773);
    assert!(rad_to_shortest_deg(-0.0).is_sign_positive());
}

proptest! {
    #[test]
    fn roll_pitch_yaw_give_the_rotation_back(
        roll in -3.1..3.1f64,
        pitch in prop_oneof![-1.57..1.57f64, Just(FRAC_PI_2), Just(-FRAC_PI_2), Just(FRAC_PI_2 - 1e-9)],
        yaw in -3.1..3.1f64,
    ) {
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let [r, p, y] = roll_pitch_yaw(&rotation);
        let back = UnitQuaternion::from_euler_angles(r, p, y);
        prop_assert!(back.angle_to(&rotation) < 1e-14, "{}", back.angle_to(&rotation));
    }

    #[test]
    fn what_was_written_is_read_and_written_again(rad in -13.0..13.0f64, m in -10.0..10.0f64) {
        let deg = rad_to_shortest_deg(rad);
        let read = deg_to_rad(deg);
        prop_assert!((read - rad).abs() <= 2.0 * f64::EPSILON * rad.abs());
        prop_assert_eq!(rad_to_shortest_deg(read), deg);
        let mm = m_to_shortest_mm(m);
        let read = mm_to_m(mm);
        prop_assert!((read - m).abs() <= 2.0 * f64::EPSILON * m.abs());
        prop_assert_eq!(m_to_shortest_mm(read), mm);
    }

    #[test]
    fn fixed_decimals_are_those_of_the_standard_library_without_minus_zero(
        value in prop_oneof![
            -1e4..1e4f64,
            -1e-5..1e-5f64,
            -1e14..1e14f64,
            // The middle between two, and a bit beside it.
            (-200_000i32..200_000, -2i32..3).prop_map(|(n, bits)| {
                let middle: f64 = f64::from(n) / 2e3;
                f64::from_bits(middle.to_bits().saturating_add_signed(i64::from(bits)))
            }),
        ],
        decimals in 0usize..9,
    ) {
        prop_assume!(value.is_finite());
        let text = format!("{value:.decimals$}");
        let is_zero = !text.bytes().any(|b| (b'1'..=b'9').contains(&b));
        let expected = if is_zero { text.trim_start_matches('-') } else { &text };
        prop_assert_eq!(fixed(value, decimals), expected);
    }

    #[test]
    fn degrees_and_millimetres_of_few_digits_stay(thousandths in -720_000i32..720_000) {
        let number = f64::from(thousandths) / 1e3;
        prop_assert_eq!(rad_to_shortest_deg(deg_to_rad(number)), number);
        prop_assert_eq!(m_to_shortest_mm(mm_to_m(number)), number);
    }
}

#[test]
fn a_name_ends_in_its_unit() {
    let names = [
        "robot.limits_deg[2][1]",
        "task[1].force_n",
        "--force-n",
        "fx_n",
        "stiffness.prior_nm_per_rad[3]",
        "work.milling.axial_depth_mm",
        "x_m",
        "--levels",
    ];
    let refused = names.map(|name| format!("{name}: {}", Sense::of(name).unwrap().refuse(1e200).unwrap()));
    insta::assert_snapshot!(refused.join("\n"), @"
    robot.limits_deg[2][1]: An angle of 1e200° cannot be meant: it must be below 36000°.
    task[1].force_n: A force of 1e200 N cannot be meant: it must be below 1000000 N.
    --force-n: A force of 1e200 N cannot be meant: it must be below 1000000 N.
    fx_n: A force of 1e200 N cannot be meant: it must be below 1000000 N.
    stiffness.prior_nm_per_rad[3]: A stiffness of 1e200 N·m/rad cannot be meant: it must be below 1e15 N·m/rad.
    work.milling.axial_depth_mm: A depth of cut of 1e200 mm cannot be meant: it must be below 1000 mm.
    x_m: A length of 1e200 m cannot be meant: it must be below 1000 m.
    --levels: A factor on the variance of 1e200 cannot be meant: it must be below 1000000.
    ");
    assert!(Sense::of("robot.theta_from_q[1][2]").is_none());
    assert!(Sense::of("robot.down").is_none());
}

#[test]
fn what_cannot_be_meant_is_said_with_its_unit() {
    let said = |name: &str, value: f64| Sense::of(name).unwrap().refuse(value);
    assert_eq!(
        said("force_n", 2e11).as_deref(),
        Some("A force of 2e11 N cannot be meant: it must be below 1000000 N.")
    );
    assert_eq!(said("q_deg", -4e4).as_deref(), Some("An angle of -40000° cannot be meant: it must be below 36000°."));
    assert_eq!(said("force_n", 2e5), None);
    assert!(said("load_uncertainty_percent", 1e4).is_some());
}
