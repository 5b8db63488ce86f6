//! Margins of the scene and their derivatives.

use super::Work;
use crate::files::cell::parse_cell;
use crate::model::cell::{Cell, LimitKind};
use crate::model::kinematics::Frames;
use crate::model::observation::PostureTerms;
use std::collections::BTreeMap;

/// The default cell with everything a scene can ask.
pub(crate) fn cell() -> Cell {
    parse_cell(
        include_str!("../../../tests/cells/comau-shapes.toml"),
        "cell.toml",
    )
    .unwrap()
}

/// Postures spread over the bounds.
pub(crate) fn postures(cell: &Cell, count: usize) -> Vec<Vec<f64>> {
    let angle = |p: usize, j: usize, b: &[f64; 2]| {
        let share = 0.5 + 0.5 * (1.7 * p as f64 + 2.3 * j as f64).sin();
        b[0] + share * (b[1] - b[0])
    };
    (0..count)
        .map(|p| {
            cell.bounds
                .iter()
                .enumerate()
                .map(|(j, b)| angle(p, j, b))
                .collect()
        })
        .collect()
}

/// Margins and derivatives at serial angles.
fn at(cell: &Cell, theta: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let setup = &cell.setup;
    let n = theta.len();
    let count = cell.scene.count(setup);
    let mut terms = PostureTerms::new(setup, &vec![0.0; n], None).unwrap();
    terms.frames = Frames::at_serial_angles(&setup.robot, theta);
    terms.fill(setup, None).unwrap();
    let (mut values, mut gradients) = (vec![0.0; count], vec![0.0; count * n]);
    cell.scene.visit(
        setup,
        &terms,
        &mut Work::default(),
        |_| f64::INFINITY,
        |i, margin, slope| {
            values[i] = margin;
            slope.add_to(terms.frames(), 1.0, &mut gradients[i * n..(i + 1) * n]);
        },
    );
    (values, gradients)
}

#[test]
fn derivatives_of_margins_are_those_of_differences() {
    let cell = cell();
    let n = 6;
    let mut compared = BTreeMap::new();
    for q in postures(&cell, 40) {
        let theta = cell.setup.robot.serial_angles(&q);
        let theta: Vec<f64> = theta.iter().copied().collect();
        let (values, gradients) = at(&cell, &theta);
        let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
        let named = cell.scene.margins(&cell.setup, &terms);
        assert_eq!(named.len(), values.len());
        for k in 0..n {
            let difference = |step: f64| -> Vec<f64> {
                let moved = |by: f64| {
                    let mut theta = theta.clone();
                    theta[k] += by;
                    at(&cell, &theta).0
                };
                let (after, before) = (moved(step), moved(-step));
                after
                    .iter()
                    .zip(&before)
                    .map(|(a, b)| (a - b) / (2.0 * step))
                    .collect()
            };
            let (coarse, fine) = (difference(2e-5), difference(1e-5));
            for l in 0..values.len() {
                if !values[l].is_finite() {
                    continue;
                }
                let expected = (4.0 * fine[l] - coarse[l]) / 3.0;
                // Where the nearest feature changes within the step, differences say nothing.
                if (fine[l] - coarse[l]).abs() > 1e-6 {
                    continue;
                }
                let ours = gradients[l * n + k];
                assert!(
                    (ours - expected).abs() < 2e-7 * (1.0 + expected.abs()),
                    "{:?} of {}, joint {k}: {ours} {expected} at {}",
                    named[l].kind,
                    named[l].subject,
                    values[l]
                );
                *compared.entry(format!("{:?}", named[l].kind)).or_insert(0) +=
                    usize::from(ours != 0.0);
            }
        }
    }
    for kind in &LimitKind::ALL[5..] {
        let count = compared.get(&format!("{kind:?}")).copied().unwrap_or(0);
        assert!(count > 50, "{kind:?}: {count}");
    }
}
