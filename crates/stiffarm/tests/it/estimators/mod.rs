//! The estimators against dense textbook formulas: covariance matrices written
//! out in full and inverted, which the library never does.

mod dense;
mod fits;
mod intervals;

use crate::common::prelude::*;
use crate::common::random_group;
use nalgebra::Matrix3;
use proptest::prelude::*;
use stiffarm::estimate::identify::bootstrap;
use stiffarm::internals::{
    Assumptions, Block, Covariance, MeasuredSystem, Prepared, PriorKnowledge, RowLabel, Scale, Solution, Whitened,
    solutions_without,
};

fn assume(estimator: Estimator, scale: Scale) -> Assumptions {
    Assumptions { estimator, scale, declared_ratio: 0.0, prior: None }
}

fn solve(system: &MeasuredSystem, assumed: &Assumptions) -> Solution {
    Prepared::new(system, assumed.estimator).unwrap().solve(&system.delta, assumed).unwrap()
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

fn honest_cell() -> Cell {
    changed(reference_cell(), |o| o.noise.readings_per_displacement = 2)
}

/// A random system of `postures` blocks with up to four displacements each,
/// `states` of which share shifts in proportion to a load, and covariances
/// where asked.
pub fn random_system(dice: &mut Dice, postures: usize, unknowns: usize, correlated: bool) -> MeasuredSystem {
    let mut blocks = Vec::new();
    let mut labels = Vec::new();
    let mut at = 0;
    for p in 0..postures {
        let count = 2 + dice.below(3);
        let mut shared = DMatrix::zeros(3 * count, 3);
        for d in 0..count {
            let load = if d % 2 == 0 { 1.0 } else { dice.signed(0.3, 1.0) };
            for axis in 0..3 {
                shared[(3 * d + axis, axis)] = load;
            }
            labels.push(RowLabel { measured: p, displacement: d, rows: at + 3 * d..at + 3 * d + 3 });
        }
        let rows = 3 * count;
        let covariance = correlated.then(|| {
            let root = DMatrix::from_fn(rows, rows, |_, _| dice.between(-0.4, 0.4));
            &root * root.transpose() + DMatrix::identity(rows, rows)
        });
        blocks.push(Block {
            posture: format!("p{p}"),
            rows: at..at + rows,
            covariance: covariance.map_or_else(Covariance::default, |c| Covariance::from_matrix(&c)),
            shared,
        });
        at += rows;
    }
    MeasuredSystem {
        psi: DMatrix::from_fn(at, unknowns, |_, j| dice.between(-1.0, 1.0) * 10f64.powi(j as i32 - 2)),
        delta: DVector::from_fn(at, |_, _| dice.between(-1.0, 1.0)),
        unknowns: (0..unknowns).map(|j| format!("u{j}")).collect(),
        springs: unknowns,
        extra: Vec::new(),
        blocks,
        labels,
    }
}

/// C + γ Z Zᵀ of the whole system, in units of σ².
pub fn dense_covariance(system: &MeasuredSystem, gamma: f64) -> DMatrix<f64> {
    let rows = system.psi.nrows();
    let mut out = DMatrix::identity(rows, rows);
    for block in &system.blocks {
        let (from, count) = (block.rows.start, block.rows.len());
        let within = block.covariance.to_matrix(count);
        let shift = &block.shared * block.shared.transpose() * gamma;
        out.view_mut((from, from), (count, count)).copy_from(&(within + shift));
    }
    out
}

/// Generalised least squares: values, (ΨᵀV⁻¹Ψ)⁻¹, eᵀV⁻¹e.
fn dense_gls(system: &MeasuredSystem, v: &DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>, f64) {
    let inverse = v.clone().try_inverse().unwrap();
    let information = system.psi.transpose() * &inverse * &system.psi;
    let covariance = information.try_inverse().unwrap();
    let values = &covariance * system.psi.transpose() * &inverse * &system.delta;
    let residual = &system.delta - &system.psi * &values;
    let rest = residual.dot(&(inverse * &residual));
    (values, covariance, rest)
}
