//! A search's penalty on a whole group sees the same violations as the limits of each posture, with its derivatives.

use super::*;
use crate::common::differences::assert_gradient;
use stiffarm::internals::{Kernel, KernelRequest, Lanes, WIDTH, sin_cos};

const WANTED: KernelRequest<'_> = KernelRequest { dexterity: None, information: None, limits: true };

/// A kernel with the penalty of `group` at which limits push before they are crossed.
fn pushing(cell: &Cell, flat: &[f64]) -> Kernel {
    let mut kernel = Kernel::new(cell, WANTED, flat.len() / 6).unwrap();
    kernel.reset_penalty(40.0, 1e-3);
    kernel.forward(flat);
    kernel.update_multipliers();
    kernel.set_penalty_weight(25.0);
    kernel
}

fn largest(gradient: &[f64]) -> f64 {
    gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs()))
}

#[test]
fn the_search_sees_the_same_violations() {
    let plain = builtin::cell("comau").unwrap();
    let group: Vec<_> = (0..7).map(|p| angles(6, p)).collect();
    let shapes = shapes_cell();
    let spread = postures(&shapes, 9);
    for (cell, group) in [(plain, group), (shapes, spread)] {
        let mut kernel = Kernel::new(&cell, WANTED, group.len()).unwrap();
        kernel.forward(&group.concat());
        let violations: Vec<f64> = kernel.violations().collect();
        for (q, violation) in group.iter().zip(&violations) {
            let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
            let smallest = cell.margins().smallest(&terms).unwrap().margin;
            assert!((violation - (-smallest).max(0.0)).abs() < 1e-12, "{violation} {smallest}");
            assert!((cell.margins().least(&terms) < 0.0) == (smallest < 0.0));
        }
        assert!(violations.iter().any(|v| *v > 0.1));
        assert_eq!(kernel.violation(), largest(&violations));
    }
}

#[test]
fn the_penalty_has_its_derivative() {
    let text = SHAPES.replace("[limits]", "[limits]\ndisplacement_mm = [1.2, 1.3]");
    let shapes = parse_cell(&text, "cell.toml").unwrap();
    assert!(shapes.scene.displacement().is_some());
    let spread = postures(&shapes, 5);
    let plain = builtin::cell("comau").unwrap();
    let group: Vec<_> = (0..5).map(|p| angles(6, p)).collect();
    for (cell, group, step, tolerance) in [(plain, group, 2e-4, 1e-7), (shapes, spread, 2e-6, 1e-5)] {
        let flat = group.concat();
        let mut kernel = pushing(&cell, &flat);
        let mut gradient = vec![0.0; flat.len()];
        kernel.forward(&flat);
        kernel.reverse(&mut gradient);
        assert!(largest(&gradient) > 1.0);
        let value = |q: &[f64]| {
            kernel.forward(q);
            kernel.penalty()
        };
        assert_gradient("angle", &gradient, &flat, value, step, tolerance);
    }
}

/// Displacements and torques, which a load that is moved changes.
#[test]
fn the_penalty_has_its_derivative_by_the_load() {
    let with_torque = |cell: Cell| {
        let mut torque = cell.scene.torque().unwrap().clone();
        torque.largest.fill(100.0);
        with_scene(cell, SceneParts { torque: Some(torque), ..SceneParts::default() })
    };
    let cells = loaded_cells();
    let cells = cells.into_iter().flat_map(|cell| [with_displacement(cell.clone()), with_torque(cell)]);
    for cell in cells {
        let flat: Vec<f64> = (0..6).flat_map(|p| angles(6, p)).collect();
        let mut kernel = pushing(&cell, &flat);
        kernel.forward(&flat);
        kernel.reverse(&mut vec![0.0; flat.len()]);
        let (by_anchor, by_point) = kernel.load_gradient();
        let (anchor, point) = (Vector3::new(1.8, -0.4, 0.1), cell.setup.tool.loading_point);
        let gradient = [by_anchor, by_point].concat();
        assert!(largest(&gradient) > 1e-3);
        let value = |load: &[f64]| {
            kernel.set_anchor([load[0], load[1], load[2]]);
            kernel.set_loading_point([load[3], load[4], load[5]]);
            kernel.forward(&flat);
            kernel.penalty()
        };
        let at = [anchor.as_slice(), point.as_slice()].concat();
        let what = format!("{:?}", cell.setup.load);
        assert_gradient(&what, &gradient, &at, value, 2e-4, 1e-7);
    }
}

#[test]
fn multipliers_settle_where_the_margin_is_zero_or_the_multiplier() {
    let cell = builtin::cell("comau").unwrap();
    let mut kernel = Kernel::new(&cell, WANTED, 1).unwrap();
    kernel.reset_penalty(10.0, 0.0);
    kernel.forward(&angles(6, 0));
    let crossed = kernel.violation();
    assert!(crossed > 0.0);
    assert!((kernel.update_multipliers() - crossed).abs() < 1e-12);
}

#[test]
fn what_is_remembered_changes_nothing() {
    let cell = shapes_cell();
    let group = postures(&cell, 6);
    let mut flat: Vec<f64> = group.concat();
    let mut kernel = Kernel::new(&cell, WANTED, group.len()).unwrap();
    kernel.reset_penalty(40.0, 1e-3);
    let mut gradients = [vec![0.0; flat.len()], vec![0.0; flat.len()]];
    for step in 0..300 {
        for (i, q) in flat.iter_mut().enumerate() {
            *q += 0.05 * (0.7 * step as f64 + 1.9 * i as f64).sin();
        }
        kernel.forward(&flat);
        kernel.reverse(&mut gradients[0]);
        let mut fresh = Kernel::new(&cell, WANTED, group.len()).unwrap();
        fresh.reset_penalty(40.0, 1e-3);
        fresh.forward(&flat);
        fresh.reverse(&mut gradients[1]);
        assert_eq!(kernel.penalty(), fresh.penalty());
        assert_eq!(kernel.violation(), fresh.violation());
        assert_eq!(gradients[0], gradients[1]);
    }
}

#[test]
fn sine_and_cosine_are_those_of_the_standard_library() {
    let mut x = -40.0;
    while x < 40.0 {
        let lanes = Lanes(std::array::from_fn(|i| x + 0.1 * i as f64));
        let (sin, cos) = sin_cos(lanes);
        for i in 0..WIDTH {
            let (s, c) = lanes.0[i].sin_cos();
            assert!((sin.0[i] - s).abs() <= 1.2e-16, "sin {}", lanes.0[i]);
            assert!((cos.0[i] - c).abs() <= 1.2e-16, "cos {}", lanes.0[i]);
        }
        x += 0.007_31;
    }
    for special in [0.0, std::f64::consts::FRAC_PI_2, -std::f64::consts::PI, 1e7] {
        let (sin, cos) = sin_cos(Lanes::splat(special));
        assert!((sin.0[0] - special.sin()).abs() <= 1.2e-16);
        assert!((cos.0[0] - special.cos()).abs() <= 1.2e-16);
    }
    assert!(sin_cos(Lanes::splat(f64::NAN)).0.0[0].is_nan());
}
