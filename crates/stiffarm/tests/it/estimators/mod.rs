//! The estimators against dense textbook formulas: covariance matrices written
//! out in full and inverted, which the library never does.

mod dense;
mod fits;

use crate::common;

use common::random::Dice;
use common::{cases, random_group, reference_cell};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use proptest::prelude::*;
use stiffarm::estimate::identify::{
    Assumptions, Block, Estimator, IdentifyOptions, MeasuredSystem, NoiseSource, Prepared,
    PriorKnowledge, RowLabel, Scale, Solution, Verdict, Weights, Whitened, bootstrap, identify,
    measured_system,
};
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Wrench;
use stiffarm::model::measurement::{Displacement, MeasuredPosture};
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::posture::{Posture, PostureGroup};

fn assume(estimator: Estimator, scale: Scale) -> Assumptions {
    Assumptions {
        estimator,
        scale,
        declared_ratio: 0.0,
        prior: None,
    }
}

fn solve(system: &MeasuredSystem, assumed: &Assumptions) -> Solution {
    Prepared::new(system, assumed.estimator)
        .unwrap()
        .solve(&system.delta, assumed)
        .unwrap()
}

fn same_matrix(ours: &DMatrix<f64>, theirs: &DMatrix<f64>) -> f64 {
    let n = ours.nrows();
    let mut worst = 0.0_f64;
    for i in 0..n {
        for j in 0..n {
            let size = (theirs[(i, i)] * theirs[(j, j)]).sqrt();
            worst = worst.max((ours[(i, j)] - theirs[(i, j)]).abs() / size);
        }
    }
    worst
}

fn named(postures: &[Vec<f64>]) -> Vec<Posture> {
    PostureGroup::from_angles("", postures.iter().cloned()).postures
}

fn honest_cell() -> Cell {
    let mut cell = reference_cell();
    cell.noise.readings_per_displacement = 2;
    cell
}
