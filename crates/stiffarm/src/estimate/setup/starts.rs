//! From which values a quantity is looked for: the stated one, and the slips that people make of it.

use crate::estimate::quantity::facts::Quantity;
use crate::estimate::quantity::stated::{StatedExperiment, anchor, loading_point};
use crate::estimate::quantity::value::QuantityValue;
use crate::numerics::arrangements::signed_axes;
use nalgebra::{Matrix3, Vector3};

impl StatedExperiment<'_> {
    /// Values to begin with, the stated one first.
    pub(super) fn starts(&self, quantity: Quantity) -> Vec<QuantityValue> {
        let cell = self.cell();
        let zeros = |count: usize| vec![0.0; count];
        let count = quantity.dimension(cell.setup.robot.joint_count());
        let mut out = vec![QuantityValue::new(Matrix3::identity(), zeros(count))];
        match quantity {
            Quantity::LoadingPoint(_) => {
                let stated = loading_point(cell, quantity);
                let mut others: Vec<Vector3<f64>> = exchanges().map(|turn| turn * stated).collect();
                let points = &cell.setup.tool.measuring_points;
                others.extend(points.iter().map(|point| point.position));
                let cases = cell.setup.load.cases().iter();
                others.extend(cases.filter_map(|case| case.loading_point));
                let moves = others.into_iter().map(|other| other - stated);
                out.extend(moves.map(|v| QuantityValue::new(Matrix3::identity(), v.iter().copied().collect())));
            }
            Quantity::Anchor(i) => {
                let stated = anchor(cell, i);
                let turned = exchanges().map(|turn| turn * stated - stated);
                out.extend(turned.map(|v| QuantityValue::new(Matrix3::identity(), v.iter().copied().collect())));
            }
            Quantity::Gravity => out.extend(signed_axes().map(|turn| QuantityValue::new(turn, zeros(2)))),
            // The positions behind readings show which axis is which.
            Quantity::Registration if !self.is_table() => {}
            Quantity::SensorAxes | Quantity::Registration => {
                // All three against is the sign.
                let turns = signed_axes().filter(|turn| *turn != -Matrix3::identity());
                out.extend(turns.map(|turn| QuantityValue::new(turn, zeros(3))));
            }
            Quantity::Points => {
                let turns = signed_axes().filter(|turn| turn.determinant() > 0.0);
                out.extend(turns.map(|turn| QuantityValue::new(turn, zeros(6))));
            }
            Quantity::Sign => out.push(QuantityValue::new(-Matrix3::identity(), Vec::new())),
            Quantity::SensorInBase | Quantity::Rows => {
                out.push(out[0].clone());
                out[0].turn = Matrix3::zeros();
            }
            Quantity::Angle(_) => {
                for turn in [1.0, -1.0] {
                    for quarter in 0..4 {
                        let offset = f64::from(quarter) * std::f64::consts::FRAC_PI_2;
                        out.push(QuantityValue::new(Matrix3::identity() * turn, vec![offset]));
                    }
                }
            }
            Quantity::Coupling => {
                out.extend([1.0, -1.0].map(|by| QuantityValue::new(Matrix3::identity() * by, Vec::new())));
                out[0].turn = Matrix3::zeros();
            }
            _ => {}
        }
        let mut seen: Vec<QuantityValue> = Vec::new();
        out.retain(|place| {
            let is_new = !seen.contains(place);
            seen.push(place.clone());
            is_new
        });
        out
    }
}

/// Those that people make of a place: signs alone, two axes exchanged, quarter turns about z.
fn exchanges() -> impl Iterator<Item = Matrix3<f64>> {
    let likely = |turn: &Matrix3<f64>| {
        let is_diagonal = turn.diagonal().iter().all(|v| *v != 0.0);
        let is_plain = turn.iter().all(|v| *v >= 0.0) && turn.determinant() < 0.0;
        is_diagonal || is_plain || (turn[(2, 2)] == 1.0 && turn.determinant() > 0.0)
    };
    signed_axes().filter(likely)
}
