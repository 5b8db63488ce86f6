//! Stiffness over a region, and the best place for a workpiece, are those of pointwise predictions.

mod nodes;
mod places;

use crate::common::prelude::*;
use nalgebra::UnitVector3;
use stiffarm::estimate::compliance::Spread;
use stiffarm::model::path::{PathPoint, PathTarget, tip_wrenches};
use stiffarm::model::process::{Process, TipLoad};
use stiffarm::work::map::{MapOptions, PlaceOptions, Placement, Status, StiffnessMap, place, stiffness_map};
use stiffarm::work::predict::Prediction;

fn down() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(PI, 0.0, 0.0)
}

fn options() -> MapOptions {
    let mut options = MapOptions::new([0.7, -1.6, 0.8], [3.0, 1.6, 0.8], [9, 11, 1]);
    options.rotation = down();
    options.free_turn = None;
    options.direction = UnitVector3::new_normalize(Vector3::new(1.0, 0.3, -0.2));
    options.wrench = Wrench { force: Vector3::new(200.0, -300.0, 400.0), moment: Vector3::new(5.0, 0.0, -12.0) };
    options
}

/// The prior with a covariance of 2 % per joint.
fn unsure(cell: &Cell) -> IdentifiedCompliance {
    let mut predictor = prior(cell);
    let variances = predictor.values.map(|h| (0.02 * h).powi(2));
    predictor.spread = Some(Spread {
        covariance: DMatrix::from_diagonal(&variances),
        sigma: 1e-5,
        shift: 0.0,
        degrees_of_freedom: None,
        doubt: None,
        confidence: 0.95,
    });
    predictor
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-10 * a.abs().max(b.abs())
}
