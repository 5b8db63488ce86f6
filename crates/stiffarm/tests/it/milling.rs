//! Mean milling loads are the sum of all teeth over a turn, and those of cases done by hand, with their signs.

use crate::common::prelude::*;
use nalgebra::Rotation3;
use proptest::prelude::*;
use stiffarm::model::process::{CuttingCoefficients, Milling, MillingDirection, Process, TipLoad};

/// An aluminium alloy: 16 mm cutter, 3 mm deep.
fn cut(radial_depth: f64, direction: MillingDirection) -> Milling {
    Milling {
        teeth: 2,
        diameter: 0.016,
        axial_depth: 0.003,
        radial_depth,
        feed_per_tooth: 1e-4,
        direction,
        coefficients: CuttingCoefficients { k_tc: 800e6, k_rc: 200e6, k_ac: 100e6, k_te: 20e3, k_re: 25e3, k_ae: 1e3 },
    }
}

/// Force and moment at the tip, mean over a turn of the cutter: each tooth of
/// each slice of the cut, at each angle. It knows nothing of immersion angles: a
/// tooth cuts where it is in the strip of the workpiece and moves into it.
/// `lag` is the angle by which a helix has the top of the cut behind the tip.
fn brute_force(milling: &Milling, angles: usize, slices: usize, lag: f64) -> TipLoad {
    let k = &milling.coefficients;
    let radius = milling.diameter / 2.0;
    let slice = milling.axial_depth / slices as f64;
    let strip = match milling.direction {
        MillingDirection::Up => [-radius, -radius + milling.radial_depth],
        MillingDirection::Down => [radius - milling.radial_depth, radius],
    };
    let feed = Vector3::x();
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    for step in 0..angles {
        for tooth in 0..milling.teeth {
            for s in 0..slices {
                let height = (s as f64 + 0.5) * slice;
                let turn = (step as f64 + 0.5) / angles as f64 + f64::from(tooth) / f64::from(milling.teeth);
                let angle = std::f64::consts::TAU * turn - lag * height / milling.axial_depth;
                // The cutter turns positively about z, which points into the workpiece.
                let outwards = Rotation3::from_axis_angle(&Vector3::z_axis(), angle) * Vector3::x();
                let motion = Vector3::z().cross(&outwards);
                let chip = milling.feed_per_tooth * outwards.dot(&feed);
                let y = radius * outwards.y;
                if chip <= 0.0 || y < strip[0] || y > strip[1] {
                    continue;
                }
                let tangential = (k.k_tc * chip + k.k_te) * slice;
                let radial = (k.k_rc * chip + k.k_re) * slice;
                let axial = (k.k_ac * chip + k.k_ae) * slice;
                let cut = -motion * tangential - outwards * radial + Vector3::z() * axial;
                let at = outwards * radius - Vector3::z() * height;
                force += cut;
                moment += at.cross(&cut);
            }
        }
    }
    TipLoad { force: force / angles as f64, moment: moment / angles as f64, axes: ForceAxes::Path }
}

#[track_caller]
fn assert_near(load: &TipLoad, expected: &TipLoad, tolerance: f64) {
    let force = (load.force - expected.force).norm();
    let moment = (load.moment - expected.moment).norm();
    assert!(
        force <= tolerance * expected.force.norm() && moment <= tolerance * expected.moment.norm(),
        "{load:?} is not {expected:?}"
    );
    assert_eq!(load.axes, expected.axes);
}

#[test]
fn the_mean_is_that_of_all_teeth_over_a_turn() {
    use MillingDirection::{Down, Up};
    for direction in [Up, Down] {
        for (teeth, radial_depth) in [(1, 0.004), (2, 0.008), (4, 0.012), (12, 0.001), (3, 0.016)] {
            let milling = Milling { teeth, ..cut(radial_depth, direction) };
            // 12 teeth at half the diameter and more have several in the cut at once.
            let mean = milling.mean_load();
            assert_near(&mean, &brute_force(&milling, 60_000, 1, 0.0), 1e-4);
            let mut chip_only = milling;
            chip_only.coefficients.k_te = 0.0;
            chip_only.coefficients.k_re = 0.0;
            chip_only.coefficients.k_ae = 0.0;
            let expected = brute_force(&chip_only, 60_000, 1, 0.0);
            assert_near(&chip_only.mean_load(), &expected, 1e-4);
        }
    }
    let many = Milling { teeth: 12, ..cut(0.012, Up) };
    let [entry, exit] = many.immersion();
    assert!(exit - entry > 3.0 * std::f64::consts::TAU / 12.0, "more than three teeth in the cut");
    assert_near(&many.mean_load(), &brute_force(&many, 60_000, 1, 0.0), 1e-4);
}

#[test]
fn a_helix_leaves_the_mean_as_it_is() {
    let milling = cut(0.005, MillingDirection::Down);
    let helical = brute_force(&milling, 20_000, 20, 0.7);
    // Slices lump the moment of the height exactly: it is linear in it.
    assert_near(&milling.mean_load(), &helical, 1e-3);
}

#[test]
fn a_full_slot_by_hand() {
    // φ from 0 to π: ∫ sin² = π/2, ∫ sin cos = 0, ∫ sin = 2, ∫ cos = 0, ∫ 1 = π. With
    // N a/(2π) = 2 · 3 mm/(2π) and N/mm all through:
    let share = 2.0 * 3.0 / std::f64::consts::TAU;
    let (h, pi) = (0.1, PI);
    let force = share
        * Vector3::new(
            -(200.0 * h * pi / 2.0 + 25.0 * 2.0),
            -(800.0 * h * pi / 2.0 + 20.0 * 2.0),
            100.0 * h * 2.0 + pi,
        );
    let torque = -share * 8.0 * (800.0 * h * 2.0 + 20.0 * pi) * 1e-3;
    for direction in [MillingDirection::Up, MillingDirection::Down] {
        let load = cut(0.016, direction).mean_load();
        assert!((load.force - force).norm() < 1e-12 * force.norm(), "{load:?}");
        assert!((load.moment.z - torque).abs() < 1e-12 * torque.abs(), "{load:?}");
        let process = Process::Milling(cut(0.016, direction));
        assert_eq!(process.load(), load.into());
        // Half of 3 mm above the tip, and the axial force beside the axis, at +x on average.
        let tilt_x = 1.5e-3 * force.y;
        let tilt_y = -1.5e-3 * force.x - share * 8e-3 * (100.0 * h * pi / 2.0 + 2.0);
        assert!((load.moment.x - tilt_x).abs() < 1e-12, "{load:?}");
        assert!((load.moment.y - tilt_y).abs() < 1e-12, "{load:?}");
    }
}

/// Rows of docs/paths.md, from an integration of its own with 200,000 angles.
#[test]
fn the_table_of_the_guide() {
    use MillingDirection::{Down, Up};
    #[rustfmt::skip]
    let rows = [
        (2.0, Up, [-36.28, 3.38, 2.39, -0.01, 0.05, -0.26]),
        (2.0, Down, [22.40, -30.24, 2.39, -0.03, -0.04, -0.26]),
        (8.0, Up, [-91.39, -50.45, 9.55, -0.11, 0.08, -0.85]),
        (8.0, Down, [23.20, -107.75, 9.55, -0.12, -0.09, -0.85]),
        (16.0, Up, [-68.20, -158.20, 19.10, -0.24, -0.02, -1.70]),
        (16.0, Down, [-68.20, -158.20, 19.10, -0.24, -0.02, -1.70]),
    ];
    for (radial_depth_mm, direction, expected) in rows {
        let mut milling = cut(radial_depth_mm * 1e-3, direction);
        milling.coefficients.k_re = 20e3;
        milling.coefficients.k_ae = 0.0;
        let load = milling.mean_load();
        let components = load.force.iter().chain(load.moment.iter());
        for (component, expected) in components.zip(expected) {
            assert!((component - expected).abs() <= 0.005, "{load:?}");
        }
    }
}

proptest! {
    /// The spindle gives power, and that is what the teeth take: mean tangential
    /// force times speed, from the force's line of action as well as the torque.
    #[test]
    fn the_power_is_that_of_the_chip(
        radial_depth in 1e-4..0.016f64,
        feed_per_tooth in 1e-5..1e-3f64,
        up in any::<bool>(),
    ) {
        let direction = if up { MillingDirection::Up } else { MillingDirection::Down };
        let mut milling = Milling { feed_per_tooth, ..cut(radial_depth, direction) };
        let speed = 300.0;
        prop_assert!(-milling.mean_load().moment.z * speed > 0.0);
        // Without edge forces: k_tc times the volume removed per second.
        milling.coefficients.k_te = 0.0;
        let power = -milling.mean_load().moment.z * speed;
        let feed_rate = feed_per_tooth * f64::from(milling.teeth) * speed / std::f64::consts::TAU;
        let volume = feed_rate * milling.axial_depth * radial_depth;
        let expected = milling.coefficients.k_tc * volume;
        prop_assert!((power - expected).abs() < 1e-9 * expected, "{power} {expected}");
    }
}
