//! The compliance that most load states agree on, and how far each state is from it.
//!
//! Every state is divided by the size that its load lets expect, so that a load
//! typed ten times too large weighs no more than its neighbours; states that
//! disagree with the others lose their weight round by round.

use super::super::Work;
use super::super::motion::{CLEAR_STDS, Move, displacement, moves};
use super::super::slip::StateIndex;
use super::class::{PRIOR_SPREAD, expected_stiffness};
use crate::numerics::sample::median;
use nalgebra::{DMatrix, DVector, Isometry3};

/// Spread of a joint's compliance about the common ratio to what is expected:
/// standard deviation of the ratio, as a share of it.
const SPREAD: f64 = 0.8;
/// What an arm of joint springs leaves unexplained of a displacement: at least, at most.
const UNEXPLAINED_SHARE: [f64; 2] = [0.03, 0.5];
/// Logarithm of a state's ratio at which it has lost half its weight: at first, and later.
const HALF_WEIGHT_RATIO: [f64; 2] = [0.8, 0.5];
/// Rounds of weighing.
const ROUNDS: usize = 10;

/// One load state against the fit.
#[derive(Debug, Clone)]
pub(super) struct StateScale {
    /// Posture and state.
    pub at: (usize, usize),
    /// Size over what the fit gives, along the latter; below zero against it.
    pub ratio: f64,
    /// Distance from the fit over the larger of both sizes.
    pub misfit: f64,
}

/// The fit.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    /// Compliance of each spring \[rad/(N·m)\].
    pub compliance: DVector<f64>,
    /// Compliance over the expected one: logarithm of its mean over the joints
    /// that are determined, and its standard deviation.
    pub common: f64,
    pub common_std: f64,
    /// The states, in the order of the moves.
    pub states: Vec<StateScale>,
    /// Median misfit.
    pub level: f64,
}

impl Fitted {
    /// Mean misfit of all states: what changes of the cell are judged by.
    pub fn mean_misfit(&self) -> f64 {
        let sum: f64 = self.states.iter().map(|s| s.misfit).sum();
        sum / self.states.len().max(1) as f64
    }
}

/// How far `one` is from what `compliance` gives.
fn scaled(one: &Move, compliance: &DVector<f64>) -> StateScale {
    let (measured, expected) = (&one.shift - &one.series_shift, &one.block * compliance);
    let (measured_size, size) = (measured.norm(), expected.norm());
    StateScale {
        at: (one.posture, one.state),
        ratio: measured.dot(&expected) / (size * size).max(f64::MIN_POSITIVE),
        misfit: (measured - expected).norm() / measured_size.max(size).max(f64::MIN_POSITIVE),
    }
}

/// Mean misfit of the displacements of the states `at`; `None` where one is not known.
pub(super) fn misfit_of(
    work: &Work,
    base_from_tracker: &Isometry3<f64>,
    at: &[StateIndex],
    fitted: &Fitted,
) -> Option<f64> {
    let mut sum = 0.0;
    for (p, s) in at {
        let reference = *work.sheet.postures[*p].references().first()?;
        let one = displacement(work, base_from_tracker, *p, *s, reference)?;
        sum += scaled(&one, &fitted.compliance).misfit;
    }
    Some(sum / at.len() as f64)
}

/// Displacements that stand out of the noise, with the wrench their table gives them.
/// In a table of displacements that is every one: typed in metres none would.
pub(super) fn clear_moves(work: &Work, base_from_tracker: &Isometry3<f64>) -> Vec<Move> {
    let mut out = moves(work, base_from_tracker);
    let least = if work.is_displacements { 0.0 } else { CLEAR_STDS };
    out.retain(|m| m.shift.norm() > least * m.std * (m.shift.len() as f64).sqrt() && m.block.amax() > 0.0);
    out
}

/// Fits the springs to `all`; `None` without displacements.
pub(super) fn fit(work: &Work, all: &[Move]) -> Option<Fitted> {
    let stiffness = work.cell.prior.clone();
    let stiffness = stiffness.unwrap_or_else(|| expected_stiffness(&work.setup().robot));
    let expected = DVector::from_iterator(stiffness.len(), stiffness.iter().map(|k| 1.0 / k));
    let rows: Vec<(DMatrix<f64>, DVector<f64>)> = all
        .iter()
        .map(|one| {
            let mut block = one.block.clone();
            for (mut column, h) in block.column_iter_mut().zip(expected.iter()) {
                column *= *h;
            }
            let size = block.column_sum().norm();
            (block / size, (&one.shift - &one.series_shift) / size)
        })
        .filter(|(block, _)| block.iter().all(|v| v.is_finite()))
        .collect();
    if rows.is_empty() || rows.len() != all.len() {
        return None;
    }
    let sizes: Vec<f64> = rows.iter().map(|(_, measured)| measured.norm()).collect();
    let mut common = median(&sizes);
    let weight = |log: f64, half: f64| 1.0 / (1.0 + (log / half).powi(4));
    let mut weights: Vec<f64> = sizes.iter().map(|s| weight((s / common).ln(), HALF_WEIGHT_RATIO[0])).collect();
    let n = expected.len();
    let mut left = 0.2;
    let mut out = None;
    for _ in 0..ROUNDS {
        // Ridge towards the common ratio: joints without information follow the others.
        let ridge = 1.0 / (SPREAD * common).powi(2);
        let mut information = DMatrix::identity(n, n) * ridge;
        let mut right = DVector::from_element(n, common * ridge);
        for ((block, measured), weight) in rows.iter().zip(&weights) {
            let precision = weight * measured.len() as f64 / (left * common).powi(2) / 3.0;
            information += block.tr_mul(block) * precision;
            right += block.tr_mul(measured) * precision;
        }
        let covariance = information.clone().try_inverse()?;
        let ratio: DVector<f64> = (&covariance * right).map(|x| x.max(0.02 * common));
        let compliance = ratio.component_mul(&expected);
        let states: Vec<StateScale> = all.iter().map(|one| scaled(one, &compliance)).collect();
        weights = states
            .iter()
            .map(|s| {
                if s.ratio > 0.05 {
                    weight(s.ratio.ln(), HALF_WEIGHT_RATIO[1])
                } else {
                    weight(3.0, HALF_WEIGHT_RATIO[1])
                }
            })
            .collect();
        let misfits: Vec<f64> = states.iter().map(|s| s.misfit).collect();
        let level = median(&misfits);
        left = level.clamp(UNEXPLAINED_SHARE[0], UNEXPLAINED_SHARE[1]);
        let (mut sum, mut total) = (0.0, 0.0);
        for j in 0..n {
            let error = covariance[(j, j)].sqrt() / ratio[j];
            let determined = (1.0 - (error / SPREAD).powi(2)).max(1e-3);
            let w = determined / (PRIOR_SPREAD.powi(2) + error.powi(2));
            sum += w * ratio[j].ln();
            total += w;
        }
        let mean = sum / total;
        common = mean.exp();
        out = Some(Fitted { compliance, common: mean, common_std: total.sqrt().recip(), states, level });
    }
    out.filter(|f| f.common.is_finite())
}
