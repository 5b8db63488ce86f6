//! The index `prediction` against a second, plain implementation over dual numbers that
//! solves the mixed-model equations by orthogonalisation instead of kriging, and against
//! all groups of a list.

use crate::common;

use common::model::{Model, inverse_r};
use common::random::Dice;
use nalgebra::DMatrix;
use num_dual::{Dual64, DualNum};
use stiffarm::model::elastic::ElasticSizes;
use stiffarm::model::load::Load;
use stiffarm::plan::index::{Index, IndexFunction, evaluate};

const POSTURES: usize = 4;

/// Rows of the readings \[Ψ/k, B\] over their noise, with one row per random effect.
fn equations(model: &Model, postures: &[Vec<Dual64>], sizes: [f64; 3]) -> DMatrix<Dual64> {
    let n = model.joint_count();
    let white = model.posture_covariance().cholesky().unwrap().l();
    let white = white.try_inverse().unwrap();
    let blocks: Vec<DMatrix<Dual64>> = postures
        .iter()
        .map(|q| {
            let (psi, springs) = (model.psi(q), model.spring_columns(q, sizes));
            DMatrix::from_fn(psi.nrows(), n + springs.ncols(), |i, j| {
                (0..=i).fold(Dual64::from(0.0), |sum, l| {
                    let entry = match j < n {
                        true => psi[(l, j)] / model.prior[j],
                        false => springs[(l, j - n)],
                    };
                    sum + entry * white[(i, l)]
                })
            })
        })
        .collect();
    let (height, unknowns) = blocks[0].shape();
    let readings = height * blocks.len();
    DMatrix::from_fn(readings + unknowns - n, unknowns, |i, j| {
        match i < readings {
            true => blocks[i / height][(i % height, j)],
            false => Dual64::from(if i - readings + n == j { 1.0 } else { 0.0 }),
        }
    })
}

/// The tasks' shifts by the same unknowns.
fn targets(model: &Model, sizes: [f64; 3]) -> DMatrix<f64> {
    let share = (model.tasks.len() as f64).sqrt();
    let n = model.joint_count();
    let mut rows = Vec::new();
    for task in &model.tasks {
        let mut work = model.clone();
        work.loading_point = task.tip.into();
        work.measuring_points = vec![task.tip.into()];
        work.load = Load::Constant {
            wrench: task.wrench,
            axes: task.axes,
        };
        let (psi, springs) = (work.psi(&task.q), work.spring_columns(&task.q, sizes));
        for i in 0..3 {
            let fixed = (0..n).map(|j| psi[(i, j)] / model.prior[j]);
            let random = springs.row(i).iter().copied().collect::<Vec<f64>>();
            rows.push(fixed.chain(random).map(|v| v / share).collect::<Vec<f64>>());
        }
    }
    DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
}

/// ln of the index: ½ ln tr(T (XᵀX)⁻¹ Tᵀ).
fn ln_index(model: &Model, postures: &[Vec<Dual64>], sizes: [f64; 3]) -> Dual64 {
    let inverse = inverse_r(&equations(model, postures, sizes));
    let rows = targets(model, sizes);
    let mut trace = Dual64::from(0.0);
    for i in 0..rows.nrows() {
        for j in 0..inverse.ncols() {
            let entry = (0..=j).fold(Dual64::from(0.0), |s, k| s + inverse[(k, j)] * rows[(i, k)]);
            trace += entry * entry;
        }
    }
    trace.ln() * 0.5
}

/// A random cell and group that determine every joint.
fn determined(dice: &mut Dice, n: usize, case: usize) -> (Model, Vec<Vec<f64>>) {
    loop {
        let model = dice.model(n, case % 4, case % 2 == 1, case % 3 == 1);
        let postures = dice.postures(n, POSTURES);
        let found = evaluate(&model.cell(), "", &postures).unwrap().indices;
        if found.scaled_condition.is_some_and(|c| c < 1e3) {
            return (model, postures);
        }
    }
}

#[test]
fn values_and_gradients_are_those_of_the_mixed_model_equations() {
    let mut dice = Dice::new(77);
    let (mut worst, mut worst_value) = (0.0_f64, 0.0_f64);
    for (case, n) in [6, 6, 6, 6, 5, 7].into_iter().enumerate() {
        let (model, postures) = determined(&mut dice, n, case);
        let cell = model.cell();
        let typical = ElasticSizes::typical(&cell.setup, &model.prior).unwrap();
        let sizes = [typical.shift, typical.turn, typical.coupling];
        let flat = postures.concat();
        let mut function = IndexFunction::new(&cell, Index::Prediction, POSTURES).unwrap();
        let mut gradient = vec![0.0; flat.len()];
        let ours = function.smoothed(&flat, 1.0, &mut gradient);
        let shown = evaluate(&cell, "", &postures)
            .unwrap()
            .indices
            .prediction
            .unwrap();
        let found: Vec<Dual64> = (0..flat.len())
            .map(|k| {
                let dual: Vec<Dual64> = flat
                    .iter()
                    .enumerate()
                    .map(|(i, v)| Dual64::new(*v, if i == k { 1.0 } else { 0.0 }))
                    .collect();
                let postures: Vec<_> = dual.chunks_exact(n).map(<[_]>::to_vec).collect();
                ln_index(&model, &postures, sizes)
            })
            .collect();
        for value in [
            ours.exact,
            ours.objective,
            shown.ln(),
            function.value(&flat),
        ] {
            let error = (value - found[0].re).abs();
            assert!(
                error < 1e-10,
                "case {case}: {value} against {}",
                found[0].re
            );
            worst_value = worst_value.max(error);
        }
        let scale = found.iter().fold(1e-3_f64, |m, g| m.max(g.eps.abs()));
        for (k, (ours, golden)) in gradient.iter().zip(&found).enumerate() {
            let error = (ours - golden.eps).abs() / scale;
            assert!(
                error < 1e-10,
                "case {case} angle {k}: {ours} against {}, scale {scale}",
                golden.eps
            );
            worst = worst.max(error);
        }
    }
    println!("worst gradient {worst:.1e}, worst value {worst_value:.1e}");
}
