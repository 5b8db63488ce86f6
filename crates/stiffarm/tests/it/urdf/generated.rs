//! Chains of all kinds: fixed, parallel, nearly parallel, meeting, coincident and
//! oblique axes, with joints of any kind beside them.

use super::*;
use crate::common::runs::runs;
use proptest::prelude::*;

/// How the next axis lies to the one before.
#[derive(Debug, Clone, Copy)]
enum Lie {
    Any,
    Parallel,
    /// Off parallel by this many decades of a radian.
    Nearly(i32),
    Meeting,
    Same,
    Square,
}

#[derive(Debug, Clone)]
struct Spec {
    lie: Lie,
    xyz: [f64; 3],
    rpy: [f64; 3],
    axis: [f64; 3],
    is_fixed: bool,
    beside: u8,
}

fn spec() -> impl Strategy<Value = Spec> {
    let lie = prop_oneof![
        3 => Just(Lie::Any),
        2 => Just(Lie::Parallel),
        2 => (-14..-1i32).prop_map(Lie::Nearly),
        2 => Just(Lie::Meeting),
        1 => Just(Lie::Same),
        2 => Just(Lie::Square),
    ];
    let axis = prop_oneof![
        Just([0.0, 0.0, 1.0]),
        Just([0.0, -1.0, 0.0]),
        Just([1.0, 0.0, 0.0]),
        [-1.0..1.0f64, -1.0..1.0, 0.2..1.0],
    ];
    let xyz = [-1.5..1.5f64, -1.5..1.5, -1.5..1.5];
    let rpy = [-3.2..3.2f64, -3.2..3.2, -3.2..3.2];
    (lie, xyz, rpy, axis, prop::bool::weighted(0.2), 0..5u8).prop_map(|(lie, xyz, rpy, axis, is_fixed, beside)| Spec {
        lie,
        xyz,
        rpy,
        axis,
        is_fixed,
        beside,
    })
}

fn words(numbers: [f64; 3]) -> String {
    numbers.map(|v| v.to_string()).join(" ")
}

/// The URDF of a chain of links l0, l1, …
fn urdf(specs: &[Spec]) -> String {
    let mut out = "<robot name=\"chain\">\n<link name=\"l0\"/>\n".to_string();
    let mut axis = [0.0, 0.0, 1.0];
    for (i, spec) in specs.iter().enumerate() {
        let quarter = std::f64::consts::FRAC_PI_2;
        // Along the axis before.
        let along = axis.map(|v| v * spec.xyz[0]);
        let (xyz, rpy, turn_axis) = match spec.lie {
            Lie::Any => (spec.xyz, spec.rpy, spec.axis),
            Lie::Parallel => (spec.xyz, [0.0; 3], axis),
            Lie::Nearly(decade) => (spec.xyz, spec.rpy.map(|v| v * 10f64.powi(decade)), axis),
            Lie::Meeting => (along, spec.rpy, spec.axis),
            Lie::Same => (along, [0.0; 3], axis),
            Lie::Square => (spec.xyz, spec.rpy.map(|v| v.round() * quarter), [0.0, 0.0, 1.0]),
        };
        axis = turn_axis;
        let kind = match (spec.is_fixed, i % 2) {
            (true, _) => "fixed",
            (false, 0) => "revolute",
            _ => "continuous",
        };
        out += &format!(
            "<link name=\"l{}\"/>\n<joint name=\"j{i}\" type=\"{kind}\"><parent link=\"l{i}\"/><child link=\"l{}\"/>\
             <origin xyz=\"{}\" rpy=\"{}\"/><axis xyz=\"{}\"/>\
             <limit lower=\"-2.5\" upper=\"3\" effort=\"0\" velocity=\"0\"/></joint>\n",
            i + 1,
            i + 1,
            words(xyz),
            words(rpy),
            words(turn_axis)
        );
        let beside = match spec.beside {
            0 => "type=\"prismatic\"><limit lower=\"0\" upper=\"1\" effort=\"0\" velocity=\"0\"/>".to_string(),
            1 => format!("type=\"revolute\"><mimic joint=\"j{i}\" multiplier=\"-2\"/>"),
            _ => continue,
        };
        out += &format!(
            "<link name=\"x{i}\"/><joint name=\"m{i}\" {beside}<parent link=\"l{i}\"/><child link=\"x{i}\"/></joint>\n"
        );
    }
    out + "</robot>\n"
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(runs(300) as u32))]

    #[test]
    fn chains_of_any_axes_are_exact(specs in prop::collection::vec(spec(), 2..9), seed in 0..u64::MAX) {
        prop_assume!(specs.iter().any(|spec| !spec.is_fixed));
        let text = urdf(&specs);
        let ends = options("l0", &format!("l{}", specs.len()));
        let read = read_urdf(&text, "chain.urdf", &ends).unwrap();
        let worst = differences(&text, &read, &mut Dice::new(seed), 5);
        prop_assert!(worst.pose < 1e-11, "pose {:e}\n{}", worst.pose, text);
        prop_assert!(worst.jacobian < 1e-11, "Jacobian {:e}\n{}", worst.jacobian, text);
        prop_assert!(worst.cell < 1e-9, "cell {:e}\n{}", worst.cell, text);
    }
}
