//! Margins of a cell's limits are as many as its limits, and their derivatives those of differences.

mod kernel;

use crate::common::prelude::*;
use std::collections::BTreeMap;
use stiffarm::model::cell::Slopes;
use stiffarm::model::scene::{DisplacementLimits, SceneParts};
use stiffarm::model::tool::{NamedPoint, Tool};

const SHAPES: &str = include_str!("../../cells/comau-shapes.toml");

/// The default cell with everything a scene can ask.
fn shapes_cell() -> Cell {
    parse_cell(SHAPES, "cell.toml").unwrap()
}

/// Postures spread over the bounds.
fn postures(cell: &Cell, count: usize) -> Vec<Vec<f64>> {
    let angle = |p: usize, j: usize, b: &[f64; 2]| {
        let share = 0.5 + 0.5 * (1.7 * p as f64 + 2.3 * j as f64).sin();
        b[0] + share * (b[1] - b[0])
    };
    let posture = |p: usize| {
        let bounds = cell.bounds.iter().enumerate();
        bounds.map(|(j, b)| angle(p, j, b)).collect()
    };
    (0..count).map(posture).collect()
}

/// Angles of `n` joints all round.
fn angles(n: usize, posture: usize) -> Vec<f64> {
    let angle = |j: usize| (1.3 * posture as f64 + 0.7 * j as f64).sin() * 2.0;
    (0..n).map(angle).collect()
}

/// Margins and their derivatives by the serial angles `theta`.
fn at(cell: &Cell, theta: &[f64]) -> (Vec<f64>, Vec<f64>) {
    some(cell, theta, |_| true)
}

/// The same with not a number for derivatives that are not wanted.
fn some(cell: &Cell, theta: &[f64], is_wanted: fn(usize) -> bool) -> (Vec<f64>, Vec<f64>) {
    let mut margins = cell.posture_margins().unwrap();
    let theta = DVector::from_column_slice(theta);
    let q = cell.setup.robot.controller_angles(&theta).unwrap();
    let (mut values, mut gradients) = (vec![f64::NAN; margins.count()], vec![f64::NAN; margins.count() * theta.len()]);
    let slopes = Slopes { rows: &mut gradients, wanted: &(0..margins.count()).map(is_wanted).collect::<Vec<_>>() };
    margins.evaluate(q.as_slice(), f64::INFINITY, &mut values, slopes).unwrap();
    (values, gradients)
}

/// Calls `each` with number and joint of a margin, its derivative by the serial angle, and by
/// central differences over `step` and half of it.
fn compare(cell: &Cell, theta: &[f64], step: f64, mut each: impl FnMut(usize, usize, f64, [f64; 2])) {
    let n = theta.len();
    let (values, gradients) = at(cell, theta);
    for k in 0..n {
        let difference = |step: f64| -> Vec<f64> {
            let moved = |by: f64| {
                let mut theta = theta.to_vec();
                theta[k] += by;
                at(cell, &theta).0
            };
            let (after, before) = (moved(step), moved(-step));
            let both = after.iter().zip(&before);
            both.map(|(a, b)| (a - b) / (2.0 * step)).collect()
        };
        let (coarse, fine) = (difference(step), difference(step / 2.0));
        for l in 0..values.len() {
            each(l, k, gradients[l * n + k], [coarse[l], fine[l]]);
        }
    }
}

/// Without the error of order h² (Richardson).
fn extrapolated([coarse, fine]: [f64; 2]) -> f64 {
    (4.0 * fine - coarse) / 3.0
}

/// A tilted and shifted arm of `n` joints with general twists and a rope, with every limit on
/// points.
fn bent(n: usize) -> Cell {
    let rows: Vec<DhRow> = (0..n)
        .map(|i| {
            let i = i as f64;
            DhRow { alpha: 0.9 - 0.4 * i, a: 0.3 + 0.1 * i, d: 0.2 * i - 0.3, offset: 0.5 * i }
        })
        .collect();
    let base =
        Isometry3::from_parts(Translation3::new(0.2, -0.1, 0.4), UnitQuaternion::from_euler_angles(0.3, -0.2, 0.5));
    let point = |name: &str, position| NamedPoint { name: name.to_string(), position };
    let tool = Tool {
        loading_point: Vector3::new(0.2, -0.1, 0.25),
        measuring_points: vec![point("a", Vector3::new(0.1, 0.2, 0.3)), point("b", Vector3::new(-0.2, 0.0, 0.1))],
        has_sensor: false,
        series_compliance: None,
    };
    let load = Load::Rope { anchor: Vector3::new(1.8, -0.4, 0.1), magnitude: 500.0 };
    let robot = Robot::from_dh("bent", DhConvention::Modified, &rows, base).unwrap();
    let mut cell = Cell::new("bent", robot, tool, load);
    cell.bounds = vec![[-PI, PI]; n];
    cell.limits = Limits {
        tool_box: Some([Vector3::new(-1.0, -1.1, -0.7), Vector3::new(1.2, 1.3, 1.4)]),
        floor: Some(-0.2),
        keep_out_radius: Some(0.35),
        wrist_height: Some(0.15),
        rope_length: Some([0.8, 3.4]),
    };
    cell
}

#[test]
fn derivatives_of_limits_on_points_are_those_of_differences() {
    for n in [2, 5, 6, 7] {
        let cell = bent(n);
        // 6 box sides, floor and cylinder of 4 points; cylinder and height of the wrist; rope.
        assert_eq!(cell.posture_margins().unwrap().count(), 4 * 8 + 2 + 2);
        for posture in 0..6 {
            compare(&cell, &angles(n, posture), 2e-3, |l, k, ours, differences| {
                let expected = extrapolated(differences);
                assert!((ours - expected).abs() < 1e-8, "n {n} margin {l} joint {k}: {ours} {expected}");
            });
        }
    }
}

#[test]
fn derivatives_come_where_they_are_wanted() {
    for cell in loaded_cells().into_iter().chain([shapes_cell(), bent(7)]) {
        let n = cell.setup.robot.joint_count();
        let theta = angles(n, 1);
        let (values, all) = at(&cell, &theta);
        let (same, third) = some(&cell, &theta, |margin| margin % 3 == 1);
        assert_eq!(same, values);
        for (margin, (chosen, all)) in third.chunks(n).zip(all.chunks(n)).enumerate() {
            if margin % 3 == 1 { assert_eq!(chosen, all) } else { assert!(chosen.iter().all(|slope| slope.is_nan())) }
        }
        // Rows for some margins, and not a word on the others.
        let mut margins = cell.posture_margins().unwrap();
        let slopes = Slopes { rows: &mut vec![0.0; n], wanted: &[true] };
        let mut values = vec![0.0; margins.count()];
        let error = margins.evaluate(&vec![0.1; n], 1.0, &mut values, slopes);
        assert_eq!(error.unwrap_err().code(), Code::Dimension);
    }
}

/// Their values: `feasible/compare.rs`.
#[test]
fn margins_are_as_many_as_limits_and_none_without() {
    let cell = bent(6);
    let terms = PostureTerms::new(&cell.setup, &[0.3, -0.4, 0.2, 0.9, -0.5, 0.1], None).unwrap();
    let mut all = cell.margins();
    let margins = all.named(&terms);
    assert_eq!(margins.len(), all.count());
    // The wrist centre is no tool point: it may leave the box.
    let mut boxed = margins.iter().filter(|m| m.kind == LimitKind::ToolBox);
    assert!(boxed.all(|m| m.point != "wrist centre"));
    let smallest = all.smallest(&terms).unwrap();
    assert!(margins.iter().all(|m| m.margin >= smallest.margin));
    let none = changed(cell.clone(), |cell| cell.limits = Limits::default());
    assert!(none.margins().smallest(&terms).is_none());
    // A load without a rope has no limits of one.
    let hung = changed(cell.clone(), |cell| cell.setup.load = hanging(500.0));
    assert_eq!(hung.margins().named(&terms).len(), margins.len() - 2);
    assert_eq!(hung.margins().count(), margins.len() - 2);
}

#[test]
fn derivatives_of_a_scene_are_those_of_differences() {
    let cell = shapes_cell();
    let mut compared = BTreeMap::new();
    for q in postures(&cell, 40) {
        let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
        let named = cell.margins().named(&terms);
        let theta = cell.setup.robot.serial_angles(&q);
        let values = at(&cell, theta.as_slice()).0;
        assert_eq!(named.len(), values.len());
        compare(&cell, theta.as_slice(), 2e-5, |l, k, ours, differences| {
            // Where the nearest feature changes within the step, differences say nothing.
            let [coarse, fine] = differences;
            if !values[l].is_finite() || (fine - coarse).abs() > 1e-6 {
                return;
            }
            let expected = extrapolated(differences);
            assert!(
                (ours - expected).abs() < 2e-7 * (1.0 + expected.abs()),
                "{:?} of {}, joint {k}: {ours} {expected} at {}",
                named[l].kind,
                named[l].point,
                values[l]
            );
            *compared.entry(format!("{:?}", named[l].kind)).or_insert(0) += usize::from(ours != 0.0);
        });
    }
    // Displacements have a test of their own.
    for kind in &LimitKind::ALL[5..11] {
        let count = compared.get(&format!("{kind:?}")).copied().unwrap_or(0);
        assert!(count > 50, "{kind:?}: {count}");
    }
}

/// The default cell under each kind of load, joints as springs and mixed.
fn loaded_cells() -> Vec<Cell> {
    let anchor = Vector3::new(1.8, -0.4, 0.1);
    let wrench = Wrench { force: Vector3::new(300.0, -200.0, 400.0), moment: Vector3::new(50.0, 80.0, -60.0) };
    let rope = |magnitude| Load::Rope { anchor, magnitude };
    let constant = |axes| Load::Constant { wrench, axes };
    let loads = [rope(500.0), rope(-500.0), hanging(500.0), constant(Axes::Base), constant(Axes::Tool)];
    let mixing = DMatrix::from_fn(6, 6, |i, j| if i == j { 1.0 } else { 0.2 * ((3 * i + j) as f64).sin() });
    let mut out = Vec::new();
    for load in loads {
        for mixed in [false, true] {
            let mut cell = shapes_cell();
            cell.setup.load = load.clone();
            if mixed {
                let robot = cell.setup.robot.clone();
                cell.setup.robot = robot.with_elastic_coordinates(mixing.clone()).unwrap();
            }
            out.push(cell);
        }
    }
    out
}

/// The cell with this alone in its scene, and without limits on points.
fn with_scene(mut cell: Cell, parts: SceneParts) -> Cell {
    cell.limits = Limits::default();
    cell.scene = parts.build(&cell.setup.robot, &cell.bounds).unwrap();
    cell
}

/// The cell with limits on the displacement that some postures violate.
fn with_displacement(cell: Cell) -> Cell {
    let prior = cell.require_prior().unwrap();
    let parts = SceneParts {
        displacement: Some(DisplacementLimits {
            smallest: Some(4e-4),
            largest: Some(1.2e-3),
            compliance: joint_compliance(&cell.setup.robot, prior).unwrap(),
        }),
        ..SceneParts::default()
    };
    with_scene(cell, parts)
}

#[test]
fn margins_of_displacements_are_those_of_the_linear_model() {
    for cell in loaded_cells().into_iter().map(with_displacement) {
        let springs = compliance_of(cell.prior.as_ref().unwrap());
        for posture in 0..8 {
            let q = angles(6, posture);
            let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
            // Ψ diag(1/k) 1: Eq. (7) by the columns of the springs.
            let moved = terms.block(&cell.setup.robot) * &springs;
            let rms = (moved.norm_squared() / cell.setup.tool.point_count() as f64).sqrt();
            let named = cell.margins().named(&terms);
            let margins: Vec<f64> = named.iter().map(|m| m.margin).collect();
            assert!(named.iter().all(|m| m.point == "measuring points"));
            assert_eq!(margins.len(), 2);
            assert!((margins[0] - (rms - 4e-4)).abs() < 1e-15);
            assert!((margins[1] - (1.2e-3 - rms)).abs() < 1e-15);
            let inside = (4e-4..=1.2e-3).contains(&rms);
            assert_eq!(cell.margins().least(&terms) >= 0.0, inside);
        }
    }
}

#[test]
fn derivatives_of_displacements_are_those_of_differences() {
    for cell in loaded_cells().into_iter().map(with_displacement) {
        assert_eq!(cell.posture_margins().unwrap().count(), 2);
        for posture in 0..6 {
            compare(&cell, &angles(6, posture), 2e-4, |_, k, ours, differences| {
                let expected = extrapolated(differences);
                // As shares of the largest one allowed.
                let error = (ours - expected).abs() * 1.2e-3;
                assert!(error < 1e-8, "{k}: {ours} {expected}");
            });
        }
    }
}

#[test]
fn one_of_two_limits_on_displacements_may_go() {
    let cell = with_displacement(shapes_cell());
    let (least, most) = (LimitKind::SmallestDisplacement, LimitKind::LargestDisplacement);
    for (kind, rest) in [(least, most), (most, least)] {
        let less = cell.without_limit(kind);
        assert!(less.limit_kinds().contains(&rest) && !less.limit_kinds().contains(&kind));
        let none = less.without_limit(rest);
        assert!(none.scene.is_empty() && none.scene.displacement().is_none());
    }
}
